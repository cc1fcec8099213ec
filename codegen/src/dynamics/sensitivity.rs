//! Gradients in the lumped parameters of a family: what sensitivities of an optimum need of the dynamics.
//!
//! As in `curvature`, all that an instant or a touchdown gives enters one sum with a weight for each, so
//! that one gradient serves every multiplier, and unit weights give the partial derivatives themselves.

use super::curvature::Instant;
use super::kernel::{Block, Kernel};
use super::lumps::Lumps;
use super::model::Model;
use super::transition::Results;
use super::turn::Turn;
use crate::expr::{Poly, Var};
use crate::mechanism::{Mode, Transition};
use std::collections::BTreeMap;

/// A weighted sum of which a kernel will give the gradient.
pub struct Weighted {
    kernel: Kernel,
    sum: Poly,
    /// What is held in the derivative and inserted afterwards.
    held: BTreeMap<Var, Poly>,
}

/// The weighted sums of all modes and transitions.
pub fn weighted(model: &mut Model) -> Vec<Weighted> {
    let mut all = Vec::new();
    for mode in model.mechanism.modes.clone() {
        let turn = Turn::new(model, mode);
        all.extend([instant(model, mode, &turn), terms(model, mode, &turn)]);
        let into: Vec<Transition> = model.mechanism.transitions.iter().filter(|t| t.to == mode).copied().collect();
        all.extend(into.into_iter().map(|transition| of_transition(model, transition)));
    }
    all
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

fn instant(model: &mut Model, mode: Mode, turn: &Turn) -> Weighted {
    let instant = Instant::new(model, mode, turn);
    let kernel = Kernel::of_mode(
        mode,
        "sensitivity",
        "Gradient in the lumped parameters of the sum of all outputs of an instant, with the weights of the curvature's kernel.",
    );
    Weighted { kernel: instant.inputs(model, kernel), sum: instant.sum, held: BTreeMap::new() }
}

/// f1, f2 and c one by one.
fn terms(model: &mut Model, mode: Mode, turn: &Turn) -> Weighted {
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
    let kernel = Kernel::of_mode(
        mode,
        "terms_sensitivity",
        "Gradient in the lumped parameters of the weighted sum of f1, f2 (eq. 8) and the lever arm c (eq. 9).",
    )
    .input("q", model.q(0))
    .input("qd", model.q(1))
    .blocks("weights", weights, ["f1", "f2", "c"].map(Block::scalar).to_vec());
    Weighted { kernel, sum, held: BTreeMap::new() }
}

/// The weighted sum of what a transition does.
fn of_transition(model: &mut Model, transition: Transition) -> Weighted {
    let results = Results::new(model, transition);
    let kernel = Kernel::of_transition(
        transition,
        "_sensitivity",
        "Gradient in the lumped parameters of what a transition does, with the weights of its curvature's kernel.",
    );
    let kernel = kernel.inputs(results.inputs);
    Weighted { kernel, sum: results.sum, held: results.solution }
}
