//! A phase as a function of t, β and β̇: all that happens at an instant.

use super::contact::Contact;
use super::geometry::{Plane, Vec3};
use super::numbers::Numbers;
use super::polynomial::Polynomials;
use super::support::Support;
use piaffe_model::Description;
use piaffe_model::motion::Course;
use piaffe_number::Scalar;

/// The instants of a phase: Q(t) is prescribed, β and β̇ come from outside.
#[derive(Clone, Debug)]
pub struct Instants<'a, T: Scalar = f64> {
    support: Either<'a, T>,
    polynomials: Polynomials<T>,
    contact: Contact<T>,
}

/// Computed in the sagittal plane where all motion is in it, or else in space.
#[derive(Clone, Debug)]
enum Either<'a, T: Scalar> {
    Plane(Support<'a, T, Plane>),
    Space(Support<'a, T>),
}

/// What is done with `$support`, in whichever geometry it is.
macro_rules! either {
    ($of:expr, $support:ident => $do:expr) => {
        match $of {
            Either::Plane($support) => $do,
            Either::Space($support) => $do,
        }
    };
}

/// All that happens at one instant. Positions and velocities are taken from the stance foot, or in flight from the ground below where
/// the mass centre took off; in world axes.
#[derive(Clone, Debug)]
pub struct State<T = f64> {
    pub q: Vec<T>,
    pub qd: Vec<T>,
    pub qdd: Vec<T>,
    /// Of every joint: what moves the robot, N·m.
    pub torques: Vec<T>,
    /// Of every joint's motor, at the joint: that, and what overcomes springs and friction, N·m.
    pub motors: Vec<T>,
    /// Reaction on the stance foot, N.
    pub force: Vec3<T>,
    /// The platform's mass centre, m.
    pub platform: Vec3<T>,
    /// The feet of both legs, m and m/s.
    pub feet: [Vec3<T>; 2],
    pub feet_velocity: [Vec3<T>; 2],
    /// In flight how fast they are accelerated upward, m/s².
    pub feet_acceleration: [T; 2],
    /// Of the description's points over the ground, m.
    pub heights: Vec<T>,
}

impl<T: Scalar> State<T> {
    pub fn new(description: &Description) -> Self {
        let (n, joints) = (description.orientations(), description.joints());
        let (q, zero) = (vec![T::zero(); n], Vec3::zeros());
        State {
            qd: q.clone(),
            qdd: q.clone(),
            q,
            torques: vec![T::zero(); joints],
            motors: vec![T::zero(); joints],
            force: zero,
            platform: zero,
            feet: [zero; 2],
            feet_velocity: [zero; 2],
            feet_acceleration: [T::zero(); 2],
            heights: vec![T::zero(); description.points.len()],
        }
    }
}

impl<'a, T: Scalar> Instants<'a, T> {
    /// Of a phase on such a contact, whose lists have a number for every prescribed coordinate.
    pub fn new(
        description: &'a Description,
        numbers: Numbers<T>,
        course: &Course<T>,
        contact: impl Into<Contact<T>>,
    ) -> Self {
        let contact = contact.into();
        let leg = contact.stance();
        let support = if Plane::holds(description) {
            Either::Plane(Support::with(description, numbers, leg))
        } else {
            Either::Space(Support::with(description, numbers, leg))
        };
        Instants { support, polynomials: Polynomials::new(course), contact }
    }

    pub fn description(&self) -> &'a Description {
        either!(&self.support, support => support.multibody.description())
    }

    pub fn contact(&self) -> Contact<T> {
        self.contact
    }

    pub fn numbers(&self) -> &Numbers<T> {
        either!(&self.support, support => support.multibody.numbers())
    }

    /// β̈ by eq. 10 at time `t`; leaves q, q̇ and q̈ in `state`. `None` where f1 vanishes.
    pub fn accelerate(&mut self, t: T, [beta, betad]: [T; 2], state: &mut State<T>) -> Option<T> {
        let description = self.description();
        for k in 0..description.prescribed() {
            let at = description.prescribed_index(k);
            [state.q[at], state.qd[at], state.qdd[at]] = self.polynomials.at(k, t);
        }
        state.q[description.unactuated] = beta;
        state.qd[description.unactuated] = betad;
        either!(&mut self.support, support => support.accelerate(&state.q, &state.qd, &mut state.qdd))
    }

    /// σ and its rate for the state of the last [`Instants::accelerate`]; see [`Support::momentum`].
    pub fn momentum(&self) -> [T; 2] {
        either!(&self.support, support => support.momentum())
    }

    /// Everything at time `t`, into `state`; returns β̈. `None` where f1 vanishes.
    pub fn at(&mut self, t: T, beta: [T; 2], state: &mut State<T>) -> Option<T> {
        let acceleration = self.accelerate(t, beta, state)?;
        either!(&mut self.support, support => support.complete(state));
        if let Contact::Flight(fall) = self.contact {
            let ([forward, up], velocity) = (fall.place(t), fall.velocity(t));
            for place in state.feet.iter_mut().chain([&mut state.platform]) {
                place.x += forward;
                place.y += up;
            }
            for speed in &mut state.feet_velocity {
                speed.x += velocity[0];
                speed.y += velocity[1];
            }
            state.heights.iter_mut().for_each(|height| *height += up);
            state.feet_acceleration.iter_mut().for_each(|acceleration| *acceleration -= fall.gravity);
        }
        Some(acceleration)
    }
}
