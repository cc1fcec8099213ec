//! Which quantities an instant has, and where each stands in a row of them.

use crate::constraints::sharing;
use piaffe_model::Description;
use piaffe_model::shape::{Shapes, Sharing, SharingCurvatureWeights};

/// Where each quantity stands.
#[derive(Clone, Copy, Debug)]
pub struct Quantities {
    joints: usize,
    components: usize,
    points: usize,
    pub(super) shared: usize,
}

impl Quantities {
    pub fn new(description: &Description) -> Quantities {
        let shared = if sharing::applies(description) { Shared::new(description).len() } else { 0 };
        Quantities {
            joints: description.joints(),
            components: description.positions(),
            points: description.lowest.len(),
            shared,
        }
    }

    /// Γj, N·m.
    pub fn torque(&self, joint: usize) -> usize {
        joint
    }

    /// Component of the reaction at the stance foot, N.
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

    /// Height of the swing foot over `4 s (1 − s)`: the height of the parabola that it touches, m.
    /// At both ends its limit: the vertical speed times T/4, up or down.
    pub fn clearance(&self) -> usize {
        3 * self.joints + self.components
    }

    /// Height of the platform's mass centre over the ground, m.
    pub fn height(&self) -> usize {
        self.clearance() + 1
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
    pub(super) fn write_shared(&self, values: &mut [f64], shapes: &Shapes, sharing: &[f64]) {
        let (from, to) = (&shapes.sharing, &shapes.sharing_curvature.weights);
        let own = &mut values[self.shared()];
        to.moment.of_mut(own).copy_from_slice(from.moment.of(sharing));
        to.levers.of_mut(own).copy_from_slice(from.levers.of(sharing));
    }

    /// The shape of what the kernel `sharing` gives: nothing if it is not looked at.
    pub(super) fn sharing(&self, shapes: &Shapes) -> Sharing {
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
        Shared { shape: description.shapes.sharing_curvature.weights }
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

/// Sign and factor that turn the swing foot's vertical velocity into clearance: up first, down last.
pub fn direction(end: usize) -> f64 {
    if end == 0 { 0.25 } else { -0.25 }
}
