//! Newton–Euler in numbers, on descriptions computed at run time, against the compiled kernels.

use super::draws::{GENERAL, member};
use super::kernels::{assert_close, filled, vector};
use piaffe::model::{Gait, Mode};
use piaffe::verify::{impact::impact, instants::State, multibody::Multibody, support::Support};
use piaffe_family::FAMILIES;

const TOLERANCE: f64 = 1e-11;

/// Checks 30 random robots of every gait in `states` states each.
fn each(states: usize, check: impl Fn(&dyn Gait, &[f64], &[f64], Vec<f64>)) {
    for family in FAMILIES {
        let mut rng = fastrand::Rng::with_seed(3);
        for _ in 0..30 {
            let robot = member(family, &GENERAL, &mut rng);
            let n = robot.description().orientations();
            for _ in 0..states {
                let (q, qd) = (vector(n, 1.3, &mut rng), vector(n, 8.0, &mut rng));
                check(&*robot, &q, &qd, vector(n, 60.0, &mut rng));
            }
        }
    }
}

#[test]
fn floating_model_agrees() {
    each(4, |gait, q, qd, _| {
        let d = gait.description();
        let (np, n) = (d.positions(), d.positions() + d.orientations());
        let mut multibody = Multibody::new(d);
        multibody.set(q, qd, &vec![0.0; q.len()]);
        let (a, h) = (filled(n * n, |o| gait.inertia(q, o)), filled(n, |o| gait.bias(q, qd, o)));
        assert_close("A", &a, &filled(n * n, |o| multibody.inertia(o)), TOLERANCE);
        assert_close("H", &h, &filled(n, |o| multibody.bias(o)), TOLERANCE);
        for leg in 0..2 {
            let jacobian = filled(n * np, |o| gait.foot_jacobian(leg, q, o));
            assert_close("D", &jacobian, &filled(n * np, |o| multibody.foot_jacobian(leg, o)), TOLERANCE);
        }
    });
}

#[test]
fn single_support_agrees() {
    each(4, |gait, q, qd, mut qdd| {
        let d = gait.description();
        let (np, n, joints) = (d.positions(), d.positions() + d.orientations(), d.joints());
        let prescribed: Vec<f64> = (0..d.prescribed()).map(|k| qdd[d.prescribed_index(k)]).collect();
        for leg in 0..2 {
            if filled(5, |o| gait.momentum_terms(Mode::Stance(leg), q, qd, o))[0].abs() < 0.05 {
                continue; // close to where eq. 10 is singular, both are as inaccurate as they must be
            }
            let mut support = Support::new(d, leg);
            support.accelerate(q, qd, &mut qdd).unwrap();
            let mut torques = vec![0.0; joints];
            let force = support.torques(&qdd, &mut torques);
            let expected = [&qdd[..], &torques, &force.as_slice()[..np]].concat();
            let found = filled(n + joints + np, |o| gait.inverse(Mode::Stance(leg), q, qd, &prescribed, o));
            assert_close("β̈, Γ, F", &found[np..], &expected, TOLERANCE);

            let mut state = State { qdd: qdd.clone(), ..State::new(d) };
            support.complete(&mut state);
            let rows: Vec<f64> = d.lowest.iter().map(|point| state.heights[*point]).collect();
            let found = filled(rows.len() * (1 + q.len()), |o| gait.heights(Mode::Stance(leg), q, o));
            assert_close("heights", &found[..rows.len()], &rows, TOLERANCE);
            let least = |list: &[f64]| [list.iter().copied().fold(f64::INFINITY, f64::min)];
            assert_close("lowest", &least(&rows), &least(&state.heights), TOLERANCE);
        }
    });
}

#[test]
fn impact_agrees() {
    each(2, |gait, q, qd, _| {
        let d = gait.description();
        let (np, n) = (d.positions(), d.positions() + d.orientations());
        for landing in 0..2 {
            let expected = impact(d, landing, q, qd).unwrap();
            let found = filled(n + np, |o| gait.impact(landing, q, &expected.before, o));
            let numbers = [&expected.after[..], &expected.impulse.as_slice()[..np]].concat();
            assert_close("Ẋ⁺, I", &found, &numbers, 10.0 * TOLERANCE);
        }
    });
}
