//! From the specification to a mechanism: the real robot (`robot`) as a gait moves it (`embedding`), with numbers; what of it
//! stands on the ground (`mode`), and how that changes (`transition`).

mod embedding;
mod family;
mod lever;
mod mode;
mod names;
mod parameter;
mod points;
mod robot;
mod transition;

pub use embedding::{Member, VirtualLeg};
pub use family::Family;
pub use lever::{Lever, levers};
pub use mode::{Mode, Phase, other_leg};
pub use parameter::{Parameter, Sign, parameters, select, with};
pub use points::{Point, Spot, points};
pub use robot::{Body, Whole, WholeJoint, WholeLeg};
pub use transition::Transition;

use crate::spec::{Gait, Joint, Limits, Robot, Rotation, Then, Unactuated};

/// A robot as one gait moves it; SI units, body axes x forward, y up, z right.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    pub gait: String,
    pub robot: String,
    /// m/s², along −y.
    pub gravity: f64,
    pub rotation: Rotation,
    /// The platform, then of each virtual leg its links from the platform down, those that move alike put together.
    pub bodies: Vec<Body>,
    /// Corners of what the platform fills.
    pub corners: Vec<Spot>,
    /// Joint coordinates q1, q2, … of virtual leg 1, then of virtual leg 2.
    pub joints: Vec<Actuated>,
    pub legs: [VirtualLeg; 2],
    /// Index of β in q = [joints, θ].
    pub unactuated: usize,
    pub phases: Vec<Phase>,
    pub then: Then,
    /// In which situations it moves; stance on either leg is always among them.
    pub modes: Vec<Mode>,
    /// How these follow each other.
    pub transitions: Vec<Transition>,
    pub polynomial_order: usize,
    pub limits: Limits,
}

/// An actuated joint of a virtual leg, seen at the joint: N·m, rad/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuated {
    pub name: String,
    pub range: [f64; 2],
    pub gear: f64,
    pub max_torque: f64,
    pub unloaded_speed: f64,
    pub loaded_speed: f64,
    /// Rotor inertias times gear², kg·m².
    pub rotor_inertia: f64,
    /// A spring beside the motor, N·m/rad, and where it does nothing, rad.
    pub stiffness: f64,
    pub rest: f64,
    /// Viscous friction, N·m·s/rad, and dry friction, N·m.
    pub damping: f64,
    pub coulomb: f64,
}

impl Mechanism {
    /// The robot in the coordinates of `gait`. Both must have passed validation, and the robot must be
    /// one whose locked joints are gone ([`Robot::locked`]).
    pub fn new(robot: &Robot, gait: &Gait) -> Mechanism {
        let (mut bodies, mut joints) = (vec![Body::platform(robot)], Vec::new());
        let legs = [0, 1].map(|k| VirtualLeg::new(robot, &gait.virtual_legs[k], k + 1, &mut joints, &mut bodies));
        let phases: Vec<Phase> = gait.phases.list.iter().map(Phase::new).collect();
        let unactuated = match gait.unactuated {
            Unactuated::Platform => joints.len(),
            Unactuated::Joint { leg, joint } => legs[leg].joints.start + joint,
        };
        Mechanism {
            gait: gait.name.clone(),
            robot: robot.name.clone(),
            gravity: robot.gravity,
            rotation: gait.rotation,
            bodies,
            corners: points::corners(&robot.platform),
            joints,
            legs,
            unactuated,
            modes: mode::all(&phases),
            transitions: transition::all(&phases, gait.phases.then),
            phases,
            then: gait.phases.then,
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
        if self.rotation.is_spatial() { 3 } else { 2 }
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
            stiffness: motors * joint.spring.stiffness,
            rest: joint.spring.rest,
            damping: motors * joint.friction.damping,
            coulomb: motors * joint.friction.coulomb,
        }
    }
}
