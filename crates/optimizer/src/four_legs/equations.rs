//! The equations of motion of the whole robot at one posture, A u̇ + H = Sᵀ Γ + D F, and of an impact, A Δu = D I.

use super::posture::Posture;
use super::rows::{Rows, dot};
use super::shares::Equation;
use piaffe_model::whole::{Shapes, Whole};

/// Speeds of the platform, which no motor drives: of its mass centre, and of its turning.
pub const PLATFORM: usize = 6;

/// A, H and D.
pub struct Equations {
    shapes: Shapes,
    inertia_and_bias: Vec<f64>,
    /// Places, and D: n × 3 per leg, platform's axes.
    feet: Vec<f64>,
    length: f64,
}

impl Equations {
    /// `length` (m) makes moments comparable with forces: that of a leg.
    pub fn new(whole: &dyn Whole, posture: &Posture, length: f64) -> Equations {
        let shapes = whole.description().shapes;
        let (mut inertia_and_bias, mut feet) = (shapes.inertia_and_bias.zeros(), shapes.feet.zeros());
        whole.inertia_and_bias(&posture.up(), &posture.omega(), &posture.q, posture.rates(), &mut inertia_and_bias);
        whole.feet(&posture.q, &mut feet);
        Equations { shapes, inertia_and_bias, feet, length }
    }

    /// What torques and reactions must add up to: A u̇ + H.
    pub fn demand(&self, ud: &[f64]) -> Vec<f64> {
        let bias = self.shapes.inertia_and_bias.h.of(&self.inertia_and_bias);
        self.momentum(ud).zip(bias).map(|(momentum, bias)| momentum + bias).collect()
    }

    /// What impulses must add up to: A Δu.
    pub fn impulse_demand(&self, change: &[f64]) -> Vec<f64> {
        self.momentum(change).collect()
    }

    /// A times speeds, or their derivatives.
    fn momentum<'a>(&'a self, speeds: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.shapes.inertia_and_bias.a.each(&self.inertia_and_bias).map(move |row| dot(row, speeds))
    }

    /// Columns of D for the feet of `legs`.
    pub fn columns(&self, legs: &[usize]) -> Rows {
        let jacobian = self.shapes.feet.jacobian;
        let mut columns = Rows::zeros(jacobian.rows(), 3 * legs.len());
        for k in 0..jacobian.rows() {
            let row = jacobian.row(&self.feet, k);
            let feet = columns.row_mut(k).chunks_exact_mut(3);
            feet.zip(legs).for_each(|(foot, leg)| foot.copy_from_slice(&row[3 * leg..][..3]));
        }
        columns
    }

    /// The first `rows` equations, of the feet's reactions alone, in two ranks: those that the virtual legs' model has too, so that
    /// equal shares meet them, and the two moments that it knows nothing of. `axis` is the one about which its platform may turn.
    pub fn ranks<'a>(&self, columns: &'a Rows, demand: &[f64], rows: usize, axis: usize) -> [Vec<Equation<'a>>; 2] {
        let modelled = |row: &usize| !(3..PLATFORM).contains(row) || *row == 3 + axis;
        // Moments over a length, so that they are forces like the others.
        let equation = |row: usize| Equation {
            columns: columns.row(row),
            demand: demand[row],
            unit: if row < 3 { 1.0 } else { self.length },
        };
        [true, false].map(|rank| (0..rows).filter(|row| modelled(row) == rank).map(equation).collect())
    }
}
