//! Polynomials over atoms, kept canonical by the [`laws`](super::laws).

use super::laws::{OF_A_TERM, OF_LIKE_TERMS};
use smallvec::SmallVec;
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

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

    /// A number for each atom that is neither sine nor cosine (0), each sine (1) and each cosine (2).
    pub fn place(self) -> (usize, usize) {
        (usize::from(self.is_sin()) + 2 * usize::from(self.is_cos()), self.index())
    }

    /// Whether this is `sin` of some angle.
    pub fn is_sin(self) -> bool {
        self.0 & Var::SIN != 0
    }

    /// Whether this is `cos` of some angle.
    pub fn is_cos(self) -> bool {
        self.0 & Var::COS != 0
    }

    pub(super) fn cosine_of_same_angle(self) -> Var {
        Var(self.0 & !Var::SIN | Var::COS)
    }
}

/// A product of atoms: sorted, repeated factors listed repeatedly; empty for the constant term.
pub type Monomial = SmallVec<[Var; 6]>;

/// A sum of monomials with coefficients, in canonical form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Poly {
    terms: Vec<(Monomial, f64)>,
}

/// Terms in any order, on their way to a polynomial.
#[derive(Default)]
pub struct Terms(Vec<(Monomial, f64)>);

impl Terms {
    /// None yet, with room for so many.
    pub fn with_capacity(room: usize) -> Terms {
        Terms(Vec::with_capacity(room))
    }

    /// Adds `coefficient · monomial`.
    pub fn add(&mut self, monomial: Monomial, coefficient: f64) {
        for law in &OF_A_TERM {
            if let Some(rewritten) = (law.holds)(&monomial, coefficient) {
                return rewritten.into_iter().for_each(|(m, c)| self.add(m, c));
            }
        }
        self.0.push((monomial, coefficient));
    }

    /// The sum of the terms; like ones are added in the order in which they came.
    pub fn collected(mut self) -> Poly {
        self.0.sort_by(|(m, _), (n, _)| m.cmp(n));
        let mut terms: Vec<(Monomial, f64)> = Vec::with_capacity(self.0.len());
        for (monomial, coefficient) in self.0 {
            match terms.last_mut() {
                Some((last, sum)) if *last == monomial => {
                    *sum = collect(*sum, coefficient);
                    if *sum == 0.0 {
                        terms.pop();
                    }
                }
                _ => terms.push((monomial, coefficient)),
            }
        }
        Poly { terms }
    }
}

/// The number of two like terms.
fn collect(a: f64, b: f64) -> f64 {
    OF_LIKE_TERMS.iter().find_map(|law| (law.holds)(a, b)).unwrap_or(a + b)
}

impl Poly {
    pub fn zero() -> Poly {
        Poly::default()
    }

    pub fn constant(value: f64) -> Poly {
        Poly::term(Monomial::new(), value)
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The value, if this is a constant.
    pub fn as_constant(&self) -> Option<f64> {
        match self.terms.len() {
            0 => Some(0.0),
            1 => self.terms.first().filter(|(m, _)| m.is_empty()).map(|(_, c)| *c),
            _ => None,
        }
    }

    /// Its only term, if it has one.
    pub fn as_term(&self) -> Option<(&Monomial, f64)> {
        match &self.terms[..] {
            [(monomial, coefficient)] => Some((monomial, *coefficient)),
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

    /// The polynomial `coefficient · monomial`.
    pub fn term(monomial: Monomial, coefficient: f64) -> Poly {
        let mut terms = Terms::default();
        terms.add(monomial, coefficient);
        terms.collected()
    }

    /// The sum of both, the other times ±1.
    fn plus(&self, other: &Poly, sign: f64) -> Poly {
        let copy = |m: &Monomial| Monomial::from_slice(m);
        let mut terms = Vec::with_capacity(self.len() + other.len());
        let (mut left, mut right) = (self.terms.iter().peekable(), other.terms.iter().peekable());
        while let (Some((m, c)), Some((n, d))) = (left.peek(), right.peek()) {
            match m.cmp(n) {
                Ordering::Less => {
                    terms.push((copy(m), *c));
                    left.next();
                }
                Ordering::Greater => {
                    terms.push((copy(n), sign * d));
                    right.next();
                }
                Ordering::Equal => {
                    let sum = collect(*c, sign * d);
                    if sum != 0.0 {
                        terms.push((copy(m), sum));
                    }
                    left.next();
                    right.next();
                }
            }
        }
        terms.extend(left.map(|(m, c)| (copy(m), *c)));
        terms.extend(right.map(|(n, d)| (copy(n), sign * d)));
        Poly { terms }
    }

    pub fn scaled(&self, factor: f64) -> Poly {
        if factor == 0.0 {
            return Poly::zero();
        }
        Poly { terms: self.terms.iter().map(|(m, c)| (Monomial::from_slice(m), c * factor)).collect() }
    }

    /// Equal but for rounding of the coefficients.
    pub fn is_close_to(&self, other: &Poly) -> bool {
        let close = |c: f64, d: f64| (c - d).abs() <= 1e-13 * c.abs();
        self.len() == other.len() && self.terms().zip(other.terms()).all(|((m, c), (n, d))| m == n && close(c, d))
    }

    /// The factors that all terms share, and what is left without them.
    pub fn common_factors(&self) -> (Monomial, Poly) {
        let Some((mut shared, _)) = self.terms.first().cloned() else { return (Monomial::new(), Poly::zero()) };
        for (monomial, _) in &self.terms {
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
        let mut rest = Terms::default();
        self.terms.iter().for_each(|(m, c)| rest.add(without(m), *c));
        (shared, rest.collected())
    }

    pub fn contains(&self, var: Var) -> bool {
        self.terms.iter().any(|(m, _)| m.contains(&var))
    }
}

/// The product of two sorted factor lists.
pub(super) fn times(a: &[Var], b: &[Var]) -> Monomial {
    let mut product = Monomial::from_slice(a);
    product.extend_from_slice(b);
    // Merged from behind, in place.
    let (mut i, mut j) = (a.len(), b.len());
    while j > 0 {
        if i > 0 && product[i - 1] > b[j - 1] {
            product[i + j - 1] = product[i - 1];
            i -= 1;
        } else {
            product[i + j - 1] = b[j - 1];
            j -= 1;
        }
    }
    product
}

impl From<Var> for Poly {
    fn from(var: Var) -> Poly {
        Poly { terms: vec![(Monomial::from_slice(&[var]), 1.0)] }
    }
}

impl AddAssign<&Poly> for Poly {
    fn add_assign(&mut self, rhs: &Poly) {
        *self = self.plus(rhs, 1.0);
    }
}

impl Add for &Poly {
    type Output = Poly;
    fn add(self, rhs: &Poly) -> Poly {
        self.plus(rhs, 1.0)
    }
}

impl Sub for &Poly {
    type Output = Poly;
    fn sub(self, rhs: &Poly) -> Poly {
        self.plus(rhs, -1.0)
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
        let mut product = Terms::with_capacity(self.len() * rhs.len());
        for (m, c) in self.terms() {
            for (n, d) in rhs.terms() {
                product.add(times(m, n), c * d);
            }
        }
        product.collected()
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
