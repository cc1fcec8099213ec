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

impl Dip {
    /// First node of its element.
    pub fn first(&self) -> usize {
        self.element * (NODES - 1)
    }
}

/// The lowest point of the quartic through five values, and how it depends on them.
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
    pub fn of(lobatto: &Lobatto, values: &[f64; NODES]) -> Lowest {
        let quartic = lobatto.interpolate(values);
        let (mut at, mut value, mut curvature) = (0.0, values[0], f64::INFINITY);
        if values[NODES - 1] < value {
            (at, value) = (1.0, values[NODES - 1]);
        }
        let mut buffer = [0.0; NODES];
        let mut stationary = Roots::new();
        roots(derivative(&quartic, &mut buffer), &mut stationary);
        for (root, second) in stationary {
            let there = evaluate(&quartic, root);
            if there < value && second > 0.0 {
                (at, value, curvature) = (root, there, second);
            }
        }
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
        let value = |x, y| Lowest::of(&lobatto, &values(x, y)).value;
        let (x, y, h) = (0.1, 0.02, 1e-4);
        let lowest = Lowest::of(&lobatto, &values(x, y));
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
        let lowest = Lowest::of(&lobatto, &lobatto.nodes.map(|s| 1.0 - s));
        assert_eq!((lowest.at, lowest.value, lowest.curvature), (1.0, 0.0, f64::INFINITY));
    }
}
