//! The same for any number of feet: a cone program, `height(s) − m ≥ |tangential(s)|` for every limit, solved by Clarabel.

use super::{Best, SLACK, weighed};
use crate::four_legs::limits::Room;
use crate::four_legs::shares::Squeeze;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use piaffe_sqp::qp::interior::settings;

const BISECTIONS: usize = 60;

/// See [`best`](super::best). `None` if the cone program was not solved.
pub fn best(rooms: &[Room], squeezes: usize) -> Option<Best> {
    let solution = maximize(rooms, squeezes)?;
    let margin = |s: &[f64]| rooms.iter().map(|room| room.margin(s)).fold(f64::INFINITY, f64::min);
    let most = margin(&solution.s);
    // The margin is concave on the way from 0 to s.
    let on_the_way = |part: f64| solution.s.iter().map(|s| part * s).collect::<Squeeze>();
    let (mut low, mut high) = (0.0, 1.0);
    if margin(&on_the_way(low)) >= most - SLACK {
        high = low;
    } else {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if margin(&on_the_way(middle)) >= most - SLACK { high = middle } else { low = middle }
        }
    }
    let s = on_the_way(high);
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
    let binding = weighed(of.into_iter().map(|(limit, row)| (limit, solver.solution.z[row])));
    let x = &solver.solution.x;
    Some(Best { s: x[..squeezes].into(), margin: x[squeezes], binding })
}
