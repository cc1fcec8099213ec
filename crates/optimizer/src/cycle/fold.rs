//! Where |power| will bend next: the [folds](piaffe_sqp::Problem::folds) of the criterion.
//!
//! In an element a joint does work, and takes some: ∫ |power| is P⁺ + P⁻, and neither is ever negative. Linearized they may become so:
//! while a power keeps its sign in an element, and the criterion is smooth, no derivative tells that P⁺ has an end; where a root is on its way
//! through an element, none tells how far. So both are handed to the solver, each as a term that counts on as its magnitude beyond zero.
//! What that makes of the criterion is the greatest of three of its tangents: the present one, and those of all work done and of all taken.

use super::Cycle;
use super::phase::Phase;
use crate::cost::Signs;
use crate::lgl::NODES;
use piaffe_model::motion::Criterion;
use piaffe_sqp::axpy;

impl Phase {
    /// P⁺ and P⁻ of each joint and element.
    fn folds(&self) -> usize {
        2 * self.cost.drives.len() * self.mesh.elements
    }
}

impl Cycle<'_> {
    /// As many as the criterion may have.
    pub(super) fn count_folds(&self) -> usize {
        match self.criterion {
            Criterion::Energy => self.phases.iter().map(Phase::folds).sum(),
            Criterion::Torque => 0,
        }
    }

    /// What the work that a joint does, or takes, in an element adds to the objective, and its gradient in Θ; `None` if it does or takes
    /// none.
    pub(super) fn write_fold(&self, mut i: usize, row: &mut [f64]) -> Option<f64> {
        let phase = self.phases.iter().find(|p| {
            let rest = i.checked_sub(p.folds());
            i = rest.unwrap_or(i);
            rest.is_none()
        })?;
        let (drive, element) = (i / 2 / phase.mesh.elements, i / 2 % phase.mesh.elements);
        let signs = phase.cost.signs.iter().find(|signs| (signs.drive, signs.element) == (drive, element))?;
        let weights = part(signs, &phase.mesh.lobatto.weights, [1.0, -1.0][i % 2])?;
        let drive = &phase.cost.drives[drive];
        let scale = phase.duration() * self.per_work() / phase.mesh.elements as f64;
        let nodes = || (element * (NODES - 1)..).zip(weights);
        let power = |node: usize| drive.power(phase.linearized(node), signs.side);
        let value = nodes().map(|(node, weight)| scale * weight * power(node)).sum::<f64>();
        if value <= 0.0 {
            return None;
        }
        let mut local = phase.no_parameters();
        local[phase.layout.duration()] = value / phase.duration();
        for (node, weight) in nodes() {
            let partials = drive.power_partials(phase.linearized(node), signs.side);
            phase.add_partials(self.description(), node, &partials, scale * weight, &mut local);
        }
        phase.by_theta.pull(&local, 1.0, row);
        axpy(-value / self.duration, &self.duration_gradient, row);
        Some(value)
    }
}

/// Weights of the powers at the nodes of an element in the integral of one sign's part; `None` if there is no such part.
fn part(signs: &Signs, whole: &[f64; NODES], sign: f64) -> Option<[f64; NODES]> {
    let weights: [f64; NODES] = std::array::from_fn(|i| 0.5 * (signs.weights[i] + sign * whole[i]));
    weights.iter().any(|weight| *weight != 0.0).then_some(weights)
}
