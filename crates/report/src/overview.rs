//! What a sweep says of its results as a whole, in `sweep.json`: all of it follows from the results that stand beside it.

use crate::Extremes;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::audit::{Audit, Statement};
use piaffe_optimizer::result::{GaitResult, Status};
use piaffe_optimizer::search::crossover::Comparison;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The search's own account in it.
const ENDED: &str = "maximum_speeds.ended_by";

/// Results over speeds, in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overview {
    pub points: Vec<Point>,
    pub maximum_speeds: Vec<Greatest>,
    pub comparisons: Vec<Comparison>,
}

/// One of the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub gait: String,
    pub criterion: Criterion,
    /// m/s.
    pub speed: f64,
    pub status: Status,
    pub cost: Option<f64>,
    /// s.
    pub durations: Vec<f64>,
    /// Costs of all local optima that were found.
    pub local_optima: Vec<f64>,
    /// Name of the result's file, in the same folder.
    pub file: String,
}

/// The greatest speed of a gait.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Greatest {
    pub gait: String,
    /// m/s.
    pub speed: f64,
    /// What conflicts just above it, weightiest first. That was seen by the search and cannot be seen from results.
    #[serde(deserialize_with = "piaffe_model::limit::names")]
    pub ended_by: Vec<String>,
}

impl Overview {
    /// What results say together. `ends`: where a search found that gaits end; where a result does not reach it, the gait's
    /// greatest speed is that of its fastest optimum, and nothing is said to have ended it.
    pub fn new(results: &[GaitResult], ends: &[Greatest]) -> Overview {
        let mut gaits: Vec<&str> = Vec::new();
        for r in results {
            if !gaits.contains(&r.gait.as_str()) {
                gaits.push(&r.gait);
            }
        }
        let line = |gait: &str, criterion: Criterion| {
            let mut line: Vec<GaitResult> =
                results.iter().filter(|r| r.gait == gait && r.criterion == criterion).cloned().collect();
            line.sort_by(|a, b| a.speed.total_cmp(&b.speed));
            line
        };
        let lines: Vec<[Vec<GaitResult>; 2]> = gaits.iter().map(|gait| Criterion::ALL.map(|c| line(gait, c))).collect();
        let mut comparisons = Vec::new();
        for c in 0..Criterion::ALL.len() {
            for (k, a) in lines.iter().enumerate() {
                comparisons.extend(lines[k + 1..].iter().filter_map(|b| Comparison::of([&a[c], &b[c]])));
            }
        }
        let all = || lines.iter().flatten().flatten();
        let greatest = |end: &Greatest| {
            let speeds = all().filter(|r| r.gait == end.gait && r.is_optimal()).map(|r| r.speed);
            let speed = speeds.max_by(f64::total_cmp)?;
            let ended_by = if speed == end.speed { end.ended_by.clone() } else { Vec::new() };
            Some(Greatest { gait: end.gait.clone(), speed, ended_by })
        };
        Overview {
            points: all().map(Point::new).collect(),
            maximum_speeds: ends.iter().filter_map(greatest).collect(),
            comparisons,
        }
    }

    /// Whether all that is stated follows from the results. `stated` is the file, `self` what was read from it.
    pub fn audit(&self, stated: &Value, results: &[GaitResult]) -> Audit {
        let mut found = Overview::new(results, &self.maximum_speeds);
        for (found, stated) in found.maximum_speeds.iter_mut().zip(&self.maximum_speeds) {
            found.ended_by.clone_from(&stated.ended_by);
        }
        let found = serde_json::to_value(found).unwrap_or_default();
        let entries = stated.as_object().into_iter().flatten();
        let of_search = Statement::not_derivable(ENDED, "where a gait ends, and by what, was seen by the search");
        let compared = entries.map(|(key, value)| Statement::of(key, value, &found[key]));
        Audit { name: "a sweep's overview".into(), statements: compared.chain([of_search]).collect() }
    }

    /// What is told beside the points.
    pub fn extremes(self) -> Extremes {
        Extremes { maximum_speeds: self.maximum_speeds }
    }
}

impl Point {
    fn new(r: &GaitResult) -> Point {
        Point {
            gait: r.gait.clone(),
            criterion: r.criterion,
            speed: r.speed,
            status: r.status,
            cost: r.cost,
            durations: r.durations.clone(),
            local_optima: r.local_optima.iter().map(|o| o.cost).collect(),
            file: r.file_name(),
        }
    }
}
