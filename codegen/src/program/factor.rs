//! Factoring and common subexpressions of many sums at once.
//!
//! Greedy extraction of *divisors*, after the two-term method of Hosangadi, Fallah and Kastner
//! (2006) for polynomials: a divisor is a sum of two terms up to a common factor, `a + ρ b`; a
//! product of two nodes; or a scaled node, `k·a`. The divisor that saves most operations over all
//! sums becomes a node of its own, and the search goes on until none saves any.

use super::divisor::{
    Comparison, Divisor, Factors, Item, cost, exact, hash_of, marks_of, rounded, scaled_key, without,
};
use super::market::{Best, Market, Number, Origin};
use super::{Id, Node, Program, Term};
use smallvec::SmallVec;
use std::collections::HashMap;

struct Search<'a> {
    nodes: &'a mut Vec<Node>,
    /// All terms there ever were.
    items: Vec<Item>,
    sums: Vec<Terms>,
    /// Sums in which a node occurs or has occurred.
    places: Vec<Vec<u32>>,
    market: Market,
    /// A zero per node, for comparisons.
    hashes: Vec<u64>,
}

/// The terms of a sum.
#[derive(Default)]
struct Terms {
    /// Their indices, and their numbers among all terms that the sum ever had.
    now: Vec<(u32, u32)>,
    /// For each of these a row with the divisors that it is with those before it.
    pairs: Vec<Vec<Pair>>,
}

/// A divisor, and whether the older of its two terms comes first in it.
#[derive(Clone, Copy, Default)]
struct Pair(Number);

/// An occurrence in a sum: which terms go, what takes their place.
struct Rewrite {
    sum: usize,
    gone: SmallVec<[usize; 2]>,
    /// Of the new term, if the divisor's first part has the coefficient 1.
    coefficient: f64,
    factors: Factors,
}

/// Rewrites the sums of `program` over shared new nodes.
pub fn factor(program: &mut Program) {
    let pairs = program.sums.iter().map(|s| s.len() * s.len() / 2).sum();
    let mut search = Search {
        places: vec![Vec::new(); program.nodes.len()],
        hashes: vec![0; program.nodes.len()],
        nodes: &mut program.nodes,
        items: Vec::new(),
        sums: program.sums.iter().map(|_| Terms::default()).collect(),
        market: Market::new(pairs),
    };
    for (sum, terms) in program.sums.iter().enumerate() {
        terms.iter().for_each(|t| search.insert(sum, Item::new(t.coefficient, t.factors.clone())));
    }
    search.market.open();
    while let Some(best) = search.market.best() {
        search.extract(&best);
    }
    let term = |(i, _): &(u32, u32)| {
        let item = &search.items[*i as usize];
        Term { coefficient: item.coefficient, factors: item.factors.clone() }
    };
    program.sums = search.sums.iter().map(|terms| terms.now.iter().map(term).collect()).collect();
    program.sums.iter_mut().for_each(|sum| sum.sort_by(|a, b| a.factors.cmp(&b.factors)));
    merge_equal_sums(program);
}

impl Pair {
    fn new(number: Number, ordered: bool) -> Pair {
        Pair(number << 1 | u32::from(ordered))
    }

    fn number(self) -> Number {
        self.0 >> 1
    }

    fn ordered(self) -> bool {
        self.0 & 1 == 1
    }
}

impl Search<'_> {
    /// Adds a term to a sum, with all that it offers.
    fn insert(&mut self, sum: usize, item: Item) {
        let new = self.items.len() as u32;
        item.offers(new, |offer, saved| {
            self.market.add(&offer, saved);
        });
        let terms = &mut self.sums[sum];
        let birth = terms.pairs.len();
        let mut row = vec![Pair::default(); birth];
        let comparison = Comparison::new(&item, &mut self.hashes);
        for (other, other_birth) in &terms.now {
            let (offer, ordered, saved) = comparison.offer_with(&self.items[*other as usize], [*other, new]);
            row[*other_birth as usize] = Pair::new(self.market.add(&offer, saved), ordered);
        }
        drop(comparison);
        terms.pairs.push(row);
        terms.now.push((new, birth as u32));
        for id in &item.factors {
            let places = &mut self.places[*id as usize];
            if places.last() != Some(&(sum as u32)) {
                places.push(sum as u32);
            }
        }
        self.items.push(item);
    }

    /// Takes a term out of a sum, with all that it offered.
    fn remove(&mut self, sum: usize, at: usize) {
        let terms = &mut self.sums[sum];
        let (number, birth) = terms.now.swap_remove(at);
        let item = &self.items[number as usize];
        item.offers(number, |offer, saved| self.market.take_by_key(offer.key, saved));
        for (other, other_birth) in &terms.now {
            let (early, late) = (birth.min(*other_birth), birth.max(*other_birth));
            let pair = terms.pairs[late as usize][early as usize];
            let other = &self.items[*other as usize];
            let (x, y) = if (birth == early) == pair.ordered() { (item, other) } else { (other, item) };
            let shared = x.factors.len() - self.market.first(pair.number());
            self.market.take(pair.number(), x.saved(y, shared));
        }
        terms.pairs[birth as usize] = Vec::new();
    }

    fn divisor(&self, origin: Origin) -> Divisor {
        let item = |i: u32| &self.items[i as usize];
        match origin {
            Origin::Pair(i, j) => Divisor::pair(item(i), item(j)),
            Origin::Product(a, b) => Divisor::Product(a, b),
            Origin::Scaled(a, i) => Divisor::Scaled(a, item(i).coefficient.abs()),
        }
    }

    fn extract(&mut self, best: &Best) {
        let divisor = self.divisor(best.origin);
        let node = self.nodes.len() as Id;
        let rarest = divisor.nodes().min_by_key(|id| self.places[*id as usize].len());
        let mut places = rarest.map_or(Vec::new(), |id| self.places[id as usize].clone());
        places.sort_unstable();
        places.dedup();
        let mut found = Vec::new();
        places.into_iter().for_each(|s| self.occurrences(s as usize, &divisor, node, &mut found));
        let (scale, gain) = self.scale(&divisor, &found);
        // Occurrences can overlap: then the gain was counted too high.
        if gain < best.gain {
            return self.market.correct(best, gain);
        }
        self.nodes.push(Node::Value(self.sums.len()));
        self.places.push(Vec::new());
        self.hashes.push(0);
        for list in found.chunk_by(|a, b| a.sum == b.sum) {
            let mut gone: Vec<usize> = list.iter().flat_map(|r| r.gone.iter().copied()).collect();
            gone.sort_unstable();
            gone.into_iter().rev().for_each(|at| self.remove(list[0].sum, at));
            list.iter().for_each(|r| self.insert(r.sum, Item::new(exact(r.coefficient / scale), r.factors.clone())));
        }
        let new = self.sums.len();
        self.sums.push(Terms::default());
        for term in divisor.definition(scale) {
            self.insert(new, Item::new(term.coefficient, term.factors));
        }
    }

    /// The coefficient of a divisor's first part with which it saves most, and how much that is.
    fn scale(&self, divisor: &Divisor, found: &[Rewrite]) -> (f64, i32) {
        let Divisor::Pair { first, second, ratio } = divisor else { return (1.0, self.gain(divisor, found, 1.0)) };
        let mut scales = vec![1.0, 1.0 / ratio.abs()];
        // Equal coefficients are factored out in any case.
        if exact(*ratio).abs() != 1.0 && (first.len() == 1 || second.len() == 1) {
            scales.extend(found.iter().map(|r| r.coefficient.abs()));
            scales.dedup_by_key(|scale| rounded(*scale));
        }
        let gains = scales.into_iter().map(|scale| (scale, self.gain(divisor, found, scale)));
        gains.reduce(|best, next| if next.1 > best.1 { next } else { best }).unwrap_or((1.0, 0))
    }

    /// Operations saved if the divisor replaces all that was found.
    fn gain(&self, divisor: &Divisor, found: &[Rewrite], scale: f64) -> i32 {
        let mut gain = 0;
        for r in found {
            let before: i32 = r.gone.iter().map(|at| self.items[self.sums[r.sum].now[*at].0 as usize].cost()).sum();
            gain += before + r.gone.len() as i32 - 1 - cost(exact(r.coefficient / scale), r.factors.len());
        }
        let definition = divisor.definition(scale);
        gain -= definition.iter().map(|t| t.cost() as i32).sum::<i32>() + definition.len() as i32 - 1;
        if definition.len() == 2 {
            // A part that is needed elsewhere too costs nothing here.
            for part in definition.iter().filter(|t| t.factors.len() == 1 && t.coefficient.abs() != 1.0) {
                let here = found.iter().filter(|r| rounded(r.coefficient.abs()) == rounded(scale)).count() as i32;
                gain += i32::from(self.market.saved(scaled_key(part.factors[0], part.coefficient.abs())) > here);
            }
        }
        gain
    }

    /// Occurrences of `divisor` in a sum that do not overlap.
    fn occurrences(&self, sum: usize, divisor: &Divisor, node: Id, found: &mut Vec<Rewrite>) {
        let items = || self.sums[sum].now.iter().map(|(i, _)| &self.items[*i as usize]).enumerate();
        match divisor {
            Divisor::Product(a, b) => {
                let marks = marks_of(&[*a, *b]);
                for (i, item) in items().filter(|(_, item)| item.may_contain(marks)) {
                    let mut factors = item.factors.clone();
                    let mut times = 0;
                    while let Some(rest) = without(&factors, &[*a, *b]) {
                        factors = rest;
                        times += 1;
                    }
                    if times > 0 {
                        factors.extend(std::iter::repeat_n(node, times));
                        found.push(Rewrite {
                            sum,
                            gone: [i].as_slice().into(),
                            coefficient: item.coefficient,
                            factors,
                        });
                    }
                }
            }
            Divisor::Scaled(a, size) => {
                for (i, item) in items() {
                    let coefficient = item.coefficient.abs();
                    if coefficient == 1.0 || rounded(coefficient) != rounded(*size) {
                        continue;
                    }
                    if let Some(mut factors) = without(&item.factors, &[*a]) {
                        factors.push(node);
                        let coefficient = item.coefficient.signum();
                        found.push(Rewrite { sum, gone: [i].as_slice().into(), coefficient, factors });
                    }
                }
            }
            Divisor::Pair { first, second, ratio } => {
                let change = hash_of(second).wrapping_sub(hash_of(first));
                let marks = marks_of(first);
                let mut used = vec![false; self.sums[sum].now.len()];
                for (i, item) in items().filter(|(_, item)| item.may_contain(marks)) {
                    let Some(common) = without(&item.factors, first).filter(|_| !used[i]) else { continue };
                    let partner = item.hash.wrapping_add(change);
                    let fits = |j: usize, other: &Item| {
                        other.hash == partner
                            && !used[j]
                            && j != i
                            && rounded(other.coefficient / item.coefficient) == rounded(*ratio)
                            && without(&other.factors, second).as_ref() == Some(&common)
                    };
                    if let Some((j, _)) = items().find(|(j, other)| fits(*j, other)) {
                        (used[i], used[j]) = (true, true);
                        let mut factors = common;
                        factors.push(node);
                        let gone = [i, j].as_slice().into();
                        found.push(Rewrite { sum, gone, coefficient: item.coefficient, factors });
                    }
                }
            }
        }
    }
}

/// Sums that became equal are computed once.
fn merge_equal_sums(program: &mut Program) {
    let mut known: HashMap<Vec<(u64, &Factors)>, usize> = HashMap::new();
    let mut first = Vec::with_capacity(program.sums.len());
    for (s, sum) in program.sums.iter().enumerate() {
        let key = sum.iter().map(|t| (t.coefficient.to_bits(), &t.factors)).collect();
        first.push(*known.entry(key).or_insert(s));
    }
    for node in program.nodes.iter_mut() {
        if let Node::Sin(s) | Node::Cos(s) | Node::Value(s) | Node::Reciprocal(s) = node {
            *s = first[*s];
        }
    }
    for s in program.outputs.iter_mut().flatten() {
        *s = first[*s];
    }
}
