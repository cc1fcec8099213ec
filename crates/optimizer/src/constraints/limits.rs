//! The numbers that the constraints compare with, as the optimizer reads them from a description.

use crate::passive::Passive;
use piaffe_model::Description;
use piaffe_number::{Dual, Scalar};

/// Limits of §6.1 as numbers of any kind, in the description's units.
#[derive(Clone, Debug)]
pub struct Limits<T = f64> {
    pub joints: Vec<JointLimits<T>>,
    pub friction: T,
    pub min_vertical_force: T,
    pub swing_clearance: T,
    /// Shortest and longest, of each phase.
    pub durations: Vec<[T; 2]>,
    pub min_platform_height: T,
    pub body_clearance: T,
}

/// Those of a joint.
#[derive(Clone, Copy, Debug)]
pub struct JointLimits<T = f64> {
    pub range: [T; 2],
    pub max_torque: T,
    pub unloaded_speed: T,
    pub loaded_speed: T,
    /// What its motor has to overcome, if anything.
    pub passive: Option<Passive<T>>,
}

impl Limits {
    /// As they are.
    pub fn new(d: &Description) -> Limits {
        Limits::read(d, |number| number(d), |j| Passive::acts(&d.joints[j]))
    }
}

impl<const N: usize> Limits<Dual<f64, N>> {
    /// With their derivatives in `N` directions: descriptions whose numbers are those by which the description's change.
    pub fn along(d: &Description, directions: &[Description; N]) -> Self {
        // Springs and friction that are zero may change too.
        let acts = |j: usize| directions.iter().chain([d]).any(|d| Passive::acts(&d.joints[j]));
        Limits::read(d, |number| Dual { x: number(d), d: directions.each_ref().map(number) }, acts)
    }
}

impl<T: Scalar> Limits<T> {
    /// Picks every limit; `one` makes a scalar of what a pick gives, `acts` tells which joints' motors have something to overcome.
    fn read(
        d: &Description,
        one: impl Fn(&dyn Fn(&Description) -> f64) -> T,
        acts: impl Fn(usize) -> bool,
    ) -> Limits<T> {
        let joint = |j: usize| JointLimits {
            range: [0, 1].map(|end| one(&|d| d.joints[j].range[end])),
            max_torque: one(&|d| d.joints[j].max_torque),
            unloaded_speed: one(&|d| d.joints[j].unloaded_speed),
            loaded_speed: one(&|d| d.joints[j].loaded_speed),
            passive: acts(j).then(|| Passive::read(d, j, &one)),
        };
        Limits {
            joints: (0..d.joints()).map(joint).collect(),
            friction: one(&|d| d.limits.friction),
            min_vertical_force: one(&|d| d.limits.min_vertical_force),
            swing_clearance: one(&|d| d.limits.swing_clearance),
            durations: (0..d.phases.len()).map(|k| [0, 1].map(|end| one(&|d| d.phases[k].duration[end]))).collect(),
            min_platform_height: one(&|d| d.limits.min_platform_height),
            body_clearance: one(&|d| d.limits.body_clearance),
        }
    }
}
