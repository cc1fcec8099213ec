//! What is said of results. They come as JSON, and with the files that their gaits were derived from.

use crate::error::{Error, NoOptimum};
use crate::robot::unloadable;
use crate::work::{Stop, apart, work};
use piaffe::Robot;
use piaffe::audit::Audit;
use piaffe::export::{mjcf as mujoco, npz as arrays, table};
use piaffe::finite::not_finite;
use piaffe::interpreter::Interpreted;
use piaffe::model::Gait;
use piaffe::model::digits::digits;
use piaffe::motion::Motion;
use piaffe::origin::is_of;
use piaffe::report::{Extremes, Record, Report};
use piaffe::result::GaitResult;
use piaffe::walk::Walk;
use piaffe_codegen::spec::BYTE_ORDER_MARK;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Serialize;
use serde_json::Value;

/// As the command line writes it.
pub fn text(value: &impl Serialize) -> PyResult<String> {
    if let Some(place) = not_finite(value) {
        return Err(Error::new_err(format!("{place} is not a finite number")));
    }
    serde_json::to_string_pretty(value).map_err(|why| Error::new_err(why.to_string()))
}

fn read(json: &str) -> Result<(Value, GaitResult), String> {
    let place = |why: serde_json::Error| format!("this is no result of piaffe: {why}");
    let json = json.trim_start_matches(BYTE_ORDER_MARK);
    let value = serde_json::from_str(json).map_err(place)?;
    Ok((value, serde_json::from_str(json).map_err(place)?))
}

/// The gait of a result, from the files that it carries.
fn gait_of(py: Python<'_>, result: &GaitResult) -> PyResult<Interpreted> {
    let name = result.name();
    let Some(carried) = &result.specification else {
        return Err(Error::new_err(format!("{name} carries no files of its robot: optimize again")));
    };
    let gait = apart(py, || Robot::carried(carried, &result.gait))?.map_err(unloadable)?;
    let what = "the files that it carries are those of another robot or gait (its fingerprint differs)";
    if is_of(result, gait.description()) { Ok(gait) } else { Err(Error::new_err(format!("{name}: {what}"))) }
}

fn motion_of(result: &GaitResult) -> PyResult<Motion> {
    let conflicts: Vec<&str> = result.conflicts.iter().map(|conflict| conflict.constraint.as_str()).collect();
    let which = if conflicts.is_empty() { String::new() } else { format!(": {}", conflicts.join(", ")) };
    let nearest = result
        .nearest_speed
        .map_or(String::new(), |speed| format!("; the nearest speed found to work is {} m/s", digits(speed)));
    let none = || NoOptimum::new_err(format!("{} has no motion ({}{which}{nearest})", result.name(), result.message));
    result.motion().ok_or_else(none)
}

/// A result's JSON as it is written here.
#[pyfunction]
pub fn normal(json: &str) -> PyResult<String> {
    text(&read(json).map_err(Error::new_err)?.1)
}

/// The audit of a result, as JSON.
#[pyfunction]
pub fn verify(py: Python<'_>, json: String) -> PyResult<String> {
    let (stated, result) = read(&json).map_err(Error::new_err)?;
    let gait = gait_of(py, &result)?;
    text(&work(py, None, Stop::default(), move |_| Audit::new(&stated, &result, &[&gait]))?)
}

/// What a result's walk is made into.
fn of_walk<T: Send>(
    py: Python<'_>,
    json: &str,
    walk: impl FnOnce(&dyn Gait, &Motion) -> Result<T, String> + Send,
) -> PyResult<T> {
    let (_, result) = read(json).map_err(Error::new_err)?;
    let (motion, gait) = (motion_of(&result)?, gait_of(py, &result)?);
    apart(py, || walk(&gait, &motion))?.map_err(Error::new_err)
}

fn words(why: impl std::fmt::Display) -> String {
    why.to_string()
}

/// A rate at which a walk can be sampled, Hz.
fn rate(rate: f64) -> PyResult<f64> {
    let good = (1.0..=1e6).contains(&rate);
    good.then_some(rate)
        .ok_or_else(|| Error::new_err(format!("`rate` is {}: give 1 to 1000000 per second", digits(rate))))
}

/// The walk as arrays, in numpy's format.
#[pyfunction]
pub fn npz<'py>(py: Python<'py>, json: &str, rate: f64) -> PyResult<Bound<'py, PyBytes>> {
    let rate = self::rate(rate)?;
    let bytes = of_walk(py, json, |gait, motion| {
        Walk::at_rate(gait, motion, rate).map_err(words).and_then(|walk| arrays::npz(&walk).map_err(words))
    })?;
    Ok(PyBytes::new(py, &bytes))
}

/// The walk as a table.
#[pyfunction]
pub fn csv(py: Python<'_>, json: &str, rate: f64) -> PyResult<String> {
    let rate = self::rate(rate)?;
    of_walk(py, json, |gait, motion| Ok(table::csv(&Walk::at_rate(gait, motion, rate).map_err(words)?)))
}

/// The robot for MuJoCo, where its walk begins.
#[pyfunction]
pub fn mjcf(py: Python<'_>, json: &str) -> PyResult<String> {
    of_walk(py, json, |gait, motion| Ok(mujoco::mjcf(&Walk::even(gait, motion, 1).map_err(words)?)))
}

/// The page that shows a result.
#[pyfunction]
pub fn page(py: Python<'_>, json: &str) -> PyResult<String> {
    let (_, result) = read(json).map_err(Error::new_err)?;
    motion_of(&result)?;
    let gait = gait_of(py, &result)?;
    let page = work(py, None, Stop::default(), move |_| {
        Report::new(vec![Record::read(result, &[&gait])], Extremes::default(), None).map(|report| report.page())
    })?;
    page.map_err(|why| Error::new_err(why.to_string()))
}
