//! Laws of flight, along motions that fly: the mass centre falls, nothing turns the robot about it, joints alone do work.

use crate::motions::stepping;
use crate::physics::{POINTS, rate};
use nalgebra::Vector3;
use piaffe::gaits::GAITS;
use piaffe::model::{Description, Gait, Mode};
use piaffe::verify::{Sample, multibody::Multibody, sample};

fn gaits() -> impl Iterator<Item = &'static dyn Gait> {
    GAITS.iter().copied().filter(|gait| gait.description().flies())
}

/// Place of the mass centre, and the angular momentum about it.
fn centre(d: &Description, s: &Sample) -> (Vector3<f64>, f64) {
    let mut multibody = Multibody::new(d);
    multibody.set(&s.q, &s.qd, &s.qdd);
    let centre = multibody.centre();
    let about = |(b, body): (usize, &piaffe::model::Body)| {
        let (arm, velocity) =
            (multibody.com(b).position - centre.position, multibody.com(b).velocity - centre.velocity);
        (arm.cross(&velocity) * body.mass).z + multibody.spin_momentum(b, multibody.spin(b)).z
    };
    (Vector3::from(s.platform) + centre.position, d.bodies.iter().enumerate().map(about).sum())
}

/// Calls `judge` with each five samples in a row of every flight.
fn in_flight(gait: &dyn Gait, mut judge: impl FnMut(&Description, [&Sample; 5], f64)) {
    let d = gait.description();
    let samples = sample(d, &stepping(d), POINTS).unwrap();
    for (phase, samples) in d.phases.iter().zip(samples.chunks_exact(POINTS)) {
        if phase.mode == Mode::Flight {
            for five in samples.windows(5).step_by(7) {
                judge(d, [0, 1, 2, 3, 4].map(|i| &five[i]), samples[1].t);
            }
        }
    }
}

#[test]
fn the_mass_centre_falls_and_keeps_its_momentum() {
    for gait in gaits() {
        in_flight(gait, |d, five, h| {
            let now = five.map(|s| centre(d, s));
            // Second differences of fourth order.
            let second = |f: [f64; 5]| (-f[0] + 16.0 * f[1] - 30.0 * f[2] + 16.0 * f[3] - f[4]) / (12.0 * h * h);
            let [x, y] = [0, 1].map(|axis| second(now.map(|(place, _)| place[axis])));
            assert!(x.abs() < 1e-4 * d.gravity && (y + d.gravity).abs() < 1e-4 * d.gravity, "{}: {x} {y}", d.gait);
            let turned = rate(now.map(|(_, sigma)| sigma), h);
            assert!(turned.abs() < 1e-6, "{}: {turned} N·m about the mass centre", d.gait);
            assert_eq!(five[2].force, [0.0; 3]);
        });
    }
}

#[test]
fn energy_changes_by_the_work_of_the_joints_in_flight() {
    for gait in gaits() {
        let d = gait.description();
        let samples = sample(d, &stepping(d), POINTS).unwrap();
        for (phase, samples) in
            d.phases.iter().zip(samples.chunks_exact(POINTS)).filter(|(p, _)| p.mode == Mode::Flight)
        {
            let h = samples[1].t;
            let velocity = |k: usize, axis: usize| rate([0, 1, 2, 3, 4].map(|i| samples[k + i - 2].platform[axis]), h);
            let energy = |k: usize| {
                let s = &samples[k];
                let mut multibody = Multibody::new(d);
                multibody.set(&s.q, &s.qd, &s.qdd);
                let moves = Vector3::new(velocity(k, 0), velocity(k, 1), 0.0);
                let (kinetic, potential) = multibody.energy(&Vector3::from(s.platform), &moves, &s.qd);
                kinetic + potential
            };
            for k in (4..POINTS - 4).step_by(37) {
                let found = rate([0, 1, 2, 3, 4].map(|i| energy(k + i - 2)), h);
                let power: f64 =
                    samples[k].torques.iter().zip(&samples[k].qd).map(|(torque, rate)| torque * rate).sum();
                assert!(
                    (found - power).abs() < 1e-5 * power.abs().max(10.0),
                    "{} {phase:?}: {found} W, {power} W",
                    d.gait
                );
            }
        }
    }
}
