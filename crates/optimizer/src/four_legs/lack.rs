//! What the equations of motion lack: which force or moment, and how much of it.

use super::equations::PLATFORM;
use super::posture::Posture;
use serde::{Deserialize, Serialize};

/// The largest part that equations of motion lack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lack {
    pub of: Component,
    /// Of the robot's weight, or of its weight times the length of a leg; at an impact of its momentum at the speed √(g × leg
    /// length), or of that times the length of a leg.
    pub share: f64,
}

/// A force or moment on the robot, in world axes; at an impact an impulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    ForwardForce,
    VerticalForce,
    SidewaysForce,
    /// About the forward axis: it keeps the robot from falling to the side.
    SidewaysMoment,
    /// About the vertical.
    TurningMoment,
    /// About the transverse axis: it keeps the robot from falling on its nose.
    PitchingMoment,
    /// At a joint, which takes no impulse.
    JointMoment,
}

impl Lack {
    pub const NONE: Lack = Lack { of: Component::VerticalForce, share: 0.0 };

    /// The largest entry of what is left of the equations: forces and moments in the platform's axes, then moments at joints;
    /// `unit` of a force, `length` of a leg.
    pub fn new(left: &[f64], posture: &Posture, unit: f64, length: f64) -> Lack {
        let platform = |k: usize| posture.outside([left[k], left[k + 1], left[k + 2]]);
        let entries = platform(0).into_iter().chain(platform(3)).chain(left.iter().skip(PLATFORM).copied());
        let each = entries.enumerate().map(|(row, x)| {
            let of = Component::of(row);
            Lack { of, share: x.abs() / if of.is_moment() { unit * length } else { unit } }
        });
        each.fold(Lack::NONE, Lack::larger)
    }

    /// Of two; one that is no number is the largest.
    pub fn larger(self, other: Lack) -> Lack {
        if other.share > self.share || other.share.is_nan() { other } else { self }
    }
}

impl Component {
    /// What the `row`-th equation balances.
    fn of(row: usize) -> Component {
        use Component::*;
        let platform = [ForwardForce, VerticalForce, SidewaysForce, SidewaysMoment, TurningMoment, PitchingMoment];
        platform.get(row).copied().unwrap_or(JointMoment)
    }

    pub fn is_moment(self) -> bool {
        !matches!(self, Component::ForwardForce | Component::VerticalForce | Component::SidewaysForce)
    }
}
