//! The dual active-set method of Goldfarb & Idnani (Math. Prog. 27, 1983), with two extensions.
//!
//! *Capped multipliers.* A multiplier that reaches its limit wᵢ stays there and its constraint gives way, so the elastic
//! program needs no slack variables and an inconsistent one no first phase: the dual is then a box-constrained ascent. The
//! invariant at every step is Hd + g = Aᵀy + ν with all multipliers within their limits and the working set satisfied as
//! equations; what is still wrong (a violated row, a satisfied row whose multiplier is at its limit) is repaired one
//! constraint at a time, and each repair raises the dual objective.
//!
//! *Warm start.* The working set of the previous program is factorized first, rows that nearly depend on others left out,
//! and constraints whose multipliers come out of range dropped until the point is dual feasible. From there the method runs
//! as from scratch, so a bad guess costs time but never correctness. Rows added later are repaired from where it stands.

use super::factor::Factor;
use super::{Failure, Place, Quadratic, Step};
use crate::dense::{dot, max_abs};

/// Part of a normal that must be independent of the working set, relative to its length (in the metric of H⁻¹).
const INDEPENDENT: f64 = 1e-9;
/// The same for rows that are only a guess: neighbouring samples give nearly parallel rows, and one of them is enough.
const INDEPENDENT_GUESS: f64 = 1e-5;
/// A row that depends on the working set (to the square root of that) is not worth a violation below `EXCUSED`: at a degenerate
/// vertex rounding alone violates the rows beyond the n-th.
const DEPENDENT: f64 = 1e-6;
const EXCUSED: f64 = 1e-10;
/// How far a working row is from holding.
const ROUNDING: f64 = 1e-15;
/// Violation that counts otherwise.
const VIOLATED: f64 = 1e-13;
/// From this many rows on, each look at all of them yields up to `QUEUE` candidates.
const MANY: usize = 100;
const QUEUE: usize = 12;
/// Share of its violation that a candidate must have kept while others were repaired: with less, all rows are looked at anew.
const KEPT: f64 = 0.3;
/// Rows whose values are found at once.
const BLOCK: usize = 32;
/// Residual of the optimality conditions at which the answer stands.
const ACCEPT: f64 = 1e-9;

/// Workspace of the method.
#[derive(Clone, Debug, Default)]
pub struct ActiveSet {
    pub(super) n: usize,
    pub(super) factor: Factor,
    /// Constraints of the working set, in the order of the factorization. Ids: 0..n lower bounds, n..2n upper, then rows.
    pub(super) working: Vec<usize>,
    pub(super) place: Vec<Place>,
    /// Violation that is a matter of rounding, of each constraint.
    excused: Vec<f64>,
    /// Next candidates with their violation when last looked at, the largest last.
    queue: Vec<(f64, usize)>,
    queue_length: usize,
    /// Multipliers by id; bounds have nonnegative ones here.
    pub(super) y: Vec<f64>,
    pub(super) d: Vec<f64>,
    pub(super) w: Vec<f64>,
    pub(super) u: Vec<f64>,
    pub(super) change: Vec<f64>,
    pub(super) scratch: Vec<f64>,
    result: Step,
    /// Working-set changes since `solve`.
    pub(crate) changes: usize,
}

impl ActiveSet {
    /// A workspace for programs of `n` variables, and room for `rows` rows.
    #[must_use]
    pub fn new(n: usize, rows: usize) -> Self {
        let zeros = || vec![0.0; n];
        let ids = 2 * n + rows;
        Self {
            n,
            factor: Factor::new(n),
            working: Vec::with_capacity(n),
            place: Vec::with_capacity(ids),
            excused: Vec::with_capacity(ids),
            queue: Vec::with_capacity(QUEUE),
            y: Vec::with_capacity(ids),
            result: Step::with_room(n, rows),
            d: zeros(),
            w: zeros(),
            u: zeros(),
            change: zeros(),
            scratch: zeros(),
            ..Self::default()
        }
    }

    /// Solves `qp`, starting from its hints.
    ///
    /// # Errors
    /// [`Failure`]; the caller then turns to [`interior`](super::interior).
    pub fn solve(&mut self, qp: &Quadratic) -> Result<&Step, Failure> {
        self.working.clear();
        self.changes = 0;
        if !self.factor.start(&qp.hessian) {
            return Err(Failure::NotConvex);
        }
        self.place.clear();
        self.place.resize(2 * self.n + qp.len(), Place::Off);
        self.y.clear();
        self.y.resize(2 * self.n + qp.len(), 0.0);
        for id in 0..self.place.len() {
            match qp.hints.get(id).copied().unwrap_or_default() {
                Place::Working if self.exists(qp, id) => {
                    self.project(qp, id);
                    if self.independent(INDEPENDENT_GUESS) {
                        self.enter(id);
                    }
                }
                side @ (Place::Full | Place::Empty) if self.limit(qp, id).is_finite() => self.saturate(qp, id, side),
                _ => {}
            }
        }
        self.restart(qp)
    }

    /// Solves `qp` again after its gradient, constants or limits have changed, from the present working set.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn restart(&mut self, qp: &Quadratic) -> Result<&Step, Failure> {
        self.extend(qp);
        for id in 0..self.place.len() {
            let limit = self.limit(qp, id);
            match self.place[id] {
                side @ (Place::Full | Place::Empty) if limit.is_finite() => self.saturate(qp, id, side),
                Place::Full | Place::Empty | Place::Off => {
                    self.place[id] = Place::Off;
                    self.y[id] = 0.0;
                }
                Place::Working => {}
            }
        }
        self.make_dual_feasible(qp)?;
        self.ascend(qp)?;
        self.finish(qp)
    }

    /// Solves `qp` again after rows were added to it.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn resume(&mut self, qp: &Quadratic) -> Result<&Step, Failure> {
        self.extend(qp);
        self.ascend(qp)?;
        self.finish(qp)
    }

    /// The last solution.
    #[must_use]
    pub fn step(&self) -> &Step {
        &self.result
    }

    pub(crate) fn places(&self) -> &[Place] {
        &self.place
    }

    /// By how much a constraint contradicts optimality, and the direction in which its multiplier has to go.
    fn contradiction(&self, qp: &Quadratic, id: usize, reach: f64) -> Option<(f64, f64)> {
        if !self.exists(qp, id) {
            return None;
        }
        let place = self.place[id];
        if place == Place::Working {
            return None;
        }
        let value = self.value(qp, id);
        let (violation, sign) = match place {
            Place::Off if self.equality(qp, id) => (value.abs(), -value.signum()),
            Place::Full => (value, -1.0),
            _ => (-value, 1.0),
        };
        let tolerance = self.excused[id] * (reach + self.constant(qp, id).abs());
        (violation > tolerance).then_some((violation, sign))
    }

    /// A constraint that contradicts optimality (nearly) most, and the direction of its multiplier. Equalities come first:
    /// they are in every working set sooner or later. One look at all rows serves several picks where rows are many.
    fn pick(&mut self, qp: &Quadratic) -> Option<(usize, f64)> {
        let reach = 1.0 + max_abs(&self.d);
        while let Some((former, id)) = self.queue.pop() {
            if let Some((violation, sign)) = self.contradiction(qp, id, reach)
                && violation >= KEPT * former
            {
                return Some((id, sign));
            }
        }
        for j in 0..self.n {
            self.look(qp, j, self.d[j] - qp.lower[j], reach);
            self.look(qp, self.n + j, qp.upper[j] - self.d[j], reach);
        }
        let mut values = [0.0; BLOCK];
        for first in (0..qp.len()).step_by(BLOCK) {
            let values = &mut values[..BLOCK.min(qp.len() - first)];
            qp.values(first, &self.d, values);
            for (k, value) in values.iter().enumerate() {
                self.look(qp, 2 * self.n + first + k, *value, reach);
            }
        }
        let (_, id) = self.queue.pop()?;
        // The others must have kept their share of what they are worth now.
        let (_, sign) = self.contradiction(qp, id, reach)?;
        for entry in &mut self.queue {
            if entry.0 == f64::MAX {
                entry.0 = 0.0;
            }
        }
        Some((id, sign))
    }

    /// Queues a constraint with this value if it is one of those that contradict optimality most.
    #[inline(always)]
    fn look(&mut self, qp: &Quadratic, id: usize, value: f64, reach: f64) {
        // Most constraints are in order, and cheaply seen to be.
        let in_order = match self.place[id] {
            Place::Working => true,
            Place::Off => value >= 0.0 && !self.equality(qp, id),
            Place::Full => value <= 0.0,
            Place::Empty => value >= 0.0,
        };
        if !in_order {
            self.queue(qp, id, reach);
        }
    }

    fn queue(&mut self, qp: &Quadratic, id: usize, reach: f64) {
        if let Some((mut violation, _)) = self.contradiction(qp, id, reach) {
            if self.equality(qp, id) && self.place[id] == Place::Off {
                violation = f64::MAX;
            }
            // Insertion into the few largest, the largest last; of equals the first comes first.
            let position = self.queue.partition_point(|(other, _)| *other < violation);
            if self.queue.len() < self.queue_length {
                self.queue.insert(position, (violation, id));
            } else if position > 0 {
                self.queue[..position].rotate_left(1);
                self.queue[position - 1] = (violation, id);
            }
        }
    }

    fn ascend(&mut self, qp: &Quadratic) -> Result<(), Failure> {
        let limit = 50 + 10 * (self.n + qp.len());
        let mut count = 0;
        self.queue.clear();
        self.queue_length = if qp.len() < MANY { 1 } else { QUEUE };
        self.excused.clear();
        self.excused.resize(self.place.len(), VIOLATED);
        while let Some((p, sign)) = self.pick(qp) {
            self.project(qp, p);
            if self.excused[p] < EXCUSED && !self.independent(DEPENDENT) {
                // Look again without the rounding that the steps have left in d; the row is picked again only if it is
                // violated by more than can be excused.
                self.excused[p] = EXCUSED;
                self.stationarity(qp);
                self.correct(qp);
                continue;
            }
            // Raise (or lower) the multiplier of p until p holds, is dropped, or its limit is reached.
            loop {
                count += 1;
                if count > limit {
                    return Err(Failure::Inaccurate);
                }
                if self.advance(qp, p, sign)? {
                    break;
                }
                self.project(qp, p);
            }
        }
        Ok(())
    }

    /// One step of the dual ascent along the multiplier of `p`, whose projection is in `w`. `true` when `p` is settled.
    fn advance(&mut self, qp: &Quadratic, p: usize, sign: f64) -> Result<bool, Failure> {
        let q = self.factor.q;
        let independent = q < self.n && self.independent(INDEPENDENT);
        if sign < 0.0 {
            self.w.iter_mut().for_each(|w| *w = -*w);
        }
        self.change.copy_from_slice(&self.w);
        self.factor.solve(&mut self.change);

        // t₂: p holds as an equation. t₁: a working multiplier reaches one of its limits. t₃: that of p does.
        let full = if independent {
            (-sign * self.value(qp, p)).max(0.0) / dot(&self.w[q..], &self.w[q..])
        } else {
            f64::INFINITY
        };
        let mut partial = (f64::INFINITY, 0, Place::Off);
        for (k, &id) in self.working.iter().enumerate() {
            let (rate, y, limit) = (self.change[k], self.y[id], self.limit(qp, id));
            let (room, place) = if rate > 0.0 {
                if self.equality(qp, id) { (limit + y, Place::Empty) } else { (y, Place::Off) }
            } else if rate < 0.0 {
                (limit - y, Place::Full)
            } else {
                continue;
            };
            let t = room.max(0.0) / rate.abs();
            if t < partial.0 {
                partial = (t, k, place);
            }
        }
        let own_limit = self.limit(qp, p);
        let (own, own_place) = if sign > 0.0 {
            (own_limit - self.y[p], Place::Full)
        } else if self.equality(qp, p) {
            (self.y[p] + own_limit, Place::Empty)
        } else {
            (self.y[p], Place::Off)
        };

        let t = full.min(partial.0).min(own);
        if t.is_nan() {
            return Err(Failure::Inaccurate);
        }
        if t.is_infinite() {
            // The working rows, so weighted, contradict p: each of them holds but for rounding.
            let doubt = ACCEPT.min(ROUNDING * self.change.iter().map(|c| c.abs()).sum::<f64>());
            if self.y[p] != 0.0 || doubt <= self.excused[p] {
                return Err(Failure::Inconsistent);
            }
            self.excused[p] = doubt;
            return Ok(true);
        }
        if independent {
            self.factor.descend(t, &self.w, &mut self.d);
        }
        for (k, &id) in self.working.iter().enumerate() {
            self.y[id] -= t * self.change[k];
        }
        self.y[p] += sign * t;

        if full <= partial.0 && full <= own {
            if sign < 0.0 {
                self.w.iter_mut().for_each(|w| *w = -*w);
            }
            self.enter(p);
            self.changes += 1;
            Ok(true)
        } else if partial.0 <= own {
            self.leave(qp, partial.1, partial.2);
            Ok(false)
        } else {
            match own_place {
                Place::Full | Place::Empty => self.saturate(qp, p, own_place),
                Place::Off | Place::Working => {
                    self.place[p] = Place::Off;
                    self.y[p] = 0.0;
                }
            }
            self.changes += 1;
            Ok(true)
        }
    }

    /// Refines the answer on its working set and checks it against the optimality conditions.
    fn finish(&mut self, qp: &Quadratic) -> Result<&Step, Failure> {
        let n = self.n;
        for attempt in 0..3 {
            if attempt > 0 {
                self.stationarity(qp);
                self.correct(qp);
            }
            let result = &mut self.result;
            result.d.clear();
            result.d.extend(self.d.iter().zip(&qp.lower).zip(&qp.upper).map(|((d, low), high)| d.max(*low).min(*high)));
            result.multipliers.clear();
            result.multipliers.extend((0..qp.len()).map(|i| {
                let (low, high) = qp.range(i);
                self.y[2 * n + i].max(low).min(high)
            }));
            result.bound_multipliers.clear();
            result.bound_multipliers.extend((0..n).map(|j| self.y[j].max(0.0) - self.y[n + j].max(0.0)));
            let residual = qp.residual(&self.result, &mut self.scratch);
            if residual <= ACCEPT * 1e-3 || (attempt == 2 && residual <= ACCEPT) {
                return Ok(&self.result);
            }
        }
        Err(Failure::Inaccurate)
    }
}
