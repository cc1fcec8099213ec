//! The free fall of the mass centre in flight: a parabola in the phase's parameters.

use super::Layout;
use piaffe_model::{FORWARD, UP};

/// Where the mass centre is, `t = s T` after take-off.
#[derive(Clone, Copy, Debug)]
pub struct Fall {
    layout: Layout,
    gravity: f64,
    duration: f64,
    /// Over the ground at take-off, m.
    height: f64,
    /// At take-off, forward and up, m/s.
    velocity: [f64; 2],
}

impl Fall {
    /// Of a phase with these parameters; none in stance.
    pub fn new(layout: &Layout, gravity: f64, parameters: &[f64]) -> Option<Fall> {
        layout.flies().then(|| Fall {
            layout: *layout,
            gravity,
            duration: parameters[layout.duration()],
            height: parameters[layout.centre_height()],
            velocity: [FORWARD, UP].map(|component| parameters[layout.centre_velocity(component)]),
        })
    }

    /// Its height at share `s`, m.
    pub fn height(&self, s: f64) -> f64 {
        let t = s * self.duration;
        self.height + t * (self.velocity[UP] - 0.5 * self.gravity * t)
    }

    /// How fast it rises at share `s`, m/s.
    pub fn rise(&self, s: f64) -> f64 {
        self.velocity[UP] - self.gravity * s * self.duration
    }

    /// Its velocity at share `s`, m/s.
    pub fn velocity(&self, s: f64) -> [f64; 2] {
        [self.velocity[FORWARD], self.rise(s)]
    }

    /// How far forward it has come at share `s`, m.
    pub fn advance(&self, s: f64) -> f64 {
        self.velocity[FORWARD] * s * self.duration
    }

    /// Adds to points that are given from the mass centre, `components` each, where it is at share `s`, m.
    pub fn carry(&self, s: f64, points: &mut [f64], components: usize) {
        let (advance, height) = (self.advance(s), self.height(s));
        for point in points.chunks_mut(components) {
            point[FORWARD] += advance;
            point[UP] += height;
        }
    }

    /// Adds `weight` times the gradient of its height at `s` in the parameters from the duration on.
    pub fn add_height_gradient(&self, s: f64, weight: f64, out: &mut [f64]) {
        out[self.at_height()] += weight;
        out[self.at_velocity(UP)] += weight * s * self.duration;
        out[0] += weight * s * self.rise(s);
    }

    /// The same of how fast it rises.
    pub fn add_rise_gradient(&self, s: f64, weight: f64, out: &mut [f64]) {
        out[self.at_velocity(UP)] += weight;
        out[0] -= weight * s * self.gravity;
    }

    /// The same of how far it has come.
    pub fn add_advance_gradient(&self, s: f64, weight: f64, out: &mut [f64]) {
        out[self.at_velocity(FORWARD)] += weight * s * self.duration;
        out[0] += weight * s * self.velocity[FORWARD];
    }

    /// Second derivatives of its height, of how fast it rises and of how far it has come, as pairs of parameters, the first that of
    /// the duration: `add(other, second derivative)` with each weighted, others counted from the duration on. Of the duration with
    /// itself half the second derivative.
    pub fn second_derivatives(&self, s: f64, [height, advance]: [f64; 2], mut add: impl FnMut(usize, f64)) {
        add(self.at_velocity(UP), height * s);
        add(0, -0.5 * height * self.gravity * s * s);
        add(self.at_velocity(FORWARD), advance * s);
    }

    fn at_height(&self) -> usize {
        self.layout.centre_height() - self.layout.duration()
    }

    fn at_velocity(&self, component: usize) -> usize {
        self.layout.centre_velocity(component) - self.layout.duration()
    }
}
