//! URDF or MJCF → the specification of a robot that builds: what was taken, what was assumed, what was dropped; or everything
//! that is in the way, each with its place and what to do about it.
//!
//! `urdf` and `mjcf` read a `model`: links on joints. `tree` makes of it the bodies that move against each
//! other; `limbs` decides which chains are legs and holds the rest still; `foot` finds where they touch the ground. `robot`
//! has what the specification needs, `symmetry` makes alike what is meant to be, `write` and `gaits` put it into words, and the
//! specification's own checks have the last one. A `trial` then finds out which gaits the robot can do. URDF's axes are x forward, y to the left, z up, unless a person says
//! otherwise; the specification's are x forward, y up, z to the right.

#![forbid(unsafe_code)]

mod axes;
mod fault;
mod foot;
mod gaits;
mod inertia;
mod limbs;
mod mjcf;
mod model;
mod options;
mod robot;
pub mod standing;
mod symmetry;
mod tree;
mod trial;
mod urdf;
mod words;
mod write;
mod xml;

pub use axes::Direction;
pub use fault::{Fault, ImportError, Kind, Place};
pub use gaits::{Candidate, Variant};
pub use trial::Found;

use fault::Faults;
use model::Model;
use nalgebra::{Matrix3, Vector3};
use piaffe_codegen::spec::parse_robot;
use std::str::FromStr;

/// What an import takes beside the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Joints that are held still: arms, heads, wheels.
    pub locks: Vec<Lock>,
    /// Where legs touch the ground.
    pub feet: Vec<FootPoint>,
    /// Of joints, N·m and rad/s; motor turns per joint turn; of rotors at the motor, kg·m².
    pub efforts: Vec<Setting>,
    pub velocities: Vec<Setting>,
    pub gears: Vec<Setting>,
    pub rotors: Vec<Setting>,
    pub ranges: Vec<Stops>,
    /// Axes of the root link.
    pub forward: Option<Direction>,
    pub up: Option<Direction>,
    /// Parts that differ by no more than this share are made alike.
    pub alike: f64,
    /// Whether inertias that no body has become the nearest possible ones.
    pub mend: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            locks: Vec::new(),
            feet: Vec::new(),
            efforts: Vec::new(),
            velocities: Vec::new(),
            gears: Vec::new(),
            rotors: Vec::new(),
            ranges: Vec::new(),
            forward: None,
            up: None,
            alike: 1e-3,
            mend: false,
        }
    }
}

/// A joint to hold, or all that a pattern with `*` and `?` fits; with a `/` at the end all below it too.
#[derive(Clone, Debug, PartialEq)]
pub struct Lock {
    pub pattern: String,
    /// The file's angle, rad; the one nearest to zero if it is not given.
    pub angle: Option<f64>,
}

/// The link of a foot and the point of it that touches the ground, in its frame, m.
#[derive(Clone, Debug, PartialEq)]
pub struct FootPoint {
    pub link: String,
    pub point: Option<Vector3<f64>>,
}

/// A number for the joints that a pattern fits; without one for all that have none.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub joint: Option<String>,
    pub value: f64,
}

/// Stops for the joints that a pattern fits, rad.
#[derive(Clone, Debug, PartialEq)]
pub struct Stops {
    pub joint: String,
    pub range: [f64; 2],
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    number.ok_or_else(|| format!("\"{text}\" is no number"))
}

fn finite_list<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split(',').map(finite).collect::<Result<_, _>>()?;
    <[f64; N]>::try_from(numbers).map_err(|n| format!("{} numbers instead of {N}", n.len()))
}

impl FromStr for Lock {
    type Err = String;

    fn from_str(text: &str) -> Result<Lock, String> {
        match text.rsplit_once('=') {
            Some((pattern, angle)) => Ok(Lock { pattern: pattern.into(), angle: Some(finite(angle)?) }),
            None => Ok(Lock { pattern: text.into(), angle: None }),
        }
    }
}

impl FromStr for FootPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<FootPoint, String> {
        match text.rsplit_once('=') {
            Some((link, point)) => {
                Ok(FootPoint { link: link.into(), point: Some(Vector3::from(finite_list::<3>(point)?)) })
            }
            None => Ok(FootPoint { link: text.into(), point: None }),
        }
    }
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Setting, String> {
        let (joint, value) = match text.rsplit_once('=') {
            Some((joint, value)) => (Some(joint.to_string()), value),
            None => (None, text),
        };
        let value = finite(value)?;
        if value < 0.0 { Err("must not be negative".into()) } else { Ok(Setting { joint, value }) }
    }
}

impl FromStr for Stops {
    type Err = String;

    fn from_str(text: &str) -> Result<Stops, String> {
        let (joint, range) = text.rsplit_once('=').ok_or("write JOINT=LOW,HIGH in rad")?;
        let [low, high] = finite_list(range)?;
        if low < high {
            Ok(Stops { joint: joint.into(), range: [low, high] })
        } else {
            Err("write the lower stop first".into())
        }
    }
}

/// A specification made of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The robot's name as a folder's name.
    pub folder: String,
    /// `robot.toml`.
    pub robot: String,
    /// Gaits to begin with: name of the file and its text. At least one.
    pub gaits: Vec<(String, String)>,
    /// Gaits that legs like these have; [`Import::tried`] makes of them those that the robot can do.
    pub candidates: Vec<Candidate>,
    /// What a trial found, a gait each of its own file.
    pub found: Vec<Found>,
    /// What a person must know of it, a sentence each.
    pub notes: Vec<String>,
}

/// Makes a specification of a file's text. What it returns passes the specification's checks.
///
/// # Errors
/// All that is in the way, if the file describes no platform on legs of revolute joints.
pub fn import(text: &str, options: &Options) -> Result<Import, ImportError> {
    let mut faults = Faults::default();
    let model = read(text, &mut faults)?;
    let skeleton = tree::Skeleton::new(&model, &mut faults);
    faults.settle()?;
    let skeleton = skeleton.expect("a skeleton, where nothing was wrong");
    options::check(&model, options, &mut faults);
    let axes = axes::rotation(options, &mut faults);
    faults.settle()?;
    let limbs = limbs::find(&model, &skeleton, options, &axes, &mut faults);
    // On axes that are not the robot's nothing else that is said would hold.
    let mut turned = Faults::default();
    axes::ask(&model, &limbs, options, &mut turned);
    turned.settle()?;
    let mut notes = model.notes.clone();
    notes.extend(limbs.notes.iter().cloned());
    let mut robot = robot::assemble(&model, &limbs, options, &mut faults, &mut notes);
    if limbs.chains.len() < 2 {
        let what = match limbs.chains.len() {
            0 => "no limb reaches the ground: there is no leg",
            _ => "only one limb reaches the ground, and two legs are needed",
        };
        let remedy = "name the feet: --foot LINK, or LINK=x,y,z with the point in its frame; or say which axes of the root are \
                      forward and up, if they are not x and z: --forward AXIS --up AXIS";
        faults.add(Kind::Legs, None, what, remedy);
    }
    faults.settle()?;
    let Some(arrangement) = symmetry::arrange(&mut robot, options.alike, &mut notes) else {
        faults.add(Kind::Legs, None, unpaired(&robot), "hold what is no leg (--lock JOINT/), name what is one (--foot LINK), or say which way is forward (--forward)");
        return Err(ImportError(faults.take()));
    };
    notes.extend(options::idle(&model, &limbs, options));
    remarks(&model, &robot, &mut notes);
    notes.extend(arrangement.differences.iter().cloned());
    notes.extend(arrangement.consequence());
    let text = write::robot(&robot, model.format, &notes);
    let file = parse_robot("robot.toml", &text).map_err(|mistakes| refused(&mistakes, &robot))?;
    let gaits = gaits::find(&robot, &arrangement, &file);
    if gaits.candidates.is_empty() {
        let mut why = arrangement.differences.clone();
        why.extend(gaits.notes);
        let what = format!("no gait fits these legs: {}", why.join("; "));
        let remedy = format!("{}; or hold joints still (--lock)", symmetry::MEANT_ALIKE);
        faults.add(Kind::Legs, None, what, remedy);
        return Err(ImportError(faults.take()));
    }
    notes.extend(gaits.notes);
    notes.push("the limits of the gaits (friction, clearance, forces, durations) are assumed".into());
    let untried = trial::untried(&gaits.candidates);
    let folder = write::folder(&robot.name, gaits.candidates.iter().map(|candidate| candidate.name.as_str()));
    Ok(Import { folder, robot: text, gaits: untried, candidates: gaits.candidates, found: Vec::new(), notes })
}

/// Reads a file of any format that is known.
fn read(text: &str, faults: &mut Faults) -> Result<Model, ImportError> {
    let prepared = xml::Prepared::new(text)?;
    let file = prepared.document()?;
    let root = file.root();
    let place = file.place(root);
    let model = match root.tag_name().name() {
        "robot" => urdf::read(&file, faults),
        "mujoco" => mjcf::read(&file, faults),
        "sdf" => {
            let remedy =
                "convert it first: `sdf2mjcf robot.sdf robot.xml` (pip install sdformat-mjcf), then import robot.xml";
            faults.add(Kind::Format, Some(&place), "this is SDF", remedy);
            None
        }
        "mujocoinclude" => {
            let remedy = "import the file that includes it, with its contents put in";
            faults.add(Kind::Format, Some(&place), "this is a part of an MJCF file", remedy);
            None
        }
        _ => {
            faults.add(
                Kind::Format,
                Some(&place),
                "this is neither URDF (<robot>) nor MJCF (<mujoco>)",
                "give one of them",
            );
            None
        }
    };
    faults.settle()?;
    Ok(model.expect("a model, where nothing was wrong"))
}

/// Why legs form no pairs.
fn unpaired(robot: &robot::Robot) -> String {
    let names: Vec<String> = robot.legs.iter().map(|l| format!("`{}`", l.name)).collect();
    format!("{} legs do not form pairs of a left and a right one, from fore to hind: {}", names.len(), names.join(", "))
}

/// What holds for every import of its kind.
fn remarks(model: &Model, robot: &robot::Robot, notes: &mut Vec<String>) {
    let file = model.format.name();
    notes.push("visual and collision geometry is dropped, but for where feet touch the ground".into());
    let rubbing = robot.legs.iter().flat_map(|l| &l.segments).filter(|s| !s.joint.friction.is_none()).count();
    if rubbing > 0 {
        notes.push(format!("the friction of {rubbing} joints is taken over, as `damping` and `coulomb`"));
    }
    let sprung = robot.legs.iter().flat_map(|l| &l.segments).filter(|s| !s.joint.spring.is_none()).count();
    if sprung > 0 {
        notes.push(format!("the springs of {sprung} joints are taken over, as `stiffness` and `rest_angle`"));
    }
    let motors = || robot.legs.iter().flat_map(|l| &l.segments).map(|s| &s.joint.motor);
    if motors().any(|m| m.gear.is_none()) {
        notes.push("gears are taken to be 1 where none is given, so that torques and speeds are the joints'".into());
    }
    if motors().any(|m| m.rotor.is_none()) {
        notes.push("inertias of rotors are taken to be 0 where none is given".into());
    }
    notes.push(format!("the greatest torque is taken to be there at any speed: {file} knows no line between them"));
    for leg in &robot.legs {
        notes.push(format!("leg `{}` ends in a point: {}", leg.name, leg.foot));
    }
    if robot.gravity.is_none() {
        notes.push(format!("gravity is taken to be {} m/s²", model::EARTH));
    }
    let held = gaits::held(robot);
    if !held.is_empty() {
        notes.push(format!(
            "the gaits hold still what leaves their plane, and what swings below the second joint that does: {} rad; \
             take from `locked` in gaits/ what is to swing freely",
            held.join(", ")
        ));
    }
}

/// What the specification's checks say of a text that was made here.
fn refused(mistakes: &[piaffe_codegen::spec::Diagnostic], robot: &robot::Robot) -> ImportError {
    let mut faults = Faults::default();
    for mistake in mistakes {
        let (line, _) = mistake.line_column();
        let lines: Vec<&str> = mistake.primary.source.text().lines().take(line).collect();
        let text = lines.last().copied().unwrap_or_default();
        let what = format!("{} ({}, robot.toml would say `{text}`)", mistake.title, mistake.code);
        let header = lines.iter().rfind(|line| line.starts_with('[')).copied().unwrap_or_default();
        let places = write::sources(robot, header);
        if places.is_empty() {
            faults.add(Kind::Specification, None, what, mistake.help.clone());
            continue;
        }
        let remedy = match header.starts_with("[actuators.") {
            true => {
                "correct its greatest torque or speed, or give another one: --effort JOINT=…, --velocity JOINT=…, --gear JOINT=…"
            }
            false => "correct what the file says of it",
        };
        places.into_iter().for_each(|place| faults.add(Kind::Specification, Some(place), what.clone(), remedy));
    }
    ImportError(faults.take())
}

/// Angles between axes of joints and of the trunk that count as rounding, rad: 0.1°, which no assembly keeps.
const ROUNDED: f64 = 2e-3;

/// The coordinate axis nearest to a direction of unit length, 1 or −1 where it points along it or against it, and the angle
/// between them.
fn nearest_axis(direction: &Vector3<f64>) -> (usize, f64, f64) {
    let axis = direction.iamax();
    let mut rest = *direction;
    rest[axis] = 0.0;
    (axis, direction[axis].signum(), rest.norm().atan2(direction[axis].abs()))
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
