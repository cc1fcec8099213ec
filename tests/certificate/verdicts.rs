//! Optima are certified; what breaks a limit anywhere is not.

use crate::motions::{gaits, stepping};
use piaffe::altered::Altered;
use piaffe::certificate::{Certificate, certify};
use piaffe::gaits::{GAITS, curvet::Curvet, running_trot::RunningTrot, trot::Trot};
use piaffe::model::{Description, Gait};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::verify::constraint::{Constraint, Tally};
use piaffe::verify::contact::contact;
use piaffe::verify::instants::State;
use piaffe::verify::margins::Units;
use piaffe::verify::phase::Phase;
use piaffe::verify::verify;
use proptest::prelude::*;
use std::sync::OnceLock;

const SPEED: f64 = 0.6;

fn optimum(gait: &dyn Gait, criterion: Criterion) -> Motion {
    search(gait, criterion, SPEED, &Settings::default(), &|_| {}).optima[0].local.motion.clone()
}

#[test]
fn optima_are_certified() {
    // Of high orders much cancels, and limits bend more between two nodes.
    let [six, eight] = [6, 8].map(|order| Altered::of_order(&Trot, order));
    let [curvet, running] = [Altered::of_order(&Curvet, 6), Altered::of_order(&RunningTrot, 8)];
    // Those of gaits that fly are in `running.rs`.
    let walking = GAITS.iter().copied().filter(|g| !g.description().flies());
    for gait in walking.chain([&six as &dyn Gait, &eight, &curvet, &running]) {
        for criterion in Criterion::ALL {
            let d = gait.description();
            let certificate = certify(d, &optimum(gait, criterion), SPEED).unwrap();
            assert!(certificate.is_certified(), "{} {}: {certificate:?}", d.key, criterion.name());
            assert!(certificate.phases.iter().flat_map(|h| h.width).all(|width| width < 1e-8));
        }
    }
}

/// The margins at `points` instants.
fn tallies(d: &Description, motion: &Motion, points: usize) -> Vec<Tally> {
    let mut state = State::new(d);
    let one = |(i, h)| {
        let mut tally = Tally::new(d, i + 1);
        let mut phase = Phase::new(d, h, contact(d, &motion.phases, i), i + 1).unwrap();
        for k in 0..points {
            let t = phase.duration * k as f64 / (points - 1) as f64;
            phase.at(t, &mut state).unwrap();
            Units::new(d).margins(phase.numbers(), &phase.contact(), &state, |constraint, margin| {
                tally.note(constraint, margin, t)
            });
        }
        tally
    };
    motion.phases.iter().enumerate().map(one).collect()
}

/// No margin that is found anywhere is below what was proven.
fn bounds_hold(d: &Description, motion: &Motion, certificate: &Certificate) {
    for (i, tally) in tallies(d, motion, 501).iter().enumerate() {
        for constraint in Constraint::all(d).filter(|c| tally.margin(*c).is_finite()) {
            let (name, found) = (constraint.name(d), tally.margin(constraint));
            let bound = certificate.bounds.iter().find(|b| b.phase == i + 1 && b.constraint == name).unwrap();
            // The samples come from an integration that is off by 1e-11 or so.
            assert!(bound.margin.is_none_or(|m| m <= found + 1e-8), "{name}: {found:e}, but {bound:?}");
        }
    }
}

#[test]
fn bounds_are_below_all_samples() {
    for gait in gaits() {
        let d = gait.description();
        // Motions from geometry break many limits, and do not close.
        let motion = stepping(d);
        let certificate = certify(d, &motion, 0.3).unwrap();
        assert!(!certificate.is_certified() && certificate.gaps.iter().any(|gap| gap.violated));
        assert!(certificate.cycle_error.unwrap() > 1e-3);
        bounds_hold(d, &motion, &certificate);
        bounds_hold(
            d,
            &optimum(gait, Criterion::Energy),
            &certify(d, &optimum(gait, Criterion::Energy), SPEED).unwrap(),
        );
    }
}

/// Where an angle of the first phase is greatest (or least, with `sign` −1), and what it is there.
fn extreme(d: &Description, motion: &Motion, joint: usize, sign: f64) -> (f64, f64) {
    let h = &motion.phases[0];
    let mut phase = Phase::new(d, h, 0, 1).unwrap();
    let mut state = State::new(d);
    let points = 20_001;
    let at = |k: usize| {
        let t = h.duration * k as f64 / (points - 1) as f64;
        phase.at(t, &mut state).unwrap();
        (t, state.q[joint])
    };
    (0..points).map(at).max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1))).unwrap()
}

#[test]
fn a_limit_that_is_broken_between_the_nodes_of_a_grid_alone_is_found() {
    let mut tried = 0;
    for gait in gaits() {
        let (good, motion) = (gait.description(), optimum(gait, Criterion::Energy));
        let stops = (0..good.joints()).flat_map(|j| [(j, 0, -1.0), (j, 1, 1.0)]);
        for (joint, side, sign) in stops {
            let (time, angle) = extreme(good, &motion, joint, sign);
            let limited = |by: f64| {
                let mut d = good.clone();
                d.joints.to_mut()[joint].range[side] = angle - sign * by;
                d
            };
            // Half of it is tolerated.
            let ends = time < 0.02 || time > motion.phases[0].duration - 0.02;
            if ends || !certify(&limited(9e-7), &motion, SPEED).unwrap().is_certified() {
                continue; // An end is a node of every grid; in the other phase the joint may go further.
            }
            let d = limited(2e-6);
            let name = [Constraint::LowerStop(joint), Constraint::UpperStop(joint)][side].name(&d);
            // A grid that misses it.
            let blind = (51..200).find(|n| verify(&d, &motion, SPEED, *n).unwrap().max_violation <= 1e-6);
            assert!(blind.is_some(), "{name}: no grid is blind to it");
            let certificate = certify(&d, &motion, SPEED).unwrap();
            assert!(!certificate.is_certified());
            let [gap] = certificate.gaps.as_slice() else { panic!("{:?}", certificate.gaps) };
            assert!(gap.constraint == name && gap.phase == 1 && gap.violated, "{gap:?}, not {name}");
            assert!(gap.from <= time && time <= gap.to && gap.to - gap.from < 0.01, "{gap:?} at {time}");
            assert!((gap.bound.unwrap() + 2e-6).abs() < 1e-7, "{gap:?}");
            tried += 1;
        }
    }
    assert!(tried > 2, "{tried}");
}

#[test]
fn a_motion_that_does_not_close_is_not_certified() {
    let good = optimum(&Trot, Criterion::Torque);
    for change in [|m: &mut Motion| m.phases[0].betad_initial += 2e-6, |m: &mut Motion| m.phases[0].beta_final += 2e-6]
    {
        let mut motion = good.clone();
        change(&mut motion);
        let certificate = certify(Trot.description(), &motion, SPEED).unwrap();
        assert!(!certificate.is_certified() && certificate.cycle_error.unwrap() > 1e-6);
    }
    let slower = certify(Trot.description(), &good, SPEED - 2e-6).unwrap();
    assert!(!slower.is_certified() && slower.gaps.iter().all(|gap| gap.constraint == "mean speed"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_samples_refute_is_never_certified(
        index in 0..3_usize,
        size in prop_oneof![Just(1e-7), Just(1e-6), Just(1e-5), Just(1e-3), Just(0.1)],
        shifts in prop::collection::vec(-1.0..1.0_f64, 32),
    ) {
        static OPTIMA: OnceLock<Vec<Motion>> = OnceLock::new();
        let optima = OPTIMA.get_or_init(|| gaits().iter().map(|g| optimum(*g, Criterion::Energy)).collect());
        let d = gaits()[index].description();
        let mut motion = optima[index].clone();
        let mut shifts = shifts.into_iter().cycle();
        for h in &mut motion.phases {
            for list in h.q_interior.iter_mut().chain([&mut h.q_final, &mut h.q_initial, &mut h.qd_final]) {
                list.iter_mut().zip(&mut shifts).for_each(|(x, shift)| *x += size * shift);
            }
        }
        let Ok(receipt) = verify(d, &motion, SPEED, 4001) else { return Ok(()) };
        let certificate = certify(d, &motion, SPEED).unwrap();
        if receipt.max_violation > 1e-6 + 1e-10 || receipt.cycle_error > 1e-6 + 1e-10 {
            prop_assert!(!certificate.is_certified(), "{receipt:?} {certificate:?}");
        }
        if receipt.max_violation > 1e-6 + 1e-10 && certificate.cycle_error.is_some() {
            prop_assert!(!certificate.gaps.is_empty());
        }
        if !certificate.is_certified() && certificate.gaps.iter().all(|gap| !gap.violated) && size < 1e-2 {
            // It is not too modest either.
            prop_assert!(receipt.cycle_error > 0.9e-6 || receipt.max_violation > 0.9e-6, "{receipt:?} {certificate:?}");
        }
        bounds_hold(d, &motion, &certificate);
    }
}
