//! All ways in which feet can share what is demanded of them.

use super::rows::{Rows, dot};
use smallvec::SmallVec;

/// Directions in which a share could change count as free below this part of the stiffest, squared.
const FREE: f64 = 1e-9;

/// Of several feet, three numbers each; N, or N·s.
pub type Reactions = SmallVec<[f64; 6]>;

/// A choice of shares: how much of each squeeze, one number of two feet.
pub type Squeeze = SmallVec<[f64; 2]>;

/// An equation of the reactions F: `(columns · F − demand) / unit = 0`.
pub struct Equation<'a> {
    pub columns: &'a [f64],
    pub demand: f64,
    /// Makes what it balances comparable with what others do.
    pub unit: f64,
}

impl Equation<'_> {
    /// What it lacks with them.
    fn lacking(&self, reactions: &[f64]) -> f64 {
        (self.demand - dot(self.columns, reactions)) / self.unit
    }

    /// How much it feels of any reactions, squared.
    fn stiffness(&self) -> f64 {
        dot(self.columns, self.columns) / (self.unit * self.unit)
    }
}

/// Reactions that meet demands of several ranks: `nearest + Σ sₖ squeezeₖ` for any s.
///
/// Where not all can be met, an equation of a lower rank is never met at the cost of one of a higher rank.
pub struct Shares {
    /// Of all that meet the demands, or come closest to them, those nearest to equal shares; N, or N·s.
    pub nearest: Reactions,
    /// Orthonormal rows: reactions that add up to nothing, the feet pushing against each other.
    pub squeezes: Rows,
}

impl Shares {
    /// From equal shares of the reactions on all of the feet, and the equations that they must meet, by rank, the highest first.
    pub fn new(ranks: &[Vec<Equation>], equal: &[f64]) -> Shares {
        let (size, count) = (equal.len(), ranks.iter().map(Vec::len).sum::<usize>());
        // Orthonormal directions, each with what the equations feel of it: first of one reaction alone.
        let mut directions = Rows::zeros(size, size + count);
        for k in 0..size {
            let (direction, felt) = directions.row_mut(k).split_at_mut(size);
            direction[k] = 1.0;
            let equations = ranks.iter().flatten();
            felt.iter_mut().zip(equations).for_each(|(felt, equation)| *felt = equation.columns[k] / equation.unit);
        }
        let stiffness = |rank: &Vec<Equation>| rank.iter().map(Equation::stiffness).sum();
        let stiffest = ranks.iter().map(stiffness).fold(0.0, f64::max);
        let mut nearest = Reactions::from_slice(equal);
        let (mut stiff, mut column) = (0, size);
        for rank in ranks {
            stiff = meet(rank, column, &mut directions, stiff, FREE * stiffest, &mut nearest);
            column += rank.len();
        }
        let mut squeezes = Rows::zeros(size - stiff, size);
        (stiff..size).for_each(|k| squeezes.row_mut(k - stiff).copy_from_slice(&directions.row(k)[..size]));
        Shares { nearest, squeezes }
    }

    /// The choice whose reactions are nearest to these.
    pub fn nearest_to(&self, reactions: &[f64]) -> Squeeze {
        self.squeezes.iter().map(|squeeze| dot(squeeze, reactions) - dot(squeeze, &self.nearest)).collect()
    }

    /// The reactions for one choice.
    pub fn reactions(&self, s: &[f64]) -> Reactions {
        let mut reactions = self.nearest.clone();
        for (squeeze, s) in self.squeezes.iter().zip(s) {
            reactions.iter_mut().zip(squeeze).for_each(|(reaction, part)| *reaction += s * part);
        }
        reactions
    }
}

/// Meets a further rank, from `column` of the directions on, as nearly as those from the `first` on allow, by a complete orthogonal
/// decomposition. Gives the first direction that is still free: no equation feels more than `free` of it.
fn meet(
    rank: &[Equation],
    column: usize,
    directions: &mut Rows,
    first: usize,
    free: f64,
    nearest: &mut [f64],
) -> usize {
    // Reflected so that, of those that are left, the equation that feels most feels one direction alone: that is stiff.
    let mut stiff = first;
    while stiff < directions.len() {
        let mut felt: SmallVec<[f64; 16]> = SmallVec::from_elem(0.0, rank.len());
        for k in stiff..directions.len() {
            felt.iter_mut().zip(&directions.row(k)[column..]).for_each(|(sum, x)| *sum += x * x);
        }
        let most = felt.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((equation, _)) = most.filter(|(_, felt)| **felt > free) else { break };
        directions.reflect(stiff, column + equation);
        stiff += 1;
    }
    // What the equations feel of stiff directions, and what they lack, reflected into the triangle of least squares.
    let count = stiff - first;
    let mut triangle = Rows::zeros(rank.len(), count + 1);
    for (k, equation) in rank.iter().enumerate() {
        let row = triangle.row_mut(k);
        (0..count).for_each(|j| row[j] = directions.row(first + j)[column + k]);
        row[count] = equation.lacking(nearest);
    }
    (0..count).for_each(|k| triangle.reflect(k, k));
    for k in (0..count).rev() {
        let row = triangle.row(k);
        let step = row[count] / row[k];
        (0..k).for_each(|j| triangle.row_mut(j)[count] -= step * triangle.row(j)[k]);
        nearest.iter_mut().zip(directions.row(first + k)).for_each(|(reaction, part)| *reaction += step * part);
    }
    stiff
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random equations of `size` reactions that follow from `rank` of them, with demands that need not.
    fn drawn(rng: &mut fastrand::Rng, count: usize, rank: usize, size: usize) -> Vec<(Vec<f64>, f64)> {
        let mut any = |count: usize| (0..count).map(|_| 2.0 * rng.f64() - 1.0).collect::<Vec<f64>>();
        let independent: Vec<Vec<f64>> = (0..rank).map(|_| any(size)).collect();
        let mut equation = || {
            let parts = any(rank);
            let columns = (0..size).map(|k| parts.iter().zip(&independent).map(|(part, row)| part * row[k]).sum());
            (columns.collect(), any(1)[0])
        };
        (0..count).map(|_| equation()).collect()
    }

    fn felt(equation: &Equation, reactions: &[f64]) -> f64 {
        dot(equation.columns, reactions) / equation.unit
    }

    /// The conditions of what is nearest, rank by rank: no direction that is free when a rank has its turn would meet it better,
    /// and none that stays free leads nearer to equal shares.
    #[test]
    fn no_reactions_meet_random_equations_better_or_are_nearer_to_equal_shares() {
        let mut rng = fastrand::Rng::with_seed(11);
        for trial in 0..1000 {
            let size = 3 * (1 + trial % 4);
            // Equations that follow from each other, met or not, more of them than reactions, and none.
            let dimensions = [(4, 1 + trial % 4), (trial % 9, 1 + trial % 3)];
            let drawn = dimensions.map(|(count, rank)| drawn(&mut rng, count, rank, size));
            let unit = 0.5 + rng.f64();
            let ranks = drawn.each_ref().map(|rank| {
                let each = rank.iter().map(|(columns, demand)| Equation { columns, demand: *demand, unit });
                each.collect::<Vec<_>>()
            });
            let equal: Vec<f64> = (0..size).map(|_| 2.0 * rng.f64() - 1.0).collect();
            let shares = Shares::new(&ranks, &equal);
            let change: Vec<f64> = shares.nearest.iter().zip(&equal).map(|(nearest, equal)| nearest - equal).collect();
            let large = 1.0 + change.iter().fold(0.0, |most: f64, x| most.max(x.abs()));

            let mut free = size;
            for (k, (count, rank)) in dimensions.into_iter().enumerate() {
                let before = Shares::new(&ranks[..k], &equal).squeezes;
                for direction in before.iter() {
                    let gain: f64 = ranks[k].iter().map(|e| felt(e, direction) * e.lacking(&shares.nearest)).sum();
                    assert!(gain.abs() < 1e-12 * large, "{trial}: {gain}");
                }
                free -= free.min(rank).min(count);
            }
            assert_eq!(shares.squeezes.len(), free, "{trial}");
            for (k, squeeze) in shares.squeezes.iter().enumerate() {
                assert!(dot(squeeze, &change).abs() < 1e-12 * large, "{trial}");
                assert!(ranks.iter().flatten().all(|e| felt(e, squeeze).abs() < 1e-12), "{trial}");
                for (j, other) in shares.squeezes.iter().enumerate() {
                    assert!((dot(squeeze, other) - f64::from(j == k)).abs() < 1e-14, "{trial}");
                }
            }
        }
    }
}
