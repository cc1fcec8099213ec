//! `robot.toml` → [`RobotFile`]: the values of each table. How the tables hang together is `chain.rs`.

use super::bodies::{actuator, link, platform};
use super::chain::{self, Parts};
use super::code::Code;
use super::diagnostic::{At, Diagnostic, Label, Sink, Source, Span};
use super::format;
use super::keys::Table;
use super::name;
use super::set::numbers;
use super::syntax;
use super::types::{Axis, Friction, Link, Platform, Robot, Spring};
use super::view::View;
use std::sync::Arc;

/// A validated robot, and where its parts stand in its file, so that a gait that contradicts it can point there.
#[derive(Clone, Debug)]
pub struct RobotFile {
    pub robot: Robot,
    pub(super) source: Source,
    /// One for each of the robot's legs.
    pub(super) places: Vec<LegPlaces>,
    pub(super) axes: Axes,
}

/// Where each joint states its axis, or is named.
type Axes = Vec<(String, Span)>;

/// Where a leg's parts stand in the file.
#[derive(Clone, Debug)]
pub(super) struct LegPlaces {
    pub name: Span,
    pub mount: Span,
}

impl RobotFile {
    /// The file that it was read from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// A label where a joint states its axis.
    pub(super) fn axis_label(&self, joint: &str, text: String) -> Label {
        let span = self.axes.iter().find(|(name, _)| name == joint).map_or(0..0, |(_, span)| span.clone());
        Label { source: self.source.clone(), span, text }
    }
}

/// Reads a robot's description.
///
/// `path` is what messages shall call the file, `text` its contents.
///
/// # Errors
/// All mistakes that were found, at least one, in the order of the file.
pub fn parse_robot(path: &str, text: &str) -> Result<RobotFile, Vec<Diagnostic>> {
    let source = Source::new(path, text);
    let mut sink = Sink::new(source.clone());
    let read = read(source.text(), &mut sink);
    match read {
        Some((robot, places, axes)) if sink.is_empty() => Ok(RobotFile { robot, source, places, axes }),
        _ => Err(sink.into_sorted()),
    }
}

fn read(text: &str, sink: &mut Sink) -> Option<(Robot, Vec<LegPlaces>, Axes)> {
    let root = syntax::document(text, sink)?;
    let root = View::of_file(&root, &format::ROBOT, sink);
    let name = name::of_robot(&root, sink);
    let gravity = root.number("gravity", sink);
    let parts = parts(&root, sink);
    let axes = parts.joints.iter().map(|j| (j.name.value.clone(), j.axis.span.clone())).collect();
    let (platform, legs, places) = chain::assemble(parts, sink)?;
    let written = Arc::new(numbers(text).into_iter().map(|number| number.name).collect());
    Some((Robot { name: name?, gravity: gravity?.value, platform, legs, written }, places, axes))
}

/// All named tables; `None` stands for one with mistakes, so that references to it still resolve.
fn parts(root: &View<'_>, sink: &mut Sink) -> Parts {
    let joints = root.map("joints", sink, |_, _| &format::JOINT);
    let joints = each(joints, |name, view| RawJoint::read(name, view, sink));
    let links = links(root, joints.as_deref().unwrap_or_default(), sink);
    let legs = root.map("legs", sink, |_, _| &format::LEG);
    let legs = each(legs, |name, view| RawLeg::read(name, view, sink));
    let actuators = root.map("actuators", sink, |_, _| &format::ACTUATOR);
    let actuators = each(actuators, |name, view| {
        let value = view.and_then(|v| actuator(&name.value, &v, sink));
        (name, value)
    });
    Parts {
        whole: links.is_some() && joints.is_some() && legs.is_some() && actuators.is_some(),
        links: links.unwrap_or_default(),
        joints: joints.unwrap_or_default(),
        legs: legs.unwrap_or_default(),
        actuators: actuators.unwrap_or_default(),
        joints_at: root.key_span("joints"),
        legs_at: root.key_span("legs"),
    }
}

type Views<'t> = Vec<(At<String>, Option<View<'t>>)>;

fn each<'t, T>(views: Option<Views<'t>>, mut read: impl FnMut(At<String>, Option<View<'t>>) -> T) -> Option<Vec<T>> {
    Some(views?.into_iter().map(|(name, view)| read(name, view)).collect())
}

/// A joint as written; what could not be read is `None`.
pub(super) struct RawJoint {
    pub name: At<String>,
    pub parent: Option<At<String>>,
    pub child: Option<At<String>>,
    pub axis: At<Axis>,
    pub range: Option<[f64; 2]>,
    pub spring: Option<Spring>,
    pub friction: Option<Friction>,
    pub actuator: Option<At<String>>,
}

/// A spring that pulls says where it rests; one that is said to rest somewhere need not pull.
fn spring(view: &View<'_>, sink: &mut Sink) -> Option<Spring> {
    let mut number = |key| if view.has(key) { view.number(key, sink).map(|x| x.value) } else { Some(0.0) };
    let (stiffness, rest) = (number("stiffness"), number("rest_angle"));
    if view.has("stiffness") && !view.has("rest_angle") {
        let title = format!("`{}` without `rest_angle`", view.join("stiffness"));
        let help = "write rest_angle = the joint's angle at which the spring does nothing, in rad";
        sink.report(Code::MissingKey, title, &view.key_span("stiffness"), "a spring rests somewhere", help);
        return None;
    }
    Some(Spring { stiffness: stiffness?, rest: rest? })
}

impl RawJoint {
    fn read(name: At<String>, view: Option<View<'_>>, sink: &mut Sink) -> Self {
        let mut joint = Self {
            axis: At { value: Axis::Pitch, span: name.span.clone() },
            name,
            parent: None,
            child: None,
            range: None,
            spring: None,
            friction: None,
            actuator: None,
        };
        let Some(view) = view else { return joint };
        joint.parent = view.text("parent", sink);
        joint.child = view.text("child", sink);
        if let Some(axis) = view.choice("axis", [Axis::Roll, Axis::Yaw, Axis::Pitch], sink) {
            joint.axis = axis;
        }
        joint.range = view.pair("range", sink).map(|range| range.value);
        joint.spring = spring(&view, sink);
        let mut friction = |key| if view.has(key) { view.number(key, sink).map(|x| x.value) } else { Some(0.0) };
        let (damping, coulomb) = (friction("damping"), friction("coulomb"));
        joint.friction = damping.zip(coulomb).map(|(damping, coulomb)| Friction { damping, coulomb });
        joint.actuator = view.text("actuator", sink);
        joint
    }
}

/// A leg as written.
pub(super) struct RawLeg {
    pub name: At<String>,
    pub mount: Option<At<[f64; 3]>>,
    pub first_joint: Option<At<String>>,
}

impl RawLeg {
    fn read(name: At<String>, view: Option<View<'_>>, sink: &mut Sink) -> Self {
        let Some(view) = view else {
            return Self { name, mount: None, first_joint: None };
        };
        let mount = view.vector("mount", sink);
        let first_joint = view.text("first_joint", sink);
        Self { name, mount, first_joint }
    }
}

/// A link as written: the platform has other keys than the links of legs.
pub(super) enum Body {
    /// With the place where its extent is named.
    Platform(Platform, Span),
    Link(Link),
}

/// Reads the links. One that no joint has as its child is the platform, unless it has a length and another
/// one fits better: then a joint's `child` is misspelt, and that is reported where it stands.
fn links(root: &View<'_>, joints: &[RawJoint], sink: &mut Sink) -> Option<Vec<(At<String>, Option<Body>)>> {
    let is_child = |name: &str| joints.iter().any(|j| j.child.as_ref().is_some_and(|c| c.value == name));
    let lengths = root.peek("links", "length");
    let platform_elsewhere =
        |name: &str| lengths.iter().any(|(other, has_length)| other != name && !has_length && !is_child(other));
    let form = |name: &str, has_length: bool| -> &'static Table {
        if is_child(name) || (has_length && platform_elsewhere(name)) { &format::LINK } else { &format::PLATFORM }
    };
    let views = root.map("links", sink, |name, entries| form(name, entries.contains_key("length")));
    each(views, |name, view| {
        let body = view.and_then(|view| match view.is(&format::LINK) {
            true => link(&name.value, &view, sink).map(Body::Link),
            false => platform(&name.value, &view, sink).map(|read| Body::Platform(read, view.key_span("extent"))),
        });
        (name, body)
    })
}
