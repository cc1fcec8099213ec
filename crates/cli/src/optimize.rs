//! `piaffe optimize`: one gait, one criterion, one speed.

use super::{output, summary};
use indicatif::{ProgressBar, ProgressStyle};
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_optimizer::search::watch::Event;
use piaffe_sqp::Control;

pub fn run(task: Task, real_legs: bool, settings: &Settings, json: Option<&str>) -> anyhow::Result<bool> {
    let bar = progress(settings.starts);
    let watch = |event| {
        match event {
            Event::Iterate => {}
            Event::Ended(_) => bar.inc(1),
            Event::AtRealLegs => bar.set_position(0),
            Event::NearestSpeed => bar.set_message("nearest speed that works"),
        }
        Control::Continue
    };
    let result = task.answer(real_legs, settings, &watch).map_err(anyhow::Error::msg)?;
    bar.finish_and_clear();
    if json != Some("-") {
        output::quiet_when_closed(summary::print(task.gait.description(), &result))?;
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
