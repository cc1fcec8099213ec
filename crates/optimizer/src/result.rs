//! A result as it leaves the program: what was asked, what was found, and its receipt.

use crate::cycle::{Label, apart, theta};
use crate::examine::Examination;
use crate::four_legs::RealLegs;
use crate::optimality::Optimality;
use crate::search::evidence::Effort;
use crate::search::local::Local;
use crate::search::multi_start::{Found, Settings};
use crate::sensitivity::Sensitivities;
use crate::stability::Stability;
use crate::verdict::{self, Verdict};
use piaffe_model::digits::digits;
use piaffe_model::motion::{Costs, Course, Criterion, Motion};
use piaffe_model::{Description, Gait, Specification};
use piaffe_sqp as sqp;
use piaffe_verify::certificate::Certificate;
use piaffe_verify::{Finding, JointPeak, VerifyError};
use serde::{Deserialize, Serialize};

/// Characters of a speed in a file's name that has four decimals.
const LONGEST: usize = 24;

/// The name of a file for the result of a gait (by its key): no two tasks share one, and those of a sweep stand in the order of
/// their speeds.
pub fn file_name(gait: &str, criterion: Criterion, speed: f64, real_legs: bool) -> String {
    let padded = format!("{speed:.4}");
    let exact = padded.len() <= LONGEST && padded.parse() == Ok(speed);
    let speed = if exact { padded } else { digits(speed) };
    named(gait, criterion, &speed, real_legs) + ".json"
}

fn named(gait: &str, criterion: Criterion, speed: &str, real_legs: bool) -> String {
    let legs = if real_legs { "-real-legs" } else { "" };
    format!("{}-{}-{speed}{legs}", gait.replace('/', "-"), criterion.name())
}

/// How an optimization ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// A local optimum whose receipt holds.
    Optimal,
    /// No motion keeps to all constraints, whatever it costs: they conflict from every start.
    Infeasible,
    /// No point was found that can be called an optimum.
    NotConverged,
    /// An optimum for the optimizer, but its receipt does not hold.
    ReceiptFailed,
}

impl Status {
    /// As files have it.
    pub fn name(self) -> &'static str {
        match self {
            Status::Optimal => "optimal",
            Status::Infeasible => "infeasible",
            Status::NotConverged => "not-converged",
            Status::ReceiptFailed => "receipt-failed",
        }
    }
}

/// What was asked and what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GaitResult {
    pub gait: String,
    pub robot: String,
    pub criterion: Criterion,
    /// Mean forward speed asked for, m/s.
    pub speed: f64,
    pub status: Status,
    /// In plain words.
    pub message: String,
    /// The criterion, as the receipt's own integration gives it; with limits at each real leg that of the real joints, by the whole robot's
    /// equations of motion. Absent without an optimum.
    pub cost: Option<f64>,
    pub costs: Option<Costs>,
    /// Whether the limits hold at each real leg by constraint, not only at the virtual legs.
    #[serde(default)]
    pub limits_at_real_legs: bool,
    /// What the optimum without these further constraints costs, where it was looked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub virtual_cost: Option<f64>,
    /// s, per phase that defines the gait.
    #[serde(default)]
    pub durations: Vec<f64>,
    /// Travel in these phases, m: of a mirrored gait that of half a step.
    pub step_length: Option<f64>,
    /// Order of the joint polynomials.
    pub polynomial_order: usize,
    /// The motion (see `Course`); of a failed search none.
    #[serde(default)]
    pub variables: Vec<Course>,
    pub receipt: Option<Receipt>,
    /// What is proven between the instants of the receipt.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
    /// The first-order conditions, derived from the motion alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optimality: Option<Optimality>,
    /// What to change to lower the criterion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivities: Option<Sensitivities>,
    /// What becomes of a push.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    #[serde(default)]
    pub peaks: Vec<JointPeak>,
    /// Whether the real legs can do what the virtual ones do; absent where the build has no model of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub real_legs: Option<RealLegs>,
    /// What an optimum's entries leave open: those that are absent, each with its reason.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_examined: Vec<NotExamined>,
    /// For an infeasible problem: the constraints that conflict, worst first.
    #[serde(default)]
    pub conflicts: Vec<ConflictEntry>,
    /// For an infeasible problem: the nearest speed found at which the same search finds an optimum, m/s.
    pub nearest_speed: Option<f64>,
    /// What a motion costs that keeps to all limits, where it is less than the optimum: a better optimum exists, and was not found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cheaper_motion: Option<f64>,
    /// All distinct local optima found, best first.
    #[serde(default)]
    pub local_optima: Vec<LocalOptimum>,
    pub search: SearchEntry,
    /// Of the robot and gait as built: results of another robot are not comparable.
    pub fingerprint: String,
    /// What robot and gait were derived from. With it any machine can derive anew what is stated here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub specification: Option<Specification>,
    /// Wall time of all that was done for it.
    pub seconds: f64,
    pub version: String,
}

/// What stands behind a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Receipt {
    /// Largest violation of any constraint on the grid, in natural units.
    pub max_violation: f64,
    /// How far the motion is from a cycle under an independent integration.
    pub cycle_error: f64,
    /// Scaled residual of the first-order optimality conditions, derived from the motion alone: that of [`Optimality`].
    /// Absent where they cannot be looked at.
    pub kkt_residual: Option<f64>,
    /// Names of the active constraints.
    #[serde(deserialize_with = "piaffe_model::limit::names")]
    pub active: Vec<String>,
    /// The same with phase, time and margin.
    pub findings: Vec<Finding>,
    /// The constraint that is violated most, if any is.
    pub worst: Option<Finding>,
    pub grid: usize,
}

/// An entry of a result that is absent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotExamined {
    /// Its key, as in `stability`.
    pub entry: String,
    /// Why: not looked at, or what kept it from being derived.
    pub reason: String,
}

/// A constraint that takes part in a conflict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConflictEntry {
    #[serde(deserialize_with = "piaffe_model::limit::name")]
    pub constraint: String,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// s.
    pub time: f64,
    /// Scaled; 0 for one that holds but is in the way of others.
    pub violation: f64,
    pub weight: f64,
}

/// One of several local optima.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocalOptimum {
    pub cost: f64,
    pub durations: Vec<f64>,
    /// How many starts that knew of no optimum led to it.
    pub reached: usize,
}

/// How widely the search has looked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SearchEntry {
    #[serde(flatten)]
    pub effort: Effort,
    pub seed: u64,
}

/// How near to each other two descents to one optimum end, in natural sizes of the variables.
const MET: f64 = 1e-4;

impl LocalOptimum {
    /// Whether both are one optimum, met from two sides.
    fn same(&self, other: &LocalOptimum) -> bool {
        let near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs().max(b.abs());
        let mut durations = self.durations.iter().zip(&other.durations);
        near(self.cost, other.cost, 1e-5) && durations.all(|(a, b)| near(*a, *b, 1e-2))
    }
}

impl GaitResult {
    /// Verifies what a search found: the best optimum whose receipt holds is the result.
    pub fn new(
        gait: &dyn Gait,
        criterion: Criterion,
        speed: f64,
        found: &Found,
        settings: &Settings,
        seconds: impl Fn() -> f64,
    ) -> GaitResult {
        let search = SearchEntry { effort: found.effort, seed: settings.seed };
        let mut result = GaitResult::empty(gait, criterion, speed, search);
        for optimum in &found.optima {
            let mut candidate = GaitResult::empty(gait, criterion, speed, result.search);
            candidate.take(gait, &optimum.local, settings.examination);
            // Without its receipt an optimum does not leave the program.
            if let Some(cost) = candidate.cost {
                let durations = candidate.durations.clone();
                result.local_optima.push(LocalOptimum { cost, durations, reached: optimum.reached });
            }
            if !result.is_optimal() {
                candidate.local_optima = std::mem::take(&mut result.local_optima);
                result = candidate;
            }
        }
        if found.optima.is_empty() {
            result.explain(gait, found);
        } else if let Some(cost) = result.cost {
            result.cheaper_motion =
                found.motion.as_ref().and_then(|local| result.receipt_of(gait, local)).filter(|less| *less < cost);
        }
        result.seconds = seconds();
        result
    }

    /// The result that a motion makes, whoever found it: all that is stated about it derived anew.
    ///
    /// # Errors
    /// If the motion does not have the numbers that the gait needs, or cannot be followed to its end.
    pub fn of_motion(
        gait: &dyn Gait,
        criterion: Criterion,
        speed: f64,
        motion: &Motion,
    ) -> Result<GaitResult, VerifyError> {
        let mut result = GaitResult::empty(gait, criterion, speed, SearchEntry::default());
        result.accept(motion, Verdict::new(gait, criterion, speed, motion)?);
        result.examine(gait, Examination::Full);
        Ok(result)
    }

    fn empty(gait: &dyn Gait, criterion: Criterion, speed: f64, search: SearchEntry) -> GaitResult {
        let d = gait.description();
        GaitResult {
            gait: d.key.into(),
            robot: d.robot.into(),
            criterion,
            speed,
            status: Status::NotConverged,
            message: String::new(),
            cost: None,
            costs: None,
            limits_at_real_legs: d.limits.real_legs,
            virtual_cost: None,
            durations: Vec::new(),
            step_length: None,
            polynomial_order: d.polynomial_order,
            variables: Vec::new(),
            receipt: None,
            certificate: None,
            optimality: None,
            sensitivities: None,
            stability: None,
            peaks: Vec::new(),
            real_legs: None,
            not_examined: Vec::new(),
            conflicts: Vec::new(),
            nearest_speed: None,
            cheaper_motion: None,
            local_optima: Vec::new(),
            search,
            fingerprint: d.fingerprint(),
            specification: None,
            seconds: 0.0,
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }

    /// Takes in a local optimum that was found elsewhere: as the result if it is the best, else among the others.
    /// Tells whether it was new; without a receipt it does not count.
    pub fn join(&mut self, gait: &dyn Gait, local: &Local, examination: Examination) -> bool {
        // Before its verdict, which takes longer than the search did.
        if !local.status.is_optimal() || self.is_met_by(gait, local) {
            return false;
        }
        let mut candidate = GaitResult::empty(gait, self.criterion, self.speed, self.search);
        candidate.take(gait, local, examination);
        // Of costs only those of receipts compare: the optimizer's, from its nodes, differ by more than two optima may.
        let Some(cost) = candidate.cost else { return false };
        let new = LocalOptimum { cost, durations: candidate.durations.clone(), reached: 0 };
        if self.local_optima.iter().any(|known| known.same(&new)) {
            return false;
        }
        self.local_optima.push(new);
        self.local_optima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        if self.cost.is_none_or(|known| cost < known) {
            candidate.seconds = self.seconds;
            candidate.cheaper_motion = self.cheaper_motion.filter(|less| *less < cost);
            candidate.local_optima = std::mem::take(&mut self.local_optima);
            *self = candidate;
        }
        true
    }

    /// Whether the motion of `local` is this one.
    fn is_met_by(&self, gait: &dyn Gait, local: &Local) -> bool {
        self.theta().is_some_and(|own| apart(gait.description(), &own, &local.theta) < MET)
    }

    /// What tells it from others: gait, criterion, speed to its last digit, and whether the real legs are limited.
    pub fn name(&self) -> String {
        named(&self.gait, self.criterion, &digits(self.speed), self.limits_at_real_legs)
    }

    /// The name of a file for it.
    pub fn file_name(&self) -> String {
        file_name(&self.gait, self.criterion, self.speed, self.limits_at_real_legs)
    }

    /// The motion, if there is one.
    pub fn motion(&self) -> Option<Motion> {
        self.is_optimal().then(|| Motion { phases: self.variables.clone() })
    }

    /// Its variables Θ.
    pub fn theta(&self) -> Option<Vec<f64>> {
        self.motion().map(|motion| theta(&motion))
    }

    /// Makes the motion of `local` the result, with its verdict.
    fn take(&mut self, gait: &dyn Gait, local: &Local, examination: Examination) {
        let verdict = if examination == Examination::Full { Verdict::new } else { Verdict::by_receipt };
        match verdict(gait, self.criterion, self.speed, &local.motion) {
            Ok(verdict) => self.accept(&local.motion, verdict),
            Err(error) => {
                self.status = Status::ReceiptFailed;
                self.message = format!("the optimizer's motion could not be re-derived: {error}");
            }
        }
    }

    /// Makes `motion` the result: an optimum if its verdict says so.
    fn accept(&mut self, motion: &Motion, verdict: Verdict) {
        let holds = verdict.is_optimal();
        (self.status, self.message) = if holds {
            (Status::Optimal, "local optimum, receipt holds".into())
        } else {
            (Status::ReceiptFailed, format!("no receipt: {}", verdict.reasons.join("; ")))
        };
        let kkt_residual = verdict.kkt_residual();
        let receipt = verdict.receipt;
        self.cost = holds.then(|| receipt.costs.of(self.criterion));
        self.costs = holds.then_some(receipt.costs);
        self.step_length = Some(receipt.step_length);
        self.durations = motion.durations().collect();
        self.variables = motion.phases.clone();
        self.peaks = receipt.peaks;
        self.receipt = Some(Receipt {
            max_violation: receipt.max_violation,
            cycle_error: receipt.cycle_error,
            kkt_residual,
            active: receipt.active.iter().map(|f| f.constraint.clone()).collect(),
            findings: receipt.active,
            worst: receipt.worst,
            grid: receipt.grid,
        });
        self.optimality = verdict.optimality;
        self.certificate = verdict.certificate;
        self.not_examined = if holds { self.absent("not looked at") } else { Vec::new() };
    }

    /// What the motion of `local` costs, if it keeps to all limits by a receipt.
    fn receipt_of(&self, gait: &dyn Gait, local: &Local) -> Option<f64> {
        let receipt = verdict::receipt(gait, self.speed, &local.motion).ok()?;
        let holds = receipt.max_violation <= verdict::VIOLATION && receipt.cycle_error <= verdict::CYCLE_ERROR;
        holds.then(|| receipt.costs.of(self.criterion))
    }

    /// Says why there is no optimum.
    fn explain(&mut self, gait: &dyn Gait, found: &Found) {
        if let Some(message) = impossible(gait.description()) {
            (self.status, self.message) = (Status::Infeasible, message);
            return;
        }
        if found.motion.as_ref().is_some_and(|local| self.receipt_of(gait, local).is_some()) {
            self.message = "motions exist at this speed, but no start led to an optimum of the criterion".into();
            return;
        }
        let Some(local) = found.failure.as_ref() else {
            self.message = "no start led anywhere".into();
            return;
        };
        self.conflicts = local
            .conflicts
            .iter()
            .map(|c| {
                let Label { phase, time, .. } = c.label;
                ConflictEntry { constraint: c.label.name(), phase, time, violation: c.violation, weight: c.weight }
            })
            .collect();
        (self.status, self.message) = match local.status {
            sqp::Status::Infeasible => (Status::Infeasible, "infeasible: these constraints conflict".into()),
            sqp::Status::IterationLimit => (Status::NotConverged, "not converged within the iteration limit".into()),
            sqp::Status::Undefined => (Status::NotConverged, "no start gives a motion that exists".into()),
            _ => (Status::NotConverged, "no further progress before the optimality conditions held".into()),
        };
    }

    pub fn is_optimal(&self) -> bool {
        self.status == Status::Optimal
    }
}

/// What a result says of a gait to whose limits no motion can keep, which is known without a search.
pub fn impossible(d: &Description) -> Option<String> {
    let all: Vec<String> = d.contradictions().iter().map(ToString::to_string).collect();
    (!all.is_empty()).then(|| format!("infeasible: {}", all.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::{digits, file_name};
    use piaffe_model::motion::Criterion;

    #[test]
    fn files_of_different_tasks_have_different_names_of_bounded_length() {
        let mut speeds = vec![5e-324, 1e-300, 1e-12, 0.1 + 0.2, 0.6, 1.4265625, 1e5, 1e21, f64::MAX];
        speeds.extend(speeds.clone().into_iter().map(f64::next_down));
        speeds.extend([0.60001, 0.60002, 0.600_01_f64.next_up(), 1.0]);
        let mut names = std::collections::BTreeSet::new();
        for speed in &speeds {
            for criterion in Criterion::ALL {
                for real_legs in [false, true] {
                    let name = file_name("a1/bound", criterion, *speed, real_legs);
                    assert!(name.len() < 80 && !name.contains('/'), "{name}");
                    names.insert(name);
                }
            }
            assert_eq!(digits(*speed).parse(), Ok(*speed));
        }
        assert_eq!(names.len(), 4 * speeds.len());
        assert_eq!(file_name("trot", Criterion::Torque, 0.6, false), "trot-torque-0.6000.json");
    }
}
