//! Objectives with folds: sums of magnitudes, rounded off within next to nothing.

use super::model::print;
use piaffe::sqp::{Options, Problem, Solution, Undefined, Values, minimize};

/// ½‖x‖² + Σ |aᵢᵀx − bᵢ| with each magnitude rounded off to a parabola within ± `width`: smooth, and no wiser for it.
struct Magnitudes {
    n: usize,
    /// aᵢ and bᵢ.
    terms: Vec<(Vec<f64>, f64)>,
    width: f64,
    folds: bool,
    at: Vec<f64>,
}

impl Magnitudes {
    fn random(seed: u64, folds: bool) -> Magnitudes {
        let mut rng = fastrand::Rng::with_seed(seed);
        let n = 8;
        let mut any = || 2.0 * rng.f64() - 1.0;
        let terms = (0..12).map(|_| ((0..n).map(|_| any()).collect(), 3.0 * any())).collect();
        Magnitudes { n, terms, width: 1e-4, folds, at: vec![0.0; n] }
    }

    fn solve(&mut self) -> Solution {
        minimize(self, &vec![0.0; self.n], &Options { tolerance: 1e-9, ..Options::default() }, &mut print)
    }

    fn inside(&self, x: &[f64], i: usize) -> f64 {
        let (a, b) = &self.terms[i];
        a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b
    }

    /// The slope of a term in what is inside.
    fn slope(&self, x: &[f64], i: usize) -> f64 {
        (self.inside(x, i) / self.width).clamp(-1.0, 1.0)
    }
}

impl Problem for Magnitudes {
    fn variables(&self) -> usize {
        self.n
    }

    fn equalities(&self) -> usize {
        0
    }

    fn inequalities(&self) -> usize {
        0
    }

    fn bounds(&self, _: &mut [f64], _: &mut [f64]) {}

    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        let rounded = |c: f64| {
            if c.abs() < self.width { 0.5 * (c * c / self.width + self.width) } else { c.abs() }
        };
        out.objective = 0.5 * x.iter().map(|x| x * x).sum::<f64>();
        out.objective += (0..self.terms.len()).map(|i| rounded(self.inside(x, i))).sum::<f64>();
        Ok(())
    }

    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.at.copy_from_slice(x);
        Ok(())
    }

    fn gradient(&self, gradient: &mut [f64]) {
        gradient.copy_from_slice(&self.at);
        for (i, (a, _)) in self.terms.iter().enumerate() {
            let slope = self.slope(&self.at, i);
            gradient.iter_mut().zip(a).for_each(|(g, a)| *g += slope * a);
        }
    }

    fn equality_row(&self, _: usize, _: &mut [f64]) {}

    fn inequality_row(&self, _: usize, _: &mut [f64]) {}

    fn folds(&self) -> usize {
        if self.folds { self.terms.len() } else { 0 }
    }

    fn fold(&self, i: usize) -> Option<f64> {
        let c = self.inside(&self.at, i);
        (c.abs() > self.width).then_some(c.abs())
    }

    fn fold_row(&self, i: usize, row: &mut [f64]) {
        let sign = self.inside(&self.at, i).signum();
        row.iter_mut().zip(&self.terms[i].0).for_each(|(row, a)| *row = sign * a);
    }

    fn hessian(&mut self, _: &[f64], _: &[f64], hessian: &mut [f64]) -> bool {
        hessian.fill(0.0);
        for i in 0..self.n {
            hessian[i * self.n + i] = 1.0;
        }
        for i in (0..self.terms.len()).filter(|i| self.inside(&self.at, *i).abs() < self.width) {
            let a = &self.terms[i].0;
            for (row, x) in hessian.chunks_mut(self.n).zip(a) {
                row.iter_mut().zip(a).for_each(|(h, y)| *h += x * y / self.width);
            }
        }
        true
    }
}

/// The objective is convex: where its gradient vanishes it is least. That a subproblem knows of folds changes the way, not the end.
#[test]
fn folds_shorten_the_way_and_change_no_optimum() {
    let mut iterations = [0; 2];
    for seed in 0..20 {
        let [without, with] = [false, true].map(|folds| {
            let mut problem = Magnitudes::random(seed, folds);
            let solution = problem.solve();
            assert!(solution.status.is_optimal(), "seed {seed}, folds {folds}: {:?}", solution.status);
            problem.at.copy_from_slice(&solution.x);
            let mut gradient = vec![0.0; problem.n];
            problem.gradient(&mut gradient);
            assert!(gradient.iter().all(|g| g.abs() < 1e-7), "{gradient:?}");
            iterations[usize::from(folds)] += solution.iterations;
            solution
        });
        assert!((without.objective - with.objective).abs() < 1e-9 * with.objective, "seed {seed}");
    }
    println!("iterations without and with folds: {iterations:?}");
    assert!(3 * iterations[1] < iterations[0], "{iterations:?}");
}
