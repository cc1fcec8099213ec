//! Lumped parameters: what a family of robots needs of its parameters, evaluated once per robot.
//!
//! Parameters are known before anything moves. So every expression is split by binding time, as
//! `staging` splits it at β: a sum over what moves, with coefficients in the parameters alone. Each
//! different coefficient becomes a symbol. What runs at every instant then has the size that it has with
//! numbers, and gradients in so few symbols, in which most is linear, are cheap.

use super::kernel::Kernel;
use super::model::Model;
use crate::expr::{Monomial, Poly, Ring, Var};
use std::collections::{BTreeMap, BTreeSet};

/// Name of the input that holds the lumped parameters.
pub const LUMPS: &str = "lumps";
/// Name of the input that holds the parameters.
pub const PARAMETERS: &str = "parameters";

/// The lumped parameters of one gait.
#[derive(Debug, Default)]
pub struct Lumps {
    pub symbols: Vec<Var>,
    /// What each stands for, in the parameters.
    pub values: Vec<Poly>,
    /// Symbols whose values have the same monomials.
    alike: BTreeMap<Vec<Monomial>, Vec<usize>>,
    /// Atoms whose definitions are rewritten.
    rewritten: BTreeSet<Var>,
}

impl Lumps {
    /// The same expression with lumped parameters as coefficients, in the definitions of its atoms too.
    pub fn rewrite(&mut self, ring: &mut Ring, p: &Poly) -> Poly {
        let mut result = Poly::zero();
        for (moving, coefficient) in ring.by_motion(p) {
            for atom in &moving {
                self.rewrite_definition(ring, *atom);
            }
            result += &(&self.lump(ring, coefficient) * &Poly::term(moving, 1.0));
        }
        result
    }

    fn rewrite_definition(&mut self, ring: &mut Ring, atom: Var) {
        if self.rewritten.insert(atom)
            && let Some(definition) = ring.definition(atom)
        {
            let rewritten = self.rewrite(ring, &definition);
            ring.redefine(atom, rewritten);
        }
    }

    /// What makes them of the parameters, once per robot.
    pub fn kernel(&self, model: &Model) -> Kernel {
        of_parameters(model, "lumps", "The lumped parameters of a robot: what the other kernels need of it.").vector(
            "lumps",
            self.values.clone(),
            "lumped parameters",
        )
    }

    /// How they depend on the parameters.
    pub fn jacobian(&self, model: &Model) -> Kernel {
        of_parameters(model, "lumps_jacobian", "Jacobian of the lumped parameters in the parameters.").matrix(
            "jacobian",
            model.jacobian(&self.values, &model.parameters),
            "∂lumps/∂parameters",
        )
    }

    /// The symbol of a coefficient, times a number.
    fn lump(&mut self, ring: &mut Ring, coefficient: Poly) -> Poly {
        if coefficient.as_constant().is_some() {
            return coefficient;
        }
        let leading = coefficient.terms().next().map_or(1.0, |(_, c)| c);
        let value = coefficient.scaled(1.0 / leading);
        let alike = self.alike.entry(value.terms().map(|(m, _)| m.clone()).collect()).or_default();
        let known = alike.iter().copied().find(|i| self.values[*i].is_close_to(&value));
        let number = known.unwrap_or_else(|| {
            alike.push(self.symbols.len());
            self.symbols.push(ring.symbol(format!("k{}", self.symbols.len())));
            self.values.push(value);
            self.symbols.len() - 1
        });
        Poly::from(self.symbols[number]).scaled(leading)
    }
}

/// The mechanism's numbers from the parameters.
pub fn numbers(model: &Model) -> Kernel {
    of_parameters(model, "numbers", "The numbers of the robot's mechanism, in the order of its description.").vector(
        "numbers",
        model.quantities.numbers.clone(),
        "numbers",
    )
}

fn of_parameters(model: &Model, name: &str, doc: &str) -> Kernel {
    Kernel::new(name, doc).input(PARAMETERS, model.parameters.clone())
}
