//! What a motion costs on the real joints.
//!
//! Counted so that equal shares cost what the virtual legs' joints do: Σ |Γ q̇| and, as n joints share one of the virtual leg,
//! n Σ Γ². Unequal shares cost more, and which they are is a choice.

use super::lift::{Instant, Lift};
use super::limits::Affine;
use piaffe_model::motion::Costs;
use serde::{Deserialize, Serialize};

/// One number for each way to share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ways<T> {
    /// As the virtual legs' joints do it.
    pub virtual_legs: T,
    /// Of each criterion the least that any shares cost, at every instant.
    pub least: T,
    /// The same of shares that keep to all limits; at instants at which none do, of those with the most room.
    pub within_limits: T,
    /// With each foot pushing in proportion to its load, as limits at each real leg have it.
    pub proportional: T,
}

/// Both criteria over all real joints, per metre of travel.
pub type RealCosts = Ways<Costs>;

/// What the joints do at an instant.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Γ q̇ of each joint, W.
    pub powers: Vec<f64>,
    /// n Σ Γ², N²·m².
    pub torque: f64,
    /// Whether powers may jump from one joint to another until the next instant, as those of the least energy of many feet do. What
    /// they cost together does not.
    pub jumps: bool,
}

/// The torque of a real joint over the choice of shares.
pub struct Motor {
    pub torque: Affine,
    /// rad/s.
    pub rate: f64,
    /// How many joints do together what the virtual leg's does.
    pub sharing: f64,
}

impl Effort {
    /// For one choice of shares, or two: one for the powers and one for the torques.
    pub fn new(motors: &[Motor], for_energy: &[f64], for_torque: &[f64]) -> Effort {
        let square = |motor: &Motor| motor.sharing * motor.torque.value(for_torque).powi(2);
        Effort {
            powers: motors.iter().map(|motor| motor.torque.value(for_energy) * motor.rate).collect(),
            torque: motors.iter().map(square).sum(),
            jumps: false,
        }
    }

    /// Σ |Γ q̇|, W.
    pub fn energy(&self) -> f64 {
        self.powers.iter().map(|power| power.abs()).sum()
    }
}

impl RealCosts {
    /// Of a lifted motion.
    pub fn of(lift: &Lift) -> RealCosts {
        Ways {
            virtual_legs: costs(lift, |instant| &instant.efforts.virtual_legs),
            least: costs(lift, |instant| &instant.efforts.least),
            within_limits: costs(lift, |instant| &instant.efforts.within_limits),
            proportional: costs(lift, |instant| &instant.efforts.proportional),
        }
    }
}

/// Both criteria over a lifted motion of what is done at each instant, per metre of travel.
pub fn costs(lift: &Lift, effort: fn(&Instant) -> &Effort) -> Costs {
    let mut work = Costs { energy: 0.0, torque: 0.0 };
    let mut add = |instants: &[Instant]| {
        let over_time = |of: &dyn Fn(&Effort) -> f64| {
            let mut points: Vec<(f64, f64)> = instants.iter().map(|i| (i.time, of(effort(i)))).collect();
            points.dedup_by(|b, a| a.0 == b.0);
            points
        };
        work.torque += integral(&over_time(&|effort| effort.torque), |parabola, to| parabola.integral(to));
        if instants.iter().any(|i| effort(i).jumps) {
            work.energy += integral(&over_time(&Effort::energy), |parabola, to| parabola.integral(to));
        } else {
            for joint in 0..instants.first().map_or(0, |i| effort(i).powers.len()) {
                work.energy += integral(&over_time(&|effort| effort.powers[joint]), Parabola::magnitude);
            }
        }
    };
    for phase in lift.instants.chunk_by(|a, b| a.phase == b.phase) {
        // Where dry friction changes its sign, the torques jump: on both sides by themselves, and what is between them.
        let mut begun = 0;
        for smooth in phase.chunk_by(|a, b| lift.legs.rubs_alike(&a.posture, &b.posture)) {
            if begun > 0 {
                add(&phase[begun - 1..=begun]);
            }
            add(smooth);
            begun += smooth.len();
        }
    }
    // Backwards, too, metres cost.
    let travel = lift.travel.abs();
    Costs { energy: work.energy / travel, torque: work.torque / travel }
}

/// `c0 + c1 t + c2 t²`.
struct Parabola([f64; 3]);

impl Parabola {
    /// From 0.
    fn integral(&self, to: f64) -> f64 {
        to * (self.0[0] + to * (self.0[1] / 2.0 + to * self.0[2] / 3.0))
    }

    /// The integral of its magnitude from 0, sign by sign.
    fn magnitude(self, to: f64) -> f64 {
        let [c0, c1, c2] = self.0;
        let root = (c1 * c1 - 4.0 * c0 * c2).sqrt();
        // Written so that nothing cancels; what is no root is no number, or outside.
        let q = -0.5 * (c1 + root.copysign(c1));
        let [a, b] = [q / c2, c0 / q].map(|root| if root > 0.0 && root < to { root } else { to });
        let at = [0.0, a.min(b), a.max(b), to].map(|end| self.integral(end));
        at.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
    }
}

/// The integral through points in order of time of a function of parabolas through three each, and of a line through the last
/// two if one is left; `part` gives it from 0.
fn integral(points: &[(f64, f64)], part: impl Fn(Parabola, f64) -> f64) -> f64 {
    let mut sum = 0.0;
    let mut rest = points;
    while let [(t0, f0), (t1, f1), (t2, f2), ..] = *rest {
        let (a, b) = (t1 - t0, t2 - t1);
        let (left, right) = ((f1 - f0) / a, (f2 - f1) / b);
        let bend = (right - left) / (a + b);
        sum += part(Parabola([f0, left - bend * a, bend]), a + b);
        rest = &rest[2..];
    }
    if let [(t0, f0), (t1, f1)] = *rest {
        sum += part(Parabola([f0, (f1 - f0) / (t1 - t0), 0.0]), t1 - t0);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_are_integrated_exactly_and_so_are_their_magnitudes() {
        let f = |t: f64| 1.0 + t - 3.0 * t * t;
        let points: Vec<(f64, f64)> = [0.0, 0.3, 1.0, 1.1, 2.0].map(|t| (t, f(t))).to_vec();
        let whole = |t: f64| t + t * t / 2.0 - t * t * t;
        let plain = integral(&points, |parabola, to| parabola.integral(to));
        assert!((plain - whole(2.0)).abs() < 1e-12);
        let root = (1.0 + 13f64.sqrt()) / 6.0;
        assert!((integral(&points, Parabola::magnitude) - (2.0 * whole(root) - whole(2.0))).abs() < 1e-12);
        // Lines and constants are parabolas too.
        let line: Vec<(f64, f64)> = [0.0, 0.5, 2.0].map(|t| (t, 1.0 - t)).to_vec();
        assert!((integral(&line, Parabola::magnitude) - 1.0).abs() < 1e-12);
        let constant: Vec<(f64, f64)> = [0.0, 0.5, 2.0, 3.0].map(|t| (t, -2.0)).to_vec();
        assert!((integral(&constant, Parabola::magnitude) - 6.0).abs() < 1e-12);
        let nothing: Vec<(f64, f64)> = [0.0, 0.5, 2.0].map(|t| (t, 0.0)).to_vec();
        assert_eq!(integral(&nothing, Parabola::magnitude), 0.0);
    }
}
