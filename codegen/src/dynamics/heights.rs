//! Heights of all that must stay above the ground but feet: over the foot in support, in flight over the mass centre.
//!
//! Of points that cannot be lower than others there is no need to know: those at the same height (what legs of a virtual leg
//! have in common), and on one body, or beside each other on bodies that turn alike, those within the hull of the others as the
//! platform's rotation sees them: a level platform has one lowest point, a pitching one those of its silhouette.

use super::kernel::Kernel;
use super::model::Model;
use crate::expr::{Poly, Var, Vec3, add, rotate, zero};
use crate::mechanism::{Mode, Point, points};
use crate::spec::Rotation;

/// Kernels of a mode.
pub fn kernels(model: &mut Model, mode: Mode) -> Vec<Kernel> {
    let q = model.q(0);
    let origin = model.place(mode.into());
    let heights: Vec<Poly> = all(model).into_iter().filter(|h| h.counts).map(|h| &h.place[1] - &origin[1]).collect();
    let weights: Vec<Var> = (0..heights.len()).map(|k| model.ring.symbol(format!("w{k}"))).collect();
    let mut sum = Poly::zero();
    for (weight, height) in weights.iter().zip(&heights) {
        sum += &(&Poly::from(*weight) * height);
    }
    let gradient: Vec<Poly> = q.iter().map(|s| model.ring.derivative(&sum, *s)).collect();
    let values = Kernel::of_mode(
        mode,
        "heights",
        mode.say(
            "Heights over the ground of joints and corners, those that can be the lowest, with their \
             Jacobian in q.",
            "Heights over the mass centre of joints and corners, those that can be the lowest, with their \
             Jacobian in q.",
        ),
    )
    .input("q", q.clone())
    .vector("heights", heights.clone(), "m, in the order of the description's `lowest`")
    .matrix("heights_q", model.jacobian(&heights, &q), "∂heights/∂q");
    let curvature = Kernel::of_mode(
        mode,
        "heights_curvature",
        "Gradient in q and second derivatives of the sum of these heights, each with its weight.",
    )
    .input("q", q.clone())
    .input("weights", weights)
    .vector("gradient", gradient.clone(), "∂/∂q")
    .matrix("q_q", model.hessian(&gradient, &q), "∂²/∂q∂q");
    vec![values, curvature]
}

/// Which of the mechanism's points can be the lowest.
pub fn lowest(model: &mut Model) -> Vec<usize> {
    all(model).iter().enumerate().filter(|(_, height)| height.counts).map(|(k, _)| k).collect()
}

/// A point from the platform's mass centre.
struct Height {
    place: Vec3,
    /// What the platform alone adds to it, as far as its rotation moves that up or down, in its own axes.
    arm: Vec<Poly>,
    /// The height of the rest.
    rest: Poly,
    /// Whether it can be lower than all others.
    counts: bool,
}

fn all(model: &Model) -> Vec<Height> {
    let mut heights: Vec<Height> = points(&model.mechanism).iter().map(|point| Height::new(model, point)).collect();
    for k in 0..heights.len() {
        let (before, rest) = heights.split_at(k);
        let same = |other: &Height| other.rest.is_close_to(&rest[0].rest) && same(&other.arm, &rest[0].arm);
        heights[k].counts = !before.iter().any(|other| other.counts && same(other));
    }
    let inside: Vec<usize> =
        (0..heights.len()).filter(|k| heights[*k].counts && heights[*k].is_inside(&heights)).collect();
    inside.into_iter().for_each(|k| heights[k].counts = false);
    heights
}

fn same(a: &[Poly], b: &[Poly]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.is_close_to(b))
}

impl Height {
    fn new(model: &Model, point: &Point) -> Height {
        let (m, numbers) = (&model.mechanism, &model.quantities);
        let links = point.links(m);
        let arm = |k: usize| -> Vec3 {
            let mut arm = match point.of {
                Some((leg, member)) if k < links => numbers.members[leg][member].offsets[k].clone(),
                Some((leg, member)) => numbers.members[leg][member].spots[point.spot].clone(),
                None => numbers.corners[point.spot].clone(),
            };
            if point.mirrored {
                arm[2] = -&arm[2];
            }
            arm
        };
        let place = |k: usize| rotate(&model.kinematics.axes[point.body(m, k)], &arm(k));
        let rest = (1..=links).fold(zero(), |sum, k| add(&sum, &place(k)));
        let seen: &[usize] = match m.rotation {
            Rotation::None => &[1],
            Rotation::Pitch => &[0, 1],
            Rotation::Roll => &[1, 2],
        };
        let own = arm(0);
        Height {
            place: add(&place(0), &rest),
            arm: seen.iter().map(|axis| own[*axis].clone()).collect(),
            rest: rest[1].clone(),
            counts: true,
        }
    }

    /// Whether it lies within the hull of others that are beside it whatever the joints do.
    fn is_inside(&self, all: &[Height]) -> bool {
        let constant = |height: &Height| height.arm.iter().map(Poly::as_constant).collect::<Option<Vec<f64>>>();
        let Some(own) = constant(self) else { return false };
        let beside = all.iter().filter(|other| other.counts && other.rest.is_close_to(&self.rest));
        let away =
            beside.filter_map(constant).map(|other| other.iter().zip(&own).map(|(a, b)| a - b).collect::<Vec<_>>());
        let away: Vec<Vec<f64>> = away.filter(|away| away.iter().any(|x| *x != 0.0)).collect();
        match own.len() {
            1 => away.iter().any(|away| away[0] < 0.0),
            _ => !leaves_half_plane(&away),
        }
    }
}

/// Whether some direction points away from all of these.
fn leaves_half_plane(away: &[Vec<f64>]) -> bool {
    // Then all others are to the left of one of them, by less than half a turn.
    let is_first = |a: &Vec<f64>| {
        away.iter().all(|b| {
            let (along, across) = (a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
            // Of what rounding makes of it.
            let size = 1e-9 * (a[0].abs() + a[1].abs()) * (b[0].abs() + b[1].abs());
            across > size || (across >= -size && along > 0.0)
        })
    };
    away.is_empty() || away.iter().any(is_first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_plane_is_left_where_there_is_room() {
        let leaves = |away: &[[f64; 2]]| leaves_half_plane(&away.iter().map(|v| v.to_vec()).collect::<Vec<_>>());
        assert!(leaves(&[]) && leaves(&[[-1.0, 0.0]]) && leaves(&[[1.0, 0.0], [2.0, 0.0], [0.0, 1.0]]));
        assert!(leaves(&[[-1.0, 0.1], [1.0, 0.1], [0.0, 3.0]]));
        assert!(leaves(&[[0.0, -1.0], [1e-3, 1.0], [1e3, 0.0]]), "across the cut of an angle");
        assert!(leaves(&[[-1.0, 1e-3], [-1.0, -1e-3]]), "likewise");
        assert!(!leaves(&[[1.0, 0.0], [-2.0, 0.0]]), "what is between two is not outside");
        assert!(!leaves(&[[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]]));
    }
}
