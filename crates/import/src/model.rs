//! What URDF and MJCF both say: links on joints, each thing with its place in the file. SI units, the file's own axes.

use super::Rigid;
use super::fault::Place;
use nalgebra::{Isometry3, Matrix3, Vector3};

/// Gravity where a file says nothing else, m/s².
pub const EARTH: f64 = 9.81;

/// A robot as its file has it.
pub struct Model {
    pub name: String,
    pub format: Format,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
    /// m/s²; `None` where the file gives none.
    pub gravity: Option<f64>,
    /// Against gravity, in the root's frame; `None` where the file does not tell.
    pub up: Option<Vector3<f64>>,
    /// What was left out or rounded, a sentence each.
    pub notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Urdf,
    Mjcf,
}

impl Format {
    pub fn name(self) -> &'static str {
        match self {
            Format::Urdf => "URDF",
            Format::Mjcf => "MJCF",
        }
    }
}

pub struct Link {
    pub name: String,
    pub place: Place,
    /// In the link's frame.
    pub masses: Vec<Mass>,
    /// What can touch the ground, in the link's frame.
    pub shapes: Vec<Shape>,
}

/// A mass with its moments of inertia about its centre, in its own frame; kg, kg·m².
pub struct Mass {
    pub mass: f64,
    pub frame: Isometry3<f64>,
    pub inertia: Matrix3<f64>,
}

impl Mass {
    /// In the axes of its link.
    pub fn rigid(&self) -> Rigid {
        let rotation = self.frame.rotation.to_rotation_matrix();
        let rotation: &Matrix3<f64> = rotation.matrix();
        let inertia = rotation * self.inertia * rotation.transpose();
        Rigid { mass: self.mass, com: self.frame.translation.vector, inertia }
    }
}

#[derive(Clone, Debug)]
pub struct Shape {
    pub frame: Isometry3<f64>,
    pub solid: Solid,
}

/// Capsules and cylinders lie along their z axis; a box has half its edges, an ellipsoid half its axes; m.
#[derive(Clone, Copy, Debug)]
pub enum Solid {
    Sphere { radius: f64 },
    Capsule { radius: f64, half: f64 },
    Cylinder { radius: f64, half: f64 },
    Box { half: [f64; 3] },
    Ellipsoid { half: [f64; 3] },
}

pub struct Joint {
    pub name: String,
    pub place: Place,
    pub kind: Kind,
    /// Whether it goes along its axis instead of about it: what it does is in m.
    pub slides: bool,
    /// Indices of links.
    pub parent: usize,
    pub child: usize,
    /// The joint's frame in the parent's.
    pub frame: Isometry3<f64>,
    /// The child's origin in the joint's frame, m.
    pub offset: Vector3<f64>,
    /// In the joint's frame, any length.
    pub axis: Vector3<f64>,
    /// Stops, rad or m; `None` where the file gives none.
    pub range: Option<[f64; 2]>,
    /// At the joint: N·m, rad/s.
    pub effort: Option<f64>,
    pub velocity: Option<f64>,
    /// Motor turns per joint turn.
    pub gear: Option<f64>,
    pub rotor: Option<Rotor>,
    pub spring: Spring,
    /// Whether its spring and damping follow from the inertia of the whole robot, and are not read.
    pub spring_is_derived: bool,
    pub friction: Friction,
}

/// The inertia of a rotor, kg·m², where a file or a person gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotor {
    AtMotor(f64),
    /// What the joint feels of it, whatever its gear is.
    AtJoint(f64),
}

impl Rotor {
    /// Motor turns per joint turn; 1 where nothing is known of them.
    fn square(gear: Option<f64>) -> f64 {
        gear.unwrap_or(1.0).powi(2)
    }

    pub fn at_motor(self, gear: Option<f64>) -> f64 {
        match self {
            Rotor::AtMotor(inertia) => inertia,
            Rotor::AtJoint(inertia) => inertia / Rotor::square(gear),
        }
    }

    pub fn at_joint(self, gear: Option<f64>) -> f64 {
        match self {
            Rotor::AtMotor(inertia) => inertia * Rotor::square(gear),
            Rotor::AtJoint(inertia) => inertia,
        }
    }
}

/// Of a joint: stiffness, N·m/rad, and the angle at which it does nothing, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    pub stiffness: f64,
    pub rest: f64,
}

impl Spring {
    pub fn is_none(self) -> bool {
        self.stiffness == 0.0
    }

    /// Seen with the joint's angle turned round.
    pub fn turned(self) -> Spring {
        Spring { rest: 0.0 - self.rest, ..self }
    }
}

/// Of a joint: viscous, N·m·s/rad, and dry, N·m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    pub damping: f64,
    pub coulomb: f64,
}

impl Friction {
    pub fn is_none(self) -> bool {
        self == Friction::default()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    Fixed,
    Revolute,
    Continuous,
    /// Puts a model into a world.
    Free,
    /// Follows another joint.
    Mimic,
    /// Any other, by its name.
    Other(String),
}

impl Joint {
    /// The unit of what it does.
    pub fn unit(&self) -> &'static str {
        if self.slides { "m" } else { "rad" }
    }

    /// The angle or place nearest to zero within its stops.
    pub fn at_rest(&self) -> f64 {
        match self.range {
            Some([low, high]) if (self.slides || self.kind == Kind::Revolute) && low <= high => 0.0f64.clamp(low, high),
            _ => 0.0,
        }
    }

    /// Whether it has one degree of freedom: a number says where it is.
    pub fn has_angle(&self) -> bool {
        self.turns() || self.slides || self.kind == Kind::Mimic
    }

    pub fn turns(&self) -> bool {
        matches!(self.kind, Kind::Revolute | Kind::Continuous)
    }
}
