//! What can keep a motion from being verified at all, and the checks of its shape.

use super::integrate::Stop;
use piaffe_model::Description;
use piaffe_model::digits::digits;
use piaffe_model::motion::{Course, Motion};
use piaffe_number::Scalar;

/// Fewest points of a grid: quadrature needs four neighbours.
pub const SMALLEST_GRID: usize = 5;

/// Why there is no receipt. A motion that merely breaks constraints or does not close has one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VerifyError {
    #[error("the {gait} is defined by {expected} phase(s), the motion has {found}")]
    Phases { gait: &'static str, expected: usize, found: usize },
    #[error("phase {phase}: `{list}` has {found} numbers, one for each of {expected} prescribed coordinates is needed")]
    Length { phase: usize, list: String, expected: usize, found: usize },
    #[error(
        "phase {phase}: polynomials of order {order} need {expected} list(s) in `q_interior`, not {found}",
        order = .expected + 3
    )]
    Interior { phase: usize, expected: usize, found: usize },
    #[error("phase {phase}: `{list}` contains a number that is not finite")]
    NotFinite { phase: usize, list: String },
    #[error("phase {phase} takes {} s: its duration must be positive and finite", digits(*.duration))]
    Duration { phase: usize, duration: f64 },
    #[error("the speed must be finite and not zero, not {} m/s", digits(*.0))]
    Speed(f64),
    #[error("a grid of {0} points is too coarse: at least {SMALLEST_GRID} are needed")]
    Grid(usize),
    #[error(
        "phase {phase}: from t = {time:.6} s on β cannot be integrated (eq. 10): f1 vanishes, or β̈ grows without bound"
    )]
    Blowup { phase: usize, time: f64 },
    #[error("phase {phase}: the integration of β takes too many steps; it was given up at t = {time:.6} s")]
    Steps { phase: usize, time: f64 },
    #[error(
        "phase {phase}: at t = {time:.6} s the torques do not follow from the motion, because f1 vanishes (eq. 10)"
    )]
    Singular { phase: usize, time: f64 },
    #[error("phase {phase}: the velocities after the impact are not determined (eq. 12)")]
    Impact { phase: usize },
    #[error("the robot travels {distance:e} m in its phases: costs per metre mean nothing")]
    NoTravel { distance: f64 },
}

impl VerifyError {
    pub(super) fn stopped(stop: Stop, phase: usize) -> VerifyError {
        match stop {
            Stop::Blowup { time } => VerifyError::Blowup { phase, time },
            Stop::Steps { time } => VerifyError::Steps { phase, time },
        }
    }
}

/// Whether the motion has the numbers that the gait needs, all of them finite.
pub(crate) fn check(description: &Description, motion: &Motion, grid: usize) -> Result<(), VerifyError> {
    let (expected, found) = (description.phases.len(), motion.phases.len());
    if expected != found {
        return Err(VerifyError::Phases { gait: description.gait, expected, found });
    }
    if grid < SMALLEST_GRID {
        return Err(VerifyError::Grid(grid));
    }
    for (i, course) in motion.phases.iter().enumerate() {
        check_course(course, description.prescribed(), i + 1)?;
        let (expected, found) = (description.polynomial_order - 3, course.q_interior.len());
        if expected != found {
            return Err(VerifyError::Interior { phase: i + 1, expected, found });
        }
    }
    Ok(())
}

pub(super) fn check_course<T: Scalar>(course: &Course<T>, prescribed: usize, number: usize) -> Result<(), VerifyError> {
    let duration = course.duration.value();
    if !(duration.is_finite() && duration > 0.0) {
        return Err(VerifyError::Duration { phase: number, duration });
    }
    let list = |name: String, values: &[T], expected: usize| {
        if values.len() != expected {
            return Err(VerifyError::Length { phase: number, list: name, expected, found: values.len() });
        }
        if values.iter().any(|x| !x.value().is_finite()) {
            return Err(VerifyError::NotFinite { phase: number, list: name });
        }
        Ok(())
    };
    list("q_initial".into(), &course.q_initial, prescribed)?;
    list("qd_initial".into(), &course.qd_initial, prescribed)?;
    for (k, q) in course.q_interior.iter().enumerate() {
        list(format!("q_interior[{k}]"), q, prescribed)?;
    }
    list("q_final".into(), &course.q_final, prescribed)?;
    list("qd_final".into(), &course.qd_final, prescribed)?;
    list("beta_initial, betad_initial".into(), &[course.beta_initial, course.betad_initial], 2)?;
    list("beta_final, betad_final".into(), &[course.beta_final, course.betad_final], 2)
}
