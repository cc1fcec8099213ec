//! The prescribed coordinates Q(t) (eq. 15).

use super::{Layout, Mesh};
use crate::trajectory::{Basis, Jet};

impl Layout {
    /// Q, Q̇ and Q̈ (eq. 15) of prescribed coordinate `k`, and the derivatives of each in T.
    pub(super) fn coordinate(&self, k: usize, jet: &Jet, parameters: &[f64]) -> ([f64; 3], [f64; 3]) {
        let t = parameters[self.duration()];
        let per_t = 1.0 / t;
        let own = &parameters[self.joint(k, 0)..][..self.per_joint];
        let ((v, rv), (d, rd), (dd, rdd)) = (sums(&jet.value, own), sums(&jet.first, own), sums(&jet.second, own));
        let by_duration = [rv, -d * per_t * per_t, -(2.0 * dd * per_t + rdd) * per_t * per_t];
        ([v + t * rv, d * per_t + rd, (dd * per_t + rdd) * per_t], by_duration)
    }
}

/// What the values among the parameters add up to, and what the two rates, which are given times T.
#[inline(always)]
fn sums(basis: &[f64], own: &[f64]) -> (f64, f64) {
    let last = own.len() - 1;
    let values = basis[2..last].iter().zip(&own[2..last]).fold(basis[0] * own[0], |sum, (b, p)| sum + b * p);
    (values, basis[1] * own[1] + basis[last] * own[last])
}

/// The prescribed coordinates at some instants, a row per instant: Q, Q̇, Q̈ (eq. 15) and the derivatives of each in T.
#[derive(Clone, Debug, Default)]
pub struct Prescribed {
    count: usize,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    by_duration: Vec<[f64; 3]>,
}

impl Prescribed {
    /// Room for `count` coordinates at some instants.
    pub fn new(count: usize, instants: usize) -> Prescribed {
        let z = || vec![0.0; count * instants];
        Prescribed { count, q: z(), qd: z(), qdd: z(), by_duration: vec![[0.0; 3]; count * instants] }
    }

    /// Evaluates all coordinates at all nodes.
    pub fn evaluate(&mut self, layout: &Layout, mesh: &Mesh, parameters: &[f64]) {
        for (node, (_, jet)) in mesh.nodes.iter().enumerate() {
            for k in 0..layout.prescribed {
                let at = node * self.count + k;
                ([self.q[at], self.qd[at], self.qdd[at]], self.by_duration[at]) = layout.coordinate(k, jet, parameters);
            }
        }
    }

    /// Q, Q̇ and Q̈ at an instant.
    pub fn at(&self, instant: usize) -> [&[f64]; 3] {
        [&self.q, &self.qd, &self.qdd].map(|table| &table[instant * self.count..][..self.count])
    }

    /// Derivatives of Q, Q̇ and Q̈ in T at an instant, for each coordinate.
    pub fn by_duration(&self, instant: usize) -> &[[f64; 3]] {
        &self.by_duration[instant * self.count..][..self.count]
    }
}

/// ∂(Q, Q̇, Q̈)/∂(basis parameter i): the same for every coordinate.
pub fn basis_derivatives(basis: &Basis, jet: &Jet, t: f64, i: usize) -> [f64; 3] {
    let scale = if basis.is_rate(i) { t } else { 1.0 };
    [jet.value[i] * scale, jet.first[i] * scale / t, jet.second[i] * scale / (t * t)]
}
