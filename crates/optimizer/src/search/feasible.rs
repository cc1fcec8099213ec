//! Whether there is any motion at all, where a search found no optimum.
//!
//! That a problem is infeasible says something about motions, whatever is to be minimized. So before it is said, every start is
//! asked again: for the nearest motion within all limits, whatever it costs, and for the optimum by the other criterion.

use super::local::{Local, Task};
use super::multi_start::{descend, start};
use super::watch::{Event, Watch};
use piaffe_model::motion::Criterion;
use piaffe_sqp::Iteration;
use rayon::prelude::*;

/// Starts that run side by side; none are asked after one of them knows a motion.
const BATCH: usize = 8;

/// Motions within all limits that neighbours or else these starts of a seed lead to, in their order.
pub fn motions(task: &Task, seed: u64, starts: usize, neighbours: &[Vec<f64>], watch: Watch) -> Vec<Local> {
    let nearest = |theta: &Vec<f64>| {
        let local = task.nearest_motion(theta, &mut |_: &Iteration| watch(Event::Iterate));
        Some(local).filter(Local::is_motion)
    };
    let known: Vec<Local> = neighbours.par_iter().filter_map(nearest).collect();
    if !known.is_empty() {
        return known;
    }
    for first in (0..starts).step_by(BATCH) {
        let batch = (first..starts.min(first + BATCH)).into_par_iter();
        let found: Vec<Local> = batch
            .filter_map(|k| {
                let start = start(task.gait, task.criterion, task.speed, seed, k);
                nearest(&start).or_else(|| by_the_other(task, &start, k, watch))
            })
            .collect();
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

/// The optimum by the other criterion to which the k-th start leads.
fn by_the_other(task: &Task, start: &[f64], k: usize, watch: Watch) -> Option<Local> {
    let other = Criterion::ALL.into_iter().find(|c| *c != task.criterion)?;
    Some(descend(&Task { criterion: other, ..*task }, start, k, watch)).filter(Local::is_motion)
}
