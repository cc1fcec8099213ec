//! C1 (eq. 13): Σ Γj² by the quadrature of the collocation nodes.
//!
//! Dry friction c sign q̇ adds 2 c Γ sign q̇ + c². It jumps where the rate changes its sign, so it is integrated side by side: Γ as
//! the quartic through its nodal values in an element, between the roots of the rate's. A root's motion exchanges what stands on its
//! two sides, which is part of the gradient.

use super::energy::sides;
use super::{Integral, Turn};
use crate::flow::Mesh;
use crate::instant::Instants;
use crate::lgl::NODES;
use crate::polynomial::evaluate;
use std::array::from_fn;

pub fn integrate(mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (node, weight) in mesh.weights.iter().copied().enumerate() {
        let y = instants.row(node);
        for k in 0..integral.drives.len() {
            let drive = &integral.drives[k];
            let (torque, weight) = (drive.torque(y, 0.0), weight * drive.sharing);
            integral.value += weight * torque * torque;
            let first = 2.0 * weight * torque;
            drive.torque_curvature(y, |a, b, second| integral.seconds.push((node, a, b, first * second)));
            integral.add(node, &drive.torque_partials(y), first, 2.0 * weight);
        }
    }
    for k in 0..integral.drives.len() {
        if integral.drives[k].coulomb() != 0.0 {
            (0..mesh.elements).for_each(|e| dry(mesh, instants, integral, k, e));
        }
    }
}

/// Adds what dry friction adds for drive `k` in element `e`.
fn dry(mesh: &Mesh, instants: &Instants, integral: &mut Integral, k: usize, e: usize) {
    let (lobatto, share) = (&mesh.lobatto, integral.drives[k].sharing / mesh.elements as f64);
    let sides = sides(mesh, instants, integral, k, e);
    let node = |i: usize| e * (NODES - 1) + i;
    let c = integral.drives[k].coulomb();
    let torques: [f64; NODES] = from_fn(|i| integral.drives[k].torque(instants.row(node(i)), 0.0));
    let (mut weights, mut moving) = ([0.0; NODES], 0.0);
    for side in &sides.parts {
        let [before, after] = side.within.map(|s| lobatto.integrals(s));
        (0..NODES).for_each(|i| weights[i] += side.sign * (after[i] - before[i]));
        moving += side.sign.abs() * (side.within[1] - side.within[0]);
    }
    let signed: f64 = weights.iter().zip(&torques).map(|(w, torque)| w * torque).sum();
    integral.value += share * c * (2.0 * signed + c * moving);
    integral.by_coulomb[k] += share * 2.0 * (signed + c * moving);
    for (i, weight) in weights.iter().enumerate() {
        let (drive, y, first) = (&integral.drives[k], instants.row(node(i)), 2.0 * share * c * weight);
        drive.torque_curvature(y, |a, b, second| integral.seconds.push((node(i), a, b, first * second)));
        integral.add(node(i), &drive.torque_partials(y), first, 0.0);
    }
    let torque = lobatto.interpolate(&torques);
    for &(at, slope) in &sides.turns {
        let (shape, slopes) = (lobatto.values(at), lobatto.slopes(at));
        // Per change of the rate at the root, which moves by that over the slope.
        let jump = 2.0 * c * share * 2.0 / slope.abs();
        let here = evaluate(&torque, at);
        let rising: f64 = slopes.iter().zip(&torques).map(|(by, torque)| by * torque).sum();
        let bend = 2.0 * sides.rate[2] + at * (6.0 * sides.rate[3] + at * 12.0 * sides.rate[4]);
        let rate = integral.drives[k].rate();
        integral.partials.extend((0..NODES).map(|i| (node(i), rate, jump * here * shape[i])));
        let along = -0.5 * (rising - here * bend / slope) / slope;
        integral.turns.push(Turn {
            drive: k,
            first: node(0),
            shape,
            by_torque: shape.map(|l| jump * l),
            by_rate: from_fn(|i| jump * (along * shape[i] - here / slope * slopes[i])),
        });
    }
}
