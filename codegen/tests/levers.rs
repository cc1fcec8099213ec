//! How a gait's numbers follow from those of the specification.

mod common;

use common::{FAMILIES, GAITS, files, shipped, specification, with_phases};
use piaffe_codegen::dynamics::{kernels, lowest};
use piaffe_codegen::mechanism::{Family, Lever, Mechanism, levers, parameters};
use piaffe_codegen::spec::{Gait, Robot, RobotFile, parse_gait, parse_robot};
use piaffe_codegen::{RobotFiles, SpecFile};

#[test]
fn slopes_of_masses_and_lengths_are_those_of_unit_robots() {
    for key in FAMILIES {
        let (robot, gait) = specification(key);
        let family = Family::new(&robot, &gait, parameters(&robot)).unwrap();
        let levers = levers(&robot, &gait);
        for (parameter, slopes) in family.parameters.iter().zip(&family.slopes) {
            // A family has mounts that are as far out as one.
            let mounts = parameter.name.rsplit_once(".mount.").map(|(_, axis)| format!(".mount.{axis}"));
            let as_far =
                |l: &&Lever| l.value.abs() == parameter.value.abs() && mounts.iter().any(|axis| l.name.ends_with(axis));
            let found: Vec<&Lever> =
                levers.iter().filter(|l| l.numbers.contains(&parameter.name) || as_far(l)).collect();
            for (number, expected) in slopes.iter().enumerate() {
                let slope = |l: &&Lever| {
                    let own = l.slopes.iter().filter(|s| s.0 == number).map(|s| s.1).sum::<f64>();
                    if l.value * parameter.value < 0.0 { -own } else { own }
                };
                let slope = found.iter().map(slope).sum::<f64>();
                let near = (slope - expected).abs() <= 1e-9 * expected.abs();
                assert!(near, "{key} {} {number}: {slope} {expected}", parameter.name);
            }
        }
    }
}

#[test]
fn slopes_are_those_of_a_changed_text() {
    let changes = [
        ("mass = 1.6", "mass = 1.601", "links.thigh.mass", 1e-3),
        ("gear = 50.0", "gear = 50.001", "actuators.haunch_motor.gear", 1e-3),
        ("max_torque = 0.4", "max_torque = 0.401", "actuators.haunch_motor.max_torque", 1e-3),
        ("unloaded = 6600.0", "unloaded = 6601.0", "actuators.knee_motor.max_speed.unloaded", 1.0),
        ("at_max_torque = 4200.0", "at_max_torque = 4201.0", "actuators.knee_motor.max_speed.at_max_torque", 1.0),
        ("range = [-0.5236,", "range = [-0.5226,", "joints.haunch.range.lower", 1e-3),
        ("-0.2618]", "-0.2608]", "joints.knee.range.upper", 1e-3),
        ("friction = 1.0", "friction = 1.001", "limits.friction", 1e-3),
        ("min_vertical_force = 10.0", "min_vertical_force = 11.0", "limits.min_vertical_force", 1.0),
        ("swing_clearance = 0.005", "swing_clearance = 0.006", "limits.swing_clearance", 1e-3),
        ("[0.05, 2.0]", "[0.051, 2.0]", "limits.half_step_duration.shortest", 1e-3),
        ("[0.05, 2.0]", "[0.05, 2.001]", "limits.half_step_duration.longest", 1e-3),
    ];
    let numbers = |change: Option<(&str, &str)>| {
        let (_, robot, gait) = files("trot");
        let text = |text: &str| change.map_or(text.to_string(), |(from, to)| text.replacen(from, to, 1));
        let robot = parse_robot(&robot.path, &text(&robot.text)).unwrap();
        let gait = parse_gait(&gait.path, &text(&gait.text), &robot).unwrap();
        let mechanism = Mechanism::new(&robot.robot, &gait);
        [mechanism.numbers(), mechanism.limiting_numbers()].concat()
    };
    let (robot, gait) = specification("trot");
    let (levers, before) = (levers(&robot, &gait), numbers(None));
    for (from, to, name, by) in changes {
        let lever = levers.iter().find(|l| l.name == name).unwrap_or_else(|| panic!("no {name}"));
        assert!(!lever.slopes.is_empty() && lever.value.is_finite());
        for (number, (before, after)) in before.iter().zip(numbers(Some((from, to)))).enumerate() {
            let slope = lever.slopes.iter().filter(|s| s.0 == number).map(|s| s.1).sum::<f64>();
            // Of a gear, all but rounding and the second order.
            let error = (after - before - slope * by).abs();
            assert!(error <= 1e-3 * (slope * by).abs() + 1e-14, "{name} {number}: {before} {after} {slope}");
        }
    }
}

/// So what is derived of one serves for all that differ in their limits.
#[test]
fn limits_have_no_part_in_the_equations_of_motion() {
    for key in GAITS {
        let mechanism = shipped(key);
        let unlimited = mechanism.unlimited();
        assert!(mechanism.limiting_numbers().iter().any(|number| *number != 0.0));
        assert!(unlimited.limiting_numbers().iter().all(|number| *number == 0.0), "{key}");
        assert_eq!(unlimited.numbers(), mechanism.numbers());
        let derived = |of: &Mechanism| {
            let (mut model, kernels) = kernels(of);
            (lowest(&mut model), format!("{kernels:?}"))
        };
        assert!(derived(&unlimited) == derived(&mechanism), "{key}");
    }
}

/// A trot of the A1: its diagonal legs move as one, and the diagonals mirror each other.
const TROT_OF_A1: &str = r#"
virtual_legs = [["FL", "RR"], ["FR", "RL"]]
locked = { FR_hip_joint = 0.0, FL_hip_joint = 0.0, RR_hip_joint = 0.0, RL_hip_joint = 0.0 }
platform = { moves = ["x", "y"], rotates = "none" }
unactuated = "leg1.FL_thigh_joint"
half_steps = "mirrored"
[limits]
friction = 1.0
min_vertical_force = 7.0
swing_clearance = 0.005
half_step_duration = [0.05, 2.0]
"#;

fn robot(key: &str) -> RobotFile {
    let (_, robot, _) = files(key);
    parse_robot(&robot.path, &robot.text).unwrap()
}

/// Changes every lever of a gait by a percent: the gait must remain one of the robot, and slopes tell its numbers.
fn every_lever_keeps_the_gait(robot: &RobotFile, text: &str) -> Vec<Lever> {
    let gait = parse_gait("gait.toml", text, robot).unwrap();
    let numbers = |robot: &RobotFile, gait: &Gait| {
        let mechanism = Mechanism::new(&robot.robot.locked(&gait.locked).unwrap(), gait);
        [mechanism.numbers(), mechanism.limiting_numbers()].concat()
    };
    let before = numbers(robot, &gait);
    let levers = levers(&robot.robot, &gait);
    for lever in &levers {
        let by = if lever.value == 0.0 { 1e-6 } else { 1e-2 * lever.value };
        let (other, changed) = lever.moved(&robot.robot, &gait, by);
        let mut moved = robot.clone();
        moved.robot = other;
        let again = parse_gait("gait.toml", text, &moved);
        assert!(again.is_ok(), "{}: {:?}", lever.name, again.unwrap_err());
        let largest = before.iter().fold(0.0f64, |most, number| most.max(number.abs()));
        for (number, (before, after)) in before.iter().zip(numbers(&moved, &changed)).enumerate() {
            let slope = lever.slopes.iter().filter(|s| s.0 == number).map(|s| s.1).sum::<f64>();
            // All but the second order.
            let error = (after - before - slope * by).abs();
            assert!(error <= 2e-2 * (slope * by).abs() + 1e-12 * largest, "{} {number}: {error}", lever.name);
        }
    }
    levers
}

/// Each phase has its own; half steps have one for all.
#[test]
fn durations_are_called_as_they_are_written() {
    let run = with_phases("trot", &[Some(1), None], "mirrored");
    let levers = every_lever_keeps_the_gait(&robot("trot"), &run.text);
    let durations: Vec<&str> =
        levers.iter().map(|l| l.name.as_str()).filter(|name| name.contains("duration")).collect();
    let expected =
        ["phases.1", "phases.2"].map(|phase| ["shortest", "longest"].map(|end| format!("{phase}.duration.{end}")));
    assert_eq!(durations, expected.concat());
}

#[test]
fn numbers_that_must_stay_alike_change_together() {
    for key in GAITS {
        let (_, _, gait) = files(key);
        every_lever_keeps_the_gait(&robot(key), &gait.text);
    }
    let bound = every_lever_keeps_the_gait(&robot("a1/bound"), &files("a1/bound").2.text);
    let trot = every_lever_keeps_the_gait(&robot("a1/bound"), TROT_OF_A1);
    let named = |levers: &[Lever], name: &str| levers.iter().any(|l| l.name == name);
    // A bound's hind legs are alike, and its fore legs; a trot's are all of one build.
    for name in ["links.{RR,RL}_calf.length.y", "links.{FR,FL}_calf.length.y", "joints.{RR,RL}_calf_joint.range.lower"]
    {
        assert!(named(&bound, name) && !named(&trot, name), "{name}");
    }
    for name in [
        "links.{FR,FL,RR,RL}_calf.length.y",
        "links.{FR,FL,RR,RL}_calf.length.z",
        "links.{FR,FL,RR,RL}_thigh.com.x",
        "legs.{FR,FL,RR,RL}.mount.x",
        "actuators.motor.max_torque",
    ] {
        assert!(named(&trot, name), "{name}: {:?}", trot.iter().map(|l| &l.name).collect::<Vec<_>>());
    }
    assert!(named(&every_lever_keeps_the_gait(&robot("trot"), &files("trot").2.text), "links.shin.length"));
}

const AMBLE_OF_A1: &str = r#"
virtual_legs = [["FR", "RR"], ["FL", "RL"]]
platform = { moves = ["x", "y", "z"], rotates = "roll" }
unactuated = "platform"
half_steps = "mirrored"
[limits]
friction = 1.0
min_vertical_force = 7.0
swing_clearance = 0.005
half_step_duration = [0.05, 2.0]
"#;

/// The A1 with its mass centre in the middle, where its mirror image is.
fn even_a1() -> String {
    let text = files("a1/bound").1.text;
    text.replace("com = [0.0, -0.000499916680553, -0.00409931678054]", "com = [0.0, -0.0005, 0.0]")
}

/// Mirror images turn the other way: where the platform rolls, a stop of a hip on the right is the other one on the left.
#[test]
fn stops_of_mirror_images_change_against_each_other() {
    let robot = parse_robot("robot.toml", &even_a1()).unwrap();
    let levers = every_lever_keeps_the_gait(&robot, AMBLE_OF_A1);
    let stop = levers.iter().find(|l| l.numbers.iter().any(|n| n == "joints.FR_hip_joint.range.lower")).unwrap();
    let mut numbers: Vec<&str> = stop.numbers.iter().map(String::as_str).collect();
    numbers.sort_unstable();
    let upper = ["FL", "RL"].map(|leg| format!("joints.{leg}_hip_joint.range.upper"));
    let lower = ["FR", "RR"].map(|leg| format!("joints.{leg}_hip_joint.range.lower"));
    assert_eq!(numbers, [&upper[0], &lower[0], &upper[1], &lower[1]]);
}

/// A spring on the right that pulls inward is one on the left that pulls inward: their angles change against each other, what they and
/// friction give changes alike, from zero too.
#[test]
fn springs_of_mirror_images_stay_so() {
    let mut text = even_a1();
    for leg in ["FR", "RR", "FL", "RL"] {
        let rest = if leg.ends_with('R') { 0.1 } else { -0.1 };
        for (joint, keys) in [
            ("hip", format!("stiffness = 3.0\nrest_angle = {rest}\ndamping = 0.0\n")),
            ("thigh", "stiffness = 0.0\nrest_angle = 0.4\n".into()),
            ("calf", "stiffness = 2.0\nrest_angle = 0.0\n".into()),
        ] {
            let table = format!("[joints.{leg}_{joint}_joint]\n");
            assert!(text.contains(&table));
            text = text.replace(&table, &format!("{table}{keys}"));
        }
    }
    let robot = parse_robot("robot.toml", &text).unwrap();
    for gait in [AMBLE_OF_A1, TROT_OF_A1] {
        let levers = every_lever_keeps_the_gait(&robot, gait);
        let of = |name: &str| levers.iter().find(|l| l.numbers.iter().any(|n| n == name)).map(|l| l.slopes.len());
        // What a virtual leg has is of both its real ones.
        let hips = if gait == AMBLE_OF_A1 { Some(2) } else { None };
        for (name, slopes) in [
            ("hip_joint.stiffness", hips),
            ("hip_joint.rest_angle", hips),
            ("hip_joint.damping", hips),
            ("thigh_joint.stiffness", Some(2)),
            ("thigh_joint.rest_angle", None),
            ("calf_joint.rest_angle", Some(2)),
        ] {
            assert_eq!(of(&format!("joints.FR_{name}")), slopes, "{name}");
        }
    }
}

/// A robot of which no number is shipped.
fn heron() -> RobotFiles {
    RobotFiles::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/sensitivity/heron").as_ref()).unwrap()
}

/// The robots of all tests here, with one gait each.
fn all_files() -> Vec<RobotFiles> {
    let mut all: Vec<RobotFiles> = GAITS
        .iter()
        .map(|key| {
            let (module, robot, gait) = files(key);
            RobotFiles { module: module.into(), robot, gaits: vec![gait] }
        })
        .collect();
    let a1 = files("a1/bound").1;
    all.push(RobotFiles {
        module: "a1".into(),
        robot: a1,
        gaits: vec![SpecFile { path: "trot.toml".into(), text: TROT_OF_A1.into() }],
    });
    let kitten = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/report/kitten");
    all.push(RobotFiles::read(kitten.as_ref()).unwrap());
    all.push(heron());
    all
}

fn described(files: &RobotFiles) -> Option<(Robot, Gait)> {
    let robot = parse_robot("robot.toml", &files.robot.text).ok()?;
    let gait = parse_gait("gait.toml", &files.gaits[0].text, &robot).ok()?;
    Some((robot.robot, gait))
}

/// Whoever sets what a slope is called gets what the slope says.
#[test]
fn names_are_those_by_which_numbers_are_set() {
    let numbers = |files: &RobotFiles| {
        let (robot, gait) = described(files)?;
        let mechanism = Mechanism::new(&robot.locked(&gait.locked).ok()?, &gait);
        Some([mechanism.numbers(), mechanism.limiting_numbers()].concat())
    };
    let mut compared = 0;
    for files in all_files() {
        let (robot, gait) = described(&files).unwrap();
        let before = numbers(&files).unwrap();
        let sizes = Mechanism::new(&robot.locked(&gait.locked).unwrap(), &gait).sizes();
        for lever in levers(&robot, &gait) {
            let name = format!("{} {}", files.module, lever.name);
            let known = files.number(&lever.name);
            assert!(
                known == Some(lever.value) || (known, lever.value) == (None, 0.0),
                "{name}: {known:?} {}",
                lever.value
            );
            assert!(lever.numbers.iter().all(|one| files.number(one).is_some() || lever.value == 0.0), "{name}");
            if lever.value == 0.0 && lever.numbers.len() > 1 {
                continue; // On either side to its own.
            }
            // What is none is changed by little, a rotor by little beside a small one.
            let step = if lever.unit == "kg·m²" { 1e-11 } else { 1e-6 };
            let by = if lever.value == 0.0 { step } else { 1e-5 * lever.value };
            let moved = |by: f64| {
                let mut changed = files.clone();
                changed.set(&lever.name, lever.value + by).unwrap();
                numbers(&changed)
            };
            // Beyond zero, or beyond what a rigid body can be, there is none.
            let (above, below) = (moved(by), moved(-by));
            let (after, before, apart) = match (above, below) {
                (Some(above), Some(below)) => (above, below, 2.0 * by),
                (Some(above), None) => (above, before.clone(), by),
                (None, Some(below)) => (before.clone(), below, by),
                (None, None) => continue,
            };
            for (number, (before, after)) in before.iter().zip(after).enumerate() {
                let slope = lever.slopes.iter().filter(|s| s.0 == number).map(|s| s.1).sum::<f64>();
                let error = (after - before - slope * apart).abs();
                // Sums of numbers of the robot's size.
                let rounding = 2e-14 * sizes.get(number).map_or(before.abs(), |size| size.abs());
                assert!(error <= 2e-3 * (slope * apart).abs() + rounding, "{name} {number}: {before} {after} {slope}");
            }
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
}

/// Every number that stands in the file, but for those that have no part in the gait and coulomb friction that is none.
#[test]
fn feet_and_zeros_have_slopes() {
    let (robot, gait) = described(&heron()).unwrap();
    let levers = levers(&robot, &gait);
    let value = |name: &str| levers.iter().find(|l| l.numbers.iter().any(|n| n == name)).map(|l| l.value);
    for (name, expected) in [
        ("links.meta.mass", 0.0008),
        ("links.meta.foot_mass", 0.0003),
        ("links.meta.length.x", 0.001),
        ("links.meta.com.x", 0.0),
        ("links.tibia.foot_mass", 0.0),
        ("links.tibia.com", 0.0),
        ("links.body.extent.centre.x", 0.0),
        ("legs.left.mount.x", 0.0),
        ("legs.right.mount.y", 0.0),
        ("joints.hip.damping", 0.0),
        ("actuators.m.rotor_inertia", 0.0),
    ] {
        assert_eq!(value(name), Some(expected), "{name}: {:?}", levers.iter().map(|l| &l.name).collect::<Vec<_>>());
    }
    for name in ["links.meta.length", "joints.hock.coulomb", "joints.knee.damping", "links.femur.foot_mass"] {
        assert_eq!(value(name), None, "{name}");
    }
}

/// Fore and hind legs of a bound are as far out, and two things.
#[test]
fn what_is_equal_by_chance_is_not_one() {
    let bound = every_lever_keeps_the_gait(&robot("a1/bound"), &files("a1/bound").2.text);
    let mounts: Vec<&str> = bound.iter().map(|l| l.name.as_str()).filter(|name| name.contains("mount.x")).collect();
    assert_eq!(mounts, ["legs.{FR,FL}.mount.x", "legs.{RR,RL}.mount.x"]);
}

/// What is named changes, and nothing else; braces name what is on either side.
#[test]
fn only_what_is_named_is_set() {
    let (module, robot, gait) = files("trot");
    let files = RobotFiles { module: module.into(), robot, gaits: vec![gait] };
    let changed = |name: &str, value: f64| -> Vec<(String, f64)> {
        let mut other = files.clone();
        other.set(name, value).unwrap();
        let before = files.numbers();
        other.numbers().into_iter().filter(|number| !before.contains(number)).collect()
    };
    let named = |leg: &str, value: f64| (format!("legs.{leg}.mount.x"), value);
    assert_eq!(changed("legs.hind_left.mount.x", -0.2), [named("hind_left", -0.2)]);
    assert_eq!(
        changed("legs.{fore_left,hind_left}.mount.x", 0.2),
        [named("fore_left", 0.2), named("hind_left", -0.2)],
        "those of opposite signs stay so"
    );
}
