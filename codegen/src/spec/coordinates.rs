//! The coordinates of a gait: directions in which the platform moves, its one rotation, and the one
//! coordinate β that no actuator drives (§2.2 to §2.4).
//!
//! A leg touches the ground with a point, so the robot has one actuator less than it has degrees of freedom:
//! β is the platform's rotation where it has one; else it is the joint of a leg that hangs on the platform.

use super::Code;
use super::diagnostic::{At, Sink};
use super::gait::RawGait;
use super::nearest::nearest;
use super::pairing::joints;
use super::robot::RobotFile;
use super::types::{Axis, Rotation, Unactuated};
use super::view::View;

/// The one name under `unactuated`; a list there names more or less than one.
pub(super) fn single(root: &View<'_>, sink: &mut Sink) -> Option<At<String>> {
    match root.list_length("unactuated") {
        Some((length, span)) => {
            let title = format!("a gait has exactly one unactuated coordinate, not {length}");
            let help = "write unactuated = \"platform\", or \"leg1.<joint>\" where the platform does not rotate";
            sink.report(Code::NotOneUnactuated, title, &span, "expected one name", help);
            None
        }
        None => root.text("unactuated", sink),
    }
}

/// The directions in which the platform moves go with its rotation.
pub(super) fn check_moves(raw: &RawGait, sink: &mut Sink) -> Option<()> {
    let moves = raw.moves.as_ref()?;
    let rotation = raw.rotation.as_ref()?;
    let spatial = rotation.value.is_spatial();
    let wanted: &[usize] = if spatial { &[0, 1, 2] } else { &[0, 1] };
    let mut given = moves.value.clone();
    given.sort_unstable();
    if given == wanted {
        return Some(());
    }
    let (title, help) = if spatial {
        ("a platform that rolls moves in x, y and z", "write moves = [\"x\", \"y\", \"z\"], or rotates = \"pitch\"")
    } else {
        ("a platform that does not roll moves in x and y", "write moves = [\"x\", \"y\"], or rotates = \"roll\"")
    };
    sink.report(Code::WrongMoves, title, &moves.span, "these directions do not go with the rotation", help);
    sink.beside(sink.label(&rotation.span, "the rotation"));
    None
}

/// Resolves β.
pub(super) fn unactuated(
    raw: &RawGait,
    legs: Option<&[Vec<usize>; 2]>,
    robot: &RobotFile,
    sink: &mut Sink,
) -> Option<Unactuated> {
    let name = raw.unactuated.as_ref()?;
    let rotation = raw.rotation.as_ref();
    let word = rotation.map_or("none", |r| match r.value {
        Rotation::None => "none",
        Rotation::Pitch => "pitch",
        Rotation::Roll => "roll",
    });
    let rotates = rotation.map(|r| r.value != Rotation::None);
    if name.value == "platform" {
        if rotates == Some(false) {
            let title = "no unactuated coordinate: the platform does not rotate";
            let help = "write unactuated = \"leg1.<joint>\" with the joint that hangs on the platform, or let the platform rotate";
            sink.report(Code::NotOneUnactuated, title, &name.span, "the platform has no such coordinate", help);
            sink.beside(sink.label(&rotation?.span, "it stays level"));
            return None;
        }
        return rotates.map(|_| Unactuated::Platform);
    }
    let Some((leg, joint)) = split(&name.value) else {
        let title = format!("there is no coordinate `{}`", name.value);
        let help = match nearest(&name.value, ["platform"]) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => {
                "write \"platform\", or \"leg1.<joint>\" or \"leg2.<joint>\" where the platform does not rotate".into()
            }
        };
        sink.report(Code::UnknownName, title, &name.span, "expected platform, leg1.<joint> or leg2.<joint>", help);
        return None;
    };
    let joint = resolve_joint(name, leg, joint, legs?, robot, sink)?;
    if rotates? {
        let title = format!("two unactuated coordinates: the platform's {word} and `{}`", name.value);
        let help =
            format!("write unactuated = \"platform\", or rotates = \"none\" to make `{}` the only one", name.value);
        sink.report(Code::NotOneUnactuated, title, &name.span, "the second one", help);
        sink.beside(sink.label(&rotation?.span, "no actuator turns the platform: the first one"));
        return None;
    }
    Some(Unactuated::Joint { leg, joint })
}

/// `leg1.haunch` → (0, `haunch`).
fn split(name: &str) -> Option<(usize, &str)> {
    let (leg, joint) = name.split_once('.')?;
    match leg {
        "leg1" => Some((0, joint)),
        "leg2" => Some((1, joint)),
        _ => None,
    }
}

/// The joint's place in its leg's chain; it must be the first.
fn resolve_joint(
    name: &At<String>,
    leg: usize,
    joint: &str,
    legs: &[Vec<usize>; 2],
    robot: &RobotFile,
    sink: &mut Sink,
) -> Option<usize> {
    let real = robot.robot.legs.get(*legs[leg].first()?)?;
    let chain = joints(real);
    let first = chain.first()?;
    match chain.iter().position(|j| *j == joint) {
        Some(0) => Some(0),
        Some(_) => {
            let title = format!("`{}` cannot be unactuated: it does not hang on the platform", name.value);
            let help = format!("write unactuated = \"leg{}.{first}\"", leg + 1);
            sink.report(Code::NotOneUnactuated, title, &name.span, "expected the leg's first joint", help);
            None
        }
        None => {
            let title = format!("leg {} has no joint `{joint}`", leg + 1);
            let help = match nearest(joint, chain.iter().copied()) {
                Some(near) => format!("did you mean \"leg{}.{near}\"?", leg + 1),
                None => format!("its joints are {}: write \"leg{}.{first}\"", chain.join(", "), leg + 1),
            };
            sink.report(Code::UnknownName, title, &name.span, "no such joint", help);
            None
        }
    }
}

/// A gait without roll stays in its plane only if all joints turn about the pitch axis.
pub(super) fn check_plane(raw: &RawGait, robot: &RobotFile, sink: &mut Sink) {
    let Some(rotation) = &raw.rotation else {
        return;
    };
    if rotation.value == Rotation::Roll {
        return;
    }
    let mut told: Vec<&str> = Vec::new();
    for joint in robot.robot.legs.iter().flat_map(|leg| &leg.chain).map(|segment| &segment.joint) {
        if joint.axis == Axis::Pitch || told.contains(&joint.name.as_str()) {
            continue;
        }
        told.push(&joint.name);
        let title = format!("joint `{}` leaves the plane of this gait", joint.name);
        let help = format!(
            "hold it still: locked = {{ {} = 0.0 }}; or let the platform roll: moves = [\"x\", \"y\", \"z\"], rotates = \"roll\"",
            joint.name
        );
        sink.report(Code::OutOfPlane, title, &rotation.span, "a gait in the sagittal plane", help);
        sink.beside(robot.axis_label(&joint.name, format!("`{}` does not turn about the pitch axis", joint.name)));
    }
}
