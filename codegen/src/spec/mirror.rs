//! Whether the two halves of a cycle can mirror each other, so that one of them defines the gait: where
//! the virtual legs exchange their roles, one must be for the other what it is itself, or its mirror image.

use super::Code;
use super::as_one::Unlike;
use super::diagnostic::Sink;
use super::format::DIRECTIONS;
use super::gait::RawGait;
use super::pairing::{self, place};
use super::phases::Written;
use super::robot::RobotFile;
use super::types::Then;

/// Mirrored halves: the virtual legs are alike and their hips at the same place; where the platform
/// rolls, they are mirror images.
pub(super) fn check(raw: &RawGait, legs: &[Vec<usize>; 2], robot: &RobotFile, sink: &mut Sink) {
    let (Some(then), Some(rotation)) = (&raw.then, &raw.rotation) else {
        return;
    };
    let (Some(&second), Then::Mirrored) = (legs[1].first(), then.value) else {
        return;
    };
    let mut mounts = "their mounts".to_string();
    let (why, label) = match robot.robot.exchange(legs, rotation.value) {
        None => return,
        Some(Unlike::Link(why)) => (why, place(robot, second, |p| &p.name, "a leg of virtual leg 2")),
        Some(Unlike::Mount(k)) => {
            let [a, b] = [0, 1].map(|leg| robot.robot.hip(&legs[leg])[k]);
            let at = DIRECTIONS[k];
            mounts += &format!(" ({})", pairing::mounts(legs.iter().flatten().map(|leg| &robot.robot.legs[*leg]), k));
            let why =
                format!("the hips of the virtual legs are at {at} = {a:.4} and {at} = {b:.4} from the mass centre");
            (why, place(robot, second, |p| &p.mount, "a mount of virtual leg 2"))
        }
    };
    let (halves, instead) = match raw.phases {
        Written::HalfSteps(_) => ("half steps", "half_steps = \"distinct\""),
        Written::List(_) => ("halves of the cycle", "then = \"repeat\", with phases on both legs"),
    };
    let title = format!("the {halves} cannot mirror each other: {why}");
    let help = format!("write {instead}, choose other virtual legs, or correct {mounts}");
    sink.report(Code::NotMirrored, title, &then.span, "the virtual legs exchange their roles", help);
    sink.beside(label);
}
