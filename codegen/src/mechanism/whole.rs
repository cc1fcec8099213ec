//! The whole robot: its platform, free to move and turn in space, with every real leg.
//!
//! It belongs to no gait. What the virtual legs of a gait stand for can be checked against it.

use super::{Body, chain, names};
use crate::spec::{Axis, Robot};

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

impl Body {
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
