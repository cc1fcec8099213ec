//! The same for any number of feet: a cone program, `height(s) − m ≥ |tangential(s)|` for every limit, solved by Clarabel.

use super::{Best, SLACK, lowest, on_the_way, weighed};
use crate::four_legs::limits::Room;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use piaffe_sqp::qp::interior::settings;

/// See [`best`](super::best). `None` if the cone program was not solved.
pub fn best(rooms: &[Room], squeezes: usize) -> Option<Best> {
    let solution = maximize(rooms, squeezes)?;
    let most = lowest(rooms, &solution.s);
    // The margin is concave on the way from 0 to s.
    let s = on_the_way(&vec![0.0; squeezes], &solution.s, |s| lowest(rooms, s) >= most - SLACK);
    Some(Best { margin: lowest(rooms, &s), s, binding: solution.binding })
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
    let binding = weighed(of.into_iter().map(|(limit, row)| (limit, solver.solution.z[row])));
    let x = &solver.solution.x;
    Some(Best { s: x[..squeezes].into(), margin: x[squeezes], binding })
}
