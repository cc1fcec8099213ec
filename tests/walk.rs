//! A walk is a motion in the world: real feet stand still, steps follow each other, velocities are derivatives.

#[path = "gaits/walking.rs"]
mod walking;

use piaffe::model::{Gait, Mode};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::verify::verify;
use piaffe::walk::{Point, Walk};
use std::sync::LazyLock;
use walking::walking;

const SPEED: f64 = 0.6;

/// Any optimum of every one of them.
static MOTIONS: LazyLock<Vec<Motion>> = LazyLock::new(|| {
    let motion = |gait: &&dyn Gait| {
        let found = search(*gait, Criterion::Torque, SPEED, &Settings::default(), &|_| {});
        found.optima[0].local.motion.clone()
    };
    walking().map(motion).collect()
});

fn walks(intervals: usize) -> Vec<(&'static dyn Gait, Motion, Walk<'static>)> {
    let motions = walking().copied().zip(MOTIONS.iter().cloned());
    motions.map(|(gait, motion)| (gait, motion.clone(), Walk::even(gait, &motion, intervals).unwrap())).collect()
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn real_feet_in_support_stand_still_on_the_ground() {
    for (_, _, walk) in walks(40) {
        let d = walk.description;
        for (k, phase) in walk.phases.iter().enumerate() {
            let moments: Vec<_> = walk.moments.iter().filter(|m| m.phase == k).collect();
            for leg in 0..2 {
                for member in 0..d.legs[leg].members.len() {
                    let foot = |k: usize| *moments[k].chain(d, leg, member).last().unwrap();
                    let moved = (0..moments.len()).map(|k| distance(foot(k), foot(0))).fold(0.0, f64::max);
                    let height = (0..moments.len()).map(|k| foot(k)[1]).fold(0.0, f64::max);
                    if phase.mode == Mode::Stance(leg) {
                        assert!(moved < 1e-8 && height < 1e-8, "{}: foot slips by {moved}", d.gait);
                    } else {
                        assert!(moved > 0.01 && height > 0.003, "{}: foot does not swing", d.gait);
                    }
                }
            }
        }
    }
}

#[test]
fn a_virtual_foot_is_the_mean_of_its_real_feet_and_that_of_the_kernel() {
    for (_, _, walk) in walks(10) {
        let d = walk.description;
        for (m, swings) in walk.moments.iter().flat_map(|m| m.mode.swinging().map(move |leg| (m, leg))) {
            let foot = *m.virtual_chain(d, swings).last().unwrap();
            // The kernels of a planar gait do not know how far beside its plane a leg is.
            let known = if d.is_spatial() { foot } else { [foot[0], foot[1], m.feet[swings][2]] };
            assert!(distance(known, m.feet[swings]) < 1e-12, "{}", d.gait);
            let members = d.legs[swings].members.len();
            let feet = (0..members).map(|i| *m.chain(d, swings, i).last().unwrap());
            let mean = feet.fold([0.0; 3], |a, f| [0, 1, 2].map(|k| a[k] + f[k] / members as f64));
            assert!(distance(foot, mean) < 1e-12, "{}", d.gait);
        }
    }
}

#[test]
fn steps_follow_each_other_at_the_mean_speed() {
    for (_, motion, walk) in walks(10) {
        let d = walk.description;
        let (first, last) = (&walk.moments[0], &walk.moments[walk.moments.len() - 1]);
        let next = [first.platform[0][0] + walk.travel, first.platform[0][1], first.platform[0][2]];
        assert!(distance(last.platform[0], next) < 1e-7, "{}", d.gait);
        assert!((walk.travel / walk.duration() - SPEED).abs() < 1e-7, "{}", d.gait);
        for leg in 0..2 {
            for member in 0..d.legs[leg].members.len() {
                let (a, b) = (first.chain(d, leg, member), last.chain(d, leg, member));
                assert!(a.iter().zip(&b).all(|(a, b)| distance([a[0] + walk.travel, a[1], a[2]], *b) < 1e-7));
            }
        }
        // The impact between the phases changes velocities, not the configuration.
        let (before, after) = (&walk.moments[10], &walk.moments[11]);
        assert_eq!(before.time, after.time);
        assert!(distance(before.platform[0], after.platform[0]) < 1e-7, "{}", d.gait);
        assert!(before.q.iter().zip(&after.q).all(|(a, b)| (a - b).abs() < 1e-7), "{}", d.gait);
        assert_eq!(walk.phases[0].duration, motion.phases[0].duration);
    }
}

#[test]
fn velocities_and_accelerations_are_derivatives() {
    for (gait, motion, _) in walks(2) {
        let walk = Walk::even(gait, &motion, 2000).unwrap();
        for (index, phase) in walk.phases.iter().enumerate() {
            let moments: Vec<_> = walk.moments.iter().filter(|m| m.phase == index).collect();
            let dt = phase.duration / 2000.0;
            for k in (100..1900).step_by(300) {
                let [before, now, after] = [k - 1, k, k + 1].map(|k| moments[k]);
                let name = walk.description.gait;
                let check = |what: &str, a: f64, b: f64, now: f64| {
                    let slope = (b - a) / (2.0 * dt);
                    assert!((slope - now).abs() < 1e-4 * (1.0 + now.abs()), "{name}: {what}: {slope} is not {now}");
                };
                for axis in 0..3 {
                    for order in 0..2 {
                        let at = |m: &piaffe::walk::Moment| m.platform[order][axis];
                        check("platform", at(before), at(after), now.platform[order + 1][axis]);
                    }
                }
                for c in 0..now.q.len() {
                    check("rate", before.q[c], after.q[c], now.qd[c]);
                    check("acceleration", before.qd[c], after.qd[c], now.qdd[c]);
                }
            }
        }
    }
}

#[test]
fn the_criteria_are_the_integrals_over_the_walk() {
    for (gait, motion, _) in walks(2) {
        let walk = Walk::even(gait, &motion, 4000).unwrap();
        let receipt = verify(walk.description, &motion, SPEED, 2001).unwrap();
        let (mut energy, mut torque) = (0.0, 0.0);
        for pair in walk.moments.windows(2) {
            let dt = pair[1].time - pair[0].time;
            let of = |f: fn(f64, f64) -> f64, m: &piaffe::walk::Moment| -> f64 {
                m.torque.iter().zip(&m.qd).map(|(t, r)| f(*t, *r)).sum()
            };
            energy += 0.5 * dt * (of(|t, r| (t * r).abs(), &pair[0]) + of(|t, r| (t * r).abs(), &pair[1]));
            torque += 0.5 * dt * (of(|t, _| t * t, &pair[0]) + of(|t, _| t * t, &pair[1]));
        }
        assert!((energy / walk.travel / receipt.costs.energy - 1.0).abs() < 1e-5);
        assert!((torque / walk.travel / receipt.costs.torque - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_rate_samples_the_same_walk() {
    for (gait, motion, _) in walks(2) {
        let walk = Walk::at_rate(gait, &motion, 1000.0).unwrap();
        assert_eq!(walk.moments.len(), (walk.duration() * 1000.0).ceil() as usize);
        for (k, m) in walk.moments.iter().enumerate() {
            assert!((m.time - k as f64 / 1000.0).abs() < 1e-12);
        }
        let same = Walk::even(gait, &motion, 2).unwrap();
        assert_eq!(walk.moments[0].q, same.moments[0].q);
        assert_eq!(walk.moments[0].torque, same.moments[0].torque);
    }
}
