//! What tells one robot and gait from another: all that describes them as one text, and its hash.
//!
//! Results hold fingerprints, so a robot's text stays what it is: it is written field by field in the words of its first version,
//! whatever the types are called today. A field that is new is told where it is not what it was for all robots before it.

use super::{Body, Description, Joint, Leg, Limits, Member, Mode, Phase, Point, Rotation, Spot, Then};
use std::fmt::Debug;

impl Description {
    /// Tells one robot and gait from another: a hash of all that describes them. How their kernels are written is no part of it.
    pub fn fingerprint(&self) -> String {
        format!("{:016x}", hash(&description(self)))
    }
}

/// FNV-1a: the same on every machine and with every compiler.
pub fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Where kernels put their numbers is no part of what a robot is: this is told of every one.
fn shapes() -> String {
    include_str!("fingerprint.txt").trim_end().replace('\n', " ").replace('*', "Block { at: 0, rows: 0, columns: 0 }")
}

fn description(d: &Description) -> String {
    let Description {
        key,
        gait,
        robot,
        gravity,
        rotation,
        phases,
        then,
        bodies,
        corners,
        joints,
        legs,
        unactuated,
        polynomial_order,
        points,
        lowest,
        limits: within,
        shapes: _,
        operations: _,
    } = d;
    let rotates = match rotation {
        Rotation::None => "None",
        Rotation::Pitch => "Pitch",
        Rotation::Roll => "Roll",
    };
    let follows = match then {
        Then::Mirrored => "Mirrored",
        Then::Repeat => "Repeat",
    };
    record(
        "Description",
        &[
            ("key", plain(key)),
            ("gait", plain(gait)),
            ("robot", plain(robot)),
            ("gravity", plain(gravity)),
            ("lateral", plain(&d.is_spatial())),
            ("rotation", rotates.into()),
            ("phases", list(phases, phase)),
            ("then", follows.into()),
            ("bodies", list(bodies, body)),
            ("corners", list(corners, spot)),
            ("joints", list(joints, joint)),
            ("legs", list(legs, leg)),
            ("unactuated", plain(unactuated)),
            ("polynomial_order", plain(polynomial_order)),
            ("points", list(points, point)),
            ("lowest", plain(lowest)),
            ("limits", limits(within)),
            ("shapes", shapes()),
            ("operations", "[]".into()),
        ],
    )
}

fn phase(Phase { mode, duration }: &Phase) -> String {
    let mode = match mode {
        Mode::Stance(leg) => format!("Stance({leg})"),
        Mode::Flight => "Flight".into(),
    };
    record("Phase", &[("mode", mode), ("duration", plain(duration))])
}

fn body(Body { name, parent, coordinate, axis, offset, mass, com, inertia }: &Body) -> String {
    record(
        "Body",
        &[
            ("name", plain(name)),
            ("parent", plain(parent)),
            ("coordinate", plain(coordinate)),
            ("axis", plain(axis)),
            ("offset", plain(offset)),
            ("mass", plain(mass)),
            ("com", plain(com)),
            ("inertia", plain(inertia)),
        ],
    )
}

/// Springs and friction are told where there are some.
fn joint(j: &Joint) -> String {
    let Joint {
        name,
        range,
        gear,
        max_torque,
        unloaded_speed,
        loaded_speed,
        rotor_inertia,
        stiffness,
        rest,
        damping,
        coulomb,
    } = j;
    let mut fields = vec![
        ("name", plain(name)),
        ("range", plain(range)),
        ("gear", plain(gear)),
        ("max_torque", plain(max_torque)),
        ("unloaded_speed", plain(unloaded_speed)),
        ("loaded_speed", plain(loaded_speed)),
        ("rotor_inertia", plain(rotor_inertia)),
    ];
    if j.has_spring() {
        fields.extend([("stiffness", plain(stiffness)), ("rest", plain(rest))]);
    }
    if j.has_friction() {
        fields.extend([("damping", plain(damping)), ("coulomb", plain(coulomb))]);
    }
    record("Joint", &fields)
}

fn leg(Leg { members, first_joint, end_joint, foot_body, foot }: &Leg) -> String {
    record(
        "Leg",
        &[
            ("members", list(members, member)),
            ("first_joint", plain(first_joint)),
            ("end_joint", plain(end_joint)),
            ("foot_body", plain(foot_body)),
            ("foot", plain(foot)),
        ],
    )
}

fn member(Member { name, bodies, joints, foot, spots }: &Member) -> String {
    record(
        "Member",
        &[
            ("name", plain(name)),
            ("bodies", list(bodies, body)),
            ("joints", plain(joints)),
            ("foot", plain(foot)),
            ("spots", list(spots, spot)),
        ],
    )
}

fn spot(Spot { body, at }: &Spot) -> String {
    record("Spot", &[("body", plain(body)), ("at", plain(at))])
}

fn point(Point { name, of, spot, leg, mirrored }: &Point) -> String {
    record(
        "Point",
        &[
            ("name", plain(name)),
            ("of", plain(of)),
            ("spot", plain(spot)),
            ("leg", plain(leg)),
            ("mirrored", plain(mirrored)),
        ],
    )
}

fn limits(l: &Limits) -> String {
    let Limits { friction, min_vertical_force, swing_clearance, min_platform_height, body_clearance, real_legs } = l;
    record(
        "Limits",
        &[
            ("friction", plain(friction)),
            ("min_vertical_force", plain(min_vertical_force)),
            ("swing_clearance", plain(swing_clearance)),
            ("min_platform_height", plain(min_platform_height)),
            ("body_clearance", plain(body_clearance)),
            ("real_legs", plain(real_legs)),
        ],
    )
}

fn record(name: &str, fields: &[(&str, String)]) -> String {
    let fields: Vec<String> = fields.iter().map(|(field, value)| format!("{field}: {value}")).collect();
    format!("{name} {{ {} }}", fields.join(", "))
}

fn list<T>(all: &[T], tell: impl Fn(&T) -> String) -> String {
    format!("[{}]", all.iter().map(tell).collect::<Vec<_>>().join(", "))
}

/// A number, a name, or several of them.
fn plain(value: &impl Debug) -> String {
    format!("{value:?}")
}
