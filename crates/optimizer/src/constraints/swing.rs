//! Feet in the air (§6.1): each stays above a curve of its elapsed share of the whole swing, 4 h s (1 − s) in the paper's gaits; see
//! `swing`.

use super::{Limits, PathConstraint};
use crate::instant::Quantities;
use crate::swing::Swing;
use piaffe_model::{Description, Limit};
use piaffe_number::Scalar;

pub fn constraints<T: Scalar>(
    d: &Description,
    limits: &Limits<T>,
    y: &Quantities,
    swings: &[Swing],
) -> Vec<PathConstraint<T>> {
    let of_foot = |(foot, swing): (usize, &Swing)| {
        let terms = vec![(y.clearance(foot), T::from(1.0))];
        let (limit, of) = match swings.len() {
            1 => (Limit::Clearance, String::new()),
            _ => (Limit::ClearanceOfFoot, format!("leg {}", swing.leg + 1)),
        };
        // In the middle of a swing the first instant is the last one of the phase before.
        PathConstraint {
            at_start: swing.begins(),
            ..PathConstraint::linear(limit, d.leg_length(), -limits.swing_clearance, terms).of(of)
        }
    };
    swings.iter().enumerate().map(of_foot).collect()
}
