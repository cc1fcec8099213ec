//! Which quantities an instant has, and where each stands in a row of them.

use crate::constraints::sharing;
use piaffe_model::shape::{ModeShapes, Sharing, SharingCurvatureWeights};
use piaffe_model::{Description, Mode};

/// Where each quantity stands.
#[derive(Clone, Copy, Debug)]
pub struct Quantities {
    joints: usize,
    /// Of the reaction.
    components: usize,
    /// Feet in the air.
    feet: usize,
    points: usize,
    pub(super) shared: usize,
}

impl Quantities {
    /// Of an instant of this mode.
    pub fn new(description: &Description, mode: Mode) -> Quantities {
        let stands = mode.stance().is_some();
        let shared = if stands && sharing::applies(description) { Shared::new(description).len() } else { 0 };
        Quantities {
            joints: description.joints(),
            components: if stands { description.positions() } else { 0 },
            feet: mode.swinging().count(),
            points: description.lowest.len(),
            shared,
        }
    }

    /// Γj that moves the robot, N·m; what a motor overcomes besides is friction's.
    pub fn torque(&self, joint: usize) -> usize {
        joint
    }

    /// Component of the reaction at the stance foot, N; in flight there is none.
    pub fn force(&self, component: usize) -> usize {
        self.joints + component
    }

    /// Joint angle, rad.
    pub fn angle(&self, joint: usize) -> usize {
        self.joints + self.components + joint
    }

    /// Joint rate, rad/s.
    pub fn rate(&self, joint: usize) -> usize {
        2 * self.joints + self.components + joint
    }

    /// How many components the reaction has.
    pub fn components(&self) -> usize {
        self.components
    }

    /// How many feet are in the air.
    pub fn feet(&self) -> usize {
        self.feet
    }

    /// Height of a foot in the air over the curve above which it stays: how high that curve could be, m; see `swing`.
    pub fn clearance(&self, foot: usize) -> usize {
        3 * self.joints + self.components + foot
    }

    /// Height of the platform's mass centre over the ground, m.
    pub fn height(&self) -> usize {
        self.clearance(self.feet)
    }

    /// Heights over the ground of the description's `lowest` points, m.
    pub fn heights(&self) -> std::ops::Range<usize> {
        self.height() + 1..self.height() + 1 + self.points
    }

    /// What decides how the real legs share the load, if their limits count: see [`Shared`].
    pub fn shared(&self) -> std::ops::Range<usize> {
        self.heights().end..self.heights().end + self.shared
    }

    /// Writes what follows from the state itself, and torques and reaction.
    pub(super) fn write(&self, values: &mut [f64], [q, qd]: [&[f64]; 2], [torques, force]: [&[f64]; 2], height: f64) {
        let nj = self.joints;
        values[self.torque(0)..][..nj].copy_from_slice(torques);
        values[self.force(0)..][..self.components].copy_from_slice(force);
        values[self.angle(0)..][..nj].copy_from_slice(&q[..nj]);
        values[self.rate(0)..][..nj].copy_from_slice(&qd[..nj]);
        values[self.height()] = height;
    }

    /// Writes what the kernel `sharing` gives.
    pub(super) fn write_shared(&self, values: &mut [f64], shapes: &ModeShapes, sharing: &[f64]) {
        let (from, to) = (&shapes.sharing, &shapes.sharing_curvature.weights);
        let own = &mut values[self.shared()];
        to.moment.of_mut(own).copy_from_slice(from.moment.of(sharing));
        to.levers.of_mut(own).copy_from_slice(from.levers.of(sharing));
    }

    /// The shape of what the kernel `sharing` gives: nothing if it is not looked at.
    pub(super) fn sharing(&self, shapes: &ModeShapes) -> Sharing {
        if self.shared > 0 { shapes.sharing } else { Sharing::NONE }
    }

    pub fn len(&self) -> usize {
        self.shared().end
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}

/// Order of what the kernel `sharing` gives, as of its weights.
#[derive(Clone, Copy, Debug)]
pub struct Shared {
    shape: SharingCurvatureWeights,
}

impl Shared {
    pub fn new(description: &Description) -> Shared {
        Shared { shape: description.shapes.stance.sharing_curvature.weights }
    }

    /// Moment about the vertical (0) or the transverse axis (1).
    pub fn moment(self, axis: usize) -> usize {
        self.shape.moment.place(axis)
    }

    /// Component of ∂foot/∂q for a joint of the leg in support.
    pub fn lever(self, joint: usize, component: usize) -> usize {
        self.shape.levers.index(joint, component)
    }

    pub fn len(self) -> usize {
        self.shape.len
    }

    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}
