//! From the specification to a mechanism: one tree of rigid bodies per gait, with numbers.
//!
//! This is where virtual legs come from (§2.1): the real legs that move together become one leg
//! whose hip is the mean of their mounts and whose masses and inertias are their sums ([`Robot::virtual_leg`]).

mod family;
mod lever;
mod names;
mod parameter;
mod points;
mod whole;

pub use family::Family;
pub use lever::{Lever, levers};
pub use parameter::{Parameter, Sign, parameters, select, with};
pub use points::{Point, Spot, points};
pub use whole::{Whole, WholeJoint, WholeLeg};

use crate::spec::{Axis, Gait, HalfSteps, Inertia, Joint, Leg, Limits, Robot, Rotation, Segment, Unactuated};

/// The tree of rigid bodies of one gait's model; SI units, body axes x forward, y up, z right.
#[derive(Clone, Debug)]
pub struct Mechanism {
    pub gait: String,
    pub robot: String,
    /// m/s², along −y.
    pub gravity: f64,
    /// Whether the platform moves along z as well as x and y.
    pub lateral: bool,
    pub rotation: Rotation,
    /// Parents precede children; body 0 is the platform.
    pub bodies: Vec<Body>,
    /// Corners of what the platform fills.
    pub corners: Vec<Spot>,
    /// Joint coordinates q1, q2, … of virtual leg 1, then of virtual leg 2.
    pub joints: Vec<Actuated>,
    pub legs: [VirtualLeg; 2],
    /// Index of β in q = [joints, θ].
    pub unactuated: usize,
    pub half_steps: HalfSteps,
    pub polynomial_order: usize,
    pub limits: Limits,
}

/// A rigid body and the joint that carries it.
#[derive(Clone, Debug)]
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

/// An actuated joint of a virtual leg, seen at the joint: N·m, rad/s.
#[derive(Clone, Debug)]
pub struct Actuated {
    pub name: String,
    pub range: [f64; 2],
    pub gear: f64,
    pub max_torque: f64,
    pub unloaded_speed: f64,
    pub loaded_speed: f64,
    /// Rotor inertias times gear², kg·m².
    pub rotor_inertia: f64,
}

/// A virtual leg: which joints it has and where its foot is.
#[derive(Clone, Debug)]
pub struct VirtualLeg {
    /// The real legs that it stands for.
    pub members: Vec<Member>,
    pub joints: std::ops::Range<usize>,
    pub foot_body: usize,
    /// Foot from the joint of `foot_body`, in its axes, m.
    pub foot: [f64; 3],
}

/// A real leg: its own links, which move as those of the virtual leg.
#[derive(Clone, Debug)]
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

impl Mechanism {
    /// Builds the virtual-leg model of `gait`. Both must have passed validation, and the robot must be
    /// one whose locked joints are gone ([`Robot::locked`]).
    pub fn new(robot: &Robot, gait: &Gait) -> Mechanism {
        let mut bodies = vec![Body::platform(robot)];
        let mut joints = Vec::new();
        let (link_names, joint_names) = (names::links(robot), names::joints(robot));
        let legs = [0, 1].map(|k| {
            let from_centre = |mount: &[f64; 3]| [0, 1, 2].map(|axis| mount[axis] - robot.platform.com[axis]);
            let (first, body) = (joints.len(), bodies.len());
            let members = gait.virtual_legs[k].iter().map(|i| {
                let leg = &robot.legs[*i];
                let (mut links, foot) = chain(leg, from_centre(&leg.mount), 1, first);
                links.iter_mut().zip(&link_names[*i]).for_each(|(link, name)| link.name.clone_from(name));
                let spots = points::joints(robot, *i, &joint_names[*i]);
                Member { name: leg.name.clone(), bodies: links, joints: joint_names[*i].clone(), foot, spots }
            });
            let members = members.collect();
            let leg = robot.virtual_leg(&gait.virtual_legs[k]);
            let (mut links, foot) = chain(&leg, from_centre(&leg.mount), body, first);
            for (link, segment) in links.iter_mut().zip(&leg.chain) {
                link.name += &(k + 1).to_string();
                joints.push(Actuated::new(&segment.joint, k + 1, gait.virtual_legs[k].len()));
            }
            bodies.extend(links);
            let foot_body = bodies.len() - 1;
            VirtualLeg { members, joints: first..joints.len(), foot_body, foot }
        });
        let unactuated = match gait.unactuated {
            Unactuated::Platform => joints.len(),
            Unactuated::Joint { leg, joint } => legs[leg].joints.start + joint,
        };
        Mechanism {
            gait: gait.name.clone(),
            robot: robot.name.clone(),
            gravity: robot.gravity,
            lateral: gait.lateral,
            rotation: gait.rotation,
            bodies,
            corners: points::corners(&robot.platform),
            joints,
            legs,
            unactuated,
            half_steps: gait.half_steps,
            polynomial_order: gait.polynomial_order,
            limits: gait.limits.clone(),
        }
    }

    pub fn total_mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).sum()
    }

    /// Everything that is measured, in one fixed order: gravity; of each body offset, mass, mass centre and
    /// inertia; of each joint the rotor's inertia; of each leg the foot, and of its members their bodies, feet and spots; corners.
    pub fn numbers(&self) -> Vec<f64> {
        let members = self.legs.iter().flat_map(|leg| &leg.members);
        let bodies = self.bodies.len() + members.map(|member| member.bodies.len()).sum::<usize>();
        let mut numbers = Vec::with_capacity((bodies + 1) * Body::COUNT);
        numbers.push(self.gravity);
        self.bodies.iter().for_each(|body| numbers.extend(body.numbers()));
        numbers.extend(self.joints.iter().map(|joint| joint.rotor_inertia));
        for leg in &self.legs {
            numbers.extend(leg.foot);
            for member in &leg.members {
                member.bodies.iter().for_each(|body| numbers.extend(body.numbers()));
                numbers.extend(member.foot);
                numbers.extend(member.spots.iter().flat_map(|spot| spot.at));
            }
        }
        numbers.extend(self.corners.iter().flat_map(|corner| corner.at));
        numbers
    }

    /// Mass of the robot and reach of its leg, kg and m: what its numbers are small or large beside.
    pub fn size(&self) -> (f64, f64) {
        let norm = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach = self.bodies.iter().map(|body| norm(&body.offset)).sum::<f64>() + norm(&self.legs[0].foot);
        (self.bodies.iter().map(|body| body.mass).sum(), reach)
    }

    /// The robot's size in the unit of each of its [`numbers`](Mechanism::numbers).
    pub fn sizes(&self) -> Vec<f64> {
        let (mass, length) = self.size();
        let inertia = mass * length * length;
        let typical = |body: &mut Body| {
            (body.offset, body.mass, body.com) = ([length; 3], mass, [length; 3]);
            body.inertia = [[inertia; 3]; 3];
        };
        let mut sized = self.clone();
        sized.bodies.iter_mut().for_each(typical);
        sized.joints.iter_mut().for_each(|joint| joint.rotor_inertia = inertia);
        for leg in &mut sized.legs {
            leg.foot = [length; 3];
            for member in &mut leg.members {
                member.bodies.iter_mut().for_each(typical);
                member.foot = [length; 3];
            }
        }
        sized.numbers()
    }

    /// Number of position coordinates p (and of reaction components).
    pub fn positions(&self) -> usize {
        if self.lateral { 3 } else { 2 }
    }

    /// Number of joint and orientation coordinates q.
    pub fn orientations(&self) -> usize {
        self.joints.len() + usize::from(self.rotation != Rotation::None)
    }

    /// Names of X = [p, q].
    pub fn coordinate_names(&self) -> Vec<String> {
        let mut names: Vec<String> = ["x", "y", "z"][..self.positions()].iter().map(|s| s.to_string()).collect();
        names.extend((1..=self.joints.len()).map(|j| format!("q{j}")));
        if self.rotation != Rotation::None {
            names.push("theta".into());
        }
        names
    }

    /// Whether the joint connects a leg to the platform.
    pub fn hangs_on_platform(&self, joint: usize) -> bool {
        self.bodies.iter().any(|b| b.parent == Some(0) && b.coordinate == Some(joint))
    }

    /// Indices in q of the prescribed coordinates Q: all but β.
    pub fn prescribed(&self) -> Vec<usize> {
        (0..self.orientations()).filter(|i| *i != self.unactuated).collect()
    }

    /// The joints whose torques are independent: as many as there are prescribed coordinates.
    ///
    /// Where the platform does not rotate, the torque of the unactuated joint keeps it level (eq. 1).
    pub fn independent_torques(&self) -> Vec<usize> {
        (0..self.joints.len()).filter(|j| *j != self.unactuated).collect()
    }
}

/// Bodies of a leg that hangs at `mount`, numbered from `first_body` and with coordinates from `first_joint`; and
/// its foot from the last joint.
fn chain(leg: &Leg, mount: [f64; 3], first_body: usize, first_joint: usize) -> (Vec<Body>, [f64; 3]) {
    let mut offset = mount;
    let bodies = leg.chain.iter().enumerate().map(|(i, Segment { joint, link })| {
        let parent = if i == 0 { 0 } else { first_body + i - 1 };
        let at = std::mem::replace(&mut offset, link.end);
        Body {
            name: link.name.clone(),
            parent: Some(parent),
            coordinate: Some(first_joint + i),
            axis: joint.axis,
            offset: at,
            mass: link.mass,
            com: link.com,
            inertia: link.inertia,
        }
    });
    (bodies.collect(), offset)
}

impl Body {
    /// How many numbers are measured of a body.
    pub const COUNT: usize = 3 + 1 + 3 + 9;

    fn numbers(&self) -> [f64; Body::COUNT] {
        let ([x, y, z], [u, v, w], [a, b, c]) = (self.offset, self.com, self.inertia);
        [x, y, z, self.mass, u, v, w, a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
    }
}

impl Actuated {
    /// The joint of a virtual leg, which the motors of all its `members` drive.
    fn new(joint: &Joint, leg: usize, members: usize) -> Actuated {
        let a = &joint.actuator;
        let motors = members as f64;
        let joint_speed = |rev_per_min: f64| rev_per_min * std::f64::consts::TAU / 60.0 / a.gear;
        Actuated {
            name: format!("{}{leg}", joint.name),
            range: joint.range,
            gear: a.gear,
            max_torque: motors * a.max_torque * a.gear,
            unloaded_speed: joint_speed(a.unloaded_speed),
            loaded_speed: joint_speed(a.loaded_speed),
            rotor_inertia: motors * a.rotor_inertia * a.gear * a.gear,
        }
    }
}
