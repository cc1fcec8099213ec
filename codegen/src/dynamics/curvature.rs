//! Second derivatives, contracted with multipliers: what an exact Hessian needs of the dynamics.
//!
//! A weighted sum of generalized forces is the virtual power of the motion's d'Alembert forces in a
//! virtual velocity: `Σ nₖ Qₖ + φ·F = Σ m (δv + φ)·(a + g) + δω·(Iω̇ + ω×Iω)`, δv linear in n. So one
//! scalar holds all rows, and it is small. n has a weight for the torque of every joint and one for
//! the balance of eq. 10: the platform's row where it turns, else a turn of the whole robot.

use super::kernel::Kernel;
use super::model::{Model, Origin, scaled};
use super::solve::Factors;
use super::turn::Turn;
use crate::expr::{Poly, Var, Vec3, add, cross, dot, subtract};
use crate::spec::Rotation;
use std::collections::BTreeMap;

/// Kernels of the Hessian for stance on `leg`, and for the impact on `leg`.
pub fn kernels(model: &mut Model, leg: usize, turn: &Turn) -> Vec<Kernel> {
    vec![instant(model, leg, turn), touchdown(model, leg)]
}

fn symbols(model: &mut Model, name: &str, count: usize) -> Vec<Var> {
    (0..count).map(|k| model.ring.symbol(format!("{name}{k}"))).collect()
}

/// The expression with every rate replaced by the symbol of its coordinate in `by`.
fn with_rates(model: &mut Model, v: &Vec3, by: &BTreeMap<Var, Poly>) -> Vec3 {
    [0, 1, 2].map(|i| model.ring.substitute(&v[i], by))
}

/// Virtual power of the generalized forces in the virtual rates `n`, and of the reaction in `phi`.
fn virtual_power(model: &mut Model, leg: usize, n: &[Var], phi: &[Var]) -> Poly {
    let rename: BTreeMap<Var, Poly> = model.q(1).into_iter().zip(n.iter().map(|v| Poly::from(*v))).collect();
    let mut translation = [Poly::zero(), Poly::zero(), Poly::zero()];
    for (slot, symbol) in translation.iter_mut().zip(phi) {
        *slot = (*symbol).into();
    }
    let mut power = Poly::zero();
    for (b, centre) in model.centres(Origin::Foot(leg)).iter().enumerate() {
        let body = model.kinematics.bodies[b].clone();
        let velocity = model.rate(centre);
        let mut acceleration = model.rate(&velocity);
        acceleration[1] += &model.quantities.gravity;
        let spin = model.kinematics.bodies[b].place.spin.clone();
        let mut virtual_velocity = add(&with_rates(model, &velocity, &rename), &translation);
        let mut virtual_spin = with_rates(model, &spin, &rename);
        if model.mechanism.rotation == Rotation::None
            && let Some(turn) = n.last()
        {
            let turn = Poly::from(*turn);
            virtual_velocity[0] = &virtual_velocity[0] - &(&turn * &centre[1]);
            virtual_velocity[1] += &(&turn * &centre[0]);
            virtual_spin[2] += &turn;
        }
        power += &(&dot(&virtual_velocity, &acceleration) * &body.mass);
        let angular = scaled(&spin, &body.inertia);
        let moment = add(&model.rate(&angular), &cross(&spin, &angular));
        power += &dot(&virtual_spin, &moment);
    }
    for (k, inertia) in model.quantities.rotor_inertia.iter().enumerate() {
        power += &(&(&Poly::from(n[k]) * &Poly::from(model.coordinates.q[k][2])) * inertia);
    }
    power
}

/// All outputs of an instant, each with its weight.
pub struct Instant {
    /// Weights of the torques of the joints, then of the balance.
    pub n: Vec<Var>,
    /// Weights of the reaction.
    pub phi: Vec<Var>,
    /// Weights of σ, σ̇, the swing foot's height, the platform's x, the swing foot's vertical velocity and the
    /// platform's height.
    pub others: Vec<Var>,
    pub sum: Poly,
}

impl Instant {
    pub fn new(model: &mut Model, leg: usize, turn: &Turn) -> Instant {
        let n = symbols(model, "n", model.mechanism.joints.len() + 1);
        let phi = symbols(model, "phi", model.mechanism.positions());
        let others = symbols(model, "w", 6);
        let mut sum = virtual_power(model, leg, &n, &phi);
        let swing = subtract(&model.foot(1 - leg), &model.foot(leg));
        let swing_rate = model.rate(&swing);
        let platform = model.foot(leg).map(|x| -&x);
        let terms = [&turn.sigma, &turn.gravity_moment, &swing[1], &platform[0], &swing_rate[1], &platform[1]];
        for (weight, term) in others.iter().zip(terms) {
            sum += &(&Poly::from(*weight) * term);
        }
        Instant { n, phi, others, sum }
    }
}

fn instant(model: &mut Model, leg: usize, turn: &Turn) -> Kernel {
    let Instant { n, phi, others, sum } = Instant::new(model, leg, turn);
    let kernel = Kernel::new(
        format!("curvature{}", leg + 1),
        "Gradient in (q, q̇, q̈) and second derivatives of the sum of all outputs of an instant, each with its weight: \
         torques of the joints, then the balance (n), reaction (phi), and σ, σ̇, swing foot's height, platform's x, swing foot's \
         vertical velocity, platform's height (others).",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("qdd", model.q(2))
    .input("n", n)
    .input("phi", phi)
    .input("others", others);
    second_derivatives(model, kernel, &sum)
}

/// Adds to a kernel the gradient in (q, q̇, q̈) and the second derivatives of a sum that is linear in q̈, with factors
/// that depend on q alone.
pub fn second_derivatives(model: &Model, kernel: Kernel, sum: &Poly) -> Kernel {
    let (q, qd, qdd) = (model.q(0), model.q(1), model.q(2));
    let gradient: Vec<Poly> = q.iter().chain(&qd).chain(&qdd).map(|s| model.ring.derivative(sum, *s)).collect();
    let (by_q, rest) = gradient.split_at(q.len());
    let by_qd = &rest[..q.len()];
    let (qq, q_qd, q_qdd) = (model.hessian(by_q, &q), model.jacobian(by_q, &qd), model.jacobian(by_q, &qdd));
    let qd_qd = model.hessian(by_qd, &qd);
    kernel
        .vector("gradient", gradient, "∂/∂(q, q̇, q̈)")
        .matrix("q_q", qq, "∂²/∂q∂q")
        .matrix("q_qd", q_qd, "∂²/∂q∂q̇")
        .matrix("q_qdd", q_qdd, "∂²/∂q∂q̈")
        .matrix("qd_qd", qd_qd, "∂²/∂q̇∂q̇")
}

/// A touchdown's results, each with its weight, and the adjoint of its linear system.
pub struct Landing {
    /// Weights of q̇⁺.
    pub xi: Vec<Var>,
    /// Weights of the other results.
    pub outputs: Vec<Var>,
    /// Symbols of q̇⁺.
    pub plus: Vec<Var>,
    /// A sum whose partial derivatives, with q̇⁺ and the adjoint held, are total ones of the weighted results.
    pub sum: Poly,
    /// q̇⁺ and the adjoint, to be inserted after differentiation.
    pub solution: BTreeMap<Var, Poly>,
}

impl Landing {
    pub fn new(model: &mut Model, leg: usize) -> Landing {
        let impact = super::impact::Touchdown::new(model, leg);
        let q = model.q(0);
        let xi = symbols(model, "xi", q.len());
        let outputs = symbols(model, "w", impact.outputs.len());
        let factors = Factors::new(&mut model.ring, &impact.inertia);
        let solution = factors.solve(&mut model.ring, &impact.before);
        let insert: BTreeMap<Var, Poly> = impact.plus.iter().copied().zip(solution).collect();

        let mut direct = Poly::zero();
        for (weight, output) in outputs.iter().zip(&impact.outputs) {
            direct += &(&Poly::from(*weight) * output);
        }
        // Aq ζ = ξ + ∂(weighted outputs)/∂q̇⁺
        let right: Vec<Poly> = xi
            .iter()
            .zip(&impact.plus)
            .map(|(x, plus)| {
                let through = model.ring.derivative(&direct, *plus);
                &Poly::from(*x) + &model.ring.substitute(&through, &insert)
            })
            .collect();
        let zeta = factors.solve(&mut model.ring, &right);
        let adjoint = symbols(model, "zeta", q.len());
        let solution = insert.into_iter().chain(adjoint.iter().copied().zip(zeta)).collect();
        let mut sum = direct;
        for (z, residual) in adjoint.iter().zip(&impact.residual) {
            sum += &(&Poly::from(*z) * residual);
        }
        Landing { xi, outputs, plus: impact.plus, sum, solution }
    }
}

/// Second derivatives of a touchdown's weighted results.
fn touchdown(model: &mut Model, leg: usize) -> Kernel {
    let (q, qd) = (model.q(0), model.q(1));
    let Landing { xi, outputs, plus, sum, solution } = Landing::new(model, leg);
    let by_q: Vec<Poly> = q.iter().map(|s| model.ring.derivative(&sum, *s)).collect();
    let raw = [model.hessian(&by_q, &q), model.jacobian(&by_q, &qd), model.jacobian(&by_q, &plus)];
    let mut insert = |rows: &Vec<Vec<Poly>>| -> Vec<Vec<Poly>> {
        rows.iter().map(|row| row.iter().map(|p| model.ring.substitute(p, &solution)).collect()).collect()
    };
    let [qq, q_qd, q_plus] = raw.each_ref().map(&mut insert);
    Kernel::new(
        format!("touchdown_curvature{}", leg + 1),
        "Second derivatives of a touchdown's results, weighted: q̇⁺ (xi), then impulse, leaving and landing velocity, \
         couple and pitch if there are any (outputs). With J = ∂q̇⁺/∂(q, q̇⁻), the Hessian in (q, q̇⁻) is [q_q, q_qd; ·, 0] + [q_plus; 0] J + its transpose.",
    )
    .input("q", q)
    .input("qd", qd)
    .input("xi", xi)
    .input("outputs", outputs)
    .matrix("q_q", qq, "∂²/∂q∂q")
    .matrix("q_qd", q_qd, "∂²/∂q∂q̇⁻")
    .matrix("q_plus", q_plus, "∂²/∂q∂q̇⁺")
}
