//! From derivatives in the state of an instant to derivatives in the parameters of its half step.

use super::Instants;
use crate::flow::{Flow, Layout};
use piaffe_model::Description;

/// Derivatives in (q, q̇, q̈), by parts.
pub(super) fn parts(row: &[f64], nq: usize) -> [&[f64]; 3] {
    [&row[..nq], &row[nq..2 * nq], &row[2 * nq..]]
}

/// The chain rule at one node: from partial derivatives in q, q̇, q̈ to the local parameters.
pub(super) struct Chain<'a> {
    d: &'a Description,
    layout: Layout,
    basis: &'a [[f64; 3]],
    by_duration: &'a [[f64; 3]],
    beta_p: &'a [f64],
    betad_p: &'a [f64],
}

impl<'a> Chain<'a> {
    pub(super) fn new(instants: &'a Instants, d: &'a Description, stance: &'a Flow, node: usize) -> Chain<'a> {
        let layout = instants.layout;
        let np = layout.len();
        Chain {
            d,
            layout,
            basis: &instants.basis[node * layout.per_joint..][..layout.per_joint],
            by_duration: stance.prescribed.by_duration(node),
            beta_p: &stance.beta_p[node * np..][..np],
            betad_p: &stance.betad_p[node * np..][..np],
        }
    }

    /// `parts` are the partial derivatives in q, q̇ and q̈ (each may be empty). Without `betadd_p` the
    /// derivative in β̈ is left out.
    pub(super) fn row(&self, parts: [&[f64]; 3], betadd_p: Option<&[f64]>, out: &mut [f64]) {
        let (layout, beta) = (self.layout, self.d.unactuated);
        let at = |part: usize, index: usize| parts[part].get(index).copied().unwrap_or(0.0);
        let mut by_duration = 0.0;
        for (j, out) in out.chunks_mut(layout.per_joint).take(layout.prescribed).enumerate() {
            let index = self.d.prescribed_index(j);
            let [a, b, c] = [at(0, index), at(1, index), at(2, index)];
            for (o, basis) in out.iter_mut().zip(self.basis) {
                *o = a * basis[0] + b * basis[1] + c * basis[2];
            }
            let t = self.by_duration[j];
            by_duration += a * t[0] + b * t[1] + c * t[2];
        }
        out[layout.duration()..].fill(0.0);
        out[layout.duration()] = by_duration;
        let [a, b, c] = [at(0, beta), at(1, beta), at(2, beta)];
        match betadd_p {
            Some(betadd_p) => {
                for (((o, x), y), z) in out.iter_mut().zip(self.beta_p).zip(self.betad_p).zip(betadd_p) {
                    *o += a * x + b * y + c * z;
                }
            }
            None => {
                for ((o, x), y) in out.iter_mut().zip(self.beta_p).zip(self.betad_p) {
                    *o += a * x + b * y;
                }
            }
        }
    }

    /// Gradient of coordinate `index` of q (order 0) or of q̇ (order 1).
    pub(super) fn coordinate(&self, index: usize, order: usize, out: &mut [f64]) {
        let layout = self.layout;
        if index == self.d.unactuated {
            out.copy_from_slice(if order == 0 { self.beta_p } else { self.betad_p });
            return;
        }
        let j = if index < self.d.unactuated { index } else { index - 1 };
        out.fill(0.0);
        for (o, basis) in out[layout.joint(j, 0)..].iter_mut().zip(self.basis) {
            *o = basis[order];
        }
        out[layout.duration()] = self.by_duration[j][order];
    }
}
