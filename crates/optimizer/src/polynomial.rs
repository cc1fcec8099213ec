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

/// Roots in (0, 1) of a polynomial of at most degree four, ascending. It has at most as many as its coefficients in the basis of
/// Bernstein have changes of sign, and one if there is one change; else it is monotone between the roots of its derivative.
pub fn roots(p: &[f64], found: &mut Roots) {
    let changes = changes_of_sign(p);
    if changes == 0 {
        return;
    }
    let mut buffer = [0.0; NODES];
    let derivative = derivative(p, &mut buffer);
    let mut bounds = Roots::new();
    if changes > 1 {
        roots(derivative, &mut bounds);
    }
    bounds.push((1.0, 0.0));
    let mut a = 0.0;
    for (b, _) in bounds {
        if let Some(root) = bracketed(p, derivative, a, b) {
            found.push((root, evaluate(derivative, root)));
        }
        a = b;
    }
}

/// How often the coefficients in the basis of Bernstein on [0, 1] change their sign.
fn changes_of_sign(p: &[f64]) -> usize {
    // In place: of each the sum over those before it, as often as the degree has it.
    let degree = p.len().saturating_sub(1);
    let mut b = [0.0; NODES];
    let mut choose = 1.0;
    for (k, (b, c)) in b.iter_mut().zip(p).enumerate() {
        *b = c / choose;
        choose *= (degree - k) as f64 / (k + 1) as f64;
    }
    for first in 1..=degree {
        for k in (first..=degree).rev() {
            b[k] += b[k - 1];
        }
    }
    let signs = b[..=degree].iter().filter(|b| **b != 0.0).map(|b| *b > 0.0);
    let mut last = None;
    signs.filter(|sign| last.replace(*sign).is_some_and(|last| last != *sign)).count()
}

/// The root between `a` and `b`, where there is one if signs differ: Newton's method, and bisection where its steps leave the
/// bracket or do not become shorter.
fn bracketed(p: &[f64], derivative: &[f64], mut a: f64, mut b: f64) -> Option<f64> {
    let (fa, fb) = (evaluate(p, a), evaluate(p, b));
    if fa * fb >= 0.0 {
        return None;
    }
    let rising = fb > fa;
    let mut s = 0.5 * (a + b);
    let mut step = b - a;
    for _ in 0..60 {
        let value = evaluate(p, s);
        if (value > 0.0) == rising {
            b = s;
        } else {
            a = s;
        }
        let newton = s - value / evaluate(derivative, s);
        let shorter = newton > a && newton < b && (newton - s).abs() < 0.5 * step;
        let next = if shorter { newton } else { 0.5 * (a + b) };
        step = (next - s).abs();
        if step < 1e-15 {
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
    fn one_change_of_sign_is_one_root() {
        // (s − 0.2)((s − 0.5)² + 0.01): not monotone, one root.
        let p = [-0.052, 0.46, -1.2, 1.0];
        let mut found = Roots::new();
        roots(&p, &mut found);
        assert!(found.len() == 1 && (found[0].0 - 0.2).abs() < 1e-14, "{found:?}");
        // In the basis of Bernstein s is 0, ½, 1.
        assert_eq!(changes_of_sign(&[-0.7, 1.0, 0.0]), 1);
        assert_eq!(changes_of_sign(&[1.0, -1.0, 0.0, 0.0, 0.0]), 0);
    }

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
