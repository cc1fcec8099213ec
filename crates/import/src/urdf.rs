//! URDF → [`Model`]. Only the parts that matter are read; what else is in a file cannot refuse it.

use super::fault::{Faults, Kind, Place};
use super::model::{Format, Friction, Joint, Kind as JointKind, Link, Mass, Model, Rotor, Shape, Solid, Spring};
use super::words::{point_masses, short_list};
use super::xml::{File, child, children, name as xml_name, plain};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use piaffe_model::digits::digits;
use roxmltree::Node;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// Angles this close to a right one were rounded by a person (1.57, 3.14), rad: twice what 3.14 leaves out, less than 0.1°
/// of a mount that is meant.
const RIGHT: f64 = 2e-3;

pub fn read(file: &File, faults: &mut Faults) -> Option<Model> {
    let root = file.root();
    if let Some(macros) = root.descendants().find(|n| is_xacro(n)) {
        let place = file.place(macros);
        let remedy =
            "convert it first: `xacro FILE > robot.urdf` (ROS, or `pip install xacro`), then import robot.urdf";
        faults.add(Kind::Format, Some(&place), "this is xacro, of which URDF is made", remedy);
        return None;
    }
    let mut reader = Reader { file, faults, rounded: 0.0, rounds: 0, points: Vec::new() };
    let mut links = Vec::new();
    let mut named: BTreeMap<String, usize> = BTreeMap::new();
    for node in children(root, "link") {
        let link = reader.link(node);
        if let Some(first) = named.insert(link.name.clone(), links.len()) {
            let first: &Link = &links[first];
            let what = format!("another link has this name already (line {})", first.place.line);
            reader.faults.add(Kind::NotATree, Some(&link.place), what, "give it a name of its own");
        }
        links.push(link);
    }
    let mut joints: Vec<Joint> = Vec::new();
    let mut jointed: BTreeMap<String, usize> = BTreeMap::new();
    for node in children(root, "joint") {
        let Some(joint) = reader.joint(node, &named) else { continue };
        if let Some(line) = jointed.insert(joint.name.clone(), joint.place.line) {
            let what = format!("another joint has this name already (line {line})");
            reader.faults.add(Kind::NotATree, Some(&joint.place), what, "give it a name of its own");
        }
        joints.push(joint);
    }
    for node in children(root, "loop_joint") {
        let place = file.place(node);
        let remedy = "take a file in which each leg is one chain: a linkage cannot be described";
        reader.faults.add(Kind::Loop, Some(&place), "links that hang on each other in a loop", remedy);
    }
    for node in children(root, "transmission") {
        reader.transmission(node, &mut joints);
    }
    let mut notes = Vec::new();
    if reader.rounds > 0 {
        notes.push(format!(
            "{} angles of the file are right angles rounded by up to {:.1e} rad (3.14, 1.57): they are taken to be right ones",
            reader.rounds, reader.rounded
        ));
    }
    if !reader.points.is_empty() {
        notes.push(point_masses(&short_list(&reader.points)));
    }
    let name = root.attribute("name").map(plain).unwrap_or_default();
    Some(Model { name, format: Format::Urdf, links, joints, gravity: None, up: None, notes })
}

/// An element of the namespace of xacro, or one with what xacro replaces.
fn is_xacro(node: &Node) -> bool {
    let namespace = node.tag_name().namespace().unwrap_or_default();
    let prefixed = !namespace.is_empty() && node.lookup_prefix(namespace) == Some("xacro");
    prefixed || node.attributes().any(|a| a.value().contains("${"))
}

struct Reader<'r, 'f, 't> {
    file: &'r File<'t>,
    faults: &'f mut Faults,
    /// The greatest change of an angle that was made a right one, and how many there are.
    rounded: f64,
    rounds: usize,
    /// Links with a mass and no inertia.
    points: Vec<String>,
}

impl Reader<'_, '_, '_> {
    fn name(&mut self, node: Node, place: &Place) -> String {
        let name = node.attribute("name").map(xml_name).unwrap_or_default();
        if name.is_empty() {
            self.faults.add(Kind::Missing, Some(place), "it has no name", "write name=\"…\"");
        }
        name
    }

    fn link(&mut self, node: Node) -> Link {
        let place = self.file.place(node);
        let name = self.name(node, &place);
        let masses = child(node, "inertial").and_then(|inertial| self.mass(inertial, &name)).into_iter().collect();
        let shapes_of = |of: &'static str| children(node, of).collect::<Vec<_>>();
        let mut solid = shapes_of("collision");
        if solid.is_empty() {
            solid = shapes_of("visual");
        }
        let shapes = solid.into_iter().filter_map(|node| self.shape(node)).collect();
        Link { name, place, masses, shapes }
    }

    fn mass(&mut self, node: Node, name: &str) -> Option<Mass> {
        let place = self.place_of_parent(node);
        let frame = self.origin(node);
        let mass = child(node, "mass").and_then(|m| self.file.number(m, "value", self.faults));
        let entries = child(node, "inertia").map(|inertia| {
            ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"].map(|key| match inertia.attribute(key) {
                None if ["ixx", "iyy", "izz"].contains(&key) => {
                    let remedy = format!("write {key}=\"…\" in kg·m²");
                    self.faults.add(Kind::Inertia, Some(&place), format!("its inertia has no {key}"), remedy);
                    f64::NAN
                }
                None => 0.0,
                Some(_) => self.file.number(inertia, key, self.faults).unwrap_or(f64::NAN),
            })
        });
        let mass = mass.unwrap_or(if child(node, "mass").is_some() { f64::NAN } else { 0.0 });
        if entries.is_none() && mass > 0.0 {
            self.points.push(format!("`{name}`"));
        }
        let [xx, yy, zz, xy, xz, yz] = entries.unwrap_or_default();
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        if mass < 0.0 {
            self.faults.add(Kind::Inertia, Some(&place), format!("its mass is {} kg", digits(mass)), "remove the sign");
        }
        Some(Mass { mass, frame, inertia }).filter(|m| m.mass.is_finite() && m.inertia.iter().all(|x| x.is_finite()))
    }

    fn place_of_parent(&self, node: Node) -> Place {
        self.file.place(node.parent_element().unwrap_or(node))
    }

    /// The shape of a geometry that can be rolled or stood on; meshes say nothing here.
    fn shape(&mut self, node: Node) -> Option<Shape> {
        let frame = self.origin(node);
        let geometry = child(node, "geometry")?;
        let node = geometry.children().find(|n| n.is_element())?;
        let number = |attribute: &str| node.attribute(attribute)?.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let round = || Some((number("radius")?, number("length").unwrap_or_default() / 2.0));
        let solid = match node.tag_name().name() {
            "sphere" => round().map(|(radius, _)| Solid::Sphere { radius })?,
            "cylinder" => round().map(|(radius, half)| Solid::Cylinder { radius, half })?,
            "capsule" => round().map(|(radius, half)| Solid::Capsule { radius, half })?,
            "box" => {
                let size: Vec<f64> = node
                    .attribute("size")?
                    .split_whitespace()
                    .filter_map(|w| w.parse().ok())
                    .filter(|x: &f64| x.is_finite())
                    .collect();
                let [x, y, z] = size[..] else { return None };
                Solid::Box { half: [x / 2.0, y / 2.0, z / 2.0] }
            }
            _ => return None,
        };
        Some(Shape { frame, solid })
    }

    fn joint(&mut self, node: Node, links: &BTreeMap<String, usize>) -> Option<Joint> {
        let place = self.file.place(node);
        let name = self.name(node, &place);
        let ends = ["parent", "child"].map(|end| {
            let Some(link) = child(node, end).and_then(|n| n.attribute("link")) else {
                self.faults.add(Kind::Missing, Some(&place), format!("it has no <{end} link=\"…\"/>"), "name the link");
                return None;
            };
            let found = links.get(&xml_name(link)).copied();
            if found.is_none() {
                let near = super::words::nearest(link, links.keys().map(String::as_str));
                let remedy = near.map_or("name a link of the file".into(), |near| format!("did you mean `{near}`?"));
                let what = format!("its {end} is link `{}`, which does not exist", plain(link));
                self.faults.add(Kind::NotATree, Some(&place), what, remedy);
            }
            found
        });
        let kind = match node.attribute("type").unwrap_or_default() {
            _ if child(node, "mimic").is_some() => JointKind::Mimic,
            "fixed" => JointKind::Fixed,
            "revolute" => JointKind::Revolute,
            "continuous" => JointKind::Continuous,
            "floating" | "planar" => JointKind::Free,
            other => JointKind::Other(plain(other)),
        };
        let frame = self.origin(node);
        let axis = match child(node, "axis") {
            None => Vector3::x(),
            Some(axis) => self.file.numbers(axis, "xyz", self.faults).map_or(Vector3::x(), Vector3::from),
        };
        let slides = node.attribute("type") == Some("prismatic");
        let limit = child(node, "limit");
        let given = |key: &str, reader: &mut Self| {
            limit.and_then(|limit| reader.file.number(limit, key, reader.faults)).filter(|x| *x != 0.0)
        };
        let (effort, velocity) = (given("effort", self), given("velocity", self));
        let bounded = limit.filter(|l| l.has_attribute("lower") || l.has_attribute("upper"));
        let range = bounded.map(|limit| {
            ["lower", "upper"].map(|key| match limit.attribute(key) {
                None => 0.0,
                Some(_) => self.file.number(limit, key, self.faults).unwrap_or(f64::NAN),
            })
        });
        let friction = child(node, "dynamics").map(|dynamics| self.friction(dynamics)).unwrap_or_default();
        let [Some(parent), Some(child)] = ends else { return None };
        let range = range.filter(|r| r.iter().all(|x| !x.is_nan()));
        let offset = Vector3::zeros();
        Some(Joint {
            name,
            place,
            kind,
            slides,
            parent,
            child,
            frame,
            offset,
            axis,
            range,
            effort,
            velocity,
            gear: None,
            rotor: None,
            spring: Spring::default(),
            spring_is_derived: false,
            friction,
        })
    }

    fn friction(&mut self, dynamics: Node) -> Friction {
        let mut number = |key| self.file.number(dynamics, key, self.faults).unwrap_or_default();
        Friction { damping: number("damping"), coulomb: number("friction") }
    }

    /// A gear and a rotor, of the joint and its one actuator.
    fn transmission(&mut self, node: Node, joints: &mut [Joint]) {
        let all: Vec<Node> = children(node, "joint").collect();
        let [named] = all[..] else { return };
        let Some(joint) =
            named.attribute("name").map(xml_name).and_then(|name| joints.iter_mut().find(|j| j.name == name))
        else {
            return;
        };
        let within = |tag: &'static str| {
            let actuator = children(node, "actuator").find_map(|a| child(a, tag));
            let node = actuator.or(child(node, tag)).or(child(named, tag))?;
            Some((node, node.text().unwrap_or_default().trim()))
        };
        let mut read = |tag: &'static str| {
            let (node, text) = within(tag)?;
            let numbers = self.file.list(node, tag, text, self.faults)?;
            let [x] = numbers[..] else { return None };
            Some((x, self.file.place(node)))
        };
        let (gear, rotor) = (read("mechanicalReduction"), read("motorInertia"));
        if let Some((gear, place)) = gear {
            if gear.abs() > 0.0 && gear.is_finite() {
                joint.gear = Some(gear.abs());
            } else {
                let what = format!("a gear of {gear}");
                self.faults.add(Kind::Number, Some(&place), what, "write motor turns per joint turn");
            }
        }
        if let Some((rotor, place)) = rotor {
            if rotor >= 0.0 && rotor.is_finite() {
                joint.rotor = Some(Rotor::AtMotor(rotor));
            } else {
                let what = format!("a rotor's inertia of {rotor}");
                self.faults.add(Kind::Number, Some(&place), what, "write it in kg·m², 0 or more");
            }
        }
    }

    fn origin(&mut self, node: Node) -> Isometry3<f64> {
        let Some(origin) = child(node, "origin") else { return Isometry3::identity() };
        let place = self.file.numbers(origin, "xyz", self.faults).unwrap_or([0.0; 3]);
        let [roll, pitch, yaw] =
            self.file.numbers(origin, "rpy", self.faults).unwrap_or([0.0; 3]).map(|angle| self.right(angle));
        Isometry3::from_parts(Translation3::from(place), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }

    /// A right angle that a person rounded becomes a right angle.
    fn right(&mut self, angle: f64) -> f64 {
        let turns = (angle / FRAC_PI_2).round();
        let exact = turns * FRAC_PI_2;
        let change = (angle - exact).abs();
        if turns == 0.0 || change > RIGHT {
            return angle;
        }
        // Six digits and more are meant as they stand.
        if change > 1e-9 {
            self.rounds += 1;
            self.rounded = self.rounded.max(change);
        }
        exact
    }
}
