//! A periodic motion as the numbers that define it: the variables Θ of §5.2 and what follows from them.

use serde::{Deserialize, Serialize};

/// One step of a gait: one half step where the second mirrors it, else two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    pub half_steps: Vec<HalfStep>,
}

/// A single support phase. Q are the prescribed coordinates in the order of q without β.
///
/// Q(t) is the polynomial (eq. 15) with these initial and final values and rates that passes through
/// the interior values at equally spaced times (one at T/2 for order 4, three at T/4, T/2, 3T/4 for
/// order 6, five for order 8). Initial values follow from the final ones of the half step before:
/// same configuration, velocities after the impact (eq. 16, 18, 19), legs renamed where the gait is
/// mirrored. Angles in rad, rates in rad/s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HalfStep {
    /// T, s.
    pub duration: f64,
    pub q_initial: Vec<f64>,
    pub qd_initial: Vec<f64>,
    /// Interior values, one list per time.
    pub q_interior: Vec<Vec<f64>>,
    pub q_final: Vec<f64>,
    pub qd_final: Vec<f64>,
    pub beta_initial: f64,
    pub betad_initial: f64,
    /// What β and β̇ must be at the end for the motion to be a cycle (eq. 23, 24).
    pub beta_final: f64,
    pub betad_final: f64,
}

/// What is minimized, per metre of travel (§4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Criterion {
    /// C2 = (1/d) ∫ Σ |Γj q̇j| dt, N (eq. 14).
    Energy,
    /// C1 = (1/d) ∫ Σ Γj² dt, N²·m·s (eq. 13).
    Torque,
}

impl Criterion {
    pub const ALL: [Criterion; 2] = [Criterion::Energy, Criterion::Torque];

    pub fn name(self) -> &'static str {
        match self {
            Criterion::Energy => "energy",
            Criterion::Torque => "torque",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Criterion::Energy => "N",
            Criterion::Torque => "N²·m·s",
        }
    }
}

/// Both criteria, per metre of travel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Costs {
    /// C2, N.
    pub energy: f64,
    /// C1, N²·m·s.
    pub torque: f64,
}

impl Costs {
    pub fn of(&self, criterion: Criterion) -> f64 {
        match criterion {
            Criterion::Energy => self.energy,
            Criterion::Torque => self.torque,
        }
    }
}
