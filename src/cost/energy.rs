//! C2 (eq. 14): Σ |Γj q̇j|, with its kinks treated exactly.
//!
//! In each element the power of a joint is the quartic through its nodal values. Its roots split the
//! element, and each part is integrated with its sign. The result is differentiable where roots are
//! simple, and its gradient is exact: a root's motion does not change the integral to first order.

use super::Integral;
use crate::instant::Instants;
use crate::lgl::NODES;
use crate::model::Description;
use crate::stance::Mesh;

pub fn integrate(description: &Description, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    let y = instants.quantities;
    let share = 1.0 / mesh.elements as f64;
    for j in 0..description.joints() {
        for e in 0..mesh.elements {
            let node = |i: usize| e * (NODES - 1) + i;
            let mut power = [0.0; NODES];
            for (i, p) in power.iter_mut().enumerate() {
                *p = instants.value(node(i), y.torque(j)) * instants.value(node(i), y.rate(j));
            }
            let weights = absolute_weights(mesh, &power);
            for (i, (p, w)) in power.iter().zip(&weights).enumerate() {
                integral.value += share * w * p;
                let (torque, rate) = (instants.value(node(i), y.torque(j)), instants.value(node(i), y.rate(j)));
                integral.partials.push((node(i), y.torque(j), share * w * rate));
                integral.partials.push((node(i), y.rate(j), share * w * torque));
            }
        }
    }
}

/// Weights ω with ∫₀¹ |p| = Σ ω p(node), for the quartic p through `values`.
fn absolute_weights(mesh: &Mesh, values: &[f64; NODES]) -> [f64; NODES] {
    let lobatto = &mesh.lobatto;
    let coefficients = lobatto.interpolate(values);
    let mut cuts = roots(&coefficients);
    cuts.push(1.0);
    let mut weights = [0.0; NODES];
    let mut before = [0.0; NODES];
    let mut from = 0.0;
    for to in cuts {
        let after = lobatto.integrals(to);
        let sign = if evaluate(&coefficients, 0.5 * (from + to)) >= 0.0 { 1.0 } else { -1.0 };
        for ((w, a), b) in weights.iter_mut().zip(&after).zip(&before) {
            *w += sign * (a - b);
        }
        before = after;
        from = to;
    }
    weights
}

fn evaluate(p: &[f64], s: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Roots in (0, 1) of a polynomial, ascending: between the roots of its derivative it is monotone.
fn roots(p: &[f64]) -> Vec<f64> {
    if p.len() <= 1 {
        return Vec::new();
    }
    let derivative: Vec<f64> = p.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
    let mut bounds = vec![0.0];
    bounds.extend(roots(&derivative));
    bounds.push(1.0);
    let mut found = Vec::new();
    for pair in bounds.windows(2) {
        let (mut a, mut b) = (pair[0], pair[1]);
        let (fa, fb) = (evaluate(p, a), evaluate(p, b));
        if fa == 0.0 && a > 0.0 || fa * fb >= 0.0 {
            continue;
        }
        // Newton's method, kept inside the bracket by bisection.
        let rising = fb > fa;
        let mut s = 0.5 * (a + b);
        for _ in 0..60 {
            let value = evaluate(p, s);
            if (value > 0.0) == rising {
                b = s;
            } else {
                a = s;
            }
            let newton = s - value / evaluate(&derivative, s);
            let next = if newton > a && newton < b { newton } else { 0.5 * (a + b) };
            if (next - s).abs() < 1e-15 {
                break;
            }
            s = next;
        }
        found.push(s);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_quartic_with_four_roots() {
        // (s − 0.1)(s − 0.3)(s − 0.6)(s − 0.9)
        let p = [0.0162, -0.261, 1.11, -1.8, 0.9].map(|c: f64| c);
        let _ = p;
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
        let found = roots(&expand(&[0.1, 0.3, 0.6, 0.9]));
        for (f, e) in found.iter().zip([0.1, 0.3, 0.6, 0.9]) {
            assert!((f - e).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(found.len(), 4);
    }

    #[test]
    fn the_integral_of_an_absolute_value_is_exact() {
        let mesh = Mesh::new(1, 4);
        let f = |s: f64| s * s - 0.25;
        let values = mesh.lobatto.nodes.map(f);
        let weights = absolute_weights(&mesh, &values);
        let integral: f64 = weights.iter().zip(&values).map(|(w, v)| w * v).sum();
        // ∫|s² − 1/4| over [0, 1] = 1/4
        assert!((integral - 0.25).abs() < 1e-14);
    }
}
