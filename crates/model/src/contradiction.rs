//! Limits to which no motion can keep, at whatever speed: the robot's weight and the lengths of its legs say so.
//!
//! Only what is certain is said. Over a cycle the ground gives what the weight takes, and impacts only push: a foot cannot push harder
//! all the time that it stands than the weight is, by as much more as flights let it stand less. And nothing is higher above
//! a foot that stands than stretched links reach.

use super::digits::{digits, few, legible};
use super::{Description, FORWARD, Mode, Rotation, SIDEWAYS, UP, norm};
use std::fmt;

/// Rounding: the share by which a limit may be beyond what is possible without a word.
const ROUNDING: f64 = 1e-9;

/// A limit to which no motion of a gait can keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// Its name in the specification.
    pub limit: &'static str,
    /// What it is.
    pub asked: f64,
    /// What it could be at most.
    pub most: f64,
    /// Of both.
    pub unit: &'static str,
    /// What keeps every motion from more.
    why: String,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Contradiction { limit, asked, most, unit, why } = self;
        let [asked, most] = [*asked, legible(*most, false)].map(digits);
        write!(f, "no motion keeps to {limit} = {asked} {unit}: {why}; give at most {most}")
    }
}

impl Description {
    /// Its limits to which no motion can keep; none of most gaits.
    pub fn contradictions(&self) -> Vec<Contradiction> {
        let limits = &self.limits;
        let of = |limit, asked: f64, most: f64, unit, why| {
            (asked > most * (1.0 + ROUNDING)).then_some(Contradiction { limit, asked, most, unit, why })
        };
        let (force, why_no_more) = self.greatest_least_force();
        let reaches = [0, 1].map(|leg| self.reach(leg));
        let highest = [0, 1].map(|leg| reaches[leg] + self.platform_above_hip(leg));
        let last = self.legs.each_ref().map(|leg| norm(&leg.foot));
        let apart = [0, 1].map(|leg| self.platform_above_hip(leg).abs()).iter().sum::<f64>();
        let found = [
            of("limits.min_vertical_force", limits.min_vertical_force, force, "N", why_no_more),
            of(
                "limits.min_platform_height",
                limits.min_platform_height,
                highest[0].min(highest[1]),
                "m",
                "the platform's mass centre is no higher above a foot that stands than on stretched legs".into(),
            ),
            of(
                "limits.body_clearance",
                limits.body_clearance,
                last[0].min(last[1]),
                "m",
                "the last joint of a leg that stands is no higher above its foot than its last link is long".into(),
            ),
            // In flight feet may be anywhere.
            of(
                "limits.swing_clearance",
                limits.swing_clearance,
                reaches[0] + reaches[1] + apart,
                "m",
                "no foot is higher above the other one than stretched legs reach".into(),
            )
            .filter(|_| !self.flies()),
        ];
        found.into_iter().flatten().collect()
    }

    /// With which force, N, a foot can push at least all the time that it stands, and why with no more.
    fn greatest_least_force(&self) -> (f64, String) {
        let sum = |flight: bool, end: usize| -> f64 {
            let phases = self.phases.iter().filter(|phase| (phase.mode == Mode::Flight) == flight);
            phases.map(|phase| phase.duration[end]).sum()
        };
        let (weight, stance, flight) = (self.weight(), sum(false, 0), sum(true, 1));
        let carries = format!("over a cycle the ground carries the weight, {} N", few(weight));
        if flight == 0.0 {
            return (weight, carries);
        }
        let why = format!("{carries}, with at least {} s on a foot to {} s of flight", few(stance), few(flight));
        (weight * (1.0 + flight / stance), why)
    }

    /// How much higher than a leg's hip the platform's mass centre can be, m.
    fn platform_above_hip(&self, leg: usize) -> f64 {
        let hip = self.hip(leg);
        match self.rotation {
            Rotation::None => -hip[UP],
            Rotation::Pitch => norm(&[hip[UP], hip[FORWARD]]),
            Rotation::Roll => norm(&[hip[UP], hip[SIDEWAYS]]),
        }
    }
}
