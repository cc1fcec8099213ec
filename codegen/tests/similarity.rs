//! Nothing in the derivation has a unit: copies of a robot, of any size and weight, get the same kernels and the same levers.

mod common;

use common::{Derived, FAMILIES, GAITS, specification};
use piaffe_codegen::mechanism::{Family, Mechanism, levers, parameters};
use piaffe_codegen::spec::{Gait, Robot};

/// A Froude copy: gravity stays, so times grow like the root of lengths.
fn copy(key: &str, length: f64, mass: f64) -> (Robot, Gait) {
    let (mut robot, mut gait) = specification(key);
    let (time, inertia) = (length.sqrt(), mass * length * length);
    let scale = |numbers: &mut [f64], factor: f64| numbers.iter_mut().for_each(|x| *x *= factor);
    let platform = &mut robot.platform;
    platform.mass *= mass;
    scale(&mut platform.com, length);
    scale(platform.inertia.as_flattened_mut(), inertia);
    for leg in &mut robot.legs {
        scale(&mut leg.mount, length);
        for segment in &mut leg.chain {
            let (link, motor) = (&mut segment.link, &mut segment.joint.actuator);
            link.mass *= mass;
            scale(&mut link.end, length);
            scale(&mut link.com, length);
            scale(link.inertia.as_flattened_mut(), inertia);
            motor.max_torque *= mass * length;
            motor.unloaded_speed /= time;
            motor.loaded_speed /= time;
            motor.rotor_inertia *= inertia;
        }
    }
    let limits = &mut gait.limits;
    limits.min_vertical_force *= mass;
    limits.swing_clearance *= length;
    limits.min_platform_height *= length;
    gait.phases.list.iter_mut().for_each(|phase| scale(&mut phase.duration, time));
    (robot, gait)
}

/// Lengths and masses of copies, exact and not.
const SIZES: [(f64, f64); 4] = [(1e-3, 1e-6), (1e2, 1e6), (1e-2, 1e4), (0.000_976_562_5, 0.000_030_517_578_125)];

#[test]
fn levers_of_copies_reach_the_same_numbers() {
    for key in GAITS {
        let reach = |(robot, gait): &(Robot, Gait)| -> Vec<(String, Vec<usize>)> {
            let numbers = |slopes: &[(usize, f64)]| slopes.iter().map(|s| s.0).collect();
            levers(robot, gait).iter().map(|l| (l.name.clone(), numbers(&l.slopes))).collect()
        };
        let expected = reach(&specification(key));
        for (length, mass) in SIZES {
            assert_eq!(reach(&copy(key, length, mass)), expected, "{key}: lengths × {length}, masses × {mass}");
        }
    }
}

#[test]
fn kernels_of_copies_have_as_many_terms() {
    let terms = |(robot, gait): &(Robot, Gait)| -> Vec<(String, usize)> {
        let derived = Derived::new(&Mechanism::new(&robot.locked(&gait.locked).unwrap(), gait));
        let count = |k: &piaffe_codegen::dynamics::Kernel| -> usize {
            k.outputs.iter().flat_map(|o| &o.values).map(|value| value.len()).sum()
        };
        derived.kernels.iter().map(|k| (k.name.clone(), count(k))).collect()
    };
    for key in ["trot", "rabbit/walk"] {
        let expected = terms(&specification(key));
        for (length, mass) in &SIZES[..2] {
            assert_eq!(terms(&copy(key, *length, *mass)), expected, "{key}: lengths × {length}, masses × {mass}");
        }
    }
}

#[test]
fn copies_have_families_too() {
    for key in FAMILIES {
        for (length, mass) in SIZES {
            let (robot, gait) = copy(key, length, mass);
            assert!(Family::new(&robot, &gait, parameters(&robot)).is_ok(), "{key}: {length}, {mass}");
        }
    }
}
