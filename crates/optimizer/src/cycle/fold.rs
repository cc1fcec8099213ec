//! Where |power| will bend next: the [folds](piaffe_sqp::Problem::folds) of the criterion.
//!
//! In an element a joint does work, and takes some: ∫ |power| is P⁺ + P⁻, and neither is ever negative. Linearized they may become so:
//! while a power keeps its sign in an element, and the criterion is smooth, no derivative tells that P⁺ has an end; where a root is on its way
//! through an element, none tells how far. So both are handed to the solver, each as a term that counts on as its magnitude beyond zero.
//! What that makes of the criterion is the greatest of three of its tangents: the present one, and those of all work done and of all taken.

use super::Cycle;
use super::phase::Phase;
use crate::lgl::NODES;
use piaffe_model::Description;
use piaffe_model::motion::Criterion;
use piaffe_sqp::{axpy, dot};

/// What the work that a joint does, or takes, in an element adds to the objective at the linearized point.
#[derive(Clone, Copy, Debug)]
struct Part {
    drive: usize,
    /// First node of the element.
    first: usize,
    /// The sign of dry friction.
    side: f64,
    /// Of the powers at the nodes.
    weights: [f64; NODES],
    value: f64,
}

/// The parts of a phase.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// Of work done and of work taken, by each joint, in each element.
    slots: Vec<Option<Part>>,
    /// Relative derivatives of them all in the duration of the phase and in that of the cycle.
    by_duration: [f64; 2],
}

impl Phase {
    /// How many parts there may be: of work done and taken, by each joint, in each element.
    pub(super) fn folds(&self) -> usize {
        2 * self.cost.drives.len() * self.mesh.elements
    }

    /// Keeps the parts of the criterion at the linearized point, where it counts `per_work` and the cycle lasts `duration`.
    pub(super) fn divide(&mut self, per_work: f64, duration: f64) {
        let (drives, own) = (self.cost.drives.len(), self.duration());
        let scale = own * per_work / self.mesh.elements as f64;
        let mut parts = std::mem::take(&mut self.parts);
        parts.by_duration = [1.0 / own, -1.0 / duration];
        parts.slots.clear();
        parts.slots.resize(self.folds(), None);
        for signs in &self.cost.signs {
            let first = signs.element * (NODES - 1);
            let drive = &self.cost.drives[signs.drive];
            let powers: [f64; NODES] = std::array::from_fn(|i| drive.power(self.linearized(first + i), signs.side));
            let slots = &mut parts.slots[2 * (signs.element * drives + signs.drive)..][..2];
            for (slot, sign) in slots.iter_mut().zip([1.0, -1.0]) {
                let whole = &self.mesh.lobatto.weights;
                let weights = std::array::from_fn(|i| 0.5 * scale * (signs.weights[i] + sign * whole[i]));
                let value = dot(&weights, &powers);
                let part = Part { drive: signs.drive, first, side: signs.side, weights, value };
                *slot = (value > 0.0).then_some(part);
            }
        }
        self.parts = parts;
    }

    /// Adds to the changes of all parts what they have from a node, where its quantities change like this.
    pub(super) fn add_changes(&self, node: usize, change: &[f64], out: &mut [f64]) {
        let count = 2 * self.cost.drives.len();
        let later = node / (NODES - 1);
        let earlier = later.checked_sub(1).filter(|_| node.is_multiple_of(NODES - 1));
        for element in earlier.into_iter().chain([later]).filter(|element| *element < self.mesh.elements) {
            let range = element * count..(element + 1) * count;
            for (pair, out) in self.parts.slots[range.clone()].chunks(2).zip(out[range].chunks_mut(2)) {
                let Some(any) = pair.iter().flatten().next() else { continue };
                let partials = self.cost.drives[any.drive].power_partials(self.linearized(node), any.side);
                let along: f64 = partials.iter().map(|(quantity, partial)| partial * change[*quantity]).sum();
                for (part, out) in pair.iter().zip(out) {
                    *out += part.map_or(0.0, |part| part.weights[node - part.first] * along);
                }
            }
        }
    }

    /// Adds what they have from the durations of the phase and of the cycle.
    pub(super) fn add_stretch(&self, durations: [f64; 2], out: &mut [f64]) {
        let stretch = dot(&self.parts.by_duration, &durations);
        for (part, out) in self.parts.slots.iter().zip(out) {
            *out += part.map_or(0.0, |part| part.value * stretch);
        }
    }

    fn write_part(&self, d: &Description, part: &Part, row: &mut [f64]) {
        let mut local = self.no_parameters();
        local[self.layout.duration()] = part.value * self.parts.by_duration[0];
        for (node, weight) in (part.first..).zip(part.weights) {
            let partials = self.cost.drives[part.drive].power_partials(self.linearized(node), part.side);
            self.add_partials(d, node, &partials, weight, &mut local);
        }
        self.by_theta.pull(&local, 1.0, row);
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

    /// Keeps the parts of the criterion at the linearized point.
    pub(super) fn divide_criterion(&mut self) {
        if self.criterion == Criterion::Energy {
            let (per_work, duration) = (self.per_work(), self.duration);
            self.phases.iter_mut().for_each(|phase| phase.divide(per_work, duration));
        }
    }

    /// Fold `i`, and its phase.
    fn part(&self, mut i: usize) -> Option<(&Phase, &Part)> {
        let phase = self.phases.iter().find(|p| {
            let rest = i.checked_sub(p.folds());
            i = rest.unwrap_or(i);
            rest.is_none()
        })?;
        Some((phase, phase.parts.slots.get(i)?.as_ref()?))
    }

    pub(super) fn value_of_fold(&self, i: usize) -> Option<f64> {
        self.part(i).map(|(_, part)| part.value)
    }

    pub(super) fn write_fold(&self, i: usize, row: &mut [f64]) {
        if let Some((phase, part)) = self.part(i) {
            phase.write_part(self.description(), part, row);
            axpy(part.value * phase.parts.by_duration[1], &self.duration_gradient, row);
        }
    }
}
