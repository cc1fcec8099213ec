//! Whether there is any motion at all, where a search found no optimum.
//!
//! That a problem is infeasible says something about motions, whatever is to be minimized. So before it is said, every start is
//! asked again: for the optimum of another criterion, and if there is none, for the nearest motion within all limits.

use super::local::{Local, Task};
use super::multi_start::start;
use super::watch::{Event, Watch};
use piaffe_model::motion::Criterion;
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

/// A motion to which the k-th start of a seed leads.
fn motion(task: &Task, seed: u64, k: usize, watch: Watch) -> Option<Local> {
    let start = start(task.gait, task.criterion, task.speed, seed, k);
    let others = Criterion::ALL.into_iter().filter(|c| *c != task.criterion);
    let optima = others.map(|criterion| Task { criterion, ..*task }.descend(&start, &mut |_| watch(Event::Iterate)));
    let nearest = std::iter::once_with(|| task.nearest_motion(&start, &mut |_| watch(Event::Iterate)));
    optima.chain(nearest).find(Local::is_motion)
}
