//! C2 (eq. 14): Σ |Γj q̇j|, with its kinks treated exactly.
//!
//! In each element the power of a joint is the quartic through its nodal values. Its roots split the
//! element, and each part is integrated with its sign. The result is differentiable where roots are
//! simple, and its gradient is exact: a root's motion does not change the integral to first order.

use super::{Integral, Kink};
use crate::flow::Mesh;
use crate::instant::Instants;
use crate::lgl::NODES;
use crate::polynomial::{Roots, evaluate, roots};

pub fn integrate(mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    let share = 1.0 / mesh.elements as f64;
    for k in 0..integral.drives.len() {
        for e in 0..mesh.elements {
            let node = |i: usize| e * (NODES - 1) + i;
            let mut power = [0.0; NODES];
            for (i, p) in power.iter_mut().enumerate() {
                *p = integral.drives[k].power(instants.row(node(i)));
            }
            let (weights, roots) = absolute_weights(mesh, &power);
            for (i, (p, w)) in power.iter().zip(&weights).enumerate() {
                let (drive, y, first) = (&integral.drives[k], instants.row(node(i)), share * w);
                integral.value += first * p;
                drive.power_curvature(y, |a, b, second| integral.seconds.push((node(i), a, b, first * second)));
                integral.add(node(i), &drive.power_partials(y), first, 0.0);
            }
            for (root, slope) in roots {
                let shape = mesh.lobatto.values(root);
                integral.kinks.push(Kink { drive: k, first: node(0), shape, weight: 2.0 * share / slope.abs(), slope });
            }
        }
    }
}

/// √(power² + ε²) − ε by the quadrature of the collocation nodes: what a search may start with.
pub fn integrate_smooth(epsilon: f64, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (node, weight) in mesh.weights.iter().copied().enumerate() {
        let y = instants.row(node);
        for k in 0..integral.drives.len() {
            let drive = &integral.drives[k];
            let power = drive.power(y);
            let root = (power * power + epsilon * epsilon).sqrt();
            integral.value += weight * (root - epsilon);
            let (first, second) = (weight * power / root, weight * epsilon * epsilon / (root * root * root));
            drive.power_curvature(y, |a, b, curvature| integral.seconds.push((node, a, b, first * curvature)));
            integral.add(node, &drive.power_partials(y), first, second);
        }
    }
}

/// Weights ω with ∫₀¹ |p| = Σ ω p(node) for the quartic p through `values`, and its roots with slopes.
fn absolute_weights(mesh: &Mesh, values: &[f64; NODES]) -> ([f64; NODES], Roots) {
    let lobatto = &mesh.lobatto;
    let coefficients = lobatto.interpolate(values);
    let mut found = Roots::new();
    if may_change_sign(&coefficients) {
        roots(&coefficients, &mut found);
    }
    let mut weights = [0.0; NODES];
    let mut before = [0.0; NODES];
    let mut from = 0.0;
    for to in found.iter().map(|r| r.0).chain([1.0]) {
        let after = if to == 1.0 { lobatto.weights } else { lobatto.integrals(to) };
        let sign = if evaluate(&coefficients, 0.5 * (from + to)) >= 0.0 { 1.0 } else { -1.0 };
        for ((w, a), b) in weights.iter_mut().zip(&after).zip(&before) {
            *w += sign * (a - b);
        }
        before = after;
        from = to;
    }
    (weights, found)
}

/// A polynomial whose Bernstein coefficients on [0, 1] agree in sign has no root there.
fn may_change_sign(c: &[f64; NODES]) -> bool {
    let [c0, c1, c2, c3, c4] = *c;
    let bernstein =
        [c0, c0 + c1 / 4.0, c0 + c1 / 2.0 + c2 / 6.0, c0 + 0.75 * c1 + 0.5 * c2 + 0.25 * c3, c0 + c1 + c2 + c3 + c4];
    bernstein.iter().any(|b| *b > 0.0) && bernstein.iter().any(|b| *b < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_an_absolute_value_is_exact() {
        let mesh = Mesh::new(1, 4);
        let f = |s: f64| s * s - 0.25;
        let values = mesh.lobatto.nodes.map(f);
        let (weights, _) = absolute_weights(&mesh, &values);
        let integral: f64 = weights.iter().zip(&values).map(|(w, v)| w * v).sum();
        // ∫|s² − 1/4| over [0, 1] = 1/4
        assert!((integral - 0.25).abs() < 1e-14);
    }
}
