//! What each real leg does, and the limits of §6.1 there, of the pair in support, where the platform rolls (§2.3).
//!
//! The legs of a side have their feet at different places along Xf, so the moment N that keeps the platform from pitching and
//! turning (kernel `sharing`) splits the vertical and the lateral reaction. Along Xf nothing does: there the legs can push
//! against each other. Here each foot pushes in proportion to the weight that it carries, as is best for friction:
//!
//! ```text
//! F_y = F̄_y/2 + N_z/2a,   F_z = F̄_z/2 − N_y/2a,   F_x = F̄_x F_y/F̄_y,   Γ = Γ̄/2 − ∂foot/∂q·(F − F̄/2)
//! ```
//!
//! a: the foot from the virtual foot; a bar: of the virtual leg. At the impact no motor gives an impulse, so the legs of a pair, which
//! move alike, take the same impulse in their plane; across it they take what keeps the robot from turning. Nothing is left
//! against pitching: no more of it may be asked for than may be lacking (`BALANCED`). Where the hips are level with the mass centre none is.

use super::{Form, Limits, PathConstraint};
use crate::instant::{Quantities, Shared};
use crate::passive::Passive;
use piaffe_model::{Description, Leg, Limit, Then};
use piaffe_number::{Dual, Scalar};

/// Mounts nearer than this share of a leg are at one place.
const SAME: f64 = 1e-9;

/// Whether real legs need constraints of their own: asked for, and not settled by an equal share.
pub fn applies(d: &Description) -> bool {
    d.limits.real_legs && d.is_spatial()
}

/// The part of weight, or of weight × leg length, that may be lacking; at an impact of momentum. Masses and mass centres of a robot are
/// hardly known better, and a foot that is no point presses a hundredth of a leg's length beside its middle.
pub const BALANCED: f64 = 0.01;

/// Whether impacts must be kept from pitching the robot: hips off the mass centre or rotors make them.
pub fn pitches(d: &Description) -> bool {
    let same = SAME * d.leg_length();
    let hips = d.bodies.iter().filter(|b| b.parent == Some(0));
    let level = hips.flat_map(|b| &b.offset[..2]).all(|x| x.abs() < same);
    let rotors = d.joints.iter().any(|j| j.rotor_inertia != 0.0);
    applies(d) && (!level || rotors)
}

/// Why the constraints cannot be imposed, if they cannot.
pub fn obstacle(d: &Description) -> Option<String> {
    if !d.is_spatial() {
        return None;
    }
    if d.then == Then::Repeat {
        return Some(format!(
            "limits at each real leg need a cycle whose halves mirror each other; those of the {} do not",
            d.gait
        ));
    }
    let same = SAME * d.leg_length();
    let apart = |leg: &Leg| {
        let [a, b] = leg.members.as_ref() else { return false };
        let [a, b] = [a.mount(), b.mount()];
        (a[0] - b[0]).abs() > same && (a[1] - b[1]).abs() < same && (a[2] - b[2]).abs() < same
    };
    (!d.legs.iter().all(apart)).then(|| {
        format!(
            "limits at each real leg need pairs of legs mounted one behind the other; those of the {} are not",
            d.gait
        )
    })
}

/// The feet of a pair from the virtual foot, along Xf, m.
pub fn offsets(leg: &Leg) -> Vec<f64> {
    let mounts: Vec<f64> = leg.members.iter().map(|m| m.mount()[0]).collect();
    let mean = mounts.iter().sum::<f64>() / mounts.len().max(1) as f64;
    mounts.iter().map(|x| x - mean).collect()
}

/// Something of a real leg in support: what it depends on, and where among an instant's quantities that stands.
#[derive(Clone, Debug)]
pub struct Share<T = f64> {
    quantities: [usize; COUNT],
    /// The foot from the virtual foot, along Xf, m.
    offset: f64,
    /// The robot's weight, N.
    weight: f64,
    of: Of<T>,
}

const COUNT: usize = 11;
/// Places in `Share::quantities`: reaction, moment, lever of a joint, its torque, rate and angle.
const FORCE: usize = 0;
const MOMENT: usize = 3;
const LEVER: usize = 5;
const TORQUE: usize = 8;
const RATE: usize = 9;
const ANGLE: usize = 10;

#[derive(Clone, Copy, Debug)]
enum Of<T> {
    /// The torque of a joint that moves the robot, N·m.
    Torque,
    /// Vertical force ≥ this, N.
    Vertical(T),
    /// |tangential| ≤ this · vertical.
    Friction(T),
    /// `bound − torque · Γ − rate · q̇ ≥ 0`, Γ the motor's, which may have something to overcome.
    Actuator { bound: T, torque: T, rate: f64, passive: Option<Passive<T>> },
}

/// While virtual leg `stance` stands.
pub fn constraints<T: Scalar>(
    d: &Description,
    limits: &Limits<T>,
    y: &Quantities,
    stance: usize,
) -> Vec<PathConstraint<T>> {
    let mut list = Vec::new();
    if !applies(d) {
        return list;
    }
    let weight = d.total_mass() * d.gravity;
    let leg = &d.legs[stance];
    let share = 1.0 / leg.members.len() as f64;
    for (member, offset) in leg.members.iter().zip(offsets(leg)) {
        let mut add = |limit: Limit, of: String, unit: f64, joint: usize, formula: Of<T>| {
            let form = Form::Share(Share { quantities: quantities(d, y, leg, joint), offset, weight, of: formula });
            list.push(PathConstraint::new(limit, unit, form).of(of));
        };
        let foot = || member.name.to_string();
        add(Limit::VerticalForceOfFoot, foot(), weight, 0, Of::Vertical(limits.min_vertical_force.scale(share)));
        add(Limit::FrictionOfFoot, foot(), weight, 0, Of::Friction(limits.friction));
        for (k, j) in (leg.first_joint..leg.end_joint).enumerate() {
            let (joint, actuator) = (&d.joints[j], &limits.joints[j]);
            let joint_of_leg = || format!("{} of {}", joint.name, member.name);
            let bound = actuator.max_torque.scale(share);
            let passive = actuator.passive;
            for sign in [1.0, -1.0] {
                let limit = Of::Actuator { bound, torque: T::from(sign), rate: 0.0, passive };
                add(Limit::Torque, joint_of_leg(), joint.max_torque * share, k, limit);
            }
            let slope = (actuator.unloaded_speed - actuator.loaded_speed) / bound;
            for (rate, torque) in [(1.0, slope), (1.0, -slope), (-1.0, slope), (-1.0, -slope)] {
                let limit = Of::Actuator { bound: actuator.unloaded_speed, torque, rate, passive };
                add(Limit::TorqueSpeed, joint_of_leg(), joint.unloaded_speed, k, limit);
            }
        }
    }
    list
}

/// The torques of all joints of the real legs that stand while virtual leg `stance` does, each with the joint of that which it is one of.
pub fn torques(d: &Description, y: &Quantities, stance: usize) -> Vec<(usize, Share)> {
    let leg = &d.legs[stance];
    let of_foot = |offset: f64| {
        let weight = d.total_mass() * d.gravity;
        let share = move |k: usize| Share { quantities: quantities(d, y, leg, k), offset, weight, of: Of::Torque };
        (leg.first_joint..leg.end_joint).enumerate().map(move |(k, j)| (j, share(k)))
    };
    offsets(leg).into_iter().flat_map(of_foot).collect()
}

/// Where what decides of a joint of the leg in support stands among an instant's quantities.
fn quantities(d: &Description, y: &Quantities, leg: &Leg, joint: usize) -> [usize; COUNT] {
    let shared = Shared::new(d);
    let at = |index: usize| y.shared().start + index;
    let mut quantities = [0; COUNT];
    for c in 0..3 {
        quantities[FORCE + c] = y.force(c);
        quantities[LEVER + c] = at(shared.lever(joint, c));
    }
    quantities[MOMENT] = at(shared.moment(0));
    quantities[MOMENT + 1] = at(shared.moment(1));
    let joint = leg.first_joint + joint;
    (quantities[TORQUE], quantities[RATE], quantities[ANGLE]) = (y.torque(joint), y.rate(joint), y.angle(joint));
    quantities
}

impl<T: Scalar> Of<T> {
    fn value(self, offset: f64, weight: f64, v: &[T; COUNT]) -> T {
        let over = 0.5 / offset;
        let vertical = v[FORCE + 1].scale(0.5) + v[MOMENT + 1].scale(over);
        let lateral = v[FORCE + 2].scale(0.5) - v[MOMENT].scale(over);
        let forward = v[FORCE] * vertical / v[FORCE + 1];
        let torque_of_joint = || {
            let mut gamma = v[TORQUE].scale(0.5);
            for (c, force) in [forward, vertical, lateral].into_iter().enumerate() {
                gamma -= v[LEVER + c] * (force - v[FORCE + c].scale(0.5));
            }
            gamma
        };
        match self {
            Of::Torque => torque_of_joint(),
            Of::Vertical(least) => vertical - least,
            Of::Friction(mu) => mu * vertical - length([forward, lateral], weight),
            Of::Actuator { bound, torque, rate, passive } => {
                let moving = torque_of_joint();
                // Real legs move alike, so that each of the two has half of the virtual leg's.
                let motor = passive.map_or(moving, |passive| moving + passive.torque(v[ANGLE], v[RATE]).scale(0.5));
                bound - torque * motor - v[RATE].scale(rate)
            }
        }
    }
}

impl<T: Scalar> Share<T> {
    pub fn value(&self, y: &[T]) -> T {
        self.of.value(self.offset, self.weight, &self.quantities.map(|q| y[q]))
    }
}

impl Share {
    /// The formula for other numbers.
    fn formula<T: Scalar>(&self, v: &[T; COUNT]) -> T {
        let of = match self.of {
            Of::Torque => Of::Torque,
            Of::Vertical(least) => Of::Vertical(T::from(least)),
            Of::Friction(mu) => Of::Friction(T::from(mu)),
            Of::Actuator { bound, torque, rate, passive } => {
                let passive = passive.map(Passive::cast);
                Of::Actuator { bound: bound.into(), torque: torque.into(), rate, passive }
            }
        };
        of.value(self.offset, self.weight, v)
    }

    /// Calls `add(quantity, partial derivative)`.
    pub fn partials(&self, y: &[f64], mut add: impl FnMut(usize, f64)) {
        let gradient = first(&self.quantities.map(|q| y[q]), |v| self.formula(v));
        for (q, partial) in self.quantities.iter().zip(gradient).filter(|(_, partial)| *partial != 0.0) {
            add(*q, partial);
        }
    }

    /// Calls `add(quantity, quantity, second derivative)`.
    pub fn curvature(&self, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        let hessian = second(&self.quantities.map(|q| y[q]), |v| self.formula(v));
        for (a, row) in self.quantities.iter().zip(hessian) {
            for (b, second) in self.quantities.iter().zip(row).filter(|(_, second)| *second != 0.0) {
                add(*a, *b, second);
            }
        }
    }
}

/// Length of a tangential vector; where it vanishes beside its unit it has a derivative all the same, zero.
pub fn length<T: Scalar>(v: [T; 2], unit: f64) -> T {
    /// Too small a share of the unit to matter.
    const TINY: f64 = 1e-14;
    let tiny = TINY * unit;
    (v[0] * v[0] + v[1] * v[1] + T::from(tiny * tiny)).sqrt()
}

/// Gradient of a short formula.
pub fn first<const N: usize>(at: &[f64; N], f: impl Fn(&[Dual<f64, N>; N]) -> Dual<f64, N>) -> [f64; N] {
    f(&std::array::from_fn(|k| Dual::variable(at[k], k))).d
}

/// Second derivatives of a short formula.
pub fn second<const N: usize>(at: &[f64; N], f: impl Fn(&[Second<N>; N]) -> Second<N>) -> [[f64; N]; N] {
    f(&std::array::from_fn(|k| Dual::variable(Dual::variable(at[k], k), k))).d.map(|row| row.d)
}

/// A dual number of dual numbers.
type Second<const N: usize> = Dual<Dual<f64, N>, N>;
