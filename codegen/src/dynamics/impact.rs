//! Passive impacts: eq. 12 (the other foot leaves) and eq. 11 (both feet stay).
//!
//! A landing foot j that comes to rest takes an impulse that does no work in motions with foot j at
//! rest. In those, the generalized momenta before and after are equal: `Aq⁽ʲ⁾ q̇⁺ = P⁽ʲ⁾(Ẋ⁻)`.

use super::kernel::Kernel;
use super::model::{Model, Origin, scaled};
use super::sharing;
use super::solve::Factors;
use crate::expr::{Poly, Var, Vec3, subtract};
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

/// Kernels of the impact on foot `leg`.
pub fn kernels(model: &mut Model, leg: usize) -> Vec<Kernel> {
    let platform = platform_rate(model);
    let momenta = momenta_before(model, leg, &platform);
    let inertia = inertia_about(model, leg);
    let factors = Factors::new(&mut model.ring, &inertia);
    let solution = factors.solve(&mut model.ring, &momenta);
    let (map, xd) = with_platform(model, leg, &solution);
    let before = linear_momentum(model, &platform);
    let impulse = impulse(model, leg, &before, &map);
    let general = Kernel::new(
        format!("impact{}", leg + 1),
        "Passive impact on this foot, the other one free (eq. 12): velocities after, and the impulse.",
    )
    .input("q", model.q(0))
    .input("xd", model.x(1))
    .vector("xd_plus", xd, "Ẋ⁺")
    .vector("impulse", impulse, "impulse on this foot, N·s");
    vec![general, touchdown(model, leg)]
}

/// The impact on one foot at the end of single support on the other, with the velocities after as
/// symbols, so that what depends on them can be differentiated by parts.
pub struct Touchdown {
    /// Aq about the landing foot.
    pub inertia: Vec<Vec<Poly>>,
    /// Momenta before.
    pub before: Vec<Poly>,
    /// Symbols of q̇⁺.
    pub plus: Vec<Var>,
    /// Momenta before minus after: zero.
    pub residual: Vec<Poly>,
    /// Impulse, vertical velocity of the leaving foot after, of the landing foot before; where the platform rolls also how
    /// real feet share (see `sharing::landing`).
    pub outputs: Vec<Poly>,
}

impl Touchdown {
    pub fn new(model: &mut Model, leg: usize) -> Touchdown {
        let stance = 1 - leg;
        let qd = model.q(1);
        let p = model.foot(stance).map(|x| -&x);
        let platform = model.rate(&p);
        let before = momenta_before(model, leg, &platform);
        let inertia = inertia_about(model, leg);
        let plus: Vec<Var> = (0..qd.len()).map(|k| model.ring.symbol(format!("plus{k}"))).collect();
        let rename: BTreeMap<Var, Poly> = qd.iter().copied().zip(plus.iter().map(|v| Poly::from(*v))).collect();
        let coordinates = model.coordinates.q.clone();
        let momenta = model.momenta(Origin::Foot(leg), &coordinates);
        let after: Vec<Poly> = momenta.iter().map(|m| model.ring.substitute(m, &rename)).collect();
        let residual = before.iter().zip(&after).map(|(b, a)| b - a).collect();
        let momentum_before = linear_momentum(model, &platform);
        let mut outputs = impulse(model, leg, &momentum_before, &rename);
        let leaving = subtract(&model.foot(stance), &model.foot(leg));
        let leaving_rate = model.rate(&leaving);
        outputs.push(model.ring.substitute(&leaving_rate[1], &rename));
        let landing = subtract(&model.foot(leg), &model.foot(stance));
        outputs.push(model.rate(&landing)[1].clone());
        if model.mechanism.rotation == Rotation::Roll {
            outputs.extend(sharing::landing(model, leg, &platform, &rename));
        }
        Touchdown { inertia, before, plus, residual, outputs }
    }
}

/// The impact at the end of a single support, with its Jacobian in (q, q̇⁻).
fn touchdown(model: &mut Model, leg: usize) -> Kernel {
    let (q, qd) = (model.q(0), model.q(1));
    let by: Vec<Var> = q.iter().chain(&qd).copied().collect();
    let Touchdown { inertia, before, plus, residual, outputs } = Touchdown::new(model, leg);
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
    let mut couple = values.split_off(model.mechanism.positions() + 2);
    let couple_rows = jacobian.split_off(jacobian.len() - couple.len());
    let landing_velocity = values.pop().unwrap_or_default();
    let leaving_velocity = values.pop().unwrap_or_default();
    let kernel = Kernel::new(
        format!("touchdown{}", leg + 1),
        "Impact on this foot at the end of single support on the other (eq. 12), with its Jacobian in (q, q̇⁻): \
         rows are q̇⁺, the impulse, the leaving foot's vertical velocity after, the landing foot's before.",
    )
    .input("q", q)
    .input("qd", qd)
    .vector("qd_plus", solution, "q̇⁺, before the legs swap names")
    .vector("impulse", values, "impulse on the landing foot, N·s")
    .scalar("leaving", leaving_velocity, "vertical velocity of the leaving foot after, m/s")
    .scalar("landing", landing_velocity, "vertical velocity of the landing foot before, m/s")
    .matrix("jacobian", jacobian, "∂(q̇⁺, impulse, leaving, landing)/∂(q, q̇⁻)");
    let Some(pitch) = couple.pop() else { return kernel };
    kernel
        .vector(
            "couple",
            couple,
            "half the difference of the real feet's impulses times their distance, y and z, N·m·s",
        )
        .scalar("pitch", pitch, "change of the angular momentum about the platform's transverse axis, N·m·s")
        .matrix("couple_jacobian", couple_rows, "∂(couple, pitch)/∂(q, q̇⁻)")
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
