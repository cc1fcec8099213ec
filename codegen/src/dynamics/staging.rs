//! Staging by binding time: Q(t) and Q̇(t) are known before β is.
//!
//! f1, f2 and σ̇ (eq. 8, 9) are split into what depends on (Q, Q̇) alone, evaluated once per instant,
//! and a remainder in sin β, cos β. Where the robot turns as a whole with β, f1 and f2 do not contain
//! it at all, and σ̇ = a cos β + b sin β: a pendulum; in flight σ̇ = 0, and β is an integral. The split finds this by itself, because angles
//! are split at β and the ring's law cancels what is common.

use super::kernel::Kernel;
use super::model::Model;
use super::turn::Turn;
use crate::expr::{Poly, Var};
use crate::mechanism::Mode;

/// Collects early expressions and hands out a symbol for each.
struct Early {
    symbols: Vec<Var>,
    values: Vec<Poly>,
}

impl Early {
    /// An expression in early symbols and sin β, cos β that equals `p`.
    fn stage(&mut self, model: &mut Model, p: &Poly) -> Poly {
        let beta = model.unactuated(0);
        let split = model.ring.split_angles(p, beta);
        let (sin, cos) = model.ring.sin_cos(&[beta]);
        let is_late = |v: Var| sin.contains(v) || cos.contains(v);
        let mut late = Poly::zero();
        for (monomial, early) in model.ring.staged(&split, is_late) {
            let coefficient = if model.ring.is_fixed(&early) { early } else { self.symbol(model, early) };
            late += &(&coefficient * &Poly::term(monomial, 1.0));
        }
        late
    }

    /// The symbol of an early expression; one that is known up to its sign is reused.
    fn symbol(&mut self, model: &mut Model, early: Poly) -> Poly {
        let negative = -&early;
        for (symbol, value) in self.symbols.iter().zip(&self.values) {
            if value.is_close_to(&early) {
                return (*symbol).into();
            }
            if value.is_close_to(&negative) {
                return Poly::from(*symbol).scaled(-1.0);
            }
        }
        let symbol = model.ring.symbol(format!("e{}", self.symbols.len()));
        self.symbols.push(symbol);
        self.values.push(early);
        symbol.into()
    }
}

pub fn kernels(model: &mut Model, mode: Mode, turn: &Turn) -> Vec<Kernel> {
    let beta = model.unactuated(0);
    let (prescribed, rates) = (model.prescribed(0), model.prescribed(1));
    let mut early = Early { symbols: Vec::new(), values: Vec::new() };
    let terms = [&turn.f1, &turn.f2, &turn.gravity_moment];
    let late: Vec<Poly> = terms.iter().map(|p| early.stage(model, p)).collect();
    let by_beta: Vec<Poly> = late.iter().map(|p| model.ring.derivative(p, beta)).collect();
    let mut gradient = |p: &Poly, by: &[Var]| -> Vec<Poly> {
        by.iter()
            .map(|s| {
                let derivative = model.ring.derivative(p, *s);
                early.stage(model, &derivative)
            })
            .collect()
    };
    let f1_q = gradient(&turn.f1, &prescribed);
    let f2_q = gradient(&turn.f2, &prescribed);
    let f2_qd = gradient(&turn.f2, &rates);
    let moment_q = gradient(&turn.gravity_moment, &prescribed);
    vec![
        Kernel::of_mode(
            mode,
            "early",
            "What eq. 8 and 9 and their gradients need of (Q, Q̇) alone; the late kernels take it.",
        )
        .input("actuated", prescribed)
        .input("actuated_d", rates)
        .vector("early", early.values.clone(), "early values")
        .measured(),
        Kernel::of_mode(mode, "late", "f1, f2 (eq. 8) and σ̇ (eq. 9) with their derivatives in β.")
            .input("early", early.symbols.clone())
            .scalar_input("beta", beta)
            .vector("value", late, "f1, f2, σ̇")
            .vector("by_beta", by_beta, "∂(f1, f2, σ̇)/∂β"),
        Kernel::of_mode(mode, "late_gradient", "Gradients of f1, f2 (eq. 8) and σ̇ (eq. 9) in Q and Q̇.")
            .input("early", early.symbols)
            .scalar_input("beta", beta)
            .vector("f1_q", f1_q, "∂f1/∂Q")
            .vector("f2_q", f2_q, "∂f2/∂Q")
            .vector("f2_qd", f2_qd, "∂f2/∂Q̇")
            .vector("moment_q", moment_q, "∂σ̇/∂Q"),
    ]
}
