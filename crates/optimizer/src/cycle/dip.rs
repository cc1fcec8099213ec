//! Constraints between nodes: the lowest point of a path constraint inside an element.
//!
//! There a path constraint is close to the quartic through its values at the element's nodes, and the
//! quartic's minimum is a smooth function of these values wherever it moves. So it is imposed as a row
//! of its own, with exact derivatives: to first order the minimum's motion does not matter (envelope
//! theorem), to second order it does. What the quartic misses hardly depends on Θ; it is measured on a
//! fine grid (`search::refine`) and added as an offset.
//!
//! A limit of a motor that overcomes dry friction jumps where the joint turns around. One that is meant for a side is lowest among the
//! instants of that side, which may be a turn: that moves with the rate, to first order already.

use crate::lgl::{Lobatto, NODES};
use crate::polynomial::{Roots, derivative, evaluate, may_change_sign, roots};

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

    /// How it depends on a joint's rate besides, where it is lowest at a turn: node, quantity, derivative.
    pub fn of_turn(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let turn = self.lowest.turn.iter();
        turn.flat_map(|turn| turn.by_rate.iter().enumerate().map(|(i, by)| (self.first() + i, turn.rate, *by)))
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
    /// The quartic's second derivative; infinite at an end of the element, where the minimum stays, and at a turn.
    pub curvature: f64,
    pub turn: Option<Turn>,
}

/// A lowest point where a joint turns around: it moves with the root of the joint's rate.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Which quantity the rate is.
    pub rate: usize,
    /// ∂value/∂(rate at the nodes).
    pub by_rate: [f64; NODES],
    /// The value's second derivative is `a bᵀ + b aᵀ`, where a is the gradient of the rate at the turn, and b has these weights of the
    /// gradients of constraint and rate at the nodes.
    pub bend: [[f64; NODES]; 2],
}

/// Room (scaled) of a limit that is meant for a side to which the joint never turns in an element.
const VOID: f64 = 1.0;

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
        Lowest { at, value, shape: lobatto.values(at), slopes: lobatto.slopes(at), curvature, turn: None }
    }

    /// The same among the instants at which a joint with these rates, which are that quantity, turns to a side.
    pub fn on_side(
        lobatto: &Lobatto,
        values: &[f64; NODES],
        rates: [f64; NODES],
        rate: usize,
        side: f64,
        from: f64,
    ) -> Lowest {
        let all = Lowest::all_on_side(lobatto, values, rates, rate, side);
        let nearest = all.into_iter().min_by(|a, b| (a.at - from).abs().total_cmp(&(b.at - from).abs()));
        let none = [0.0; NODES];
        nearest.unwrap_or(Lowest {
            at: from,
            value: VOID,
            shape: none,
            slopes: none,
            curvature: f64::INFINITY,
            turn: None,
        })
    }

    /// All minima among these instants, in order.
    pub fn all_on_side(
        lobatto: &Lobatto,
        values: &[f64; NODES],
        rates: [f64; NODES],
        rate: usize,
        side: f64,
    ) -> Vec<Lowest> {
        let [quartic, speed] = [values, &rates].map(|values| lobatto.interpolate(values));
        let mut turns = Roots::new();
        if may_change_sign(&speed) {
            roots(&speed, &mut turns);
        }
        let mut buffer = [0.0; NODES];
        let slope = derivative(&quartic, &mut buffer);
        let mut stationary = Roots::new();
        roots(slope, &mut stationary);
        let lowest = |at: f64, curvature: f64| {
            let (shape, slopes) = (lobatto.values(at), lobatto.slopes(at));
            Lowest { at, value: evaluate(&quartic, at), shape, slopes, curvature, turn: None }
        };
        let mut all = Vec::new();
        let borders = [0.0].into_iter().chain(turns.iter().map(|turn| turn.0)).chain([1.0]);
        let borders: Vec<f64> = borders.collect();
        for (k, part) in borders.windows(2).enumerate() {
            let [first, last] = [part[0], part[1]];
            if side * evaluate(&speed, 0.5 * (first + last)) <= 0.0 {
                continue;
            }
            let inside = stationary.iter().filter(|(at, second)| first < *at && *at < last && *second > 0.0);
            all.extend(inside.map(|(at, second)| lowest(*at, *second)));
            for (at, falls_off, border) in
                [(first, evaluate(slope, first) >= 0.0, k), (last, evaluate(slope, last) <= 0.0, k + 1)]
            {
                if !falls_off {
                    continue;
                }
                let is_turn = border > 0 && border < borders.len() - 1;
                let turn = is_turn.then(|| Turn::new(lobatto, &quartic, &speed, rate, at));
                all.push(Lowest { turn, ..lowest(at, f64::INFINITY) });
            }
        }
        all.sort_by(|a, b| a.at.total_cmp(&b.at));
        all
    }
}

impl Turn {
    /// At a root of a joint's rate: both are quartics in an element.
    fn new(lobatto: &Lobatto, value: &[f64; NODES], speed: &[f64; NODES], rate: usize, at: f64) -> Turn {
        let derivatives = |quartic: &[f64; NODES]| {
            let (mut first, mut second) = ([0.0; NODES], [0.0; NODES]);
            let first = derivative(quartic, &mut first);
            [evaluate(first, at), evaluate(derivative(first, &mut second), at)]
        };
        let ([by, bend], [speeds, bends]) = (derivatives(value), derivatives(speed));
        let (shape, slopes, ratio) = (lobatto.values(at), lobatto.slopes(at), by / speeds);
        let curved = 0.5 * (bend - ratio * bends) / (speeds * speeds);
        let by_value = slopes.map(|slope| -slope / speeds);
        let by_speed = std::array::from_fn(|i| ratio / speeds * slopes[i] + curved * shape[i]);
        Turn { rate, by_rate: shape.map(|share| -ratio * share), bend: [by_value, by_speed] }
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
