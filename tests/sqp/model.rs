//! A test problem as formulas, and its adapter to the solver.

use super::jet::{Jet, Scalar};
use piaffe::sqp::{Control, Iteration, Options, Problem, Solution, Undefined, Values, minimize};

pub const INF: f64 = f64::INFINITY;

/// minimize f(x) with E equations and I inequalities in N variables.
pub trait Model<const N: usize> {
    const NAME: &'static str;
    const EQUALITIES: usize;
    const INEQUALITIES: usize;
    const START: [f64; N];
    const LOWER: [f64; N] = [-INF; N];
    const UPPER: [f64; N] = [INF; N];
    /// Published optimal value.
    const BEST: f64;
    fn functions<T: Scalar>(x: &[T; N], e: &mut [T], i: &mut [T]) -> T;
}

pub struct Adapter<M, const N: usize> {
    objective: Jet<N>,
    equalities: Vec<Jet<N>>,
    inequalities: Vec<Jet<N>>,
    pub exact: bool,
    model: std::marker::PhantomData<M>,
}

impl<M: Model<N>, const N: usize> Adapter<M, N> {
    pub fn new(exact: bool) -> Self {
        let zero = Jet::constant(0.0);
        Self {
            objective: zero,
            equalities: vec![zero; M::EQUALITIES],
            inequalities: vec![zero; M::INEQUALITIES],
            exact,
            model: std::marker::PhantomData,
        }
    }
}

impl<M: Model<N>, const N: usize> Problem for Adapter<M, N> {
    fn variables(&self) -> usize {
        N
    }
    fn equalities(&self) -> usize {
        M::EQUALITIES
    }
    fn inequalities(&self) -> usize {
        M::INEQUALITIES
    }
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        lower.copy_from_slice(&M::LOWER);
        upper.copy_from_slice(&M::UPPER);
    }
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        let x: &[f64; N] = x.try_into().unwrap();
        out.objective = M::functions(x, &mut out.equalities, &mut out.inequalities);
        Ok(())
    }
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        let x: [Jet<N>; N] = std::array::from_fn(|i| Jet::variable(x[i], i));
        self.objective = M::functions(&x, &mut self.equalities, &mut self.inequalities);
        Ok(())
    }
    fn gradient(&self, gradient: &mut [f64]) {
        gradient.copy_from_slice(&self.objective.g);
    }
    fn equality_row(&self, i: usize, row: &mut [f64]) {
        row.copy_from_slice(&self.equalities[i].g);
    }
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        row.copy_from_slice(&self.inequalities[i].g);
    }
    fn hessian(&mut self, lambda: &[f64], mu: &[f64], hessian: &mut [f64]) -> bool {
        if !self.exact {
            return false;
        }
        for i in 0..N {
            for j in 0..=i {
                let mut h = self.objective.h[i][j];
                for (c, m) in self.equalities.iter().zip(lambda) {
                    h -= m * c.h[i][j];
                }
                for (c, m) in self.inequalities.iter().zip(mu) {
                    h -= m * c.h[i][j];
                }
                hessian[i * N + j] = h;
            }
        }
        true
    }
}

pub fn solve<M: Model<N>, const N: usize>(exact: bool, options: &Options) -> Solution {
    minimize(&mut Adapter::<M, N>::new(exact), &M::START, options, &mut print)
}

/// Prints the log of a run when the environment asks for it.
pub fn print(line: &Iteration) -> Control {
    if std::env::var_os("SQP_LOG").is_some() { show(line) } else { Control::Continue }
}

/// Prints a line of the log.
pub fn show(line: &Iteration) -> Control {
    println!(
        "{:4} {:15.8e} v {:8.1e} s {:8.1e} |s| {:7.1e} radius {:7.1e} ρ {:7.1e} active {:2} rows {:3} {:?}",
        line.k,
        line.objective,
        line.violation,
        line.stationarity,
        line.step,
        line.radius,
        line.penalty,
        line.active,
        line.rows,
        line.kind
    );
    Control::Continue
}
