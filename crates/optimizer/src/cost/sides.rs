//! In which parts of an element a joint moves which way: dry friction changes its sign between them.

use crate::flow::Mesh;
use crate::lgl::NODES;
use crate::polynomial::{Roots, evaluate, may_change_sign, roots};
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

    pub fn new(mesh: &Mesh, rates: &[f64; NODES], at_rest: f64) -> Sides {
        if rates.iter().all(|rate| rate.abs() <= at_rest) {
            return Sides::none();
        }
        let rate = mesh.lobatto.interpolate(rates);
        let mut turns = Roots::new();
        if may_change_sign(&rate) {
            roots(&rate, &mut turns);
        }
        let mut parts = SmallVec::new();
        let mut from = 0.0;
        for to in turns.iter().map(|turn| turn.0).chain([1.0]) {
            let sign = if evaluate(&rate, 0.5 * (from + to)) >= 0.0 { 1.0 } else { -1.0 };
            parts.push(Side { within: [from, to], sign });
            from = to;
        }
        Sides { parts, turns, rate }
    }
}
