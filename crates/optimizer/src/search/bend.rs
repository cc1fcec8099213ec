//! A bend of least torque at which descents end: with dry friction, where a joint comes to rest just as a phase begins or ends.
//!
//! There a turn comes in or goes out. What it adds to Γ² grows like the root of its depth, so no gradient vanishes, and none leads past it. In
//! the middle of a phase that is treated (`cycle/halt.rs`), at its ends it is not.

use piaffe_model::motion::{Criterion, Motion};
use piaffe_model::units::Units;
use piaffe_model::{Description, RESTING_RATE};
use std::fmt;

/// A joint with dry friction that comes to rest at an end of a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bend {
    pub joint: &'static str,
    /// 1-based.
    pub phase: usize,
    pub at: End,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Beginning,
    End,
}

impl Bend {
    /// The first one of a motion, if the criterion has such.
    pub fn of(d: &Description, criterion: Criterion, motion: &Motion) -> Option<Bend> {
        if criterion != Criterion::Torque {
            return None;
        }
        let resting = RESTING_RATE * Units::new(d).rate();
        motion.phases.iter().enumerate().find_map(|(k, course)| {
            let beginning = d.complete(&course.qd_initial, course.betad_initial);
            let end = d.complete(&course.qd_final, course.betad_final);
            [(End::Beginning, beginning), (End::End, end)].into_iter().find_map(|(at, rates)| {
                let mut joints = d.joints.iter().zip(rates);
                let (joint, _) = joints.find(|(joint, rate)| joint.coulomb != 0.0 && rate.abs() < resting)?;
                Some(Bend { joint: joint.name, phase: k + 1, at })
            })
        })
    }
}

impl fmt::Display for Bend {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Bend { joint, phase, at } = self;
        let at = if *at == End::Beginning { "beginning" } else { "end" };
        write!(
            f,
            "that may be because of dry friction: where the best attempt ends, {joint} comes to rest just at the {at} of phase {phase}, \
             where least torque has a bend"
        )
    }
}
