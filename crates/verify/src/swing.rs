//! The whole time that a foot is off the ground, over several phases and over the exchange of the legs' roles, and the curve above
//! which it stays.

use super::constraint::Constraint;
use piaffe_model::motion::Course;
use piaffe_model::{Description, Mode};
use piaffe_number::Scalar;

/// A swing as a phase sees it.
#[derive(Clone, Copy, Debug)]
pub struct Swing<T = f64> {
    pub leg: usize,
    /// What its clearance is called.
    pub constraint: Constraint,
    /// From its beginning to that of the phase, and in all, s.
    before: T,
    whole: T,
    /// Whether it begins and ends with the phase.
    pub begins: bool,
    pub ends: bool,
    /// Whether the foot has been at rest when it left; else an impact has thrown it.
    pub from_rest: bool,
}

/// Of the feet in the air in phase `index`.
pub fn swings<T: Scalar>(description: &Description, phases: &[Course<T>], index: usize) -> Vec<Swing<T>> {
    let count = phases.len();
    // What stands `steps` phases later or earlier, in the legs' names of this phase.
    let mode = |steps: isize| description.mode(index as isize + steps);
    let duration = |steps: isize| phases[(index as isize + steps).rem_euclid(count as isize) as usize].duration;
    let in_air: Vec<usize> = mode(0).swinging().collect();
    let alone = in_air.len() == 1;
    let swing = |leg: usize| {
        let (mut before, mut after) = (1, 1);
        while before < 2 * count as isize && mode(-before) != Mode::Stance(leg) {
            before += 1;
        }
        while after < 2 * count as isize && mode(after) != Mode::Stance(leg) {
            after += 1;
        }
        let sum = |range: std::ops::Range<isize>| range.map(duration).fold(T::zero(), |sum, t| sum + t);
        Swing {
            leg,
            constraint: if alone { Constraint::Clearance } else { Constraint::FootClearance(leg) },
            before: sum(1 - before..0),
            whole: sum(1 - before..after),
            begins: before == 1,
            ends: after == 1,
            from_rest: mode(1 - before) == Mode::Flight,
        }
    };
    in_air.into_iter().map(swing).collect()
}

impl<T: Scalar> Swing<T> {
    /// The curve at time `t` of the phase, 1 at its highest: 4 w (1 − w) of the elapsed share w, or from rest 27/4 w² (1 − w).
    pub fn curve(&self, t: T) -> T {
        let w = (self.before + t) / self.whole;
        let one = T::from(1.0);
        if self.from_rest { T::from(6.75) * w * w * (one - w) } else { T::from(4.0) * w * (one - w) }
    }

    /// In how many of its durations the foot would come down from the curve's height if it went on as it ends.
    pub fn descent(&self) -> f64 {
        if self.from_rest { 6.75 } else { 4.0 }
    }

    /// What the foot does more than the curve of height `clearance` (m) where both begin: ẏ T − 4 h, or from rest ÿ T²/2 − 27/4 h.
    pub fn rise(&self, clearance: T, velocity: T, acceleration: T) -> T {
        let more =
            if self.from_rest { acceleration * self.whole * self.whole * T::from(0.5) } else { velocity * self.whole };
        more - T::from(self.descent()) * clearance
    }

    /// How much faster than the curve it comes down where both end, m per swing.
    pub fn fall(&self, clearance: T, velocity: T) -> T {
        -velocity * self.whole - T::from(self.descent()) * clearance
    }
}
