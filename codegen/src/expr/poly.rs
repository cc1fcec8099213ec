//! Polynomials over atoms, kept canonical by construction.
//!
//! The one algebraic law built in is `sin²a = 1 − cos²a`: a monomial holds at most one factor
//! `sin a` of each angle. Coefficients are `f64`; a sum that cancels to rounding noise is zero.

use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A coefficient that cancels below this share of its summands is taken to be zero.
const CANCELLED: f64 = 1e-12;

/// An atom. The two high bits mark the cosine and the sine of an angle, which share an index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Var(u32);

impl Var {
    const COS: u32 = 1 << 30;
    const SIN: u32 = 1 << 31;

    pub(super) fn plain(index: usize) -> Var {
        Var(index as u32)
    }

    pub(super) fn cos(angle: usize) -> Var {
        Var(angle as u32 | Var::COS)
    }

    pub(super) fn sin(angle: usize) -> Var {
        Var(angle as u32 | Var::SIN)
    }

    pub(super) fn index(self) -> usize {
        (self.0 & !(Var::SIN | Var::COS)) as usize
    }

    /// Whether this is `sin` of some angle.
    pub fn is_sin(self) -> bool {
        self.0 & Var::SIN != 0
    }

    /// Whether this is `cos` of some angle.
    pub fn is_cos(self) -> bool {
        self.0 & Var::COS != 0
    }

    fn cosine_of_same_angle(self) -> Var {
        Var(self.0 & !Var::SIN | Var::COS)
    }
}

/// A product of atoms: sorted, repeated factors listed repeatedly; empty for the constant term.
pub type Monomial = SmallVec<[Var; 6]>;

/// A sum of monomials with coefficients, in canonical form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Poly {
    terms: BTreeMap<Monomial, f64>,
}

impl Poly {
    pub fn zero() -> Poly {
        Poly::default()
    }

    pub fn constant(value: f64) -> Poly {
        let mut p = Poly::zero();
        p.add_term(Monomial::new(), value);
        p
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The value, if this is a constant.
    pub fn as_constant(&self) -> Option<f64> {
        match self.terms.len() {
            0 => Some(0.0),
            1 => self.terms.iter().next().filter(|(m, _)| m.is_empty()).map(|(_, c)| *c),
            _ => None,
        }
    }

    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, f64)> {
        self.terms.iter().map(|(m, c)| (m, *c))
    }

    pub fn len(&self) -> usize {
        self.terms.len()
    }

    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// Adds `coefficient · monomial`, reducing squares of sines.
    pub fn add_term(&mut self, mut monomial: Monomial, coefficient: f64) {
        if coefficient == 0.0 {
            return;
        }
        let square = monomial.windows(2).position(|w| w[0] == w[1] && w[0].is_sin());
        if let Some(at) = square {
            let cosine = monomial[at].cosine_of_same_angle();
            monomial.remove(at);
            monomial.remove(at);
            let with_cosines = times(&monomial, &[cosine, cosine]);
            self.add_term(monomial, coefficient);
            self.add_term(with_cosines, -coefficient);
            return;
        }
        use std::collections::btree_map::Entry;
        match self.terms.entry(monomial) {
            Entry::Vacant(e) => {
                e.insert(coefficient);
            }
            Entry::Occupied(mut e) => {
                let old = *e.get();
                let sum = old + coefficient;
                if sum.abs() <= CANCELLED * old.abs().max(coefficient.abs()) {
                    e.remove();
                } else {
                    e.insert(sum);
                }
            }
        }
    }

    pub fn scaled(&self, factor: f64) -> Poly {
        if factor == 0.0 {
            return Poly::zero();
        }
        Poly { terms: self.terms.iter().map(|(m, c)| (m.clone(), c * factor)).collect() }
    }

    /// The terms for which `keep` holds of their monomial.
    pub fn filtered(&self, keep: impl Fn(&Monomial) -> bool) -> Poly {
        Poly { terms: self.terms.iter().filter(|(m, _)| keep(m)).map(|(m, c)| (m.clone(), *c)).collect() }
    }

    /// Equal but for rounding of the coefficients.
    pub fn is_close_to(&self, other: &Poly) -> bool {
        let close = |c: f64, d: f64| (c - d).abs() <= 1e-13 * c.abs();
        self.len() == other.len() && self.terms().zip(other.terms()).all(|((m, c), (n, d))| m == n && close(c, d))
    }

    /// The factors that all terms share, and what is left without them.
    pub fn common_factors(&self) -> (Monomial, Poly) {
        let Some(mut shared) = self.terms.keys().next().cloned() else { return (Monomial::new(), Poly::zero()) };
        for monomial in self.terms.keys() {
            let mut rest = monomial.clone();
            shared.retain(|factor| rest.iter().position(|r| r == factor).map(|at| rest.remove(at)).is_some());
        }
        let without = |monomial: &Monomial| {
            let mut rest = monomial.clone();
            for factor in &shared {
                if let Some(at) = rest.iter().position(|r| r == factor) {
                    rest.remove(at);
                }
            }
            rest
        };
        let rest = Poly { terms: self.terms.iter().map(|(m, c)| (without(m), *c)).collect() };
        (shared, rest)
    }

    pub fn contains(&self, var: Var) -> bool {
        self.terms.keys().any(|m| m.contains(&var))
    }
}

/// The product of two sorted factor lists.
pub(super) fn times(a: &[Var], b: &[Var]) -> Monomial {
    let mut product = Monomial::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        if a[i] <= b[j] {
            product.push(a[i]);
            i += 1;
        } else {
            product.push(b[j]);
            j += 1;
        }
    }
    product.extend_from_slice(&a[i..]);
    product.extend_from_slice(&b[j..]);
    product
}

impl From<Var> for Poly {
    fn from(var: Var) -> Poly {
        let mut p = Poly::zero();
        p.add_term(Monomial::from_slice(&[var]), 1.0);
        p
    }
}

impl AddAssign<&Poly> for Poly {
    fn add_assign(&mut self, rhs: &Poly) {
        for (m, c) in rhs.terms() {
            self.add_term(m.clone(), c);
        }
    }
}

impl Add for &Poly {
    type Output = Poly;
    fn add(self, rhs: &Poly) -> Poly {
        let mut sum = self.clone();
        sum += rhs;
        sum
    }
}

impl Sub for &Poly {
    type Output = Poly;
    fn sub(self, rhs: &Poly) -> Poly {
        let mut difference = self.clone();
        for (m, c) in rhs.terms() {
            difference.add_term(m.clone(), -c);
        }
        difference
    }
}

impl Neg for &Poly {
    type Output = Poly;
    fn neg(self) -> Poly {
        self.scaled(-1.0)
    }
}

impl Mul for &Poly {
    type Output = Poly;
    fn mul(self, rhs: &Poly) -> Poly {
        if let Some(factor) = rhs.as_constant() {
            return self.scaled(factor);
        }
        let mut product = Poly::zero();
        for (m, c) in self.terms() {
            for (n, d) in rhs.terms() {
                product.add_term(times(m, n), c * d);
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_sine_and_cosine_sum_to_one() {
        let (s, c) = (Poly::from(Var::sin(3)), Poly::from(Var::cos(3)));
        let sum = &(&s * &s) + &(&c * &c);
        assert_eq!(sum.as_constant(), Some(1.0));
    }

    #[test]
    fn like_terms_are_collected_and_cancel() {
        let (x, y) = (Poly::from(Var::plain(0)), Poly::from(Var::plain(1)));
        let sum = &x + &y;
        let square = &sum * &sum;
        assert_eq!(square.len(), 3);
        let difference = &(&square - &(&x * &x)) - &(&y * &y);
        assert_eq!(difference, (&x * &y).scaled(2.0));
    }

    #[test]
    fn higher_powers_of_sine_reduce() {
        let (s, c) = (Poly::from(Var::sin(0)), Poly::from(Var::cos(0)));
        let s2 = &s * &s;
        let s4 = &s2 * &s2;
        // sin⁴ = 1 − 2cos² + cos⁴
        let expected = &(&Poly::constant(1.0) - &(&c * &c).scaled(2.0)) + &(&(&c * &c) * &(&c * &c));
        assert_eq!(s4, expected);
    }
}
