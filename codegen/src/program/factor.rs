//! Factoring and common subexpressions of many sums at once.
//!
//! Greedy extraction of *divisors*, after the two-term method of Hosangadi, Fallah and Kastner
//! (2006) for polynomials: a divisor is a sum of two terms up to a common factor, `a + ρ b`; a
//! product of two nodes; or a scaled node, `k·a`. The divisor that saves most operations over all
//! sums becomes a node of its own, and the search goes on until none saves any.

use super::{Id, Node, Program, Sum, Term};
use smallvec::SmallVec;
use std::collections::{BTreeSet, BinaryHeap, HashMap};
use std::hash::{BuildHasherDefault, DefaultHasher};

type Factors = SmallVec<[Id; 6]>;
/// A hasher without a random seed: same input, same program.
type Map<K, V> = HashMap<K, V, BuildHasherDefault<DefaultHasher>>;

/// Sums longer than this only pair terms that share a factor.
const LONG: usize = 80;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Divisor {
    /// `first + ratio · second`.
    Pair { first: Factors, second: Factors, ratio: Number },
    /// Product of two nodes.
    Product(Id, Id),
    /// A node times a positive number.
    Scaled(Id, Number),
}

/// A coefficient as an ordered key: its bits, less the last few, which are rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Number(u64);

impl Number {
    const NOISE: u32 = 8;

    fn new(value: f64) -> Number {
        Number((value.to_bits() + (1 << (Number::NOISE - 1))) >> Number::NOISE)
    }
}

#[derive(Default)]
struct Candidate {
    /// Operations saved if all occurrences are replaced, less what the divisor costs.
    gain: i64,
    sums: BTreeSet<usize>,
}

struct Search<'a> {
    program: &'a mut Program,
    candidates: Map<Divisor, Candidate>,
    /// What each sum contributes, to take it back when the sum changes.
    contributions: Vec<Vec<(Divisor, i64)>>,
    queue: BinaryHeap<(i64, std::cmp::Reverse<Divisor>)>,
}

/// Rewrites the sums of `program` over shared new nodes.
pub fn factor(program: &mut Program) {
    let count = program.sums.len();
    let mut search = Search { program, candidates: Map::default(), contributions: vec![Vec::new(); count], queue: BinaryHeap::new() };
    for sum in 0..count {
        search.enter(sum);
    }
    while let Some((gain, std::cmp::Reverse(divisor))) = search.queue.pop() {
        if search.candidates.get(&divisor).is_some_and(|c| c.gain == gain) {
            search.extract(&divisor);
        }
    }
    merge_equal_sums(program);
}

impl Divisor {
    fn cost(&self) -> i64 {
        match self {
            Divisor::Pair { first, second, ratio } => {
                let unit = *ratio == Number::new(1.0) || *ratio == Number::new(-1.0);
                let of = |f: &Factors| f.len().saturating_sub(1) as i64;
                let scale = if unit || second.is_empty() { 0 } else { 1 };
                of(first) + of(second) + scale + 1
            }
            Divisor::Product(..) | Divisor::Scaled(..) => 1,
        }
    }
}

impl Search<'_> {
    /// Counts what `sum` offers.
    fn enter(&mut self, sum: usize) {
        let offers = offers(&self.program.sums[sum]);
        let mut touched: Vec<Divisor> = Vec::new();
        for (divisor, saved) in &offers {
            let candidate = self.candidates.entry(divisor.clone()).or_insert_with(|| Candidate { gain: -divisor.cost(), sums: BTreeSet::new() });
            candidate.gain += saved;
            candidate.sums.insert(sum);
            touched.push(divisor.clone());
        }
        touched.dedup();
        for divisor in touched {
            let gain = self.candidates[&divisor].gain;
            if gain > 0 {
                self.queue.push((gain, std::cmp::Reverse(divisor)));
            }
        }
        self.contributions[sum] = offers;
    }

    /// Takes back what `sum` offered.
    fn leave(&mut self, sum: usize) {
        for (divisor, saved) in std::mem::take(&mut self.contributions[sum]) {
            if let Some(candidate) = self.candidates.get_mut(&divisor) {
                candidate.gain -= saved;
                candidate.sums.remove(&sum);
                if candidate.sums.is_empty() {
                    self.candidates.remove(&divisor);
                } else if candidate.gain > 0 {
                    let gain = candidate.gain;
                    self.queue.push((gain, std::cmp::Reverse(divisor)));
                }
            }
        }
    }

    fn extract(&mut self, divisor: &Divisor) {
        let sums: Vec<usize> = self.candidates[divisor].sums.iter().copied().collect();
        let node = self.program.nodes.len() as Id;
        let mut definition: Option<Sum> = None;
        let mut saved = 0;
        let mut rewritten: Vec<(usize, Sum)> = Vec::new();
        for sum in sums {
            let mut terms = self.program.sums[sum].clone();
            let before = cost(&terms);
            let found = replace(&mut terms, divisor, node);
            if let Some(found) = found {
                saved += before - cost(&terms);
                definition.get_or_insert(found);
                rewritten.push((sum, terms));
            }
        }
        // Occurrences can overlap within a sum: then the gain was counted too high.
        let Some(definition) = definition.filter(|d| saved - cost(d) > 0) else {
            if let Some(candidate) = self.candidates.get_mut(divisor) {
                candidate.gain = i64::MIN / 2;
            }
            return;
        };
        self.program.nodes.push(Node::Value(self.program.sums.len()));
        self.program.sums.push(definition);
        self.contributions.push(Vec::new());
        for (sum, terms) in rewritten {
            self.leave(sum);
            self.program.sums[sum] = terms;
            self.enter(sum);
        }
        let new = self.program.sums.len() - 1;
        self.enter(new);
    }
}

fn cost(sum: &[Term]) -> i64 {
    sum.iter().map(|t| t.cost() as i64).sum::<i64>() + sum.len() as i64 - 1
}

/// All divisors of a sum with what each occurrence saves.
fn offers(sum: &Sum) -> Vec<(Divisor, i64)> {
    let mut offers = Vec::new();
    for term in sum {
        let f = &term.factors;
        for (i, a) in f.iter().enumerate() {
            if i > 0 && f[i - 1] == *a && i > 1 && f[i - 2] == *a {
                continue;
            }
            for (j, b) in f.iter().enumerate().skip(i + 1) {
                if j > i + 1 && f[j - 1] == *b {
                    continue;
                }
                if i > 0 && f[i - 1] == *a && *b != *a {
                    continue;
                }
                offers.push((Divisor::Product(*a, *b), 1));
            }
            if term.coefficient.abs() != 1.0 && (i == 0 || f[i - 1] != *a) {
                offers.push((Divisor::Scaled(*a, Number::new(term.coefficient.abs())), 1));
            }
        }
    }
    for (i, a) in sum.iter().enumerate() {
        for b in &sum[i + 1..] {
            let (common, first, second) = split(&a.factors, &b.factors);
            if sum.len() > LONG && common.is_empty() {
                continue;
            }
            let divisor = Divisor::Pair { first, second, ratio: Number::new(b.coefficient / a.coefficient) };
            let mut factors = common;
            factors.push(0);
            let together = Term { coefficient: a.coefficient, factors };
            let saved = a.cost() as i64 + b.cost() as i64 + 1 - together.cost() as i64;
            offers.push((divisor, saved));
        }
    }
    offers.sort();
    offers
}

/// Common factors and what is left of each list.
fn split(a: &Factors, b: &Factors) -> (Factors, Factors, Factors) {
    let (mut common, mut only_a, mut only_b) = (Factors::new(), Factors::new(), Factors::new());
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        match a[i].cmp(&b[j]) {
            std::cmp::Ordering::Equal => {
                common.push(a[i]);
                i += 1;
                j += 1;
            }
            std::cmp::Ordering::Less => {
                only_a.push(a[i]);
                i += 1;
            }
            std::cmp::Ordering::Greater => {
                only_b.push(b[j]);
                j += 1;
            }
        }
    }
    only_a.extend_from_slice(&a[i..]);
    only_b.extend_from_slice(&b[j..]);
    (common, only_a, only_b)
}

/// Replaces all occurrences of `divisor` by `node`; gives the divisor's definition if there was one.
fn replace(sum: &mut Sum, divisor: &Divisor, node: Id) -> Option<Sum> {
    let mut definition = None;
    match divisor {
        Divisor::Product(a, b) => {
            for term in sum.iter_mut() {
                while let Some(rest) = without(&term.factors, &[*a, *b]) {
                    term.factors = rest;
                    term.factors.push(node);
                    definition.get_or_insert_with(|| vec![Term { coefficient: 1.0, factors: Factors::from_slice(&[*a, *b]) }]);
                }
            }
        }
        Divisor::Scaled(a, number) => {
            for term in sum.iter_mut() {
                if term.coefficient.abs() == 1.0 || Number::new(term.coefficient.abs()) != *number {
                    continue;
                }
                if let Some(rest) = without(&term.factors, &[*a]) {
                    let coefficient = term.coefficient.abs();
                    definition.get_or_insert_with(|| vec![Term { coefficient, factors: Factors::from_slice(&[*a]) }]);
                    term.factors = rest;
                    term.factors.push(node);
                    term.coefficient = term.coefficient.signum();
                }
            }
        }
        Divisor::Pair { first, second, ratio } => {
            let mut i = 0;
            while i < sum.len() {
                let partner = (i + 1..sum.len()).find(|&j| {
                    let (_, a, b) = split(&sum[i].factors, &sum[j].factors);
                    a == *first && b == *second && Number::new(sum[j].coefficient / sum[i].coefficient) == *ratio
                });
                if let Some(j) = partner {
                    let other = sum.remove(j);
                    let (mut common, ..) = split(&sum[i].factors, &other.factors);
                    let ratio = other.coefficient / sum[i].coefficient;
                    definition.get_or_insert_with(|| {
                        vec![Term { coefficient: 1.0, factors: first.clone() }, Term { coefficient: ratio, factors: second.clone() }]
                    });
                    common.push(node);
                    sum[i].factors = common;
                }
                i += 1;
            }
        }
    }
    for term in sum.iter_mut() {
        term.factors.sort_unstable();
    }
    sum.sort_by(|a, b| a.factors.cmp(&b.factors));
    definition
}

/// `factors` without those listed, if it has them all.
fn without(factors: &Factors, remove: &[Id]) -> Option<Factors> {
    let mut rest = factors.clone();
    for r in remove {
        let at = rest.iter().position(|f| f == r)?;
        rest.remove(at);
    }
    Some(rest)
}

/// Sums that became equal are computed once.
fn merge_equal_sums(program: &mut Program) {
    let mut first: Vec<usize> = (0..program.sums.len()).collect();
    for s in 0..program.sums.len() {
        if let Some(same) = (0..s).find(|t| program.sums[*t] == program.sums[s]) {
            first[s] = same;
        }
    }
    for node in &mut program.nodes {
        if let Node::Sin(s) | Node::Cos(s) | Node::Value(s) | Node::Reciprocal(s) = node {
            *s = first[*s];
        }
    }
    for s in program.outputs.iter_mut().flatten() {
        *s = first[*s];
    }
}
