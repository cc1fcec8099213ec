//! Terms that go together: what occurs in the same sums in the same proportion is a sum of its own.
//!
//! In relative coordinates the force of a joint is part of the force of the joint before it, row and
//! column of a matrix repeat parts of each other, and a Jacobian repeats its function. Greedy divisors
//! see two terms at a time and may cut such a common part differently in each place.

use super::divisor::{Factors, exact, hash_of, rounded};
use super::{Id, Node, Program, Sum, Term};
use std::collections::BTreeMap;

/// Which sums a term is in, and its coefficient there beside that in the first of them.
type Signature = Vec<(usize, u64)>;

/// A term of a group: its factors, and its coefficient and index in each of the signature's sums.
struct Member {
    factors: Factors,
    places: Vec<(f64, usize)>,
}

/// The groups of a program's terms.
pub struct Groups(Vec<(Signature, Vec<Member>)>);

impl Groups {
    pub fn new(program: &Program) -> Groups {
        // Where like terms are: those with equal hashes, sum by sum.
        let mut terms: Vec<(u64, usize, usize)> = Vec::with_capacity(program.sums.iter().map(Vec::len).sum());
        for (s, sum) in program.sums.iter().enumerate() {
            terms.extend(sum.iter().enumerate().map(|(i, t)| (hash_of(&t.factors), s, i)));
        }
        terms.sort_unstable();
        let term = |(_, s, i): &(u64, usize, usize)| &program.sums[*s][*i];
        let mut groups: BTreeMap<Signature, Vec<Member>> = BTreeMap::new();
        let alike = terms.chunk_by(|a, b| a.0 == b.0 && term(a).factors == term(b).factors);
        for places in alike.filter(|places| places.len() > 1) {
            let first = term(&places[0]);
            let ratio = |at| rounded(term(at).coefficient / first.coefficient);
            let signature = places.iter().map(|at| (at.1, ratio(at))).collect();
            let places = places.iter().map(|at| (term(at).coefficient, at.2)).collect();
            groups.entry(signature).or_default().push(Member { factors: Factors::from_slice(&first.factors), places });
        }
        groups.values_mut().for_each(|members| members.sort_by(|a, b| a.factors.cmp(&b.factors)));
        Groups(groups.into_iter().collect())
    }

    /// How many groups have at least `least` members.
    pub fn count(&self, least: usize) -> usize {
        self.0.iter().filter(|(_, members)| members.len() >= least).count()
    }

    /// Pairs of terms in the sums that [`apply`](Groups::apply) leaves.
    pub fn pairs(&self, program: &Program, least: usize) -> usize {
        let mut lengths: Vec<usize> = program.sums.iter().map(Vec::len).collect();
        for (signature, members) in self.0.iter().filter(|(_, members)| members.len() >= least) {
            signature.iter().for_each(|(s, _)| lengths[*s] = lengths[*s] + 1 - members.len());
            lengths.push(members.len());
        }
        lengths.iter().map(|length| length * length / 2).sum()
    }

    /// The program with every group of at least `least` members computed once.
    pub fn apply(&self, program: &Program, least: usize) -> Program {
        let (nodes, outputs) = (program.nodes.clone(), program.outputs.clone());
        let mut result = Program { nodes, sums: Vec::with_capacity(program.sums.len()), outputs };
        let mut gone: Vec<Vec<bool>> = program.sums.iter().map(|sum| vec![false; sum.len()]).collect();
        let mut nodes: Vec<Sum> = vec![Sum::new(); program.sums.len()];
        let mut groups = Vec::new();
        for (signature, members) in self.0.iter().filter(|(_, members)| members.len() >= least) {
            let unit = rounded(1.0);
            let whole = signature.iter().find(|(s, ratio)| *ratio == unit && program.sums[*s].len() == members.len());
            let sum = whole.map_or(program.sums.len() + groups.len(), |(s, _)| *s);
            if whole.is_none() {
                let term = |m: &Member| Term { coefficient: m.places[0].0, factors: Factors::from_slice(&m.factors) };
                groups.push(members.iter().map(term).collect());
            }
            let node = node_of(&mut result, sum);
            for (place, (s, _)) in signature.iter().enumerate().filter(|(_, (s, _))| *s != sum) {
                members.iter().for_each(|m| gone[*s][m.places[place].1] = true);
                let coefficient = exact(members[0].places[place].0 / members[0].places[0].0);
                nodes[*s].push(Term { coefficient, factors: Factors::from_slice(&[node]) });
            }
        }
        for ((terms, gone), nodes) in program.sums.iter().zip(gone).zip(nodes) {
            let kept = terms.iter().zip(gone).filter(|(_, gone)| !gone).map(|(term, _)| term.clone());
            let mut sum = Sum::with_capacity(terms.len() + nodes.len());
            sum.extend(kept.chain(nodes));
            result.sums.push(sum);
        }
        result.sums.extend(groups);
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
