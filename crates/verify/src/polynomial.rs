//! Q(t) of eq. 15 in Newton's form, from the conditions that define it.
//!
//! Each coordinate is the polynomial through its initial and final values and rates and its interior
//! values. With s = t/T and nodes 0, 0, 1/(m+1), …, m/(m+1), 1, 1 (a node that is there twice stands
//! for a value and a rate), p(s) = c₀ + c₁(s − s₀) + c₂(s − s₀)(s − s₁) + …, where the cₖ are divided
//! differences. One interior value makes the paper's fourth order; any number is allowed.

use piaffe_model::motion::Course;
use piaffe_number::Scalar;

/// The prescribed coordinates of one phase as functions of time.
#[derive(Clone, Debug)]
pub struct Polynomials<T = f64> {
    duration: T,
    nodes: Vec<T>,
    /// Divided differences, one list of `nodes.len()` per coordinate.
    differences: Vec<T>,
}

impl<T: Scalar> Polynomials<T> {
    /// From values and rates; a number that is missing in a list makes its coordinate undefined.
    pub fn new(course: &Course<T>) -> Self {
        let interior = course.q_interior.len();
        let (zero, one) = (T::zero(), T::from(1.0));
        let mut nodes = vec![zero, zero];
        nodes.extend((1..=interior).map(|k| T::from(k as f64) / T::from((interior + 1) as f64)));
        nodes.extend([one, one]);
        let mut differences = Vec::new();
        for k in 0..course.q_initial.len() {
            let of = |list: &[T]| list.get(k).copied().unwrap_or(T::from(f64::NAN));
            let (first, last) = (of(&course.q_initial), of(&course.q_final));
            let mut values = vec![first, first];
            values.extend(course.q_interior.iter().map(|q| of(q)));
            values.extend([last, last]);
            let rates = [of(&course.qd_initial), of(&course.qd_final)].map(|rate| rate * course.duration);
            differences.extend(divided_differences(&nodes, values, rates));
        }
        Polynomials { duration: course.duration, nodes, differences }
    }

    /// Q, Q̇ and Q̈ of coordinate `k` at time `t`; s, rad, rad/s, rad/s².
    pub fn at(&self, k: usize, t: T) -> [T; 3] {
        let s = t / self.duration;
        let count = self.nodes.len();
        let [mut value, mut slope, mut curvature] = [T::zero(); 3];
        for (c, node) in self.differences[k * count..][..count].iter().zip(&self.nodes).rev() {
            let x = s - *node;
            curvature = curvature * x + slope.scale(2.0);
            slope = slope * x + value;
            value = value * x + *c;
        }
        [value, slope / self.duration, curvature / (self.duration * self.duration)]
    }
}

/// Divided differences of `values`; `rates` are the derivatives at the double first and last node.
fn divided_differences<T: Scalar>(nodes: &[T], mut values: Vec<T>, rates: [T; 2]) -> Vec<T> {
    let n = nodes.len();
    for order in 1..n {
        // From the end, so that the lower orders a difference needs are still there.
        for k in (order..n).rev() {
            // Only the first two nodes are the same, and the last two.
            let double = order == 1 && (k == 1 || k == n - 1);
            let gap = nodes[k] - nodes[k - order];
            values[k] = if double { rates[usize::from(k > 1)] } else { (values[k] - values[k - 1]) / gap };
        }
    }
    values
}
