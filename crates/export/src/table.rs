//! A walk as CSV: a row per moment, a column per number, SI units.

use piaffe_model::{Description, Rotation};
use piaffe_optimizer::walk::{Moment, Walk};

/// Names of the coordinates q: the joints, then the platform's rotation.
pub fn coordinates(d: &Description) -> Vec<String> {
    let mut names: Vec<String> = d.joints.iter().map(|j| j.name.into()).collect();
    match d.rotation {
        Rotation::None => {}
        Rotation::Pitch => names.push("pitch".into()),
        Rotation::Roll => names.push("roll".into()),
    }
    names
}

/// The real joints: the coordinate that each follows, and its name, which every export of the robot has.
pub fn real_joints(d: &Description) -> impl Iterator<Item = (usize, &'static str)> + '_ {
    let members = d.legs.iter().flat_map(|leg| leg.members.iter().map(move |member| (leg, member)));
    members.flat_map(|(leg, member)| (leg.first_joint..).zip(member.joints.iter().copied()))
}

/// The real legs: virtual leg, member, name.
pub fn legs(d: &Description) -> impl Iterator<Item = (usize, usize, &'static str)> + '_ {
    let of = |leg: usize| d.legs[leg].members.iter().enumerate().map(move |(k, m)| (leg, k, m.name));
    (0..2).flat_map(of)
}

fn header(d: &Description) -> Vec<String> {
    let mut names: Vec<String> = ["t", "phase", "stance"].map(str::to_string).to_vec();
    for of in ["", "d", "dd"] {
        names.extend(["x", "y", "z"].map(|axis| format!("{axis}{of}")));
    }
    for of in ["q", "qd", "qdd"] {
        names.extend(coordinates(d).iter().map(|name| format!("{of}_{name}")));
    }
    names.extend(d.joints.iter().map(|j| format!("torque_{}", j.name)));
    names.extend(["x", "y", "z"].map(|axis| format!("force_{axis}")));
    names.extend(legs(d).flat_map(|(_, _, name)| ["x", "y", "z"].map(|axis| format!("foot_{name}_{axis}"))));
    names
}

fn row(d: &Description, m: &Moment) -> Vec<f64> {
    let mut row = vec![m.time, (m.phase + 1) as f64, m.mode.stance().map_or(0.0, |leg| (leg + 1) as f64)];
    row.extend(m.platform.concat());
    row.extend([&m.q[..], &m.qd, &m.qdd, &m.torque, &m.force].concat());
    row.extend(legs(d).flat_map(|(leg, member, _)| m.chain(d, leg, member).pop().unwrap_or_default()));
    row
}

/// The platform's mass centre (x, y, z; with d its velocity, with dd its acceleration), the coordinates with rates
/// and accelerations, the torques of the virtual legs' joints, the reaction on the virtual leg in support
/// (`stance`: 1 or 2, in flight 0), and the real feet. Angles in rad.
pub fn csv(walk: &Walk) -> String {
    let d = walk.description;
    let mut text = header(d).join(",");
    for m in &walk.moments {
        text.push('\n');
        text += &row(d, m).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    }
    text.push('\n');
    text
}
