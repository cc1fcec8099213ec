//! What stands on the ground. With the embedding and the platform's freedom, this is what a derivation is for.

use super::Mechanism;
use crate::spec::Rotation;

/// A situation in which the robot moves. With every joint driven, what no torque can reach are the turns of the whole robot that
/// keep its contacts fixed: one in the plane, whether a foot stands or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// On the foot of this leg (0 or 1).
    Stance(usize),
    /// No foot stands: the mass centre flies like a stone, and nothing turns the robot about it.
    Flight,
}

impl Mode {
    /// Legs whose feet are in the air.
    pub fn swinging(self) -> impl Iterator<Item = usize> + Clone {
        (0..2).filter(move |leg| self != Mode::Stance(*leg))
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

impl Mechanism {
    /// The same with flight among its modes.
    ///
    /// # Errors
    /// Why it cannot fly.
    pub fn with_flight(mut self) -> Result<Mechanism, &'static str> {
        if self.rotation == Rotation::Roll {
            return Err(
                "the platform rolls: in stance the two real feet carry the pitch and yaw moments that the model \
                        leaves out, in flight nobody does",
            );
        }
        if !self.modes.contains(&Mode::Flight) {
            self.modes.push(Mode::Flight);
        }
        Ok(self)
    }
}
