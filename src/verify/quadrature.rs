//! Integrals of what is known on a uniform grid.
//!
//! Each interval takes the cubic through its four nearest points, so the error falls with the fourth
//! power of the spacing. For ∫|w| (eq. 14) an interval in which w changes sign is split at the root
//! of its cubic, so that the kinks cost no accuracy.

/// ∫ w dt of at least four values, `spacing` apart.
pub fn integral(values: &[f64], spacing: f64) -> f64 {
    cubics(values).map(|cubic| primitive(&cubic, 1.0)).sum::<f64>() * spacing
}

/// ∫ |w| dt of at least four values, `spacing` apart.
pub fn integral_of_magnitude(values: &[f64], spacing: f64) -> f64 {
    let magnitude = |cubic: [f64; 4]| {
        let (whole, end) = (primitive(&cubic, 1.0), value(&cubic, 1.0));
        if cubic[0] * end >= 0.0 {
            return whole.abs();
        }
        let first = primitive(&cubic, root(&cubic));
        first.abs() + (whole - first).abs()
    };
    cubics(values).map(magnitude).sum::<f64>() * spacing
}

/// Coefficients 1, u, u², u³ of the cubic of each interval, u from 0 to 1 over it.
fn cubics(values: &[f64]) -> impl Iterator<Item = [f64; 4]> + '_ {
    let intervals = values.len().saturating_sub(1);
    (0..intervals).filter_map(move |i| {
        // The first of the four points; the first and last interval have no outer neighbour.
        let first = i.saturating_sub(1).min(values.len().checked_sub(4)?);
        let [a, b, c, d]: [f64; 4] = values[first..first + 4].try_into().ok()?;
        let [first_difference, second, third] = [b - a, c - 2.0 * b + a, d - 3.0 * (c - b) - a];
        // a + f x + s x(x−1)/2 + t x(x−1)(x−2)/6 in powers of x = u + offset.
        let [s, t] = [second / 2.0, third / 6.0];
        let by_x = [a, first_difference - s + 2.0 * t, s - 3.0 * t, t];
        let o = (i - first) as f64;
        Some([
            by_x[0] + o * (by_x[1] + o * (by_x[2] + o * by_x[3])),
            by_x[1] + o * (2.0 * by_x[2] + 3.0 * o * by_x[3]),
            by_x[2] + 3.0 * o * by_x[3],
            by_x[3],
        ])
    })
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
