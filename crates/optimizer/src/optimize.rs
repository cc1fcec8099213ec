//! A question and its answer, for those who write a program: the optimum of a gait at a speed, with its receipt.

use crate::altered::Altered;
use crate::result::{GaitResult, Status};
use crate::search::fastest::{is_too_fast, nearest_speed};
use crate::search::local::Task;
use crate::search::multi_start::{Expected, Settings, search_watched};
use crate::search::watch::{Event, Watch, ended};
use piaffe_model::Gait;
use piaffe_model::digits::digits;
use piaffe_model::motion::Criterion;
use piaffe_sqp::Control;
use std::time::Instant;

/// A question that has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a speed of {} m/s cannot be asked for: it must be a positive number", digits(*.speed))]
pub struct Unaskable {
    /// m/s.
    pub speed: f64,
}

impl Unaskable {
    /// If the speed, m/s, is none that can be asked for.
    pub fn of(speed: f64) -> Option<Unaskable> {
        (!(speed.is_finite() && speed > 0.0)).then_some(Unaskable { speed })
    }
}

impl<'a> Task<'a> {
    /// The walk of least energy at 0.6 m/s, until something else is asked for.
    pub fn new(gait: &'a dyn Gait) -> Task<'a> {
        Task { gait, criterion: Criterion::Energy, speed: 0.6 }
    }

    /// At this mean speed, m/s.
    pub fn speed(self, speed: f64) -> Task<'a> {
        Task { speed, ..self }
    }

    /// With the least of this.
    pub fn least(self, criterion: Criterion) -> Task<'a> {
        Task { criterion, ..self }
    }

    /// The best optimum of as many starts as the evidence asks for. Whether there is one, and why not, is in the result:
    /// [`GaitResult::is_optimal`], [`GaitResult::message`](GaitResult#structfield.message).
    ///
    /// # Errors
    /// If the speed is no positive number.
    pub fn optimize(&self) -> Result<GaitResult, Unaskable> {
        self.optimize_with(&Settings::default())
    }

    /// The same with starts of one's own choice.
    ///
    /// # Errors
    /// If the speed is no positive number.
    pub fn optimize_with(&self, settings: &Settings) -> Result<GaitResult, Unaskable> {
        match Unaskable::of(self.speed) {
            Some(why) => Err(why),
            None => Ok(self.search(settings, &[], &|_| {})),
        }
    }

    /// The same from these motions' variables Θ too, at a speed that can be asked for. `done(k)` is told when start `k` has ended.
    pub fn search(&self, settings: &Settings, from: &[Vec<f64>], done: &(dyn Fn(usize) + Sync)) -> GaitResult {
        self.watched(settings, from, &ended(done))
    }

    /// The answer as it leaves the program, at a speed that can be asked for: where there is no motion with the nearest speed that
    /// works, and with all that is told about an optimum. With `real_legs`, limits hold at each real leg too.
    ///
    /// # Errors
    /// If limits cannot be imposed at each real leg, why.
    pub fn answer(&self, real_legs: bool, settings: &Settings, watch: Watch) -> Result<GaitResult, String> {
        let started = Instant::now();
        let altered = real_legs.then(|| Altered::at_real_legs(self.gait)).transpose()?;
        let mut result = self.watched(settings, &[], watch);
        let mut task = *self;
        if let Some(altered) = &altered {
            task.gait = altered;
            // Sought from the optimum without these limits too.
            let (from, virtual_cost): (Vec<_>, _) = (result.theta().into_iter().collect(), result.cost);
            watch(Event::AtRealLegs);
            result = GaitResult { virtual_cost, ..task.watched(settings, &from, watch) };
        }
        // At a speed that is beyond all reason searches may not even see what is in the way.
        let lost = !result.is_optimal() && is_too_fast(task.gait, self.speed);
        let none = lost || result.status == Status::Infeasible;
        if none && watch(Event::NearestSpeed) == Control::Continue {
            result.nearest_speed = nearest_speed(task.gait, self.criterion, self.speed, settings);
        }
        result.examine(task.gait, settings.examination);
        result.seconds = started.elapsed().as_secs_f64();
        Ok(result)
    }

    /// The same as [`Task::search`], for who wants to know more of it or may end it.
    pub fn watched(&self, settings: &Settings, from: &[Vec<f64>], watch: Watch) -> GaitResult {
        let Task { gait, criterion, speed } = *self;
        let started = Instant::now();
        let found = search_watched(self, settings, from, Expected::Nothing, watch);
        GaitResult::new(gait, criterion, speed, &found, settings, || started.elapsed().as_secs_f64())
    }
}
