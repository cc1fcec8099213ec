//! Joints that follow functions of time.
//!
//! At the clock's time of a landing, the state of the robot deviates from the gait's by (δβ, δσ). That is all: the joints are
//! where the clock wants them. The half step carries the deviation linearly. At its end the swing foot meets the ground
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

use super::halving;
use super::passage::{Passage, with_next_names};
use piaffe_model::Gait;
use piaffe_sqp::dot;
use serde::{Deserialize, Serialize};

/// What the clock of the references does when the foot lands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The gait keeps its period, however late a foot lands.
    RunsOn,
    /// The next half step begins when the foot lands.
    StartsAnew,
}

/// The return map of (β, σ) from step to step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeTracking {
    /// Real and imaginary parts, per step.
    pub eigenvalues: [[f64; 2]; 2],
    /// Largest modulus: what a deviation is multiplied by, from step to step.
    pub factor: f64,
    /// Steps until a deviation is halved; none if it grows.
    pub steps_to_halve: Option<f64>,
}

impl TimeTracking {
    /// From the half steps that define the gait, of which a step is `repeats` rounds.
    pub fn new(gait: &dyn Gait, passages: &[Passage], repeats: usize, clock: Clock) -> TimeTracking {
        let mut step = [[1.0, 0.0], [0.0, 1.0]];
        for passage in (0..repeats).flat_map(|_| passages) {
            step = product(&half_step_map(gait, passage, clock), &step);
        }
        let eigenvalues = eigenvalues(&step);
        let factor = eigenvalues.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
        TimeTracking { eigenvalues, factor, steps_to_halve: halving(factor) }
    }
}

/// What becomes of (δβ, δσ) from just after a landing to just after the next: rows β, σ.
pub fn half_step_map(gait: &dyn Gait, passage: &Passage, clock: Clock) -> [[f64; 2]; 2] {
    let columns = [0, 1].map(|column| {
        let [beta, sigma] = [0, 1].map(|row| passage.flow[row][column]);
        across_landing(gait, passage, beta, sigma, clock)
    });
    [0, 1].map(|row| [columns[0][row], columns[1][row]])
}

/// Takes (δβ, δσ) at the end of a half step across the landing.
fn across_landing(gait: &dyn Gait, passage: &Passage, beta: f64, sigma: f64, clock: Clock) -> [f64; 2] {
    let (landing, next) = (&passage.landing, &passage.next);
    let unactuated = gait.description().unactuated;
    let late = -landing.height[unactuated] * beta / landing.speed();
    let mut q: Vec<f64> = landing.state.qd.iter().map(|rate| rate * late).collect();
    let mut qd: Vec<f64> = landing.state.qdd.iter().map(|acceleration| acceleration * late).collect();
    q[unactuated] += beta;
    qd[unactuated] += landing.betad[0] * beta + landing.betad[1] * sigma;

    let qd = with_next_names(gait.description(), passage.index, &landing.impact(&q, &qd));
    let q = with_next_names(gait.description(), passage.index, &q);
    // By how much the next references are ahead when they begin.
    let ahead = if clock == Clock::RunsOn { late } else { 0.0 };
    let deviation: Vec<f64> = q.iter().zip(&next.qd).map(|(q, rate)| q - rate * ahead).collect();
    let beta = dot(&next.by_qd, &deviation) / next.by_qd[unactuated];
    let sigma = dot(&next.by_q, &q) + dot(&next.by_qd, &qd) - next.sigmad * ahead;
    [beta, sigma]
}

fn product(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    a.map(|row| [0, 1].map(|column| row[0] * b[0][column] + row[1] * b[1][column]))
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
