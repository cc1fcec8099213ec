//! How a gait moves the real robot: q_real = E q.
//!
//! A virtual leg (§2.1) is no sum of legs. It is an embedding of coordinates: the joints of the real legs that move as one
//! follow the same coordinates of q, from the platform down. All equations are derived on the tree of the real links in
//! these coordinates ([`Mechanism::tree`]), and the normal form of the polynomials does the summing. That their feet then
//! move as one is checked where a gait is read, symbolically (`spec::as_one`).
//!
//! Where the platform is seen from, the legs stand side by side: all of them hang at the mean of their mounts.

use super::robot::{Body, chain};
use super::{Actuated, Mechanism, Spot, names, points};
use crate::spec::{Leg, Robot};
use std::ops::Range;

/// Real legs that move as one.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualLeg {
    pub members: Vec<Member>,
    /// The coordinates that the joints of every member follow.
    pub joints: Range<usize>,
    /// Of [`Mechanism::bodies`].
    pub foot_body: usize,
    /// Foot from the joint of `foot_body`, in its axes, m.
    pub foot: [f64; 3],
}

/// A real leg: its own links, in the coordinates of the virtual leg.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    pub name: String,
    /// From the platform down, under the names that are theirs alone. The parent of the first is the platform, of the others the
    /// link before.
    pub bodies: Vec<Body>,
    /// Names of its joints, theirs alone.
    pub joints: Vec<String>,
    /// Foot from the last joint, m.
    pub foot: [f64; 3],
    /// Its joints, also those that the gait holds still.
    pub spots: Vec<Spot>,
}

impl VirtualLeg {
    /// The legs of these numbers as virtual leg `number`. Adds to `joints` its coordinates, and to `bodies` what its links
    /// are when those that move alike are put together.
    pub(super) fn new(
        robot: &Robot,
        legs: &[usize],
        number: usize,
        joints: &mut Vec<Actuated>,
        bodies: &mut Vec<Body>,
    ) -> VirtualLeg {
        let (link_names, joint_names) = (names::links(robot), names::joints(robot));
        let from_centre = |mount: &[f64; 3]| [0, 1, 2].map(|axis| mount[axis] - robot.platform.com[axis]);
        let first = joints.len();
        let members = legs.iter().map(|i| {
            let leg = &robot.legs[*i];
            let (mut links, foot) = chain(leg, from_centre(&leg.mount), 1, first);
            links.iter_mut().zip(&link_names[*i]).for_each(|(link, name)| link.name.clone_from(name));
            let spots = points::joints(robot, *i, &joint_names[*i]);
            Member { name: leg.name.clone(), bodies: links, joints: joint_names[*i].clone(), foot, spots }
        });
        let members = members.collect();
        let together = together(robot, legs);
        let (mut links, foot) = chain(&together, robot.hip(legs), bodies.len(), first);
        for (link, segment) in links.iter_mut().zip(&together.chain) {
            link.name += &number.to_string();
            joints.push(Actuated::new(&segment.joint, number, legs.len()));
        }
        bodies.extend(links);
        VirtualLeg { members, joints: first..joints.len(), foot_body: bodies.len() - 1, foot }
    }

    /// Its first link in [`Mechanism::bodies`].
    pub fn first_body(&self) -> usize {
        self.foot_body + 1 - self.joints.len()
    }
}

impl Mechanism {
    /// Whether gaits of both move the robot alike, in whatever phases and within whatever limits: their kernels are the same.
    pub fn moves_like(&self, other: &Mechanism) -> bool {
        let embedding = |m: &Mechanism| Mechanism {
            gait: String::new(),
            phases: Vec::new(),
            modes: Vec::new(),
            transitions: Vec::new(),
            polynomial_order: 0,
            limits: self.limits.clone(),
            ..m.clone()
        };
        embedding(self) == embedding(other)
    }

    /// The same with the modes and transitions of another one that moves alike.
    pub fn with_those_of(mut self, other: &Mechanism) -> Mechanism {
        self.modes.extend(other.modes.iter().filter(|mode| !self.modes.contains(mode)).copied().collect::<Vec<_>>());
        let more = other.transitions.iter().filter(|t| !self.transitions.contains(t)).copied();
        self.transitions.extend(more.collect::<Vec<_>>());
        self.transitions.sort_by_key(|t| (t.to, t.from));
        self
    }
}

/// The legs as one leg called like the first of them: their links put together.
/// So a description tells of a robot that moves like the real one and has fewer bodies, for those who only want numbers. The
/// derivation does not use it, and tests compare the two.
fn together(robot: &Robot, legs: &[usize]) -> Leg {
    let legs: Vec<&Leg> = legs.iter().map(|&leg| &robot.legs[leg]).collect();
    let mut one = legs[0].clone();
    for (depth, segment) in one.chain.iter_mut().enumerate() {
        for other in &legs[1..] {
            let sum = segment.link.rigid().with(&other.chain[depth].link.rigid());
            segment.link.put(&sum);
        }
    }
    one
}

impl Mechanism {
    /// The real robot in the coordinates of the gait: the platform, then of each virtual leg, from the platform down, the
    /// links of its members side by side. Parents precede children.
    pub fn tree(&self) -> Vec<Body> {
        let mut bodies = vec![self.bodies[0].clone()];
        for leg in &self.legs {
            let (first, side_by_side) = (bodies.len(), leg.members.len());
            for depth in 0..leg.joints.len() {
                for (k, member) in leg.members.iter().enumerate() {
                    let mut body = member.bodies[depth].clone();
                    match depth.checked_sub(1) {
                        Some(above) => body.parent = Some(first + above * side_by_side + k),
                        None => body.offset = self.bodies[leg.first_body()].offset,
                    }
                    bodies.push(body);
                }
            }
        }
        bodies
    }

    /// Where in the tree the links of the first member of `leg` are.
    pub fn lead_links(&self, leg: usize) -> impl Iterator<Item = usize> {
        let before = self.legs[..leg].iter().map(|leg| leg.joints.len() * leg.members.len()).sum::<usize>();
        let leg = &self.legs[leg];
        (1 + before..).step_by(leg.members.len()).take(leg.joints.len())
    }
}
