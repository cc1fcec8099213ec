//! A periodic motion as the numbers that define it: the variables Θ of §5.2 and what follows from them.

use serde::{Deserialize, Serialize};

/// The phases of a gait in their order: half of its cycle where the other half mirrors them, else all of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    #[serde(alias = "half_steps")]
    pub phases: Vec<Course>,
}

impl Motion {
    /// Of each phase, s.
    pub fn durations(&self) -> impl Iterator<Item = f64> {
        self.phases.iter().map(|course| course.duration)
    }
}

/// The course of one phase, be it single support or flight: the numbers that define Q(t) during it. Q are the prescribed
/// coordinates in the order of q without β.
///
/// Q(t) is the polynomial (eq. 15) with these initial and final values and rates that passes through
/// the interior values at equally spaced times (one at T/2 for order 4, three at T/4, T/2, 3T/4 for
/// order 6, five for order 8). Initial values follow from the final ones of the phase before:
/// same configuration, velocities after the impact (eq. 16, 18, 19) or, where a foot takes off, the same
/// velocities, legs renamed where the gait is mirrored. Angles in rad, rates in rad/s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Course<T = f64> {
    /// T, s.
    pub duration: T,
    pub q_initial: Vec<T>,
    pub qd_initial: Vec<T>,
    /// Interior values, one list per time.
    pub q_interior: Vec<Vec<T>>,
    pub q_final: Vec<T>,
    pub qd_final: Vec<T>,
    pub beta_initial: T,
    pub betad_initial: T,
    /// What β and β̇ must be at the end for the motion to be a cycle (eq. 23, 24).
    pub beta_final: T,
    pub betad_final: T,
}

impl Course {
    /// The same numbers as scalars of another kind.
    pub fn cast<T: From<f64>>(&self) -> Course<T> {
        let list = |values: &[f64]| values.iter().map(|x| T::from(*x)).collect();
        Course {
            duration: self.duration.into(),
            q_initial: list(&self.q_initial),
            qd_initial: list(&self.qd_initial),
            q_interior: self.q_interior.iter().map(|q| list(q)).collect(),
            q_final: list(&self.q_final),
            qd_final: list(&self.qd_final),
            beta_initial: self.beta_initial.into(),
            betad_initial: self.betad_initial.into(),
            beta_final: self.beta_final.into(),
            betad_final: self.betad_final.into(),
        }
    }
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
