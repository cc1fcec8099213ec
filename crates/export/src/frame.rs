//! From the axes of this crate to those with z up: (x, y, z) becomes (x, −z, y).

use piaffe_optimizer::walk::Point;

/// A vector, or a position.
pub fn vector([x, y, z]: Point) -> Point {
    // Not −0.
    [x, 0.0 - z, y]
}

/// Flat plates and slender rods are the limit of what a rigid body can be. Some readers compare without tolerance:
/// this share of the trace, added to each moment, is more than rounding and less than anything measured.
const SLACK: f64 = 1e-9;

/// A tensor of inertia.
pub fn tensor(t: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    // Every row, then every column; the tensor is symmetric.
    let rows = t.map(vector);
    let mut turned = [0, 1, 2].map(|k| vector([rows[0][k], rows[1][k], rows[2][k]]));
    let trace = turned[0][0] + turned[1][1] + turned[2][2];
    (0..3).for_each(|k| turned[k][k] += SLACK * trace);
    turned
}

/// The axis of a joint: 0, 1, 2 for x, y, z.
pub fn axis(axis: usize) -> Point {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    vector(unit)
}
