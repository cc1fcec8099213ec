//! A motion as a table: states, torques and reactions at equally spaced times.

use super::cycle::stance_leg;
use super::error::{VerifyError, check};
use super::geometry::Vec3;
use super::instants::State;
use super::phase::Phase;
use piaffe_model::Description;
use piaffe_model::motion::Motion;
use serde::{Deserialize, Serialize};

/// One instant of a motion. World axes with the origin in the first stance foot; SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// 1-based.
    pub half_step: usize,
    /// From the beginning of the half step, s.
    pub t: f64,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Of every joint, N·m.
    pub torques: Vec<f64>,
    /// Reaction on the stance foot, N.
    pub force: [f64; 3],
    /// The platform's mass centre.
    pub platform: [f64; 3],
    pub stance_foot: [f64; 3],
    pub swing_foot: [f64; 3],
}

/// The motion at `points` instants of each half step, both ends included.
///
/// # Errors
/// As for [`verify`](super::verify).
pub fn sample(description: &Description, motion: &Motion, points: usize) -> Result<Vec<Sample>, VerifyError> {
    check(description, motion, points)?;
    let mut samples = Vec::with_capacity(points * motion.half_steps.len());
    let mut state = State::new(description);
    let mut foot: Vec3 = Vec3::zeros();
    for (i, half_step) in motion.half_steps.iter().enumerate() {
        let mut phase = Phase::new(description, half_step, stance_leg(description, i), i + 1)?;
        for k in 0..points {
            let t = half_step.duration * (k as f64 / (points - 1) as f64);
            phase.at(t, &mut state)?;
            samples.push(Sample {
                half_step: i + 1,
                t,
                q: state.q.clone(),
                qd: state.qd.clone(),
                qdd: state.qdd.clone(),
                torques: state.torques.clone(),
                force: state.force.into(),
                platform: (foot + state.platform).into(),
                stance_foot: foot.into(),
                swing_foot: (foot + state.swing).into(),
            });
        }
        // The foot that lands is the next to stand.
        foot += state.swing;
    }
    Ok(samples)
}
