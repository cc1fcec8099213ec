//! A criterion of one's own: the torque criterion, and a price on half steps that are not 0.35 s long.
//! `cargo run --release --example own_cost`. Constraints hold at the nodes; `search` also looks between them.

use piaffe::cycle::Cycle;
use piaffe::gaits::trot::Trot;
use piaffe::motion::Criterion;
use piaffe::search::local::options;
use piaffe::search::multi_start::start;
use piaffe::sqp::{Control, Problem, Undefined, Values, minimize};

/// `cycle` with `weight · (T − wanted)²` added to what is minimized. T is the last variable of a mirrored gait.
struct Paced<'a> {
    cycle: Cycle<'a>,
    weight: f64,
    wanted: f64,
    /// T − wanted at the linearized point.
    gap: f64,
}

impl Problem for Paced<'_> {
    fn variables(&self) -> usize {
        self.cycle.variables()
    }
    fn equalities(&self) -> usize {
        self.cycle.equalities()
    }
    fn inequalities(&self) -> usize {
        self.cycle.inequalities()
    }
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        self.cycle.bounds(lower, upper);
    }
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        self.cycle.evaluate(x, out)?;
        out.objective += self.weight * (x[x.len() - 1] - self.wanted).powi(2);
        Ok(())
    }
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.gap = x[x.len() - 1] - self.wanted;
        self.cycle.linearize(x)
    }
    fn gradient(&self, gradient: &mut [f64]) {
        self.cycle.gradient(gradient);
        gradient[self.variables() - 1] += 2.0 * self.weight * self.gap;
    }
    fn equality_row(&self, i: usize, row: &mut [f64]) {
        self.cycle.equality_row(i, row);
    }
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.cycle.inequality_row(i, row);
    }
    fn inequality_directions(&self, d: &[f64], out: &mut [f64]) {
        self.cycle.inequality_directions(d, out);
    }
    fn hessian(&mut self, equalities: &[f64], inequalities: &[f64], hessian: &mut [f64]) -> bool {
        let exact = self.cycle.hessian(equalities, inequalities, hessian);
        if let Some(corner) = hessian.last_mut() {
            *corner += 2.0 * self.weight;
        }
        exact
    }
}

fn main() {
    let (criterion, speed) = (Criterion::Torque, 0.6);
    let from = start(&Trot, criterion, speed, 1, 0);
    for weight in [0.0, 1e3, 1e5] {
        let cycle = Cycle::new(&Trot, criterion, speed);
        let options = options(&cycle);
        let mut problem = Paced { cycle, weight, wanted: 0.35, gap: 0.0 };
        let solution = minimize(&mut problem, &from, &options, &mut |_| Control::Continue);
        let duration = solution.x[solution.x.len() - 1];
        if problem.cycle.simulate(&solution.x).is_err() {
            println!("weight {weight}: no such walk");
            continue;
        }
        println!("weight {weight}: half step {duration:.4} s, torque {:.3} N²·m·s", problem.cycle.costs().torque);
        assert!(solution.status.is_optimal());
    }
}
