//! Studies: a question, of which workers get the outline and their points.

use crate::error::Error;
use crate::optimize::criterion;
use crate::result::text;
use crate::robot::Robot;
use crate::work::{Stop, apart, work};
use piaffe::study::{Answers, Beyond, Cell, Column, Designs, Kind, Point, Search, Study};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// What a study asks.
#[pyclass(frozen, module = "piaffe._piaffe")]
pub struct Question {
    robot: Robot,
    study: Study,
}

fn beyond(name: &str) -> PyResult<Beyond> {
    let known = || Beyond::ALL.map(|beyond| format!("\"{}\"", beyond.name())).join(", ");
    let found = Beyond::ALL.into_iter().find(|beyond| beyond.name() == name);
    found.ok_or_else(|| Error::new_err(format!("`also` has \"{name}\": give some of {}", known())))
}

/// A cell as JSON has it.
fn cell(cell: Cell) -> serde_json::Value {
    match cell {
        Cell::Integer(value) => value.into(),
        Cell::Number(value) => value.into(),
        Cell::Text(value) => value.into(),
    }
}

/// What `Question` is made of, for a process elsewhere.
type Parts = (
    Robot,
    Vec<String>,
    Vec<Vec<f64>>,
    Vec<String>,
    Vec<&'static str>,
    Vec<f64>,
    bool,
    Option<usize>,
    u64,
    Vec<&'static str>,
);

#[pymethods]
impl Question {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        names: Vec<String>,
        rows: Vec<Vec<f64>>,
        gaits: Vec<String>,
        criteria: Vec<String>,
        speeds: Vec<f64>,
        real_legs: bool,
        starts: Option<usize>,
        seed: u64,
        beyond: Vec<String>,
    ) -> PyResult<Question> {
        let study = Study {
            robot: robot.robot().clone(),
            designs: Designs::listed(names, &rows).map_err(Error::new_err)?,
            gaits,
            criteria: criteria.iter().map(|name| criterion(name)).collect::<PyResult<_>>()?,
            speeds,
            real_legs,
            search: Search { starts, seed },
            beyond: beyond.iter().map(|name| self::beyond(name)).collect::<PyResult<_>>()?,
        };
        match apart(py, || study.faults())? {
            faults if faults.is_empty() => Ok(Question { robot: robot.clone(), study }),
            faults => Err(Error::new_err(faults.join("\n"))),
        }
    }

    /// The question without its designs, but for those that have all that differs.
    fn outline(&self) -> Question {
        Question { robot: self.robot.clone(), study: self.study.outline() }
    }

    /// How many points it has.
    fn __len__(&self) -> usize {
        self.study.points()
    }

    /// Tells one study from another.
    #[getter]
    fn fingerprint(&self) -> String {
        self.study.fingerprint()
    }

    /// Names of the table's columns and what they have: "integer", "number" or "text".
    #[getter]
    fn columns(&self) -> Vec<(String, &'static str)> {
        let kind = |column: &Column| match column.kind() {
            Kind::Integer => "integer",
            Kind::Number => "number",
            Kind::Text => "text",
        };
        Column::all(&self.study).iter().map(|column| (column.name(), kind(column))).collect()
    }

    /// The gait and the criterion of a point.
    fn kind(&self, number: usize) -> (&str, &'static str) {
        let point = self.study.point(number);
        (point.gait, point.criterion.name())
    }

    /// A point, for `answers`.
    fn point(&self, number: usize) -> (usize, Vec<f64>) {
        (number, self.study.point(number).numbers.to_vec())
    }

    fn __getnewargs__(&self) -> Parts {
        let Study { designs, gaits, criteria, speeds, real_legs, search, beyond, .. } = &self.study;
        let rows = (0..designs.count()).map(|design| designs.numbers(design).to_vec()).collect();
        let (criteria, beyond) =
            (criteria.iter().map(|c| c.name()).collect(), beyond.iter().map(|b| b.name()).collect());
        let (names, gaits) = (designs.names().to_vec(), gaits.clone());
        let robot = self.robot.clone();
        (robot, names, rows, gaits, criteria, speeds.clone(), *real_legs, search.starts, search.seed, beyond)
    }
}

/// What answers a question, with the question's fingerprint.
type Known = (String, Arc<Answers<'static>>);

/// Of the last question of this process: its chunks come one after another.
static LAST: Mutex<Option<Known>> = Mutex::new(None);

/// What answers a question of this outline. The outline stays, as what it derives does: some kilobytes.
fn answers_to(outline: &Study) -> Arc<Answers<'static>> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let fingerprint = outline.fingerprint();
    if let Some((known, answers)) = &*last
        && *known == fingerprint
    {
        return answers.clone();
    }
    let answers = Arc::new(Answers::new(Box::leak(Box::new(outline.clone()))));
    *last = Some((fingerprint, answers.clone()));
    answers
}

/// Rows of these points of a question of this outline, one after another, as JSON; and what each took, s. The threads are for what
/// they have in common.
#[pyfunction]
pub fn answers(
    py: Python<'_>,
    outline: &Question,
    points: Vec<(usize, Vec<f64>)>,
    threads: Option<usize>,
    stop: &Stop,
) -> PyResult<(String, Vec<f64>)> {
    let study = outline.study.clone();
    let found = work(py, threads, stop.clone(), move |stop| {
        let (answers, columns) = (answers_to(&study), Column::all(&study));
        let (mut rows, mut seconds) = (Vec::new(), Vec::new());
        for (number, numbers) in &points {
            if stop.is_wanted() {
                return Err("the study was stopped");
            }
            let started = Instant::now();
            // All points of a design are alike but for its numbers.
            let point = Point {
                number: *number,
                design: number / study.of_design(),
                numbers,
                ..study.point(number % study.of_design())
            };
            let row = answers.answer(&point);
            rows.push(columns.iter().map(|column| cell(column.of(&row))).collect::<Vec<_>>());
            seconds.push(started.elapsed().as_secs_f64());
        }
        Ok((rows, seconds))
    })?;
    let (rows, seconds) = found.map_err(Error::new_err)?;
    Ok((text(&rows)?, seconds))
}
