//! Gradients in the lumped parameters of a family: what sensitivities of an optimum need of the dynamics.
//!
//! As in `curvature`, all that an instant or a touchdown gives enters one sum with a weight for each, so
//! that one gradient serves every multiplier, and unit weights give the partial derivatives themselves.

use super::curvature::{Instant, Landing};
use super::kernel::Kernel;
use super::lumps::Lumps;
use super::model::Model;
use super::turn::Turn;
use crate::expr::{Poly, Var};
use std::collections::BTreeMap;

/// A weighted sum of which a kernel will give the gradient.
pub struct Weighted {
    kernel: Kernel,
    sum: Poly,
    /// What is held in the derivative and inserted afterwards.
    held: BTreeMap<Var, Poly>,
}

/// The weighted sums of stance on `leg`, and of the impact on `leg`.
pub fn weighted(model: &mut Model, leg: usize) -> Vec<Weighted> {
    let turn = Turn::new(model, leg);
    vec![instant(model, leg, &turn), terms(model, leg, &turn), touchdown(model, leg)]
}

impl Weighted {
    /// The same sum of lumped parameters.
    pub fn lumped(self, model: &mut Model, lumps: &mut Lumps) -> Weighted {
        let mut rewrite = |p: &Poly| lumps.rewrite(&mut model.ring, p);
        Weighted {
            kernel: self.kernel,
            sum: rewrite(&self.sum),
            held: self.held.iter().map(|(v, p)| (*v, rewrite(p))).collect(),
        }
    }

    /// The kernel with the gradient of the sum in all lumped parameters.
    pub fn gradient(self, model: &mut Model, lumps: &Lumps) -> Kernel {
        let mut by = |k: &Var| {
            let derivative = model.ring.derivative(&self.sum, *k);
            model.ring.substitute(&derivative, &self.held)
        };
        let gradient = lumps.symbols.iter().map(&mut by).collect();
        self.kernel.vector("by_lump", gradient, "gradient in the lumped parameters")
    }
}

fn instant(model: &mut Model, leg: usize, turn: &Turn) -> Weighted {
    let Instant { n, phi, others, sum } = Instant::new(model, leg, turn);
    let kernel = Kernel::new(
        format!("sensitivity{}", leg + 1),
        "Gradient in the lumped parameters of the sum of all outputs of an instant, with the weights of the curvature's kernel.",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("qdd", model.q(2))
    .input("n", n)
    .input("phi", phi)
    .input("others", others);
    Weighted { kernel, sum, held: BTreeMap::new() }
}

/// f1, f2 and c one by one.
fn terms(model: &mut Model, leg: usize, turn: &Turn) -> Weighted {
    let mut sum = Poly::zero();
    let weights: Vec<Var> = [&turn.f1, &turn.f2, &turn.c]
        .into_iter()
        .enumerate()
        .map(|(k, term)| {
            let weight = model.ring.symbol(format!("w{k}"));
            sum += &(&Poly::from(weight) * term);
            weight
        })
        .collect();
    let kernel = Kernel::new(
        format!("terms_sensitivity{}", leg + 1),
        "Gradient in the lumped parameters of the weighted sum of f1, f2 (eq. 8) and the lever arm c (eq. 9).",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("weights", weights);
    Weighted { kernel, sum, held: BTreeMap::new() }
}

fn touchdown(model: &mut Model, leg: usize) -> Weighted {
    let Landing { xi, outputs, sum, solution, .. } = Landing::new(model, leg);
    let kernel = Kernel::new(
        format!("touchdown_sensitivity{}", leg + 1),
        "Gradient in the lumped parameters of a touchdown's results, with the weights of the touchdown curvature's kernel.",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .input("xi", xi)
    .input("outputs", outputs);
    Weighted { kernel, sum, held: solution }
}
