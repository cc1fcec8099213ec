//! `piaffe optimize`: one gait, one criterion, one speed.

use super::{output, summary};
use indicatif::{ProgressBar, ProgressStyle};
use piaffe_optimizer::altered::Altered;
use piaffe_optimizer::result::{GaitResult, Status};
use piaffe_optimizer::search::fastest::nearest_speed;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;

pub fn run(task: Task, real_legs: bool, settings: &Settings, json: Option<&str>) -> anyhow::Result<bool> {
    let Task { mut gait, criterion, speed } = task;
    let altered = real_legs.then(|| Altered::at_real_legs(gait)).transpose().map_err(anyhow::Error::msg)?;
    let bar = progress(settings.starts);
    let ended = |_| bar.inc(1);
    let mut result = task.search(settings, &[], &ended);
    if let Some(altered) = &altered {
        // Sought from the optimum without these limits too.
        gait = altered;
        let (from, virtual_cost): (Vec<_>, _) = (result.theta().into_iter().collect(), result.cost);
        bar.set_position(0);
        result = GaitResult { virtual_cost, ..Task { gait, ..task }.search(settings, &from, &ended) };
    }
    if result.status == Status::Infeasible {
        bar.set_message("nearest speed that works");
        result.nearest_speed = nearest_speed(gait, criterion, speed, settings);
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

/// Counts starts on standard error, with a bar if it is known how many there will be; hidden where that is no terminal.
pub fn progress(starts: Option<usize>) -> ProgressBar {
    let bar = match starts {
        _ if output::is_quiet() => ProgressBar::hidden(),
        Some(starts) => ProgressBar::new(starts as u64),
        None => ProgressBar::no_length(),
    };
    let template =
        if starts.is_some() { "{msg} {bar:30} {pos}/{len} starts {elapsed}" } else { "{msg} {pos} starts {elapsed}" };
    bar.with_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()))
}
