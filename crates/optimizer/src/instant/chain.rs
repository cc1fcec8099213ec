//! From derivatives in the state of an instant to derivatives in the parameters of its phase, and back.
//!
//! The *state* of an instant is q, q̇, q̈ and, because some quantities depend on them directly, the parameters from the duration on.
//! A weighted sum of many gradients is taken there, where they are short, and pulled to the parameters once.

use super::Instants;
use crate::flow::{Flow, Layout};
use piaffe_model::Description;
use piaffe_sqp::dot;

/// The chain rule at one node.
pub struct Chain<'a> {
    d: &'a Description,
    layout: Layout,
    /// Derivatives of Q, Q̇, Q̈ in each of their parameters, and in T for each coordinate.
    pub basis: &'a [[f64; 3]],
    pub by_duration: &'a [[f64; 3]],
    /// Gradients of β, β̇, β̈ in the parameters.
    pub unactuated: [&'a [f64]; 3],
}

impl<'a> Chain<'a> {
    /// `betadd` is the gradient of β̈, if it is known.
    pub(super) fn new(
        instants: &'a Instants,
        d: &'a Description,
        flow: &'a Flow,
        node: usize,
        betadd: &'a [f64],
    ) -> Chain<'a> {
        let layout = instants.layout;
        let own = layout.len() * node..layout.len() * (node + 1);
        Chain {
            d,
            layout,
            basis: &instants.basis[node * layout.per_joint..][..layout.per_joint],
            by_duration: &instants.by_duration[node * layout.prescribed..][..layout.prescribed],
            unactuated: [&flow.beta_p[own.clone()], &flow.betad_p[own], betadd],
        }
    }

    /// `out` ← Uᵀ·state, U = ∂state/∂parameters.
    pub fn pull(&self, state: &[f64], out: &mut [f64]) {
        self.pull_explicit(state, out);
        let c = state[2 * self.d.orientations() + self.d.unactuated];
        out.iter_mut().zip(self.unactuated[2]).for_each(|(out, by)| *out += c * by);
    }

    /// The same but for what depends on β̈.
    pub(super) fn pull_explicit(&self, state: &[f64], out: &mut [f64]) {
        let (nq, beta) = (self.d.orientations(), self.d.unactuated);
        let (prescribed, direct) = out.split_at_mut(self.layout.duration());
        direct.copy_from_slice(&state[3 * nq..]);
        let [q, qd, qdd] = [0, 1, 2].map(|order| &state[order * nq..(order + 1) * nq]);
        for (j, out) in prescribed.chunks_exact_mut(self.basis.len()).enumerate() {
            let index = self.d.prescribed_index(j);
            let (a, b, c) = (q[index], qd[index], qdd[index]);
            for (out, basis) in out.iter_mut().zip(self.basis) {
                *out = a * basis[0] + b * basis[1] + c * basis[2];
            }
            let t = self.by_duration[j];
            direct[0] += a * t[0] + b * t[1] + c * t[2];
        }
        let (a, b) = (q[beta], qd[beta]);
        for ((out, x), y) in out.iter_mut().zip(self.unactuated[0]).zip(self.unactuated[1]) {
            *out += a * x + b * y;
        }
    }

    /// `state` ← U·local.
    pub fn push(&self, local: &[f64], state: &mut [f64]) {
        let nq = self.d.orientations();
        let (prescribed, direct) = local.split_at(self.layout.duration());
        for (j, own) in prescribed.chunks_exact(self.basis.len()).enumerate() {
            let mut sums = self.by_duration[j].map(|by| by * direct[0]);
            for (basis, x) in self.basis.iter().zip(own) {
                sums.iter_mut().zip(basis).for_each(|(sum, basis)| *sum += basis * x);
            }
            let index = self.d.prescribed_index(j);
            sums.iter().enumerate().for_each(|(order, sum)| state[order * nq + index] = *sum);
        }
        for (order, by) in self.unactuated.iter().enumerate() {
            state[order * nq + self.d.unactuated] = dot(by, local);
        }
        state[3 * nq..].copy_from_slice(direct);
    }
}
