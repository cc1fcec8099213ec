//! `piaffe optimize`: one gait, one criterion, one speed.

use super::{output, summary};
use indicatif::{ProgressBar, ProgressStyle};
use piaffe::altered::Altered;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::result::{GaitResult, Status};
use piaffe::search::atlas::theta;
use piaffe::search::fastest::nearest_speed;
use piaffe::search::local::Task;
use piaffe::search::multi_start::{Settings, search, search_from};
use std::time::Instant;

pub fn run(task: Task, real_legs: bool, settings: &Settings, json: Option<&str>) -> anyhow::Result<bool> {
    let Task { mut gait, criterion, speed } = task;
    let bar = progress(settings.starts as u64, "starts");
    let mut result = solve(gait, criterion, speed, settings, &bar);
    let altered;
    if real_legs {
        altered = Altered::at_real_legs(gait).map_err(anyhow::Error::msg)?;
        gait = &altered;
        bar.set_position(0);
        result = at_real_legs(&Task { gait, ..task }, &result, settings, &bar);
    }
    if result.status == Status::Infeasible {
        bar.set_message("nearest speed that works");
        result.nearest_speed = nearest_speed(gait, speed, settings);
    }
    result.examine(gait);
    bar.finish_and_clear();
    if json != Some("-") {
        output::quiet_when_closed(summary::print(gait.description(), &result))?;
    }
    if let Some(target) = json {
        output::json_to(target, &result)?;
        if target != "-" {
            output::say!("written to {target}");
        }
    }
    Ok(result.is_optimal())
}

/// The same task with the limits at each real leg, sought from the optimum without them too.
fn at_real_legs(task: &Task, without: &GaitResult, settings: &Settings, bar: &ProgressBar) -> GaitResult {
    let Task { gait, criterion, speed } = *task;
    let started = Instant::now();
    let from: Vec<Vec<f64>> = theta(gait, without).into_iter().collect();
    let found = search_from(gait, criterion, speed, settings, &from, &|_| bar.inc(1));
    let mut result = GaitResult::new(gait, criterion, speed, &found, settings.seed, || started.elapsed().as_secs_f64());
    result.virtual_cost = without.cost;
    result
}

/// Searches and verifies; the bar advances with every start.
pub fn solve(gait: &dyn Gait, criterion: Criterion, speed: f64, settings: &Settings, bar: &ProgressBar) -> GaitResult {
    let started = Instant::now();
    let found = search(gait, criterion, speed, settings, &|_| bar.inc(1));
    GaitResult::new(gait, criterion, speed, &found, settings.seed, || started.elapsed().as_secs_f64())
}

/// A bar on standard error; hidden where that is no terminal.
pub fn progress(length: u64, unit: &str) -> ProgressBar {
    let bar = if output::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(length) };
    let style = ProgressStyle::with_template(&format!("{{msg}} {{bar:30}} {{pos}}/{{len}} {unit} {{elapsed}}"));
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}
