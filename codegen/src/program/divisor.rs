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

/// What decides about a term, at a glance.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    pub coefficient: f64,
    pub hash: u64,
    /// Which nodes can occur among the factors: a bit per node modulo 64.
    marks: u64,
    length: u16,
    /// Multiplications to evaluate it.
    cost: u16,
    /// Whether one of them is by the coefficient.
    scaled: bool,
    /// Whether a node occurs twice.
    repeats: bool,
}

/// What two terms of a sum have in common: the hash of their common factors and how many there are.
#[derive(Clone, Copy, Default)]
pub struct Shared {
    hash: u64,
    count: u16,
}

/// Two terms of a sum, of which the first comes first in their divisor.
pub struct Pair<'a> {
    first: &'a Item,
    second: &'a Item,
    shared: u16,
}

/// The mixing of SplitMix64: spreads numbers over all bits.
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Not for a multiple of `id`, which `mix` would nearly take to a multiple: a square must not look like a node.
fn hash_of_node(id: Id) -> u64 {
    mix(u64::from(id).wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x2545_F491_4F6C_DD1D))
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
    pub fn new(coefficient: f64, factors: &[Id]) -> Item {
        Item {
            coefficient,
            hash: hash_of(factors),
            marks: marks_of(factors),
            length: factors.len() as u16,
            cost: cost(coefficient, factors.len()) as u16,
            scaled: coefficient.abs() != 1.0,
            repeats: factors.windows(2).any(|w| w[0] == w[1]),
        }
    }

    pub fn cost(&self) -> i32 {
        i32::from(self.cost)
    }

    /// Whether it may have all factors with these marks.
    pub fn may_contain(&self, marks: u64) -> bool {
        self.marks & marks == marks
    }

    /// Divisors within this term.
    pub fn offers(&self, f: &[Id], number: u32, mut found: impl FnMut(Offer)) {
        let mut offer = |key: u64, origin: Origin, times: i16| {
            found(Offer { key, cost: [1; 2], first: 0, saved: [times; 2], origin });
        };
        for (i, a) in f.iter().enumerate() {
            let repeated = i > 0 && f[i - 1] == *a;
            if !repeated && self.scaled {
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
                    let count = |id: &Id| f.iter().filter(|other| *other == id).count() as i16;
                    times = if a == b { count(a) / 2 } else { count(a).min(count(b)) };
                }
                offer(mix(hash.wrapping_add(hash_of_node(*b)) ^ 1), Origin::Product(*a, *b), times);
            }
        }
    }

    /// What this term has in common with another, by the hashes of its own factors; `other` are the other's.
    #[inline]
    pub fn shared(&self, f: &[Id], hashes: &[u64], item: &Item, other: &[Id]) -> Shared {
        if self.marks & item.marks == 0 {
            Shared::default()
        } else if item.repeats {
            shared(f, other)
        } else {
            let mut shared = Shared::default();
            for id in other {
                let hash = hashes[*id as usize];
                shared.hash = shared.hash.wrapping_add(hash);
                shared.count += u16::from(hash != 0);
            }
            shared
        }
    }
}

/// The hash of each node that a term contains, 0 for others.
pub fn set_hashes(hashes: &mut [u64], factors: &[Id]) {
    factors.iter().for_each(|id| hashes[*id as usize] = hash_of_node(*id));
}

pub fn reset_hashes(hashes: &mut [u64], factors: &[Id]) {
    factors.iter().for_each(|id| hashes[*id as usize] = 0);
}

fn shared(a: &[Id], b: &[Id]) -> Shared {
    let mut shared = Shared::default();
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

impl<'a> Pair<'a> {
    /// What two terms offer, given with their numbers: a pair in which either comes first.
    #[inline]
    pub fn offer(older: (&Item, u32), newer: (&Item, u32), shared: Shared) -> Offer {
        let (h1, h2) = (older.0.hash.wrapping_sub(shared.hash), newer.0.hash.wrapping_sub(shared.hash));
        let ordered = h1 <= h2;
        let (first, second, h1, h2) = if ordered { (older, newer, h1, h2) } else { (newer, older, h2, h1) };
        let pair = Pair { first: first.0, second: second.0, shared: shared.count };
        let ratio = exact(pair.second.coefficient / pair.first.coefficient);
        let parts = h1.wrapping_mul(0xD6E8_FEB8_6659_FD93).wrapping_add(h2.rotate_left(23));
        let key = mix(parts.wrapping_add(rounded(ratio).wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        let (cost, length) = pair.definition(ratio.abs() != 1.0);
        Offer { key, cost, first: length, saved: pair.saved(), origin: Origin::Pair(first.1, second.1) }
    }

    /// A pair whose first part is known to have so many factors.
    pub fn again(first: &'a Item, second: &'a Item, length: u16) -> Pair<'a> {
        Pair { first, second, shared: first.length - length }
    }

    /// Operations that a definition costs, with the first or the second part's coefficient 1, and the first part's factors.
    fn definition(&self, scaled: bool) -> ([i16; 2], u16) {
        let (n1, n2) = (self.first.length - self.shared, self.second.length - self.shared);
        let products = (n1.saturating_sub(1) + n2.saturating_sub(1) + 1) as i16;
        let scale = |factors: u16| i16::from(factors > 0 && scaled);
        ([products + scale(n2), products + scale(n1)], n1)
    }

    /// Operations that it saves to replace it, with the first or the second part's coefficient 1.
    #[inline]
    pub fn saved(&self) -> [i16; 2] {
        let saved = (self.first.cost + self.second.cost + 1 - self.shared) as i16;
        [saved - i16::from(self.first.scaled), saved - i16::from(self.second.scaled)]
    }
}

/// The factors of `a` that `b` does not have.
fn quotient(a: &[Id], b: &[Id]) -> Factors {
    let mut rest = Factors::with_capacity(a.len());
    let mut j = 0;
    for id in a {
        while j < b.len() && b[j] < *id {
            j += 1;
        }
        if j < b.len() && b[j] == *id {
            j += 1;
        } else {
            rest.push(*id);
        }
    }
    rest
}

/// `factors` without those listed, if it has them all.
pub fn without(factors: &[Id], remove: &[Id]) -> Option<Factors> {
    let rest = quotient(factors, remove);
    (rest.len() + remove.len() == factors.len()).then_some(rest)
}

impl Divisor {
    /// What remains of two terms without their common factors.
    pub fn pair(a: (f64, &[Id]), b: (f64, &[Id])) -> Divisor {
        let (first, second) = (quotient(a.1, b.1), quotient(b.1, a.1));
        if hash_of(&first) <= hash_of(&second) {
            Divisor::Pair { first, second, ratio: exact(b.0 / a.0) }
        } else {
            Divisor::Pair { first: second, second: first, ratio: exact(a.0 / b.0) }
        }
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
