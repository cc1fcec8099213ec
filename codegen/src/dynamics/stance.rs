//! Single support on one leg: the model reduced to q by the stance foot at rest (eq. 6), with what is known of its
//! turn (eq. 8, 9), β̈ (eq. 10), forward and inverse dynamics.
//!
//! With positions measured from the stance foot, p drops out; its reaction does no work there, so
//! the generalized forces of q are the torques alone: `Aq q̈ + Hq = Dq Γ`.

use super::kernel::Kernel;
use super::model::{Model, Origin};
use super::solve::Factors;
use super::turn::Turn;
use crate::expr::{Poly, Var, subtract};
use crate::spec::Rotation;
use std::collections::BTreeMap;

/// The reduced model of one stance leg, as expressions.
pub struct Stance<'t> {
    /// Generalized forces of q: linear in q̈.
    pub forces: Vec<Poly>,
    /// Aq (eq. 6).
    pub inertia: Vec<Vec<Poly>>,
    /// Hq (eq. 6).
    pub bias: Vec<Poly>,
    /// Reaction at the stance foot, N.
    pub reaction: Vec<Poly>,
    pub turn: &'t Turn,
}

impl Stance<'_> {
    pub fn new<'t>(model: &mut Model, leg: usize, turn: &'t Turn) -> Stance<'t> {
        let origin = Origin::Foot(leg);
        let q = model.coordinates.q.clone();
        let qdd = model.q(2);
        let forces = model.generalized_forces(origin, &q);
        let inertia = model.jacobian(&forces, &qdd);
        let bias = forces.iter().map(|f| model.without(f, &qdd)).collect();
        // Change of linear momentum, less the weight.
        let moment = model.first_moment(origin);
        let momentum = model.rate(&moment);
        let mut force = model.rate(&momentum);
        force[1] += &(&model.total_mass() * &model.quantities.gravity);
        let reaction = model.components(&force);
        Stance { forces, inertia, bias, reaction, turn }
    }
}

/// p of the platform when the stance foot is at the origin, with its time derivatives up to `order`.
fn platform_motion(model: &mut Model, leg: usize) -> [Vec<Poly>; 3] {
    let p = model.foot(leg).map(|x| -&x);
    let v = model.rate(&p);
    let a = model.rate(&v);
    [model.components(&p), model.components(&v), model.components(&a)]
}

pub fn kernels(model: &mut Model, leg: usize, turn: &Turn) -> Vec<Kernel> {
    let stance = Stance::new(model, leg, turn);
    let name = |what: &str| format!("{what}{}", leg + 1);
    let (q, qd) = (model.q(0), model.q(1));
    let [position, velocity, acceleration] = platform_motion(model, leg);
    let mut kernels = vec![
        Kernel::new(name("platform_velocity"), "ṗ with the stance foot at rest (eq. 3), m/s.")
            .input("q", q.clone())
            .input("qd", qd.clone())
            .vector("pd", velocity, "ṗ"),
        Kernel::new(name("momentum_terms"), "Angular momentum about the stance foot S: σ = f1 β̇ + f2 (eq. 8), σ̇ (eq. 9) and its lever arm c.")
            .input("q", q.clone())
            .input("qd", qd.clone())
            .scalar("f1", stance.turn.f1.clone(), "f1(q), kg·m²")
            .scalar("f2", stance.turn.f2.clone(), "f2(q, Q̇), kg·m²/s")
            .scalar("sigma", stance.turn.sigma.clone(), "σ, kg·m²/s")
            .scalar("c", stance.turn.c.clone(), "horizontal distance from S to the mass centre, m")
            .scalar("sigmadot", stance.turn.gravity_moment.clone(), "moment of gravity about S, N·m"),
        Kernel::new(name("reduced"), "Reduced model of eq. 6: the rows of Aq q̈ + Hq are the torques of the joints and, where the platform turns, 0.")
            .input("q", q.clone())
            .input("qd", qd.clone())
            .matrix("a", stance.inertia.clone(), "Aq")
            .vector("h", stance.bias.clone(), "Hq"),
    ];
    kernels.push(forward(model, &stance, leg, &acceleration));
    kernels.push(inverse(model, &stance, leg, &acceleration));
    kernels.push(momentum(model, &stance, leg));
    kernels.push(inverse_with_jacobian(model, &stance, leg));

    let swing = subtract(&model.foot(1 - leg), &model.foot(leg));
    let swing_position = model.components(&swing);
    let swing_rate = model.rate(&swing);
    let swing_velocity = model.components(&swing_rate);
    kernels.push(
        Kernel::new(
            name("placement"),
            "Platform's mass centre and swing foot from the stance foot, m, with Jacobians in q.",
        )
        .input("q", q.clone())
        .vector("p", position.clone(), "platform's mass centre")
        .vector("swing", swing_position.clone(), "swing foot")
        .matrix("p_q", model.jacobian(&position, &q), "∂p/∂q")
        .matrix("swing_q", model.jacobian(&swing_position, &q), "∂swing/∂q"),
    );
    let by: Vec<Var> = q.iter().chain(&qd).copied().collect();
    kernels.push(
        Kernel::new(name("swing_velocity"), "Velocity of the swing foot, m/s, with its Jacobian in (q, q̇).")
            .input("q", q)
            .input("qd", qd)
            .vector("v", swing_velocity.clone(), "velocity")
            .matrix("v_w", model.jacobian(&swing_velocity, &by), "∂v/∂(q, q̇)"),
    );
    kernels
}

/// σ and its gradient: where the integration of (β, σ) starts.
fn momentum(model: &mut Model, stance: &Stance, leg: usize) -> Kernel {
    let (q, qd) = (model.q(0), model.q(1));
    let by: Vec<Var> = q.iter().chain(&qd).copied().collect();
    let gradient = model.jacobian(std::slice::from_ref(&stance.turn.sigma), &by).remove(0);
    Kernel::new(format!("momentum{}", leg + 1), "σ about the stance foot (eq. 8) and its gradient in (q, q̇).")
        .input("q", q)
        .input("qd", qd)
        .scalar("sigma", stance.turn.sigma.clone(), "σ, kg·m²/s")
        .vector("sigma_w", gradient, "∂σ/∂(q, q̇)")
}

fn forward(model: &mut Model, stance: &Stance, leg: usize, platform: &[Poly]) -> Kernel {
    let independent = model.mechanism.independent_torques();
    let torques: Vec<Var> = independent.iter().map(|j| model.ring.symbol(format!("gamma{}", j + 1))).collect();
    let mut right: Vec<Poly> = stance.bias.iter().map(|bias| -bias).collect();
    for (joint, torque) in independent.iter().zip(&torques) {
        right[*joint] += &(*torque).into();
    }
    let beta = model.mechanism.unactuated;
    let level = model.mechanism.rotation == Rotation::None;
    let cancel = level && torques_cancel(model, stance);
    if cancel {
        for (_, torque) in independent.iter().zip(&torques).filter(|(j, _)| model.mechanism.hangs_on_platform(**j)) {
            right[beta] = &right[beta] - &(*torque).into();
        }
    }
    let factors = Factors::new(&mut model.ring, &stance.inertia);
    let mut solution = factors.solve(&mut model.ring, &right);
    if level && !cancel {
        solution = keep_level(model, stance, &factors, &solution);
    }
    let map: BTreeMap<Var, Poly> = model.q(2).into_iter().zip(solution.iter().cloned()).collect();
    let mut xdd: Vec<Poly> = platform.iter().map(|a| model.ring.substitute(a, &map)).collect();
    xdd.extend(solution);
    let reaction = stance.reaction.iter().map(|f| model.ring.substitute(f, &map)).collect();
    Kernel::new(
        format!("forward{}", leg + 1),
        "Forward dynamics in single support: Ẍ and the reaction F from the independent torques Γ (eq. 5 with eq. 4).",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("gamma", torques)
    .vector("xdd", xdd, "Ẍ")
    .vector("f", reaction, "reaction at the stance foot, N")
}

/// Whether a level platform means that the torques on it cancel (eq. 1): so it does where both hips lie
/// at its mass centre and rotors weigh nothing. Then the balance is the sum of those joints' rows.
fn torques_cancel(model: &Model, stance: &Stance) -> bool {
    let mut rest = stance.turn.balance.clone();
    for (joint, force) in stance.forces.iter().enumerate() {
        if model.mechanism.hangs_on_platform(joint) {
            rest = &rest - force;
        }
    }
    rest.is_zero()
}

/// q̈ with the torque at β that keeps the platform level: the one with which the balance holds.
fn keep_level(model: &mut Model, stance: &Stance, factors: &Factors, torque_free: &[Poly]) -> Vec<Poly> {
    let mut unit = vec![Poly::zero(); torque_free.len()];
    unit[model.mechanism.unactuated] = Poly::constant(1.0);
    let response = factors.solve(&mut model.ring, &unit);
    let accelerations = model.q(2);
    let row = model.jacobian(std::slice::from_ref(&stance.turn.balance), &accelerations).remove(0);
    let mut rest = model.without(&stance.turn.balance, &accelerations);
    let mut share = Poly::zero();
    for ((b, y), w) in row.iter().zip(torque_free).zip(&response) {
        rest += &(b * y);
        share += &(b * w);
    }
    let (rest, share) = (model.ring.bind(rest), model.ring.bind(share));
    let over_share = model.ring.reciprocal(share);
    let torque = model.ring.bind(-&(&rest * &over_share));
    torque_free.iter().zip(&response).map(|(y, w)| model.ring.bind(y + &(w * &torque))).collect()
}

/// β̈ as a bound atom (eq. 10): the balance is linear in it.
fn free_acceleration(model: &mut Model, stance: &Stance) -> Poly {
    let beta = model.unactuated(2);
    let rest = model.without(&stance.turn.balance, &[beta]);
    let rest = model.ring.bind(rest);
    let f1 = model.ring.bind(stance.turn.f1.clone());
    let over_f1 = model.ring.reciprocal(f1);
    model.ring.bind(-&(&rest * &over_f1))
}

/// An expression, linear in β̈, with a value for it: what remains without β̈, and β̈ times its factor. The
/// balance that gives β̈ consists of the same remainders and factors.
fn insert(model: &mut Model, p: &Poly, beta: &Poly) -> Poly {
    let symbol = model.unactuated(2);
    let factor = model.ring.derivative(p, symbol);
    &model.without(p, &[symbol]) + &(&factor * beta)
}

fn inverse(model: &mut Model, stance: &Stance, leg: usize, platform: &[Poly]) -> Kernel {
    let beta = free_acceleration(model, stance);
    let mut xdd: Vec<Poly> = platform.iter().map(|a| insert(model, a, &beta)).collect();
    xdd.extend(model.q(2).into_iter().map(|s| insert(model, &s.into(), &beta)).collect::<Vec<_>>());
    let joints = model.mechanism.joints.len();
    let torques = stance.forces[..joints].iter().map(|f| insert(model, f, &beta)).collect();
    let reaction = stance.reaction.iter().map(|f| insert(model, f, &beta)).collect();
    Kernel::new(
        format!("inverse{}", leg + 1),
        "Inverse dynamics in single support: full Ẍ (β̈ by eq. 10), the torque of every joint and the reaction, from Q̈.",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("actuated_dd", model.prescribed(2))
    .vector("xdd", xdd, "Ẍ")
    .vector("gamma", torques, "torque of every joint, N·m")
    .vector("f", reaction, "reaction at the stance foot, N")
    .batched()
}

/// What the optimizer evaluates at every instant: outputs and Jacobian, β̈ treated as independent.
///
/// The caller eliminates β̈ with the balance row: δβ̈ = −(∂balance/∂(q, q̇, Q̈))·δ / f1.
fn inverse_with_jacobian(model: &mut Model, stance: &Stance, leg: usize) -> Kernel {
    let beta = free_acceleration(model, stance);
    let map = BTreeMap::from([(model.unactuated(2), beta.clone())]);
    let joints = model.mechanism.joints.len();
    let outputs: Vec<Poly> =
        stance.forces[..joints].iter().chain(&stance.reaction).chain([&stance.turn.balance]).cloned().collect();
    let by: Vec<Var> = [model.q(0), model.q(1), model.q(2)].concat();
    let jacobian: Vec<Vec<Poly>> = model
        .jacobian(&outputs, &by)
        .iter()
        .map(|row| row.iter().map(|p| model.ring.substitute(p, &map)).collect())
        .collect();
    let mut values: Vec<Poly> = outputs.iter().map(|p| model.ring.substitute(p, &map)).collect();
    values.pop();
    let reaction = values.split_off(joints);
    Kernel::new(
        format!("inverse_jacobian{}", leg + 1),
        "Inverse dynamics in single support with its Jacobian in (q, q̇, q̈), β̈ taken as an input of its own: \
         rows are the torques of all joints, the reaction, and the balance of eq. 10.",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("actuated_dd", model.prescribed(2))
    .scalar("beta_dd", beta, "β̈, rad/s² (eq. 10)")
    .vector("gamma", values, "torque of every joint, N·m")
    .vector("f", reaction, "reaction at the stance foot, N")
    .matrix("jacobian", jacobian, "∂(Γ, F, balance)/∂(q, q̇, q̈)")
}
