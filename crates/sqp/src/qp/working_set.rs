//! The working set of [`ActiveSet`]: what one constraint is, how it comes and goes, and the equality-constrained program that
//! the set defines. Ids: 0..n lower bounds, n..2n upper bounds, then the rows.

use super::active_set::ActiveSet;
use super::{Failure, Place, Quadratic};
use crate::dense::{axpy, dot, multiply};

impl ActiveSet {
    pub(super) fn extend(&mut self, qp: &Quadratic) {
        self.place.resize(2 * self.n + qp.len(), Place::Off);
        self.y.resize(2 * self.n + qp.len(), 0.0);
    }

    pub(super) fn exists(&self, qp: &Quadratic, id: usize) -> bool {
        let n = self.n;
        if id < n {
            qp.lower[id].is_finite()
        } else if id < 2 * n {
            qp.upper[id - n].is_finite()
        } else {
            true
        }
    }

    pub(super) fn limit(&self, qp: &Quadratic, id: usize) -> f64 {
        if id < 2 * self.n { f64::INFINITY } else { qp.limits[id - 2 * self.n] }
    }

    pub(super) fn equality(&self, qp: &Quadratic, id: usize) -> bool {
        id >= 2 * self.n && qp.equality[id - 2 * self.n]
    }

    /// The constant b of aᵀd + b.
    pub(super) fn constant(&self, qp: &Quadratic, id: usize) -> f64 {
        let n = self.n;
        if id < n {
            -qp.lower[id]
        } else if id < 2 * n {
            qp.upper[id - n]
        } else {
            qp.constants[id - 2 * n]
        }
    }

    /// aᵀd + b.
    pub(super) fn value(&self, qp: &Quadratic, id: usize) -> f64 {
        let n = self.n;
        if id < n {
            self.d[id] - qp.lower[id]
        } else if id < 2 * n {
            qp.upper[id - n] - self.d[id - n]
        } else {
            dot(qp.row(id - 2 * n), &self.d) + qp.constants[id - 2 * n]
        }
    }

    /// w ← Jᵀa.
    pub(super) fn project(&mut self, qp: &Quadratic, id: usize) {
        let n = self.n;
        if id < n {
            self.factor.project_unit(id, 1.0, &mut self.w);
        } else if id < 2 * n {
            self.factor.project_unit(id - n, -1.0, &mut self.w);
        } else {
            self.factor.project(qp.row(id - 2 * n), &mut self.w);
        }
    }

    /// out ← out + α·a.
    pub(super) fn accumulate(n: usize, qp: &Quadratic, id: usize, alpha: f64, out: &mut [f64]) {
        if id < n {
            out[id] += alpha;
        } else if id < 2 * n {
            out[id - n] -= alpha;
        } else {
            axpy(alpha, qp.row(id - 2 * n), out);
        }
    }

    pub(super) fn independent(&self, threshold: f64) -> bool {
        let q = self.factor.q;
        let free = dot(&self.w[q..], &self.w[q..]);
        free > threshold * threshold * dot(&self.w, &self.w)
    }

    pub(super) fn enter(&mut self, id: usize) {
        self.factor.add(&self.w);
        self.working.push(id);
        self.place[id] = Place::Working;
    }

    pub(super) fn leave(&mut self, qp: &Quadratic, k: usize, place: Place) {
        self.factor.remove(k, &mut self.w);
        let id = self.working.remove(k);
        match place {
            Place::Full | Place::Empty => self.saturate(qp, id, place),
            Place::Off | Place::Working => {
                self.place[id] = Place::Off;
                self.y[id] = 0.0;
            }
        }
        self.changes += 1;
    }

    pub(super) fn saturate(&mut self, qp: &Quadratic, id: usize, side: Place) {
        let limit = self.limit(qp, id);
        self.place[id] = side;
        self.y[id] = if side == Place::Empty { -limit } else { limit };
    }

    /// Corrects d and the working multipliers so that Hd + g = Aᵀy and the working set holds as equations, given what
    /// `scratch` holds of the former residual and the present values of the working set.
    pub(super) fn correct(&mut self, qp: &Quadratic) {
        self.factor.project(&self.scratch, &mut self.w);
        self.balance(|this, id| this.value(qp, id));
        self.follow();
    }

    /// change ← what is missing in the working multipliers, and u₁, from the constraints' values and the residual in J-coordinates,
    /// `w` (see the module header of `factor`).
    fn balance(&mut self, value: impl Fn(&Self, usize) -> f64) {
        let q = self.factor.q;
        for k in 0..q {
            self.change[k] = -value(self, self.working[k]);
        }
        self.factor.solve_transposed(&self.change, &mut self.u);
        for k in 0..q {
            self.change[k] = self.w[k] + self.u[k];
        }
        self.factor.solve(&mut self.change);
    }

    /// Takes over what [`balance`](Self::balance) has found; u₂ is from stationarity.
    fn follow(&mut self) {
        for k in self.factor.q..self.n {
            self.u[k] = -self.w[k];
        }
        self.factor.expand(&self.u, &mut self.d);
        for (k, &id) in self.working.iter().enumerate() {
            self.y[id] += self.change[k];
        }
    }

    /// scratch ← Hd + g − Aᵀy.
    pub(super) fn stationarity(&mut self, qp: &Quadratic) {
        multiply(&qp.hessian, &self.d, &mut self.scratch);
        axpy(1.0, &qp.gradient, &mut self.scratch);
        for (id, &y) in self.y.iter().enumerate() {
            if y != 0.0 {
                Self::accumulate(self.n, qp, id, -y, &mut self.scratch);
            }
        }
    }

    /// Solves for the working set and drops constraints until every multiplier is within its limits.
    pub(super) fn make_dual_feasible(&mut self, qp: &Quadratic) -> Result<(), Failure> {
        self.d.fill(0.0);
        for &id in &self.working {
            self.y[id] = 0.0;
        }
        self.stationarity(qp);
        self.factor.project(&self.scratch, &mut self.w);
        loop {
            // At d = 0 and without working multipliers: dropping a constraint changes neither residual nor values.
            self.balance(|this, id| this.constant(qp, id));
            let mut worst = (0.0, 0, Place::Off);
            for (k, &id) in self.working.iter().enumerate() {
                let (y, limit) = (self.change[k], self.limit(qp, id));
                let (excess, place) = if y > limit {
                    (y - limit, Place::Full)
                } else if self.equality(qp, id) {
                    (-limit - y, Place::Empty)
                } else {
                    (-y, Place::Off)
                };
                if !excess.is_finite() && excess != f64::NEG_INFINITY {
                    return Err(Failure::Inaccurate);
                }
                if excess > worst.0 {
                    worst = (excess, k, place);
                }
            }
            if worst.0 == 0.0 {
                self.follow();
                return Ok(());
            }
            self.leave(qp, worst.1, worst.2);
            if worst.2 != Place::Off {
                self.stationarity(qp);
                self.factor.project(&self.scratch, &mut self.w);
            }
        }
    }
}
