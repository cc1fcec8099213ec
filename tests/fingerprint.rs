//! Fingerprints: those of results that exist hold for ever, and whatever describes a robot has a part in them.

use piaffe::Robot;
use piaffe::gaits::GAITS;
use piaffe::model::{Description, Gait, Mode, Point, Rotation, Then};
use piaffe_codegen::RobotFiles;

/// Of the shipped gaits. Whoever changes a shipped robot changes its own; nothing else does.
const FINGERPRINTS: [(&str, &str); 11] = [
    ("amble", "cf6da2268fd1eded"),
    ("bound", "8a73b121c1adf3e6"),
    ("bound_two_flights", "21eb10e81998fd85"),
    ("curvet", "6cc3f22698183d87"),
    ("running_trot", "7005a5a6499d7919"),
    ("trot", "f1124b492368bd98"),
    ("a1/bound", "13ef5fb5be3aa720"),
    ("a1/flying_bound", "e90f9214c8f41581"),
    ("a1/running_trot", "a48bc3f1a0374ed5"),
    ("rabbit/run", "ad5c158ef8cba4e5"),
    ("rabbit/walk", "03ea4c560f501ad8"),
];

fn described(key: &str) -> &'static Description {
    GAITS.iter().map(|gait| gait.description()).find(|d| d.key == key).unwrap()
}

#[test]
fn fingerprints_stay_what_they_are() {
    let found: Vec<(&str, String)> = FINGERPRINTS.map(|(key, _)| (key, described(key).fingerprint())).into();
    assert_eq!(found, FINGERPRINTS.map(|(key, known)| (key, known.to_string())));
    assert_eq!(GAITS.len(), FINGERPRINTS.len());
}

/// With springs or friction a robot is another one.
#[test]
fn springs_and_friction_have_theirs() {
    let files = RobotFiles::read(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec").as_ref()).unwrap();
    let fingerprint = |numbers: &[(&str, f64)]| {
        let mut files = RobotFiles { module: String::new(), ..files.clone() };
        files.set_all(numbers.iter().copied()).unwrap();
        Robot::new(files).unwrap().gait("trot").unwrap().description().fingerprint()
    };
    assert_eq!(fingerprint(&[]), described("trot").fingerprint());
    assert_eq!(fingerprint(&[("joints.knee.damping", 0.01)]), "1a08486432783e62");
    let spring = [("joints.knee.stiffness", 1.0), ("joints.knee.rest_angle", -0.2)];
    assert_eq!(fingerprint(&spring), "25ffd51bf2826458");
}

/// With its first point changed.
fn with_point(d: &mut Description, change: fn(&mut Point)) {
    let mut points = d.points.to_vec();
    change(&mut points[0]);
    d.points = points.leak();
}

#[test]
fn every_field_counts() {
    let original = described("amble");
    type Change = fn(&mut Description);
    let changes: Vec<(&str, Change)> = vec![
        ("key", |d| d.key = "pace"),
        ("gait", |d| d.gait = "pace"),
        ("robot", |d| d.robot = "another"),
        ("gravity", |d| d.gravity = 1.62),
        ("rotation", |d| d.rotation = Rotation::None),
        ("rotation", |d| d.rotation = Rotation::Pitch),
        ("phases' number", |d| d.phases = [&d.phases[..], &d.phases[..]].concat().into()),
        ("a phase's mode", |d| d.phases.to_mut()[0].mode = Mode::Flight),
        ("a phase's leg", |d| d.phases.to_mut()[0].mode = Mode::Stance(1)),
        ("a shortest duration", |d| d.phases.to_mut()[0].duration[0] *= 1.5),
        ("a longest duration", |d| d.phases.to_mut()[0].duration[1] *= 1.5),
        ("then", |d| d.then = if d.then == Then::Repeat { Then::Mirrored } else { Then::Repeat }),
        ("a body's name", |d| d.bodies.to_mut()[1].name = "another"),
        ("a body's parent", |d| d.bodies.to_mut()[1].parent = None),
        ("a body's coordinate", |d| d.bodies.to_mut()[1].coordinate = None),
        ("a body's axis", |d| d.bodies.to_mut()[1].axis = 1),
        ("a body's offset", |d| d.bodies.to_mut()[1].offset[0] += 0.1),
        ("a body's mass", |d| d.bodies.to_mut()[1].mass += 0.1),
        ("a body's mass centre", |d| d.bodies.to_mut()[1].com[1] += 0.1),
        ("a body's inertia", |d| d.bodies.to_mut()[1].inertia[2][2] += 0.1),
        ("corners", |d| d.corners = [&d.corners[..], &d.legs[0].members[0].spots[..1]].concat().into()),
        ("a joint's name", |d| d.joints.to_mut()[0].name = "another"),
        ("a lower stop", |d| d.joints.to_mut()[0].range[0] -= 0.1),
        ("an upper stop", |d| d.joints.to_mut()[0].range[1] += 0.1),
        ("a gear", |d| d.joints.to_mut()[0].gear += 1.0),
        ("a greatest torque", |d| d.joints.to_mut()[0].max_torque += 1.0),
        ("an unloaded speed", |d| d.joints.to_mut()[0].unloaded_speed += 1.0),
        ("a loaded speed", |d| d.joints.to_mut()[0].loaded_speed -= 0.1),
        ("a rotor", |d| d.joints.to_mut()[0].rotor_inertia += 1.0),
        ("a spring", |d| d.joints.to_mut()[0].stiffness = 1.0),
        ("where it rests", |d| (d.joints.to_mut()[0].stiffness, d.joints.to_mut()[0].rest) = (1.0, 0.2)),
        ("viscous friction", |d| d.joints.to_mut()[0].damping = 1.0),
        ("dry friction", |d| d.joints.to_mut()[0].coulomb = 1.0),
        ("a leg's first joint", |d| d.legs[0].first_joint += 1),
        ("a leg's last joint", |d| d.legs[0].end_joint += 1),
        ("a leg's foot's body", |d| d.legs[1].foot_body += 1),
        ("a leg's foot", |d| d.legs[1].foot[1] += 0.1),
        ("members", |d| d.legs[0].members = d.legs[0].members[..1].to_vec().into()),
        ("a member's name", |d| d.legs[0].members.to_mut()[0].name = "another"),
        ("a member's body", |d| d.legs[0].members.to_mut()[0].bodies.to_mut()[0].mass += 0.1),
        ("a member's joint", |d| d.legs[0].members.to_mut()[0].joints.to_mut()[0] = "another"),
        ("a member's foot", |d| d.legs[0].members.to_mut()[0].foot[0] += 0.1),
        ("a spot's body", |d| d.legs[0].members.to_mut()[0].spots.to_mut()[0].body += 1),
        ("a spot's place", |d| d.legs[0].members.to_mut()[0].spots.to_mut()[0].at[0] += 0.1),
        ("β", |d| d.unactuated += 1),
        ("an order", |d| d.polynomial_order += 1),
        ("points", |d| d.points = &d.points[1..]),
        ("a point's name", |d| with_point(d, |point| point.name = "another")),
        ("whose it is", |d| with_point(d, |point| point.of = Some((1, 1)))),
        ("a point's spot", |d| with_point(d, |point| point.spot += 1)),
        ("a point's leg", |d| with_point(d, |point| point.leg += 1)),
        ("a point's side", |d| with_point(d, |point| point.mirrored = !point.mirrored)),
        ("the lowest points", |d| d.lowest = &d.lowest[1..]),
        ("ground", |d| d.limits.friction += 0.1),
        ("a least force", |d| d.limits.min_vertical_force += 1.0),
        ("a swing's clearance", |d| d.limits.swing_clearance += 0.1),
        ("a platform's height", |d| d.limits.min_platform_height += 0.1),
        ("a body's clearance", |d| d.limits.body_clearance += 0.1),
        ("real legs", |d| d.limits.real_legs = !d.limits.real_legs),
    ];
    let mut known = vec![("nothing", original.fingerprint())];
    for (what, change) in changes {
        let mut d = original.clone();
        change(&mut d);
        let found = d.fingerprint();
        let twin = known.iter().find(|(_, other)| *other == found);
        assert!(twin.is_none(), "{what} has the fingerprint of {twin:?}");
        known.push((what, found));
    }
}

/// How kernels are written and what they cost is no part of a robot.
#[test]
fn kernels_do_not_count() {
    let [trot, amble] = ["trot", "amble"].map(described);
    let other = Description { shapes: amble.shapes, operations: amble.operations, ..trot.clone() };
    assert_eq!(other.fingerprint(), trot.fingerprint());
}
