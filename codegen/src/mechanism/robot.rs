//! The real robot, once: a tree of rigid bodies. [`Whole`] is all of it, its platform free to move and turn in space.
//!
//! It belongs to no gait. What the virtual legs of a gait stand for can be checked against it.

use super::names;
use crate::spec::{Axis, Inertia, Leg, Robot, Segment};

/// The tree of rigid bodies of the real robot; SI units, body axes x forward, y up, z right.
#[derive(Clone, Debug)]
pub struct Whole {
    pub robot: String,
    /// m/s², along −Yf.
    pub gravity: f64,
    /// Parents precede children; body 0 is the platform.
    pub bodies: Vec<Body>,
    /// In the order of their coordinates: leg after leg, from the platform down.
    pub joints: Vec<WholeJoint>,
    pub legs: Vec<WholeLeg>,
}

/// A joint of a real leg.
#[derive(Clone, Debug)]
pub struct WholeJoint {
    /// Its own in the robot.
    pub name: String,
    /// Rotor inertia times gear², kg·m².
    pub rotor_inertia: f64,
}

/// A real leg.
#[derive(Clone, Debug)]
pub struct WholeLeg {
    pub name: String,
    pub joints: std::ops::Range<usize>,
    pub foot_body: usize,
    /// Foot from the joint of `foot_body`, in its axes, m.
    pub foot: [f64; 3],
}

impl Whole {
    /// The tree of a validated robot whose locked joints are gone ([`Robot::locked`]).
    pub fn new(robot: &Robot) -> Whole {
        let mut bodies = vec![Body::platform(robot)];
        let mut joints = Vec::new();
        let of_legs = names::links(robot).into_iter().zip(names::joints(robot));
        let legs = robot.legs.iter().zip(of_legs).map(|(leg, (link_names, joint_names))| {
            let (first, body) = (joints.len(), bodies.len());
            let mount = [0, 1, 2].map(|axis| leg.mount[axis] - robot.platform.com[axis]);
            let (mut links, foot) = chain(leg, mount, body, first);
            links.iter_mut().zip(link_names).for_each(|(link, name)| link.name = name);
            for (segment, name) in leg.chain.iter().zip(joint_names) {
                let motor = &segment.joint.actuator;
                joints.push(WholeJoint { name, rotor_inertia: motor.rotor_inertia * motor.gear * motor.gear });
            }
            bodies.extend(links);
            WholeLeg { name: leg.name.clone(), joints: first..joints.len(), foot_body: bodies.len() - 1, foot }
        });
        let legs = legs.collect();
        Whole { robot: robot.name.clone(), gravity: robot.gravity, bodies, joints, legs }
    }

    pub fn total_mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).sum()
    }
}

/// A rigid body and the joint that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub name: String,
    pub parent: Option<usize>,
    /// Index of its joint's coordinate in q; `None` for the platform.
    pub coordinate: Option<usize>,
    pub axis: Axis,
    /// Its joint in the parent's axes, from the parent's joint (from the mass centre for the platform), m.
    pub offset: [f64; 3],
    pub mass: f64,
    /// Mass centre from its own joint, in its own axes, m.
    pub com: [f64; 3],
    /// About the mass centre in its own axes, kg·m².
    pub inertia: Inertia,
}

/// Bodies of a leg that hangs at `mount`, numbered from `first_body` and with coordinates from `first_joint`; and
/// its foot from the last joint.
pub(super) fn chain(leg: &Leg, mount: [f64; 3], first_body: usize, first_joint: usize) -> (Vec<Body>, [f64; 3]) {
    let mut offset = mount;
    let bodies = leg.chain.iter().enumerate().map(|(i, Segment { joint, link })| {
        let parent = if i == 0 { 0 } else { first_body + i - 1 };
        let (at, body) = (std::mem::replace(&mut offset, link.end), link.rigid());
        Body {
            name: link.name.clone(),
            parent: Some(parent),
            coordinate: Some(first_joint + i),
            axis: joint.axis,
            offset: at,
            mass: body.mass,
            com: body.com,
            inertia: body.inertia,
        }
    });
    (bodies.collect(), offset)
}

impl Body {
    /// How many numbers are measured of a body.
    pub const COUNT: usize = 3 + 1 + 3 + 9;

    pub(super) fn numbers(&self) -> [f64; Body::COUNT] {
        let ([x, y, z], [u, v, w], [a, b, c]) = (self.offset, self.com, self.inertia);
        [x, y, z, self.mass, u, v, w, a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
    }

    /// The platform, its mass centre at the origin of its axes.
    pub(super) fn platform(robot: &Robot) -> Body {
        Body {
            name: robot.platform.name.clone(),
            parent: None,
            coordinate: None,
            axis: Axis::Pitch,
            offset: [0.0; 3],
            mass: robot.platform.mass,
            com: [0.0; 3],
            inertia: robot.platform.inertia,
        }
    }
}
