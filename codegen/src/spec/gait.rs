//! A gait file → [`Gait`]: the values of its tables. How they fit the robot is checked in `pairing.rs`, how
//! they fit each other in `coordinates.rs` and `phases.rs`.

use super::coordinates;
use super::decode::NameLists;
use super::diagnostic::{At, Diagnostic, Sink, Source};
use super::format;
use super::locked;
use super::mirror;
use super::name;
use super::pairing;
use super::phases::{self, Written};
use super::robot::RobotFile;
use super::syntax;
use super::types::{Gait, Limits, Rotation, Then};
use super::view::View;

/// Reads a gait and checks it against its robot.
///
/// `path` is what messages shall call the file, `text` its contents. Where the file gives no `name`, the
/// gait is called like the file: `trot.toml` is the trot.
///
/// # Errors
/// All mistakes that were found, at least one, in the order of the file. Their second labels may point into
/// the robot's file.
pub fn parse_gait(path: &str, text: &str, robot: &RobotFile) -> Result<Gait, Vec<Diagnostic>> {
    let source = Source::new(path, text);
    let mut sink = Sink::new(source.clone());
    let gait = read(path, source.text(), Some(robot), &mut sink);
    match gait {
        Some(gait) if sink.is_empty() => Ok(gait),
        _ => Err(sink.into_sorted()),
    }
}

/// What is wrong with a gait's file whatever its robot is.
pub fn gait_mistakes(path: &str, text: &str) -> Vec<Diagnostic> {
    let source = Source::new(path, text);
    let mut sink = Sink::new(source.clone());
    let _ = read(path, source.text(), None, &mut sink);
    sink.into_sorted()
}

/// A gait as written, each part with its place.
pub(super) struct RawGait {
    pub virtual_legs: Option<NameLists>,
    pub moves: Option<At<Vec<usize>>>,
    pub rotation: Option<At<Rotation>>,
    pub unactuated: Option<At<String>>,
    pub phases: Written,
    pub then: Option<At<Then>>,
}

/// Without a robot there is no gait, but mistakes in the file are told.
fn read(path: &str, text: &str, robot: Option<&RobotFile>, sink: &mut Sink) -> Option<Gait> {
    let root = syntax::document(text, sink)?;
    let root = View::of_file(&root, &format::GAIT, sink);
    let name = name::of_gait(path, &root, sink);
    let (platform, limits) = (root.table("platform", sink), root.table("limits", sink));
    let (phases, then) = phases::read(&root, limits.as_ref(), sink);
    let raw = RawGait {
        virtual_legs: root.name_lists("virtual_legs", sink),
        moves: platform.as_ref().and_then(|p| p.choices("moves", sink)),
        rotation: platform
            .as_ref()
            .and_then(|p| p.choice("rotates", [Rotation::None, Rotation::Pitch, Rotation::Roll], sink)),
        unactuated: coordinates::single(&root, sink),
        phases,
        then,
    };
    let polynomial_order = match root.has("polynomial_order") {
        true => root.order("polynomial_order", sink).and_then(|order| usize::try_from(order.value).ok()),
        false => Some(4),
    };
    let limits = limits.and_then(|view| read_limits(&view, sink));
    let phases = phases::phases(&raw, &root.key_span("phases"), sink);

    let locked = if root.has("locked") { root.angles("locked", sink) } else { Some(Vec::new()) };
    let moves = coordinates::check_moves(&raw, sink);
    // From here on the robot is one without its locked joints.
    let robot = &locked::with_locked(locked.as_deref()?, robot?, sink)?;
    let virtual_legs = pairing::virtual_legs(&raw, &root.key_span("virtual_legs"), robot, sink);
    let unactuated = coordinates::unactuated(&raw, virtual_legs.as_ref(), robot, sink);
    if let Some(legs) = &virtual_legs {
        coordinates::check_plane(&raw, robot, sink);
        mirror::check(&raw, legs, robot, sink);
    }
    moves?;
    Some(Gait {
        name: name?,
        virtual_legs: virtual_legs?,
        locked: locked?.into_iter().map(|(name, angle)| (name.value, angle)).collect(),
        rotation: raw.rotation?.value,
        unactuated: unactuated?,
        phases: phases?,
        polynomial_order: polynomial_order?,
        limits: limits?,
    })
}

fn read_limits(view: &View<'_>, sink: &mut Sink) -> Option<Limits> {
    let friction = view.number("friction", sink);
    let min_vertical_force = view.number("min_vertical_force", sink);
    let swing_clearance = view.number("swing_clearance", sink);
    let min_platform_height = match view.has("min_platform_height") {
        true => view.number("min_platform_height", sink).map(|height| height.value),
        false => Some(0.0),
    };
    let body_clearance = match view.has("body_clearance") {
        true => view.number("body_clearance", sink).map(|height| height.value),
        false => Some(0.0),
    };
    Some(Limits {
        friction: friction?.value,
        min_vertical_force: min_vertical_force?.value,
        swing_clearance: swing_clearance?.value,
        min_platform_height: min_platform_height?,
        body_clearance: body_clearance?,
    })
}
