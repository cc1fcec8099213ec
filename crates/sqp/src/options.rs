//! What a caller can choose, and what a caller can watch.

/// Settings of [`minimize`](super::minimize). `Options::default()` suits problems whose variables are of order one.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Largest stationarity and complementarity residual of an optimum, relative to max(1, ‖∇f‖∞) in scaled variables.
    pub tolerance: f64,
    /// Largest violation of any constraint at an optimum, in the constraint's own unit.
    pub feasibility: f64,
    /// Number of iterations after which to give up.
    pub iteration_limit: usize,
    /// Typical magnitude of each variable; the algorithm works on x / scale. `None`: all ones.
    pub scale: Option<Vec<f64>>,
    /// Divide each constraint by the largest component of its gradient at the first point (in scaled variables).
    pub scale_rows: bool,
    /// Length of the first step that a quasi-Newton method would take without constraints, in scaled variables.
    pub initial_step: f64,
    /// Largest component of any step, in scaled variables. Infinite: only refused steps limit later ones.
    pub step_limit: f64,
    /// The same of the first step alone; later ones go as far as those before them went well.
    pub first_step_limit: f64,
    /// First penalty of the ℓ1 merit function; it grows by itself.
    pub penalty: f64,
    /// Use [`Problem::hessian`](super::Problem::hessian) if the problem provides it.
    pub exact_hessian: bool,
    /// Estimate multipliers before the first exact Hessian: right for starts near an optimum, whose first steps would lead away
    /// without the constraints' curvature.
    pub estimate_multipliers: bool,
    /// Solver of the quadratic subproblems.
    pub subproblems: Subproblems,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            feasibility: 1e-6,
            iteration_limit: 500,
            scale: None,
            scale_rows: false,
            initial_step: 1.0,
            step_limit: f64::INFINITY,
            first_step_limit: f64::INFINITY,
            penalty: 1.0,
            exact_hessian: true,
            estimate_multipliers: false,
            subproblems: Subproblems::ActiveSet,
        }
    }
}

/// Which method solves the quadratic subproblems.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subproblems {
    /// The dense dual active-set method; Clarabel wherever its answer does not satisfy the optimality conditions.
    #[default]
    ActiveSet,
    /// Clarabel only: slower, an independent check.
    InteriorPoint,
}

/// One line of the log, handed to the observer at every iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Number of the iterate; 0 is the first point.
    pub k: usize,
    /// f at the iterate.
    pub objective: f64,
    /// Largest violation of any constraint.
    pub violation: f64,
    /// Scaled stationarity residual with the latest multipliers.
    pub stationarity: f64,
    /// ‖·‖∞ of the change of the scaled variables that led here.
    pub step: f64,
    /// Bound on that change that the next subproblem respects; infinite while all goes well.
    pub radius: f64,
    /// Penalty of the merit function.
    pub penalty: f64,
    /// Number of constraints and bounds active in the subproblem that led here.
    pub active: usize,
    /// Number of inequality rows that the subproblem needed.
    pub rows: usize,
    /// How the step that led here was found.
    pub kind: Kind,
}

/// How a step was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The first point.
    Start,
    /// The quadratic program with its constraints as they are.
    Exact,
    /// The same, followed by a second-order correction.
    Corrected,
    /// The ℓ1 relaxation: the linearized constraints contradict each other, or nearly.
    Elastic,
    /// A step that looks at the violation alone.
    Feasibility,
}

/// The observer's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Stop here; the solution's status is [`Status::Stopped`](super::Status::Stopped).
    Stop,
}
