//! Factoring and common subexpressions of many sums at once.
//!
//! Greedy extraction of *divisors*, after the two-term method of Hosangadi, Fallah and Kastner
//! (2006) for polynomials: a divisor is a sum of two terms up to a common factor, `a + ρ b`; a
//! product of two nodes; or a scaled node, `k·a`. The divisor that saves most operations over all
//! sums becomes a node of its own, and the search goes on until none saves any.

use super::divisor::{
    Divisor, Factors, Item, Pair, cost, exact, hash_of, marks_of, reset_hashes, rounded, scaled_key, set_hashes,
    without,
};
use super::market::{Best, Market, Number, Offer, Origin};
use super::{Id, Node, Program, Term};
use smallvec::SmallVec;
use std::collections::HashMap;

struct Search<'a> {
    nodes: &'a mut Vec<Node>,
    /// All terms there ever were.
    terms: Vec<Term>,
    sums: Vec<Sum>,
    /// Rows of `Entry`s.
    offered: Vec<Offered>,
    /// Sums in which a node occurs or has occurred.
    places: Vec<SmallVec<[u32; 4]>>,
    market: Market,
    /// A zero for every node, but while a term is compared with others.
    hashes: Vec<u64>,
    /// What the term at hand offers, and the numbers of these divisors.
    offers: Vec<Offer>,
    numbers: Vec<Number>,
}

/// The terms that a sum has.
#[derive(Default)]
struct Sum {
    entries: Vec<Entry>,
    /// How many it ever had.
    births: u32,
}

#[derive(Clone, Copy)]
struct Entry {
    item: Item,
    term: u32,
    /// Its number among all terms that the sum ever had.
    birth: u32,
    /// Where the divisors begin that it has in itself, and those with the terms born before it.
    row: u32,
    pairs: u32,
}

/// What a term or a pair of terms has offered: a divisor, and whether the older of the two comes first in it.
#[derive(Clone, Copy, Default)]
struct Offered(Number);

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
        places: vec![SmallVec::new(); program.nodes.len()],
        hashes: vec![0; program.nodes.len()],
        offers: Vec::new(),
        numbers: Vec::new(),
        nodes: &mut program.nodes,
        terms: Vec::new(),
        sums: program.sums.iter().map(|s| Sum { entries: Vec::with_capacity(s.len()), births: 0 }).collect(),
        offered: Vec::with_capacity(6 * pairs),
        market: Market::new(pairs),
    };
    for (sum, terms) in program.sums.iter().enumerate() {
        terms.iter().for_each(|t| search.insert(sum, t.coefficient, Factors::from_slice(&t.factors)));
    }
    search.market.open();
    while let Some(best) = search.market.best() {
        search.extract(&best);
    }
    let term = |entry: &Entry| search.terms[entry.term as usize].clone();
    program.sums = search.sums.iter().map(|sum| sum.entries.iter().map(term).collect()).collect();
    program.sums.iter_mut().for_each(|sum| sum.sort_by(|a, b| a.factors.cmp(&b.factors)));
    merge_equal_sums(program);
}

impl Offered {
    fn new(number: Number, ordered: bool) -> Offered {
        Offered(number << 1 | u32::from(ordered))
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
    fn insert(&mut self, sum: usize, coefficient: f64, mut factors: Factors) {
        factors.sort_unstable();
        let item = Item::new(coefficient, &factors);
        let term = self.terms.len() as u32;
        let Sum { entries, births } = &mut self.sums[sum];
        self.offers.clear();
        item.offers(&factors, term, |offer| self.offers.push(offer));
        let alone = self.offers.len();
        set_hashes(&mut self.hashes, &factors);
        self.offers.extend(entries.iter().map(|other| {
            let shared = item.shared(&factors, &self.hashes, &other.item, &self.terms[other.term as usize].factors);
            Pair::offer((&other.item, other.term), (&item, term), shared)
        }));
        reset_hashes(&mut self.hashes, &factors);
        self.market.add(&self.offers, &mut self.numbers);
        let row = self.offered.len();
        self.offered.extend(self.numbers[..alone].iter().map(|number| Offered::new(*number, false)));
        let pairs = self.offered.len();
        self.offered.resize(pairs + *births as usize, Offered::default());
        for ((other, offer), number) in entries.iter().zip(&self.offers[alone..]).zip(&self.numbers[alone..]) {
            let ordered = matches!(offer.origin, Origin::Pair(first, _) if first == other.term);
            self.offered[pairs + other.birth as usize] = Offered::new(*number, ordered);
        }
        entries.push(Entry { item, term, birth: *births, row: row as u32, pairs: pairs as u32 });
        *births += 1;
        for id in &factors {
            let places = &mut self.places[*id as usize];
            if places.last() != Some(&(sum as u32)) {
                places.push(sum as u32);
            }
        }
        self.terms.push(Term { coefficient, factors });
    }

    /// Takes a term out of a sum, with all that it offered.
    fn remove(&mut self, sum: usize, at: usize) {
        let entries = &mut self.sums[sum].entries;
        let gone = entries.swap_remove(at);
        let factors = &self.terms[gone.term as usize].factors;
        let mut alone = self.offered[gone.row as usize..gone.pairs as usize].iter();
        gone.item.offers(factors, gone.term, |offer| {
            alone.next().into_iter().for_each(|known| self.market.take(known.number(), offer.saved));
        });
        for other in entries.iter() {
            let (older, newer) = if gone.birth < other.birth { (&gone, other) } else { (other, &gone) };
            let offered = self.offered[(newer.pairs + older.birth) as usize];
            let (first, second) = if offered.ordered() { (older, newer) } else { (newer, older) };
            let pair = Pair::again(&first.item, &second.item, self.market.first(offered.number()));
            self.market.take(offered.number(), pair.saved());
        }
    }

    fn divisor(&self, origin: Origin) -> Divisor {
        let coefficient = |i: u32| self.terms[i as usize].coefficient;
        let term = |i: u32| (coefficient(i), &self.terms[i as usize].factors[..]);
        match origin {
            Origin::Pair(i, j) => Divisor::pair(term(i), term(j)),
            Origin::Product(a, b) => Divisor::Product(a, b),
            Origin::Scaled(a, i) => Divisor::Scaled(a, coefficient(i).abs()),
        }
    }

    fn extract(&mut self, best: &Best) {
        let divisor = self.divisor(best.origin);
        let node = self.nodes.len() as Id;
        let rarest = divisor.nodes().min_by_key(|id| self.places[*id as usize].len());
        let mut places = rarest.map_or(Vec::new(), |id| self.places[id as usize].to_vec());
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
        self.places.push(SmallVec::new());
        self.hashes.push(0);
        for list in found.chunk_by(|a, b| a.sum == b.sum) {
            let mut gone: Vec<usize> = list.iter().flat_map(|r| r.gone.iter().copied()).collect();
            gone.sort_unstable();
            gone.into_iter().rev().for_each(|at| self.remove(list[0].sum, at));
            list.iter().for_each(|r| self.insert(r.sum, exact(r.coefficient / scale), Factors::from_slice(&r.factors)));
        }
        let new = self.sums.len();
        self.sums.push(Sum::default());
        for term in divisor.definition(scale) {
            self.insert(new, term.coefficient, term.factors);
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
            let before: i32 = r.gone.iter().map(|at| self.sums[r.sum].entries[*at].item.cost()).sum();
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
        let entries = &self.sums[sum].entries;
        let factors = |entry: &Entry| &self.terms[entry.term as usize].factors;
        let containing = |marks: u64| entries.iter().enumerate().filter(move |(_, e)| e.item.may_contain(marks));
        match divisor {
            Divisor::Product(a, b) => {
                for (i, entry) in containing(marks_of(&[*a, *b])) {
                    let mut rest = Factors::from_slice(factors(entry));
                    let mut times = 0;
                    while let Some(less) = without(&rest, &[*a, *b]) {
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
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
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
