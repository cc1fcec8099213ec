//! Random robots of the family that could be built.
#![allow(dead_code, reason = "each test binary uses its part")]

use piaffe::model::family::{Family, Parametric};

/// How far random robots are from the specification's.
pub struct Spread {
    /// By up to this share of each number.
    pub share: f64,
    /// Rotors, which weigh nothing there, get up to this, kg·m² at the motor.
    pub rotor: f64,
    /// Slender and flat bodies become this thick, as a share.
    pub thickness: f64,
}

/// The numbers of the specification ± 30 %.
pub const NEAR: Spread = Spread { share: 0.3, rotor: 0.0, thickness: 0.0 };
/// No number is zero or at the edge of what is possible.
pub const GENERAL: Spread = Spread { share: 0.3, rotor: 2e-5, thickness: 0.1 };

pub fn member(family: &Family, spread: &Spread, rng: &mut fastrand::Rng) -> Box<dyn Parametric> {
    let mut values = family.nominal();
    let mut k = 0;
    while k < values.len() {
        let mut factor = || 1.0 + spread.share * (2.0 * rng.f64() - 1.0);
        let name = family.parameters[k].name;
        if name.contains(".inertia.") {
            // Second moments of mass, ∫x² dm and so on, are free; moments of inertia are their sums.
            let sum: f64 = values[k..k + 3].iter().sum();
            let second = [0, 1, 2].map(|i| (0.5 * sum - values[k + i]).max(0.5 * sum * spread.thickness) * factor());
            let total: f64 = second.iter().sum();
            (0..3).for_each(|i| values[k + i] = total - second[i]);
            k += 3;
        } else {
            let rotor = name.ends_with(".rotor_inertia");
            values[k] = if rotor { spread.rotor * (0.2 + 0.8 * rng.f64()) } else { values[k] * factor() };
            k += 1;
        }
    }
    (family.member)(&values).unwrap()
}
