//! From one mode to the next: which foot lands, and which one leaves.

use super::{Mode, Phase};
use crate::spec::Then;

/// A change of what stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    pub from: Mode,
    pub to: Mode,
}

impl Transition {
    /// The leg whose foot lands: a passive impact (eq. 12).
    pub fn lands(self) -> Option<usize> {
        match self.to {
            Mode::Stance(leg) => Some(leg),
            Mode::Flight => None,
        }
    }

    /// The leg whose foot leaves the ground.
    pub fn leaves(self) -> Option<usize> {
        match self.from {
            Mode::Stance(leg) => Some(leg),
            Mode::Flight => None,
        }
    }

    /// The leg that it is of: the one that lands, or leaves into flight.
    pub fn leg(self) -> usize {
        self.lands().or(self.leaves()).unwrap_or_default()
    }

    /// What a kernel computes of such transitions; `what` is what it is for, if that has a name.
    pub fn what(self, what: &str) -> String {
        let name = match (self.leaves(), self.lands()) {
            (Some(_), Some(_)) => "touchdown",
            (None, Some(_)) => "landing",
            (_, None) => "takeoff",
        };
        format!("{name}{what}")
    }

    /// What a kernel of this transition is called.
    pub fn kernel(self, what: &str) -> String {
        format!("{}{}", self.what(what), self.leg() + 1)
    }
}

/// The transitions of a gait, in an order that does not depend on that of its phases. Legs are called as in the phase before, so
/// that those of the mirror image are the same.
pub fn all(phases: &[Phase], then: Then) -> Vec<Transition> {
    let following = phases.iter().skip(1).chain(phases.first());
    let mut transitions = Vec::new();
    for (k, (phase, next)) in phases.iter().zip(following).enumerate() {
        let exchanges = then == Then::Mirrored && k + 1 == phases.len();
        let to = if exchanges { next.mode.exchanged() } else { next.mode };
        let transition = Transition { from: phase.mode, to };
        if !transitions.contains(&transition) {
            transitions.push(transition);
        }
    }
    transitions.sort_by_key(|t| (t.to, t.from));
    transitions
}
