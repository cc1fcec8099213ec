//! Whether the phases follow from each other (§5.2): the impact at the end of each if there is one, and how far
//! the motion is from a cycle.

use super::constraint::Constraint;
use super::contact::Contact;
use super::error::VerifyError;
use super::impact::{Before, impact_of};
use super::margins::Units;
use super::multibody::Multibody;
use super::numbers::Numbers;
use piaffe_model::motion::Course;
use piaffe_model::{Description, Transition};
use piaffe_number::Scalar;

/// Notes the margins of the impact that ends phase `index`, if one does, and returns how far the initial state of the phase after
/// it is from what follows (eq. 16, 18, 19): angles in rad, rates relative to themselves or to a slow rate.
pub fn transition<T: Scalar>(
    description: &Description,
    numbers: Numbers<T>,
    phases: &[Course<T>],
    index: usize,
    note: impl FnMut(Constraint, T),
) -> Result<Vec<T>, VerifyError> {
    let before = &phases[index];
    let after = &phases[(index + 1) % phases.len()];
    let q = description.complete(&before.q_final, before.beta_final);
    let qd = description.complete(&before.qd_final, before.betad_final);
    let units = Units::new(description);
    let rates = match description.transition(index) {
        Transition::TakeOff(_) => qd,
        Transition::Touchdown(landing) | Transition::Landing(landing) => {
            let moves = match Contact::of(description, &numbers, phases, index) {
                Contact::Foot(_) => Before::Stance,
                Contact::Flight(fall) => Before::Flight(fall.velocity(before.duration)),
            };
            let mut multibody = Multibody::with(description, numbers);
            let impact =
                impact_of(&mut multibody, landing, &q, &qd, moves).ok_or(VerifyError::Impact { phase: index + 1 })?;
            let leaving = matches!(moves, Before::Stance).then_some(&impact.leaving);
            units.impact(multibody.numbers(), &impact.impulse, leaving, note);
            impact.after[description.positions()..].to_vec()
        }
    };
    let found = description.complete(&after.q_initial, after.beta_initial);
    let found_rates = description.complete(&after.qd_initial, after.betad_initial);
    let gaps = (0..q.len()).flat_map(|k| {
        let (from, sign) = description.renamed(index, k);
        [found[k] - q[from].scale(sign), relative(&units, found_rates[k], rates[from].scale(sign))]
    });
    Ok(gaps.collect())
}

/// How far the integrated β and β̇ end from what the motion says (eq. 23, 24).
pub fn closure<T: Scalar>(units: &Units, course: &Course<T>, end: [T; 2]) -> [T; 2] {
    [end[0] - course.beta_final, relative(units, end[1], course.betad_final)]
}

/// Difference of two rates, relative where they are not slow, else to a slow one.
fn relative<T: Scalar>(units: &Units, found: T, expected: T) -> T {
    (found - expected) / T::from(expected.least_magnitude().max(units.rate()))
}
