//! Transitions between modes. A foot lands in a passive impact (eq. 12), while the other one leaves or out of flight; a foot that
//! leaves into flight changes nothing at that instant. Beside them eq. 11, with both feet at rest.
//!
//! A landing foot j that comes to rest takes an impulse that does no work in motions with foot j at
//! rest. In those, the generalized momenta before and after are equal: `Aq⁽ʲ⁾ q̇⁺ = P⁽ʲ⁾(Ẋ⁻)`.

use super::curvature::{second_derivatives, symbols};
use super::kernel::{Block, Input, Kernel};
use super::model::{Model, Origin, scaled};
use super::sharing;
use super::solve::Factors;
use crate::expr::{Poly, Var, Vec3, subtract, zero};
use crate::mechanism::Transition;
use crate::spec::Rotation;
use std::collections::BTreeMap;

/// Momenta conjugate to motions about foot `landing`, of velocities with the platform at `pd`.
fn momenta_before(model: &mut Model, landing: usize, platform_velocity: &Vec3) -> Vec<Poly> {
    let q = model.coordinates.q.clone();
    let about: Vec<Vec3> = model.centres(Origin::Foot(landing));
    let mut momenta = vec![Poly::zero(); q.len()];
    for (b, centre) in about.iter().enumerate() {
        let relative = model.kinematics.bodies[b].place.com.clone();
        let mut velocity = model.rate(&relative);
        for (v, p) in velocity.iter_mut().zip(platform_velocity) {
            *v += p;
        }
        let spin = model.kinematics.bodies[b].place.spin.clone();
        let body = model.kinematics.bodies[b].clone();
        let angular = scaled(&spin, &body.inertia);
        for (sum, [x, xd, _]) in momenta.iter_mut().zip(&q) {
            for i in 0..3 {
                *sum += &(&(&model.ring.derivative(&centre[i], *x) * &velocity[i]) * &body.mass);
                *sum += &(&model.ring.derivative(&spin[i], *xd) * &angular[i]);
            }
        }
    }
    for (k, inertia) in model.quantities.rotor_inertia.iter().enumerate() {
        momenta[k] += &(&Poly::from(q[k][1]) * inertia);
    }
    momenta
}

fn platform_rate(model: &Model) -> Vec3 {
    let mut v = [Poly::zero(), Poly::zero(), Poly::zero()];
    for (slot, symbol) in v.iter_mut().zip(&model.coordinates.p) {
        *slot = symbol[1].into();
    }
    v
}

/// Inertia of motions about foot `leg`.
fn inertia_about(model: &mut Model, leg: usize) -> Vec<Vec<Poly>> {
    let q = model.coordinates.q.clone();
    let momenta = model.momenta(Origin::Foot(leg), &q);
    let rates = model.q(1);
    model.jacobian(&momenta, &rates)
}

/// Impulse on the feet in all: the change of linear momentum.
fn impulse(model: &mut Model, landing: usize, before: &Vec3, after: &BTreeMap<Var, Poly>) -> Vec<Poly> {
    let moment = model.first_moment(Origin::Foot(landing));
    let rate = model.rate(&moment);
    let after: Vec<Poly> = model.components(&rate).iter().map(|v| model.ring.substitute(v, after)).collect();
    after.iter().zip(before).map(|(a, b)| a - b).collect()
}

/// Linear momentum of the robot when the platform moves at `platform`.
fn linear_momentum(model: &mut Model, platform: &Vec3) -> Vec3 {
    let mass = model.total_mass();
    let shift = model.platform().map(|x| &x * &mass);
    let relative = subtract(&model.first_moment(Origin::World), &shift);
    let rate = model.rate(&relative);
    [0, 1, 2].map(|i| &rate[i] + &(&platform[i] * &mass))
}

fn with_platform(model: &mut Model, landing: usize, solution: &[Poly]) -> (BTreeMap<Var, Poly>, Vec<Poly>) {
    let map: BTreeMap<Var, Poly> = model.q(1).into_iter().zip(solution.iter().cloned()).collect();
    let p = model.foot(landing).map(|x| -&x);
    let rate = model.rate(&p);
    let mut xd: Vec<Poly> = model.components(&rate).iter().map(|v| model.ring.substitute(v, &map)).collect();
    xd.extend(solution.iter().cloned());
    (map, xd)
}

/// What a transition does, with its Jacobian.
pub fn kernel(model: &mut Model, transition: Transition) -> Kernel {
    match transition.lands() {
        Some(leg) => landing(model, transition, leg),
        None => TakeOff::new(model, transition).kernel(model, transition),
    }
}

/// Second derivatives of what it does, each with its weight.
pub fn curvature(model: &mut Model, transition: Transition) -> Kernel {
    match transition.lands() {
        Some(leg) => landing_curvature(model, transition, leg),
        None => {
            let (weights, sum) = TakeOff::new(model, transition).weighted(model);
            let kernel = Kernel::of_transition(
                transition,
                "_curvature",
                "Gradient in (q, q̇, q̈) and second derivatives of a take-off's results, weighted: r, v, lift.",
            )
            .input("q", model.q(0))
            .input("qd", model.q(1))
            .input("qdd", model.q(2))
            .inputs(vec![weights]);
            second_derivatives(model, kernel, &sum)
        }
    }
}

/// The impact on foot `leg` whatever moved before.
pub fn impact(model: &mut Model, leg: usize) -> Kernel {
    let platform = platform_rate(model);
    let momenta = momenta_before(model, leg, &platform);
    let inertia = inertia_about(model, leg);
    let factors = Factors::new(&mut model.ring, &inertia);
    let solution = factors.solve(&mut model.ring, &momenta);
    let (map, xd) = with_platform(model, leg, &solution);
    let before = linear_momentum(model, &platform);
    let impulse = impulse(model, leg, &before, &map);
    Kernel::of_leg(
        leg,
        "impact",
        "Passive impact on this foot, the other one free (eq. 12): velocities after, and the impulse.",
    )
    .input("q", model.q(0))
    .input("xd", model.x(1))
    .vector("xd_plus", xd, "Ẋ⁺")
    .vector("impulse", impulse, "impulse on this foot, N·s")
}

/// The impact on one foot at the end of a mode, with the velocities after as symbols, so that what depends on them can be
/// differentiated by parts.
struct Impact {
    /// Velocities before that are given.
    given: Given,
    /// Aq about the landing foot.
    inertia: Vec<Vec<Poly>>,
    /// Momenta before.
    before: Vec<Poly>,
    /// Symbols of q̇⁺.
    plus: Vec<Var>,
    /// Momenta before minus after: zero.
    residual: Vec<Poly>,
    /// Impulse, vertical velocity after of the foot that leaves, if one does, of the landing foot before; where the platform rolls
    /// also how real feet share (see `sharing::landing`).
    outputs: Vec<Poly>,
    /// What these are.
    blocks: Vec<Block>,
}

/// Velocities before an impact: q̇⁻ after single support, which knows all others by it; after a flight that of the mass centre
/// besides.
struct Given {
    centre: Vec<Var>,
    rates: Vec<Var>,
}

impl Given {
    fn new(model: &mut Model, transition: Transition) -> Given {
        let components = if transition.leaves().is_some() { 0 } else { model.mechanism.positions() };
        Given { centre: symbols(model, "v", components), rates: model.q(1) }
    }

    fn symbols(&self) -> Vec<Var> {
        [&self.centre[..], &self.rates].concat()
    }

    /// As inputs of a kernel.
    fn inputs(self) -> Vec<Input> {
        let centre = (!self.centre.is_empty()).then(|| Input::new("v", self.centre));
        centre.into_iter().chain([Input::new("qd", self.rates)]).collect()
    }

    /// Velocity of the platform.
    fn platform(&self, model: &mut Model, transition: Transition) -> Vec3 {
        let origin = transition.leaves().map_or(Origin::MassCentre, Origin::Foot);
        let p = model.place(origin).map(|x| -&x);
        let mut velocity = model.rate(&p);
        for (component, centre) in velocity.iter_mut().zip(&self.centre) {
            *component += &(*centre).into();
        }
        velocity
    }
}

impl Impact {
    fn new(model: &mut Model, transition: Transition, leg: usize) -> Impact {
        let qd = model.q(1);
        let given = Given::new(model, transition);
        let platform = given.platform(model, transition);
        let before = momenta_before(model, leg, &platform);
        let inertia = inertia_about(model, leg);
        let plus = symbols(model, "plus", qd.len());
        let rename: BTreeMap<Var, Poly> = qd.iter().copied().zip(plus.iter().map(|v| Poly::from(*v))).collect();
        let coordinates = model.coordinates.q.clone();
        let momenta = model.momenta(Origin::Foot(leg), &coordinates);
        let after: Vec<Poly> = momenta.iter().map(|m| model.ring.substitute(m, &rename)).collect();
        let residual = before.iter().zip(&after).map(|(b, a)| b - a).collect();
        let momentum_before = linear_momentum(model, &platform);
        let mut outputs = impulse(model, leg, &momentum_before, &rename);
        let mut blocks = vec![Block::vector("impulse", outputs.len())];
        if let Some(stance) = transition.leaves() {
            let leaving = subtract(&model.foot(stance), &model.foot(leg));
            let leaving_rate = model.rate(&leaving);
            outputs.push(model.ring.substitute(&leaving_rate[1], &rename));
            blocks.push(Block::scalar("leaving"));
        }
        let place = model.foot(leg);
        let landing = match transition.leaves() {
            Some(stance) => model.rate(&subtract(&place, &model.foot(stance)))[1].clone(),
            None => &platform[1] + &model.rate(&place)[1],
        };
        outputs.push(landing);
        blocks.push(Block::scalar("landing"));
        if model.mechanism.rotation == Rotation::Roll {
            outputs.extend(sharing::landing(model, leg, &platform, &rename));
            blocks.extend([Block::vector("couple", 2), Block::scalar("pitch")]);
        }
        Impact { given, inertia, before, plus, residual, outputs, blocks }
    }
}

/// The impact at the end of a mode, with its Jacobian in q and the velocities before.
fn landing(model: &mut Model, transition: Transition, leg: usize) -> Kernel {
    let q = model.q(0);
    let Impact { given, inertia, before, plus, residual, outputs, .. } = Impact::new(model, transition, leg);
    let by: Vec<Var> = q.iter().copied().chain(given.symbols()).collect();
    let factors = Factors::new(&mut model.ring, &inertia);
    let solution = factors.solve(&mut model.ring, &before);
    let insert: BTreeMap<Var, Poly> = plus.iter().copied().zip(solution.iter().cloned()).collect();
    let partial = model.jacobian(&residual, &by);
    // Aq ∂q̇⁺/∂w = ∂(P⁻ − Aq q̇⁺)/∂w with q̇⁺ held.
    let mut columns: Vec<Vec<Poly>> = Vec::new();
    for w in 0..by.len() {
        let right: Vec<Poly> = partial.iter().map(|row| model.ring.substitute(&row[w], &insert)).collect();
        columns.push(factors.solve(&mut model.ring, &right));
    }

    let direct = model.jacobian(&outputs, &by);
    let through = model.jacobian(&outputs, &plus);
    let mut jacobian: Vec<Vec<Poly>> =
        (0..q.len()).map(|k| columns.iter().map(|column| column[k].clone()).collect()).collect();
    for (direct, through) in direct.iter().zip(&through) {
        let row = (0..by.len())
            .map(|w| {
                let mut total = model.ring.substitute(&direct[w], &insert);
                for (k, partial) in through.iter().enumerate() {
                    let partial = model.ring.substitute(partial, &insert);
                    total += &(&partial * &columns[w][k]);
                }
                total
            })
            .collect();
        jacobian.push(row);
    }
    let mut values: Vec<Poly> = outputs.iter().map(|p| model.ring.substitute(p, &insert)).collect();
    let leaves = transition.leaves().is_some();
    let mut couple = values.split_off(model.mechanism.positions() + 1 + usize::from(leaves));
    let landing_velocity = values.pop().unwrap_or_default();
    let leaving_velocity = if leaves { values.pop() } else { None };
    let mut rows = jacobian.into_iter();
    let mut rows = |count: usize| rows.by_ref().take(count).collect::<Vec<_>>();
    let doc = if leaves {
        "Impact on this foot at the end of single support on the other (eq. 12), with its Jacobian in w = (q, q̇⁻)."
    } else {
        "Impact on this foot at the end of a flight (eq. 12), with its Jacobian in w = (q, v⁻, q̇⁻), v the mass centre's velocity."
    };
    let components = values.len();
    let mut kernel = Kernel::of_transition(transition, "", doc)
        .input("q", q.clone())
        .inputs(given.inputs())
        .vector("qd_plus", solution, "q̇⁺, before the legs swap names")
        .vector("impulse", values, "impulse on the landing foot, N·s");
    if let Some(leaving) = leaving_velocity {
        kernel = kernel.scalar("leaving", leaving, "vertical velocity of the leaving foot after, m/s");
    }
    kernel = kernel
        .scalar("landing", landing_velocity, "vertical velocity of the landing foot before, m/s")
        .matrix("qd_plus_w", rows(q.len()), "∂q̇⁺/∂w")
        .matrix("impulse_w", rows(components), "∂impulse/∂w");
    if leaves {
        kernel = kernel.matrix("leaving_w", rows(1), "∂leaving/∂w");
    }
    kernel = kernel.matrix("landing_w", rows(1), "∂landing/∂w");
    let Some(pitch) = couple.pop() else { return kernel };
    let components = couple.len();
    kernel
        .vector(
            "couple",
            couple,
            "half the difference of the real feet's impulses times their distance, y and z, N·m·s",
        )
        .scalar("pitch", pitch, "change of the angular momentum about the platform's transverse axis, N·m·s")
        .matrix("couple_w", rows(components), "∂couple/∂w")
        .matrix("pitch_w", rows(1), "∂pitch/∂w")
}

/// An impact's results, each with its weight, and the adjoint of its linear system.
struct WeightedImpact {
    given: Given,
    /// Weights of q̇⁺.
    xi: Vec<Var>,
    /// Weights of the other results.
    outputs: Vec<Var>,
    /// What these are.
    blocks: Vec<Block>,
    /// Symbols of q̇⁺.
    plus: Vec<Var>,
    /// A sum whose partial derivatives, with q̇⁺ and the adjoint held, are total ones of the weighted results.
    sum: Poly,
    /// q̇⁺ and the adjoint, to be inserted after differentiation.
    solution: BTreeMap<Var, Poly>,
}

impl WeightedImpact {
    fn new(model: &mut Model, transition: Transition, leg: usize) -> WeightedImpact {
        let impact = Impact::new(model, transition, leg);
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
        WeightedImpact { given: impact.given, xi, outputs, blocks: impact.blocks, plus: impact.plus, sum, solution }
    }
}

/// Second derivatives of an impact's weighted results.
fn landing_curvature(model: &mut Model, transition: Transition, leg: usize) -> Kernel {
    let q = model.q(0);
    let WeightedImpact { given, xi, outputs, blocks, plus, sum, solution } =
        WeightedImpact::new(model, transition, leg);
    let by_q: Vec<Poly> = q.iter().map(|s| model.ring.derivative(&sum, *s)).collect();
    let raw = [model.hessian(&by_q, &q), model.jacobian(&by_q, &given.symbols()), model.jacobian(&by_q, &plus)];
    let mut insert = |rows: &Vec<Vec<Poly>>| -> Vec<Vec<Poly>> {
        rows.iter().map(|row| row.iter().map(|p| model.ring.substitute(p, &solution)).collect()).collect()
    };
    let [qq, q_before, q_plus] = raw.each_ref().map(&mut insert);
    let (doc, block, what) = match transition.leaves() {
        Some(_) => (
            "Second derivatives of a touchdown's results, weighted: q̇⁺ (xi), then impulse, leaving and landing velocity, \
             couple and pitch if there are any (outputs). With J = ∂q̇⁺/∂(q, q̇⁻), the Hessian in (q, q̇⁻) is \
             [q_q, q_qd; ·, 0] + [q_plus; 0] J + its transpose.",
            "q_qd",
            "∂²/∂q∂q̇⁻",
        ),
        None => (
            "Second derivatives of a landing's results, weighted: q̇⁺ (xi), then impulse and landing velocity (outputs). With \
             J = ∂q̇⁺/∂(q, v⁻, q̇⁻), the Hessian in (q, v⁻, q̇⁻) is [q_q, q_v; ·, 0] + [q_plus; 0] J + its transpose.",
            "q_v",
            "∂²/∂q∂(v⁻, q̇⁻)",
        ),
    };
    Kernel::of_transition(transition, "_curvature", doc)
        .input("q", q)
        .inputs(given.inputs())
        .input("xi", xi)
        .blocks("outputs", outputs, blocks)
        .matrix("q_q", qq, "∂²/∂q∂q")
        .matrix(block, q_before, what)
        .matrix("q_plus", q_plus, "∂²/∂q∂q̇⁺")
}

/// A foot that has stood leaves: where the parabola of the mass centre begins, and how the foot does.
struct TakeOff {
    /// Mass centre from the foot.
    place: Vec<Poly>,
    velocity: Vec<Poly>,
    /// Vertical acceleration of the foot in flight. It was at rest, so its height begins like lift · t²/2.
    lift: Poly,
}

impl TakeOff {
    fn new(model: &mut Model, transition: Transition) -> TakeOff {
        let foot = transition.leaves().map_or(zero(), |leg| model.foot(leg));
        let place = subtract(&model.place(Origin::MassCentre), &foot);
        let velocity = model.rate(&place);
        let lift = -&(&model.rate(&velocity)[1] + &model.quantities.gravity);
        TakeOff { place: model.components(&place), velocity: model.components(&velocity), lift }
    }

    /// All of it, each with its weight, and the weights.
    fn weighted(&self, model: &mut Model) -> (Input, Poly) {
        let blocks =
            vec![Block::vector("r", self.place.len()), Block::vector("v", self.velocity.len()), Block::scalar("lift")];
        let weights = symbols(model, "w", Block::total(&blocks));
        let terms = self.place.iter().chain(&self.velocity).chain([&self.lift]);
        let weighted = weights.iter().zip(terms).map(|(weight, term)| &Poly::from(*weight) * term);
        let sum = weighted.fold(Poly::zero(), |sum, term| &sum + &term);
        (Input::of_blocks("weights", weights, blocks), sum)
    }

    fn kernel(self, model: &Model, transition: Transition) -> Kernel {
        let (q, qd, qdd) = (model.q(0), model.q(1), model.q(2));
        let to_velocity: Vec<Var> = [&q[..], &qd].concat();
        let to_acceleration: Vec<Var> = [&q[..], &qd, &qdd].concat();
        let r_q = model.jacobian(&self.place, &q);
        let v_w = model.jacobian(&self.velocity, &to_velocity);
        let gradient = model.jacobian(std::slice::from_ref(&self.lift), &to_acceleration).remove(0);
        Kernel::of_transition(
            transition,
            "",
            "What begins when this foot, at rest so far, leaves the ground: the mass centre's parabola, seen from the \
             foot, and the foot's rise; with Jacobians.",
        )
        .input("q", q)
        .input("qd", qd)
        .input("qdd", qdd)
        .vector("r", self.place, "mass centre, m")
        .vector("v", self.velocity, "its velocity, m/s")
        .scalar("lift", self.lift, "vertical acceleration of the foot in flight, m/s²")
        .matrix("r_q", r_q, "∂r/∂q")
        .matrix("v_w", v_w, "∂v/∂(q, q̇)")
        .vector("lift_w", gradient, "∂lift/∂(q, q̇, q̈)")
    }
}

/// A sum of weighted results: the inputs and the sum.
pub struct Results {
    pub inputs: Vec<Input>,
    pub sum: Poly,
    /// To be inserted after differentiation.
    pub solution: BTreeMap<Var, Poly>,
}

impl Results {
    /// Of what a transition does.
    pub fn new(model: &mut Model, transition: Transition) -> Results {
        let q = Input::new("q", model.q(0));
        match transition.lands() {
            None => {
                let (weights, sum) = TakeOff::new(model, transition).weighted(model);
                let inputs = vec![q, Input::new("qd", model.q(1)), Input::new("qdd", model.q(2)), weights];
                Results { inputs, sum, solution: BTreeMap::new() }
            }
            Some(leg) => {
                let impact = WeightedImpact::new(model, transition, leg);
                let outputs = Input::of_blocks("outputs", impact.outputs, impact.blocks);
                let mut inputs = vec![q];
                inputs.extend(impact.given.inputs());
                inputs.extend([Input::new("xi", impact.xi), outputs]);
                Results { inputs, sum: impact.sum, solution: impact.solution }
            }
        }
    }
}

/// Both feet at rest after the impact (eq. 11). Singular where the feet cannot both be loaded
/// independently: the pivots say so.
pub fn both_feet(model: &mut Model) -> Kernel {
    let (landing, other) = (1, 0);
    let platform = platform_rate(model);
    let momenta = momenta_before(model, landing, &platform);
    let inertia = inertia_about(model, landing);
    let factors = Factors::new(&mut model.ring, &inertia);
    let free = factors.solve(&mut model.ring, &momenta);
    let apart = subtract(&model.foot(other), &model.foot(landing));
    let apart = model.components(&apart);
    let jacobian = model.jacobian(&apart, &model.q(0));
    let responses: Vec<Vec<Poly>> = jacobian.iter().map(|row| factors.solve(&mut model.ring, row)).collect();
    let product = |row: &[Poly], x: &[Poly]| {
        let mut sum = Poly::zero();
        for (a, b) in row.iter().zip(x) {
            sum += &(a * b);
        }
        sum
    };
    let schur: Vec<Vec<Poly>> =
        jacobian.iter().map(|row| responses.iter().map(|x| model.ring.bind(product(row, x))).collect()).collect();
    let right: Vec<Poly> = jacobian.iter().map(|row| -&product(row, &free)).collect();
    let schur_factors = Factors::new(&mut model.ring, &schur);
    let impulse_other = schur_factors.solve(&mut model.ring, &right);
    let solution: Vec<Poly> = free
        .iter()
        .enumerate()
        .map(|(k, u)| {
            let mut sum = u.clone();
            for (response, i) in responses.iter().zip(&impulse_other) {
                sum += &(&response[k] * i);
            }
            model.ring.bind(sum)
        })
        .collect();
    let (map, xd) = with_platform(model, landing, &solution);
    let before = linear_momentum(model, &platform);
    let total = impulse(model, landing, &before, &map);
    let impulse_landing = total.iter().zip(&impulse_other).map(|(t, o)| t - o).collect();
    let scale = (0..schur.len()).map(|k| schur[k][k].clone()).collect();
    Kernel::new("impact_both", "Passive impact with both feet at rest after (eq. 11).")
        .input("q", model.q(0))
        .input("xd", model.x(1))
        .vector("xd_plus", xd, "Ẋ⁺")
        .vector("impulse1", impulse_other, "impulse on foot 1, N·s")
        .vector("impulse2", impulse_landing, "impulse on foot 2, N·s")
        .vector(
            "pivots",
            schur_factors.pivots,
            "pivots of the feet's mutual compliance: one that is tiny beside `scale` means a singular case",
        )
        .vector("scale", scale, "the compliance's diagonal")
}
