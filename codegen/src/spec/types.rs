//! A validated specification: plain values, every reference resolved, nothing left to check.
//!
//! Frames: body axes x forward, y up, z to the right, the same for all bodies where all joints are at zero.
//! SI units, except motor speeds (rev/min), which is how data sheets state them.

use std::collections::BTreeSet;
use std::sync::Arc;

/// The real robot: a platform and its legs, in real-leg values.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    pub name: String,
    /// Magnitude of gravity, m/s², along −y.
    pub gravity: f64,
    pub platform: Platform,
    pub legs: Vec<Leg>,
    /// Names of the numbers that its file has: how a length is written, and which zeros.
    pub written: Arc<BTreeSet<String>>,
}

/// The platform (trunk). The gaits' coordinates `p` are those of its mass centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Platform {
    pub name: String,
    pub mass: f64,
    /// Mass centre in the frame in which the legs' mounts are given, m.
    pub com: [f64; 3],
    /// About the mass centre, in platform axes.
    pub inertia: Inertia,
    /// What it fills, if that is given.
    pub extent: Option<Extent>,
}

/// A box with edges along the platform's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Edges along x, y, z, m.
    pub size: [f64; 3],
    /// Its middle in the frame in which the legs' mounts are given, m.
    pub centre: [f64; 3],
}

impl Extent {
    /// In the frame in which the legs' mounts are given, m.
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| {
            [0, 1, 2].map(|k| self.centre[k] + if corner >> k & 1 == 0 { -0.5 } else { 0.5 } * self.size[k])
        })
    }
}

/// An inertia tensor, kg·m²: moments Ixx, Iyy, Izz on its diagonal, −∫xy dm and the like beside it.
pub type Inertia = [[f64; 3]; 3];

/// One real leg: a chain of joint + link, from the mount down to the foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    pub name: String,
    /// First joint in the platform's frame, m.
    pub mount: [f64; 3],
    pub chain: Vec<Segment>,
    /// Joints above its first that a gait holds still, in the platform's frame.
    pub locked: Vec<Locked>,
}

/// A joint that a gait holds still ([`Robot::locked`]): it moves nothing, but is a point of what carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Locked {
    /// The joint.
    pub name: String,
    /// In the axes of the link (from its joint) or of the platform, m.
    pub at: [f64; 3],
}

/// A joint and the link that it carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    pub joint: Joint,
    pub link: Link,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    pub name: String,
    pub axis: Axis,
    /// Lower and upper stop, rad.
    pub range: [f64; 2],
    pub spring: Spring,
    pub friction: Friction,
    pub actuator: Actuator,
}

/// A spring beside a motor, at the joint: the motor overcomes `stiffness · (q − rest)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// N·m/rad.
    pub stiffness: f64,
    /// Where it does nothing, rad.
    pub rest: f64,
}

/// What a motor overcomes besides the dynamics, at the joint: `damping · q̇ + coulomb · sign q̇`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// N·m·s/rad.
    pub damping: f64,
    /// N·m.
    pub coulomb: f64,
}

/// A body axis; a joint turns positively about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// x, forward.
    Roll,
    /// y, up.
    Yaw,
    /// z, to the right.
    Pitch,
}

impl Axis {
    pub const ALL: [Axis; 3] = [Axis::Roll, Axis::Yaw, Axis::Pitch];

    /// x, y, z as 0, 1, 2.
    pub const fn index(self) -> usize {
        match self {
            Axis::Roll => 0,
            Axis::Yaw => 1,
            Axis::Pitch => 2,
        }
    }
}

/// A link of a leg without its foot, which is a point at its end: `Link::rigid` has both.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    pub name: String,
    pub mass: f64,
    /// The next joint (last link: the foot) from its own joint, in link axes, m.
    pub end: [f64; 3],
    /// Mass centre from the proximal joint, in link axes, m.
    pub com: [f64; 3],
    /// About the mass centre, in link axes.
    pub inertia: Inertia,
    /// Of the foot, kg.
    pub foot_mass: f64,
    /// Joints that a gait holds still, so that what they carried is part of this link.
    pub locked: Vec<Locked>,
}

/// The motor of one joint of one leg.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    pub name: String,
    /// Motor turns per joint turn.
    pub gear: f64,
    /// At the motor, N·m.
    pub max_torque: f64,
    /// Motor speed limits at no torque and at `max_torque`, rev/min.
    pub unloaded_speed: f64,
    pub loaded_speed: f64,
    /// At the motor, kg·m² (acts on the joint times gear²).
    pub rotor_inertia: f64,
}

/// How a gait uses the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    pub name: String,
    /// Indices into `Robot::legs`: the real legs that make up virtual leg 1 and 2.
    pub virtual_legs: [Vec<usize>; 2],
    /// Joints that the gait holds at an angle, by name; rad.
    pub locked: Vec<(String, f64)>,
    pub rotation: Rotation,
    pub unactuated: Unactuated,
    /// In the order in which they follow each other.
    pub phases: Phases,
    /// Order of the joint polynomials (eq. 15): 4, 6 or 8.
    pub polynomial_order: usize,
    pub limits: Limits,
}

/// How the platform may rotate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    None,
    /// About Zf.
    Pitch,
    /// About Xf.
    Roll,
}

impl Rotation {
    /// Whether the platform also moves sideways (z): it does where it rolls, about a foot beside it.
    pub const fn is_spatial(self) -> bool {
        matches!(self, Rotation::Roll)
    }

    /// Why a robot whose platform rotates like this cannot fly, if it cannot.
    pub const fn keeps_on_the_ground(self) -> Option<&'static str> {
        match self {
            Rotation::None | Rotation::Pitch => None,
            Rotation::Roll => Some(
                "the platform rolls: in stance the two real feet carry the pitch and yaw moments that the model \
                 leaves out, in flight nobody does",
            ),
        }
    }
}

/// The coordinate β that no actuator drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unactuated {
    /// The platform's rotation.
    Platform,
    /// A leg's first joint, where the platform does not rotate: `leg` 0 or 1, `joint` in its chain
    /// of joints that are not locked.
    Joint { leg: usize, joint: usize },
}

/// A cyclic list of phases.
#[derive(Clone, Debug, PartialEq)]
pub struct Phases {
    pub list: Vec<Phase>,
    pub then: Then,
    /// Whether they are given as half steps, all with the duration in `limits.half_step_duration`.
    pub half_steps: bool,
}

/// What stands on the ground for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// The virtual leg that stands, 0 or 1; none in flight.
    pub stance: Option<usize>,
    /// Shortest and longest, s.
    pub duration: [f64; 2],
}

/// What follows the last phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// The same with the virtual legs' roles exchanged: the list is half a cycle.
    Mirrored,
    /// The first phase: the list is the whole cycle.
    Repeat,
}

impl Phases {
    /// One half step that its mirror image follows, or two different ones, on leg 1 and on leg 2.
    pub fn half_steps(then: Then, duration: [f64; 2]) -> Phases {
        let legs = match then {
            Then::Mirrored => 0..1,
            Then::Repeat => 0..2,
        };
        let list = legs.map(|leg| Phase { stance: Some(leg), duration }).collect();
        Phases { list, then, half_steps: true }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    pub friction: f64,
    /// N.
    pub min_vertical_force: f64,
    /// Height of the swing parabola, m.
    pub swing_clearance: f64,
    /// Of the platform's mass centre, m.
    pub min_platform_height: f64,
    /// Of everything but feet above the ground, m.
    pub body_clearance: f64,
}
