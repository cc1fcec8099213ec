//! Q(t): polynomials through given values and rates (eq. 15).
//!
//! On s = t/T, a joint's polynomial of order m is fixed by m + 1 parameters: Q(0), T·Q̇(0), values at
//! m − 3 equally spaced interior times, Q(1), T·Q̇(1). Each parameter has a basis polynomial; order 4
//! is the paper's, with one interior value at T/2.

use nalgebra::DMatrix;
use smallvec::SmallVec;

/// Basis polynomials of one order.
#[derive(Clone, Debug)]
pub struct Basis {
    order: usize,
    /// `coefficients[k][i]` of sⁱ in the basis polynomial of parameter k.
    coefficients: Vec<Vec<f64>>,
}

/// Value, first and second derivative in s of every basis polynomial at one s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Jet {
    pub value: PerParameter,
    pub first: PerParameter,
    pub second: PerParameter,
}

/// A number for each parameter of a polynomial.
type PerParameter = SmallVec<[f64; 6]>;

impl Basis {
    /// Order 4 or more.
    pub fn new(order: usize) -> Basis {
        let order = order.max(4);
        let n = order + 1;
        let interior = order - 3;
        // Each row is a condition on the monomial coefficients; the inverse's columns are the basis.
        let mut conditions = DMatrix::zeros(n, n);
        let mut value_at = |row: usize, s: f64| {
            let mut power = 1.0;
            for i in 0..n {
                conditions[(row, i)] = power;
                power *= s;
            }
        };
        value_at(0, 0.0);
        for k in 0..interior {
            value_at(2 + k, (k + 1) as f64 / (interior + 1) as f64);
        }
        value_at(n - 2, 1.0);
        conditions[(1, 1)] = 1.0;
        for i in 0..n {
            conditions[(n - 1, i)] = i as f64;
        }
        // The conditions are independent, so the inverse exists.
        let inverse = conditions.try_inverse().unwrap_or_else(|| DMatrix::identity(n, n));
        let coefficients = (0..n).map(|k| inverse.column(k).iter().copied().collect()).collect();
        Basis { order, coefficients }
    }

    pub fn order(&self) -> usize {
        self.order
    }

    /// Parameters per joint.
    pub fn len(&self) -> usize {
        self.order + 1
    }

    pub fn is_empty(&self) -> bool {
        false
    }

    /// Whether parameter `k` is a rate (given times T).
    pub fn is_rate(&self, k: usize) -> bool {
        k == 1 || k == self.order
    }

    /// Coefficients of sⁱ in the basis polynomial of parameter `k`.
    pub fn coefficients(&self, k: usize) -> &[f64] {
        &self.coefficients[k]
    }

    pub fn jet(&self, s: f64) -> Jet {
        let mut jet = Jet::default();
        for c in &self.coefficients {
            let (mut value, mut first, mut second) = (0.0, 0.0, 0.0);
            for &a in c.iter().rev() {
                second = second * s + 2.0 * first;
                first = first * s + value;
                value = value * s + a;
            }
            jet.value.push(value);
            jet.first.push(first);
            jet.second.push(second);
        }
        jet
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_meets_its_conditions_for_every_order() {
        for order in [4, 6, 8] {
            let basis = Basis::new(order);
            let interior = order - 3;
            let (start, end) = (basis.jet(0.0), basis.jet(1.0));
            for k in 0..basis.len() {
                let is = |j: usize| if j == k { 1.0 } else { 0.0 };
                assert!((start.value[k] - is(0)).abs() < 1e-9);
                assert!((start.first[k] - is(1)).abs() < 1e-9);
                assert!((end.value[k] - is(order - 1)).abs() < 1e-9);
                assert!((end.first[k] - is(order)).abs() < 1e-9);
                for i in 0..interior {
                    let jet = basis.jet((i + 1) as f64 / (interior + 1) as f64);
                    assert!((jet.value[k] - is(2 + i)).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let basis = Basis::new(6);
        let h = 1e-5;
        let (a, m, b) = (basis.jet(0.3 - h), basis.jet(0.3), basis.jet(0.3 + h));
        for k in 0..basis.len() {
            assert!(((b.value[k] - a.value[k]) / (2.0 * h) - m.first[k]).abs() < 1e-7);
            assert!(((b.first[k] - a.first[k]) / (2.0 * h) - m.second[k]).abs() < 1e-6);
        }
    }
}
