//! Whether the optima at two speeds are of one branch: whether each, carried to the other's speed, becomes the other.

use super::local::{Local, Task};
use crate::result::GaitResult;
use piaffe_model::Gait;
use piaffe_sqp::Control;

/// Equal steps in which an optimum is carried: one where that is enough, more where the branch bends.
const STEPS: [usize; 3] = [1, 4, 16];
/// Two optima are one if their costs and durations differ by less than these shares.
const COST: f64 = 1e-4;
const DURATION: f64 = 1e-2;

/// Whether two optima of one gait and criterion are of one branch. Both must be carried: where a branch ends, what falls off its
/// end may land on the other.
pub fn connected(gait: &dyn Gait, a: &GaitResult, b: &GaitResult) -> bool {
    a.criterion == b.criterion && reaches(gait, a, b) && reaches(gait, b, a)
}

/// Whether an optimum, carried to another's speed, becomes that.
fn reaches(gait: &dyn Gait, from: &GaitResult, to: &GaitResult) -> bool {
    STEPS.into_iter().any(|steps| carried(gait, from, to.speed, steps).is_some_and(|found| same(&found, to)))
}

/// The optimum in which a motion's variables Θ end that are carried to a task at once, if it is one.
pub fn carried_to(task: &Task, theta: &[f64]) -> Option<Local> {
    Some(task.carry(theta, &mut |_| Control::Continue)).filter(|local| local.status.is_optimal())
}

fn carried(gait: &dyn Gait, from: &GaitResult, speed: f64, steps: usize) -> Option<Local> {
    let mut theta = from.theta()?;
    let mut found = None;
    for k in 1..=steps {
        let speed = from.speed + (speed - from.speed) * k as f64 / steps as f64;
        let task = Task { gait, criterion: from.criterion, speed };
        let local = carried_to(&task, &theta)?;
        theta.clone_from(&local.theta);
        found = Some(local);
    }
    found
}

/// Whether what was found anew is a motion that is known.
pub fn same(found: &Local, known: &GaitResult) -> bool {
    let near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
    let mut durations = found.motion.durations().zip(&known.durations);
    known.cost.is_some_and(|cost| near(found.costs.of(known.criterion), cost, COST))
        && durations.all(|(a, b)| near(a, *b, DURATION))
}
