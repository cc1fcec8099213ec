//! Single support on one leg, or flight, at one instant: β̈, the torques and the reaction from Q̈.
//!
//! The stance foot S is at rest, so velocities and accelerations are those relative to it, and its
//! reaction drops out of the balance along the free direction, in which the robot turns about S as a
//! whole and no torque does work:
//!
//! ```text
//! Σ_bodies  f·v + n·w = 0,    f = m (a − g),  n = I α + ω × I ω,   v, w: partial velocities about S
//! ```
//!
//! It is linear in β̈ with the coefficient f1 of eq. 8, which gives eq. 10. Then the reaction is
//! F = Σ f, and the torque of a joint is the moment about its axis of all it carries (eq. 5).
//!
//! In flight the mass centre takes the foot's place, and the fall takes the weight away: the same balance is that of the angular
//! momentum about it, and the reaction is zero.

use super::geometry::{Geometry, Space, Vec3};
use super::heights::{Arms, alike};
use super::instants::State;
use super::margins::at_rest;
use super::multibody::Multibody;
use super::numbers::Numbers;
use num_traits::Zero;
use piaffe_model::{Description, Rotation};
use piaffe_number::Scalar;

/// f1 below this share of (mass × leg²) counts as zero.
const VANISHING: f64 = 1e-9;

/// The mechanism on one leg or in flight, with room for what each body contributes.
#[derive(Clone, Debug)]
pub struct Support<'a, T: Scalar = f64, G: Geometry<T> = Space> {
    pub multibody: Multibody<'a, T, G>,
    /// The leg that stands.
    leg: Option<usize>,
    /// World axis of the free direction: 0, 1 or 2.
    axis: usize,
    loads: Vec<Load<G::Vector, G::Spin>>,
    /// Force and moment about the platform's mass centre of each body with all that it carries.
    carried: Vec<(G::Vector, G::Spin)>,
    /// What must stay above the ground: where it is, or which point before is at the same height.
    points: Vec<Result<Arms<T>, usize>>,
    smallest_f1: f64,
    /// A joint slower than this is at rest, rad/s.
    at_rest: f64,
}

/// Inertial force (gravity included) and moment of a body, as if β̈ were 0, and what β̈ = 1 adds.
#[derive(Clone, Copy, Debug)]
struct Load<V, S> {
    force: V,
    moment: S,
    force_per_beta: V,
    moment_per_beta: S,
}

impl<'a> Support<'a> {
    pub fn new(description: &'a Description, leg: impl Into<Option<usize>>) -> Self {
        Support::with(description, Numbers::new(description), leg)
    }
}

impl<'a, T: Scalar, G: Geometry<T>> Support<'a, T, G> {
    /// The mechanism of `description` with other numbers.
    pub fn with(description: &'a Description, numbers: Numbers<T>, leg: impl Into<Option<usize>>) -> Self {
        let (zero, still) = (G::Vector::zero(), G::Spin::zero());
        let load = Load { force: zero, moment: still, force_per_beta: zero, moment_per_beta: still };
        let length = leg_length(description);
        let alike = alike(description).into_iter().enumerate();
        let point = |(k, first)| {
            if first < k { Err(first) } else { Ok(Arms::new(description, &numbers, &description.points[k])) }
        };
        let points = alike.map(point).collect();
        Support {
            points,
            multibody: Multibody::with(description, numbers),
            leg: leg.into(),
            axis: if description.rotation == Rotation::Roll { 0 } else { 2 },
            loads: vec![load; description.bodies.len()],
            carried: vec![(zero, still); description.bodies.len()],
            smallest_f1: VANISHING * description.total_mass() * length * length,
            at_rest: at_rest(description),
        }
    }

    /// β̈ by eq. 10; also written into `qdd`, whose other entries are Q̈. `None` where f1 vanishes.
    pub fn accelerate(&mut self, q: &[T], qd: &[T], qdd: &mut [T]) -> Option<T> {
        let Support { multibody, leg, axis, loads, smallest_f1, .. } = self;
        let description = multibody.description();
        let beta = description.unactuated;
        qdd[beta] = T::zero();
        multibody.set(q, qd, qdd);
        let numbers = multibody.numbers();
        let (stance, beta_of_stance, weight) = match *leg {
            Some(leg) => {
                let stance = *multibody.foot(leg);
                let body = description.legs[leg].foot_body;
                (stance, multibody.partial_velocity(beta, body, stance.position), G::up(numbers.gravity))
            }
            None => (multibody.centre(), multibody.partial_velocity_of_centre(beta), G::Vector::zero()),
        };
        let (mut balance, mut f1) = (T::zero(), T::zero());
        for (b, (body, load)) in numbers.bodies.iter().zip(loads).enumerate() {
            let com = multibody.com(b);
            let acceleration = com.acceleration - stance.acceleration + weight;
            let partial = |k| multibody.partial_velocity(k, b, com.position);
            load.force = acceleration * body.mass;
            load.moment = multibody.spin_moment(b);
            load.force_per_beta = (partial(beta) - beta_of_stance) * body.mass;
            load.moment_per_beta = multibody.spin_momentum(b, multibody.partial_spin(beta, b));
            let arm = com.position - stance.position;
            balance += G::about(G::moment(arm, load.force) + load.moment, *axis);
            f1 += G::about(G::moment(arm, load.force_per_beta) + load.moment_per_beta, *axis);
        }
        let magnitude = f1.least_magnitude();
        if magnitude.is_nan() || magnitude <= *smallest_f1 {
            return None;
        }
        let acceleration = -balance / f1;
        qdd[beta] = acceleration;
        Some(acceleration)
    }

    /// Angular momentum about the stance foot, or in flight the mass centre, along the free direction, kg·m²/s, and the moment of the
    /// weight, which is its rate (eq. 9), N·m; for the state of the last [`Support::accelerate`].
    pub fn momentum(&self) -> [T; 2] {
        let (multibody, numbers) = (&self.multibody, self.multibody.numbers());
        let (origin, weight) = match self.leg {
            Some(leg) => (*multibody.foot(leg), G::up(-numbers.gravity)),
            None => (multibody.centre(), G::Vector::zero()),
        };
        let (mut momentum, mut moment) = (G::Spin::zero(), G::Spin::zero());
        for (b, body) in numbers.bodies.iter().enumerate() {
            let com = multibody.com(b);
            let arm = com.position - origin.position;
            momentum += G::moment(arm, (com.velocity - origin.velocity) * body.mass);
            momentum += multibody.spin_momentum(b, multibody.spin(b));
            moment += G::moment(arm, weight * body.mass);
        }
        [momentum, moment].map(|of| G::about(of, self.axis))
    }

    /// The torque of every joint, N·m, and the reaction on the stance foot, N, for the state of the
    /// last [`Support::accelerate`], whose `qdd` is complete.
    pub fn torques(&mut self, qdd: &[T], torques: &mut [T]) -> G::Vector {
        let description = self.multibody.description();
        let beta = qdd[description.unactuated];
        let mut reaction = G::Vector::zero();
        self.carried.fill((G::Vector::zero(), G::Spin::zero()));
        // Children before parents: what a body carries is its own load and that of its children.
        for (b, (body, load)) in description.bodies.iter().zip(&self.loads).enumerate().rev() {
            let force = load.force + load.force_per_beta * beta;
            let moment = load.moment + load.moment_per_beta * beta + G::moment(self.multibody.com(b).position, force);
            reaction += force;
            let (carried, carried_moment) = (self.carried[b].0 + force, self.carried[b].1 + moment);
            self.carried[b] = (carried, carried_moment);
            if let Some(parent) = body.parent {
                self.carried[parent].0 += carried;
                self.carried[parent].1 += carried_moment;
            }
        }
        let stance = self.leg.map(|leg| (self.multibody.foot(leg).position, description.legs[leg].foot_body));
        for (b, body) in description.bodies.iter().enumerate() {
            let Some(k) = body.coordinate else { continue };
            let (mut force, mut moment) = self.carried[b];
            if let Some((foot, _)) = stance.filter(|(_, body)| self.multibody.moves(k, *body)) {
                force -= reaction;
                moment -= G::moment(foot, reaction);
            }
            let (axis, joint) = self.multibody.axis(k);
            let rotor = self.multibody.numbers().joints[k].rotor_inertia * qdd[k];
            torques[k] = G::along(moment - G::moment(joint, force), axis) + rotor;
        }
        reaction
    }

    /// What the motors give: springs and friction are torques inside a joint, which its motor has to overcome.
    fn motors(&self, state: &mut State<T>) {
        let description = self.multibody.description();
        for (k, joint) in self.multibody.numbers().joints.iter().enumerate() {
            state.motors[k] = state.torques[k];
            if description.joints[k].has_spring() {
                state.motors[k] += joint.stiffness * (state.q[k] - joint.rest);
            }
            if description.joints[k].has_friction() {
                state.motors[k] += joint.damping * state.qd[k] + joint.coulomb * state.qd[k].side(self.at_rest);
            }
        }
    }

    /// Completes what follows from the last [`Support::accelerate`] and the `qdd` it wrote.
    pub fn complete(&mut self, state: &mut State<T>) {
        let force = self.torques(&state.qdd, &mut state.torques);
        self.motors(state);
        let feet = [0, 1].map(|leg| *self.multibody.foot(leg));
        let origin = self.leg.map_or_else(|| self.multibody.centre(), |leg| feet[leg]);
        // How deep the hips are does not matter in the plane.
        let seen = |v| G::in_space(if self.multibody.description().is_spatial() { v } else { G::flattened(v) });
        // In flight what is left of it is rounding.
        state.force = if self.leg.is_some() { G::in_space(force) } else { Vec3::zeros() };
        state.platform = seen(-origin.position);
        state.feet = feet.map(|foot| seen(foot.position - origin.position));
        state.feet_velocity = feet.map(|foot| G::in_space(foot.velocity - origin.velocity));
        if self.leg.is_none() {
            // Accelerations are as if β̈ were zero.
            let (description, beta) = (self.multibody.description(), self.multibody.description().unactuated);
            let of_centre = self.multibody.partial_velocity_of_centre(beta);
            for (leg, foot) in feet.iter().enumerate() {
                let partial = self.multibody.partial_velocity(beta, description.legs[leg].foot_body, foot.position);
                let acceleration = foot.acceleration - origin.acceleration + (partial - of_centre) * state.qdd[beta];
                state.feet_acceleration[leg] = G::in_space(acceleration).y;
            }
        }
        for (k, point) in self.points.iter().enumerate() {
            state.heights[k] = match point {
                Ok(arms) => state.platform.y + arms.rise(&self.multibody),
                Err(first) => state.heights[*first],
            };
        }
    }
}

/// Length of the stretched leg 1, m: the unit in which lengths are judged.
pub fn leg_length(description: &Description) -> f64 {
    let leg = &description.legs[0];
    let mut length = Vec3::from(leg.foot).norm();
    let mut body = leg.foot_body;
    // Up to the body that hangs on the platform, whose own offset is where the hip is mounted.
    while let Some(parent) = description.bodies[body].parent.filter(|p| *p != 0) {
        length += Vec3::from(description.bodies[body].offset).norm();
        body = parent;
    }
    length
}
