//! A phase on a dense uniform grid: constraints, costs and peaks.
//!
//! Optimizers impose constraints at a few nodes; between them they can be broken. Here all that
//! must hold at every instant (§4.2, §6.1) is evaluated at every point of the grid.

use super::constraint::{Constraint, Tally};
use super::contact::contact;
use super::error::VerifyError;
use super::instants::{Instants, State};
use super::margins::{Units, at_rest, clearance, steepness};
use super::numbers::Numbers;
use super::phase::Phase;
use super::quadrature::{Dry, integral, integral_of_magnitude};
use super::swing::swings;
use piaffe_model::motion::Course;
use piaffe_number::{Lanes, Scalar};
use std::array::from_fn;

/// What a phase adds up to.
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

/// Instants that are evaluated side by side.
const LANES: usize = 4;

/// Evaluates `points` instants of a phase and notes the margins.
pub fn evaluate(
    phase: &mut Phase,
    motion: &[Course],
    index: usize,
    points: usize,
    tally: &mut Tally,
) -> Result<Totals, VerifyError> {
    let description = phase.description();
    let units = Units::new(description);
    let joints = description.joints();
    let mut instants: Instants<Lanes<LANES>> = Instants::new(
        description,
        Numbers::new(description),
        &motion[index].cast(),
        contact(description, motion, index),
    );
    let own = swings(description, motion, index);
    let lanes: Vec<Course<Lanes<LANES>>> = motion.iter().map(Course::cast).collect();
    let side_by_side = swings(description, &lanes, index);
    let mut state = State::new(description);
    // Lists of a joint at a time, as if there were no dry friction.
    let mut squares = vec![0.0; points];
    let [mut torques, mut powers, mut rates] = [0; 3].map(|_| vec![0.0; points * joints]);
    let mut peaks = vec![[0.0_f64; 2]; joints];
    let last = points - 1;
    let mut platform = vec![0.0; points];
    for first in (0..points).step_by(LANES) {
        // Lanes beyond the last point repeat it.
        let s: [f64; LANES] = from_fn(|lane| (first + lane).min(last) as f64 / last as f64);
        let t = s.map(|s| phase.duration * s);
        let [beta, betad] = transpose(t.map(|t| phase.beta(t)));
        let acceleration = instants.at(Lanes(t), [Lanes(beta), Lanes(betad)], &mut state);
        if !acceleration.is_some_and(|a| a.0.iter().all(|a| a.is_finite())) {
            return Err(phase.singular(t[0]));
        }
        let count = LANES.min(points - first);
        for (j, (motor, rate)) in state.motors.iter().zip(&state.qd).enumerate() {
            let joint = &description.joints[j];
            let spring = || (state.q[j] - Lanes([joint.rest; LANES])).scale(joint.stiffness);
            let smooth =
                if joint.coulomb == 0.0 { *motor } else { state.torques[j] + spring() + rate.scale(joint.damping) };
            for lane in 0..count {
                let (torque, rate, at) = (smooth.0[lane], rate.0[lane], j * points + first + lane);
                squares[first + lane] += torque * torque;
                (torques[at], powers[at], rates[at]) = (torque, torque * rate, rate);
                peaks[j] = [peaks[j][0].max(motor.0[lane].abs()), peaks[j][1].max(rate.abs())];
            }
        }
        units.margins(instants.numbers(), &instants.contact(), &state, |constraint, margin| {
            tally.note_all(constraint, &margin.0[..count], &t);
        });
        for (swing, lanes) in own.iter().zip(&side_by_side) {
            let numbers = instants.numbers();
            let above = clearance(numbers, &state, lanes, Lanes(t));
            let [rise, fall] = [false, true].map(|at_end| steepness(numbers, &state, lanes, at_end));
            let margin: [f64; LANES] = from_fn(|lane| {
                let (above, per_height) = match (first + lane, rise, fall) {
                    (0, Some(rise), _) => (rise.0[lane], swing.descent()),
                    (i, _, Some(fall)) if i == last => (fall.0[lane], swing.descent()),
                    _ => (above.0[lane], swing.curve(t[lane])),
                };
                room(above, per_height) / units.leg
            });
            tally.note_all(swing.constraint, &margin[..count], &t);
        }
        platform[first..first + count].copy_from_slice(&state.platform.x.0[..count]);
    }
    if let Some(leg) = description.transition(index).lands() {
        let landing = state.feet[leg].y.0[last % LANES];
        tally.note(Constraint::Touchdown, -landing.abs() / units.leg, phase.duration);
    }
    let spacing = phase.duration / last as f64;
    let mut totals =
        Totals { torque: integral(&squares, spacing), energy: 0.0, travel: platform[last] - platform[0], peaks };
    for (j, joint) in description.joints.iter().enumerate() {
        let [torques, powers, rates] = [&torques, &powers, &rates].map(|list| &list[j * points..][..points]);
        if joint.coulomb == 0.0 {
            totals.energy += integral_of_magnitude(powers, spacing);
        } else {
            let rests = rates.iter().all(|rate| rate.abs() <= at_rest(description));
            let dry = Dry { coulomb: joint.coulomb, rates, rests, spacing };
            totals.energy += dry.energy(powers);
            totals.torque += dry.torque(torques);
        }
    }
    Ok(totals)
}

/// How much higher the curve could be, m, where the foot is so much above it; what is missing, where it is below.
///
/// At both ends the height is zero and the slope has to be steep enough: ±ẏ T ≥ 4 h. Near the ends
/// any foot is close to the curve; so room that is left is measured as the amount by which h
/// could grow, which goes over into the margin of the slope.
fn room(above: f64, per_height: f64) -> f64 {
    if above > 0.0 { above / per_height } else { above }
}

fn transpose<const N: usize>(pairs: [[f64; 2]; N]) -> [[f64; N]; 2] {
    [0, 1].map(|k| pairs.map(|pair| pair[k]))
}
