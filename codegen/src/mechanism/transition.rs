//! From one mode to the next: which foot lands, and which one leaves.

use super::{Mechanism, Mode};

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

    /// What a kernel of this transition is called, after what it is for, if that has a name.
    pub fn kernel(self, what: &str) -> String {
        let (name, leg) = match (self.leaves(), self.lands()) {
            (Some(_), Some(leg)) => ("touchdown", leg),
            (None, Some(leg)) => ("landing", leg),
            (leg, None) => ("takeoff", leg.unwrap_or_default()),
        };
        format!("{name}{what}{}", leg + 1)
    }
}

impl Mechanism {
    /// The transitions between its modes: from foot to foot, and into flight and out of it.
    pub fn transitions(&self) -> Vec<Transition> {
        let pairs = self.modes.iter().flat_map(|to| self.modes.iter().map(|from| Transition { from: *from, to: *to }));
        pairs.filter(|t| t.from != t.to).collect()
    }
}
