//! The laws of algebra by which expressions and programs are simplified: one list each, one test per law.
//!
//! A law is checked on random numbers, and the rewriting is seen to happen: both sides become the same
//! polynomial, or the program needs the operations that the law promises.

use piaffe_codegen::dynamics::Kernel;
use piaffe_codegen::expr::{Poly, Ring, Var, laws};
use piaffe_codegen::program::Program;
use proptest::prelude::*;
use std::ops::{Add, Mul, Neg, Sub};

/// An expression as a person writes it.
#[derive(Clone, Debug)]
enum Term {
    Number(f64),
    Symbol(usize),
    Sin(usize),
    Cos(usize),
    /// Of the sum of the first two symbols.
    SinOfSum,
    CosOfSum,
    Sum(Box<Term>, Box<Term>),
    Product(Box<Term>, Box<Term>),
}

macro_rules! operator {
    ($name:ident, $method:ident, |$a:ident, $b:ident| $value:expr) => {
        impl $name for Term {
            type Output = Term;
            fn $method(self, other: Term) -> Term {
                let ($a, $b) = (Box::new(self), Box::new(other));
                $value
            }
        }
    };
}
operator!(Add, add, |a, b| Term::Sum(a, b));
operator!(Mul, mul, |a, b| Term::Product(a, b));
operator!(Sub, sub, |a, b| Term::Sum(a, Box::new(-*b)));

impl Neg for Term {
    type Output = Term;
    fn neg(self) -> Term {
        Term::Number(-1.0) * self
    }
}

/// Symbols of the laws.
const NAMES: [&str; 4] = ["x", "y", "z", "w"];

impl Term {
    fn value(&self, numbers: &[f64]) -> f64 {
        match self {
            Term::Number(k) => *k,
            Term::Symbol(i) => numbers[*i],
            Term::Sin(i) => numbers[*i].sin(),
            Term::Cos(i) => numbers[*i].cos(),
            Term::SinOfSum => (numbers[0] + numbers[1]).sin(),
            Term::CosOfSum => (numbers[0] + numbers[1]).cos(),
            Term::Sum(a, b) => a.value(numbers) + b.value(numbers),
            Term::Product(a, b) => a.value(numbers) * b.value(numbers),
        }
    }

    fn poly(&self, ring: &mut Ring, symbols: &[Var]) -> Poly {
        match self {
            Term::Number(k) => Poly::constant(*k),
            Term::Symbol(i) => symbols[*i].into(),
            Term::Sin(i) => ring.sin_cos(&symbols[*i..=*i]).0,
            Term::Cos(i) => ring.sin_cos(&symbols[*i..=*i]).1,
            Term::SinOfSum => ring.sin_cos(&symbols[..2]).0,
            Term::CosOfSum => ring.sin_cos(&symbols[..2]).1,
            Term::Sum(a, b) => &a.poly(ring, symbols) + &b.poly(ring, symbols),
            Term::Product(a, b) => &a.poly(ring, symbols) * &b.poly(ring, symbols),
        }
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + a.abs() + b.abs())
}

/// Both sides have the same values and become the same polynomial, of `terms` terms.
fn equal(left: &Term, right: &Term, terms: &usize, numbers: &[f64]) {
    assert!(close(left.value(numbers), right.value(numbers)), "no law: {left:?} = {right:?} at {numbers:?}");
    let mut ring = Ring::new();
    let symbols = NAMES.map(|name| ring.symbol(name));
    let [l, r] = [left, right].map(|side| {
        let p = side.poly(&mut ring, &symbols);
        ring.split_angles(&p, symbols[0])
    });
    assert_eq!(l, r, "not rewritten");
    assert_eq!(l.len(), *terms);
}

/// A kernel of these sums needs `operations` additions and multiplications, and gives their values.
fn cost(sums: &[Term], operations: &usize, numbers: &[f64]) {
    let mut ring = Ring::new();
    let symbols = NAMES.map(|name| ring.symbol(name));
    let values: Vec<Poly> = sums.iter().map(|s| s.poly(&mut ring, &symbols)).collect();
    let kernel = Kernel::new("sums", "").input("numbers", symbols.to_vec()).vector("values", values, "");
    let program = Program::new(&ring, &kernel);
    assert_eq!(program.operations().flops, *operations);
    for (found, sum) in program.evaluate(&[numbers.to_vec()])[0].iter().zip(sums) {
        assert!(close(*found, sum.value(numbers)), "{found} instead of {}", sum.value(numbers));
    }
}

macro_rules! vocabulary {
    ($($name:ident = $term:expr;)+) => { $(fn $name() -> Term { $term })+ };
}
vocabulary! {
    x = Term::Symbol(0);
    y = Term::Symbol(1);
    z = Term::Symbol(2);
    w = Term::Symbol(3);
    sin = Term::Sin(0);
    cos = Term::Cos(0);
    sin_y = Term::Sin(1);
    cos_y = Term::Cos(1);
}

fn k(number: f64) -> Term {
    Term::Number(number)
}

/// One test per law.
macro_rules! laws {
    ($list:tt, $check:ident: $($(#[$law:meta])+ $name:ident($($argument:expr),+);)+) => {
        const $list: &[&str] = &[$(stringify!($name)),+];
        proptest! { $(
            $(#[$law])+
            #[test]
            fn $name(numbers in prop::collection::vec(-2.0..2.0f64, NAMES.len())) {
                $check($(&$argument,)+ &numbers);
            }
        )+ }
    };
}

// Expressions.
laws! { EXPRESSIONS, equal:
    /// x + y = y + x
    sums_commute(x() + y(), y() + x(), 2);
    /// (x + y) + z = x + (y + z)
    sums_associate((x() + y()) + z(), x() + (y() + z()), 3);
    /// x y = y x
    products_commute(x() * y(), y() * x(), 1);
    /// (x y) z = x (y z)
    products_associate((x() * y()) * z(), x() * (y() * z()), 1);
    /// x (y + z) = x y + x z
    products_distribute(x() * (y() + z()), x() * y() + x() * z(), 2);
    /// a x + b x = (a + b) x
    like_terms_are_collected(k(2.5) * x() + k(0.25) * x(), k(2.75) * x(), 1);
    /// x − x = 0
    what_cancels_is_gone(x() * y() - y() * x(), k(0.0), 0);
    /// 0.1 x + 0.2 x − 0.3 x = 0, but for rounding
    rounding_cancels(k(0.1) * x() + k(0.2) * x() - k(0.3) * x(), k(0.0), 0);
    /// 0 x = 0
    nothing_times_anything(k(0.0) * x() + y(), y(), 1);
    /// 1 x = x
    one_is_neutral(k(1.0) * x(), x(), 1);
    /// a b is a number
    numbers_are_folded(k(1.5) * k(2.0) + k(0.5), k(3.5), 1);
    /// sin² = 1 − cos²
    squares_of_sines(sin() * sin(), k(1.0) - cos() * cos(), 2);
    /// sin(x + y) = sin x cos y + cos x sin y
    sine_of_a_sum(Term::SinOfSum, sin() * cos_y() + cos() * sin_y(), 2);
    /// cos(x + y) = cos x cos y − sin x sin y
    cosine_of_a_sum(Term::CosOfSum, cos() * cos_y() - sin() * sin_y(), 2);
    /// sin² + cos² = 1
    sine_and_cosine_on_the_circle(y() * sin() * sin() + y() * cos() * cos(), y(), 1);
}

// Programs.
laws! { _, cost:
    /// x y + x z = x (y + z): 2 instead of 3
    common_factors([x() * y() + x() * z()], 2);
    /// x + y in two sums: 3 instead of 4
    common_sums([(x() + y()) * z(), (x() + y()) * w()], 3);
    /// a x + b y = a (x + (b/a) y): proportional sums are one sum
    proportional_sums([k(2.0) * x() + k(6.0) * y(), k(5.0) * x() + k(15.0) * y()], 4);
    /// x − y = −(y − x)
    opposite_sums([(x() - y()) * z(), (y() - x()) * w()], 3);
    /// x y in two products: 3 instead of 4
    common_products([x() * y() * z(), x() * y() * w()], 3);
    /// a x in two products: 3 instead of 4
    common_multiples([k(3.0) * x() * y(), k(3.0) * x() * z()], 3);
    /// (x y) (x y) = (x y)²: 2 instead of 3
    squares([x() * x() * y() * y()], 2);
    /// a x + b y, where a x and b y are wanted themselves: 3 instead of 4
    sums_of_wanted_parts([k(3.0) * x(), k(5.0) * y(), k(3.0) * x() + k(5.0) * y()], 3);
    /// x + y + z wherever they go together: 4 instead of 7
    terms_that_go_together([x() + y() + z(), (x() + y() + z()) * k(2.0) + w()], 4);
    /// equal sums are one
    equal_sums([x() + y() * z(), z() * y() + x()], 2);
}

/// The lists that expressions are simplified by have no law without a test.
#[test]
fn every_law_has_a_test() {
    let structure = laws::OF_STRUCTURE.map(|law| law.name);
    let terms = [laws::OF_A_TERM.map(|law| law.name), laws::OF_LIKE_TERMS.map(|law| law.name)];
    let angles = laws::OF_SUMS_OF_ANGLES.map(|law| law.name);
    for name in structure.iter().chain(terms.as_flattened()).chain(&angles) {
        assert!(EXPRESSIONS.contains(name), "no test of the law `{name}`");
    }
}
