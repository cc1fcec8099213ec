//! What becomes of a push, in words.

use super::{PhaseTracking, TimeTracking};
use std::fmt;

impl fmt::Display for TimeTracking {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fate(f, self.factor, self.steps_to_halve)
    }
}

impl fmt::Display for PhaseTracking {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            PhaseTracking::Map { factor, steps_to_halve, slowest_entry, .. } => {
                fate(f, *factor, *steps_to_halve)?;
                write!(f, "; entered slower than at {:.0} % of its speed, it falls back", 100.0 * slowest_entry)
            }
            PhaseTracking::Singular { phase, time } => write!(
                f,
                "not possible for all joints at once: the momentum about the stance foot vanishes in phase {phase} at {time:.3} s"
            ),
            PhaseTracking::NoPhase => write!(f, "not possible: no quantity of the posture grows all the time"),
            PhaseTracking::Flight => {
                write!(f, "not possible: in flight the mass centre falls, however fast the posture changes")
            }
        }
    }
}

fn fate(f: &mut fmt::Formatter, factor: f64, steps_to_halve: Option<f64>) -> fmt::Result {
    match steps_to_halve {
        Some(steps) => write!(f, "a push dies out, ×{factor:.3} per whole step (halved in {steps:.1})"),
        None => write!(f, "a push grows, ×{factor:.3} per whole step"),
    }
}
