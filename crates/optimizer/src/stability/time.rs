//! Joints that follow functions of time.
//!
//! At the clock's time of a landing, the state of the robot deviates from the gait's by (δβ, δσ). That is all: the joints are
//! where the clock wants them. A phase carries the deviation linearly. At its end the swing foot meets the ground
//!
//! ```text
//! δt = −(∂h/∂β) δβ / ḣ
//! ```
//!
//! late, with q and q̇⁻ changed by both. The impact (eq. 12) is linearized likewise. What the joints are now from where the
//! next references want them, tracking takes up at once: gravity has no time, so σ is kept, and with e the deviation of all
//! coordinates from the gait at the same clock time,
//!
//! ```text
//! f1 δβ⁺ = ∂σ/∂q̇ · e
//! ```
//!
//! A foot leaves when the clock says so: until then it is loaded, and then the references lift it. In flight σ is that about the mass
//! centre, and what else deviates is the mass centre's parabola: its height, and its velocity. Landing, h has the
//! height's deviation too, and the impact that of the velocity. How far forward it is does not matter.

use super::halving;
use super::passage::{Crossing, Passage, with_next_names};
use piaffe_model::{Gait, Mode, UP};
use piaffe_sqp::dot;
use serde::{Deserialize, Serialize};

/// What the clock of the references does when the foot lands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The gait keeps its period, however late a foot lands.
    RunsOn,
    /// The next phase begins when the foot lands.
    StartsAnew,
}

/// The return map of (β, σ) over a whole step: from step to step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeTracking {
    /// Real and imaginary parts, per whole step.
    pub eigenvalues: [[f64; 2]; 2],
    /// Largest modulus: what a deviation is multiplied by, from step to step.
    pub factor: f64,
    /// Whole steps until a deviation is halved; none if it grows.
    pub steps_to_halve: Option<f64>,
}

impl TimeTracking {
    /// From the phases that define the gait, of which a step is `repeats` rounds.
    pub fn new(gait: &dyn Gait, passages: &[Passage], repeats: usize, clock: Clock) -> TimeTracking {
        // On the ground nothing but (β, σ) deviates; eigenvalues do not depend on where in the step one looks.
        let first = passages.iter().position(|passage| passage.mode != Mode::Flight).unwrap_or_default();
        let step = passages.iter().cycle().skip(first).take(repeats * passages.len());
        let carried =
            |start: Deviation| step.clone().fold(start, |deviation, passage| carry(gait, passage, deviation, clock));
        let by_beta = carried(Deviation { beta: 1.0, ..Deviation::default() });
        let by_sigma = carried(Deviation { sigma: 1.0, ..Deviation::default() });
        let step = [[by_beta.beta, by_sigma.beta], [by_beta.sigma, by_sigma.sigma]];
        let eigenvalues = eigenvalues(&step);
        let factor = eigenvalues.iter().map(|[re, im]| libm::hypot(*re, *im)).fold(0.0, f64::max);
        TimeTracking { eigenvalues, factor, steps_to_halve: halving(factor) }
    }
}

/// From the gait, at the same time of the clock.
#[derive(Clone, Copy, Debug, Default)]
struct Deviation {
    beta: f64,
    sigma: f64,
    /// Of the mass centre in flight: its height, m, and its velocity, forward and up, m/s.
    height: f64,
    velocity: [f64; 2],
}

/// What becomes of a deviation from just after a transition to just after the next.
fn carry(gait: &dyn Gait, passage: &Passage, start: Deviation, clock: Clock) -> Deviation {
    let [beta, sigma] = passage.flow.map(|[by_beta, by_sigma]| by_beta * start.beta + by_sigma * start.sigma);
    let height = start.height + passage.duration * start.velocity[UP];
    across(gait, passage, Deviation { beta, sigma, height, ..start }, clock)
}

/// Takes a deviation at the end of a phase across the transition.
fn across(gait: &dyn Gait, passage: &Passage, at: Deviation, clock: Clock) -> Deviation {
    let (d, end, next) = (gait.description(), &passage.end, &passage.next);
    let late = match &passage.crossing {
        Crossing::Lands { height, speed, .. } => -(height[d.unactuated] * at.beta + at.height) / speed,
        Crossing::Leaves { .. } => 0.0,
    };
    let mut q: Vec<f64> = end.state.qd.iter().map(|rate| rate * late).collect();
    let mut qd: Vec<f64> = end.state.qdd.iter().map(|acceleration| acceleration * late).collect();
    q[d.unactuated] += at.beta;
    qd[d.unactuated] += end.betad[0] * at.beta + end.betad[1] * at.sigma;
    let [forward, up] = at.velocity;

    let mut after = Deviation::default();
    let qd = match &passage.crossing {
        Crossing::Lands { impact, .. } => {
            let before = match passage.mode {
                Mode::Flight => [&q[..], &[forward, up - d.gravity * late], &qd].concat(),
                Mode::Stance(_) => [&q[..], &qd].concat(),
            };
            impact.chunks(before.len()).map(|row| dot(row, &before)).collect()
        }
        Crossing::Leaves { height, velocity } => {
            after.height = dot(height, &q);
            after.velocity = velocity.each_ref().map(|row| dot(row, &[&q[..], &qd].concat()));
            qd
        }
    };
    let (q, qd) = (with_next_names(d, passage.index, &q), with_next_names(d, passage.index, &qd));
    // By how much the next references are ahead when they begin.
    let ahead = if clock == Clock::RunsOn { late } else { 0.0 };
    let deviation: Vec<f64> = q.iter().zip(&next.qd).map(|(q, rate)| q - rate * ahead).collect();
    after.beta = dot(&next.by_qd, &deviation) / next.by_qd[d.unactuated];
    after.sigma = dot(&next.by_q, &q) + dot(&next.by_qd, &qd) - next.sigmad * ahead;
    after
}

/// Real and imaginary parts of a matrix's eigenvalues, the larger modulus first.
fn eigenvalues(m: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let (half_trace, determinant) = (0.5 * (m[0][0] + m[1][1]), m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    let discriminant = half_trace * half_trace - determinant;
    if discriminant < 0.0 {
        let imaginary = (-discriminant).sqrt();
        return [[half_trace, imaginary], [half_trace, -imaginary]];
    }
    // The larger one without cancellation, the other from the product of both.
    let larger = half_trace + discriminant.sqrt().copysign(half_trace);
    let smaller = if larger == 0.0 { 0.0 } else { determinant / larger };
    [[larger, 0.0], [smaller, 0.0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_solve_the_characteristic_equation() {
        for m in [[[0.3, 2.0], [0.1, -0.7]], [[0.3, 2.0], [-1.0, 0.1]], [[1e8, 1.0], [1.0, 1e-8]], [[0.0; 2]; 2]] {
            for [re, im] in eigenvalues(&m) {
                let (trace, determinant) = (m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]);
                let residual = [re * re - im * im - trace * re + determinant, 2.0 * re * im - trace * im];
                assert!(residual.iter().all(|r| r.abs() <= 1e-15 * (1.0 + re * re + im * im)), "{m:?} {residual:?}");
            }
        }
    }
}
