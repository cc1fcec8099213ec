//! The share that leaves most room: maximize m over (s, m) with `height(s) − m ≥ |tangential(s)|` for every limit.
//!
//! A cone program of very few variables, solved by Clarabel. Its multipliers tell which limits stand in the way: no share has
//! more room, because their weighted sum has not.

use super::limits::{Limit, Room};
use crate::sqp::qp::interior::settings;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::DVector;

/// Room that is given up for a share nearer to the equal one.
const SLACK: f64 = 1e-9;
/// Limits whose multipliers are below this part of the whole are not in the way.
const IN_THE_WAY: f64 = 1e-3;
const BISECTIONS: usize = 60;

/// The share with the most room.
#[derive(Clone, Debug)]
pub struct Best {
    pub s: DVector<f64>,
    /// The least margin of all limits.
    pub margin: f64,
    /// The limits in the way of more room with their weights, which sum to 1; heaviest first.
    pub binding: Vec<(Limit, f64)>,
}

/// Of all shares with the least margin as large as it can be (to 1e-9), the one on the way to it from `s = 0` that comes first.
///
/// `None` if the cone program was not solved, which takes numbers that are none.
pub fn best(rooms: &[Room], squeezes: usize) -> Option<Best> {
    let solution = maximize(rooms, squeezes)?;
    let margin = |s: &DVector<f64>| rooms.iter().map(|room| room.margin(s)).fold(f64::INFINITY, f64::min);
    let most = margin(&solution.s);
    // The margin is concave on the way from 0 to s.
    let (mut low, mut high) = (0.0, 1.0);
    if margin(&(&solution.s * low)) >= most - SLACK {
        high = low;
    } else {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if margin(&(&solution.s * middle)) >= most - SLACK { high = middle } else { low = middle }
        }
    }
    let s = &solution.s * high;
    Some(Best { margin: margin(&s), s, binding: solution.binding })
}

fn maximize(rooms: &[Room], squeezes: usize) -> Option<Best> {
    // Clarabel's form is A·x + slack = b with the slack in a cone, minimizing q·x; x = [s, m].
    let (mut rows, mut b, mut cones, mut of) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for room in rooms {
        let parts = 1 + room.tangential.len();
        for (k, part) in std::iter::once(&room.height).chain(&room.tangential).enumerate() {
            let mut row: Vec<f64> = part.slope.iter().map(|x| -x).collect();
            row.push(f64::from(k == 0));
            rows.push(row);
            b.push(part.at);
        }
        cones.push(match parts {
            1 => SupportedConeT::NonnegativeConeT(1),
            _ => SupportedConeT::SecondOrderConeT(parts),
        });
        of.push((room.limit, b.len() - parts));
    }
    let mut q = vec![0.0; squeezes];
    q.push(-1.0);
    let a = CscMatrix::from(&rows);
    let p = CscMatrix::zeros((squeezes + 1, squeezes + 1));
    let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings()).ok()?;
    solver.solve();
    if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return None;
    }
    // The multiplier of m's column: those of the heights sum to 1.
    let mut binding: Vec<(Limit, f64)> = Vec::new();
    for (limit, row) in of {
        let weight = solver.solution.z[row];
        match binding.iter_mut().find(|known| known.0 == limit) {
            Some(known) => known.1 += weight,
            None => binding.push((limit, weight)),
        }
    }
    binding.retain(|(_, weight)| *weight > IN_THE_WAY);
    binding.sort_by(|a, b| b.1.total_cmp(&a.1));
    let x = &solver.solution.x;
    Some(Best { s: DVector::from_column_slice(&x[..squeezes]), margin: x[squeezes], binding })
}
