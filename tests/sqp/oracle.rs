//! Random smooth problems against `slsqp` (the NLopt port of Kraft's code; its constraints read g(x) ≤ 0).
//!
//! log Σ exp(aᵢᵀx + bᵢ) + ½‖x − c‖² in the intersection of ellipsoids and a box: strictly convex, so the optimum is one.

use super::random::Random;
use piaffe::sqp::{Control, Options, Problem, Status, Undefined, Values, minimize};
use slsqp::{Func, StopTols};

#[derive(Clone)]
struct Smooth {
    n: usize,
    exponents: Vec<(Vec<f64>, f64)>,
    centre: Vec<f64>,
    /// Weights, centre and squared radius: Σ w (x − c)² ≤ r.
    ellipsoids: Vec<(Vec<f64>, Vec<f64>, f64)>,
    at: Vec<f64>,
}

impl Smooth {
    fn new(seed: u64, n: usize, constraints: usize) -> Self {
        let mut random = Random::new(seed);
        Self {
            n,
            exponents: (0..2 * n).map(|_| (random.vector(n), random.signed())).collect(),
            centre: random.vector(n).iter().map(|c| 3.0 * c).collect(),
            ellipsoids: (0..constraints)
                .map(|_| {
                    let weights = random.vector(n).iter().map(|w| 0.2 + w * w).collect();
                    let centre: Vec<f64> = random.vector(n).iter().map(|c| 0.5 * c).collect();
                    (weights, centre, n as f64 * (0.3 + 0.5 * random.unit()))
                })
                .collect(),
            at: Vec::new(),
        }
    }

    fn objective(&self, x: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        let powers: Vec<f64> =
            self.exponents.iter().map(|(a, b)| (a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() + b).exp()).collect();
        let sum: f64 = powers.iter().sum();
        if let Some(gradient) = gradient {
            for j in 0..self.n {
                gradient[j] = x[j] - self.centre[j];
                gradient[j] += self.exponents.iter().zip(&powers).map(|((a, _), p)| a[j] * p).sum::<f64>() / sum;
            }
        }
        sum.ln() + 0.5 * x.iter().zip(&self.centre).map(|(x, c)| (x - c) * (x - c)).sum::<f64>()
    }

    /// r − Σ w (x − c)² ≥ 0.
    fn constraint(&self, i: usize, x: &[f64], row: Option<&mut [f64]>) -> f64 {
        let (w, c, r) = &self.ellipsoids[i];
        if let Some(row) = row {
            for j in 0..self.n {
                row[j] = -2.0 * w[j] * (x[j] - c[j]);
            }
        }
        r - (0..self.n).map(|j| w[j] * (x[j] - c[j]) * (x[j] - c[j])).sum::<f64>()
    }
}

impl Problem for Smooth {
    fn variables(&self) -> usize {
        self.n
    }
    fn equalities(&self) -> usize {
        0
    }
    fn inequalities(&self) -> usize {
        self.ellipsoids.len()
    }
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        lower.fill(-1.0);
        upper.fill(1.0);
    }
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        out.objective = self.objective(x, None);
        for i in 0..self.ellipsoids.len() {
            out.inequalities[i] = self.constraint(i, x, None);
        }
        Ok(())
    }
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.at = x.to_vec();
        Ok(())
    }
    fn gradient(&self, gradient: &mut [f64]) {
        self.objective(&self.at, Some(gradient));
    }
    fn equality_row(&self, _: usize, _: &mut [f64]) {}
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.constraint(i, &self.at, Some(row));
    }
}

#[test]
fn agrees_with_slsqp() {
    let mut compared = 0;
    for seed in 0..150 {
        let n = 2 + seed as usize % 14;
        let problem = Smooth::new(seed, n, 1 + seed as usize % 5);
        let start = vec![0.0; n];
        let ours = minimize(&mut problem.clone(), &start, &Options::default(), &mut |_| Control::Continue);

        let constraints: Vec<_> = (0..problem.ellipsoids.len())
            .map(|i| {
                let problem = problem.clone();
                move |x: &[f64], mut gradient: Option<&mut [f64]>, _: &mut ()| {
                    let c = problem.constraint(i, x, gradient.as_deref_mut());
                    gradient.into_iter().flatten().for_each(|g| *g = -*g);
                    -c
                }
            })
            .collect();
        let references: Vec<&dyn Func<()>> = constraints.iter().map(|c| c as &dyn Func<()>).collect();
        let bounds = vec![(-1.0, 1.0); n];
        let tolerances = StopTols { ftol_rel: 1e-12, ..StopTols::default() };
        let objective = |x: &[f64], gradient: Option<&mut [f64]>, _: &mut ()| problem.objective(x, gradient);
        let theirs = slsqp::minimize(objective, &start, &bounds, &references, (), 2000, Some(tolerances));
        let (x, value) = match theirs {
            Ok((_, x, value)) | Err((_, x, value)) => (x, value),
        };
        let violation = (0..problem.ellipsoids.len()).fold(0.0, |v: f64, i| v.max(-problem.constraint(i, &x, None)));
        assert_eq!(ours.status, Status::Optimal, "seed {seed}");
        // Where slsqp has converged to a feasible point, it must be ours.
        if violation < 1e-6 {
            assert!(ours.objective < value + 1e-5, "seed {seed}: {} against {value}", ours.objective);
            if value - ours.objective < 1e-6 {
                compared += 1;
                let apart = ours.x.iter().zip(&x).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(apart < 1e-2, "seed {seed}: {apart}");
            }
        }
    }
    println!("{compared} of 150 compared");
    // slsqp gives up early on the others (never with a better point).
    assert!(compared > 90, "{compared}");
}
