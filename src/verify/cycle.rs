//! Whether the half steps follow from each other (§5.2): the impact at the end of each, and how far
//! the motion is from a cycle.

use super::constraint::{Constraint, Tally};
use super::error::VerifyError;
use super::grid::tangential;
use super::impact::impact;
use crate::model::{Description, HalfSteps};
use crate::motion::{HalfStep, Motion};

/// Leg that half step `index` stands on.
pub fn stance_leg(description: &Description, index: usize) -> usize {
    match description.half_steps {
        HalfSteps::Mirrored => 0,
        HalfSteps::Distinct => index,
    }
}

/// Notes the constraints on the impact that ends half step `index`, and returns how far the initial
/// state of the one after it is from what follows (eq. 16, 18, 19): rad, and rad/s over max(1, rate).
pub fn transition(
    description: &Description,
    motion: &Motion,
    index: usize,
    tally: &mut Tally,
) -> Result<f64, VerifyError> {
    let before = &motion.half_steps[index];
    let after = &motion.half_steps[(index + 1) % motion.half_steps.len()];
    let q = complete(description, &before.q_final, before.beta_final);
    let qd = complete(description, &before.qd_final, before.betad_final);
    let landing = 1 - stance_leg(description, index);
    let impact = impact(description, landing, &q, &qd).ok_or(VerifyError::Impact { half_step: index + 1 })?;

    let momentum = description.total_mass();
    let (impulse, t) = (impact.impulse, before.duration);
    tally.note(Constraint::VerticalImpulse, impulse.y / momentum, t);
    tally.note(
        Constraint::ImpulseFriction,
        (description.limits.friction * impulse.y - tangential(&impulse)) / momentum,
        t,
    );
    tally.note(Constraint::Leaving, impact.leaving.y, t);

    let rates = &impact.after[description.positions()..];
    let found = complete(description, &after.q_initial, after.beta_initial);
    let found_rates = complete(description, &after.qd_initial, after.betad_initial);
    let mut worst = 0.0_f64;
    for k in 0..q.len() {
        let (from, sign) = match description.half_steps {
            HalfSteps::Mirrored => description.swapped(k),
            HalfSteps::Distinct => (k, 1.0),
        };
        worst = worst.max((found[k] - sign * q[from]).abs());
        worst = worst.max(relative(found_rates[k], sign * rates[from]));
    }
    Ok(worst)
}

/// How far the integrated β and β̇ end from what the motion says (eq. 23, 24).
pub fn closure(half_step: &HalfStep, end: [f64; 2]) -> f64 {
    (end[0] - half_step.beta_final).abs().max(relative(end[1], half_step.betad_final))
}

/// Difference of two rates, relative where they are large.
fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(1.0)
}

/// q from Q and β.
fn complete(description: &Description, prescribed: &[f64], beta: f64) -> Vec<f64> {
    let mut q = prescribed.to_vec();
    q.insert(description.unactuated.min(q.len()), beta);
    q
}
