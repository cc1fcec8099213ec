//! A half step on a dense uniform grid: constraints, costs and peaks.
//!
//! Optimizers impose constraints at a few nodes; between them they can be broken. Here all that
//! must hold at every instant (§4.2, §6.1) is evaluated at every point of the grid.

use super::constraint::{Constraint, Tally};
use super::error::VerifyError;
use super::multibody::Vec3;
use super::phase::{Phase, State};
use super::quadrature::{integral, integral_of_magnitude};
use super::support::leg_length;
use crate::model::Description;

/// What a half step adds up to.
#[derive(Clone, Debug)]
pub struct Totals {
    /// ∫ Σ Γ² dt, N²·m²·s.
    pub torque: f64,
    /// ∫ Σ |Γ q̇| dt, J.
    pub energy: f64,
    /// x(T) − x(0) of the platform's mass centre, m.
    pub travel: f64,
    /// Greatest |Γ| and |q̇| of each joint, N·m and rad/s.
    pub peaks: Vec<[f64; 2]>,
}

/// Scales and limits in the form that the grid needs them.
struct Judge<'a> {
    description: &'a Description,
    weight: f64,
    leg: f64,
}

/// Evaluates `points` instants of a half step and notes the margins.
pub fn evaluate(
    description: &Description,
    phase: &mut Phase,
    points: usize,
    tally: &mut Tally,
) -> Result<Totals, VerifyError> {
    let weight = description.total_mass() * description.gravity;
    let judge = Judge { description, weight, leg: leg_length(description) };
    let joints = description.joints();
    let mut state = State::new(description);
    let mut squares = vec![0.0; points];
    // One list of powers per joint.
    let mut powers = vec![0.0; points * joints];
    let mut peaks = vec![[0.0_f64; 2]; joints];
    let mut ends = [0.0; 2];
    let last = points - 1;
    for i in 0..points {
        let s = i as f64 / last as f64;
        let t = phase.duration * s;
        phase.at(t, &mut state)?;
        for (j, (torque, rate)) in state.torques.iter().zip(&state.qd).enumerate() {
            squares[i] += torque * torque;
            powers[j * points + i] = torque * rate;
            peaks[j] = [peaks[j][0].max(torque.abs()), peaks[j][1].max(rate.abs())];
        }
        judge.joints(&state, t, tally);
        judge.reaction(&state.force, t, tally);
        judge.clearance(&state, s, phase.duration, tally);
        let height = state.platform.y - description.limits.min_platform_height;
        tally.note(Constraint::PlatformHeight, height / judge.leg, t);
        if i == 0 {
            ends[0] = state.platform.x;
        }
        ends[1] = state.platform.x;
    }
    tally.note(Constraint::Touchdown, -state.swing.y.abs() / judge.leg, phase.duration);
    let spacing = phase.duration / last as f64;
    let energy = powers.chunks_exact(points).map(|w| integral_of_magnitude(w, spacing)).sum();
    Ok(Totals { torque: integral(&squares, spacing), energy, travel: ends[1] - ends[0], peaks })
}

impl Judge<'_> {
    fn joints(&self, state: &State, t: f64, tally: &mut Tally) {
        for (j, joint) in self.description.joints.iter().enumerate() {
            let load = state.torques[j].abs() / joint.max_torque;
            tally.note(Constraint::Torque(j), 1.0 - load, t);
            let fastest = joint.unloaded_speed - (joint.unloaded_speed - joint.loaded_speed) * load;
            tally.note(Constraint::Speed(j), (fastest - state.qd[j].abs()) / joint.unloaded_speed, t);
            tally.note(Constraint::LowerStop(j), state.q[j] - joint.range[0], t);
            tally.note(Constraint::UpperStop(j), joint.range[1] - state.q[j], t);
        }
    }

    fn reaction(&self, force: &Vec3, t: f64, tally: &mut Tally) {
        let limits = &self.description.limits;
        tally.note(Constraint::VerticalForce, (force.y - limits.min_vertical_force) / self.weight, t);
        tally.note(Constraint::Friction, (limits.friction * force.y - tangential(force)) / self.weight, t);
    }

    /// Height of the swing foot above the parabola 4 h s (1 − s).
    ///
    /// At both ends the height is zero and the slope has to be steep enough: ±ẏ T ≥ 4 h. Near the ends
    /// any foot is close to the parabola; so room that is left is measured as the amount by which h
    /// could grow, which goes over into the margin of the slope.
    fn clearance(&self, state: &State, s: f64, duration: f64, tally: &mut Tally) {
        let h = self.description.limits.swing_clearance;
        let shape = 4.0 * s * (1.0 - s);
        let (above, per_height) = if s == 0.0 {
            (state.swing_velocity.y * duration - 4.0 * h, 4.0)
        } else if s == 1.0 {
            (-state.swing_velocity.y * duration - 4.0 * h, 4.0)
        } else {
            (state.swing.y - h * shape, shape)
        };
        let margin = if above > 0.0 { above / per_height } else { above };
        tally.note(Constraint::Clearance, margin / self.leg, duration * s);
    }
}

/// Magnitude of the part along the ground.
pub fn tangential(force: &Vec3) -> f64 {
    (force.x * force.x + force.z * force.z).sqrt()
}
