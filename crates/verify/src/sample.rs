//! A motion as a table: states, torques and reactions at equally spaced times.

use super::contact::contact;
use super::error::{VerifyError, check};
use super::geometry::Vec3;
use super::instants::State;
use super::multibody::Multibody;
use super::phase::Phase;
use piaffe_model::motion::Motion;
use piaffe_model::{Description, Transition};
use serde::{Deserialize, Serialize};

/// One instant of a motion. World axes with the origin in the first stance foot; SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// From the beginning of the phase, s.
    pub t: f64,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Of every joint's motor, at the joint, N·m.
    pub torques: Vec<f64>,
    /// Reaction on the stance foot, N.
    pub force: [f64; 3],
    /// The platform's mass centre.
    pub platform: [f64; 3],
    /// The feet of both legs.
    pub feet: [[f64; 3]; 2],
}

/// The motion at `points` instants of each phase, both ends included.
///
/// # Errors
/// As for [`verify`](super::verify).
pub fn sample(description: &Description, motion: &Motion, points: usize) -> Result<Vec<Sample>, VerifyError> {
    check(description, motion, points)?;
    let mut samples = Vec::with_capacity(points * motion.phases.len());
    let mut state = State::new(description);
    // Where positions of a phase are from.
    let mut origin: Vec3 = Vec3::zeros();
    for (i, course) in motion.phases.iter().enumerate() {
        let mut phase = Phase::new(description, course, contact(description, &motion.phases, i), i + 1)?;
        for k in 0..points {
            let t = course.duration * (k as f64 / (points - 1) as f64);
            phase.at(t, &mut state)?;
            samples.push(Sample {
                phase: i + 1,
                t,
                q: state.q.clone(),
                qd: state.qd.clone(),
                qdd: state.qdd.clone(),
                torques: state.motors.clone(),
                force: state.force.into(),
                platform: (origin + state.platform).into(),
                feet: state.feet.map(|foot| (origin + foot).into()),
            });
        }
        origin = match description.transition(i) {
            // The foot that lands is the next to stand.
            Transition::Touchdown(leg) | Transition::Landing(leg) => origin + state.feet[leg],
            // The mass centre takes off above where it then is.
            Transition::TakeOff(leg) => {
                let mut multibody = Multibody::new(description);
                multibody.set(&state.q, &state.qd, &state.qdd);
                let ahead = multibody.centre().position - multibody.foot(leg).position;
                origin + Vec3::new(ahead.x, 0.0, 0.0)
            }
        };
    }
    Ok(samples)
}
