//! Factoring and common subexpressions of many sums at once.
//!
//! Greedy extraction of *divisors*, after the two-term method of Hosangadi, Fallah and Kastner
//! (2006) for polynomials: a divisor is a sum of two terms up to a common factor, `a + ρ b`; a
//! product of two nodes; or a scaled node, `k·a`. The divisor that saves most operations over all
//! sums becomes a node of its own, and the search goes on until none saves any.

use super::divisor::{
    Divisor, Factors, Item, Pair, cost, exact, hash_of, hash_of_node, marks_of, rounded, scaled_key, without,
};
use super::market::{Best, Market, Offered, Origin};
use super::{Id, Node, Program, Term};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// The search for divisors in the sums of a program. Who factors several programs keeps it: its memory is used again.
#[derive(Default)]
pub struct Search {
    nodes: Vec<Node>,
    /// All terms there ever were, and their factors one after another.
    terms: Vec<Item>,
    factors: Vec<Id>,
    sums: Vec<Sum>,
    /// Rows of `Entry`s.
    offered: Vec<Offered>,
    /// Sums in which a node occurs or has occurred, in order.
    places: Vec<SmallVec<[u32; 4]>>,
    market: Market,
    /// The hashes of the factors of the term at hand, and by nodes, with a zero for those that it has not.
    own: Vec<u64>,
    hashes: Vec<u64>,
    /// Where the divisor at hand occurs.
    found: Vec<Rewrite>,
}

/// The terms that a sum has.
#[derive(Default)]
struct Sum {
    entries: Vec<Entry>,
    /// Slots that no entry has; all others below their number together are taken.
    vacant: Vec<u32>,
}

#[derive(Clone, Copy)]
struct Entry {
    item: Item,
    term: u32,
    /// Its place in the rows of younger terms of the sum.
    slot: u32,
    /// Where the divisors begin that it has in itself, and those with older terms, by their slots.
    row: u32,
    pairs: u32,
}

/// An occurrence in a sum: which terms go, what takes their place.
struct Rewrite {
    sum: usize,
    gone: SmallVec<[usize; 2]>,
    /// Of the new term, if the divisor's first part has the coefficient 1.
    coefficient: f64,
    factors: Factors,
}

impl Search {
    /// Rewrites the sums of `program` over shared new nodes.
    pub fn factor(&mut self, program: &mut Program) {
        self.begin(program);
        for (sum, terms) in program.sums.iter().enumerate() {
            terms.iter().for_each(|t| self.insert(sum, t.coefficient, &t.factors));
        }
        self.market.open();
        while let Some(best) = self.market.best() {
            self.extract(&best);
        }
        program.nodes = std::mem::take(&mut self.nodes);
        let term = |Entry { item, .. }: &Entry| Term {
            coefficient: item.coefficient,
            factors: Factors::from_slice(item.factors(&self.factors)),
        };
        program.sums = self.sums.iter().map(|sum| sum.entries.iter().map(term).collect()).collect();
        program.sums.iter_mut().for_each(|sum| sum.sort_by(|a, b| a.factors.cmp(&b.factors)));
        merge_equal_sums(program);
    }

    /// Empties all, with room for this program.
    fn begin(&mut self, program: &mut Program) {
        self.nodes = std::mem::take(&mut program.nodes);
        self.terms.clear();
        self.factors.clear();
        self.sums.clear();
        self.sums.extend(program.sums.iter().map(|s| Sum { entries: Vec::with_capacity(s.len()), vacant: Vec::new() }));
        let pairs = program.sums.iter().map(|s| s.len() * s.len() / 2).sum();
        self.offered.clear();
        self.offered.reserve(3 * pairs);
        self.places.clear();
        self.places.resize_with(self.nodes.len(), SmallVec::new);
        self.hashes.clear();
        self.hashes.resize(self.nodes.len(), 0);
        self.market.begin(pairs);
    }

    /// Adds a term to a sum, with all that it offers.
    fn insert(&mut self, sum: usize, coefficient: f64, factors: &[Id]) {
        let (term, start) = (self.terms.len() as u32, self.factors.len());
        self.factors.extend_from_slice(factors);
        self.factors[start..].sort_unstable();
        let (older_factors, factors) = self.factors.split_at(start);
        self.own.clear();
        self.own.extend(factors.iter().map(|id| hash_of_node(*id)));
        let item = Item::new(coefficient, factors, &self.own, start);
        let Sum { entries, vacant } = &mut self.sums[sum];

        let row = self.offered.len();
        item.divisors(factors, &self.own, term, |key, times, origin| {
            self.offered.push(self.market.add(key, [times; 2], || (origin, [1; 2])));
        });
        let pairs = self.offered.len();
        factors.iter().zip(&self.own).for_each(|(id, hash)| self.hashes[*id as usize] = *hash);
        let slots = entries.len() + vacant.len();
        self.offered.resize(pairs + slots, Offered::default());
        let with_older = &mut self.offered[pairs..];
        for older in entries.iter() {
            let factors_of_older = older.item.factors(older_factors);
            let shared = item.shared(factors, &self.hashes, &older.item, factors_of_older);
            let pair = Pair::new(&older.item, &item, shared);
            let new = || (pair.origin(older.term, term), pair.cost(&older.item, &item));
            with_older[older.slot as usize] = self.market.add(pair.key, pair.saved(&older.item, &item), new);
        }
        factors.iter().for_each(|id| self.hashes[*id as usize] = 0);

        let slot = vacant.pop().unwrap_or(slots as u32);
        entries.push(Entry { item, term, slot, row: row as u32, pairs: pairs as u32 });
        for id in factors {
            let places = &mut self.places[*id as usize];
            if let Err(at) = places.binary_search(&(sum as u32)) {
                places.insert(at, sum as u32);
            }
        }
        self.terms.push(item);
    }

    /// Takes a term out of a sum, with all that it offered.
    fn remove(&mut self, sum: usize, at: usize) {
        let Sum { entries, vacant } = &mut self.sums[sum];
        let gone = entries.swap_remove(at);
        vacant.push(gone.slot);
        self.offered[gone.row as usize..gone.pairs as usize].iter().for_each(|offered| self.market.take(*offered));
        for other in entries.iter() {
            let (older, younger) = if gone.term < other.term { (&gone, other) } else { (other, &gone) };
            self.market.take(self.offered[(younger.pairs + older.slot) as usize]);
        }
    }

    fn divisor(&self, origin: Origin) -> Divisor {
        let coefficient = |i: u32| self.terms[i as usize].coefficient;
        let term = |i: u32| (coefficient(i), self.terms[i as usize].factors(&self.factors));
        match origin {
            Origin::Pair(i, j) => Divisor::pair(term(i), term(j)),
            Origin::Product(a, b) => Divisor::Product([a, b]),
            Origin::Scaled(a, i) => Divisor::Scaled(a, coefficient(i).abs()),
        }
    }

    fn extract(&mut self, best: &Best) {
        let divisor = self.divisor(best.origin);
        let node = self.nodes.len() as Id;
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        let terms = divisor.terms(1.0);
        let nodes = terms.iter().flat_map(|(_, factors)| *factors);
        let rarest = nodes.map(|id| &self.places[*id as usize]).min_by_key(|places| places.len());
        rarest.into_iter().flatten().for_each(|s| self.occurrences(*s as usize, &divisor, node, &mut found));
        let (scale, gain) = self.scale(&divisor, &found);
        // Occurrences can overlap: then the gain was counted too high.
        if gain < best.gain {
            self.market.correct(best, gain);
        } else {
            self.replace(&divisor, scale, &found);
        }
        self.found = found;
    }

    /// Makes a divisor a node of its own in all that was found.
    fn replace(&mut self, divisor: &Divisor, scale: f64, found: &[Rewrite]) {
        self.nodes.push(Node::Value(self.sums.len()));
        self.places.push(SmallVec::new());
        self.hashes.push(0);
        for list in found.chunk_by(|a, b| a.sum == b.sum) {
            let mut gone: SmallVec<[usize; 8]> = list.iter().flat_map(|r| r.gone.iter().copied()).collect();
            gone.sort_unstable();
            gone.into_iter().rev().for_each(|at| self.remove(list[0].sum, at));
            list.iter().for_each(|r| self.insert(r.sum, exact(r.coefficient / scale), &r.factors));
        }
        let new = self.sums.len();
        self.sums.push(Sum::default());
        divisor.terms(scale).into_iter().for_each(|(coefficient, factors)| self.insert(new, coefficient, factors));
    }

    /// The coefficient of a divisor's first part with which it saves most, and how much that is.
    fn scale(&self, divisor: &Divisor, found: &[Rewrite]) -> (f64, i32) {
        let cost = |at: &usize, sum: usize| self.sums[sum].entries[*at].item.cost() + 1;
        let before: i32 = found.iter().map(|r| r.gone.iter().map(|at| cost(at, r.sum)).sum::<i32>() - 1).sum();
        let gain = |scale: f64| before - self.cost(divisor, found, scale);
        let mut best = (1.0, gain(1.0));
        let Divisor::Pair { first, second, ratio } = divisor else { return best };
        let mut last = 1.0;
        let mut attempt = |scale: f64| {
            if rounded(scale) != rounded(last) {
                let gain = gain(scale);
                if gain > best.1 {
                    best = (scale, gain);
                }
            }
            last = scale;
        };
        attempt(1.0 / ratio.abs());
        // Equal coefficients are factored out in any case.
        if exact(*ratio).abs() != 1.0 && (first.len() == 1 || second.len() == 1) {
            found.iter().for_each(|r| attempt(r.coefficient.abs()));
        }
        best
    }

    /// Operations of a divisor and of what takes the place of all that was found.
    fn cost(&self, divisor: &Divisor, found: &[Rewrite], scale: f64) -> i32 {
        let rewritten = |r: &Rewrite| cost(exact(r.coefficient / scale), r.factors.len());
        let definition = divisor.terms(scale);
        let of_term = |(coefficient, factors): &(f64, &[Id])| cost(*coefficient, factors.len());
        let mut operations = found.iter().map(rewritten).sum::<i32>() + definition.len() as i32 - 1;
        operations += definition.iter().map(of_term).sum::<i32>();
        if definition.len() == 2 {
            // A part that is needed elsewhere too costs nothing here.
            for (size, factors) in definition.iter().map(|(coefficient, factors)| (coefficient.abs(), *factors)) {
                let [node] = *factors else { continue };
                let here = || found.iter().filter(|r| rounded(r.coefficient.abs()) == rounded(scale)).count() as i32;
                let needed = size != 1.0 && self.market.saved(scaled_key(hash_of_node(node), size)) > here();
                operations -= i32::from(needed);
            }
        }
        operations
    }

    /// Occurrences of `divisor` in a sum that do not overlap.
    fn occurrences(&self, sum: usize, divisor: &Divisor, node: Id, found: &mut Vec<Rewrite>) {
        let entries = &self.sums[sum].entries;
        let factors = |entry: &Entry| entry.item.factors(&self.factors);
        let containing = |marks: u64| entries.iter().enumerate().filter(move |(_, e)| e.item.may_contain(marks));
        match divisor {
            Divisor::Product(nodes) => {
                for (i, entry) in containing(marks_of(nodes)) {
                    let mut rest = Factors::from_slice(factors(entry));
                    let mut times = 0;
                    while let Some(less) = without(&rest, nodes) {
                        rest = less;
                        times += 1;
                    }
                    if times > 0 {
                        rest.extend(std::iter::repeat_n(node, times));
                        let gone = [i].as_slice().into();
                        found.push(Rewrite { sum, gone, coefficient: entry.item.coefficient, factors: rest });
                    }
                }
            }
            Divisor::Scaled(a, size) => {
                for (i, entry) in containing(marks_of(&[*a])) {
                    let coefficient = entry.item.coefficient.abs();
                    if coefficient == 1.0 || rounded(coefficient) != rounded(*size) {
                        continue;
                    }
                    if let Some(mut rest) = without(factors(entry), &[*a]) {
                        rest.push(node);
                        let coefficient = entry.item.coefficient.signum();
                        found.push(Rewrite { sum, gone: [i].as_slice().into(), coefficient, factors: rest });
                    }
                }
            }
            Divisor::Pair { first, second, ratio } => {
                let change = hash_of(second).wrapping_sub(hash_of(first));
                let known = found.len();
                for (i, entry) in containing(marks_of(first)) {
                    let partner = entry.item.hash.wrapping_add(change);
                    let fits = |other: &Entry| {
                        other.item.hash == partner
                            && rounded(other.item.coefficient / entry.item.coefficient) == rounded(*ratio)
                    };
                    let mut partners =
                        entries.iter().enumerate().filter(|(j, other)| *j != i && fits(other)).peekable();
                    if partners.peek().is_none() {
                        continue;
                    }
                    let used = |at: usize| found[known..].iter().any(|r| r.gone.contains(&at));
                    let Some(mut common) = without(factors(entry), first).filter(|_| !used(i)) else { continue };
                    let same = |other: &Entry| without(factors(other), second).as_ref() == Some(&common);
                    if let Some((j, _)) = partners.find(|(j, other)| !used(*j) && same(other)) {
                        common.push(node);
                        let gone = [i, j].as_slice().into();
                        found.push(Rewrite { sum, gone, coefficient: entry.item.coefficient, factors: common });
                    }
                }
            }
        }
    }
}

/// Sums that became equal are computed once.
fn merge_equal_sums(program: &mut Program) {
    let mut known: BTreeMap<u64, SmallVec<[usize; 2]>> = BTreeMap::new();
    let mut first = Vec::with_capacity(program.sums.len());
    for (s, sum) in program.sums.iter().enumerate() {
        let hash = sum.iter().fold(0u64, |hash, t| hash.rotate_left(5) ^ hash_of(&t.factors) ^ t.coefficient.to_bits());
        let alike = known.entry(hash).or_default();
        let same = alike.iter().copied().find(|other| program.sums[*other] == *sum);
        first.push(same.unwrap_or(s));
        if same.is_none() {
            alike.push(s);
        }
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
