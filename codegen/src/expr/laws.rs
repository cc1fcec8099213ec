//! The laws of algebra by which polynomials become canonical, so that equal expressions are equal data.
//!
//! What polynomials are made of holds some laws by itself: there is no way to write the one side so that it differs
//! from the other. The others rewrite what violates them, and [`Terms`](super::Terms) applies them until nothing does:
//! those of a term as it is added, those of like terms as they are collected. One law more is one entry more. Each has
//! a test of its name in `tests/algebra.rs`, on random numbers.

use super::poly::{Monomial, Poly, times};
use smallvec::SmallVec;

/// A law: its name, what it says, and what makes it hold.
#[derive(Clone, Copy)]
pub struct Law<F> {
    pub name: &'static str,
    pub formula: &'static str,
    pub holds: F,
}

/// Terms in place of one.
pub type Rewritten = SmallVec<[(Monomial, f64); 2]>;

/// Rewrites a term, given its atoms and its number.
pub type OfTerm = fn(&Monomial, f64) -> Option<Rewritten>;
/// The number of two terms with the same atoms, given those of either.
pub type OfLikeTerms = fn(f64, f64) -> Option<f64>;
/// Takes apart a function of a sum of two angles, given sine and cosine of either.
pub type OfSumOfAngles = fn([&Poly; 2], [&Poly; 2]) -> Poly;

/// Laws of the representation, and which part of it holds them.
pub const OF_STRUCTURE: [Law<&str>; 7] = [
    Law { name: "sums_commute", formula: "x + y = y + x", holds: "terms are sorted" },
    Law { name: "sums_associate", formula: "(x + y) + z = x + (y + z)", holds: "a sum is one list" },
    Law { name: "products_commute", formula: "x y = y x", holds: "atoms are sorted" },
    Law { name: "products_associate", formula: "(x y) z = x (y z)", holds: "a product is one list" },
    Law { name: "products_distribute", formula: "x (y + z) = x y + x z", holds: "terms hold no sums" },
    Law { name: "one_is_neutral", formula: "1 x = x", holds: "numbers are no atoms" },
    Law { name: "numbers_are_folded", formula: "a b x = (ab) x", holds: "a term has one number" },
];

/// Laws of a term.
pub const OF_A_TERM: [Law<OfTerm>; 2] = [
    Law { name: "nothing_times_anything", formula: "0 x = 0", holds: nothing_times_anything },
    Law { name: "squares_of_sines", formula: "sin² = 1 − cos²", holds: squares_of_sines },
];

/// Laws of terms with the same atoms.
pub const OF_LIKE_TERMS: [Law<OfLikeTerms>; 2] = [
    Law { name: "rounding_cancels", formula: "a x + b x = 0 where a + b is rounding", holds: rounding_cancels },
    Law { name: "like_terms_are_collected", formula: "a x + b x = (a + b) x", holds: like_terms_are_collected },
];

/// Laws of a sum of two angles. They apply where an angle is to be split
/// ([`Ring::split_angles`](super::Ring::split_angles)).
pub const OF_SUMS_OF_ANGLES: [Law<OfSumOfAngles>; 2] = [
    Law { name: "sine_of_a_sum", formula: "sin(a + b) = sin a cos b + cos a sin b", holds: sine_of_a_sum },
    Law { name: "cosine_of_a_sum", formula: "cos(a + b) = cos a cos b − sin a sin b", holds: cosine_of_a_sum },
];

fn nothing_times_anything(_: &Monomial, coefficient: f64) -> Option<Rewritten> {
    (coefficient == 0.0).then(Rewritten::new)
}

fn squares_of_sines(monomial: &Monomial, coefficient: f64) -> Option<Rewritten> {
    // Sines come last.
    let first = monomial.len() - monomial.iter().rev().take_while(|v| v.is_sin()).count();
    let at = first + monomial[first..].windows(2).position(|w| w[0] == w[1])?;
    let cosine = monomial[at].cosine_of_same_angle();
    let mut rest = Monomial::from_slice(&monomial[..at]);
    rest.extend_from_slice(&monomial[at + 2..]);
    let with_cosines = times(&rest, &[cosine, cosine]);
    Some(Rewritten::from_iter([(rest, coefficient), (with_cosines, -coefficient)]))
}

/// A coefficient that cancels below this share of its summands is taken to be zero.
const CANCELLED: f64 = 1e-12;

fn rounding_cancels(a: f64, b: f64) -> Option<f64> {
    ((a + b).abs() <= CANCELLED * a.abs().max(b.abs())).then_some(0.0)
}

fn like_terms_are_collected(a: f64, b: f64) -> Option<f64> {
    Some(a + b)
}

fn sine_of_a_sum([sin_a, cos_a]: [&Poly; 2], [sin_b, cos_b]: [&Poly; 2]) -> Poly {
    &(sin_a * cos_b) + &(cos_a * sin_b)
}

fn cosine_of_a_sum([sin_a, cos_a]: [&Poly; 2], [sin_b, cos_b]: [&Poly; 2]) -> Poly {
    &(cos_a * cos_b) - &(sin_a * sin_b)
}
