//! Whether there is any motion at all, where a search found no optimum.
//!
//! That a problem is infeasible says something about motions, whatever is to be minimized. So before it is said, every start is
//! asked again: for the nearest motion within all limits, whatever it costs, and for the optimum by the smooth criterion.

use super::local::{Local, Task};
use super::multi_start::start;
use super::watch::{Event, Watch};
use piaffe_model::motion::Criterion;
use piaffe_sqp::Iteration;
use rayon::prelude::*;

/// Starts that run side by side; none are asked after one of them knows a motion.
const BATCH: usize = 8;

/// Motions within all limits that these starts of a seed lead to, in their order.
pub fn motions(task: &Task, seed: u64, starts: usize, watch: Watch) -> Vec<Local> {
    for first in (0..starts).step_by(BATCH) {
        let batch = (first..starts.min(first + BATCH)).into_par_iter();
        let found: Vec<Local> = batch.filter_map(|k| motion(task, seed, k, watch)).collect();
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

/// A motion to which the k-th start of a seed leads: the nearest one, or the optimum by the smooth criterion if that is another one.
fn motion(task: &Task, seed: u64, k: usize, watch: Watch) -> Option<Local> {
    let start = start(task.gait, task.criterion, task.speed, seed, k);
    let observe = &mut |_: &Iteration| watch(Event::Iterate);
    let nearest = task.nearest_motion(&start, observe);
    if nearest.is_motion() {
        return Some(nearest);
    }
    let smooth = Task { criterion: Criterion::Torque, ..*task };
    (task.criterion != smooth.criterion).then(|| smooth.descend(&start, observe)).filter(Local::is_motion)
}
