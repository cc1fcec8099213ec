//! URDF → the specification of a robot: what was taken, what was assumed, what was dropped.
//!
//! `tree` reads the bodies that move against each other, in the specification's axes; `legs` finds the
//! platform and the chains that hang on it; `write` puts them into words. URDF's axes are x forward,
//! y to the left, z up; the specification's are x forward, y up, z to the right.

mod legs;
mod tree;
mod write;

use nalgebra::{Matrix3, Vector3};

/// What an import takes beside the file.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Joints held where they are at zero (or at the stop nearest to it): arms, heads, wheels.
    pub locked: Vec<String>,
}

/// A specification made of a URDF.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// The robot's name as a folder's name.
    pub folder: String,
    /// `robot.toml`.
    pub robot: String,
    /// Gaits to begin with: name of the file and its text.
    pub gaits: Vec<(String, String)>,
    /// What a person must know of it, a sentence each.
    pub notes: Vec<String>,
}

/// Why a URDF is no robot of this family, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    #[error("this is no URDF: {0}")]
    Syntax(#[from] urdf_rs::UrdfError),
    #[error("joint `{joint}` names link `{link}`, which does not exist")]
    NoSuchLink { joint: String, link: String },
    #[error("there is no joint `{0}` to lock")]
    NoSuchJoint(String),
    #[error("the links do not form one tree: {0}")]
    NotATree(String),
    #[error("joint `{joint}` is {kind}: only revolute joints move. Lock it (--lock {joint}) or make it fixed")]
    NotRevolute { joint: String, kind: String },
    #[error("joint `{0}` follows another one (mimic): lock it (--lock {0})")]
    Mimic(String),
    #[error(
        "joint `{joint}` turns about an oblique axis ({axis:.3?} in the root's frame, all joints at zero): the axes \
         must be those of the root link"
    )]
    ObliqueAxis { joint: String, axis: [f64; 3] },
    #[error("joint `{joint}` has no {what} in its <limit>: an actuator cannot be made of it")]
    NoLimit { joint: String, what: &'static str },
    #[error("link `{0}` moves but has no mass")]
    Massless(String),
    #[error("a chain branches at link `{link}` into {joints}: lock those that are no legs (--lock)")]
    Branch { link: String, joints: String },
    #[error(
        "there is no foot on link `{0}`: add a link without mass where it touches the ground, with a fixed joint, or \
         lock the joints of this chain if it is no leg (--lock)"
    )]
    NoFoot(String),
    #[error("there are {0} legs, at least two are needed")]
    TooFewLegs(usize),
    #[error("the number {0} of `{1}` is not finite")]
    NotFinite(&'static str, String),
}

/// Makes a specification of a URDF's text.
///
/// # Errors
/// If it describes no platform on legs of revolute joints.
pub fn import(urdf: &str, options: &Options) -> Result<Import, ImportError> {
    let robot = urdf_rs::read_from_string(urdf)?;
    let tree = tree::Tree::new(&robot, options)?;
    let legs = legs::find(&tree)?;
    Ok(write::specification(&robot.name, &tree, &legs))
}

/// From URDF's axes to the specification's.
fn axes() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

/// Mass, mass centre and inertia about it, in the specification's axes from the root's origin; kg, m, kg·m².
#[derive(Clone, Copy, Debug)]
struct Rigid {
    mass: f64,
    com: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Rigid {
    const NOTHING: Rigid = Rigid {
        mass: 0.0,
        com: Vector3::new(0.0, 0.0, 0.0),
        inertia: Matrix3::from_array_storage(nalgebra::ArrayStorage([[0.0; 3]; 3])),
    };

    /// Both bodies as one, by the parallel axis theorem.
    fn with(&self, other: &Rigid) -> Rigid {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return *self;
        }
        let share = other.mass / mass;
        let apart = other.com - self.com;
        let steiner = Matrix3::identity() * apart.norm_squared() - apart * apart.transpose();
        Rigid {
            mass,
            com: self.com + apart * share,
            inertia: self.inertia + other.inertia + steiner * (self.mass * share),
        }
    }
}
