//! Newton–Euler in numbers against the generated kernels: two derivations, one physics.

use crate::motions::{Random, stepping};
use piaffe::gaits::{GAITS, amble::Amble, trot::Trot};
use piaffe::model::{Body, Gait, Mode, other_leg};
use piaffe::verify::geometry::{Plane, Space};
use piaffe::verify::{VerifyError, impact::impact, instants::State, multibody::Multibody, numbers::Numbers};
use piaffe::verify::{support::Support, verify};

const TOLERANCE: f64 = 1e-11;

fn compare(what: &str, gait: &dyn Gait, numeric: &[f64], generated: &[f64]) {
    assert_eq!(numeric.len(), generated.len(), "{what}");
    let scale = generated.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (a, b) in numeric.iter().zip(generated) {
        assert!(
            (a - b).abs() <= TOLERANCE * scale,
            "{what} of the {}: {numeric:?} instead of {generated:?}",
            gait.description().key
        );
    }
}

fn filled(n: usize, fill: impl FnOnce(&mut [f64])) -> Vec<f64> {
    let mut out = vec![0.0; n];
    fill(&mut out);
    out
}

/// Ordinary postures at ordinary rates.
fn states(gait: &dyn Gait) -> Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> {
    let n = gait.description().orientations();
    let mut random = Random::new(7);
    (0..50).map(|_| (random.list(n, 1.3), random.list(n, 8.0), random.list(n, 60.0))).collect()
}

#[test]
fn floating_model_agrees() {
    for gait in GAITS.iter().copied() {
        let d = gait.description();
        let (np, nq) = (d.positions(), d.orientations());
        let n = np + nq;
        let mut multibody = Multibody::new(d);
        for (q, qd, _) in states(gait) {
            multibody.set(&q, &qd, &vec![0.0; nq]);
            compare("A", gait, &filled(n * n, |o| multibody.inertia(o)), &filled(n * n, |o| gait.inertia(&q, o)));
            compare("H", gait, &filled(n, |o| multibody.bias(o)), &filled(n, |o| gait.bias(&q, &qd, o)));
            let x = [vec![0.0; np], q.clone()].concat();
            for leg in 0..2 {
                let foot = multibody.foot(leg);
                compare("d", gait, &foot.position.as_slice()[..np], &filled(np, |o| gait.foot(leg, &x, o)));
                let jacobian = filled(n * np, |o| multibody.foot_jacobian(leg, o));
                compare("D", gait, &jacobian, &filled(n * np, |o| gait.foot_jacobian(leg, &q, o)));
                compare(
                    "Hi",
                    gait,
                    &foot.acceleration.as_slice()[..np],
                    &filled(np, |o| gait.foot_bias(leg, &q, &qd, o)),
                );
            }
        }
    }
}

#[test]
fn energy_agrees() {
    for gait in GAITS.iter().copied() {
        let d = gait.description();
        let np = d.positions();
        let mut multibody = Multibody::new(d);
        for (q, qd, extra) in states(gait) {
            multibody.set(&q, &qd, &vec![0.0; q.len()]);
            let mut p = nalgebra::Vector3::zeros();
            let mut pd = p;
            p.as_mut_slice()[..np].copy_from_slice(&extra[..np]);
            pd.as_mut_slice()[..np].copy_from_slice(&extra[1..=np]);
            let (kinetic, potential) = multibody.energy(&p, &pd, &qd);
            let (x, xd) = ([&extra[..np], &q[..]].concat(), [&extra[1..=np], &qd[..]].concat());
            compare("energy", gait, &[kinetic, potential], &filled(2, |o| gait.energy(&x, &xd, o)));
        }
    }
}

#[test]
fn single_support_agrees() {
    for gait in GAITS.iter().copied() {
        let d = gait.description();
        let (np, nq, joints) = (d.positions(), d.orientations(), d.joints());
        for leg in 0..2 {
            let mut support = Support::new(d, leg);
            for (q, qd, mut qdd) in states(gait) {
                let prescribed: Vec<f64> = (0..d.prescribed()).map(|k| qdd[d.prescribed_index(k)]).collect();
                let generated =
                    filled(np + nq + joints + np, |o| gait.inverse(Mode::Stance(leg), &q, &qd, &prescribed, o));
                let f1 = filled(5, |o| gait.momentum_terms(Mode::Stance(leg), &q, &qd, o))[0];
                if f1.abs() < 0.05 {
                    continue; // close to where eq. 10 is singular, both are as inaccurate as they must be
                }
                support.accelerate(&q, &qd, &mut qdd).unwrap();
                let mut torques = vec![0.0; joints];
                let force = support.torques(&qdd, &mut torques);
                let numeric = [&qdd[..], &torques, &force.as_slice()[..np]].concat();
                compare("β̈, Γ, F", gait, &numeric, &generated[np..]);
            }
        }
    }
}

/// What stays in the plane is the same in either geometry, to the bit.
#[test]
fn plane_and_space_agree() {
    let sagittal: Vec<_> = GAITS.iter().filter(|gait| Plane::holds(gait.description())).collect();
    assert!(sagittal.len() >= 2 && sagittal.len() < GAITS.len());
    for gait in sagittal {
        let d = gait.description();
        for leg in 0..2 {
            let mut plane: Support<f64, Plane> = Support::with(d, Numbers::new(d), leg);
            let mut space: Support<f64, Space> = Support::with(d, Numbers::new(d), leg);
            for (q, qd, qdd) in states(*gait) {
                let [mut flat, mut solid] = [(); 2].map(|()| State::<f64> { qdd: qdd.clone(), ..State::new(d) });
                let accelerations = [
                    plane.accelerate(&q, &qd, &mut flat.qdd).unwrap(),
                    space.accelerate(&q, &qd, &mut solid.qdd).unwrap(),
                ];
                assert_eq!(accelerations[0], accelerations[1], "{}", d.key);
                plane.complete(&mut flat);
                space.complete(&mut solid);
                assert_eq!(flat.torques, solid.torques, "{}", d.key);
                let vectors =
                    |s: &State| [s.force, s.platform, s.feet[0], s.feet[1], s.feet_velocity[0], s.feet_velocity[1]];
                assert_eq!(vectors(&flat), vectors(&solid), "{}", d.key);
            }
        }
    }
}

#[test]
fn a_vanishing_f1_is_found() {
    // Without mass nothing determines β̈.
    let mut d = Trot.description().clone();
    let massless = d.bodies.iter().map(|body| Body { mass: 0.0, inertia: [[0.0; 3]; 3], ..body.clone() });
    d.bodies = massless.collect();
    assert_eq!(Support::new(&d, 0).accelerate(&[0.1, -0.5, 0.2, -0.7], &[1.0; 4], &mut [0.0; 4]), None);
    assert!(matches!(verify(&d, &stepping(&d), 0.3, 11), Err(VerifyError::Blowup { phase: 1, time: 0.0 })));
}

/// Where the legs exchange their roles the robot is its own mirror image, whatever the axes of its joints.
#[test]
fn exchanged_roles_are_mirror_images() {
    let mut d = Amble.description().clone();
    let abducting = d.bodies.iter().map(|b| Body { axis: if b.parent == Some(0) { 0 } else { b.axis }, ..b.clone() });
    d.bodies = abducting.collect();
    let (np, nq) = (d.positions(), d.orientations());
    let n = np + nq;
    let image = |i: usize| match i.checked_sub(np) {
        Some(k) => {
            let (from, sign) = d.swapped(k);
            (np + from, sign)
        }
        None => (i, if i == 2 { -1.0 } else { 1.0 }),
    };
    let mut multibody = Multibody::new(&d);
    for (q, ..) in states(&Amble) {
        let exchanged: Vec<f64> = (0..nq).map(|k| d.swapped(k).1 * q[d.swapped(k).0]).collect();
        let mut inertia = |q: &[f64]| {
            multibody.set(q, &vec![0.0; nq], &vec![0.0; nq]);
            filled(n * n, |o| multibody.inertia(o))
        };
        let (a, b) = (inertia(&q), inertia(&exchanged));
        let back = (0..n * n).map(|e| {
            let ((i, s), (j, t)) = (image(e / n), image(e % n));
            s * t * a[i * n + j]
        });
        compare("A of the mirror image", &Amble, &back.collect::<Vec<_>>(), &b);
    }
}

#[test]
fn impact_agrees() {
    for gait in GAITS.iter().copied() {
        let d = gait.description();
        let (np, n) = (d.positions(), d.positions() + d.orientations());
        for (q, qd, _) in states(gait) {
            for landing in 0..2 {
                let numeric = impact(d, landing, &q, &qd).unwrap();
                let generated = filled(n + np, |o| gait.impact(landing, &q, &numeric.before, o));
                // The velocities before are those with the stance foot at rest.
                let before = filled(np, |o| gait.platform_velocity(Mode::Stance(other_leg(landing)), &q, &qd, o));
                compare("Ẋ⁻", gait, &numeric.before[..np], &before);
                compare("Ẋ⁺, I", gait, &[&numeric.after[..], &numeric.impulse.as_slice()[..np]].concat(), &generated);
            }
        }
    }
}
