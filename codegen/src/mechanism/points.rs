//! What must stay above the ground: all joints of the real legs, locked ones too, and the corners of the platform's extent.
//!
//! Feet are the exception. A link ends in the next joint or in the foot, so its ends are among the points. In a mirrored
//! gait every leg takes the part of its counterpart, and where the platform rolls the robot is mirrored with it: there
//! points count on both virtual legs, and corners on both sides.

use super::{Mechanism, Member, other_leg};
use crate::spec::{Leg, Platform, Robot, Rotation, Then};

/// A point of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    pub name: String,
    /// 0: the platform; k: the k-th link of its leg.
    pub body: usize,
    /// In the axes of the body, from its joint (from the mass centre for the platform), m.
    pub at: [f64; 3],
}

/// A spot as a part of a gait: what moves it.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub name: String,
    /// The real leg whose spot it is, as (virtual leg, member); `None`: the platform's.
    pub of: Option<(usize, usize)>,
    /// Which of its spots.
    pub spot: usize,
    /// The virtual leg with which it moves; of no matter for the platform's.
    pub leg: usize,
    /// As a mirror shows it that exchanges left and right.
    pub mirrored: bool,
}

/// Spots nearer to a foot than this share of the leg are the foot.
const AT_FOOT: f64 = 1e-9;

/// Corners of what the platform fills.
pub(super) fn corners(platform: &Platform) -> Vec<Spot> {
    let corners = platform.extent.iter().flat_map(|extent| extent.corners()).enumerate();
    let spot = |(k, at): (usize, [f64; 3])| Spot {
        name: format!("corner {} of {}", k + 1, platform.name),
        body: 0,
        at: [0, 1, 2].map(|axis| at[axis] - platform.com[axis]),
    };
    corners.map(spot).collect()
}

/// Joints of a leg, the free ones under these names; held ones under their own where no other leg holds one of that name.
pub(super) fn joints(robot: &Robot, leg: usize, names: &[String]) -> Vec<Spot> {
    let held = |leg: &Leg| -> Vec<String> {
        let links = leg.chain.iter().flat_map(|segment| &segment.link.locked);
        leg.locked.iter().chain(links).map(|held| held.name.clone()).collect()
    };
    let all: Vec<String> = robot.legs.iter().flat_map(held).collect();
    let leg = &robot.legs[leg];
    let named = |own: &String| match all.iter().filter(|other| *other == own).count() {
        1 => own.clone(),
        _ => format!("{}_{own}", leg.name),
    };
    let from_centre = |at: &[f64; 3]| [0, 1, 2].map(|axis| at[axis] - robot.platform.com[axis]);
    let on_platform = leg.locked.iter().map(|l| Spot { name: named(&l.name), body: 0, at: from_centre(&l.at) });
    let mut spots: Vec<Spot> = on_platform.collect();
    for (k, (segment, name)) in leg.chain.iter().zip(names).enumerate() {
        spots.push(Spot { name: name.clone(), body: k + 1, at: [0.0; 3] });
        let held = segment.link.locked.iter();
        spots.extend(held.map(|l| Spot { name: named(&l.name), body: k + 1, at: l.at }));
    }
    spots
}

/// All points of a gait.
pub fn points(m: &Mechanism) -> Vec<Point> {
    let exchanged = m.then == Then::Mirrored;
    let mirror = exchanged && m.rotation == Rotation::Roll;
    let mut points = Vec::new();
    let mut add = |of: Option<(usize, usize)>, spots: &[Spot], leg: usize, image: bool| {
        let name = |spot: &Spot| if image { format!("{}, mirrored", spot.name) } else { spot.name.clone() };
        let point = |(k, spot): (usize, &Spot)| Point { name: name(spot), of, spot: k, leg, mirrored: image && mirror };
        let body = |spot: &Spot| of.is_none_or(|(leg, member)| !m.legs[leg].members[member].has_its_foot_at(spot));
        points.extend(spots.iter().enumerate().filter(|(_, spot)| body(spot)).map(point));
    };
    add(None, &m.corners, 0, false);
    if mirror {
        add(None, &m.corners, 0, true);
    }
    for leg in 0..2 {
        for (of, image) in [(leg, false), (other_leg(leg), true)].into_iter().filter(|(_, image)| exchanged || !image) {
            for (k, member) in m.legs[of].members.iter().enumerate() {
                add(Some((of, k)), &member.spots, leg, image);
            }
        }
    }
    points
}

impl Member {
    /// Whether a spot is the foot: where the last link has no length.
    fn has_its_foot_at(&self, spot: &Spot) -> bool {
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let leg: f64 = self.bodies.iter().skip(1).map(|link| length(link.offset)).sum::<f64>() + length(self.foot);
        spot.body == self.bodies.len() && length([0, 1, 2].map(|k| spot.at[k] - self.foot[k])) <= AT_FOOT * leg
    }
}

impl Point {
    /// How many links lead to it.
    pub fn links(&self, m: &Mechanism) -> usize {
        match self.of {
            Some((leg, member)) => m.legs[leg].members[member].spots[self.spot].body,
            None => m.corners[self.spot].body,
        }
    }

    /// The body of the mechanism that moves like its k-th link, the platform before the first.
    pub fn body(&self, m: &Mechanism, k: usize) -> usize {
        if k == 0 { 0 } else { m.legs[self.leg].foot_body + k - m.legs[self.leg].joints.len() }
    }
}
