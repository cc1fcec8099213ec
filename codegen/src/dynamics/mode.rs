//! One mode of a gait: the model reduced to q (eq. 6), with what is known of its turn (eq. 8, 9), β̈ (eq. 10), forward and
//! inverse dynamics, and where the platform and the feet in the air are.
//!
//! In stance positions are measured from the foot, which is at rest: p drops out, the foot's reaction does no work, and the
//! generalized forces of q are the torques alone: `Aq q̈ + Hq = Dq Γ`. In flight they are measured from the mass centre, which
//! falls: p drops out again, there is neither weight nor reaction, and the same equations hold with
//! `Aq − M γ_qᵀ γ_q` for Aq, γ the mass centre from the platform's.

use super::kernel::Kernel;
use super::model::{Model, Origin};
use super::solve::Factors;
use super::turn::Turn;
use crate::expr::{Poly, Var, Vec3, subtract};
use crate::mechanism::Mode;
use crate::spec::Rotation;
use std::collections::BTreeMap;

/// The reduced model of one mode, as expressions.
pub struct Reduced<'t> {
    /// Generalized forces of q: linear in q̈.
    pub forces: Vec<Poly>,
    /// Aq (eq. 6).
    pub inertia: Vec<Vec<Poly>>,
    /// Hq (eq. 6).
    pub bias: Vec<Poly>,
    /// Reaction at the stance foot, N; in flight there is none.
    pub reaction: Vec<Poly>,
    pub turn: &'t Turn,
}

impl Reduced<'_> {
    pub fn new<'t>(model: &mut Model, mode: Mode, turn: &'t Turn) -> Reduced<'t> {
        let origin = Origin::from(mode);
        let q = model.coordinates.q.clone();
        let qdd = model.q(2);
        let forces = model.generalized_forces(origin, &q);
        let inertia = model.jacobian(&forces, &qdd);
        let bias = forces.iter().map(|f| model.without(f, &qdd)).collect();
        let reaction = match mode {
            Mode::Stance(_) => reaction(model, origin),
            Mode::Flight => Vec::new(),
        };
        Reduced { forces, inertia, bias, reaction, turn }
    }
}

/// Change of linear momentum, less the weight.
fn reaction(model: &mut Model, origin: Origin) -> Vec<Poly> {
    let moment = model.first_moment(origin);
    let momentum = model.rate(&moment);
    let mut force = model.rate(&momentum);
    force[1] += &(&model.total_mass() * &model.quantities.gravity);
    model.components(&force)
}

/// p of the platform from the origin of the mode, with its time derivatives; the second as seen from the ground.
fn platform_motion(model: &mut Model, mode: Mode) -> [Vec<Poly>; 3] {
    let p = model.place(mode.into()).map(|x| -&x);
    let v = model.rate(&p);
    let mut a = model.rate(&v);
    if mode == Mode::Flight {
        a[1] = &a[1] - &model.quantities.gravity;
    }
    [model.components(&p), model.components(&v), model.components(&a)]
}

/// Feet in the air from the origin of the mode, one after the other.
pub fn swinging(model: &mut Model, mode: Mode) -> Vec<Vec3> {
    let origin = model.place(mode.into());
    mode.swinging().map(|leg| subtract(&model.foot(leg), &origin)).collect()
}

pub fn kernels(model: &mut Model, mode: Mode, turn: &Turn) -> Vec<Kernel> {
    let reduced = Reduced::new(model, mode, turn);
    let (q, qd) = (model.q(0), model.q(1));
    let [position, velocity, acceleration] = platform_motion(model, mode);
    let mut kernels = vec![
        Kernel::of_mode(mode, "platform_velocity",
            mode.say(
                "ṗ with the stance foot at rest (eq. 3), m/s.",
                "Velocity of the platform's mass centre from the robot's, m/s.",
            ),
        )
        .input("q", q.clone())
        .input("qd", qd.clone())
        .vector("pd", velocity, "ṗ"),
        momentum_terms(model, &reduced, mode),
        Kernel::of_mode(mode, "reduced",
            "Reduced model of eq. 6: the rows of Aq q̈ + Hq are the torques of the joints and, where the platform turns, 0.",
        )
        .input("q", q.clone())
        .input("qd", qd.clone())
        .matrix("a", reduced.inertia.clone(), "Aq")
        .vector("h", reduced.bias.clone(), "Hq"),
    ];
    kernels.push(forward(model, &reduced, mode, &acceleration));
    kernels.push(inverse(model, &reduced, mode, &acceleration));
    kernels.push(momentum(model, &reduced, mode));
    kernels.push(inverse_with_jacobian(model, &reduced, mode));

    let swing = swinging(model, mode);
    let place: Vec<Poly> = swing.iter().flat_map(|foot| model.components(foot)).collect();
    let rates: Vec<Vec3> = swing.iter().map(|foot| model.rate(foot)).collect();
    let velocity: Vec<Poly> = rates.iter().flat_map(|rate| model.components(rate)).collect();
    kernels.push(
        Kernel::of_mode(
            mode,
            "placement",
            mode.say(
                "Platform's mass centre and swing foot from the stance foot, m, with Jacobians in q.",
                "Platform's mass centre and both feet from the robot's mass centre, m, with Jacobians in q.",
            ),
        )
        .input("q", q.clone())
        .vector("p", position.clone(), "platform's mass centre")
        .vector("swing", place.clone(), mode.say("swing foot", "foot 1, foot 2"))
        .matrix("p_q", model.jacobian(&position, &q), "∂p/∂q")
        .matrix("swing_q", model.jacobian(&place, &q), "∂swing/∂q"),
    );
    let by: Vec<Var> = q.iter().chain(&qd).copied().collect();
    kernels.push(
        Kernel::of_mode(
            mode,
            "swing_velocity",
            mode.say(
                "Velocity of the swing foot, m/s, with its Jacobian in (q, q̇).",
                "Velocities of both feet from the robot's mass centre, m/s, with their Jacobian in (q, q̇).",
            ),
        )
        .input("q", q)
        .input("qd", qd)
        .vector("v", velocity.clone(), "velocity")
        .matrix("v_w", model.jacobian(&velocity, &by), "∂v/∂(q, q̇)"),
    );
    kernels
}

fn momentum_terms(model: &mut Model, reduced: &Reduced, mode: Mode) -> Kernel {
    let turn = reduced.turn;
    let kernel = |doc: &str| {
        Kernel::of_mode(mode, "momentum_terms", doc)
            .input("q", model.q(0))
            .input("qd", model.q(1))
            .scalar("f1", turn.f1.clone(), "f1(q), kg·m²")
            .scalar("f2", turn.f2.clone(), "f2(q, Q̇), kg·m²/s")
            .scalar("sigma", turn.sigma.clone(), "σ, kg·m²/s")
    };
    match mode {
        Mode::Stance(_) => {
            kernel("Angular momentum about the stance foot S: σ = f1 β̇ + f2 (eq. 8), σ̇ (eq. 9) and its lever arm c.")
                .scalar("c", turn.c.clone(), "horizontal distance from S to the mass centre, m")
                .scalar("sigmadot", turn.gravity_moment.clone(), "moment of gravity about S, N·m")
        }
        Mode::Flight => kernel("Angular momentum about the mass centre: σ = f1 β̇ + f2. In flight it is constant."),
    }
}

/// σ and its gradient: where the integration of (β, σ) starts.
fn momentum(model: &mut Model, reduced: &Reduced, mode: Mode) -> Kernel {
    let (q, qd) = (model.q(0), model.q(1));
    let by: Vec<Var> = q.iter().chain(&qd).copied().collect();
    let gradient = model.jacobian(std::slice::from_ref(&reduced.turn.sigma), &by).remove(0);
    Kernel::of_mode(
        mode,
        "momentum",
        mode.say(
            "σ about the stance foot (eq. 8) and its gradient in (q, q̇).",
            "σ about the mass centre and its gradient in (q, q̇).",
        ),
    )
    .input("q", q)
    .input("qd", qd)
    .scalar("sigma", reduced.turn.sigma.clone(), "σ, kg·m²/s")
    .vector("sigma_w", gradient, "∂σ/∂(q, q̇)")
}

fn forward(model: &mut Model, reduced: &Reduced, mode: Mode, platform: &[Poly]) -> Kernel {
    let independent = model.mechanism.independent_torques();
    let torques: Vec<Var> = independent.iter().map(|j| model.ring.symbol(format!("gamma{}", j + 1))).collect();
    let mut right: Vec<Poly> = reduced.bias.iter().map(|bias| -bias).collect();
    for (joint, torque) in independent.iter().zip(&torques) {
        right[*joint] += &(*torque).into();
    }
    let beta = model.mechanism.unactuated;
    let level = model.mechanism.rotation == Rotation::None;
    let cancel = level && torques_cancel(model, reduced);
    if cancel {
        for (_, torque) in independent.iter().zip(&torques).filter(|(j, _)| model.mechanism.hangs_on_platform(**j)) {
            right[beta] = &right[beta] - &(*torque).into();
        }
    }
    let factors = Factors::new(&mut model.ring, &reduced.inertia);
    let mut solution = factors.solve(&mut model.ring, &right);
    if level && !cancel {
        solution = keep_level(model, reduced, &factors, &solution);
    }
    let map: BTreeMap<Var, Poly> = model.q(2).into_iter().zip(solution.iter().cloned()).collect();
    let mut xdd: Vec<Poly> = platform.iter().map(|a| model.ring.substitute(a, &map)).collect();
    xdd.extend(solution);
    let reaction = reduced.reaction.iter().map(|f| model.ring.substitute(f, &map)).collect();
    Kernel::of_mode(
        mode,
        "forward",
        mode.say(
            "Forward dynamics in single support: Ẍ and the reaction F from the independent torques Γ \
             (eq. 5 with eq. 4).",
            "Forward dynamics in flight: Ẍ from the independent torques Γ.",
        ),
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("gamma", torques)
    .vector("xdd", xdd, "Ẍ")
    .with_reaction(reaction)
}

/// Whether a level platform means that the torques on it cancel (eq. 1): so it does where both hips lie
/// at its mass centre and rotors weigh nothing. Then the balance is the sum of those joints' rows.
fn torques_cancel(model: &Model, reduced: &Reduced) -> bool {
    let mut rest = reduced.turn.balance.clone();
    for (joint, force) in reduced.forces.iter().enumerate() {
        if model.mechanism.hangs_on_platform(joint) {
            rest = &rest - force;
        }
    }
    rest.is_zero()
}

/// q̈ with the torque at β that keeps the platform level: the one with which the balance holds.
fn keep_level(model: &mut Model, reduced: &Reduced, factors: &Factors, torque_free: &[Poly]) -> Vec<Poly> {
    let mut unit = vec![Poly::zero(); torque_free.len()];
    unit[model.mechanism.unactuated] = Poly::constant(1.0);
    let response = factors.solve(&mut model.ring, &unit);
    let accelerations = model.q(2);
    let row = model.jacobian(std::slice::from_ref(&reduced.turn.balance), &accelerations).remove(0);
    let mut rest = model.without(&reduced.turn.balance, &accelerations);
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
fn free_acceleration(model: &mut Model, reduced: &Reduced) -> Poly {
    let beta = model.unactuated(2);
    let rest = model.without(&reduced.turn.balance, &[beta]);
    let rest = model.ring.bind(rest);
    let f1 = model.ring.bind(reduced.turn.f1.clone());
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

fn inverse(model: &mut Model, reduced: &Reduced, mode: Mode, platform: &[Poly]) -> Kernel {
    let beta = free_acceleration(model, reduced);
    let mut xdd: Vec<Poly> = platform.iter().map(|a| insert(model, a, &beta)).collect();
    xdd.extend(model.q(2).into_iter().map(|s| insert(model, &s.into(), &beta)).collect::<Vec<_>>());
    let joints = model.mechanism.joints.len();
    let torques = reduced.forces[..joints].iter().map(|f| insert(model, f, &beta)).collect();
    let reaction = reduced.reaction.iter().map(|f| insert(model, f, &beta)).collect();
    Kernel::of_mode(
        mode,
        "inverse",
        mode.say(
            "Inverse dynamics in single support: full Ẍ (β̈ by eq. 10), the torque of every joint and the \
             reaction, from Q̈.",
            "Inverse dynamics in flight: full Ẍ (β̈ by dσ/dt = 0) and the torque of every joint, from Q̈.",
        ),
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("actuated_dd", model.prescribed(2))
    .vector("xdd", xdd, "Ẍ")
    .vector("gamma", torques, "torque of every joint, N·m")
    .with_reaction(reaction)
    .batched()
}

/// What the optimizer evaluates at every instant: outputs and Jacobian, β̈ treated as independent.
///
/// The caller eliminates β̈ with the balance row: δβ̈ = −(∂balance/∂(q, q̇, Q̈))·δ / f1.
fn inverse_with_jacobian(model: &mut Model, reduced: &Reduced, mode: Mode) -> Kernel {
    let beta = free_acceleration(model, reduced);
    let map = BTreeMap::from([(model.unactuated(2), beta.clone())]);
    let joints = model.mechanism.joints.len();
    let outputs: Vec<Poly> =
        reduced.forces[..joints].iter().chain(&reduced.reaction).chain([&reduced.turn.balance]).cloned().collect();
    let by: Vec<Var> = [model.q(0), model.q(1), model.q(2)].concat();
    let mut jacobian: Vec<Vec<Poly>> = model
        .jacobian(&outputs, &by)
        .iter()
        .map(|row| row.iter().map(|p| model.ring.substitute(p, &map)).collect())
        .collect();
    let mut values: Vec<Poly> = outputs.iter().map(|p| model.ring.substitute(p, &map)).collect();
    values.pop();
    let reaction = values.split_off(joints);
    let balance_rows = jacobian.split_off(outputs.len() - 1);
    let reaction_rows = jacobian.split_off(joints);
    let stands = !reaction.is_empty();
    let kernel = Kernel::of_mode(mode, "inverse_jacobian",
        mode.say(
            "Inverse dynamics in single support with its Jacobian in w = (q, q̇, q̈), β̈ taken as an input of its own, and \
             that of the balance of eq. 10.",
            "Inverse dynamics in flight with its Jacobian in w = (q, q̇, q̈), β̈ taken as an input of its own, and that of \
             dσ/dt.",
        ),
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("actuated_dd", model.prescribed(2))
    .scalar("beta_dd", beta, "β̈, rad/s² (eq. 10)")
    .vector("gamma", values, "torque of every joint, N·m")
    .with_reaction(reaction)
    .matrix("gamma_w", jacobian, "∂Γ/∂w");
    let kernel = if stands { kernel.matrix("f_w", reaction_rows, "∂F/∂w") } else { kernel };
    kernel.matrix("balance_w", balance_rows, mode.say("∂balance/∂w", "∂(dσ/dt)/∂w"))
}

impl Kernel {
    /// With the reaction at the stance foot, if there is one.
    fn with_reaction(self, reaction: Vec<Poly>) -> Kernel {
        if reaction.is_empty() { self } else { self.vector("f", reaction, "reaction at the stance foot, N") }
    }
}
