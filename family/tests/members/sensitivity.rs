//! Sensitivities in the parameters against differences between neighbouring robots.

use super::draws::{GENERAL, member};
use super::kernels::{assert_close, filled, vector};
use piaffe::model::family::{Family, Parametric};
use piaffe::model::shape::MomentumTerms;
use piaffe::model::{FORWARD, Mode, Transition, UP};
use piaffe_family::FAMILIES;

/// Of sums of outputs that are of order one or more.
const TOLERANCE: f64 = 1e-7;

/// Gradient of `value` in the parameters of `robot` by central differences.
fn differences(family: &Family, robot: &dyn Parametric, value: impl Fn(&dyn Parametric) -> f64) -> Vec<f64> {
    let at = |k: usize, h: f64| {
        let mut values = robot.parameters().to_vec();
        values[k] += h;
        value(&*(family.member)(&values).unwrap())
    };
    let slope = |k: usize| {
        // Inertias are small numbers.
        let h = 1e-4 * robot.parameters()[k].abs().max(1e-3);
        // Fourth order, so that rounding can be kept small.
        (8.0 * (at(k, h) - at(k, -h)) - (at(k, 2.0 * h) - at(k, -2.0 * h))) / (12.0 * h)
    };
    (0..robot.parameters().len()).map(slope).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// 5 random robots of every gait, each on both legs.
fn each(check: impl Fn(&Family, &dyn Parametric, usize, &mut fastrand::Rng)) {
    for family in FAMILIES {
        let mut rng = fastrand::Rng::with_seed(5);
        for k in 0..10 {
            let robot = member(family, &GENERAL, &mut rng);
            check(family, &*robot, k % 2, &mut rng);
        }
    }
}

#[test]
fn of_inverse_dynamics() {
    each(|family, robot, leg, rng| {
        let (d, mode) = (robot.description(), Mode::Stance(leg));
        let (n, joints, np) = (d.orientations(), d.joints(), d.positions());
        let (q, qd, qdd) = (vector(n, 0.8, rng), vector(n, 4.0, rng), vector(d.prescribed(), 30.0, rng));
        let shape = &d.shape(mode).inverse_jacobian;
        let jacobian = |m: &dyn Parametric| filled(shape.len, |o| m.inverse_jacobian(mode, &q, &qd, &qdd, o));
        let own = jacobian(robot);
        let mut all: Vec<f64> = (0..n - 1).map(|k| qdd[k]).collect();
        all.insert(d.unactuated, shape.beta_dd.value(&own));
        let rows = shape.gamma_w.each(&own).chain(shape.f_w.each(&own));
        let by_beta: Vec<f64> = rows.map(|row| row[2 * n + d.unactuated]).collect();
        let f1 = shape.balance_w.of(&own)[2 * n + d.unactuated];
        if f1.abs() < 0.05 {
            return; // eq. 10 is close to singular
        }
        // β̈ follows from the balance: its weight is the adjoint.
        let weights = vector(joints + np, 1.0, rng);
        let (mut gamma, phi) = (weights[..joints].to_vec(), &weights[joints..]);
        gamma.push(-dot(&weights, &by_beta) / f1);
        let by_lump = filled(robot.lumps().len(), |o| {
            robot.sensitivity(mode, &q, &qd, &all, &gamma, phi, &d.shape(mode).curvature.others.zeros(), o)
        });
        let value = |m: &dyn Parametric| {
            let own = jacobian(m);
            dot(&weights, &[shape.gamma.of(&own), shape.f.of(&own)].concat())
        };
        assert_close("Γ, F", &robot.pull_back(&by_lump), &differences(family, robot, value), TOLERANCE);
    });
}

#[test]
fn of_momentum_heights_and_velocities() {
    each(|family, robot, leg, rng| {
        let (d, mode) = (robot.description(), Mode::Stance(leg));
        let (n, np) = (d.orientations(), d.positions());
        let (q, qd) = (vector(n, 1.0, rng), vector(n, 5.0, rng));
        let s = d.shape(mode);
        let to = &s.curvature.others;
        let weights = vector(to.len, 1.0, rng);
        let (gamma, phi) = (vec![0.0; d.joints() + 1], vec![0.0; np]);
        let by_lump = filled(robot.lumps().len(), |o| {
            robot.sensitivity(mode, &q, &qd, &vec![0.0; n], &gamma, &phi, &weights, o);
        });
        let value = |m: &dyn Parametric| {
            let terms = filled(s.momentum_terms.len, |o| m.momentum_terms(mode, &q, &qd, o));
            let place = filled(s.placement.len, |o| m.placement(mode, &q, o));
            let velocity = filled(s.swing_velocity.len, |o| m.swing_velocity(mode, &q, &qd, o));
            let (platform, swing) = (s.placement.p.of(&place), s.placement.swing.of(&place));
            let weighted = [
                (to.sigma, s.momentum_terms.sigma.value(&terms)),
                (to.sigmad, s.momentum_terms.sigmadot.value(&terms)),
                (to.swing_height, swing[UP]),
                (to.platform_x, platform[FORWARD]),
                (to.swing_velocity, s.swing_velocity.v.of(&velocity)[UP]),
                (to.platform_height, platform[UP]),
            ];
            weighted.iter().map(|(weight, value)| weight.value(&weights) * value).sum()
        };
        let expected = differences(family, robot, value);
        assert_close("σ, σ̇, heights", &robot.pull_back(&by_lump), &expected, TOLERANCE);

        let weights = vector(3, 1.0, rng);
        let by_lump = filled(robot.lumps().len(), |o| robot.terms_sensitivity(mode, &q, &qd, &weights, o));
        let value = |m: &dyn Parametric| {
            let terms = filled(s.momentum_terms.len, |o| m.momentum_terms(mode, &q, &qd, o));
            let MomentumTerms { f1, f2, c, .. } = s.momentum_terms;
            dot(&weights, &[f1, f2, c].map(|block| block.value(&terms)))
        };
        assert_close("f1, f2, c", &robot.pull_back(&by_lump), &differences(family, robot, value), TOLERANCE);
    });
}

#[test]
fn of_touchdowns() {
    each(|family, robot, leg, rng| {
        let d = robot.description();
        let Transition::Touchdown(leg) = d.transition(leg % d.phases.len()) else { return };
        let (n, s) = (d.orientations(), &d.shapes.touchdown);
        let (q, qd) = (vector(n, 0.8, rng), vector(n, 3.0, rng));
        let weights = vector(n + d.shapes.touchdown_curvature.outputs.len, 1.0, rng);
        let (xi, outputs) = weights.split_at(n);
        let by_lump = filled(robot.lumps().len(), |o| robot.touchdown_sensitivity(leg, &q, &qd, xi, outputs, o));
        let value = |m: &dyn Parametric| {
            let results = filled(s.len, |o| m.touchdown(leg, &q, &qd, o));
            let values = [s.qd_plus, s.impulse, s.leaving, s.landing, s.couple, s.pitch];
            dot(&weights, &values.map(|block| block.of(&results)).concat())
        };
        assert_close("touchdown", &robot.pull_back(&by_lump), &differences(family, robot, value), TOLERANCE);
    });
}

#[test]
fn of_landings() {
    each(|family, robot, _, rng| {
        let d = robot.description();
        for leg in (0..d.phases.len())
            .filter_map(|k| if let Transition::Landing(leg) = d.transition(k) { Some(leg) } else { None })
        {
            let (n, s) = (d.orientations(), &d.shapes.landing);
            let (q, v, qd) = (vector(n, 0.8, rng), vector(d.positions(), 1.0, rng), vector(n, 3.0, rng));
            let weights = vector(n + d.shapes.landing_curvature.outputs.len, 1.0, rng);
            let (xi, outputs) = weights.split_at(n);
            let by_lump = filled(robot.lumps().len(), |o| robot.landing_sensitivity(leg, &q, &v, &qd, xi, outputs, o));
            let value = |m: &dyn Parametric| {
                let results = filled(s.len, |o| m.landing(leg, &q, &v, &qd, o));
                dot(&weights, &[s.qd_plus, s.impulse, s.landing].map(|block| block.of(&results)).concat())
            };
            assert_close("landing", &robot.pull_back(&by_lump), &differences(family, robot, value), TOLERANCE);
        }
    });
}

#[test]
fn of_takeoffs() {
    each(|family, robot, _, rng| {
        let d = robot.description();
        for leg in (0..d.phases.len())
            .filter_map(|k| if let Transition::TakeOff(leg) = d.transition(k) { Some(leg) } else { None })
        {
            let (n, s) = (d.orientations(), &d.shapes.takeoff);
            let (q, qd, qdd) = (vector(n, 0.8, rng), vector(n, 3.0, rng), vector(n, 30.0, rng));
            let weights = vector(d.shapes.takeoff_curvature.weights.len, 1.0, rng);
            let by_lump = filled(robot.lumps().len(), |o| robot.takeoff_sensitivity(leg, &q, &qd, &qdd, &weights, o));
            let value = |m: &dyn Parametric| {
                let results = filled(s.len, |o| m.takeoff(leg, &q, &qd, &qdd, o));
                dot(&weights, &[s.r, s.v, s.lift].map(|block| block.of(&results)).concat())
            };
            assert_close("take-off", &robot.pull_back(&by_lump), &differences(family, robot, value), TOLERANCE);
        }
    });
}
