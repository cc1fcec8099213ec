//! Constraints between nodes: the lowest point of a path constraint inside an element.
//!
//! There a path constraint is close to the quartic through its values at the element's nodes, and the
//! quartic's minimum is a smooth function of these values wherever it moves. So it is imposed as a row
//! of its own, with exact derivatives: to first order the minimum's motion does not matter (envelope
//! theorem), to second order it does. What the quartic misses hardly depends on Θ; it is measured on a
//! fine grid (`search::refine`) and added as an offset.

use crate::lgl::{Lobatto, NODES};
use crate::polynomial::{Roots, derivative, evaluate, roots};

/// A path constraint imposed at its lowest point in an element.
#[derive(Clone, Debug)]
pub struct Dip {
    pub constraint: usize,
    pub element: usize,
    /// The constraint's value minus the quartic's (scaled).
    pub offset: f64,
    /// Where the quartic was lowest at the last linearization.
    pub lowest: Lowest,
}

/// Minima of a constraint in an element nearer than this (share of the element) are one.
const SAME: f64 = 0.1;

/// A curve that bends by less than this share of its values is flat: what minimum it has is one of rounding.
const FLAT: f64 = 1e-12;

impl Dip {
    /// Whether it is the same dip, at another time perhaps.
    pub fn is(&self, other: &Dip) -> bool {
        let place = (self.constraint, self.element) == (other.constraint, other.element);
        place && (self.lowest.at - other.lowest.at).abs() < SAME
    }

    /// First node of its element.
    pub fn first(&self) -> usize {
        self.element * (NODES - 1)
    }
}

/// A lowest point of the quartic through five values, and how it depends on them.
#[derive(Clone, Debug, Default)]
pub struct Lowest {
    /// Place in the element, 0 to 1.
    pub at: f64,
    pub value: f64,
    /// ∂value/∂values: the Lagrange polynomials there.
    pub shape: [f64; NODES],
    /// Their slopes: the quartic's slope is `slopes · values`.
    pub slopes: [f64; NODES],
    /// The quartic's second derivative; infinite at an end of the element, where the minimum stays.
    pub curvature: f64,
}

impl Lowest {
    /// Of several minima that nearest to `from`: a row must not jump from one to another.
    pub fn of(lobatto: &Lobatto, values: &[f64; NODES], from: f64) -> Lowest {
        let quartic = lobatto.interpolate(values);
        let mut buffer = [0.0; NODES];
        let slope = derivative(&quartic, &mut buffer);
        let mut stationary = Roots::new();
        roots(slope, &mut stationary);
        let size = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let inside = stationary.into_iter().filter(|(_, second)| *second > FLAT * size);
        let start = (evaluate(slope, 0.0) >= 0.0).then_some((0.0, f64::INFINITY));
        let end = (evaluate(slope, 1.0) <= 0.0).then_some((1.0, f64::INFINITY));
        let distance = |(at, _): &(f64, f64)| (at - from).abs();
        let nearest = inside.chain(start).chain(end).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        // A quartic has a minimum on an interval; without numbers it has none.
        let (at, curvature) = nearest.unwrap_or((from, f64::INFINITY));
        let value = evaluate(&quartic, at);
        Lowest { at, value, shape: lobatto.values(at), slopes: lobatto.slopes(at), curvature }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_and_its_first_two_derivatives() {
        let lobatto = Lobatto::new();
        let values = |x: f64, y: f64| lobatto.nodes.map(|s| (s - 0.4).powi(2) + x * s.powi(3) + y * (s * 5.0).sin());
        let value = |x, y| Lowest::of(&lobatto, &values(x, y), 0.5).value;
        let (x, y, h) = (0.1, 0.02, 1e-4);
        let lowest = Lowest::of(&lobatto, &values(x, y), 0.5);
        let dot = |a: &[f64; NODES], b: &[f64; NODES]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (dx, dy) = (lobatto.nodes.map(|s| s.powi(3)), lobatto.nodes.map(|s| (s * 5.0).sin()));
        let first = (value(x + h, y) - value(x - h, y)) / (2.0 * h);
        assert!((first - dot(&lowest.shape, &dx)).abs() < 1e-7);
        let mixed =
            (value(x + h, y + h) - value(x + h, y - h) - value(x - h, y + h) + value(x - h, y - h)) / (4.0 * h * h);
        let exact = -dot(&lowest.slopes, &dx) * dot(&lowest.slopes, &dy) / lowest.curvature;
        assert!((mixed - exact).abs() < 1e-5 * exact.abs().max(1.0), "{mixed} {exact}");
        assert!(dot(&lowest.slopes, &values(x, y)).abs() < 1e-12, "the slope vanishes at the minimum");
    }

    #[test]
    fn at_an_end_the_minimum_stays() {
        let lobatto = Lobatto::new();
        let lowest = Lowest::of(&lobatto, &lobatto.nodes.map(|s| 1.0 - s), 0.3);
        assert!(lowest.at == 1.0 && lowest.value.abs() < 1e-14 && lowest.curvature == f64::INFINITY);
    }

    #[test]
    fn what_is_constant_has_no_curvature() {
        let lobatto = Lobatto::new();
        let lowest = Lowest::of(&lobatto, &lobatto.nodes.map(|s| 0.3 + 1e-16 * (9.0 * s).sin()), 0.4);
        assert!(lowest.curvature == f64::INFINITY && (lowest.value - 0.3).abs() < 1e-14);
    }

    #[test]
    fn of_two_minima_the_row_keeps_to_its_own() {
        let lobatto = Lobatto::new();
        let values = lobatto.nodes.map(|s| (s - 0.2).powi(2) * (s - 0.8).powi(2) - 0.001 * s);
        let [left, right] = [0.3, 0.7].map(|from| Lowest::of(&lobatto, &values, from));
        assert!((left.at - 0.2).abs() < 0.02 && (right.at - 0.8).abs() < 0.02 && right.value < left.value);
    }
}
