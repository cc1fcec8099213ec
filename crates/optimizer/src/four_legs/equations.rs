//! The equations of motion of the whole robot at one posture, A u̇ + H = Sᵀ Γ + D F, and of an impact, A Δu = D I.

use super::posture::Posture;
use super::shares::Rank;
use nalgebra::{DMatrix, DVector, DVectorView};
use piaffe_model::whole::Whole;

/// Speeds of the platform, which no motor drives: of its mass centre, and of its turning.
pub const PLATFORM: usize = 6;

/// A, H and D.
pub struct Equations {
    pub inertia: DMatrix<f64>,
    pub bias: DVector<f64>,
    /// n × 3 per leg, platform's axes.
    pub feet: DMatrix<f64>,
    length: f64,
}

impl Equations {
    /// `length` (m) makes moments comparable with forces: that of a leg.
    pub fn new(whole: &dyn Whole, posture: &Posture, length: f64) -> Equations {
        let d = whole.description();
        let (n, c) = (d.speeds(), d.reactions());
        let (equations, places) = (&d.shapes.inertia_and_bias, &d.shapes.feet);
        let mut out = equations.zeros();
        whole.inertia_and_bias(&posture.up(), &posture.omega(), &posture.q, posture.rates(), &mut out);
        let mut feet = places.zeros();
        whole.feet(&posture.q, &mut feet);
        Equations {
            inertia: DMatrix::from_row_slice(n, n, equations.a.of(&out)),
            bias: DVector::from_column_slice(equations.h.of(&out)),
            feet: DMatrix::from_row_slice(n, c, places.jacobian.of(&feet)),
            length,
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

    /// The first `rows` equations, of the feet's reactions alone, in two ranks: those that the virtual legs' model has too, so that
    /// equal shares meet them, and the two moments that it knows nothing of. `axis` is the one about which its platform may turn.
    pub fn ranks(&self, columns: &DMatrix<f64>, demand: &DVector<f64>, rows: usize, axis: usize) -> [Rank; 2] {
        let (modelled, others): (Vec<usize>, Vec<usize>) =
            (0..rows).partition(|row| !(3..PLATFORM).contains(row) || *row == 3 + axis);
        [modelled, others].map(|rows| {
            // Moments over a length, so that they are forces like the others.
            let unit = DVector::from_iterator(rows.len(), rows.iter().map(|row| self.unit(*row)));
            let mut rank = Rank { columns: columns.select_rows(&rows), demand: demand.select_rows(&rows) };
            rank.demand.component_div_assign(&unit);
            rank.columns.column_iter_mut().for_each(|mut column| column.component_div_assign(&unit));
            rank
        })
    }

    /// Forces and moments as forces: moments over the leg's length.
    pub fn as_forces(&self, v: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(v.len(), v.iter().enumerate().map(|(row, x)| x / self.unit(row)))
    }

    /// By what an equation is divided to be one of forces.
    fn unit(&self, row: usize) -> f64 {
        if row < 3 { 1.0 } else { self.length }
    }
}
