//! Whether the two half steps of a gait can mirror each other, so that one of them defines the gait: the
//! virtual legs must be of the same build and their hips mirror images.

use super::Code;
use super::diagnostic::{Label, Sink, Span};
use super::format::DIRECTIONS;
use super::gait::RawGait;
use super::pairing::{SAME, joints, place};
use super::robot::{LegPlaces, RobotFile};
use super::types::{Axis, HalfSteps, Leg, Rotation};

/// Mirrored half steps: the virtual legs are of the same build, and their hips are mirror images.
pub(super) fn check(raw: &RawGait, legs: &[Vec<usize>; 2], robot: &RobotFile, sink: &mut Sink) {
    let (Some(half_steps), Some(rotation)) = (&raw.half_steps, &raw.rotation) else {
        return;
    };
    if half_steps.value != HalfSteps::Mirrored {
        return;
    }
    let all = &robot.robot.legs;
    let ([first, ..], [second, ..]) = (&legs[0][..], &legs[1][..]) else {
        return;
    };
    let mut report = |why: String, label: Label| {
        let title = format!("the half steps cannot mirror each other: {why}");
        let help = "write half_steps = \"distinct\", choose other virtual legs, or correct their mounts";
        sink.report(Code::NotMirrored, title, &half_steps.span, "the virtual legs exchange their roles", help);
        sink.beside(label);
    };
    let here = |text: &str| place(robot, *second, |p| &p.mount, text);
    if joints(&all[*first]) != joints(&all[*second]) {
        return report(
            "the virtual legs have different joints".into(),
            place(robot, *second, |p| &p.name, "a leg of virtual leg 2"),
        );
    }
    if legs[0].len() != legs[1].len() {
        let why = format!("{} and {} legs make up the virtual legs", legs[0].len(), legs[1].len());
        return report(why, here("a leg of virtual leg 2"));
    }
    let [a, b] = [&legs[0], &legs[1]].map(|legs| hip(legs, robot));
    // What an exchange of the legs does to a hip: nothing, or a reflection in the sagittal plane.
    let apart = match rotation.value {
        Rotation::None | Rotation::Pitch => (0..2).find(|&k| (a[k] - b[k]).abs() > SAME),
        Rotation::Roll => (0..3).find(|&k| (if k == 2 { a[k] + b[k] } else { a[k] - b[k] }).abs() > SAME),
    };
    if let Some(k) = apart {
        let where_to = DIRECTIONS[k];
        let why = format!(
            "the hips of the virtual legs are at {where_to} = {:.4} and {where_to} = {:.4} from the mass centre",
            a[k], b[k]
        );
        return report(why, here("a mount of virtual leg 2"));
    }
    if rotation.value == Rotation::Roll {
        mirror_in_itself(&all[*second], &robot.places[*second], robot, report);
    }
}

/// Where the platform rolls, the virtual legs are mirror images although they share their links and
/// joints: so a leg must be its own mirror image.
fn mirror_in_itself(leg: &Leg, places: &LegPlaces, robot: &RobotFile, mut report: impl FnMut(String, Label)) {
    for (segment, axis) in leg.chain.iter().zip(&places.axes) {
        let label = |span: &Span, text: &str| Label {
            source: robot.source.clone(),
            span: span.clone(),
            text: text.to_string(),
        };
        if segment.joint.axis != Axis::Pitch {
            let why = format!("joint `{}` would have to turn the other way", segment.joint.name);
            return report(why, label(axis, "swings the leg sideways"));
        }
        if segment.link.com[2].abs() > SAME {
            let why = format!("the mass centre of `{}` lies beside the leg's plane", segment.link.name);
            return report(why, label(&places.mount, "has this link on the same side of the leg as its mirror image"));
        }
    }
}

/// Mean mount of the legs, from the platform's mass centre, m.
fn hip(legs: &[usize], robot: &RobotFile) -> [f64; 3] {
    let com = robot.robot.platform.com;
    [0, 1, 2].map(|k| {
        let sum: f64 = legs.iter().map(|&leg| robot.robot.legs[leg].mount[k] - com[k]).sum();
        sum / legs.len() as f64
    })
}
