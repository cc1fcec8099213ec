//! Which axes of the root link are forward and up: given, or URDF's, and then asked about where the legs say otherwise.

use super::Options;
use super::fault::{Faults, Kind};
use super::limbs::Limbs;
use super::model::Model;
use super::nearest_axis;
use super::robot::PITCH;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::fmt;
use std::str::FromStr;

/// An axis of the root link, with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    axis: usize,
    negative: bool,
}

impl Direction {
    fn vector(self) -> Vector3<f64> {
        let mut v = Vector3::zeros();
        v[self.axis] = if self.negative { -1.0 } else { 1.0 };
        v
    }

    fn reversed(self) -> Direction {
        Direction { negative: !self.negative, ..self }
    }

    fn of(v: &Vector3<f64>) -> Direction {
        let (axis, sign, _) = nearest_axis(v);
        Direction { axis, negative: sign < 0.0 }
    }
}

impl FromStr for Direction {
    type Err = String;

    fn from_str(text: &str) -> Result<Direction, String> {
        let (negative, letter) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let axis = ["x", "y", "z"].iter().position(|a| *a == letter).ok_or("must be x, y, z, -x, -y or -z")?;
        Ok(Direction { axis, negative })
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.negative { "-" } else { "" }, ["x", "y", "z"][self.axis])
    }
}

/// Axes farther than this from a coordinate axis say nothing of it, rad.
const OBLIQUE: f64 = 0.2;

/// Legs point up that rise by this share of their length where all joints are at zero, and reach as much farther up than down.
const UPWARD: f64 = 0.5;

const X: Direction = Direction { axis: 0, negative: false };
const Z: Direction = Direction { axis: 2, negative: false };

/// From the root link's axes to the specification's.
pub fn rotation(options: &Options, faults: &mut Faults) -> UnitQuaternion<f64> {
    let forward = options.forward.unwrap_or(X);
    let up = options.up.unwrap_or(if forward.axis == Z.axis { X } else { Z });
    if forward.axis == up.axis {
        let what = format!("--forward {forward} and --up {up} are one line");
        faults.add(Kind::Option, None, what, "give two different axes of the root link");
        return UnitQuaternion::identity();
    }
    let (x, y) = (forward.vector(), up.vector());
    let rows = Matrix3::from_rows(&[x.transpose(), y.transpose(), x.cross(&y).transpose()]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows))
}

/// Says what speaks against the axes that were taken, unless a person gave them.
pub fn ask(model: &Model, limbs: &Limbs, options: &Options, faults: &mut Faults) {
    if options.forward.is_some() && options.up.is_some() {
        return;
    }
    let taken = rotation(options, &mut Faults::default());
    let to_file = |v: Vector3<f64>| Direction::of(&(taken.inverse() * v));
    let bodies = &limbs.tree.bodies;
    let mut turning = [0; 3];
    let mut down = Vector3::zeros();
    for chain in &limbs.chains {
        let axes = chain.iter().filter_map(|b| bodies[*b].joint.as_ref()).map(|joint| nearest_axis(&joint.axis));
        axes.filter(|(_, _, tilt)| *tilt < OBLIQUE).for_each(|(axis, _, _)| turning[axis] += 1);
        let last = chain.last().map_or(0, |b| *b);
        down += bodies[last].rigid.com - bodies[chain.first().map_or(0, |b| *b)].origin;
    }
    let place = &model.links[bodies[0].link].place;
    if options.up.is_none() && ask_up(model, limbs, &taken, &down, options, faults) {
        return;
    }
    if options.forward.is_some() {
        return;
    }
    let across = (0..3).max_by_key(|k| (turning[*k], *k == PITCH)).unwrap_or(PITCH);
    // A leg that walks has two joints that swing it.
    if turning[across] > turning[PITCH] && turning[across] >= 2 * limbs.chains.len() {
        let mut lateral = Vector3::zeros();
        lateral[across] = 1.0;
        let mut hang = down;
        hang[across] = 0.0;
        let up = to_file(-nearest(&hang));
        // Forward is across both; which of the two ways only a person knows, unless the names of legs tell.
        let mut forward = nearest(&hang).cross(&lateral);
        if let Some(fore) = fore_minus_hind(model, limbs)
            && fore.dot(&forward) < 0.0
        {
            forward = -forward;
        }
        let (forward, other) = (to_file(forward), to_file(-forward));
        let up = if up == options.up.unwrap_or(Z) { String::new() } else { format!(" --up {up}") };
        let what = format!(
            "most joints of the legs turn about {}, as if that were sideways: is the robot turned?",
            to_file(lateral)
        );
        let remedy = format!(
            "say which axis of this link is forward: --forward {forward}{up} (or --forward {other}{up}); --forward x if it is right as it is"
        );
        faults.add(Kind::Axes, Some(place), what, remedy);
    } else if let Some(fore) = fore_minus_hind(model, limbs)
        && fore.x < 0.0
    {
        let what = "legs called fore or front are behind those called hind or rear";
        faults.add(
            Kind::Axes,
            Some(place),
            what,
            "if it faces backward: --forward -x; if it is right as it is: --forward x",
        );
    }
}

/// Asks which way is up where gravity or the legs say something else; true if it does.
fn ask_up(
    model: &Model,
    limbs: &Limbs,
    taken: &UnitQuaternion<f64>,
    down: &Vector3<f64>,
    options: &Options,
    faults: &mut Faults,
) -> bool {
    let place = &model.links[limbs.tree.bodies[0].link].place;
    let upright = Direction::of(&(taken.inverse() * Vector3::y()));
    let [below, above] = [0, 1].map(|side| limbs.reach.iter().map(|reach| reach[side]).sum::<f64>());
    let told = model.up.filter(|up| nearest_axis(up).2 < OBLIQUE).map(|up| Direction::of(&up));
    let (up, what) = match told.filter(|up| *up != upright) {
        Some(up) => (up, format!("gravity points along {} of this link", up.reversed())),
        None if told.is_none() && down.y > UPWARD * down.norm() && above > 1.0 / UPWARD * below => {
            (upright.reversed(), "the legs point up, all joints at zero".to_string())
        }
        None => return false,
    };
    let forward = options.forward.unwrap_or(X);
    let forward = if forward.axis == up.axis { Z } else { forward };
    let remedy = format!("if {up} of it is up: --forward {forward} --up {up}; if it is right as it is: --up {upright}");
    faults.add(Kind::Axes, Some(place), format!("{what}: is the robot turned?"), remedy);
    true
}

/// The coordinate direction nearest to this one.
fn nearest(v: &Vector3<f64>) -> Vector3<f64> {
    let (axis, sign, _) = nearest_axis(v);
    let mut nearest = Vector3::zeros();
    nearest[axis] = sign;
    nearest
}

/// From the middle of the hind legs to that of the fore legs, by their names.
fn fore_minus_hind(model: &Model, limbs: &Limbs) -> Option<Vector3<f64>> {
    let bodies = &limbs.tree.bodies;
    let (mut fore, mut hind) = (Vec::new(), Vec::new());
    for chain in &limbs.chains {
        let joint = bodies[chain[0]].joint.as_ref()?.joint;
        let name = model.joints[joint].name.to_lowercase();
        let begins = |words: &[&str]| words.iter().any(|w| name.starts_with(w));
        let contains = |words: &[&str]| words.iter().any(|w| name.contains(w));
        let is_fore = contains(&["front", "fore"]) || begins(&["fl_", "fr_", "lf_", "rf_"]);
        let is_hind = contains(&["hind", "rear", "back"]) || begins(&["hl_", "hr_", "lh_", "rh_", "rl_", "rr_"]);
        match (is_fore, is_hind) {
            (true, false) => fore.push(bodies[chain[0]].origin),
            (false, true) => hind.push(bodies[chain[0]].origin),
            _ => {}
        }
    }
    let mean = |of: &[Vector3<f64>]| of.iter().sum::<Vector3<f64>>() / of.len() as f64;
    (!fore.is_empty() && !hind.is_empty()).then(|| mean(&fore) - mean(&hind))
}
