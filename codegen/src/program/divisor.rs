//! Divisors: what several terms of several sums have in common, so that it pays to compute it once.
//!
//! Divisors are looked up by hashes that do not depend on the order of factors: the hash of a
//! product is the sum of its factors' hashes, so that a quotient's is a difference. Where a hash
//! decides about a rewriting, the factors themselves are compared too.

use super::Id;
use super::market::Origin;
use smallvec::SmallVec;

pub type Factors = SmallVec<[Id; 6]>;

/// Something that can become a node of its own.
#[derive(Clone, Debug)]
pub enum Divisor {
    /// `first + ratio · second`, no common factor.
    Pair { first: Factors, second: Factors, ratio: f64 },
    /// Product of two nodes.
    Product([Id; 2]),
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
    /// Where its factors stand among those of all terms, and how many they are.
    start: u32,
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

/// What two terms of a sum, the older and the younger one, offer: a pair in which either comes first.
#[derive(Clone, Copy)]
pub struct Pair {
    pub key: u64,
    shared: u16,
    /// Whether the older one comes first.
    ordered: bool,
    /// Whether one part is a multiple of the other.
    scaled: bool,
}

/// The mixing of SplitMix64: spreads numbers over all bits.
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Not for a multiple of `id`, which `mix` would nearly take to a multiple: a square must not look like a node.
pub fn hash_of_node(id: Id) -> u64 {
    mix(u64::from(id).wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x2545_F491_4F6C_DD1D))
}

/// A bit per node modulo 64.
pub fn marks_of(factors: &[Id]) -> u64 {
    factors.iter().fold(0, |marks, id| marks | 1 << (id % 64))
}

pub fn hash_of(factors: &[Id]) -> u64 {
    factors.iter().fold(0, |sum, id| sum.wrapping_add(hash_of_node(*id)))
}

/// Key of the divisor `size · a`, by the hash of a.
pub fn scaled_key(a: u64, size: f64) -> u64 {
    mix(a ^ mix(rounded(size)))
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
    /// A term whose factors, with these hashes, begin at `start` among those of all terms.
    pub fn new(coefficient: f64, factors: &[Id], hashes: &[u64], start: usize) -> Item {
        Item {
            coefficient,
            hash: hashes.iter().fold(0, |sum, hash| sum.wrapping_add(*hash)),
            marks: marks_of(factors),
            start: start as u32,
            length: factors.len() as u16,
            cost: cost(coefficient, factors.len()) as u16,
            scaled: coefficient.abs() != 1.0,
            repeats: factors.windows(2).any(|w| w[0] == w[1]),
        }
    }

    pub fn cost(&self) -> i32 {
        i32::from(self.cost)
    }

    /// Its factors among those of all terms.
    #[inline]
    pub fn factors<'f>(&self, of_all: &'f [Id]) -> &'f [Id] {
        &of_all[self.start as usize..][..usize::from(self.length)]
    }

    /// Whether it may have all factors with these marks.
    pub fn may_contain(&self, marks: u64) -> bool {
        self.marks & marks == marks
    }

    /// Divisors within this term, by its factors and their hashes: keys and how often each occurs.
    #[inline]
    pub fn divisors(&self, f: &[Id], hashes: &[u64], number: u32, mut found: impl FnMut(u64, i16, Origin)) {
        let size = self.coefficient.abs();
        for (i, (a, hash)) in f.iter().zip(hashes).enumerate() {
            let repeated = self.repeats && i > 0 && f[i - 1] == *a;
            if !repeated && self.scaled {
                found(scaled_key(*hash, size), 1, Origin::Scaled(*a, number));
            }
            for (j, (b, other)) in f.iter().zip(hashes).enumerate().skip(i + 1) {
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
                found(mix(hash.wrapping_add(*other) ^ 1), times, Origin::Product(*a, *b));
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

impl Pair {
    #[inline]
    pub fn new(older: &Item, younger: &Item, shared: Shared) -> Pair {
        let (h1, h2) = (older.hash.wrapping_sub(shared.hash), younger.hash.wrapping_sub(shared.hash));
        let ordered = h1 <= h2;
        let (first, second, h1, h2) = if ordered { (older, younger, h1, h2) } else { (younger, older, h2, h1) };
        let ratio = exact(second.coefficient / first.coefficient);
        let parts = h1.wrapping_mul(0xD6E8_FEB8_6659_FD93).wrapping_add(h2.rotate_left(23));
        let key = mix(parts.wrapping_add(rounded(ratio).wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        Pair { key, shared: shared.count, ordered, scaled: ratio.abs() != 1.0 }
    }

    fn parts<T>(self, older: T, younger: T) -> [T; 2] {
        if self.ordered { [older, younger] } else { [younger, older] }
    }

    pub fn origin(self, older: u32, younger: u32) -> Origin {
        let [first, second] = self.parts(older, younger);
        Origin::Pair(first, second)
    }

    /// Operations that a definition costs, with the first or the second part's coefficient 1.
    pub fn cost(self, older: &Item, younger: &Item) -> [i16; 2] {
        let [n1, n2] = self.parts(older, younger).map(|item| item.length - self.shared);
        let products = (n1.saturating_sub(1) + n2.saturating_sub(1) + 1) as i16;
        let scale = |factors: u16| i16::from(factors > 0 && self.scaled);
        [products + scale(n2), products + scale(n1)]
    }

    /// Operations that it saves to replace it, with the first or the second part's coefficient 1.
    #[inline]
    pub fn saved(self, older: &Item, younger: &Item) -> [i16; 2] {
        let saved = (older.cost + younger.cost + 1 - self.shared) as i16;
        self.parts(older, younger).map(|one| saved - i16::from(one.scaled))
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

    /// The terms of its definition; a pair's first part gets the coefficient `scale`.
    pub fn terms(&self, scale: f64) -> SmallVec<[(f64, &[Id]); 2]> {
        match self {
            Divisor::Pair { first, second, ratio } => {
                SmallVec::from_buf([(exact(scale), first), (exact(ratio * scale), second)])
            }
            Divisor::Product(nodes) => SmallVec::from_iter([(1.0, &nodes[..])]),
            Divisor::Scaled(node, size) => SmallVec::from_iter([(exact(*size), std::slice::from_ref(node))]),
        }
    }
}
