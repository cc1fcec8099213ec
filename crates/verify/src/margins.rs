//! What is left of every limit at an instant (§4.2, §6.1): the inequalities, in numbers of any kind.

use super::constraint::Constraint;
use super::contact::Contact;
use super::geometry::Vec3;
use super::heights::alike;
use super::instants::State;
use super::numbers::Numbers;
use super::support::leg_length;
use super::swing::Swing;
use piaffe_model::{Description, RESTING_RATE};
use piaffe_number::Scalar;

/// A rate of this many radians per unit of time is a slow one.
const SLOW: f64 = 0.2;

/// The natural units of margins; see [`constraint`](super::constraint).
#[derive(Clone, Debug)]
pub struct Units {
    /// Of masses: the robot's, kg.
    pub mass: f64,
    /// Of forces: its weight, N.
    pub weight: f64,
    /// Of lengths: its stretched leg, m.
    pub leg: f64,
    /// Of times: √(leg/gravity), s.
    pub time: f64,
    /// Of velocities: √(gravity·leg), m/s.
    pub speed: f64,
    /// Of impulses: the robot's momentum at that velocity, N·s.
    pub momentum: f64,
    /// The description's points, but for those that are as high as one before.
    points: Vec<usize>,
}

/// A joint slower than this rests, rad/s.
pub fn at_rest(description: &Description) -> f64 {
    RESTING_RATE * (description.gravity / leg_length(description)).sqrt()
}

impl Units {
    pub fn new(description: &Description) -> Units {
        let (mass, leg, gravity) = (description.total_mass(), leg_length(description), description.gravity);
        let speed = (gravity * leg).sqrt();
        let own = alike(description).into_iter().enumerate().filter(|(k, first)| k == first);
        let points = own.map(|(k, _)| k).collect();
        Units { mass, weight: mass * gravity, leg, time: (leg / gravity).sqrt(), speed, momentum: mass * speed, points }
    }

    /// A slow rate of an angle, rad/s: rates are judged relative to themselves where they are faster, else relative to this.
    pub fn rate(&self) -> f64 {
        SLOW / self.time
    }

    /// Margins of the duration of phase `k`.
    pub fn duration<T: Scalar>(
        &self,
        numbers: &Numbers<T>,
        k: usize,
        duration: T,
        mut note: impl FnMut(Constraint, T),
    ) {
        let ([shortest, longest], time) = (numbers.durations[k], T::from(self.time));
        note(Constraint::Shortest, (duration - shortest) / time);
        note(Constraint::Longest, (longest - duration) / time);
    }

    /// Margin of the mean speed: its difference from the speed asked, relative to that.
    pub fn mean_speed<T: Scalar>(found: T, asked: f64) -> T {
        -((found - T::from(asked)) / T::from(asked)).abs()
    }

    /// Margins of what must hold at every instant, but for the clearance.
    pub fn margins<T: Scalar>(
        &self,
        numbers: &Numbers<T>,
        contact: &Contact<T>,
        state: &State<T>,
        mut note: impl FnMut(Constraint, T),
    ) {
        let one = T::from(1.0);
        for (j, joint) in numbers.joints.iter().enumerate() {
            let load = state.motors[j].abs() / joint.max_torque;
            note(Constraint::Torque(j), one - load);
            let fastest = joint.unloaded_speed - (joint.unloaded_speed - joint.loaded_speed) * load;
            note(Constraint::Speed(j), (fastest - state.qd[j].abs()) / joint.unloaded_speed);
            note(Constraint::LowerStop(j), state.q[j] - joint.range[0]);
            note(Constraint::UpperStop(j), joint.range[1] - state.q[j]);
        }
        let weight = T::from(self.weight);
        if contact.stance().is_some() {
            note(Constraint::VerticalForce, (state.force.y - numbers.min_vertical_force) / weight);
            note(Constraint::Friction, (numbers.friction * state.force.y - tangential(&state.force)) / weight);
        }
        let leg = T::from(self.leg);
        note(Constraint::PlatformHeight, (state.platform.y - numbers.min_platform_height) / leg);
        for k in &self.points {
            note(Constraint::Height(*k), (state.heights[*k] - numbers.body_clearance) / leg);
        }
    }

    /// Margins of an impact; `leaving` is the velocity of the foot that stood, if one did.
    pub fn impact<T: Scalar>(
        &self,
        numbers: &Numbers<T>,
        impulse: &Vec3<T>,
        leaving: Option<&Vec3<T>>,
        mut note: impl FnMut(Constraint, T),
    ) {
        let momentum = T::from(self.momentum);
        note(Constraint::VerticalImpulse, impulse.y / momentum);
        note(Constraint::ImpulseFriction, (numbers.friction * impulse.y - tangential(impulse)) / momentum);
        if let Some(leaving) = leaving {
            note(Constraint::Leaving, leaving.y / T::from(self.speed));
        }
    }
}

/// Height of a foot in the air above its curve, m, at time `t` of the phase.
pub fn clearance<T: Scalar>(numbers: &Numbers<T>, state: &State<T>, swing: &Swing<T>, t: T) -> T {
    state.feet[swing.leg].y - numbers.swing_clearance * swing.curve(t)
}

/// How much faster than its curve a foot rises where its swing begins, or comes down where it ends, m per swing; none in the middle.
pub fn steepness<T: Scalar>(numbers: &Numbers<T>, state: &State<T>, swing: &Swing<T>, at_end: bool) -> Option<T> {
    let (h, v, a) = (numbers.swing_clearance, state.feet_velocity[swing.leg].y, state.feet_acceleration[swing.leg]);
    if at_end { swing.ends.then(|| swing.fall(h, v)) } else { swing.begins.then(|| swing.rise(h, v, a)) }
}

/// Magnitude of the part along the ground.
pub fn tangential<T: Scalar>(force: &Vec3<T>) -> T {
    (force.x * force.x + force.z * force.z).sqrt()
}
