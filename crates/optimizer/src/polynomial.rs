//! Polynomials of low degree on [0, 1], by their monomial coefficients.

use crate::lgl::NODES;

/// Roots with the slope there; a quartic has at most four.
pub type Roots = smallvec::SmallVec<[(f64, f64); 4]>;

/// Value at `s`.
pub fn evaluate(p: &[f64], s: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Coefficients of the derivative, in `buffer`.
pub fn derivative<'a>(p: &[f64], buffer: &'a mut [f64; NODES]) -> &'a [f64] {
    let d = &mut buffer[..p.len() - 1];
    for (k, slot) in d.iter_mut().enumerate() {
        *slot = (k + 1) as f64 * p[k + 1];
    }
    d
}

/// Roots in (0, 1) of a polynomial of at most degree four, ascending: between the roots of its derivative it is monotone.
pub fn roots(p: &[f64], found: &mut Roots) {
    if p.len() <= 1 {
        return;
    }
    let mut buffer = [0.0; NODES];
    let derivative = derivative(p, &mut buffer);
    let mut bounds = Roots::new();
    roots(derivative, &mut bounds);
    bounds.push((1.0, 0.0));
    let mut a = 0.0;
    for (b, _) in bounds {
        if let Some(root) = bracketed(p, derivative, a, b) {
            found.push((root, evaluate(derivative, root)));
        }
        a = b;
    }
}

/// The root between `a` and `b`, where the polynomial is monotone: Newton's method, kept inside the
/// bracket by bisection.
fn bracketed(p: &[f64], derivative: &[f64], mut a: f64, mut b: f64) -> Option<f64> {
    let (fa, fb) = (evaluate(p, a), evaluate(p, b));
    if fa * fb >= 0.0 {
        return None;
    }
    let rising = fb > fa;
    let mut s = 0.5 * (a + b);
    for _ in 0..60 {
        let value = evaluate(p, s);
        if (value > 0.0) == rising {
            b = s;
        } else {
            a = s;
        }
        let newton = s - value / evaluate(derivative, s);
        let next = if newton > a && newton < b { newton } else { 0.5 * (a + b) };
        if (next - s).abs() < 1e-15 {
            break;
        }
        s = next;
    }
    Some(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_quartic_with_four_roots() {
        // (s − 0.1)(s − 0.3)(s − 0.6)(s − 0.9)
        let expand = |roots: &[f64]| {
            let mut p = vec![1.0];
            for r in roots {
                let mut next = vec![0.0; p.len() + 1];
                for (k, c) in p.iter().enumerate() {
                    next[k + 1] += c;
                    next[k] -= r * c;
                }
                p = next;
            }
            p
        };
        let mut found = Roots::new();
        roots(&expand(&[0.1, 0.3, 0.6, 0.9]), &mut found);
        for ((f, _), e) in found.iter().zip([0.1, 0.3, 0.6, 0.9]) {
            assert!((f - e).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(found.len(), 4);
    }
}
