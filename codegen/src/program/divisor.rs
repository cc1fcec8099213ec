//! Divisors: what several terms of several sums have in common, so that it pays to compute it once.
//!
//! Divisors are looked up by hashes that do not depend on the order of factors: the hash of a
//! product is the sum of its factors' hashes, so that a quotient's is a difference. Where a hash
//! decides about a rewriting, the factors themselves are compared too.

use super::market::{Offer, Origin};
use super::{Id, Sum, Term};
use smallvec::SmallVec;

pub type Factors = SmallVec<[Id; 6]>;

/// Something that can become a node of its own.
#[derive(Clone, Debug)]
pub enum Divisor {
    /// `first + ratio · second`, no common factor.
    Pair { first: Factors, second: Factors, ratio: f64 },
    /// Product of two nodes.
    Product(Id, Id),
    /// A node times a positive number.
    Scaled(Id, f64),
}

/// A term with the hash of its factors.
#[derive(Clone, Debug)]
pub struct Item {
    pub coefficient: f64,
    pub factors: Factors,
    pub hash: u64,
    /// Which nodes can occur among the factors: a bit per node modulo 64.
    marks: u64,
    /// Whether a node occurs twice.
    repeats: bool,
}

/// What two terms of a sum have in common: the hash of their common factors and how many there are.
#[derive(Clone, Copy, Default)]
struct Shared {
    hash: u64,
    count: usize,
}

/// Finds what other terms have in common with one.
pub struct Comparison<'a> {
    item: &'a Item,
    /// The hash of each node that the term contains, 0 for others.
    hashes: &'a mut [u64],
}

/// SplitMix64: spreads consecutive numbers over all bits.
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

fn hash_of_node(id: Id) -> u64 {
    mix((u64::from(id) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// A bit per node modulo 64.
pub fn marks_of(factors: &[Id]) -> u64 {
    factors.iter().fold(0, |marks, id| marks | 1 << (id % 64))
}

pub fn hash_of(factors: &[Id]) -> u64 {
    factors.iter().fold(0, |sum, id| sum.wrapping_add(hash_of_node(*id)))
}

/// Key of the divisor `size · a`.
pub fn scaled_key(a: Id, size: f64) -> u64 {
    mix(hash_of_node(a) ^ mix(rounded(size)))
}

/// A coefficient without its last bits, which are rounding.
pub fn rounded(value: f64) -> u64 {
    const NOISE: u32 = 8;
    (value.to_bits() + (1 << (NOISE - 1))) >> NOISE
}

fn is_unit(value: f64) -> bool {
    rounded(value.abs()) == rounded(1.0)
}

/// ±1 where `value` is that but for rounding.
pub fn exact(value: f64) -> f64 {
    if is_unit(value) { value.signum() } else { value }
}

/// Multiplications of a term.
pub fn cost(coefficient: f64, factors: usize) -> i32 {
    if factors == 0 { 0 } else { factors as i32 - 1 + i32::from(coefficient.abs() != 1.0) }
}

impl Item {
    pub fn new(coefficient: f64, mut factors: Factors) -> Item {
        factors.sort_unstable();
        let hash = hash_of(&factors);
        let marks = marks_of(&factors);
        let repeats = factors.windows(2).any(|w| w[0] == w[1]);
        Item { coefficient, factors, hash, marks, repeats }
    }

    pub fn cost(&self) -> i32 {
        cost(self.coefficient, self.factors.len())
    }

    /// Whether it may have all factors with these marks.
    pub fn may_contain(&self, marks: u64) -> bool {
        self.marks & marks == marks
    }

    /// Divisors within this term, numbered `number`, and what each saves here.
    pub fn offers(&self, number: u32, mut found: impl FnMut(Offer, [i32; 2])) {
        let f = &self.factors;
        let mut offer = |key, origin, saved| found(Offer { key, origin, cost: [1; 2], first: 0 }, [saved; 2]);
        let scaled = self.coefficient.abs() != 1.0;
        for (i, a) in f.iter().enumerate() {
            let repeated = i > 0 && f[i - 1] == *a;
            if !repeated && scaled {
                offer(scaled_key(*a, self.coefficient.abs()), Origin::Scaled(*a, number), 1);
            }
            let hash = hash_of_node(*a);
            for (j, b) in f.iter().enumerate().skip(i + 1) {
                let mut times = 1;
                if self.repeats {
                    // Each different pair once, a square once.
                    if (repeated && *b != *a) || (j > i + 1 && f[j - 1] == *b) || (repeated && i > 1 && f[i - 2] == *a)
                    {
                        continue;
                    }
                    let count = |id: &Id| f.iter().filter(|other| *other == id).count() as i32;
                    times = if a == b { count(a) / 2 } else { count(a).min(count(b)) };
                }
                let key = mix(hash.wrapping_add(hash_of_node(*b)) ^ 1);
                offer(key, Origin::Product(*a, *b), times);
            }
        }
    }

    fn shared(&self, other: &Item) -> Shared {
        let mut shared = Shared::default();
        let (a, b) = (&self.factors[..], &other.factors[..]);
        let (mut i, mut j) = (0, 0);
        while i < a.len() && j < b.len() {
            match a[i].cmp(&b[j]) {
                std::cmp::Ordering::Equal => {
                    shared.hash = shared.hash.wrapping_add(hash_of_node(a[i]));
                    shared.count += 1;
                    i += 1;
                    j += 1;
                }
                std::cmp::Ordering::Less => i += 1,
                std::cmp::Ordering::Greater => j += 1,
            }
        }
        shared
    }

    /// What this term, first in a pair, and another save if the pair with `shared` common factors is replaced.
    pub fn saved(&self, other: &Item, shared: usize) -> [i32; 2] {
        let before = self.cost() + other.cost() + 1;
        [before - cost(self.coefficient, shared + 1), before - cost(other.coefficient, shared + 1)]
    }
}

impl<'a> Comparison<'a> {
    /// `hashes` has a zero for every node.
    pub fn new(item: &'a Item, hashes: &'a mut [u64]) -> Comparison<'a> {
        item.factors.iter().for_each(|id| hashes[*id as usize] = hash_of_node(*id));
        Comparison { item, hashes }
    }

    fn shared(&self, other: &Item) -> Shared {
        if self.item.marks & other.marks == 0 {
            Shared::default()
        } else if other.repeats {
            self.item.shared(other)
        } else {
            let mut shared = Shared::default();
            for id in &other.factors {
                let hash = self.hashes[*id as usize];
                shared.hash = shared.hash.wrapping_add(hash);
                shared.count += usize::from(hash != 0);
            }
            shared
        }
    }

    /// The pair of another term and this one, whether the other comes first in it, and what it saves.
    pub fn offer_with(&self, other: &Item, numbers: [u32; 2]) -> (Offer, bool, [i32; 2]) {
        let item = self.item;
        let Shared { hash, count } = self.shared(other);
        let (h1, h2) = (other.hash.wrapping_sub(hash), item.hash.wrapping_sub(hash));
        let ordered = h1 <= h2;
        let (x, y, h1, h2) = if ordered { (other, item, h1, h2) } else { (item, other, h2, h1) };
        let (n1, n2) = (x.factors.len() - count, y.factors.len() - count);
        let ratio = exact(y.coefficient / x.coefficient);
        let key = mix(h1.wrapping_add(mix(h2 ^ mix(rounded(ratio)))) ^ 2);
        let products = n1.saturating_sub(1) as i32 + n2.saturating_sub(1) as i32 + 1;
        let scale = |factors: usize| i32::from(factors > 0 && !is_unit(ratio));
        let [first, second] = numbers;
        let offer = Offer {
            key,
            origin: Origin::Pair(first, second),
            cost: [products + scale(n2), products + scale(n1)],
            first: n1 as u16,
        };
        (offer, ordered, x.saved(y, count))
    }
}

impl Drop for Comparison<'_> {
    fn drop(&mut self) {
        self.item.factors.iter().for_each(|id| self.hashes[*id as usize] = 0);
    }
}

/// The factors of `a` that `b` does not have.
fn quotient(a: &[Id], b: &[Id]) -> Factors {
    let mut j = 0;
    a.iter()
        .filter(|id| {
            while j < b.len() && b[j] < **id {
                j += 1;
            }
            let shared = j < b.len() && b[j] == **id;
            j += usize::from(shared);
            !shared
        })
        .copied()
        .collect()
}

/// `factors` without those listed, if it has them all.
pub fn without(factors: &[Id], remove: &[Id]) -> Option<Factors> {
    let rest = quotient(factors, remove);
    (rest.len() + remove.len() == factors.len()).then_some(rest)
}

impl Divisor {
    /// What two terms have in common.
    pub fn pair(a: &Item, b: &Item) -> Divisor {
        let hash = a.shared(b).hash;
        let ordered = a.hash.wrapping_sub(hash) <= b.hash.wrapping_sub(hash);
        let (x, y) = if ordered { (a, b) } else { (b, a) };
        let ratio = exact(y.coefficient / x.coefficient);
        Divisor::Pair { first: quotient(&x.factors, &y.factors), second: quotient(&y.factors, &x.factors), ratio }
    }

    /// The nodes that it is made of.
    pub fn nodes(&self) -> impl Iterator<Item = Id> {
        let (nodes, more): (&[Id], &[Id]) = match self {
            Divisor::Pair { first, second, .. } => (first, second),
            Divisor::Product(a, b) => (std::slice::from_ref(a), std::slice::from_ref(b)),
            Divisor::Scaled(a, _) => (std::slice::from_ref(a), &[]),
        };
        nodes.iter().chain(more).copied()
    }

    /// The sum that defines it; a pair's first part gets the coefficient `scale`.
    pub fn definition(&self, scale: f64) -> Sum {
        let term = |coefficient: f64, factors: &[Id]| Term { coefficient: exact(coefficient), factors: factors.into() };
        match self {
            Divisor::Pair { first, second, ratio } => vec![term(scale, first), term(ratio * scale, second)],
            Divisor::Product(a, b) => vec![term(1.0, &[*a, *b])],
            Divisor::Scaled(a, size) => vec![term(*size, &[*a])],
        }
    }
}
