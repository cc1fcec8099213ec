//! A half step on a dense uniform grid: constraints, costs and peaks.
//!
//! Optimizers impose constraints at a few nodes; between them they can be broken. Here all that
//! must hold at every instant (§4.2, §6.1) is evaluated at every point of the grid.

use super::constraint::{Constraint, Tally};
use super::error::VerifyError;
use super::instants::State;
use super::margins::{Units, clearance, steepness};
use super::phase::Phase;
use super::quadrature::{integral, integral_of_magnitude};

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

/// Evaluates `points` instants of a half step and notes the margins.
pub fn evaluate(phase: &mut Phase, points: usize, tally: &mut Tally) -> Result<Totals, VerifyError> {
    let description = phase.description();
    let units = Units::new(description);
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
        units.margins(phase.numbers(), &state, |constraint, margin| tally.note(constraint, margin, t));
        tally.note(Constraint::Clearance, swing_margin(phase, &state, s) / units.leg, t);
        if i == 0 {
            ends[0] = state.platform.x;
        }
        ends[1] = state.platform.x;
    }
    tally.note(Constraint::Touchdown, -state.swing.y.abs() / units.leg, phase.duration);
    let spacing = phase.duration / last as f64;
    let energy = powers.chunks_exact(points).map(|w| integral_of_magnitude(w, spacing)).sum();
    Ok(Totals { torque: integral(&squares, spacing), energy, travel: ends[1] - ends[0], peaks })
}

/// Room of the swing foot above the parabola, m.
///
/// At both ends the height is zero and the slope has to be steep enough: ±ẏ T ≥ 4 h. Near the ends
/// any foot is close to the parabola; so room that is left is measured as the amount by which h
/// could grow, which goes over into the margin of the slope.
fn swing_margin(phase: &Phase, state: &State, s: f64) -> f64 {
    let numbers = phase.numbers();
    let (above, per_height) = if s == 0.0 || s == 1.0 {
        (steepness(numbers, state, phase.duration, s == 1.0), 4.0)
    } else {
        (clearance(numbers, state, s), 4.0 * s * (1.0 - s))
    };
    if above > 0.0 { above / per_height } else { above }
}
