//! A gait as the polynomials that a controller follows (eq. 15).

use super::table::{coordinates, real_joints};
use piaffe_model::motion::{Course, Motion};
use piaffe_model::{Description, Gait, Then};
use piaffe_optimizer::trajectory::Basis;
use serde::Serialize;

/// The prescribed coordinates over time, phase by phase.
#[derive(Clone, Debug, Serialize)]
pub struct Controller {
    pub gait: String,
    pub robot: String,
    pub fingerprint: String,
    /// Whether the second half of the phases is the first one with the legs exchanged.
    pub mirrored: bool,
    /// The real legs of both virtual legs.
    pub legs: [Vec<String>; 2],
    pub phases: Vec<Program>,
}

/// One phase.
#[derive(Clone, Debug, Serialize)]
pub struct Program {
    /// s.
    pub duration: f64,
    /// The real legs in support; none in flight.
    pub stance: Vec<String>,
    pub coordinates: Vec<Polynomial>,
    /// What follows of itself: the coordinate that no actuator drives.
    pub unactuated: Free,
}

/// rad = Σ coefficients\[i\]·tⁱ, with t in s from the beginning of the phase.
#[derive(Clone, Debug, Serialize)]
pub struct Polynomial {
    pub name: String,
    /// The real joints that follow it; none follows the platform's rotation.
    pub joints: Vec<String>,
    pub coefficients: Vec<f64>,
}

/// Both ends of the unactuated coordinate, rad and rad/s.
#[derive(Clone, Debug, Serialize)]
pub struct Free {
    pub name: String,
    /// The real joints that go with it.
    pub joints: Vec<String>,
    pub initial: f64,
    pub initial_rate: f64,
    pub r#final: f64,
    pub final_rate: f64,
}

/// The program of a motion; for a mirrored gait with both halves written out.
pub fn controller(gait: &dyn Gait, motion: &Motion) -> Controller {
    let d = gait.description();
    let legs = [0, 1].map(|leg| d.legs[leg].members.iter().map(|m| m.name.to_string()).collect::<Vec<_>>());
    let mirrored = d.then == Then::Mirrored;
    let count = d.phases.len();
    let of_phase = |h: usize| {
        let (phase, exchanged) = (h % count, h >= count);
        let mode = d.phases[phase].mode;
        let stance = if exchanged { mode.exchanged() } else { mode }.stance();
        program(d, &motion.phases[phase], exchanged, stance.map_or(&[], |leg| &legs[leg]))
    };
    let phases = (0..if mirrored { 2 * count } else { count }).map(of_phase).collect();
    Controller { gait: d.gait.into(), robot: d.robot.into(), fingerprint: d.fingerprint(), mirrored, phases, legs }
}

fn program(d: &Description, h: &Course, exchanged: bool, stance: &[String]) -> Program {
    let names = coordinates(d);
    let joints = |k: usize| real_joints(d).filter(|(of, _)| *of == k).map(|(_, name)| name.into()).collect();
    // Where the legs have exchanged their roles, a coordinate does what its counterpart did.
    let role = |k: usize| if exchanged { d.swapped(k) } else { (k, 1.0) };
    let basis = Basis::new(d.polynomial_order);
    let mut polynomials: Vec<(usize, Polynomial)> = Vec::new();
    for j in 0..d.prescribed() {
        let (k, sign) = role(d.prescribed_index(j));
        let coefficients = coefficients(&basis, h, j).iter().map(|c| sign * c + 0.0).collect();
        polynomials.push((k, Polynomial { name: names[k].clone(), joints: joints(k), coefficients }));
    }
    polynomials.sort_by_key(|(k, _)| *k);
    let (beta, sign) = role(d.unactuated);
    Program {
        duration: h.duration,
        stance: stance.to_vec(),
        coordinates: polynomials.into_iter().map(|(_, p)| p).collect(),
        unactuated: Free {
            name: names[beta].clone(),
            joints: joints(beta),
            initial: sign * h.beta_initial,
            initial_rate: sign * h.betad_initial,
            r#final: sign * h.beta_final,
            final_rate: sign * h.betad_final,
        },
    }
}

/// Coefficients of tⁱ of the j-th prescribed coordinate.
fn coefficients(basis: &Basis, h: &Course, j: usize) -> Vec<f64> {
    let inner = h.q_interior.iter().map(|values| values[j]);
    let start = [h.q_initial[j], h.duration * h.qd_initial[j]];
    let end = [h.q_final[j], h.duration * h.qd_final[j]];
    let parameters = start.into_iter().chain(inner).chain(end);
    let mut sum = vec![0.0; basis.len()];
    for (k, p) in parameters.enumerate() {
        for (s, c) in sum.iter_mut().zip(basis.coefficients(k)) {
            *s += p * c;
        }
    }
    sum.iter().enumerate().map(|(i, c)| c / h.duration.powi(i as i32)).collect()
}
