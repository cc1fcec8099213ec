//! Gaits of robots with springs and friction in their joints. No equation of motion contains them, so the shipped gaits' kernels are
//! theirs.

#![allow(dead_code)] // Not every test needs all of them.

use piaffe::altered::Altered;
use piaffe::model::Gait;

/// Each joint with viscous and with dry friction, as shares of what its motor gives at most: at its greatest speed, or always.
pub fn with_friction(gait: &dyn Gait, viscous: f64, dry: f64) -> Altered<'_> {
    let altered = Altered::new(gait, |d| {
        for (k, joint) in d.joints.to_mut().iter_mut().enumerate() {
            // No two joints of a leg rub alike.
            let share = if k % 2 == 0 { 1.0 } else { 0.7 };
            joint.damping = share * viscous * joint.max_torque / joint.unloaded_speed;
            joint.coulomb = share * dry * joint.max_torque;
        }
    });
    altered.unwrap()
}

/// With springs beside all motors, which rest now on this side of the middle, now on that, and both kinds of friction.
pub fn sprung(gait: &dyn Gait) -> Altered<'_> {
    let altered = Altered::new(gait, |d| {
        for (k, joint) in d.joints.to_mut().iter_mut().enumerate() {
            let (share, [low, high]) = (if k % 2 == 0 { 0.3 } else { 0.7 }, joint.range);
            joint.rest = low + share * (high - low);
            joint.stiffness = 0.2 * share * joint.max_torque;
            joint.damping = 0.02 * joint.max_torque / joint.unloaded_speed;
            joint.coulomb = 0.01 * joint.max_torque;
        }
    });
    altered.unwrap()
}

/// Viscous friction alone.
pub fn smooth(gait: &dyn Gait) -> Altered<'_> {
    with_friction(gait, 0.1, 0.0)
}

/// Both kinds.
pub fn dry(gait: &dyn Gait) -> Altered<'_> {
    with_friction(gait, 0.05, 0.02)
}
