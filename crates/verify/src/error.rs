//! What can keep a motion from being verified at all, and the checks of its shape.

use super::integrate::Stop;
use piaffe_model::Description;
use piaffe_model::motion::{HalfStep, Motion};
use piaffe_number::Scalar;

/// Fewest points of a grid: quadrature needs four neighbours.
pub const SMALLEST_GRID: usize = 5;

/// Why there is no receipt. A motion that merely breaks constraints or does not close has one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VerifyError {
    #[error("the {gait} is defined by {expected} half step(s), the motion has {found}")]
    HalfSteps { gait: &'static str, expected: usize, found: usize },
    #[error(
        "half step {half_step}: `{list}` has {found} numbers, one for each of {expected} prescribed coordinates is needed"
    )]
    Length { half_step: usize, list: String, expected: usize, found: usize },
    #[error(
        "half step {half_step}: polynomials of order {order} need {expected} list(s) in `q_interior`, not {found}",
        order = .expected + 3
    )]
    Interior { half_step: usize, expected: usize, found: usize },
    #[error("half step {half_step}: `{list}` contains a number that is not finite")]
    NotFinite { half_step: usize, list: String },
    #[error("half step {half_step} takes {duration} s: its duration must be positive and finite")]
    Duration { half_step: usize, duration: f64 },
    #[error("the speed must be finite and not zero, not {0} m/s")]
    Speed(f64),
    #[error("a grid of {0} points is too coarse: at least {SMALLEST_GRID} are needed")]
    Grid(usize),
    #[error(
        "half step {half_step}: from t = {time:.6} s on β cannot be integrated (eq. 10): f1 vanishes, or β̈ grows without bound"
    )]
    Blowup { half_step: usize, time: f64 },
    #[error("half step {half_step}: the integration of β takes too many steps; it was given up at t = {time:.6} s")]
    Steps { half_step: usize, time: f64 },
    #[error(
        "half step {half_step}: at t = {time:.6} s the torques do not follow from the motion, because f1 vanishes (eq. 10)"
    )]
    Singular { half_step: usize, time: f64 },
    #[error("half step {half_step}: the velocities after the impact are not determined (eq. 12)")]
    Impact { half_step: usize },
    #[error("the robot travels {distance:e} m in a step: costs per metre mean nothing")]
    NoTravel { distance: f64 },
}

impl VerifyError {
    pub(super) fn stopped(stop: Stop, half_step: usize) -> VerifyError {
        match stop {
            Stop::Blowup { time } => VerifyError::Blowup { half_step, time },
            Stop::Steps { time } => VerifyError::Steps { half_step, time },
        }
    }
}

/// Whether the motion has the numbers that the gait needs, all of them finite.
pub(crate) fn check(description: &Description, motion: &Motion, grid: usize) -> Result<(), VerifyError> {
    let (expected, found) = (description.phases.len(), motion.half_steps.len());
    if expected != found {
        return Err(VerifyError::HalfSteps { gait: description.gait, expected, found });
    }
    if grid < SMALLEST_GRID {
        return Err(VerifyError::Grid(grid));
    }
    for (i, half_step) in motion.half_steps.iter().enumerate() {
        check_half_step(half_step, description.prescribed(), i + 1)?;
        let (expected, found) = (description.polynomial_order - 3, half_step.q_interior.len());
        if expected != found {
            return Err(VerifyError::Interior { half_step: i + 1, expected, found });
        }
    }
    Ok(())
}

pub(super) fn check_half_step<T: Scalar>(
    half_step: &HalfStep<T>,
    prescribed: usize,
    number: usize,
) -> Result<(), VerifyError> {
    let duration = half_step.duration.value();
    if !(duration.is_finite() && duration > 0.0) {
        return Err(VerifyError::Duration { half_step: number, duration });
    }
    let list = |name: String, values: &[T], expected: usize| {
        if values.len() != expected {
            return Err(VerifyError::Length { half_step: number, list: name, expected, found: values.len() });
        }
        if values.iter().any(|x| !x.value().is_finite()) {
            return Err(VerifyError::NotFinite { half_step: number, list: name });
        }
        Ok(())
    };
    list("q_initial".into(), &half_step.q_initial, prescribed)?;
    list("qd_initial".into(), &half_step.qd_initial, prescribed)?;
    for (k, q) in half_step.q_interior.iter().enumerate() {
        list(format!("q_interior[{k}]"), q, prescribed)?;
    }
    list("q_final".into(), &half_step.q_final, prescribed)?;
    list("qd_final".into(), &half_step.qd_final, prescribed)?;
    list("beta_initial, betad_initial".into(), &[half_step.beta_initial, half_step.betad_initial], 2)?;
    list("beta_final, betad_final".into(), &[half_step.beta_final, half_step.betad_final], 2)
}
