//! Two feet: one number s, how hard they push against each other.
//!
//! Every margin is a concave curve over s: a line, or a line less a hyperbola. The least of them is greatest where the lowest
//! rising curve meets the lowest falling one, or on the top of a curve. A pair of curves bounds the maximum from above; where
//! a third is lower, it takes the place of that one of the pair that has its direction. Every exchange lowers the bound, and
//! where none is lower the bound is met: that proves the maximum.

use super::{Best, SLACK, weighed};
use crate::four_legs::limits::{Limit, Room};
use smallvec::smallvec;

/// Exchanges and steps of Newton's method after which something is wrong with the numbers: it takes a handful.
const MOST: usize = 200;
/// Margins this close are equal, relative to 1 and to their size.
const ROUNDING: f64 = 1e-14;

/// `height + slope s − √(k² (s − axis)² + depth²)`.
#[derive(Clone, Copy, Debug)]
struct Curve {
    limit: Limit,
    height: f64,
    slope: f64,
    /// 0 for a line.
    k: f64,
    axis: f64,
    depth: f64,
}

/// All margins over s, and where the least of them is greatest.
pub struct Line {
    curves: Curves,
    top: Top,
}

struct Curves(Vec<Curve>);

/// The greatest least margin.
struct Top {
    s: f64,
    margin: f64,
    /// The curves that meet there; twice the same one where it is its own top.
    rising: usize,
    falling: usize,
}

impl Line {
    /// `None` if there is no greatest margin.
    pub fn new(rooms: &[Room]) -> Option<Line> {
        let curves = Curves(rooms.iter().map(Curve::new).collect());
        let top = curves.top()?;
        Some(Line { curves, top })
    }

    /// The share with most room, as near to 0 as [`SLACK`] allows.
    pub fn best(&self) -> Best {
        let s = self.nearest_with_room(0.0, f64::INFINITY);
        Best { s: smallvec![s], margin: self.curves.lowest(s).1, binding: weighed(self.curves.weights(&self.top)) }
    }

    /// The share nearest to `wanted` that leaves at least this room, or where none does, the most.
    pub fn nearest_with_room(&self, wanted: f64, room: f64) -> f64 {
        self.curves.nearest(wanted, &self.top, room.min(self.top.margin - SLACK))
    }
}

impl Curves {
    /// The lowest curve at s and its height there.
    fn lowest(&self, s: f64) -> (usize, f64) {
        let heights = self.0.iter().map(|curve| curve.value(s)).enumerate();
        // What is no number is lower than all numbers.
        let lower = |a: f64, b: f64| a < b || a.is_nan();
        heights.fold((0, f64::INFINITY), |least, other| if lower(other.1, least.1) { other } else { least })
    }

    fn top(&self) -> Option<Top> {
        let mut s = 0.0;
        // The curves that bound the maximum, and the places between which it lies.
        let (mut rising, mut falling) = (None::<usize>, None::<usize>);
        let mut between = [f64::NEG_INFINITY, f64::INFINITY];
        for _ in 0..MOST {
            let (k, margin) = self.lowest(s);
            if !margin.is_finite() {
                return None;
            }
            let lowest = &self.0[k];
            let bound = match (rising, falling) {
                (Some(r), Some(f)) => self.0[r].value(s).min(self.0[f].value(s)),
                (Some(one), None) | (None, Some(one)) => self.0[one].value(s),
                (None, None) => f64::INFINITY,
            };
            if margin >= bound - ROUNDING * (1.0 + bound.abs()) {
                let (r, f) = (rising.or(falling).unwrap_or(k), falling.or(rising).unwrap_or(k));
                return Some(Top { s, margin, rising: r, falling: f });
            }
            let [left, right] = lowest.slopes(s);
            if left >= 0.0 && right <= 0.0 {
                return Some(Top { s, margin, rising: k, falling: k });
            } else if right > 0.0 {
                (rising, between[0]) = (Some(k), s);
            } else {
                (falling, between[1]) = (Some(k), s);
            }
            s = match (rising, falling) {
                (Some(r), Some(f)) => self.meeting(r, f, between)?,
                (Some(one), None) | (None, Some(one)) => match self.0[one].top() {
                    Some(top) => top,
                    None if rising.is_some() => {
                        falling = Some(self.steepest(|curve| curve.slope - curve.k)?);
                        self.meeting(one, falling?, between)?
                    }
                    None => {
                        rising = Some(self.steepest(|curve| -curve.slope - curve.k)?);
                        self.meeting(rising?, one, between)?
                    }
                },
                (None, None) => return None,
            };
        }
        None
    }

    /// The curve that falls most steeply in the end, if one falls.
    fn steepest(&self, slope: impl Fn(&Curve) -> f64) -> Option<usize> {
        let slopes = self.0.iter().map(slope).enumerate();
        slopes.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, slope)| *slope < 0.0).map(|(k, _)| k)
    }

    /// Where the lower of two curves is highest: the first rises at the lower end of `between`, the second falls at the upper.
    fn meeting(&self, rising: usize, falling: usize, between: [f64; 2]) -> Option<f64> {
        let (r, f) = (&self.0[rising], &self.0[falling]);
        let [mut low, mut high] = between;
        // Neither is of use beyond its own top.
        if let Some(top) = r.top().filter(|top| *top < high) {
            if r.value(top) <= f.value(top) {
                return Some(top);
            }
            high = top;
        }
        if let Some(top) = f.top().filter(|top| *top > low) {
            if f.value(top) <= r.value(top) {
                return Some(top);
            }
            low = top;
        }
        // Now `rising − falling` increases from below zero to above it.
        let difference = |s: f64| r.value(s) - f.value(s);
        let mut reach = 1.0;
        while !low.is_finite() || !high.is_finite() {
            let s = match (low.is_finite(), high.is_finite()) {
                (true, false) => low + reach,
                (false, true) => high - reach,
                _ => 0.0,
            };
            if difference(s) < 0.0 {
                low = s
            } else {
                high = s
            }
            reach *= 4.0;
            if !reach.is_finite() {
                return None;
            }
        }
        let rounding = ROUNDING * (1.0 + r.value(low).abs().min(r.value(high).abs()));
        root(low, high, rounding, |s| (difference(s), r.slopes(s)[1] - f.slopes(s)[0]))
    }

    /// From `wanted` towards the top, the first share that leaves this room.
    fn nearest(&self, wanted: f64, top: &Top, room: f64) -> f64 {
        let mut s = wanted;
        // Tangents lie above the curves: their steps fall short of the place, and the last one reaches it.
        for _ in 0..MOST {
            let (k, margin) = self.lowest(s);
            if margin >= room - ROUNDING * (1.0 + room.abs()) || s == top.s {
                return s;
            }
            let [left, right] = self.0[k].slopes(s);
            let next = s + (room - margin) / if top.s > s { right } else { left };
            let ahead = if top.s > s { next > s && next < top.s } else { next < s && next > top.s };
            s = if ahead { next } else { return top.s };
        }
        top.s
    }

    /// Weights of the limits that meet at the top: with them no share has more room.
    fn weights(&self, top: &Top) -> [(Limit, f64); 2] {
        let (r, f) = (&self.0[top.rising], &self.0[top.falling]);
        if top.rising == top.falling {
            return [(r.limit, 1.0), (r.limit, 0.0)];
        }
        let (up, down) = (r.slopes(top.s)[0].max(0.0), (-f.slopes(top.s)[1]).max(0.0));
        let share = if up + down > 0.0 { down / (up + down) } else { 0.5 };
        [(r.limit, share), (f.limit, 1.0 - share)]
    }
}

impl Curve {
    fn new(room: &Room) -> Curve {
        let square = |of: &mut dyn Iterator<Item = f64>| of.map(|x| x * x).sum::<f64>();
        let slopes = square(&mut room.tangential.iter().map(|t| t.slope[0]));
        let product: f64 = room.tangential.iter().map(|t| t.at * t.slope[0]).sum();
        let axis = if slopes > 0.0 { -product / slopes } else { 0.0 };
        let depth = square(&mut room.tangential.iter().map(|t| t.at + t.slope[0] * axis)).sqrt();
        Curve { limit: room.limit, height: room.height.at, slope: room.height.slope[0], k: slopes.sqrt(), axis, depth }
    }

    fn norm(&self, s: f64) -> f64 {
        if self.k == 0.0 {
            return self.depth;
        }
        let across = self.k * (s - self.axis);
        (across * across + self.depth * self.depth).sqrt()
    }

    fn value(&self, s: f64) -> f64 {
        self.height + self.slope * s - self.norm(s)
    }

    /// To the left and to the right of s.
    fn slopes(&self, s: f64) -> [f64; 2] {
        let norm = self.norm(s);
        if norm > 0.0 {
            let slope = self.slope - self.k * (self.k * (s - self.axis) / norm);
            [slope, slope]
        } else {
            [self.slope + self.k, self.slope - self.k]
        }
    }

    /// Where it is highest, if it rises to one side and falls to the other.
    fn top(&self) -> Option<f64> {
        let steeper = self.k * self.k - self.slope * self.slope;
        (steeper > 0.0).then(|| self.axis + self.slope * self.depth / (self.k * steeper.sqrt()))
    }
}

/// The root of an increasing function between two places, by Newton's method where that stays between what is known.
fn root(mut low: f64, mut high: f64, rounding: f64, f: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
    let mut s = 0.5 * (low + high);
    for _ in 0..MOST {
        let (value, slope) = f(s);
        if value.is_nan() {
            return None;
        } else if value.abs() <= rounding {
            break;
        } else if value < 0.0 {
            low = s;
        } else {
            high = s;
        }
        let newton = s - value / slope;
        s = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if s <= low || s >= high {
            break;
        }
    }
    Some(s)
}
