//! All ways in which feet can share what is demanded of them.

use nalgebra::{DMatrix, DVector};

/// Directions in which a share could change count as free below this part of the stiffest, squared.
const FREE: f64 = 1e-9;

/// Equations `columns · F = demand` of the reactions F, of one unit.
pub struct Rank {
    pub columns: DMatrix<f64>,
    pub demand: DVector<f64>,
}

/// Reactions that meet demands of several ranks: `nearest + squeezes · s` for any s.
///
/// Where not all can be met, an equation of a lower rank is never met at the cost of one of a higher rank.
pub struct Shares {
    /// Of all that meet the demands, or come closest to them, those nearest to equal shares; N, or N·s.
    pub nearest: DVector<f64>,
    /// Orthonormal: reactions that add up to nothing, the feet pushing against each other.
    pub squeezes: DMatrix<f64>,
}

impl Shares {
    /// From equal shares of the reactions on all of the feet, and what they must add up to, the highest rank first.
    pub fn new(ranks: &[Rank], equal: &DVector<f64>) -> Shares {
        let mut shares = Shares { nearest: equal.clone(), squeezes: DMatrix::identity(equal.len(), equal.len()) };
        let stiffest = ranks.iter().map(|rank| rank.columns.norm_squared()).fold(0.0, f64::max);
        ranks.iter().for_each(|rank| shares.meet(rank, FREE * stiffest));
        shares
    }

    /// Meets a further demand as nearly as what is free allows. Directions of less stiffness than `free` stay so.
    fn meet(&mut self, rank: &Rank, free: f64) {
        if self.squeezes.ncols() == 0 {
            return;
        }
        let columns = &rank.columns * &self.squeezes;
        // Eigenvectors of the Gram matrix: as many as there are directions, free ones among them.
        let gram = (columns.transpose() * &columns).symmetric_eigen();
        let (stiff, left): (Vec<usize>, Vec<usize>) = (0..columns.ncols()).partition(|k| gram.eigenvalues[*k] > free);
        // The Gram matrix loses half of the digits: once more with what is left.
        for _ in 0..2 {
            let lacking = columns.transpose() * (&rank.demand - &rank.columns * &self.nearest);
            let mut step = DVector::zeros(columns.ncols());
            for k in &stiff {
                let direction = gram.eigenvectors.column(*k);
                step += direction * (direction.dot(&lacking) / gram.eigenvalues[*k]);
            }
            self.nearest += &self.squeezes * step;
        }
        self.squeezes = &self.squeezes * gram.eigenvectors.select_columns(&left);
    }

    /// The choice whose reactions are nearest to these.
    pub fn nearest_to(&self, reactions: &DVector<f64>) -> DVector<f64> {
        self.squeezes.tr_mul(&(reactions - &self.nearest))
    }

    /// The reactions for one choice.
    pub fn reactions(&self, s: &DVector<f64>) -> DVector<f64> {
        &self.nearest + &self.squeezes * s
    }
}
