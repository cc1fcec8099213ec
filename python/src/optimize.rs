//! A question and its answer.

use crate::error::Error;
use crate::result::text;
use crate::robot::Gait;
use crate::work::{Stop, work};
use piaffe::Task;
use piaffe::examine::Examination;
use piaffe::model::digits::digits;
use piaffe::motion::Criterion;
use piaffe::optimize::Unaskable;
use piaffe::search::multi_start::Settings;
use piaffe::sqp::Control;
use pyo3::prelude::*;

/// The criterion of this name.
pub fn criterion(name: &str) -> PyResult<Criterion> {
    let known = || Criterion::ALL.map(|criterion| format!("\"{}\"", criterion.name())).join(" or ");
    let found = Criterion::ALL.into_iter().find(|criterion| criterion.name() == name);
    found.ok_or_else(|| Error::new_err(format!("`criterion` is \"{name}\": give {}", known())))
}

/// A speed that can be asked for, m/s.
pub fn speed(speed: f64) -> PyResult<f64> {
    match Unaskable::of(speed) {
        Some(_) => {
            Err(Error::new_err(format!("`speed` is {}: give a positive number of m/s, such as 0.6", digits(speed))))
        }
        None => Ok(speed),
    }
}

/// How closely to look at an optimum.
fn examination(name: &str) -> PyResult<Examination> {
    Examination::by_name(name).ok_or_else(|| {
        let known = Examination::ALL.map(|level| format!("\"{}\"", level.name())).join(", ");
        Error::new_err(format!("`examine` is \"{name}\": give one of {known}"))
    })
}

/// The result as JSON.
#[pyfunction]
#[pyo3(signature = (gait, speed, criterion, real_legs, starts, seed, examine, threads))]
#[allow(clippy::too_many_arguments)]
pub fn optimize(
    py: Python<'_>,
    gait: &Gait,
    speed: f64,
    criterion: &str,
    real_legs: bool,
    starts: Option<usize>,
    seed: u64,
    examine: &str,
    threads: Option<usize>,
) -> PyResult<String> {
    let (criterion, speed) = (self::criterion(criterion)?, self::speed(speed)?);
    let settings = Settings { starts, seed, examination: examination(examine)? };
    let gait = gait.derived();
    let answer = work(py, threads, Stop::default(), move |stop| {
        let watch = |_| if stop.is_wanted() { Control::Stop } else { Control::Continue };
        Task { gait: &*gait, criterion, speed }.answer(real_legs, &settings, &watch)
    })?;
    text(&answer.map_err(|why| Error::new_err(format!("`real_legs`: {why}")))?)
}
