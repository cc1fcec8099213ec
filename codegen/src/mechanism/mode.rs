//! What stands on the ground. With the embedding and the platform's freedom, this is what a derivation is for.

use super::{Mechanism, Transition};
use crate::spec;

/// A situation in which the robot moves. With every joint driven, what no torque can reach are the turns of the whole robot that
/// keep its contacts fixed: one in the plane, whether a foot stands or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// On the foot of this leg (0 or 1).
    Stance(usize),
    /// No foot stands: the mass centre flies like a stone, and nothing turns the robot about it.
    Flight,
}

/// The leg beside this one (0 or 1).
pub const fn other_leg(leg: usize) -> usize {
    1 - leg
}

impl Mode {
    /// Legs whose feet are in the air.
    pub fn swinging(self) -> impl Iterator<Item = usize> + Clone {
        (0..2).filter(move |leg| self != Mode::Stance(*leg))
    }

    /// The same when the legs have exchanged roles.
    pub fn exchanged(self) -> Mode {
        match self {
            Mode::Stance(leg) => Mode::Stance(other_leg(leg)),
            Mode::Flight => Mode::Flight,
        }
    }

    /// What a kernel of this mode is called.
    pub fn kernel(self, what: &str) -> String {
        match self {
            Mode::Stance(leg) => format!("{what}{}", leg + 1),
            Mode::Flight => format!("flight_{what}"),
        }
    }

    /// What is said in stance, or what is said in flight.
    pub fn say<'t>(self, in_stance: &'t str, in_flight: &'t str) -> &'t str {
        match self {
            Mode::Stance(_) => in_stance,
            Mode::Flight => in_flight,
        }
    }
}

/// A mode for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    pub mode: Mode,
    /// Shortest and longest, s.
    pub duration: [f64; 2],
}

impl Phase {
    pub fn new(phase: &spec::Phase) -> Phase {
        Phase { mode: phase.stance.map_or(Mode::Flight, Mode::Stance), duration: phase.duration }
    }
}

/// The modes of a gait: stance on either leg, and what else occurs.
pub fn all(phases: &[Phase]) -> Vec<Mode> {
    let mut modes = vec![Mode::Stance(0), Mode::Stance(1)];
    for phase in phases {
        if !modes.contains(&phase.mode) {
            modes.push(phase.mode);
        }
    }
    modes
}

impl Mechanism {
    /// The same with flight among its modes, and all transitions between these.
    ///
    /// # Errors
    /// Why it cannot fly.
    pub fn with_flight(mut self) -> Result<Mechanism, &'static str> {
        if let Some(why) = self.rotation.keeps_on_the_ground() {
            return Err(why);
        }
        if !self.modes.contains(&Mode::Flight) {
            self.modes.push(Mode::Flight);
        }
        Ok(self.with_all_transitions())
    }

    /// The same with all transitions between its modes.
    pub fn with_all_transitions(mut self) -> Mechanism {
        let pairs = self.modes.iter().flat_map(|to| self.modes.iter().map(|from| Transition { from: *from, to: *to }));
        self.transitions = pairs.filter(|t| t.from != t.to).collect();
        self
    }
}
