//! How a gait's numbers follow from those of the specification.

mod common;

use common::{FAMILIES, files, specification};
use piaffe_codegen::mechanism::{Family, Mechanism, levers, parameters};
use piaffe_codegen::spec::{parse_gait, parse_robot};

#[test]
fn slopes_of_masses_and_lengths_are_those_of_unit_robots() {
    for key in FAMILIES {
        let (robot, gait) = specification(key);
        let family = Family::new(&robot, &gait, parameters(&robot)).unwrap();
        let levers = levers(&robot, &gait);
        for (parameter, slopes) in family.parameters.iter().zip(&family.slopes) {
            let found = levers.iter().find(|l| l.name == parameter.name);
            for (number, expected) in slopes.iter().enumerate() {
                let slopes = found.iter().flat_map(|l| &l.slopes);
                let slope = slopes.filter(|s| s.0 == number).map(|s| s.1).sum::<f64>();
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
