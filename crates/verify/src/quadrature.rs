//! Integrals of what is known on a uniform grid.
//!
//! Each interval takes the cubic through its four nearest points, so the error falls with the fourth
//! power of the spacing. For ∫|w| (eq. 14) an interval in which w changes sign is split at the root
//! of its cubic, so that the kinks cost no accuracy.

/// ∫ w dt of at least four values, `spacing` apart.
pub fn integral(values: &[f64], spacing: f64) -> f64 {
    intervals(values).map(|interval| interval.whole()).sum::<f64>() * spacing
}

/// ∫ |w| dt of at least four values, `spacing` apart.
pub fn integral_of_magnitude(values: &[f64], spacing: f64) -> f64 {
    let magnitude = |interval: Interval| {
        let whole = interval.whole();
        if !interval.changes_sign() {
            return whole.abs();
        }
        let cubic = interval.cubic();
        let first = primitive(&cubic, root(&cubic));
        first.abs() + (whole - first).abs()
    };
    intervals(values).map(magnitude).sum::<f64>() * spacing
}

/// One interval of the grid, of unit length, with the four values nearest to it.
struct Interval {
    values: [f64; 4],
    /// Which of them it begins at: the first and the last interval have no outer neighbour.
    begin: usize,
}

fn intervals(values: &[f64]) -> impl Iterator<Item = Interval> + '_ {
    let count = values.len().saturating_sub(1);
    (0..count).filter_map(move |i| {
        let first = i.saturating_sub(1).min(values.len().checked_sub(4)?);
        Some(Interval { values: values[first..first + 4].try_into().ok()?, begin: i - first })
    })
}

impl Interval {
    fn changes_sign(&self) -> bool {
        self.values[self.begin] * self.values[self.begin + 1] < 0.0
    }

    /// The integral of the cubic.
    fn whole(&self) -> f64 {
        let [a, b, c, d] = self.values;
        let sum = match self.begin {
            0 => 9.0 * a + 19.0 * b - 5.0 * c + d,
            1 => 13.0 * (b + c) - (a + d),
            _ => a - 5.0 * b + 19.0 * c + 9.0 * d,
        };
        sum / 24.0
    }

    /// Coefficients 1, u, u², u³ of the cubic, u from 0 to 1 over the interval.
    fn cubic(&self) -> [f64; 4] {
        let [a, b, c, d] = self.values;
        let [first_difference, second, third] = [b - a, c - 2.0 * b + a, d - 3.0 * (c - b) - a];
        // a + f x + s x(x−1)/2 + t x(x−1)(x−2)/6 in powers of x = u + begin.
        let [s, t] = [second / 2.0, third / 6.0];
        let by_x = [a, first_difference - s + 2.0 * t, s - 3.0 * t, t];
        let o = self.begin as f64;
        [
            by_x[0] + o * (by_x[1] + o * (by_x[2] + o * by_x[3])),
            by_x[1] + o * (2.0 * by_x[2] + 3.0 * o * by_x[3]),
            by_x[2] + 3.0 * o * by_x[3],
            by_x[3],
        ]
    }
}

fn value(c: &[f64; 4], u: f64) -> f64 {
    c[0] + u * (c[1] + u * (c[2] + u * c[3]))
}

fn primitive(c: &[f64; 4], u: f64) -> f64 {
    u * (c[0] + u * (c[1] / 2.0 + u * (c[2] / 3.0 + u * c[3] / 4.0)))
}

/// A root between 0 and 1, where the cubic has opposite signs.
fn root(c: &[f64; 4]) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if value(c, middle) * c[0] > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
