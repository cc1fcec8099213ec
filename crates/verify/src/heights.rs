//! Heights over the ground of everything but feet: all joints of the real legs and the corners of the platform.

use super::geometry::{Geometry, Plane, Vec3};
use super::multibody::Multibody;
use super::numbers::Numbers;
use piaffe_model::{Description, Point, Rotation};
use piaffe_number::Scalar;

/// Of each of the description's points, the first that is always at the same height.
pub fn alike(d: &Description) -> Vec<usize> {
    let numbers = Numbers::new(d);
    let seen: Vec<_> = d.points.iter().map(|point| (point, Arms::new(d, &numbers, point))).collect();
    let same = |(p, a): &(&Point, Arms), (q, b): &(&Point, Arms)| {
        let legs = p.leg == q.leg || a.0.len() == 1;
        legs && a.0.len() == b.0.len() && a.0.iter().zip(&b.0).all(|(a, b)| matters(d, a) == matters(d, b))
    };
    seen.iter().enumerate().map(|(k, own)| seen.iter().position(|other| same(other, own)).unwrap_or(k)).collect()
}

/// What of an arm can move up and down.
fn matters(d: &Description, (body, arm): &(usize, Vec3)) -> Vec<f64> {
    let axes: &[usize] = match d.rotation {
        Rotation::None if *body == 0 => &[1],
        Rotation::Roll if *body == 0 => &[1, 2],
        Rotation::Pitch if *body == 0 => &[0, 1],
        _ if Plane::holds(d) => &[0, 1],
        _ => &[0, 1, 2],
    };
    axes.iter().map(|axis| arm[*axis]).collect()
}

/// The arms that lead from the platform's mass centre to a point, each in the axes of a body; m.
#[derive(Clone, Debug)]
pub struct Arms<T = f64>(Vec<(usize, Vec3<T>)>);

impl<T: Scalar> Arms<T> {
    pub fn new(d: &Description, numbers: &Numbers<T>, point: &Point) -> Self {
        let links = point.links(d);
        let arm = |k: usize| {
            let arm = match point.of {
                Some((leg, member)) if k < links => numbers.members[leg][member].offsets[k],
                Some((leg, member)) => numbers.members[leg][member].spots[point.spot],
                None => numbers.corners[point.spot],
            };
            if point.mirrored { Vec3::new(arm.x, arm.y, -arm.z) } else { arm }
        };
        Arms((0..=links).map(|k| (point.body(d, k), arm(k))).collect())
    }

    /// How high above the platform's mass centre they lead, m.
    pub fn rise<G: Geometry<T>>(&self, multibody: &Multibody<T, G>) -> T {
        self.0.iter().fold(T::zero(), |sum, (body, arm)| sum + multibody.rise(*body, arm))
    }
}
