//! Which quantities an instant has, and where each stands in a row of them.

use crate::constraints::sharing;
use piaffe_model::Description;

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
    pub(super) fn write(&self, values: &mut [f64], q: &[f64], qd: &[f64], forces: &[f64], height: f64) {
        let nj = self.joints;
        values[..nj + self.components].copy_from_slice(forces);
        values[self.angle(0)..][..nj].copy_from_slice(&q[..nj]);
        values[self.rate(0)..][..nj].copy_from_slice(&qd[..nj]);
        values[self.height()] = height;
    }

    pub fn len(&self) -> usize {
        self.shared().end
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}

/// Order of what the kernel `sharing` gives.
#[derive(Clone, Copy, Debug)]
pub struct Shared {
    joints: usize,
}

impl Shared {
    pub fn new(description: &Description) -> Shared {
        let leg = &description.legs[0];
        Shared { joints: leg.end_joint - leg.first_joint }
    }

    /// Moment about the vertical (0) or the transverse axis (1).
    pub fn moment(self, axis: usize) -> usize {
        axis
    }

    /// Component of ∂foot/∂q for a joint of the leg in support.
    pub fn lever(self, joint: usize, component: usize) -> usize {
        2 + 3 * joint + component
    }

    pub fn len(self) -> usize {
        self.lever(self.joints, 0)
    }

    pub fn is_empty(self) -> bool {
        false
    }
}

/// Sign and factor that turn the swing foot's vertical velocity into clearance: up first, down last.
pub fn direction(end: usize) -> f64 {
    if end == 0 { 0.25 } else { -0.25 }
}

pub(super) fn inverse_length(nq: usize, nj: usize, nc: usize) -> usize {
    1 + nj + nc + (nj + nc + 1) * 3 * nq
}

pub(super) fn sharing_length(nq: usize, shared: usize) -> usize {
    shared + shared * 3 * nq
}

/// Of the kernel `heights` for so many points.
pub(super) fn heights_length(nq: usize, points: usize) -> usize {
    points + points * nq
}

pub(super) fn placement_length(nq: usize, nc: usize) -> usize {
    2 * nc + 2 * nc * nq
}
