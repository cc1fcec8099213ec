//! The passive impact of eq. 12 in numbers: the landing foot j comes to rest, the other one leaves.
//!
//! ```text
//! | A   −D_j | | Ẋ⁺ |   | A Ẋ⁻ |
//! | D_jᵀ   0 | | I  | = |   0  |
//! ```
//!
//! Before it the stance foot was at rest, which gives ṗ⁻ from q̇⁻ (eq. 3); after a flight the mass centre's fall gives it.

use super::geometry::Vec3;
use super::margins::Units;
use super::multibody::Multibody;
use piaffe_model::{Description, other_leg};
use piaffe_number::Scalar;

/// Pivots below this share of the largest entry make a system singular, in the robot's units.
const SINGULAR: f64 = 1e-13;

/// What the impact does.
#[derive(Clone, Debug)]
pub struct Impact<T = f64> {
    /// Ẋ⁻, Ẋ⁺, legs not yet renamed.
    pub before: Vec<T>,
    pub after: Vec<T>,
    /// On the landing foot, N·s.
    pub impulse: Vec3<T>,
    /// Velocity of the leaving foot after, m/s.
    pub leaving: Vec3<T>,
}

/// Impact on the foot of leg `landing` at the end of single support on the other leg. `None` where
/// eq. 12 has no unique solution.
pub fn impact(description: &Description, landing: usize, q: &[f64], qd: &[f64]) -> Option<Impact> {
    impact_of(&mut Multibody::new(description), landing, q, qd, Before::Stance)
}

/// What tells how the platform moves before an impact.
#[derive(Clone, Copy, Debug)]
pub enum Before<T = f64> {
    /// The foot of the other leg is at rest.
    Stance,
    /// The mass centre moves like this, forward and up, m/s.
    Flight([T; 2]),
}

/// The same, of a mechanism with numbers of its own.
pub fn impact_of<T: Scalar>(
    multibody: &mut Multibody<T>,
    landing: usize,
    q: &[T],
    qd: &[T],
    before: Before<T>,
) -> Option<Impact<T>> {
    let description = multibody.description();
    let zero = T::zero();
    multibody.set(q, qd, &vec![zero; q.len()]);
    let (nc, n) = (description.positions(), multibody.size());
    let mut a = vec![zero; n * n];
    multibody.inertia(&mut a);
    let feet = [0, 1].map(|leg| {
        let mut d = vec![zero; n * nc];
        multibody.foot_jacobian(leg, &mut d);
        d
    });
    let relative = match before {
        Before::Stance => multibody.foot(other_leg(landing)).velocity,
        Before::Flight([forward, up]) => multibody.centre().velocity - Vec3::new(forward, up, zero),
    };
    let mut before: Vec<T> = (0..nc).map(|c| -relative[c]).collect();
    before.extend_from_slice(qd);

    let d = &feet[landing];
    let size = n + nc;
    let mut system = vec![zero; size * size];
    let mut right = vec![zero; size];
    for row in 0..n {
        for column in 0..n {
            system[row * size + column] = a[row * n + column];
            right[row] += a[row * n + column] * before[column];
        }
        for c in 0..nc {
            system[row * size + n + c] = -d[row * nc + c];
            system[(n + c) * size + row] = d[row * nc + c];
        }
    }
    // In the robot's units, equations are of momentum, of angular momentum and of velocity; unknowns velocities, rates, impulses.
    let Units { mass, leg, .. } = Units::new(description);
    let per = |row: usize| [1.0 / mass, 1.0 / (mass * leg), 1.0][usize::from(row >= nc) + usize::from(row >= n)];
    let of = |column: usize| [1.0, 1.0 / leg, mass][usize::from(column >= nc) + usize::from(column >= n)];
    let mut of_rows: Vec<f64> = (0..size).map(per).collect();
    if T::IS_SET {
        let inverse = inverse(&system, &of_rows, of)?;
        (system, right) = (product(&inverse, &system, size), product(&inverse, &right, 1));
        // Each row is now one of its unknown.
        of_rows = (0..size).map(|row| 1.0 / of(row)).collect();
    }
    solve(&mut system, &mut right, of_rows, of)?;
    let velocity = |foot: &[T], xd: &[T]| {
        let mut v = Vec3::zeros();
        for (row, rate) in foot.chunks_exact(nc).zip(xd) {
            for (v, d) in v.iter_mut().zip(row) {
                *v += *d * *rate;
            }
        }
        v
    };
    let mut impulse = Vec3::zeros();
    impulse.as_mut_slice()[..nc].copy_from_slice(&right[n..]);
    right.truncate(n);
    let leaving = velocity(&feet[other_leg(landing)], &right);
    Some(Impact { before, after: right, impulse, leaving })
}

/// Nearly the inverse of a square matrix of such numbers. A system that is multiplied by it is nearly solved, so that its elimination
/// hardly widens what is known of its entries; whatever the factor is, the solution stays the same.
fn inverse<T: Scalar>(matrix: &[T], of_row: &[f64], of_column: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
    let size = of_row.len();
    let values: Vec<f64> = matrix.iter().map(|x| x.value()).collect();
    let mut inverse = vec![0.0; size * size];
    for k in 0..size {
        let mut column = vec![0.0; size];
        column[k] = 1.0;
        solve(&mut values.clone(), &mut column, of_row.to_vec(), &of_column)?;
        for (row, entry) in inverse.chunks_exact_mut(size).zip(column) {
            row[k] = entry;
        }
    }
    Some(inverse)
}

/// Of a square matrix of plain numbers with one of so many columns.
fn product<T: Scalar>(matrix: &[f64], other: &[T], columns: usize) -> Vec<T> {
    let size = other.len() / columns;
    let entry = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        (0..size).fold(T::zero(), |sum, k| sum + other[k * columns + column].scale(matrix[row * size + k]))
    };
    (0..size * columns).map(entry).collect()
}

/// Gaussian elimination with row exchanges; `matrix` is row-major, the solution replaces `right`. Entries are compared by what
/// they are times a factor of their row and one of their column.
fn solve<T: Scalar>(
    matrix: &mut [T],
    right: &mut [T],
    mut of_row: Vec<f64>,
    of_column: impl Fn(usize) -> f64,
) -> Option<()> {
    let n = right.len();
    let sizes = matrix.iter().enumerate().map(|(i, x)| x.value().abs() * of_row[i / n] * of_column(i % n));
    let largest = sizes.fold(0.0, f64::max);
    for k in 0..n {
        let size = |row: &usize| matrix[row * n + k].value().abs() * of_row[*row];
        let pivot = (k..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let value = matrix[pivot * n + k];
        let magnitude = value.least_magnitude() * of_row[pivot] * of_column(k);
        if magnitude.is_nan() || magnitude <= SINGULAR * largest {
            return None;
        }
        for column in 0..n {
            matrix.swap(k * n + column, pivot * n + column);
        }
        right.swap(k, pivot);
        of_row.swap(k, pivot);
        for row in k + 1..n {
            let factor = matrix[row * n + k] / value;
            for column in k..n {
                let above = matrix[k * n + column];
                matrix[row * n + column] -= factor * above;
            }
            let above = right[k];
            right[row] -= factor * above;
        }
    }
    for k in (0..n).rev() {
        for column in k + 1..n {
            let known = matrix[k * n + column] * right[column];
            right[k] -= known;
        }
        right[k] /= matrix[k * n + k];
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::taylor::Ball;
    use crate::numbers::Numbers;
    use piaffe::gaits::GAITS;

    /// Elimination alone makes balls wider than the numbers that they enclose are uncertain.
    #[test]
    fn light_links_leave_the_enclosure_of_an_impact_as_narrow_as_the_numbers() {
        for gait in GAITS {
            let mut description = gait.description().clone();
            let lightest: Vec<usize> = description.legs.iter().map(|leg| leg.foot_body).collect();
            for foot in lightest {
                let body = &mut description.bodies.to_mut()[foot];
                body.mass *= 1e-5;
                body.inertia.iter_mut().flatten().for_each(|moment| *moment *= 1e-5);
            }
            let d = &description;
            let (q, qd) = (&vec![0.3; d.orientations()], &vec![0.7; d.orientations()]);
            let plain = impact(d, 1, q, qd).unwrap();
            let balls = |x: &[f64]| x.iter().map(|x| Ball::from(*x)).collect::<Vec<_>>();
            let mut multibody = Multibody::with(d, Numbers::<Ball>::new(d));
            let enclosed = impact_of(&mut multibody, 1, &balls(q), &balls(qd), Before::Stance).unwrap();
            for (ball, number) in enclosed.after.iter().zip(&plain.after) {
                let size = 1.0 + number.abs();
                assert!(ball.rest() < 1e-9 * size, "{}: {:e}", d.key, ball.rest());
                // Plain numbers know no better themselves.
                assert!((ball.value() - number).abs() < ball.rest() + 1e-6 * size, "{}", d.key);
            }
        }
    }
}
