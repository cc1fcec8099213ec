//! Whether the half steps follow from each other (§5.2): the impact at the end of each, and how far
//! the motion is from a cycle.

use super::constraint::Constraint;
use super::error::VerifyError;
use super::impact::impact_of;
use super::margins::Units;
use super::multibody::Multibody;
use super::numbers::Numbers;
use piaffe_model::Description;
use piaffe_model::motion::HalfStep;
use piaffe_number::Scalar;

/// Leg that half step `index` stands on.
pub fn stance_leg(description: &Description, index: usize) -> usize {
    description.phases[index].mode.stance().unwrap_or_default()
}

/// Notes the margins of the impact that ends half step `index`, and returns how far the initial state of the one after
/// it is from what follows (eq. 16, 18, 19): angles in rad, rates relative to themselves or to a slow rate.
pub fn transition<T: Scalar>(
    description: &Description,
    numbers: Numbers<T>,
    half_steps: &[HalfStep<T>],
    index: usize,
    note: impl FnMut(Constraint, T),
) -> Result<Vec<T>, VerifyError> {
    let before = &half_steps[index];
    let after = &half_steps[(index + 1) % half_steps.len()];
    let q = description.complete(&before.q_final, before.beta_final);
    let qd = description.complete(&before.qd_final, before.betad_final);
    let landing = 1 - stance_leg(description, index);
    let mut multibody = Multibody::with(description, numbers);
    let impact = impact_of(&mut multibody, landing, &q, &qd).ok_or(VerifyError::Impact { half_step: index + 1 })?;
    let units = Units::new(description);
    units.impact(multibody.numbers(), &impact.impulse, &impact.leaving, note);

    let rates = &impact.after[description.positions()..];
    let found = description.complete(&after.q_initial, after.beta_initial);
    let found_rates = description.complete(&after.qd_initial, after.betad_initial);
    let gaps = (0..q.len()).flat_map(|k| {
        let (from, sign) = description.renamed(index, k);
        [found[k] - q[from].scale(sign), relative(&units, found_rates[k], rates[from].scale(sign))]
    });
    Ok(gaps.collect())
}

/// How far the integrated β and β̇ end from what the motion says (eq. 23, 24).
pub fn closure<T: Scalar>(units: &Units, half_step: &HalfStep<T>, end: [T; 2]) -> [T; 2] {
    [end[0] - half_step.beta_final, relative(units, end[1], half_step.betad_final)]
}

/// Difference of two rates, relative where they are not slow, else to a slow one.
fn relative<T: Scalar>(units: &Units, found: T, expected: T) -> T {
    (found - expected) / T::from(expected.least_magnitude().max(units.rate()))
}
