//! The nonlinear program solver against published optima, oracles and its own laws.

#[path = "sqp/folds.rs"]
mod folds;
#[path = "sqp/hock_schittkowski.rs"]
mod hock_schittkowski;
#[path = "sqp/jet.rs"]
mod jet;
#[path = "sqp/laws.rs"]
mod laws;
#[path = "sqp/model.rs"]
mod model;
#[path = "sqp/oracle.rs"]
mod oracle;
#[path = "sqp/quadratic.rs"]
mod quadratic;
#[path = "sqp/random.rs"]
mod random;
#[path = "sqp/trajectory.rs"]
mod trajectory;

use hock_schittkowski::*;
use model::{Model, solve};
use piaffe::sqp::{Options, Solution, Status, Subproblems, minimize};

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

/// Every problem with both curvatures reaches the published optimum; the log is printed for `--nocapture`.
#[test]
fn published_optima() {
    let (mut iterations, mut evaluations) = ([0; 2], [0; 2]);
    macro_rules! check {
        ($name:ident, $n:literal) => {
            for exact in [false, true] {
                let solution = solve::<$name, $n>(exact, &Options::default());
                line(&format!("{} {}", $name::NAME, if exact { "H" } else { "B" }), $name::BEST, &solution);
                assert_eq!(solution.status, Status::Optimal, "{}", $name::NAME);
                let error = (solution.objective - $name::BEST).abs() / $name::BEST.abs().max(1.0);
                assert!(error < 5e-5, "{}: {} is not {}", $name::NAME, solution.objective, $name::BEST);
                assert!(solution.values.violation() <= 1e-6);
                iterations[usize::from(exact)] += solution.iterations;
                evaluations[usize::from(exact)] += solution.evaluations;
            }
        };
    }
    for_each_problem!(check);
    println!("iterations in total {iterations:?}, evaluations {evaluations:?} (quasi-Newton, exact)");
    // A regression of the method as a whole shows here first.
    assert!(iterations[0] < 700 && iterations[1] < 700, "{iterations:?}");
}

/// With the interior-point judge alone the optima are the same.
#[test]
fn clarabel_alone_finds_the_same_optima() {
    let options = Options { subproblems: Subproblems::InteriorPoint, ..Options::default() };
    macro_rules! check {
        ($name:ident, $n:literal) => {
            let solution = solve::<$name, $n>(false, &options);
            line(&format!("{} C", $name::NAME), $name::BEST, &solution);
            // The last digits of an interior point are too few for these: flat valleys and bad scaling.
            if !["Hs001", "Hs106", "Hs116"].contains(&$name::NAME) {
                assert_eq!(solution.status, Status::Optimal, "{}", $name::NAME);
            }
        };
    }
    for_each_problem!(check);
}

/// From starts far off the published ones, no run may end without an answer: an optimum (perhaps another one) or a stationary
/// point of the violation, with very few exceptions.
#[test]
fn from_anywhere() {
    let mut random = random::Random::new(1);
    let (mut runs, mut open, mut evaluations) = (0, 0, 0);
    macro_rules! check {
        ($name:ident, $n:literal) => {
            for trial in 0..40 {
                let start = $name::START.map(|x| x + 2.0 * random.signed() * x.abs().max(1.0));
                let mut problem = model::Adapter::<$name, $n>::new(trial % 2 == 1);
                let options =
                    Options { scale: Some($name::START.map(|x| x.abs().max(0.1)).to_vec()), ..Options::default() };
                let solution = minimize(&mut problem, &start, &options, &mut model::print);
                runs += 1;
                evaluations += solution.evaluations;
                if !matches!(solution.status, Status::Optimal | Status::Infeasible | Status::Undefined) {
                    open += 1;
                    line(&format!("open: {} trial {trial}", $name::NAME), $name::BEST, &solution);
                    if std::env::var("SQP_TRACE").is_ok_and(|name| name == format!("{}/{trial}", $name::NAME)) {
                        minimize(&mut problem, &start, &options, &mut model::show);
                    }
                }
                if solution.status == Status::Infeasible {
                    line(&format!("infeasible: {}", $name::NAME), $name::BEST, &solution);
                }
            }
        };
    }
    for_each_problem!(check);
    println!("{open} of {runs} runs without an answer, {evaluations} evaluations");
    assert!(open <= 15, "{open} of {runs}");
}

/// The shape of the gait problems: screening and the active-set method end where Clarabel on its own does.
#[test]
fn a_sampled_trajectory() {
    use trajectory::{Trajectory, cold};
    let solve = |cheap_directions, subproblems| {
        let mut problem = Trajectory::new(trajectory::SAMPLES);
        problem.cheap_directions = cheap_directions;
        problem.solve(&Options { subproblems, ..Options::default() }, &cold())
    };
    let solution = solve(true, Subproblems::ActiveSet);
    assert_eq!(solution.status, Status::Optimal);
    assert_eq!(solution.interior_solves, 0);
    for other in [solve(false, Subproblems::ActiveSet), solve(true, Subproblems::InteriorPoint)] {
        assert_eq!(other.status, Status::Optimal);
        assert!((other.objective - solution.objective).abs() < 1e-7);
    }
}

/// Timings: `cargo test --release --test sqp bench -- --ignored --nocapture`.
#[test]
#[ignore = "prints timings"]
fn bench() {
    use std::time::Instant;
    use trajectory::{SAMPLES, Trajectory, cold};
    macro_rules! time {
        ($name:ident, $n:literal) => {
            for exact in [false, true] {
                let mut best = f64::INFINITY;
                let mut iterations = 0;
                for _ in 0..20 {
                    let start = Instant::now();
                    iterations = solve::<$name, $n>(exact, &Options::default()).iterations;
                    best = best.min(start.elapsed().as_secs_f64() * 1e6);
                }
                println!("{} {} {iterations:3} iterations {best:7.0} µs", $name::NAME, if exact { "H" } else { "B" });
            }
        };
    }
    for_each_problem!(time);

    for (cheap, subproblems, repeats) in [
        (true, Subproblems::ActiveSet, 200),
        (false, Subproblems::ActiveSet, 200),
        (true, Subproblems::InteriorPoint, 2),
    ] {
        let options = Options { subproblems, ..Options::default() };
        let mut problem = Trajectory::new(SAMPLES);
        problem.cheap_directions = cheap;
        let mut best = f64::INFINITY;
        for repeat in 0..repeats {
            problem.evaluating = std::time::Duration::ZERO;
            let start = Instant::now();
            let solution = problem.solve(&options, &cold());
            best = best.min((start.elapsed() - problem.evaluating).as_secs_f64() * 1e6);
            if repeat + 1 == repeats {
                line("trajectory", f64::NAN, &solution);
                let active = solution.inequality_multipliers.iter().filter(|m| **m > 0.0).count();
                println!(
                    "  {subproblems:?}, cheap directions {cheap}: {best:.0} µs beside evaluation, {:.1} µs per iteration, {active} active",
                    best / solution.iterations as f64
                );
            }
        }
    }
}
