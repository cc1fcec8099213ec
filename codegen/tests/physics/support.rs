//! Laws of single support: the reduced model (eq. 6), angular momentum (eq. 8, 9), inverse and forward dynamics.

use super::common::Derived;
use super::numbers::{
    along, assert_close, assert_within, difference, dot, is_positive_definite, product, transposed_product,
};
use super::state::State;
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::spec::Rotation;

/// The entries of a vector over q that are prescribed.
pub fn prescribed(m: &Mechanism, q: &[f64]) -> Vec<f64> {
    m.prescribed().iter().map(|k| q[*k]).collect()
}

/// [ṗ, q̇] with the foot of `leg` at rest.
pub fn with_foot_at_rest(d: &Derived, leg: usize, s: &State) -> Vec<f64> {
    let mut xd = d.run(&format!("platform_velocity{}", leg + 1), &[&s.q, &s.qd]).get("pd").to_vec();
    xd.extend_from_slice(&s.qd);
    xd
}

/// σ = f1 β̇ + f2 is the angular momentum about the foot, σ̇ the moment of gravity.
pub fn momenta(d: &Derived, s: &State, leg: usize) {
    let m = d.mechanism();
    let name = |what: &str| format!("{what}{}", leg + 1);
    let xd = with_foot_at_rest(d, leg, s);
    let jacobian = d.run(&name("foot_jacobian"), &[&s.q]);
    assert_close("foot at rest", &transposed_product(jacobian.get("d"), &xd), &vec![0.0; m.positions()], 1e-12);

    let reduced = d.run(&name("reduced"), &[&s.q, &s.qd]);
    assert!(is_positive_definite(reduced.get("a"), s.q.len()), "Aq is positive definite");
    let kinetic = 0.5 * dot(&product(reduced.get("a"), &s.qd), &s.qd);
    assert_close("½q̇ᵀAq q̇", &[kinetic], d.run("energy", &[&s.x, &xd]).get("kinetic"), 1e-11);

    let terms = |q: &[f64], qd: &[f64]| d.run(&name("momentum_terms"), &[q, qd]);
    let now = terms(&s.q, &s.qd);
    let sigma = now.number("f1") * s.qd[m.unactuated] + now.number("f2");
    assert_close("f1 β̇ + f2", &[sigma], now.get("sigma"), 1e-12);
    assert_close("σ", now.get("sigma"), d.run(&name("angular_momentum"), &[&s.x, &xd]).get("sigma"), 1e-11);
    let mut other = s.qd.clone();
    other[m.unactuated] += 1.0;
    let then = terms(&s.q, &other);
    assert_eq!((then.get("f1"), then.get("f2")), (now.get("f1"), now.get("f2")), "f1 and f2 do not depend on β̇");
    let mut positions = d.run("centre_of_mass", &[&s.x, &xd]).get("position").to_vec();
    positions = along(&positions, -1.0, d.run(&name("foot"), &[&s.x]).get("d"));
    let (c, sign) = if m.rotation == Rotation::Roll { (positions[2], 1.0) } else { (positions[0], -1.0) };
    assert_close("c", now.get("c"), &[c], 1e-12);
    assert_close("σ̇", now.get("sigmadot"), &[sign * m.total_mass() * m.gravity * c], 1e-11);
}

/// Inverse dynamics against the floating model, then forward dynamics back (eq. 5 with 4; eq. 10).
///
/// `turning` is the same robot with a platform that pitches: where the gait keeps it level, the
/// balance of its rotation must hold with no moment other than the joints' (eq. 1).
pub fn dynamics(d: &Derived, turning: Option<&Derived>, s: &State, leg: usize) {
    let m = d.mechanism();
    let positions = m.positions();
    let name = |what: &str| format!("{what}{}", leg + 1);
    let terms = d.run(&name("momentum_terms"), &[&s.q, &s.qd]);
    if terms.number("f1").abs() < 0.05 {
        return; // β does not move the robot's angular momentum here: nothing balances.
    }
    let inverse = d.run(&name("inverse"), &[&s.q, &s.qd, &prescribed(m, &s.qdd)]);
    let (xdd, gamma, f) = (inverse.get("xdd"), inverse.get("gamma"), inverse.get("f"));
    assert_eq!(prescribed(m, &xdd[positions..]), prescribed(m, &s.qdd));
    let xd = with_foot_at_rest(d, leg, s);
    let jacobian = d.run(&name("foot_jacobian"), &[&s.q]).get("d").to_vec();
    let foot = along(&transposed_product(&jacobian, xdd), 1.0, d.run(&name("foot_bias"), &[&s.q, &s.qd]).get("h"));
    assert_within("acceleration of the foot", &foot, &vec![0.0; positions], 1e-10, largest(xdd));

    // Eq. 5: A Ẍ + H = D_G Γ + D F, the platform's rotation without torque.
    let residual = |d: &Derived, tail: &[f64]| -> Vec<f64> {
        let extend = |v: &[f64]| [v, tail].concat();
        let q = extend(&s.q);
        let h = d.run("bias", &[&q, &extend(&s.qd)]).get("h").to_vec();
        let left = along(&product(d.run("inertia", &[&q]).get("a"), &extend(xdd)), 1.0, &h);
        let jacobian = d.run(&name("foot_jacobian"), &[&q]).get("d").to_vec();
        let mut rest = along(&left, -1.0, &product(&jacobian, f));
        for (row, torque) in rest[positions..].iter_mut().zip(gamma) {
            *row -= torque;
        }
        rest
    };
    let size = largest(f).max(largest(gamma)).max(1.0);
    let rest = residual(d, &[]);
    assert_within("A Ẍ + H − D_G Γ − D F", &rest, &vec![0.0; rest.len()], 1e-10, size);
    if let Some(turning) = turning {
        let rest = residual(turning, &[0.0]);
        assert_within("moment on the level platform", &rest, &vec![0.0; rest.len()], 1e-10, size);
    }

    // σ̇ along this motion; its rates are those of the state, not of the stance, only through q.
    let sigma = |t: f64| {
        let q = along(&along(&s.q, t, &s.qd), 0.5 * t * t, &xdd[positions..]);
        d.run(&name("momentum_terms"), &[&q, &along(&s.qd, t, &xdd[positions..])]).get("sigma").to_vec()
    };
    assert_close("dσ/dt", &difference(sigma), terms.get("sigmadot"), 1e-6);

    let independent: Vec<f64> = m.independent_torques().iter().map(|j| gamma[*j]).collect();
    let forward = d.run(&name("forward"), &[&s.q, &s.qd, &independent]);
    assert_close("forward ∘ inverse: Ẍ", forward.get("xdd"), xdd, 1e-8);
    assert_close("forward ∘ inverse: F", forward.get("f"), f, 1e-8);
    // A torque-free law that holds at any speed: the power of Γ is the rate of the energy.
    let h = d.run("bias", &[&s.q, &s.qd]).get("h").to_vec();
    let force = along(&product(d.run("inertia", &[&s.q]).get("a"), xdd), 1.0, &h);
    assert_within("power of the torques", &[dot(&force, &xd)], &[dot(gamma, &s.qd[..m.joints.len()])], 1e-9, size);
}

pub fn largest(v: &[f64]) -> f64 {
    v.iter().fold(1.0f64, |s, x| s.max(x.abs()))
}
