//! Factoring and common subexpressions of many sums at once.
//!
//! Greedy extraction of *divisors*, after the two-term method of Hosangadi, Fallah and Kastner
//! (2006) for polynomials: a divisor is a sum of two terms up to a common factor, `a + ρ b`; a
//! product of two nodes; or a scaled node, `k·a`. The divisor that saves most operations over all
//! sums becomes a node of its own, and the search goes on until none saves any.

use super::divisor::{Divisor, Factors, Item, Offer, hash_of, rounded, without};
use super::{Id, Node, Program, Term};
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

/// Keys are hashes already. No random seed: same input, same program.
#[derive(Default)]
struct Identity(u64);

impl Hasher for Identity {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, _: &[u8]) {
        unreachable!("keys are u64");
    }

    fn write_u64(&mut self, key: u64) {
        self.0 = key;
    }
}

struct Candidate {
    cost: [i32; 2],
    /// What its occurrences save in all, for either choice of the coefficient that is 1.
    saved: [i32; 2],
    /// What occurrences that overlap, so that not all can be replaced, were found to count too much.
    overcount: i32,
    /// The gain of its highest entry in the queue.
    queued: i32,
    /// Sums in which it occurs or has occurred.
    sums: SmallVec<[u32; 4]>,
    /// Known once it saves something.
    divisor: Option<Box<Divisor>>,
}

impl Candidate {
    fn unit(&self) -> usize {
        usize::from(self.saved[1] - self.cost[1] > self.saved[0] - self.cost[0])
    }

    /// Operations saved if all occurrences are replaced, less what the divisor costs.
    fn gain(&self) -> i32 {
        let unit = self.unit();
        self.saved[unit] - self.cost[unit] - self.overcount
    }
}

/// All divisors that the sums offer.
#[derive(Default)]
struct Market {
    ids: HashMap<u64, u32, BuildHasherDefault<Identity>>,
    candidates: Vec<Candidate>,
    /// By gain, then the oldest first. Entries may be out of date: too high, never too low.
    queue: BinaryHeap<(i32, Reverse<u32>)>,
    /// Whether the queue is kept up to date.
    open: bool,
}

struct Search<'a> {
    nodes: &'a mut Vec<Node>,
    sums: Vec<Vec<Item>>,
    market: Market,
}

/// An occurrence in a sum: which terms go, what takes their place.
struct Rewrite {
    gone: SmallVec<[usize; 2]>,
    item: Item,
}

/// Rewrites the sums of `program` over shared new nodes.
pub fn factor(program: &mut Program) {
    let sums = program.sums.iter().map(|s| s.iter().map(|t| Item::new(t.coefficient, t.factors.clone())).collect());
    let mut search = Search { sums: sums.collect(), nodes: &mut program.nodes, market: Market::default() };
    for sum in 0..search.sums.len() {
        let items = std::mem::take(&mut search.sums[sum]);
        items.into_iter().for_each(|item| search.insert(sum, item));
    }
    search.market.open();
    while let Some(best) = search.market.best() {
        search.extract(best);
    }
    let sort = |items: Vec<Item>| {
        let mut sum: Vec<Term> =
            items.into_iter().map(|i| Term { coefficient: i.coefficient, factors: i.factors }).collect();
        sum.sort_by(|a, b| a.factors.cmp(&b.factors));
        sum
    };
    program.sums = search.sums.into_iter().map(sort).collect();
    merge_equal_sums(program);
}

impl Market {
    /// Adds an occurrence in `sum`.
    fn add(&mut self, sum: usize, offer: &Offer) {
        let id = *self.ids.entry(offer.key).or_insert_with(|| {
            let (cost, sums) = (offer.cost, SmallVec::new());
            self.candidates.push(Candidate { cost, saved: [0; 2], overcount: 0, queued: 0, sums, divisor: None });
            self.candidates.len() as u32 - 1
        });
        let candidate = &mut self.candidates[id as usize];
        candidate.saved[0] += offer.saved[0];
        candidate.saved[1] += offer.saved[1];
        if candidate.sums.last() != Some(&(sum as u32)) {
            candidate.sums.push(sum as u32);
        }
        if candidate.gain() > 0 {
            candidate.divisor.get_or_insert_with(|| Box::new(offer.divisor()));
            if self.open {
                self.queue(id);
            }
        }
    }

    /// Takes an occurrence back.
    fn take(&mut self, offer: &Offer) {
        if let Some(id) = self.ids.get(&offer.key) {
            let saved = &mut self.candidates[*id as usize].saved;
            saved[0] -= offer.saved[0];
            saved[1] -= offer.saved[1];
        }
    }

    fn open(&mut self) {
        self.open = true;
        (0..self.candidates.len() as u32).for_each(|id| self.queue(id));
    }

    fn queue(&mut self, id: u32) {
        let candidate = &mut self.candidates[id as usize];
        let gain = candidate.gain();
        if gain > candidate.queued {
            candidate.queued = gain;
            self.queue.push((gain, Reverse(id)));
        }
    }

    /// The divisor that saves most.
    fn best(&mut self) -> Option<u32> {
        while let Some((gain, Reverse(id))) = self.queue.pop() {
            let candidate = &mut self.candidates[id as usize];
            if gain == candidate.queued {
                candidate.queued = 0;
                if candidate.gain() == gain {
                    return Some(id);
                }
                self.queue(id);
            }
        }
        None
    }
}

impl Search<'_> {
    /// Adds a term to a sum, with all that it offers.
    fn insert(&mut self, sum: usize, item: Item) {
        item.offers(|offer| self.market.add(sum, &offer));
        for other in &self.sums[sum] {
            self.market.add(sum, &other.offer_with(&item));
        }
        self.sums[sum].push(item);
    }

    /// Takes a term out of a sum, with all that it offered.
    fn remove(&mut self, sum: usize, at: usize) {
        let item = self.sums[sum].swap_remove(at);
        item.offers(|offer| self.market.take(&offer));
        for other in &self.sums[sum] {
            self.market.take(&other.offer_with(&item));
        }
    }

    fn extract(&mut self, id: u32) {
        let candidate = &mut self.market.candidates[id as usize];
        let (unit, expected) = (candidate.unit(), candidate.gain());
        let Some(divisor) = candidate.divisor.clone() else { return };
        candidate.sums.sort_unstable();
        candidate.sums.dedup();
        let node = self.nodes.len() as Id;
        let found: Vec<(usize, Vec<Rewrite>)> = candidate
            .sums
            .iter()
            .map(|s| (*s as usize, occurrences(&self.sums[*s as usize], &divisor, unit, node)))
            .filter(|(_, list)| !list.is_empty())
            .collect();
        let saved: i32 = found.iter().flat_map(|(s, list)| list.iter().map(|r| r.saved(&self.sums[*s]))).sum();
        // Occurrences can overlap: then the gain was counted too high.
        let gain = saved - candidate.cost[unit];
        if gain < expected {
            candidate.overcount += expected - gain;
            return self.market.queue(id);
        }
        candidate.sums = found.iter().map(|(s, _)| *s as u32).collect();
        for (sum, list) in found {
            let mut gone: Vec<usize> = list.iter().flat_map(|r| r.gone.iter().copied()).collect();
            gone.sort_unstable();
            gone.into_iter().rev().for_each(|at| self.remove(sum, at));
            list.into_iter().for_each(|r| self.insert(sum, r.item));
        }
        self.nodes.push(Node::Value(self.sums.len()));
        self.sums.push(Vec::new());
        let new = self.sums.len() - 1;
        for term in divisor.definition(unit) {
            self.insert(new, Item::new(term.coefficient, term.factors));
        }
    }
}

impl Rewrite {
    fn saved(&self, sum: &[Item]) -> i32 {
        let before: i32 = self.gone.iter().map(|i| sum[*i].cost()).sum();
        before + self.gone.len() as i32 - 1 - self.item.cost()
    }
}

/// Occurrences of `divisor` that do not overlap.
fn occurrences(sum: &[Item], divisor: &Divisor, unit: usize, node: Id) -> Vec<Rewrite> {
    let mut found = Vec::new();
    match divisor {
        Divisor::Product(a, b) => {
            for (i, item) in sum.iter().enumerate() {
                let mut factors = item.factors.clone();
                let mut times = 0;
                while let Some(rest) = without(&factors, &[*a, *b]) {
                    factors = rest;
                    times += 1;
                }
                if times > 0 {
                    factors.extend(std::iter::repeat_n(node, times));
                    found
                        .push(Rewrite { gone: SmallVec::from_slice(&[i]), item: Item::new(item.coefficient, factors) });
                }
            }
        }
        Divisor::Scaled(a, size) => {
            for (i, item) in sum.iter().enumerate() {
                let coefficient = item.coefficient.abs();
                if coefficient == 1.0 || rounded(coefficient) != rounded(*size) {
                    continue;
                }
                if let Some(mut rest) = without(&item.factors, &[*a]) {
                    rest.push(node);
                    let item = Item::new(item.coefficient.signum(), rest);
                    found.push(Rewrite { gone: SmallVec::from_slice(&[i]), item });
                }
            }
        }
        Divisor::Pair { first, second, ratio } => {
            let change = hash_of(second).wrapping_sub(hash_of(first));
            let mut used = vec![false; sum.len()];
            for (i, item) in sum.iter().enumerate() {
                let Some(common) = without(&item.factors, first).filter(|_| !used[i]) else { continue };
                let partner = item.hash.wrapping_add(change);
                let fits = |j: usize, other: &Item| {
                    other.hash == partner
                        && !used[j]
                        && j != i
                        && rounded(other.coefficient / item.coefficient) == rounded(*ratio)
                        && without(&other.factors, second).as_ref() == Some(&common)
                };
                if let Some(j) = sum.iter().enumerate().position(|(j, other)| fits(j, other)) {
                    (used[i], used[j]) = (true, true);
                    let mut factors = common;
                    factors.push(node);
                    let coefficient = if unit == 0 { item.coefficient } else { sum[j].coefficient };
                    found.push(Rewrite { gone: SmallVec::from_slice(&[i, j]), item: Item::new(coefficient, factors) });
                }
            }
        }
    }
    found
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
