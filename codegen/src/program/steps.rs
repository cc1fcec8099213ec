//! A program as a straight line: what is computed, step after step, and in which order a sum adds its terms. Code is written from
//! it, and whoever evaluates a program as it stands takes the same steps: both have the same bits.

use super::{Id, Node, Program, Sum, Term};

/// Sine and cosine of a sum, as far as anything needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    pub argument: usize,
    pub sin: Option<Id>,
    pub cos: Option<Id>,
}

/// Gives nodes their values. Sums are those of the program, by index.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    Value(Id, usize),
    Reciprocal(Id, usize),
    Sines(Vec<Sine>),
}

impl Program {
    /// What to do before the outputs' sums are known.
    pub fn steps(&self) -> Vec<Step> {
        let order = self.schedule_sines_first();
        let mut sines = self.sines(&order);
        let step = |id: &Id| match self.nodes[*id as usize] {
            Node::Input(..) => None,
            Node::Value(sum) => Some(Step::Value(*id, sum)),
            Node::Reciprocal(sum) => Some(Step::Reciprocal(*id, sum)),
            // They follow one another: with the first, all are known.
            Node::Sin(_) | Node::Cos(_) => (!sines.is_empty()).then(|| Step::Sines(std::mem::take(&mut sines))),
        };
        order.iter().filter_map(step).collect()
    }

    fn sines(&self, order: &[Id]) -> Vec<Sine> {
        let mut sines: Vec<Sine> = Vec::new();
        for id in order {
            let (Node::Sin(argument) | Node::Cos(argument)) = self.nodes[*id as usize] else { continue };
            let known = sines.iter().position(|sine| sine.argument == argument);
            let k = known.unwrap_or_else(|| {
                sines.push(Sine { argument, sin: None, cos: None });
                sines.len() - 1
            });
            match self.nodes[*id as usize] {
                Node::Sin(_) => sines[k].sin = Some(*id),
                _ => sines[k].cos = Some(*id),
            }
        }
        sines
    }
}

/// The terms of a sum, in the order in which they are added. A positive one first spares a negation.
pub fn terms(sum: &Sum) -> impl Iterator<Item = &Term> {
    let first = sum.iter().position(|t| t.coefficient > 0.0).unwrap_or(0);
    let others = sum.iter().enumerate().filter(move |(i, _)| *i != first).map(|(_, t)| t);
    sum.get(first).into_iter().chain(others)
}

impl Term {
    /// What its product begins with, if not with its first factor: its coefficient without a sign.
    pub fn number(&self) -> Option<f64> {
        let size = self.coefficient.abs();
        (size != 1.0 || self.factors.is_empty()).then_some(size)
    }
}
