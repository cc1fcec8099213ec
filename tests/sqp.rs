//! The nonlinear program solver against published optima, oracles and its own laws.

#[path = "sqp/hock_schittkowski.rs"]
mod hock_schittkowski;
#[path = "sqp/jet.rs"]
mod jet;
#[path = "sqp/laws.rs"]
mod laws;
#[path = "sqp/model.rs"]
mod model;
#[path = "sqp/quadratic.rs"]
mod quadratic;
#[path = "sqp/random.rs"]
mod random;
#[path = "sqp/trajectory.rs"]
mod trajectory;

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

/// µs per problem and per iteration: `cargo test --release --test sqp bench -- --ignored --nocapture`.
#[test]
#[ignore = "prints timings"]
fn bench() {
    use trajectory::{SAMPLES, Trajectory, cold};
    for cheap in [false, true] {
        for options in [
            Options::default(),
            Options { tolerance: 1e-9, feasibility: 1e-9, ..Options::default() },
            Options { subproblems: piaffe::sqp::Subproblems::InteriorPoint, ..Options::default() },
        ] {
            let mut problem = Trajectory::new(SAMPLES);
            problem.cheap_directions = cheap;
            let mut best = f64::INFINITY;
            for _ in 0..50 {
                problem.evaluating = std::time::Duration::ZERO;
                let start = std::time::Instant::now();
                let solution = problem.solve(&options, &cold());
                let own = (start.elapsed() - problem.evaluating).as_secs_f64() * 1e6;
                if own < 0.8 * best {
                    best = own;
                    let active = solution.inequality_multipliers.iter().filter(|m| **m > 0.0).count();
                    line("trajectory", 0.0, &solution);
                    println!(
                        "  cheap {cheap} {:?}: {own:.0} µs beside evaluation, {:.1} per iteration, {active} active",
                        options.subproblems,
                        own / solution.iterations as f64
                    );
                }
            }
        }
    }
}
