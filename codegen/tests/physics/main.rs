//! The derivation against physics: random robots in random states obey the laws that the equations of
//! motion, the impacts and their derivatives must obey. Expressions are evaluated as they are, without
//! the factoring and emission that come after.

#[path = "../common/mod.rs"]
mod common;
mod flight;
mod floating;
mod gaits;
mod heights;
mod impact;
mod jacobians;
mod numbers;
mod robots;
mod state;
mod support;
mod whole;

use common::Derived;
use piaffe_codegen::mechanism::{Mechanism, Mode};
use piaffe_codegen::spec::Rotation;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use robots::{BUILDS, Build, DRAWS, Draws};
use state::State;

/// States looked at per robot.
const STATES: usize = 2;

fn obeys_all_laws(mechanism: &Mechanism, draws: &mut Draws) {
    let mechanism = &common::with_all(mechanism.clone());
    assert_eq!(mechanism.modes.contains(&Mode::Flight), mechanism.rotation != Rotation::Roll);
    let d = Derived::new(mechanism);
    let turning = (mechanism.rotation == Rotation::None).then(|| {
        Derived::new(&Mechanism { rotation: Rotation::Pitch, unactuated: mechanism.joints.len(), ..mechanism.clone() })
    });
    for _ in 0..STATES {
        let s = State::random(mechanism, draws);
        floating::bodies(&d, &s);
        floating::equations_of_motion(&d, &s);
        floating::feet(&d, &s);
        for leg in 0..2 {
            support::momenta(&d, &s, leg);
            support::dynamics(&d, turning.as_ref(), &s, leg);
            impact::one_foot(&d, &s, leg);
        }
        if mechanism.modes.contains(&Mode::Flight) {
            flight::momenta(&d, &s);
            flight::dynamics(&d, turning.as_ref(), &s);
            for leg in 0..2 {
                flight::take_off(&d, &s, leg);
                flight::landing(&d, &s, leg);
            }
        }
        for mode in mechanism.modes.iter().copied() {
            jacobians::of_mode(&d, &s, mode);
            jacobians::of_inverse_dynamics(&d, &s, mode);
            jacobians::of_stages(&d, &s, mode);
            jacobians::of_curvature(&d, &s, draws, mode);
            jacobians::of_heights(&d, &s, draws, mode);
        }
        for transition in mechanism.transitions.clone() {
            if transition.lands().is_some() {
                jacobians::of_impact(&d, &s, transition);
                jacobians::of_impacts_curvature(&d, &s, draws, transition);
            } else {
                jacobians::of_take_off(&d, &s, draws, transition);
            }
        }
        impact::both_feet(&d, &s);
    }
}

fn random_robots(build: &Build, cases: u32) {
    let config = ProptestConfig {
        cases,
        max_shrink_iters: 8,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2003),
        ..ProptestConfig::default()
    };
    let numbers = prop::collection::vec(0.0..1.0, DRAWS);
    let result = TestRunner::new(config).run(&numbers, |numbers| {
        let mut draws = Draws::new(numbers);
        let (robot, gait) = robots::specification(build, &mut draws);
        let mechanism = Mechanism::new(&robot, &gait);
        obeys_all_laws(&mechanism, &mut draws);
        heights::of_random(&robot, &gait, &mut draws);
        Ok(())
    });
    if let Err(e) = result {
        panic!("{e}");
    }
}

#[test]
fn the_shipped_gaits() {
    for gait in common::GAITS {
        let numbers = (0..DRAWS).map(|k| (k as f64 * 0.618_033_988_749_895).fract()).collect();
        obeys_all_laws(&common::shipped(gait), &mut Draws::new(numbers));
    }
}

macro_rules! builds {
    ($($name:ident: $index:literal, $cases:literal;)*) => {
        $(#[test] fn $name() {
            let started = std::time::Instant::now();
            random_robots(&BUILDS[$index].1, $cases);
            println!("{}: {} cases in {:.1} s", BUILDS[$index].0, $cases, started.elapsed().as_secs_f64());
        })*
    };
}

builds! {
    trot: 0, 12;
    trot_with_rotors: 1, 12;
    level_platform_with_hips_apart: 2, 8;
    curvet: 3, 10;
    curvet_on_uneven_legs: 4, 6;
    amble: 5, 8;
    amble_on_three_links: 6, 2;
    amble_with_hips_that_abduct: 7, 1;
    amble_with_hips_that_turn: 8, 4;
    biped: 9, 4;
    crooked_trot: 10, 6;
    crooked_curvet: 11, 3;
    crooked_on_three_links: 12, 2;
    crooked_amble: 13, 2;
}
