//! Polynomials by their Bernstein coefficients: between the least and the greatest of them the polynomial stays, and those at the ends are
//! values that it takes. Where that is not close enough, de Casteljau's scheme halves the interval.

use super::taylor::{Taylor, UNIT, above};

/// How often an interval is halved to see more closely.
const HALVINGS: usize = 12;
/// Bounds closer than this to a value that is taken need not be better.
pub(super) const CLOSE: f64 = 1e-10;

/// Σ bₖ Bₖ(τ), the Bernstein polynomials of this degree on [−1, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Bernstein<const N: usize> {
    b: [f64; N],
    degree: usize,
}

impl<const N: usize> Bernstein<N> {
    /// The same polynomial, and what rounding may have changed in any coefficient, here and by halving.
    pub(super) fn new(model: &Taylor<N>) -> (Bernstein<N>, f64) {
        let n = model.degree;
        // C(n, i), and (1 − x)ⁿ: whole numbers, all of these.
        let (mut choices, mut symmetric) = ([1.0; N], [1.0; N]);
        for i in 1..=n {
            choices[i] = choices[i - 1] * (n + 1 - i) as f64 / i as f64;
            symmetric[i] = if i % 2 == 0 { choices[i] } else { -choices[i] };
        }
        let mut b = [0.0; N];
        for b in &mut b[..=n] {
            // bₖ is the polar form at k ends, 1, and n − k beginnings, −1: of τⁱ their elementary symmetric mean, a coefficient of
            // (1 + x)ᵏ (1 − x)ⁿ⁻ᵏ over C(n, i).
            *b = model.coefficients().iter().zip(&symmetric).zip(&choices).map(|((c, s), all)| c * (s / all)).sum();
            (1..=n).for_each(|i| symmetric[i] += symmetric[i - 1]);
            (1..=n).rev().for_each(|i| symmetric[i] += symmetric[i - 1]);
        }
        // Means are at most 1 and off by a unit, as are products, sums and each level of a halving.
        let rounding = UNIT * ((HALVINGS + 1) * (N + 2)) as f64 * model.norm();
        (Bernstein { b, degree: n }, above(rounding))
    }

    /// The least coefficient, and the least value at an end.
    fn floor(&self) -> (f64, f64) {
        let all = &self.b[..=self.degree];
        (all.iter().copied().fold(f64::INFINITY, f64::min), all[0].min(all[self.degree]))
    }

    /// On both halves of the interval, each stretched to [−1, 1].
    fn halves(&self) -> [Self; 2] {
        let n = self.degree;
        let (mut left, mut right) = (*self, *self);
        for level in 1..=n {
            for k in 0..=n - level {
                right.b[k] = 0.5 * (right.b[k] + right.b[k + 1]);
            }
            left.b[level] = right.b[0];
        }
        [left, right]
    }

    /// A number that the polynomial is nowhere below, but for rounding, and as close to the least of its values as is worth while.
    pub(super) fn least(&self) -> f64 {
        self.least_of(HALVINGS, f64::INFINITY)
    }

    /// The same, if that is less than `enough`.
    fn least_of(&self, halvings: usize, enough: f64) -> f64 {
        let (floor, taken) = self.floor();
        if halvings == 0 || floor >= taken.min(enough) - CLOSE || !floor.is_finite() {
            return floor;
        }
        let mut halves = self.halves();
        if halves[1].floor().0 < halves[0].floor().0 {
            halves.swap(0, 1);
        }
        // Where the other half stays above what this one takes, it need not be looked at closely.
        let first = halves[0].least_of(halvings - 1, enough.min(taken));
        let second = halves[1].least_of(halvings - 1, enough.min(taken).min(halves[0].floor().1));
        first.min(second)
    }
}
