//! C2 (eq. 14): Σ |Γj q̇j|, with its kinks treated exactly.
//!
//! In each element the power of a joint is the quartic through its nodal values. Its roots split the
//! element, and each part is integrated with its sign. The result is differentiable where roots are
//! simple, and its gradient is exact: a root's motion does not change the integral to first order.
//!
//! Dry friction adds c |q̇| to the power, which bends where the rate changes its sign. So the rate's roots split the element first: on
//! either side the power is a quartic again. Where they meet it is the same on both, so that their motion does not matter either.

use super::sides::Sides;
use super::{Bend, Going, Integral, Kink, Signs};
use crate::flow::Mesh;
use crate::instant::Instants;
use crate::lgl::NODES;
use crate::polynomial::{Roots, evaluate, may_change_sign, roots};
use smallvec::SmallVec;
use std::array::from_fn;

pub fn integrate(mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    let share = 1.0 / mesh.elements as f64;
    for k in 0..integral.drives.len() {
        for e in 0..mesh.elements {
            let node = |i: usize| e * (NODES - 1) + i;
            let sides = sides(mesh, instants, integral, k, e);
            for side in &sides.parts {
                let power: [f64; NODES] = from_fn(|i| integral.drives[k].power(instants.row(node(i)), side.sign));
                let (weights, roots) = absolute_weights(mesh, &power, side.within);
                if sides.turns.is_empty() {
                    integral.signs.push(Signs { drive: k, element: e, side: side.sign, weights });
                }
                for (i, (p, w)) in power.iter().zip(&weights).enumerate() {
                    let (drive, y, first) = (&integral.drives[k], instants.row(node(i)), share * w);
                    integral.value += first * p;
                    integral.by_coulomb[k] += first * side.sign * y[drive.rate()];
                    drive.power_curvature(y, |a, b, second| integral.seconds.push((node(i), a, b, first * second)));
                    integral.add(node(i), &drive.power_partials(y, side.sign), first, 0.0);
                }
                for (root, slope) in roots {
                    let (shape, weight) = (mesh.lobatto.values(root), 2.0 * share / slope.abs());
                    let bend = Bend::Power { side: side.sign };
                    integral.kinks.push(Kink { drive: k, bend, first: node(0), shape, weight, slope });
                }
            }
            // Where the joint turns around, what friction takes bends: c |q̇|, counted with the sign that the power has there.
            for (turn, slope) in sides.turns {
                let (drive, shape) = (&integral.drives[k], mesh.lobatto.values(turn));
                let power: f64 =
                    shape.iter().enumerate().map(|(i, l)| l * drive.power(instants.row(node(i)), 0.0)).sum();
                let weight = 2.0 * share * drive.coulomb() * power.signum() / slope.abs();
                integral.kinks.push(Kink { drive: k, bend: Bend::Rate, first: node(0), shape, weight, slope });
            }
        }
    }
    rest(mesh, instants, integral);
}

/// The parts of element `e` in which the dry friction of drive `k` keeps its sign.
pub(super) fn sides(mesh: &Mesh, instants: &Instants, integral: &Integral, k: usize, e: usize) -> Sides {
    let drive = &integral.drives[k];
    if drive.coulomb() == 0.0 {
        return Sides::none();
    }
    let rates = from_fn(|i| instants.value(e * (NODES - 1) + i, drive.rate()));
    let going = integral.going.iter().filter(|going| (going.joint, going.element) == (drive.joint, e));
    Sides::new(mesh, &rates, drive.at_rest(), &going.copied().collect::<SmallVec<[Going; 2]>>())
}

/// Joints that are held still. To move one costs (|Γ| or c, whichever is more) per rate, and besides, in the direction in which the
/// dynamics' torque works against friction, less than in the other: that part is smooth, and here.
fn rest(mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for k in 0..integral.held.len() {
        let c = integral.held[k].coulomb();
        for (node, weight) in mesh.weights.iter().copied().enumerate() {
            let (drive, y) = (&integral.held[k], instants.row(node));
            let torque = drive.torque(y, 0.0);
            if torque.abs() < c {
                integral.value += weight * drive.power(y, 0.0);
                drive.power_curvature(y, |a, b, second| integral.seconds.push((node, a, b, weight * second)));
                integral.add(node, &drive.power_partials(y, 0.0), weight, 0.0);
            } else {
                integral.value += weight * c.copysign(torque) * y[drive.rate()];
                integral.partials.push((node, drive.rate(), weight * c.copysign(torque)));
            }
        }
    }
}

/// √(power² + ε²) − ε by the quadrature of the collocation nodes: what a search may start with. What dry friction takes is rounded off
/// likewise.
pub fn integrate_smooth(epsilon: f64, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (node, weight) in mesh.weights.iter().copied().enumerate() {
        let y = instants.row(node);
        for k in 0..integral.drives.len() {
            let drive = &integral.drives[k];
            let Rounded { value: dry, side, bend } = Rounded::new(drive.coulomb(), y[drive.rate()], epsilon);
            let power = drive.power(y, 0.0) + dry;
            let root = (power * power + epsilon * epsilon).sqrt();
            integral.value += weight * (root - epsilon);
            let (first, second) = (weight * power / root, weight * epsilon * epsilon / (root * root * root));
            drive.power_curvature(y, |a, b, curvature| integral.seconds.push((node, a, b, first * curvature)));
            if bend != 0.0 {
                integral.seconds.push((node, drive.rate(), drive.rate(), first * bend));
            }
            integral.add(node, &drive.power_partials(y, side), first, second);
        }
    }
    keeping_signs(epsilon, mesh, instants, integral);
}

/// Of powers rounded off by ε, those that keep their sign in an element, and are everywhere beyond ε.
fn keeping_signs(epsilon: f64, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (k, drive) in integral.drives.iter().enumerate() {
        for e in 0..mesh.elements {
            let y = |i: usize| instants.row(e * (NODES - 1) + i);
            let side = if drive.coulomb() == 0.0 { 0.0 } else { y(0)[drive.rate()].signum() };
            let sign = drive.power(y(0), side).signum();
            let keeps = |i: usize| side * y(i)[drive.rate()] >= 0.0 && sign * drive.power(y(i), side) > epsilon;
            if (0..NODES).all(keeps) {
                let weights = mesh.lobatto.weights.map(|w| sign * w);
                integral.signs.push(Signs { drive: k, element: e, side, weights });
            }
        }
    }
}

/// √(c² q̇² + ε²) − ε for c |q̇|, its slope over c and its second derivative.
struct Rounded {
    value: f64,
    side: f64,
    bend: f64,
}

impl Rounded {
    fn new(coulomb: f64, rate: f64, epsilon: f64) -> Rounded {
        if coulomb == 0.0 {
            return Rounded { value: 0.0, side: 0.0, bend: 0.0 };
        }
        let power = coulomb * rate;
        let root = (power * power + epsilon * epsilon).sqrt();
        let bend = coulomb * coulomb * epsilon * epsilon / (root * root * root);
        Rounded { value: root - epsilon, side: power / root, bend }
    }
}

/// Weights ω with ∫ |p| = Σ ω p(node) between two places, for the quartic p through `values`, and its roots there with slopes.
fn absolute_weights(mesh: &Mesh, values: &[f64; NODES], [start, end]: [f64; 2]) -> ([f64; NODES], Roots) {
    let lobatto = &mesh.lobatto;
    let coefficients = lobatto.interpolate(values);
    let mut found = Roots::new();
    if may_change_sign(&coefficients) {
        roots(&coefficients, &mut found);
    }
    found.retain(|root| root.0 > start && root.0 < end);
    let mut weights = [0.0; NODES];
    let mut before = if start == 0.0 { [0.0; NODES] } else { lobatto.integrals(start) };
    let mut from = start;
    for to in found.iter().map(|r| r.0).chain([end]) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_an_absolute_value_is_exact() {
        let mesh = Mesh::new(1, 4);
        let f = |s: f64| s * s - 0.25;
        let values = mesh.lobatto.nodes.map(f);
        let integral = |within: [f64; 2]| {
            let (weights, _) = absolute_weights(&mesh, &values, within);
            weights.iter().zip(&values).map(|(w, v)| w * v).sum::<f64>()
        };
        // ∫|s² − 1/4| over [0, 1] = 1/4
        assert!((integral([0.0, 1.0]) - 0.25).abs() < 1e-14);
        let parts = integral([0.0, 0.2]) + integral([0.2, 0.7]) + integral([0.7, 1.0]);
        assert!((parts - 0.25).abs() < 1e-14);
    }
}
