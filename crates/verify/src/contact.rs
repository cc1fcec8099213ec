//! What holds the robot: a foot on the ground, or nothing while its mass centre falls.

use super::multibody::Multibody;
use super::numbers::Numbers;
use piaffe_model::motion::Course;
use piaffe_model::{Description, Mode};
use piaffe_number::Scalar;

/// On what a phase is performed.
#[derive(Clone, Copy, Debug)]
pub enum Contact<T = f64> {
    /// On the foot of this leg.
    Foot(usize),
    Flight(Fall<T>),
}

/// The mass centre when a flight begins.
#[derive(Clone, Copy, Debug)]
pub struct Fall<T = f64> {
    /// Over the ground, m.
    pub height: T,
    /// Forward and up, m/s.
    pub velocity: [T; 2],
    pub gravity: T,
}

impl<T: Scalar> Contact<T> {
    /// Of phase `index` of a motion. A flight begins as the phase before it ends, which stands.
    pub fn of(description: &Description, numbers: &Numbers<T>, phases: &[Course<T>], index: usize) -> Contact<T> {
        if let Mode::Stance(leg) = description.phases[index].mode {
            return Contact::Foot(leg);
        }
        let before = (index + phases.len() - 1) % phases.len();
        let last = &phases[before];
        let stance = description.phases[before].mode.stance().unwrap_or_default();
        let q = description.complete(&last.q_final, last.beta_final);
        let qd = description.complete(&last.qd_final, last.betad_final);
        let mut multibody: Multibody<T> = Multibody::with(description, numbers.clone());
        multibody.set(&q, &qd, &vec![T::zero(); q.len()]);
        let (centre, foot) = (multibody.centre(), *multibody.foot(stance));
        let (place, velocity) = (centre.position - foot.position, centre.velocity - foot.velocity);
        Contact::Flight(Fall { height: place.y, velocity: [velocity.x, velocity.y], gravity: numbers.gravity })
    }

    /// The leg that stands.
    pub fn stance(&self) -> Option<usize> {
        match self {
            Contact::Foot(leg) => Some(*leg),
            Contact::Flight(_) => None,
        }
    }
}

impl<T> From<usize> for Contact<T> {
    fn from(leg: usize) -> Contact<T> {
        Contact::Foot(leg)
    }
}

/// Of phase `index` of a motion, in numbers of any kind.
pub fn contact<T: Scalar>(description: &Description, phases: &[Course], index: usize) -> Contact<T> {
    let phases: Vec<Course<T>> = phases.iter().map(Course::cast).collect();
    Contact::of(description, &Numbers::new(description), &phases, index)
}

impl<T: Scalar> Fall<T> {
    /// How far it has come forward and how high it is at time `t`, m.
    pub fn place(&self, t: T) -> [T; 2] {
        let [forward, up] = self.velocity;
        [forward * t, self.height + (up - self.gravity * t * T::from(0.5)) * t]
    }

    /// Its velocity at time `t`, m/s.
    pub fn velocity(&self, t: T) -> [T; 2] {
        let [forward, up] = self.velocity;
        [forward, up - self.gravity * t]
    }
}
