//! The nonlinear program solver against published optima, oracles and its own laws.

#[path = "sqp/hock_schittkowski.rs"]
mod hock_schittkowski;
#[path = "sqp/jet.rs"]
mod jet;
#[path = "sqp/model.rs"]
mod model;

use hock_schittkowski::*;
use model::{Model, solve};
use piaffe::sqp::{Options, Solution};

fn line(name: &str, best: f64, solution: &Solution) {
    println!(
        "{name} {:?} f {:.9} (best {best}) iterations {} evaluations {} interior {} kkt {:.1e} {:.1e} {:.1e}",
        solution.status,
        solution.objective,
        solution.iterations,
        solution.evaluations,
        solution.interior_solves,
        solution.kkt.stationarity,
        solution.kkt.complementarity,
        solution.kkt.violation
    );
}

#[test]
fn hock_schittkowski_table() {
    macro_rules! show {
        ($name:ident, $n:literal) => {
            for exact in [false, true] {
                let solution = solve::<$name, $n>(exact, &Options::default());
                line(&format!("{} {}", $name::NAME, if exact { "H" } else { "B" }), $name::BEST, &solution);
            }
        };
    }
    for_each_problem!(show);
}
