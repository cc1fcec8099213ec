//! Second derivatives, contracted with multipliers: what an exact Hessian needs of the dynamics.
//!
//! A weighted sum of generalized forces is the virtual power of the motion's d'Alembert forces in a
//! virtual velocity: `Σ nₖ Qₖ + φ·F = Σ m (δv + φ)·(a + g) + δω·(Iω̇ + ω×Iω)`, δv linear in n. So one
//! scalar holds all rows, and it is small. n has a weight for the torque of every joint and one for
//! the balance of eq. 10: the platform's row where it turns, else a turn of the whole robot.

use super::kernel::{Block, Kernel};
use super::mode::swinging;
use super::model::{Model, Origin, scaled};
use super::turn::Turn;
use crate::expr::{Poly, Var, Vec3, add, cross, dot};
use crate::mechanism::Mode;
use crate::spec::Rotation;
use std::collections::BTreeMap;

/// `count` symbols of one name.
pub fn symbols(model: &mut Model, name: &str, count: usize) -> Vec<Var> {
    (0..count).map(|k| model.ring.symbol(format!("{name}{k}"))).collect()
}

/// The expression with every rate replaced by the symbol of its coordinate in `by`.
fn with_rates(model: &mut Model, v: &Vec3, by: &BTreeMap<Var, Poly>) -> Vec3 {
    [0, 1, 2].map(|i| model.ring.substitute(&v[i], by))
}

/// Virtual power of the generalized forces in the virtual rates `n`, and of the reaction in `phi`.
fn virtual_power(model: &mut Model, origin: Origin, n: &[Var], phi: &[Var]) -> Poly {
    let rename: BTreeMap<Var, Poly> = model.q(1).into_iter().zip(n.iter().map(|v| Poly::from(*v))).collect();
    let mut translation = [Poly::zero(), Poly::zero(), Poly::zero()];
    for (slot, symbol) in translation.iter_mut().zip(phi) {
        *slot = (*symbol).into();
    }
    let gravity = model.gravity(origin);
    let mut power = Poly::zero();
    for (b, centre) in model.centres(origin).iter().enumerate() {
        let body = model.kinematics.bodies[b].clone();
        let velocity = model.rate(centre);
        let mut acceleration = model.rate(&velocity);
        acceleration[1] += &gravity;
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
    /// Weights of the reaction; none in flight.
    pub phi: Vec<Var>,
    /// Weights of σ and σ̇, of the heights of the feet in the air, of the platform's x, of the vertical velocities of these feet,
    /// and of the platform's height. In flight there is no σ̇.
    pub others: Vec<Var>,
    /// What these are.
    pub blocks: Vec<Block>,
    pub sum: Poly,
}

impl Instant {
    pub fn new(model: &mut Model, mode: Mode, turn: &Turn) -> Instant {
        let stands = mode != Mode::Flight;
        let swing = swinging(model, mode);
        let n = symbols(model, "n", model.mechanism.joints.len() + 1);
        let phi = symbols(model, "phi", if stands { model.mechanism.positions() } else { 0 });
        let mut blocks = vec![Block::scalar("sigma")];
        blocks.extend(Some(Block::scalar("sigmad")).filter(|_| stands));
        blocks.extend([
            Block::vector("swing_height", swing.len()),
            Block::scalar("platform_x"),
            Block::vector("swing_velocity", swing.len()),
            Block::scalar("platform_height"),
        ]);
        let others = symbols(model, "w", Block::total(&blocks));
        let mut sum = virtual_power(model, mode.into(), &n, &phi);
        let rates: Vec<Vec3> = swing.iter().map(|foot| model.rate(foot)).collect();
        let platform = model.place(mode.into()).map(|x| -&x);
        let mut terms = vec![&turn.sigma];
        terms.extend(Some(&turn.gravity_moment).filter(|_| stands));
        terms.extend(swing.iter().map(|foot| &foot[1]));
        terms.push(&platform[0]);
        terms.extend(rates.iter().map(|rate| &rate[1]));
        terms.push(&platform[1]);
        for (weight, term) in others.iter().zip(terms) {
            sum += &(&Poly::from(*weight) * term);
        }
        Instant { n, phi, others, blocks, sum }
    }

    /// The kernel with the state and the weights as its inputs.
    pub fn inputs(&self, model: &Model, kernel: Kernel) -> Kernel {
        let kernel = kernel.input("q", model.q(0)).input("qd", model.q(1)).input("qdd", model.q(2));
        let kernel = kernel.blocks(
            "n",
            self.n.clone(),
            vec![Block::vector("torque", self.n.len() - 1), Block::scalar("balance")],
        );
        let kernel = kernel.input("phi", self.phi.clone());
        kernel.blocks("others", self.others.clone(), self.blocks.clone())
    }
}

/// The Hessian of an instant.
pub fn kernel(model: &mut Model, mode: Mode, turn: &Turn) -> Kernel {
    let instant = Instant::new(model, mode, turn);
    let weighted = match mode {
        Mode::Stance(_) => {
            "torques of the joints, then the balance (n), reaction (phi), and σ, σ̇, swing foot's height, platform's x, swing \
             foot's vertical velocity, platform's height (others)"
        }
        Mode::Flight => {
            "torques of the joints, then the balance (n), and σ, heights of the feet, platform's x, vertical velocities of the \
             feet, platform's height, all from the mass centre (others)"
        }
    };
    let kernel = Kernel::of_mode(
        mode,
        "curvature",
        format!(
            "Gradient in (q, q̇, q̈) and second derivatives of the sum of all outputs of an instant, each with its weight: \
             {weighted}."
        ),
    );
    let kernel = instant.inputs(model, kernel);
    second_derivatives(model, kernel, &instant.sum)
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
