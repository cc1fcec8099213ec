//! Laws of mechanics along motions and through impacts.

use crate::motions::{Random, gaits, stepping};
use nalgebra::Vector3;
use piaffe::model::{Description, Gait, Mode, Rotation};
use piaffe::verify::{Sample, impact::impact, multibody::Multibody, sample, support::Support};

pub const POINTS: usize = 1001;

/// Fourth-order central difference of samples `h` apart, at the third of five.
pub fn rate(f: [f64; 5], h: f64) -> f64 {
    (f[0] - 8.0 * f[1] + 8.0 * f[3] - f[4]) / (12.0 * h)
}

/// Calls `judge` with each five samples in a row of each phase.
fn along(gait: &dyn Gait, mut judge: impl FnMut(usize, [&Sample; 5], f64)) {
    let motion = stepping(gait.description());
    let samples = sample(gait.description(), &motion, POINTS).unwrap();
    for (leg, samples) in samples.chunks_exact(POINTS).enumerate() {
        for five in samples.windows(5).step_by(7) {
            judge(leg, [0, 1, 2, 3, 4].map(|i| &five[i]), samples[1].t);
        }
    }
}

fn energy(d: &Description, leg: usize, sample: &Sample) -> f64 {
    let mut multibody = Multibody::new(d);
    multibody.set(&sample.q, &sample.qd, &sample.qdd);
    let velocity = -multibody.foot(leg).velocity;
    let (kinetic, potential) = multibody.energy(&Vector3::from(sample.platform), &velocity, &sample.qd);
    kinetic + potential
}

#[test]
fn energy_changes_by_the_work_of_the_joints() {
    for gait in gaits() {
        let d = gait.description();
        along(gait, |leg, five, h| {
            let found = rate(five.map(|s| energy(d, leg, s)), h);
            let power: f64 = five[2].torques.iter().zip(&five[2].qd).map(|(torque, rate)| torque * rate).sum();
            assert!((found - power).abs() < 1e-6 * power.abs().max(10.0), "{}: {found} W instead of {power} W", d.gait);
        });
    }
}

#[test]
fn momentum_about_the_stance_foot_changes_by_gravity_alone() {
    for gait in gaits() {
        let mut terms = [0.0; 5];
        along(gait, |leg, five, h| {
            let sigma = five.map(|s| {
                gait.momentum_terms(Mode::Stance(leg), &s.q, &s.qd, &mut terms);
                terms[2]
            });
            gait.momentum_terms(Mode::Stance(leg), &five[2].q, &five[2].qd, &mut terms);
            let (found, moment) = (rate(sigma, h), terms[4]);
            // The verifier's own, which sensitivities are derived from.
            let (mut support, mut qdd) = (Support::new(gait.description(), leg), five[2].qdd.clone());
            support.accelerate(&five[2].q, &five[2].qd, &mut qdd).unwrap();
            for (own, kernel) in support.momentum().into_iter().zip([terms[2], moment]) {
                assert!(
                    (own - kernel).abs() < 1e-10 * kernel.abs().max(1.0),
                    "{}: {own} {kernel}",
                    gait.description().gait
                );
            }
            assert!(
                (found - moment).abs() < 1e-6 * moment.abs().max(1.0),
                "{}: {found} N·m instead of {moment} N·m",
                gait.description().gait
            );
        });
    }
}

#[test]
fn the_reaction_moves_the_mass_centre() {
    for gait in gaits() {
        let d = gait.description();
        let mut multibody = Multibody::new(d);
        let mut momentum = |leg: usize, s: &Sample| {
            multibody.set(&s.q, &s.qd, &s.qdd);
            let stance = multibody.foot(leg).velocity;
            let of = |(b, body): (usize, &piaffe::model::Body)| (multibody.com(b).velocity - stance) * body.mass;
            d.bodies.iter().enumerate().map(of).sum::<Vector3<f64>>()
        };
        along(gait, |leg, five, h| {
            let momenta = five.map(|s| momentum(leg, s));
            for axis in 0..d.positions() {
                let weight = if axis == 1 { d.total_mass() * d.gravity } else { 0.0 };
                let found = rate(momenta.map(|m| m[axis]), h) + weight;
                let force = five[2].force[axis];
                assert!(
                    (found - force).abs() < 1e-6 * force.abs().max(100.0),
                    "{}: {found} N instead of {force} N",
                    d.gait
                );
            }
        });
    }
}

#[test]
fn the_stance_foot_stays_and_torques_on_a_level_platform_cancel() {
    for gait in gaits() {
        let d = gait.description();
        let mut multibody = Multibody::new(d);
        along(gait, |leg, five, _| {
            let s = five[2];
            multibody.set(&s.q, &s.qd, &s.qdd);
            let apart = Vector3::from(s.platform) + multibody.foot(leg).position - Vector3::from(s.feet[leg]);
            assert!(apart.as_slice()[..d.positions()].iter().all(|x| x.abs() < 1e-12), "{apart}");
            if d.rotation == Rotation::None {
                assert!((s.torques[0] + s.torques[2]).abs() < 1e-9, "eq. 1: {:?}", s.torques);
            }
        });
    }
}

#[test]
fn an_impact_loses_energy_and_keeps_momentum() {
    for gait in gaits() {
        let d = gait.description();
        let (np, n) = (d.positions(), d.positions() + d.orientations());
        let mut random = Random::new(3);
        let mut multibody = Multibody::new(d);
        for _ in 0..50 {
            let (q, qd) = (random.list(d.orientations(), 1.2), random.list(d.orientations(), 8.0));
            let result = impact(d, 1, &q, &qd).unwrap();
            let mut velocity_change = Vector3::zeros();
            let mut kinetic = [0.0; 2];
            for (k, xd) in [&result.before, &result.after].into_iter().enumerate() {
                assert_eq!(xd.len(), n);
                multibody.set(&q, &xd[np..], &vec![0.0; q.len()]);
                let mut platform = Vector3::zeros();
                platform.as_mut_slice()[..np].copy_from_slice(&xd[..np]);
                kinetic[k] = multibody.energy(&Vector3::zeros(), &platform, &xd[np..]).0;
                let sign = if k == 0 { -1.0 } else { 1.0 };
                for (b, body) in d.bodies.iter().enumerate() {
                    velocity_change += (platform + multibody.com(b).velocity) * (sign * body.mass);
                }
                if k == 1 {
                    let landed = platform + multibody.foot(1).velocity;
                    assert!(landed.norm() < 1e-11, "the landing foot still moves at {landed}");
                    assert!((platform + multibody.foot(0).velocity - result.leaving).norm() < 1e-11);
                }
            }
            assert!(kinetic[1] <= kinetic[0] * (1.0 + 1e-12), "{}: {kinetic:?} J", d.gait);
            assert!((velocity_change - result.impulse).norm() < 1e-10 * result.impulse.norm().max(1.0));
        }
    }
}
