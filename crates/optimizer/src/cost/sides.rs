//! In which parts of an element a joint moves which way: dry friction changes its sign between them.

use super::{Going, Nearest};
use crate::flow::Mesh;
use crate::lgl::NODES;
use crate::polynomial::{Roots, derivative, evaluate, may_change_sign, roots};
use smallvec::SmallVec;

/// A part of an element, and the sign of the rate there; 0 at rest.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    pub within: [f64; 2],
    pub sign: f64,
}

/// All of an element, for a joint whose rate is the quartic through its nodal values.
#[derive(Clone, Debug)]
pub struct Sides {
    pub parts: SmallVec<[Side; NODES]>,
    /// Where the joint turns around, with the rate's slope.
    pub turns: Roots,
    /// The quartic.
    pub rate: [f64; NODES],
}

impl Sides {
    /// Where the sign does not matter: one part.
    pub fn none() -> Sides {
        let whole = Side { within: [0.0, 1.0], sign: 0.0 };
        Sides { parts: SmallVec::from_slice(&[whole]), turns: Roots::new(), rate: [0.0; NODES] }
    }

    /// A joint that is `going` one way does not turn where its rate is nearest to zero on the other side.
    pub fn new(mesh: &Mesh, rates: &[f64; NODES], at_rest: f64, going: &[Going]) -> Sides {
        if rates.iter().all(|rate| rate.abs() <= at_rest) {
            return Sides::none();
        }
        let rate = mesh.lobatto.interpolate(rates);
        let mut turns = Roots::new();
        if may_change_sign(&rate) {
            roots(&rate, &mut turns);
        }
        for at in going.iter().filter_map(|going| nearest_halt(&rate, going)) {
            let (before, after) =
                (turns.iter().rposition(|turn| turn.0 < at), turns.iter().position(|turn| turn.0 > at));
            for turn in after.into_iter().chain(before) {
                turns.remove(turn);
            }
        }
        let mut parts = SmallVec::new();
        let mut from = 0.0;
        let middle = if evaluate(&rate, 0.5) >= 0.0 { 1.0 } else { -1.0 };
        let undisturbed = going.first().map_or(middle, |going| going.sign);
        let mut sign = turns.first().map_or(undisturbed, |turn| -turn.1.signum());
        for to in turns.iter().map(|turn| turn.0).chain([1.0]) {
            parts.push(Side { within: [from, to], sign });
            (from, sign) = (to, -sign);
        }
        Sides { parts, turns, rate }
    }
}

/// Where the rate of a joint that goes on is on the other side of zero, and least so.
fn nearest_halt(rate: &[f64; NODES], going: &Going) -> Option<f64> {
    let sign = going.sign;
    match going.nearest {
        Nearest::Inside => {}
        Nearest::Beginning => return (sign * evaluate(rate, 0.0) < 0.0).then_some(0.0),
        Nearest::End => return (sign * evaluate(rate, 1.0) < 0.0).then_some(1.0),
    }
    let (mut buffer, mut stationary) = ([0.0; NODES], Roots::new());
    roots(derivative(rate, &mut buffer), &mut stationary);
    let halts =
        stationary.into_iter().filter(|(_, bend)| sign * bend > 0.0).map(|(at, _)| (at, sign * evaluate(rate, at)));
    let beyond = halts.filter(|(_, value)| *value < 0.0);
    beyond.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
}
