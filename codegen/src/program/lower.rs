//! Lowering: the atoms that a kernel reaches become nodes, its expressions sums over them.

use super::divisor::Factors;
use super::{Id, Node, Program, Sum, Term};
use crate::dynamics::Kernel;
use crate::expr::{Kind, Poly, Ring, Var};
use std::collections::BTreeMap;

struct Lowering<'a> {
    ring: &'a Ring,
    program: Program,
    /// Nodes of atoms, of sines and of cosines.
    known: [Vec<Option<Id>>; 3],
    /// Arguments of sines and cosines, so that a pair shares one.
    arguments: BTreeMap<Vec<Var>, usize>,
}

pub fn lower(ring: &Ring, kernel: &Kernel) -> Program {
    let mut lowering = Lowering {
        ring,
        program: Program { nodes: Vec::new(), sums: Vec::new(), outputs: Vec::new() },
        known: [const { Vec::new() }; 3],
        arguments: BTreeMap::new(),
    };
    for (i, input) in kernel.inputs.iter().enumerate() {
        for (k, symbol) in input.symbols.iter().enumerate() {
            let id = lowering.node(Node::Input(i, k));
            lowering.remember(*symbol, id);
        }
    }
    for output in &kernel.outputs {
        let sums = output.values.iter().map(|p| lowering.sum(p)).collect();
        lowering.program.outputs.push(sums);
    }
    lowering.program
}

impl Lowering<'_> {
    fn node(&mut self, node: Node) -> Id {
        self.program.nodes.push(node);
        (self.program.nodes.len() - 1) as Id
    }

    fn sum(&mut self, p: &Poly) -> usize {
        let mut sum: Sum = Vec::with_capacity(p.len());
        for (monomial, coefficient) in p.terms() {
            let mut factors = Factors::with_capacity(monomial.len());
            monomial.iter().for_each(|v| factors.push(self.atom(*v)));
            factors.sort_unstable();
            sum.push(Term { coefficient, factors });
        }
        sum.sort_by(|a, b| a.factors.cmp(&b.factors));
        // Structurally equal sums are one sum.
        if let Some(same) = self.program.sums.iter().position(|s| *s == sum) {
            return same;
        }
        self.program.sums.push(sum);
        self.program.sums.len() - 1
    }

    fn atom(&mut self, var: Var) -> Id {
        let (kind, index) = var.place();
        if let Some(Some(id)) = self.known[kind].get(index) {
            return *id;
        }
        let node = match self.ring.kind(var) {
            Kind::Sin(angle) => Node::Sin(self.argument(angle)),
            Kind::Cos(angle) => Node::Cos(self.argument(angle)),
            Kind::Bound(definition) => Node::Value(self.sum(&definition)),
            Kind::Reciprocal(definition) => Node::Reciprocal(self.sum(&definition)),
            // A symbol that is no input of the kernel is a mistake in its derivation.
            Kind::Symbol(name) => unreachable!("the kernel does not take `{name}`"),
        };
        let id = self.node(node);
        self.remember(var, id);
        id
    }

    fn remember(&mut self, var: Var, id: Id) {
        let (kind, index) = var.place();
        let known = &mut self.known[kind];
        known.resize(known.len().max(index + 1), None);
        known[index] = Some(id);
    }

    fn argument(&mut self, angle: Vec<Var>) -> usize {
        if let Some(sum) = self.arguments.get(&angle) {
            return *sum;
        }
        let mut p = Poly::zero();
        for v in &angle {
            p += &(*v).into();
        }
        let sum = self.sum(&p);
        self.arguments.insert(angle, sum);
        sum
    }
}
