//! All ways in which feet can share what is demanded of them.

use nalgebra::{DMatrix, DVector};

/// Directions in which a share could change count as free below this part of the stiffest.
const FREE: f64 = 1e-9;

/// Reactions that meet a demand `columns · F = demand`: `nearest + squeezes · s` for any s.
pub struct Shares {
    /// Of all that meet the demand, or come closest to it, those nearest to equal shares; N, or N·s.
    pub nearest: DVector<f64>,
    /// Orthonormal: reactions that add up to nothing, the feet pushing against each other.
    pub squeezes: DMatrix<f64>,
    /// Demand less what `nearest` gives: nothing, unless no reactions meet it.
    pub remainder: DVector<f64>,
}

impl Shares {
    /// From equal shares of the reactions on all of the feet.
    pub fn new(columns: &DMatrix<f64>, demand: &DVector<f64>, equal: &DVector<f64>) -> Shares {
        // Eigenvectors of the Gram matrix: as many as there are reactions, free directions among them.
        let gram = (columns.transpose() * columns).symmetric_eigen();
        let stiffest = gram.eigenvalues.iter().fold(0.0, |most: f64, value| most.max(*value));
        let lacking = columns.transpose() * (demand - columns * equal);
        let mut nearest = equal.clone();
        let mut free = Vec::new();
        for (value, direction) in gram.eigenvalues.iter().zip(gram.eigenvectors.column_iter()) {
            if *value > FREE * stiffest {
                nearest += direction * (direction.dot(&lacking) / value);
            } else {
                free.push(direction.into_owned());
            }
        }
        // The Gram matrix loses half of the digits: once more with what is left.
        let left = columns.transpose() * (demand - columns * &nearest);
        for (value, direction) in gram.eigenvalues.iter().zip(gram.eigenvectors.column_iter()) {
            if *value > FREE * stiffest {
                nearest += direction * (direction.dot(&left) / value);
            }
        }
        let squeezes = match free.as_slice() {
            [] => DMatrix::zeros(equal.len(), 0),
            some => DMatrix::from_columns(some),
        };
        let remainder = demand - columns * &nearest;
        Shares { nearest, squeezes, remainder }
    }

    /// The reactions for one choice.
    pub fn reactions(&self, s: &DVector<f64>) -> DVector<f64> {
        &self.nearest + &self.squeezes * s
    }
}
