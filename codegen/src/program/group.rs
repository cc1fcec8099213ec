//! Terms that go together: what occurs in the same sums in the same proportion is a sum of its own.
//!
//! In relative coordinates the force of a joint is part of the force of the joint before it, row and
//! column of a matrix repeat parts of each other, and a Jacobian repeats its function. Greedy divisors
//! see two terms at a time and may cut such a common part differently in each place.

use super::divisor::{Factors, exact, rounded};
use super::{Id, Node, Program, Term};
use std::collections::BTreeMap;

/// Which sums a term is in, and its coefficient there beside that in the first of them.
type Signature = Vec<(usize, u64)>;

/// A term of a group: its factors and its coefficient in each of the signature's sums.
type Member = (Factors, Vec<f64>);

/// The groups of a program's terms.
pub struct Groups(Vec<(Signature, Vec<Member>)>);

impl Groups {
    pub fn new(program: &Program) -> Groups {
        let terms = program.sums.iter().enumerate().flat_map(|(s, sum)| sum.iter().map(move |t| (s, t)));
        let mut terms: Vec<(usize, &Term)> = terms.collect();
        terms.sort_by(|(s, a), (r, b)| a.factors.cmp(&b.factors).then(s.cmp(r)));
        let mut groups: BTreeMap<Signature, Vec<Member>> = BTreeMap::new();
        for places in terms.chunk_by(|(_, a), (_, b)| a.factors == b.factors).filter(|places| places.len() > 1) {
            let first = places[0].1;
            let signature = places.iter().map(|(s, t)| (*s, rounded(t.coefficient / first.coefficient))).collect();
            let member = (first.factors.clone(), places.iter().map(|(_, t)| t.coefficient).collect());
            groups.entry(signature).or_default().push(member);
        }
        Groups(groups.into_iter().collect())
    }

    /// How many groups have at least `least` members.
    pub fn count(&self, least: usize) -> usize {
        self.0.iter().filter(|(_, members)| members.len() >= least).count()
    }

    /// The program with every group of at least `least` members computed once.
    pub fn apply(&self, program: &Program, least: usize) -> Program {
        let mut result = program.clone();
        for (signature, members) in self.0.iter().filter(|(_, members)| members.len() >= least) {
            let unit = rounded(1.0);
            let whole = signature.iter().find(|(s, ratio)| *ratio == unit && program.sums[*s].len() == members.len());
            let sum = whole.map_or(result.sums.len(), |(s, _)| *s);
            if whole.is_none() {
                let term = |(factors, c): &Member| Term { coefficient: c[0], factors: factors.clone() };
                result.sums.push(members.iter().map(term).collect());
            }
            let node = node_of(&mut result, sum);
            for (place, (s, _)) in signature.iter().enumerate().filter(|(_, (s, _))| *s != sum) {
                let coefficient = exact(members[0].1[place] / members[0].1[0]);
                let terms = &mut result.sums[*s];
                terms.retain(|t| members.binary_search_by(|(factors, _)| factors.cmp(&t.factors)).is_err());
                terms.push(Term { coefficient, factors: Factors::from_slice(&[node]) });
            }
        }
        result
    }
}

/// The node with the value of a sum.
fn node_of(program: &mut Program, sum: usize) -> Id {
    let known = program.nodes.iter().position(|n| *n == Node::Value(sum));
    known.unwrap_or_else(|| {
        program.nodes.push(Node::Value(sum));
        program.nodes.len() - 1
    }) as Id
}
