//! A criterion of one's own: the torque criterion, and a price on phases that are not 0.35 s long.
//! `cargo run --release --example own_cost`. Constraints hold at the nodes; `search` also looks between them.

use piaffe::cycle::Cycle;
use piaffe::gaits::trot::Trot;
use piaffe::motion::Criterion;
use piaffe::search::local::options;
use piaffe::search::multi_start::start;
use piaffe::sqp::{Control, Objective, Own, Redirected, minimize};

/// `weight · (T − wanted)²` on top. T is the last variable of a mirrored gait.
struct Pace {
    weight: f64,
    wanted: f64,
}

impl Pace {
    fn gap(&self, x: &[f64]) -> f64 {
        x[x.len() - 1] - self.wanted
    }
}

impl Objective for Pace {
    fn value(&self, x: &[f64], own: f64) -> f64 {
        own + self.weight * self.gap(x).powi(2)
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) {
        gradient[x.len() - 1] += 2.0 * self.weight * self.gap(x);
    }

    fn hessian(&self, _: &[f64], own: &mut Own, hessian: &mut [f64]) -> bool {
        let exact = own.lagrangian(hessian);
        hessian[hessian.len() - 1] += 2.0 * self.weight;
        exact
    }
}

fn main() {
    let (criterion, speed) = (Criterion::Torque, 0.6);
    let from = start(&Trot, criterion, speed, 1, 0);
    for weight in [0.0, 1e3, 1e5] {
        let mut cycle = Cycle::new(&Trot, criterion, speed);
        let options = options(&cycle);
        let mut problem = Redirected::new(&mut cycle, Pace { weight, wanted: 0.35 });
        let solution = minimize(&mut problem, &from, &options, &mut |_| Control::Continue);
        let duration = solution.x[solution.x.len() - 1];
        if cycle.simulate(&solution.x).is_err() {
            println!("weight {weight}: no such walk");
            continue;
        }
        println!("weight {weight}: phase {duration:.4} s, torque {:.3} N²·m·s", cycle.costs().torque);
        assert!(solution.status.is_optimal());
    }
}
