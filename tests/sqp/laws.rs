//! Infeasibility, sampled constraints, undefined regions, determinism, and what the caller can steer.

use super::jet::Scalar;
use super::model::{Adapter, INF, Model, print};
use piaffe::sqp::{Control, Options, Problem, Solution, Status, Undefined, Values, minimize};

type Function = Box<dyn Fn(&[f64]) -> f64>;
type Domain = Box<dyn Fn(&[f64]) -> bool>;

/// A problem of closures with central differences: slow, and independent of every derivative formula.
pub struct Numeric {
    pub n: usize,
    pub objective: Function,
    pub equalities: Vec<Function>,
    pub inequalities: Vec<Function>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    pub defined: Domain,
    at: Vec<f64>,
}

impl Numeric {
    pub fn new(n: usize, objective: impl Fn(&[f64]) -> f64 + 'static) -> Self {
        Self {
            n,
            objective: Box::new(objective),
            equalities: Vec::new(),
            inequalities: Vec::new(),
            lower: vec![-INF; n],
            upper: vec![INF; n],
            defined: Box::new(|_| true),
            at: Vec::new(),
        }
    }
    pub fn equals_zero(mut self, c: impl Fn(&[f64]) -> f64 + 'static) -> Self {
        self.equalities.push(Box::new(c));
        self
    }
    pub fn at_least_zero(mut self, c: impl Fn(&[f64]) -> f64 + 'static) -> Self {
        self.inequalities.push(Box::new(c));
        self
    }
    pub fn bounded(mut self, lower: f64, upper: f64) -> Self {
        self.lower.fill(lower);
        self.upper.fill(upper);
        self
    }
    fn differentiate(&self, c: &Function, row: &mut [f64]) {
        for (j, row) in row.iter_mut().enumerate() {
            let h = 1e-6 * (1.0 + self.at[j].abs());
            let (mut a, mut b) = (self.at.clone(), self.at.clone());
            a[j] += h;
            b[j] -= h;
            *row = (c(&a) - c(&b)) / (2.0 * h);
        }
    }
    pub fn solve(&mut self, start: &[f64]) -> Solution {
        minimize(self, start, &Options::default(), &mut print)
    }
}

impl Problem for Numeric {
    fn variables(&self) -> usize {
        self.n
    }
    fn equalities(&self) -> usize {
        self.equalities.len()
    }
    fn inequalities(&self) -> usize {
        self.inequalities.len()
    }
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        lower.copy_from_slice(&self.lower);
        upper.copy_from_slice(&self.upper);
    }
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        if !(self.defined)(x) {
            return Err(Undefined);
        }
        out.objective = (self.objective)(x);
        for (out, c) in out.equalities.iter_mut().zip(&self.equalities) {
            *out = c(x);
        }
        for (out, c) in out.inequalities.iter_mut().zip(&self.inequalities) {
            *out = c(x);
        }
        Ok(())
    }
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        self.at = x.to_vec();
        Ok(())
    }
    fn gradient(&self, gradient: &mut [f64]) {
        self.differentiate(&self.objective, gradient);
    }
    fn equality_row(&self, i: usize, row: &mut [f64]) {
        self.differentiate(&self.equalities[i], row);
    }
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.differentiate(&self.inequalities[i], row);
    }
}

fn assert_conflict(solution: &Solution, equalities: &[usize], inequalities: &[usize], bounds: &[usize]) {
    assert_eq!(solution.status, Status::Infeasible, "{:?} {:?}", solution.kkt, solution.x);
    let conflict = solution.conflict.as_ref().expect("an infeasible problem has a conflict");
    assert_eq!(conflict.conflicting_equalities().collect::<Vec<_>>(), equalities, "{conflict:?}");
    assert_eq!(conflict.conflicting_inequalities().collect::<Vec<_>>(), inequalities, "{conflict:?}");
    assert_eq!(conflict.conflicting_bounds().collect::<Vec<_>>(), bounds, "{conflict:?}");
    assert!(solution.iterations < 100, "{}", solution.iterations);
}

// --- infeasible problems ------------------------------------------------------------------------------------------------

#[test]
fn a_square_is_not_less_than_minus_one() {
    let solution = Numeric::new(1, |x| x[0]).at_least_zero(|x| -x[0] * x[0] - 1.0).solve(&[3.0]);
    assert_conflict(&solution, &[], &[0], &[]);
    assert!(solution.x[0].abs() < 1e-4);
}

#[test]
fn conflicting_half_planes_are_named() {
    let solution = Numeric::new(2, |x| x[0] * x[0] + (x[1] - 3.0).powi(2))
        .at_least_zero(|x| 5.0 - x[1])
        .at_least_zero(|x| x[0] - 1.0)
        .at_least_zero(|x| -x[0] - 1.0)
        .solve(&[4.0, 4.0]);
    assert_conflict(&solution, &[], &[1, 2], &[]);
}

#[test]
fn disjoint_circles_are_named() {
    let solution = Numeric::new(2, |x| x[0] + x[1])
        .at_least_zero(|x| 1.0 - (x[0] - 2.0).powi(2) - x[1] * x[1])
        .at_least_zero(|x| 100.0 - x[0] * x[0] - x[1] * x[1])
        .at_least_zero(|x| 1.0 - (x[0] + 2.0).powi(2) - x[1] * x[1])
        .solve(&[3.0, 4.0]);
    assert_conflict(&solution, &[], &[0, 2], &[]);
    assert!(solution.x[1].abs() < 1e-3, "{:?}", solution.x);
}

#[test]
fn an_equation_out_of_the_bounds_reach_is_named() {
    let solution = Numeric::new(3, |x| x[2] * x[2])
        .equals_zero(|x| x[2] - 0.5)
        .equals_zero(|x| x[0] + x[1] - 5.0)
        .bounded(0.0, 1.0)
        .solve(&[0.5, 0.5, 0.5]);
    assert_conflict(&solution, &[1], &[], &[0, 1]);
}

#[test]
fn contradictory_equations_are_named() {
    let solution = Numeric::new(2, |x| x[0] * x[1])
        .equals_zero(|x| x[0] * x[0] + x[1] * x[1] - 1.0)
        .equals_zero(|x| x[0] - 2.0)
        .solve(&[0.3, 0.7]);
    assert_conflict(&solution, &[0, 1], &[], &[]);
}

/// A thousand samples of y(t) ≥ sin t and y(t) ≤ −1 + sin 3t, with y a polynomial: some samples must conflict.
#[test]
fn conflicting_samples_are_named() {
    let mut problem = Numeric::new(4, |x| x.iter().map(|a| a * a).sum());
    let polynomial = |x: &[f64], t: f64| x.iter().rev().fold(0.0, |p, a| p * t + a);
    for k in 0..60 {
        let t = k as f64 / 30.0;
        problem = problem.at_least_zero(move |x| polynomial(x, t) - t.sin());
        problem = problem.at_least_zero(move |x| (3.0 * t).sin() - polynomial(x, t));
    }
    let solution = problem.solve(&[0.0; 4]);
    assert_eq!(solution.status, Status::Infeasible);
    assert!(solution.conflict.unwrap().conflicting_inequalities().count() > 1);
}

#[test]
fn crossed_bounds_are_invalid() {
    let solution = Numeric::new(1, |x| x[0]).bounded(1.0, 0.0).solve(&[0.0]);
    assert_eq!(solution.status, Status::Invalid);
}

// --- where nothing is defined ---------------------------------------------------------------------------------------------

#[test]
fn the_line_search_backs_off_from_undefined_points() {
    let mut problem = Numeric::new(1, |x| x[0] - x[0].ln());
    problem.defined = Box::new(|x| x[0] > 0.0);
    let solution = problem.solve(&[30.0]);
    assert_eq!(solution.status, Status::Optimal);
    assert!((solution.x[0] - 1.0).abs() < 1e-5);
}

#[test]
fn values_that_are_not_numbers_count_as_undefined() {
    // √ outside of its domain gives NaN rather than an error.
    let solution = Numeric::new(2, |x| x[0] + x[1]).at_least_zero(|x| (4.0 - x[0] * x[0] - x[1] * x[1]).sqrt() - 1.0);
    let solution = { solution }.solve(&[1.0, 0.5]);
    assert_eq!(solution.status, Status::Optimal);
    assert!((solution.objective + 6f64.sqrt()).abs() < 1e-5);
    let nowhere = Numeric::new(1, |_| f64::NAN).solve(&[0.0]);
    assert_eq!(nowhere.status, Status::Undefined);
}

// --- sampled constraints ----------------------------------------------------------------------------------------------------

/// Chebyshev approximation of exp on [−1, 1] by a polynomial of degree 5: minimize t with |p(s) − exp(s)| ≤ t at every sample.
pub struct Chebyshev {
    pub samples: usize,
    pub exact: bool,
}

impl Chebyshev {
    fn basis(&self, k: usize, row: &mut [f64]) -> f64 {
        let s = -1.0 + 2.0 * (k % self.samples) as f64 / (self.samples - 1) as f64;
        let sign = if k < self.samples { 1.0 } else { -1.0 };
        let (mut a, mut b) = (1.0, s);
        for row in &mut row[..6] {
            *row = sign * a;
            (a, b) = (b, 2.0 * s * b - a);
        }
        row[6] = 1.0;
        -sign * s.exp()
    }
}

impl Problem for Chebyshev {
    fn variables(&self) -> usize {
        7
    }
    fn equalities(&self) -> usize {
        0
    }
    fn inequalities(&self) -> usize {
        2 * self.samples
    }
    fn bounds(&self, _: &mut [f64], _: &mut [f64]) {}
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        out.objective = x[6];
        let mut row = [0.0; 7];
        for (k, out) in out.inequalities.iter_mut().enumerate() {
            let constant = self.basis(k, &mut row);
            *out = constant + row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        }
        Ok(())
    }
    fn linearize(&mut self, _: &[f64]) -> Result<(), Undefined> {
        Ok(())
    }
    fn gradient(&self, gradient: &mut [f64]) {
        gradient[6] = 1.0;
    }
    fn equality_row(&self, _: usize, _: &mut [f64]) {}
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        self.basis(i, row);
    }
    fn hessian(&mut self, _: &[f64], _: &[f64], hessian: &mut [f64]) -> bool {
        hessian.fill(0.0);
        self.exact
    }
}

#[test]
fn the_best_polynomial_equioscillates() {
    for exact in [false, true] {
        let mut problem = Chebyshev { samples: 1000, exact };
        let solution = minimize(&mut problem, &[0.0; 7], &Options::default(), &mut print);
        assert_eq!(solution.status, Status::Optimal);
        assert!((solution.objective - 4.5205e-5).abs() < 1e-8, "{}", solution.objective);
        // Degree 5: seven points of largest error, with multipliers that sum to one.
        let sum: f64 = solution.inequality_multipliers.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6);
        println!("Chebyshev exact {exact}: {} iterations, {} evaluations", solution.iterations, solution.evaluations);
    }
}

// --- determinism, observer, options -------------------------------------------------------------------------------------------

fn rosenbrock_in_a_disc() -> Numeric {
    Numeric::new(2, |x| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2))
        .at_least_zero(|x| 0.5 - x[0] * x[0] - x[1] * x[1])
}

#[test]
fn the_same_bits_twice() {
    let (a, b) = (rosenbrock_in_a_disc().solve(&[-1.0, 1.0]), rosenbrock_in_a_disc().solve(&[-1.0, 1.0]));
    assert_eq!(a.status, Status::Optimal);
    assert_eq!(a, b);
    assert_eq!(
        a.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        b.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
}

#[test]
fn the_observer_can_stop() {
    let solution = minimize(&mut rosenbrock_in_a_disc(), &[-1.0, 1.0], &Options::default(), &mut |line| {
        if line.k == 3 { Control::Stop } else { Control::Continue }
    });
    assert_eq!((solution.status, solution.iterations), (Status::Stopped, 3));
}

#[test]
fn scaling_changes_neither_solution_nor_units() {
    let plain = rosenbrock_in_a_disc().solve(&[-1.0, 1.0]);
    let options = Options { scale: Some(vec![1e-3, 1e2]), scale_rows: true, ..Options::default() };
    let scaled = minimize(&mut rosenbrock_in_a_disc(), &[-1.0, 1.0], &options, &mut print);
    assert_eq!(scaled.status, Status::Optimal);
    assert!((plain.objective - scaled.objective).abs() < 1e-5);
    assert!((plain.inequality_multipliers[0] - scaled.inequality_multipliers[0]).abs() < 1e-2);
}

/// Multipliers of the solution satisfy ∇f = J_Eᵀλ + J_Iᵀμ + ν in the problem's own units.
#[test]
fn multipliers_explain_the_gradient() {
    let mut problem =
        Numeric::new(2, |x| (x[0] - 3.0).powi(2) + (x[1] - 2.0).powi(2)).at_least_zero(|x| 4.0 - x[0] - x[1]);
    problem.upper[1] = 0.5;
    let solution = problem.solve(&[0.0, 0.0]);
    assert_eq!(solution.status, Status::Optimal);
    let (mu, nu) = (solution.inequality_multipliers[0], &solution.bound_multipliers);
    let (x, slope) = (&solution.x, [2.0 * (solution.x[0] - 3.0), 2.0 * (solution.x[1] - 2.0)]);
    assert!((slope[0] + mu - nu[0]).abs() < 1e-5 && (slope[1] + mu - nu[1]).abs() < 1e-5, "{x:?} {mu} {nu:?}");
    assert!(nu[1] < 0.0);
}

/// No multiplier exists at the solution (Hock & Schittkowski 13): the solver must neither panic nor lie.
#[test]
fn a_cusp_is_approached_honestly() {
    let mut problem =
        Numeric::new(2, |x| (x[0] - 2.0).powi(2) + x[1] * x[1]).at_least_zero(|x| (1.0 - x[0]).powi(3) - x[1]);
    problem.lower.fill(0.0);
    let solution = problem.solve(&[-2.0, -2.0]);
    println!(
        "cusp: {:?} x {:?} kkt {:?} iterations {}",
        solution.status, solution.x, solution.kkt, solution.iterations
    );
    assert!((solution.objective - 1.0).abs() < 0.05, "{:?}", solution.x);
}

/// A valley ten orders flatter than its wall is steep, beside a ridge to descend from.
struct Valley;

impl Model<3> for Valley {
    const NAME: &'static str = "valley";
    const EQUALITIES: usize = 0;
    const INEQUALITIES: usize = 0;
    const START: [f64; 3] = [3.0, 0.1, 0.1];
    const BEST: f64 = -0.25;
    fn functions<T: Scalar>(x: &[T; 3], _: &mut [T], _: &mut [T]) -> T {
        let [along, across, ridge] = *x;
        along * along * 5e-4 + across * across * 5e6 + ridge * ridge * ridge * ridge * 0.25 - ridge * ridge * 0.5
    }
}

#[test]
fn a_flat_valley_is_descended_in_long_steps() {
    let solution = minimize(&mut Adapter::<Valley, 3>::new(true), &Valley::START, &Options::default(), &mut print);
    assert!(solution.status.is_optimal() && (solution.objective - Valley::BEST).abs() < 1e-6, "{solution:?}");
    assert!(solution.iterations <= 20, "{}", solution.iterations);
}

/// Curvature is negative towards a bound on which the solution rests, and mixed with that along it.
struct Ledge;

impl Model<2> for Ledge {
    const NAME: &'static str = "ledge";
    const EQUALITIES: usize = 0;
    const INEQUALITIES: usize = 0;
    const START: [f64; 2] = [0.3, 1.0];
    const LOWER: [f64; 2] = [0.0, -2.0];
    const UPPER: [f64; 2] = [0.5, 2.0];
    const BEST: f64 = -0.21480474685286194;
    fn functions<T: Scalar>(x: &[T; 2], _: &mut [T], _: &mut [T]) -> T {
        let [away, along] = *x;
        away * 4.0 - away * away * 3.0 + away * along * 4.0 + along * along * along * along + along * along - along
    }
}

#[test]
fn on_a_bound_convergence_is_newtons() {
    let options = Options { tolerance: 1e-12, ..Options::default() };
    let solution = minimize(&mut Adapter::<Ledge, 2>::new(true), &Ledge::START, &options, &mut print);
    assert!(solution.status.is_optimal() && (solution.objective - Ledge::BEST).abs() < 1e-14, "{solution:?}");
    // Linearly it would take more than twenty.
    assert!(solution.iterations <= 8, "{}", solution.iterations);
}
