//! The parameters of a phase that everything in it is a function of.

use crate::swing::swings;
use crate::trajectory::Basis;
use piaffe_model::{Description, Mode};

/// Where each stands in a phase's parameter vector.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    pub prescribed: usize,
    /// Basis parameters per coordinate.
    pub per_joint: usize,
    flies: bool,
    /// Which phase it is, and how many durations are of interest: of one that holds all swings whole, but its own.
    phase: usize,
    durations: usize,
}

/// Numbers of a parabola.
const FALL: usize = 3;

impl Layout {
    /// Of phase `k` of a gait.
    pub fn new(d: &Description, k: usize, basis: &Basis) -> Layout {
        let alone = swings(d, k).iter().all(|swing| swing.is_within_phase());
        Layout {
            prescribed: d.prescribed(),
            per_joint: basis.len(),
            flies: d.phases[k].mode == Mode::Flight,
            phase: if alone { 0 } else { k },
            durations: if alone { 1 } else { d.phases.len() },
        }
    }

    pub fn joint(&self, k: usize, parameter: usize) -> usize {
        k * self.per_joint + parameter
    }

    pub fn duration(&self) -> usize {
        self.prescribed * self.per_joint
    }

    pub fn beta(&self) -> usize {
        self.duration() + 1
    }

    pub fn sigma(&self) -> usize {
        self.duration() + 2
    }

    /// Whether the mass centre's parabola is among them.
    pub fn flies(&self) -> bool {
        self.flies
    }

    /// Height of the mass centre over the ground at the beginning of a flight.
    pub fn centre_height(&self) -> usize {
        self.duration() + 3
    }

    /// A component of its velocity then, forward or up.
    pub fn centre_velocity(&self, component: usize) -> usize {
        self.centre_height() + 1 + component
    }

    /// Durations that swings depend on, by phase: where each stands.
    pub fn durations(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.durations).map(|k| self.duration_of(k))
    }

    /// The duration of phase `k` of the gait, if that is of interest.
    pub fn duration_of(&self, k: usize) -> usize {
        let others = self.duration() + 3 + if self.flies { FALL } else { 0 };
        match k.cmp(&self.phase) {
            std::cmp::Ordering::Less => others + k,
            std::cmp::Ordering::Equal => self.duration(),
            std::cmp::Ordering::Greater => others + k - 1,
        }
    }

    /// Other phases whose durations are among the parameters, and where.
    pub fn others(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.durations).filter(|k| *k != self.phase).map(|k| (k, self.duration_of(k)))
    }

    /// How many there are from the duration on: what quantities of an instant may depend on beside its state.
    pub fn direct(&self) -> usize {
        self.len() - self.duration()
    }

    pub fn len(&self) -> usize {
        self.duration() + 3 + if self.flies { FALL } else { 0 } + self.durations - 1
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}
