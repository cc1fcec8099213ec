//! Answers to many points, one after another.

use crate::error::Error;
use crate::optimize::{criterion, settings, speed};
use crate::result::text;
use crate::robot::Robot;
use crate::work::{Stop, work};
use piaffe::Task;
use piaffe::interpreter::Interpreted;
use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::search::multi_start::Settings;
use piaffe::search::watch::Event;
use piaffe::sensitivity::sensitivities;
use piaffe::sqp::Control;
use pyo3::prelude::*;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::time::Instant;

/// Numbers of the specification, the gait, the criterion, and the speed in m/s.
type Point = (BTreeMap<String, f64>, String, String, f64);

/// Rows as JSON, in the order of the points, and what each took, s.
#[pyfunction]
pub fn answers(
    py: Python<'_>,
    robot: &Robot,
    points: Vec<Point>,
    starts: Option<usize>,
    seed: u64,
    stop: &Stop,
) -> PyResult<(String, Vec<f64>)> {
    let (robot, settings) = (robot.robot().clone(), settings(starts, seed)?);
    let answers = work(py, Some(1), stop.clone(), move |stop| {
        let (mut last, mut rows, mut seconds) = (None, Vec::new(), Vec::new());
        for point in &points {
            let started = Instant::now();
            rows.push(row(&robot, point, &settings, &mut last, stop));
            seconds.push(started.elapsed().as_secs_f64());
            if stop.is_wanted() {
                return Err("the study was stopped");
            }
        }
        Ok((rows, seconds))
    })?;
    let (rows, seconds) = answers.map_err(Error::new_err)?;
    Ok((text(&rows)?, seconds))
}

/// What is wrong with these names: of numbers that the specification has not.
#[pyfunction]
pub fn unknown(robot: &Robot, names: Vec<String>) -> Vec<String> {
    let mut files = robot.robot().files().clone();
    // Any number will do: none is used.
    names.iter().filter_map(|name| files.set(name, 1.0).err()).collect()
}

/// Points of one design and gait share what was derived for it.
type Derived = (BTreeMap<String, f64>, String, Result<Interpreted, String>);

fn row(robot: &piaffe::Robot, point: &Point, settings: &Settings, last: &mut Option<Derived>, stop: &Stop) -> Value {
    let (numbers, gait, criterion, speed) = point;
    let derive = || {
        let named = numbers.iter().map(|(name, value)| (name.as_str(), *value));
        robot.with_all(named).and_then(|robot| robot.gait(gait)).map_err(|why| why.to_string())
    };
    let known = last.take().filter(|(known, of, _)| known == numbers && of == gait);
    let (.., derived) = last.insert(known.unwrap_or_else(|| (numbers.clone(), gait.clone(), derive())));
    let question = criterion_of(criterion, *speed);
    match (derived, question) {
        (Ok(gait), Ok((criterion, speed))) => {
            let watch = |_: Event| if stop.is_wanted() { Control::Stop } else { Control::Continue };
            let task = Task { gait, criterion, speed };
            told(&task, &task.watched(settings, &[], &watch), numbers)
        }
        (Err(why), _) => none(why),
        (_, Err(why)) => none(&why.to_string()),
    }
}

fn criterion_of(name: &str, at: f64) -> PyResult<(Criterion, f64)> {
    Ok((criterion(name)?, speed(at)?))
}

/// The row of a point that asks for nothing that there is.
fn none(why: &str) -> Value {
    json!({ "status": "no-question", "reason": why })
}

/// What a row says of a result.
fn told(task: &Task, result: &GaitResult, numbers: &BTreeMap<String, f64>) -> Value {
    let mut row = Map::new();
    let mut put = |key: &str, value: Value| row.insert(key.into(), value);
    put("status", json!(result.status));
    put("cost", json!(result.cost));
    let costs = result.costs.filter(|_| result.is_optimal());
    put("energy", json!(costs.map(|costs| costs.energy)));
    put("torque", json!(costs.map(|costs| costs.torque)));
    put("step_length", json!(result.step_length));
    put("durations", json!(result.durations));
    if let Some(receipt) = &result.receipt {
        put("violation", json!(receipt.max_violation));
        put("cycle_error", json!(receipt.cycle_error));
        put("kkt_residual", json!(receipt.kkt_residual));
        put("active", json!(receipt.active));
    }
    put("certified", json!(result.certificate.as_ref().map(|certificate| certificate.is_certified())));
    if let Some(motion) = result.motion()
        && let Ok(slopes) = sensitivities(task.gait, task.criterion, task.speed, &motion)
    {
        let of = |name: &str| slopes.slopes.iter().find(|slope| slope.numbers.iter().any(|number| number == name));
        let slopes = numbers.keys().map(String::as_str).chain(["speed"]);
        put("slopes", slopes.map(|name| (name.to_string(), json!(of(name).map(|slope| slope.slope)))).collect());
    }
    if !result.is_optimal() {
        let conflicts: Vec<&str> = result.conflicts.iter().map(|conflict| conflict.constraint.as_str()).collect();
        put("reason", json!(format!("{} {}", result.message, conflicts.join(", ")).trim_end()));
    }
    Value::Object(row)
}
