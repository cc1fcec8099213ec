//! `piaffe optimize`: one gait, one criterion, one speed.

use super::progress::{Counted, Progress};
use super::{output, robots, summary};
use piaffe_model::Gait;
use piaffe_optimizer::cycle::theta;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_optimizer::search::relative::related;
use piaffe_optimizer::search::watch::Event;
use piaffe_sqp::Control;
use std::time::Instant;

/// `started` is when the program was: its time is told.
pub fn run(
    task: Task,
    real_legs: bool,
    settings: &Settings,
    json: Option<&str>,
    started: Instant,
) -> anyhow::Result<bool> {
    output::check(json)?;
    let bar = Progress::new(Counted::Starts(settings.starts));
    let watch = |event| {
        match event {
            Event::Iterate => {}
            Event::Ended(_) => bar.inc(1),
            Event::AtRealLegs => bar.set_position(0),
            Event::NearestSpeed => bar.set_message("nearest speed found to work"),
        }
        Control::Continue
    };
    let mut result = task.answer(real_legs, settings, &watch).map_err(anyhow::Error::msg)?;
    let described = json != Some("-");
    let mut grounded = None;
    if described && !summary::shortest_flights(task.gait.description(), &result).is_empty() {
        bar.set_message("without flight");
        grounded = without_flights(task.gait, &result, settings);
    }
    bar.finish_and_clear();
    result.seconds = started.elapsed().as_secs_f64();
    if let Some(target) = json {
        output::json_to(target, &result)?;
    }
    if described {
        output::quiet_when_closed(summary::print(task.gait.description(), &result, grounded.as_ref()))?;
        if let Some(target) = json {
            output::say!("written to {target}");
        }
    }
    Ok(result.is_optimal())
}

/// Starts of a search that only sets an optimum beside another one.
const STARTS_BESIDE: usize = 8;

/// The optimum of the same task by a gait of this robot that stands alike and never flies, if there is one.
fn without_flights(gait: &dyn Gait, result: &GaitResult, asked: &Settings) -> Option<GaitResult> {
    let (of, motion) = (gait.description(), result.motion()?);
    let grounded = robots::of_same_robot(of.key).find_map(|walk| {
        let d = walk.description();
        Some((walk, related(of, &motion, d).filter(|_| !d.flies())?))
    });
    let (walk, motion) = grounded?;
    let task = Task { gait: walk, criterion: result.criterion, speed: result.speed };
    let search = |starts| {
        let settings = Settings { starts, examination: asked.examination, ..Settings::default() };
        task.search(&settings, &[theta(&motion)], &|_| {})
    };
    // Few starts do not settle that there is nothing.
    Some(search(Some(STARTS_BESIDE))).filter(GaitResult::is_optimal).or_else(|| Some(search(None)))
}
