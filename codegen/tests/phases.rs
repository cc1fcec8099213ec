//! What gaits are made of: the modes and transitions that follow from their lists of phases.

mod common;

use common::{files, shipped, with_phases};
use piaffe_codegen::dynamics::kernels;
use piaffe_codegen::mechanism::{Mechanism, Mode, Transition};
use piaffe_codegen::spec::{parse_gait, parse_robot};

fn mechanism(gait: &str, list: &[Option<usize>], then: &str) -> Mechanism {
    let (_, robot, _) = files(gait);
    let robot = parse_robot(&robot.path, &robot.text).unwrap();
    let file = with_phases(gait, list, then);
    let parsed = parse_gait(&file.path, &file.text, &robot).unwrap_or_else(|found| panic!("{}", found[0]));
    Mechanism::new(&robot.robot, &parsed)
}

const ONE: Mode = Mode::Stance(0);
const TWO: Mode = Mode::Stance(1);
const AIR: Mode = Mode::Flight;

/// Modes in the order of the derivation; transitions as a set.
fn consists_of(mechanism: &Mechanism, modes: &[Mode], transitions: &[(Mode, Mode)]) {
    assert_eq!(mechanism.modes, modes);
    let expected: Vec<Transition> = transitions.iter().map(|&(from, to)| Transition { from, to }).collect();
    let missing: Vec<_> = expected.iter().filter(|t| !mechanism.transitions.contains(t)).collect();
    let more: Vec<_> = mechanism.transitions.iter().filter(|t| !expected.contains(t)).collect();
    assert!(missing.is_empty() && more.is_empty(), "missing {missing:?}, more {more:?}");
    assert_eq!(mechanism.transitions.len(), expected.len(), "each once");
}

#[test]
fn a_run_takes_off_and_lands_and_never_steps_over() {
    let run = mechanism("trot", &[Some(1), None], "mirrored");
    consists_of(&run, &[ONE, TWO, AIR], &[(ONE, AIR), (AIR, TWO)]);
    let names: Vec<String> = kernels(&run).1.into_iter().map(|kernel| kernel.name).collect();
    for name in ["takeoff1", "landing2", "landing_curvature2", "flight_late_gradient", "flight_inverse_jacobian"] {
        assert!(names.iter().any(|n| n == name), "{name} is not in {names:?}");
    }
    // Legs exchange their names, so that nothing is there twice.
    let never = |name: &String| name.starts_with("touchdown") || name == "takeoff2" || name == "landing1";
    assert!(!names.iter().any(never), "{names:?}");
}

#[test]
fn a_bound_with_one_flight_steps_over_once() {
    let bound = mechanism("curvet", &[Some(1), Some(2), None], "repeat");
    consists_of(&bound, &[ONE, TWO, AIR], &[(ONE, TWO), (TWO, AIR), (AIR, ONE)]);
}

#[test]
fn a_bound_with_two_flights_lands_on_either_leg() {
    let bound = mechanism("curvet", &[Some(1), None, Some(2), None], "repeat");
    consists_of(&bound, &[ONE, TWO, AIR], &[(ONE, AIR), (AIR, TWO), (TWO, AIR), (AIR, ONE)]);
}

/// Half steps are phases, and say the same in fewer words.
#[test]
fn half_steps_are_short_for_phases() {
    type Case = (&'static str, &'static [Option<usize>], &'static str, &'static [(Mode, Mode)]);
    let cases: [Case; 2] = [
        ("trot", &[Some(1)], "mirrored", &[(ONE, TWO)]),
        ("curvet", &[Some(1), Some(2)], "repeat", &[(ONE, TWO), (TWO, ONE)]),
    ];
    for (gait, list, then, transitions) in cases {
        let (short, long) = (shipped(gait), mechanism(gait, list, then));
        assert_eq!((&short.modes, &short.transitions, short.then), (&long.modes, &long.transitions, long.then));
        let modes = |m: &Mechanism| m.phases.iter().map(|phase| phase.mode).collect::<Vec<_>>();
        assert_eq!(modes(&short), modes(&long));
        consists_of(&long, &[ONE, TWO], transitions);
    }
}
