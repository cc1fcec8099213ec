//! The equations of motion of the whole robot at one posture, A u̇ + H = Sᵀ Γ + D F, and of an impact, A Δu = D I.

use super::posture::Posture;
use crate::model::whole::Whole;
use nalgebra::{DMatrix, DVector, DVectorView};

/// A, H and D.
pub struct Equations {
    pub inertia: DMatrix<f64>,
    pub bias: DVector<f64>,
    /// n × 3 per leg, platform's axes.
    pub feet: DMatrix<f64>,
    weight: f64,
    length: f64,
    mass: f64,
}

impl Equations {
    /// `length` (m) makes moments comparable with forces: that of a leg.
    pub fn new(whole: &dyn Whole, posture: &Posture, length: f64) -> Equations {
        let d = whole.description();
        let (n, c) = (d.speeds(), d.reactions());
        let mut out = vec![0.0; n * n + n];
        whole.inertia_and_bias(&posture.up(), &posture.omega(), &posture.q, posture.rates(), &mut out);
        let mut feet = vec![0.0; c + n * c];
        whole.feet(&posture.q, &mut feet);
        let mass = d.total_mass();
        Equations {
            inertia: DMatrix::from_row_slice(n, n, &out[..n * n]),
            bias: DVector::from_column_slice(&out[n * n..]),
            feet: DMatrix::from_row_slice(n, c, &feet[c..]),
            weight: mass * d.gravity,
            length,
            mass,
        }
    }

    /// What torques and reactions must add up to: A u̇ + H.
    pub fn demand(&self, ud: &[f64]) -> DVector<f64> {
        &self.inertia * DVectorView::from_slice(ud, ud.len()) + &self.bias
    }

    /// What impulses must add up to: A Δu.
    pub fn impulse_demand(&self, change: &[f64]) -> DVector<f64> {
        &self.inertia * DVectorView::from_slice(change, change.len())
    }

    /// Columns of D for the feet of `legs`.
    pub fn columns(&self, legs: &[usize]) -> DMatrix<f64> {
        let columns: Vec<usize> = legs.iter().flat_map(|leg| 3 * leg..3 * leg + 3).collect();
        self.feet.select_columns(&columns)
    }

    /// The largest entry of a vector of forces and moments, in the robot's weight and in weight times length.
    pub fn scaled(&self, forces: &DVector<f64>) -> f64 {
        self.largest(forces, self.weight)
    }

    /// The same of impulses, in the robot's momentum at 1 m/s and in that times length.
    pub fn scaled_impulse(&self, impulses: &DVector<f64>) -> f64 {
        self.largest(impulses, self.mass)
    }

    fn largest(&self, v: &DVector<f64>, unit: f64) -> f64 {
        let each = v.iter().enumerate().map(|(k, x)| x.abs() / if k < 3 { unit } else { unit * self.length });
        // A sum keeps what is no number, a maximum would not.
        each.fold(0.0, |most, x| if x > most || x.is_nan() { x } else { most })
    }
}
