//! Divisors: what several terms of several sums have in common, so that it pays to compute it once.
//!
//! Divisors are looked up by hashes that do not depend on the order of factors: the hash of a
//! product is the sum of its factors' hashes, so that a quotient's is a difference. Where a hash
//! decides about a rewriting, the factors themselves are compared too.

use super::market::Origin;
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

/// One occurrence of a divisor.
pub struct Offer<'a> {
    pub key: u64,
    /// Operations that a definition costs, with the first or the second part's coefficient 1.
    pub cost: [i32; 2],
    /// Operations that this occurrence then saves.
    pub saved: [i32; 2],
    source: Source<'a>,
}

enum Source<'a> {
    Pair(&'a Item, &'a Item, f64),
    Product(Id, Id),
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
        let marks = factors.iter().fold(0, |marks, id| marks | 1 << (id % 64));
        Item { coefficient, factors, hash, marks }
    }

    pub fn cost(&self) -> i32 {
        cost(self.coefficient, self.factors.len())
    }

    /// Divisors within this term.
    pub fn offers(&self, mut found: impl FnMut(Offer)) {
        let f = &self.factors;
        for (i, a) in f.iter().enumerate() {
            let repeated = i > 0 && f[i - 1] == *a;
            if !repeated && self.coefficient.abs() != 1.0 {
                let size = self.coefficient.abs();
                let key = scaled_key(*a, size);
                found(Offer { key, cost: [1; 2], saved: [1; 2], source: Source::Scaled(*a, size) });
            }
            for (j, b) in f.iter().enumerate().skip(i + 1) {
                // Each different pair once, a square once.
                if (repeated && *b != *a) || (j > i + 1 && f[j - 1] == *b) || (repeated && i > 1 && f[i - 2] == *a) {
                    continue;
                }
                let key = mix(hash_of_node(*a).wrapping_add(hash_of_node(*b)) ^ 1);
                let count = |id: &Id| f.iter().filter(|other| *other == id).count() as i32;
                let times = if a == b { count(a) / 2 } else { count(a).min(count(b)) };
                found(Offer { key, cost: [1; 2], saved: [times; 2], source: Source::Product(*a, *b) });
            }
        }
    }

    /// What this term and another of the same sum have in common.
    pub fn offer_with<'a>(&'a self, other: &'a Item) -> Offer<'a> {
        let (mut shared, mut count) = (0u64, 0);
        let (a, b) = (&self.factors[..], &other.factors[..]);
        let (mut i, mut j) = (0, 0);
        while self.marks & other.marks != 0 && i < a.len() && j < b.len() {
            match a[i].cmp(&b[j]) {
                std::cmp::Ordering::Equal => {
                    shared = shared.wrapping_add(hash_of_node(a[i]));
                    count += 1;
                    i += 1;
                    j += 1;
                }
                std::cmp::Ordering::Less => i += 1,
                std::cmp::Ordering::Greater => j += 1,
            }
        }
        let (h1, h2) = (self.hash.wrapping_sub(shared), other.hash.wrapping_sub(shared));
        let (x, y, h1, h2) = if h1 <= h2 { (self, other, h1, h2) } else { (other, self, h2, h1) };
        let (n1, n2) = (x.factors.len() - count, y.factors.len() - count);
        let ratio = exact(y.coefficient / x.coefficient);
        let key = mix(h1.wrapping_add(mix(h2 ^ mix(rounded(ratio)))) ^ 2);
        let products = n1.saturating_sub(1) as i32 + n2.saturating_sub(1) as i32 + 1;
        let scale = |factors: usize| i32::from(factors > 0 && !is_unit(ratio));
        let before = x.cost() + y.cost() + 1;
        Offer {
            key,
            cost: [products + scale(n2), products + scale(n1)],
            saved: [before - cost(x.coefficient, count + 1), before - cost(y.coefficient, count + 1)],
            source: Source::Pair(x, y, ratio),
        }
    }
}

impl Offer<'_> {
    /// How to find it again, in the terms numbered `first` and `second`.
    pub fn origin(&self, first: u32, second: u32) -> Origin {
        match self.source {
            Source::Pair(..) => Origin::Pair(first, second),
            Source::Product(a, b) => Origin::Product(a, b),
            Source::Scaled(a, _) => Origin::Scaled(a, first),
        }
    }

    pub fn divisor(&self) -> Divisor {
        match self.source {
            Source::Pair(x, y, ratio) => {
                let first = quotient(&x.factors, &y.factors);
                Divisor::Pair { first, second: quotient(&y.factors, &x.factors), ratio }
            }
            Source::Product(a, b) => Divisor::Product(a, b),
            Source::Scaled(a, size) => Divisor::Scaled(a, size),
        }
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
