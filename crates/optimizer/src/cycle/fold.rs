//! Where |power| will bend next: the [folds](piaffe_sqp::Problem::folds) of the criterion.
//!
//! While a joint's power keeps its sign in an element, the criterion counts ± its integral there, and is as smooth as that. A step that
//! turns the sign around meets a bend that no derivative tells of. So the integrals themselves are handed to the solver, each as a
//! term that counts on as its magnitude. It is less than what the criterion will be only while the power's root is on its way through the
//! element.

use super::Cycle;
use super::phase::Phase;
use crate::lgl::NODES;
use piaffe_model::motion::Criterion;
use piaffe_sqp::axpy;
use smallvec::SmallVec;

impl Cycle<'_> {
    /// As many as there are joints and elements, if the criterion has any.
    pub(super) fn count_folds(&self) -> usize {
        match self.criterion {
            Criterion::Energy => self.phases.iter().map(|p| p.cost.drives.len() * p.mesh.elements).sum(),
            Criterion::Torque => 0,
        }
    }

    /// What the power of a joint in an element adds to the objective, and its gradient in Θ; `None` if it changes its sign there.
    pub(super) fn write_fold(&self, mut i: usize, row: &mut [f64]) -> Option<f64> {
        let phase = self.phases.iter().find(|p| {
            let count = p.cost.drives.len() * p.mesh.elements;
            i.checked_sub(count).map(|rest| i = rest).is_none()
        })?;
        let (drive, element) = (i / phase.mesh.elements, i % phase.mesh.elements);
        let OneSided { integral, side } = phase.one_sided(drive, element, self.smoothing * self.units.power())?;
        let scale = phase.duration() * self.per_work() / phase.mesh.elements as f64 * integral.signum();
        let value = scale * integral;
        let mut local = phase.no_parameters();
        local[phase.layout.duration()] = value / phase.duration();
        for (i, weight) in phase.mesh.lobatto.weights.iter().enumerate() {
            let node = element * (NODES - 1) + i;
            let mut state = SmallVec::<[f64; 32]>::from_elem(0.0, phase.instants.width());
            for (quantity, partial) in phase.cost.drives[drive].power_partials(phase.linearized(node), side) {
                axpy(scale * weight * partial, phase.instants.gradient(node, quantity), &mut state);
            }
            phase.pull(self.description(), node, &state, &mut local);
        }
        phase.by_theta.pull(&local, 1.0, row);
        axpy(-value / self.duration, &self.duration_gradient, row);
        Some(value)
    }
}

/// A power that keeps its sign in an element.
struct OneSided {
    /// Over the element, per unit of it, W.
    integral: f64,
    /// The sign of the rate, and so of dry friction, where there is any.
    side: f64,
}

impl Phase {
    /// What the power of a joint is in an element, if it keeps its sign there and is everywhere beyond what kinks are rounded off by (W).
    fn one_sided(&self, drive: usize, element: usize, smoothing: f64) -> Option<OneSided> {
        let joint = &self.cost.drives[drive];
        let first = element * (NODES - 1);
        if self.cost.kinks.iter().any(|kink| (kink.drive, kink.first) == (drive, first)) {
            return None;
        }
        let rates: [f64; NODES] = std::array::from_fn(|i| self.linearized(first + i)[joint.rate()]);
        let side = if joint.coulomb() == 0.0 { 0.0 } else { rates[0].signum() };
        let power: [f64; NODES] = std::array::from_fn(|i| joint.power(self.linearized(first + i), side));
        let sign = power[0].signum();
        let keeps = rates.iter().all(|rate| side * rate >= 0.0) && power.iter().all(|p| sign * p > smoothing);
        let integral = || power.iter().zip(&self.mesh.lobatto.weights).map(|(p, w)| p * w).sum();
        keeps.then(|| OneSided { integral: integral(), side })
    }
}
