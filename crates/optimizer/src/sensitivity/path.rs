//! How (β, σ) follow numbers of the robot: the linearized equations 8 and 9, by the program's own collocation. So slopes are
//! those of the discrete equations whose multipliers they are found with.

use crate::lgl::{Lobatto, NODES};
use nalgebra::SMatrix;

/// Unknowns of an element: changes of β and σ at each node but the first.
const UNKNOWNS: usize = 2 * (NODES - 1);

/// β̇ and σ̇ at a node to first order.
#[derive(Clone, Copy, Debug)]
pub struct Rates<const N: usize> {
    /// In β and σ.
    pub by_state: [[f64; 2]; 2],
    /// In each of N directions, with β and σ as they are.
    pub direct: [[f64; N]; 2],
}

impl<const N: usize> Rates<N> {
    /// Their changes with those of β and σ.
    pub fn changes(&self, state: &[[f64; N]; 2]) -> [[f64; N]; 2] {
        [0, 1].map(|k| {
            let [by_beta, by_sigma] = self.by_state[k];
            std::array::from_fn(|lane| self.direct[k][lane] + by_beta * state[0][lane] + by_sigma * state[1][lane])
        })
    }
}

/// Changes of β and σ at the nodes of elements of `length` (s), in N directions, from those in the beginning.
pub fn follow<const N: usize>(rates: &[Rates<N>], length: f64, initial: [[f64; N]; 2]) -> Option<Vec<[[f64; N]; 2]>> {
    let integral = Lobatto::new().integral.map(|row| row.map(|part| length * part));
    let mut changes = vec![initial];
    for element in rates.windows(NODES).step_by(NODES - 1) {
        let start = changes[changes.len() - 1];
        let first = element[0].changes(&start);
        let mut matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        let mut right = SMatrix::<f64, UNKNOWNS, N>::zeros();
        for (i, parts) in integral[1..].iter().enumerate() {
            for k in 0..2 {
                for lane in 0..N {
                    let direct = parts[1..].iter().zip(&element[1..]).map(|(part, rates)| part * rates.direct[k][lane]);
                    right[(2 * i + k, lane)] = start[k][lane] + parts[0] * first[k][lane] + direct.sum::<f64>();
                }
                for (j, (part, rates)) in parts[1..].iter().zip(&element[1..]).enumerate() {
                    (0..2).for_each(|of| matrix[(2 * i + k, 2 * j + of)] -= part * rates.by_state[k][of]);
                }
            }
        }
        let solution = matrix.lu().solve(&right)?;
        let row = |row: usize| std::array::from_fn(|lane| solution[(row, lane)]);
        changes.extend((0..NODES - 1).map(|i| [row(2 * i), row(2 * i + 1)]));
    }
    Some(changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Constant coefficients: against the exponential series of the matrix.
    #[test]
    fn changes_are_those_of_the_linear_differential_equation() {
        let rates = Rates { by_state: [[-1.0, 1.0], [8.0, 3.0]], direct: [[1.0, 0.0], [0.0, 0.0]] };
        let elements = 4;
        let nodes = vec![rates; elements * (NODES - 1) + 1];
        let found = follow(&nodes, 0.1, [[0.0, 0.5], [0.0, -0.2]]).unwrap();
        let (mut state, steps) = ([[0.0, 0.5], [0.0, -0.2]], 64);
        let h = 0.1 * elements as f64 / f64::from(steps);
        for _ in 0..steps {
            let (mut term, mut factor) = (rates.changes(&state), h);
            let linear = Rates { direct: [[0.0; 2]; 2], ..rates };
            for order in 2..12 {
                (0..2).for_each(|k| (0..2).for_each(|lane| state[k][lane] += factor * term[k][lane]));
                (term, factor) = (linear.changes(&term), factor * h / f64::from(order));
            }
        }
        for (found, expected) in found[found.len() - 1].iter().flatten().zip(state.iter().flatten()) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
