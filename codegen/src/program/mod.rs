//! From expressions to straight-line programs: factoring, common subexpressions, scheduling, counts.

mod divisor;
mod factor;
mod group;
mod lower;
mod market;
mod steps;

pub use factor::Search;
pub use steps::{Sine, Step, terms};

use crate::dynamics::Kernel;
use crate::expr::Ring;
use crate::math::sin_cos;
use crate::turns::in_turn;
use group::Groups;
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Index of a node.
pub type Id = u32;

/// `coefficient · product of nodes`, nodes sorted.
#[derive(Debug, PartialEq)]
pub struct Term {
    pub coefficient: f64,
    pub factors: SmallVec<[Id; 6]>,
}

impl Clone for Term {
    /// Copies the factors at once; a `SmallVec` clones them one by one.
    fn clone(&self) -> Term {
        Term { coefficient: self.coefficient, factors: SmallVec::from_slice(&self.factors) }
    }
}

/// A sum of terms.
pub type Sum = Vec<Term>;

/// How a node gets its value. Sums are referred to by index into `Program::sums`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// Element of an input: (input, element).
    Input(usize, usize),
    Sin(usize),
    Cos(usize),
    Value(usize),
    Reciprocal(usize),
}

/// A kernel as sums over nodes.
#[derive(Clone, Debug)]
pub struct Program {
    pub nodes: Vec<Node>,
    pub sums: Vec<Sum>,
    /// Index into `sums` of each output value, output by output.
    pub outputs: Vec<Vec<usize>>,
}

/// Floating-point operations of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions, subtractions and multiplications.
    pub flops: usize,
    pub divisions: usize,
    /// Pairs of sine and cosine.
    pub sincos: usize,
}

impl Node {
    /// The sum that it is computed from.
    pub fn sum(self) -> Option<usize> {
        match self {
            Node::Input(..) => None,
            Node::Sin(s) | Node::Cos(s) | Node::Value(s) | Node::Reciprocal(s) => Some(s),
        }
    }
}

impl Term {
    /// Multiplications to evaluate it.
    pub fn cost(&self) -> usize {
        match self.factors.len() {
            0 => 0,
            n => n - 1 + usize::from(self.coefficient.abs() != 1.0),
        }
    }
}

/// Least sizes of the groups that are computed once before factoring: no size is best for all kernels.
const LEAST_GROUP: [usize; 7] = [7, 4, 6, usize::MAX, 9, 2, 3];

/// Pairs of terms that attempts may look at, the first one apart: a bound on the time that a kernel takes.
const PAIRS: usize = 3_000;

/// The program of each kernel, in order, with what it would cost as derived.
pub fn programs(ring: &Ring, kernels: &[Kernel]) -> Vec<(Program, Operations)> {
    let make = |search: &mut Search, kernel| {
        let derived = Program::as_derived(ring, kernel);
        (derived.factored(search), derived.operations())
    };
    in_turn(kernels, |kernel| Reverse(kernel.pairs()), Search::default, make)
}

impl Program {
    /// Lowers a kernel and factors it.
    pub fn new(ring: &Ring, kernel: &Kernel) -> Program {
        Program::as_derived(ring, kernel).factored(&mut Search::default())
    }

    /// Lowers a kernel as it was derived: what is factored from it is measured against this.
    pub fn as_derived(ring: &Ring, kernel: &Kernel) -> Program {
        lower::lower(ring, kernel)
    }

    /// Factors it in several ways; the one with the fewest operations stays.
    pub fn factored(&self, search: &mut Search) -> Program {
        let groups = Groups::new(self);
        let mut tried = Vec::new();
        let mut pairs = 0;
        let mut best: Option<(usize, Program)> = None;
        for least in LEAST_GROUP {
            let count = groups.count(least);
            if tried.contains(&count) {
                continue;
            }
            tried.push(count);
            let more = groups.pairs(self, least);
            if best.is_some() && pairs + more > PAIRS {
                continue;
            }
            pairs += more;
            let mut program = groups.apply(self, least);
            search.factor(&mut program);
            let flops = program.operations().flops;
            if best.as_ref().is_none_or(|(least, _)| flops < *least) {
                best = Some((flops, program));
            }
        }
        best.map_or_else(|| self.clone(), |(_, program)| program)
    }

    /// Nodes in an order in which each comes after all that it needs; unused ones are left out.
    pub fn schedule(&self) -> Vec<Id> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut state = vec![false; self.nodes.len()];
        for sum in self.outputs.iter().flatten() {
            self.visit_sum(*sum, &mut state, &mut order);
        }
        order
    }

    /// The same with all sines and cosines side by side, as early as their angles are known.
    pub fn schedule_sines_first(&self) -> Vec<Id> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut state = vec![false; self.nodes.len()];
        let is_sine = |id: &Id| matches!(self.nodes[*id as usize], Node::Sin(_) | Node::Cos(_));
        let sines: Vec<Id> = self.schedule().into_iter().filter(is_sine).collect();
        for sum in sines.iter().filter_map(|id| self.nodes[*id as usize].sum()) {
            self.visit_sum(sum, &mut state, &mut order);
        }
        for id in sines {
            if !std::mem::replace(&mut state[id as usize], true) {
                order.push(id);
            }
        }
        for sum in self.outputs.iter().flatten() {
            self.visit_sum(*sum, &mut state, &mut order);
        }
        order
    }

    fn visit_sum(&self, sum: usize, seen: &mut [bool], order: &mut Vec<Id>) {
        for id in self.sums[sum].iter().flat_map(|t| &t.factors) {
            if seen[*id as usize] {
                continue;
            }
            seen[*id as usize] = true;
            if let Some(sum) = self.nodes[*id as usize].sum() {
                self.visit_sum(sum, seen, order);
            }
            order.push(*id);
        }
    }

    /// Operation counts of the program as it is emitted.
    pub fn operations(&self) -> Operations {
        let mut count = Operations::default();
        let mut counted = vec![false; self.sums.len()];
        let sum_cost = |s: usize| -> usize {
            let sum = &self.sums[s];
            sum.iter().map(Term::cost).sum::<usize>() + sum.len().saturating_sub(1)
        };
        for id in self.schedule() {
            match self.nodes[id as usize] {
                Node::Input(..) => {}
                Node::Value(s) => count.flops += sum_cost(s),
                Node::Reciprocal(s) => {
                    count.flops += sum_cost(s);
                    count.divisions += 1;
                }
                Node::Sin(s) | Node::Cos(s) => {
                    if !std::mem::replace(&mut counted[s], true) {
                        count.flops += sum_cost(s);
                        count.sincos += 1;
                    }
                }
            }
        }
        counted.fill(false);
        for s in self.outputs.iter().flatten() {
            if !std::mem::replace(&mut counted[*s], true) {
                count.flops += sum_cost(*s);
            }
        }
        count
    }

    /// Interprets the program: for tests. `inputs[i][k]` is element k of input i.
    pub fn evaluate(&self, inputs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut values: BTreeMap<Id, f64> = BTreeMap::new();
        let sum = |values: &BTreeMap<Id, f64>, s: usize| -> f64 {
            self.sums[s].iter().map(|t| t.factors.iter().fold(t.coefficient, |p, id| p * values[id])).sum()
        };
        for id in self.schedule() {
            let value = match self.nodes[id as usize] {
                Node::Input(i, k) => inputs[i][k],
                Node::Sin(s) => sin_cos(sum(&values, s)).0,
                Node::Cos(s) => sin_cos(sum(&values, s)).1,
                Node::Value(s) => sum(&values, s),
                Node::Reciprocal(s) => 1.0 / sum(&values, s),
            };
            values.insert(id, value);
        }
        self.outputs.iter().map(|list| list.iter().map(|s| sum(&values, *s)).collect()).collect()
    }
}
