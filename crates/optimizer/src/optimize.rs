//! A question and its answer, for those who write a program: the optimum of a gait at a speed, with its receipt.

use crate::result::GaitResult;
use crate::search::local::Task;
use crate::search::multi_start::{Settings, search};
use piaffe_model::Gait;
use piaffe_model::motion::Criterion;
use std::time::Instant;

/// A question that has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a speed of {speed} m/s cannot be asked for: it must be a positive number")]
pub struct Unaskable {
    /// m/s.
    pub speed: f64,
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
        let Task { gait, criterion, speed } = *self;
        if !(speed.is_finite() && speed > 0.0) {
            return Err(Unaskable { speed });
        }
        let started = Instant::now();
        let found = search(gait, criterion, speed, settings, &|_| {});
        Ok(GaitResult::new(gait, criterion, speed, &found, settings.seed, || started.elapsed().as_secs_f64()))
    }
}
