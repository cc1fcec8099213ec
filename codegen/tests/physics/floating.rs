//! Laws of the floating model in X = [p, q] (eq. 2–5).

use super::common::Derived;
use super::numbers::{
    along, assert_close, difference, differences, dot, is_positive_definite, momentum, poses, product,
    transposed_product,
};
use super::state::State;
use piaffe_codegen::spec::Rotation;

/// Positions, energies and momenta against rigid bodies in plain numbers.
pub fn bodies(d: &Derived, s: &State) {
    let m = d.mechanism();
    let positions = m.positions();
    let (poses, feet) = poses(m, &s.x);
    let energy = d.run("energy", &[&s.x, &s.xd]);
    let height: f64 = m.bodies.iter().zip(&poses).map(|(b, p)| b.mass * p.com[1]).sum();
    assert_close("potential energy", energy.get("potential"), &[m.gravity * height], 1e-12);
    let rotors: f64 = m.joints.iter().zip(&s.qd).map(|(j, rate)| 0.5 * j.rotor_inertia * rate * rate).sum();
    let mass: f64 = m.bodies.iter().map(|b| b.mass).sum();
    let com: Vec<f64> = (0..positions)
        .map(|i| m.bodies.iter().zip(&poses).map(|(b, p)| b.mass * p.com[i]).sum::<f64>() / mass)
        .collect();
    let found = d.run("centre_of_mass", &[&s.x, &s.xd]);
    assert_close("mass centre", found.get("position"), &com, 1e-12);
    let rate = difference(|h| d.run("centre_of_mass", &[&along(&s.x, h, &s.xd), &s.xd]).get("position").to_vec());
    assert_close("velocity of the mass centre", found.get("velocity"), &rate, 1e-8);
    for (leg, place) in feet.iter().enumerate() {
        let foot = d.run(&format!("foot{}", leg + 1), &[&s.x]);
        assert_close("foot", foot.get("d"), &place[..positions], 1e-12);
        let (kinetic, sigma) = momentum(m, &s.x, &s.xd, *place);
        assert_close("kinetic energy", energy.get("kinetic"), &[kinetic + rotors], 1e-8);
        let axis = if m.rotation == Rotation::Roll { 0 } else { 2 };
        let found = d.run(&format!("angular_momentum{}", leg + 1), &[&s.x, &s.xd]);
        assert_close("angular momentum", found.get("sigma"), &[sigma[axis]], 1e-8);
    }
}

/// A is symmetric positive definite, T = ½ẊᵀAẊ, and H follows from A and V alone: Christoffel's form.
pub fn equations_of_motion(d: &Derived, s: &State) {
    let n = s.x.len();
    let positions = d.mechanism().positions();
    let inertia = |q: &[f64]| d.run("inertia", &[q]).get("a").to_vec();
    let energy = |x: &[f64], xd: &[f64]| d.run("energy", &[x, xd]);
    let a = inertia(&s.q);
    for i in 0..n {
        for j in 0..i {
            assert_eq!(a[i * n + j], a[j * n + i], "A is symmetric");
        }
    }
    assert!(is_positive_definite(&a, n), "A is positive definite");
    let momenta = product(&a, &s.xd);
    assert_close("T", &[0.5 * dot(&momenta, &s.xd)], energy(&s.x, &s.xd).get("kinetic"), 1e-12);

    let h = d.run("bias", &[&s.q, &s.qd]).get("h").to_vec();
    let together = d.run("inertia_and_bias", &[&s.q, &s.qd]);
    assert_eq!((together.get("a"), together.get("h")), (&a[..], &h[..]));
    let gravity = differences(&s.x, |x| energy(x, &s.xd).get("potential").to_vec());
    let slopes: Vec<Vec<f64>> = (0..n)
        .map(|k| match k.checked_sub(positions) {
            Some(k) => difference(|step| {
                let mut q = s.q.clone();
                q[k] += step;
                inertia(&q)
            }),
            None => vec![0.0; n * n],
        })
        .collect();
    let christoffel: Vec<f64> = (0..n)
        .map(|k| {
            let mut sum = gravity[k];
            for i in 0..n {
                for j in 0..n {
                    sum += (slopes[j][k * n + i] - 0.5 * slopes[k][i * n + j]) * s.xd[i] * s.xd[j];
                }
            }
            sum
        })
        .collect();
    assert_close("H", &h, &christoffel, 1e-8);

    // Along any motion the power of the generalized forces is the rate of the energy.
    let forces = along(&product(&a, &s.xdd), 1.0, &h);
    let rate = difference(|t| {
        let e = energy(&along(&along(&s.x, t, &s.xd), 0.5 * t * t, &s.xdd), &along(&s.xd, t, &s.xdd));
        vec![e.number("kinetic") + e.number("potential")]
    });
    assert_close("power", &[dot(&forces, &s.xd)], &rate, 1e-7);
}

/// D is the Jacobian of a foot, Hᵢ what its acceleration has beside DᵀẌ (eq. 3, 4).
pub fn feet(d: &Derived, s: &State) {
    for leg in 1..=2 {
        let foot = |x: &[f64]| d.run(&format!("foot{leg}"), &[x]).get("d").to_vec();
        let jacobian = |q: &[f64]| d.run(&format!("foot_jacobian{leg}"), &[q]).get("d").to_vec();
        let slopes = differences(&s.x, foot);
        let rows = s.x.len();
        let transposed: Vec<f64> = (0..rows).flat_map(|r| slopes.chunks(rows).map(move |row| row[r])).collect();
        assert_close("D", &jacobian(&s.q), &transposed, 1e-9);
        let velocity = |t: f64| {
            let x = along(&along(&s.x, t, &s.xd), 0.5 * t * t, &s.xdd);
            transposed_product(&jacobian(&x[d.mechanism().positions()..]), &along(&s.xd, t, &s.xdd))
        };
        let bias = d.run(&format!("foot_bias{leg}"), &[&s.q, &s.qd]).get("h").to_vec();
        let expected = along(&difference(velocity), -1.0, &transposed_product(&jacobian(&s.q), &s.xdd));
        assert_close("Hᵢ", &bias, &expected, 1e-7);
    }
}
