//! MJCF → [`Model`]: bodies, hinges, inertias (given, or those of the geoms), what drives the joints, and the classes from
//! which all of them take their defaults.

use super::fault::{Faults, Kind, Place};
use super::model::{EARTH, Format, Friction, Joint, Kind as JointKind, Link, Mass, Model, Shape, Solid, Spring};
use super::xml::{File, child, children, plain};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// kg/m³ of a geom that says nothing else.
const DENSITY: f64 = 1000.0;

pub fn read(file: &File, faults: &mut Faults) -> Option<Model> {
    let root = file.root();
    let included: Vec<Node> = root.descendants().filter(|n| n.has_tag_name("include")).collect();
    for node in &included {
        let other = plain(node.attribute("file").unwrap_or("another file"));
        let remedy = format!("import {other} if that is the robot; else put what it has into this file");
        faults.add(
            Kind::Format,
            Some(&file.place(*node)),
            format!("it includes {other}, and one file is read"),
            remedy,
        );
    }
    for tag in ["replicate", "attach", "composite", "flexcomp"] {
        for node in root.descendants().filter(|n| n.has_tag_name(tag)) {
            let remedy = "save the compiled model and import that: mujoco.mj_saveLastXML(\"robot.xml\", model)";
            faults.add(Kind::Format, Some(&file.place(node)), "it makes bodies that are not in the file", remedy);
        }
    }
    if !faults.is_empty() {
        return None;
    }
    let mut reader = Reader::new(file, faults);
    let Some(trunk) = reader.trunk(root) else {
        let remedy = "give a file with <body>s in its <worldbody>";
        faults.add(Kind::Format, Some(&file.place(root)), "no body of this file has joints on it", remedy);
        return None;
    };
    reader.bodies(trunk);
    reader.actuators(root);
    reader.equalities(root);
    reader.settle_mass(root);
    let gravity = reader.gravity(root);
    let Reader { links, joints, mut notes, .. } = reader;
    if child(root, "tendon").is_some() {
        notes.push("tendons are dropped".into());
    }
    let name = root.attribute("model").map(plain).filter(|name| !name.is_empty()).unwrap_or_else(|| "robot".into());
    Some(Model { name, format: Format::Mjcf, links, joints, gravity, notes })
}

/// Attributes that elements of a class take where they have none of their own.
struct Class<'a, 't> {
    above: Option<String>,
    elements: BTreeMap<String, Node<'a, 't>>,
}

struct Reader<'a, 't, 'f> {
    file: &'a File<'t>,
    faults: &'f mut Faults,
    classes: BTreeMap<String, Class<'a, 't>>,
    /// rad in one unit of the file's angles.
    angle: f64,
    eulers: String,
    autolimits: bool,
    from_geoms: bool,
    links: Vec<Link>,
    joints: Vec<Joint>,
    notes: Vec<String>,
}

/// An element with the class that it takes its defaults from.
#[derive(Clone)]
struct Styled<'a, 't> {
    node: Node<'a, 't>,
    tag: &'static str,
    class: String,
}

/// A body that is yet to be read.
struct Waiting<'a, 't> {
    node: Node<'a, 't>,
    parent: Option<usize>,
    /// Of the <frame>s around it.
    frame: Isometry3<f64>,
    class: String,
}

impl<'a, 't, 'f> Reader<'a, 't, 'f> {
    fn new(file: &'a File<'t>, faults: &'f mut Faults) -> Self {
        let root = file.root();
        let said = |key: &str| children(root, "compiler").filter_map(|c| c.attribute(key)).last();
        let mut classes = BTreeMap::new();
        let mut open: Vec<(Node, Option<String>)> = children(root, "default").map(|n| (n, None)).collect();
        while let Some((node, above)) = open.pop() {
            let name = node.attribute("class").unwrap_or("main").to_string();
            let mut elements = BTreeMap::new();
            for element in node.children().filter(Node::is_element) {
                match element.tag_name().name() {
                    "default" => open.push((element, Some(name.clone()))),
                    tag => {
                        elements.insert(tag_of(tag).to_string(), element);
                    }
                }
            }
            classes.insert(name, Class { above, elements });
        }
        Reader {
            file,
            faults,
            classes,
            angle: if said("angle") == Some("radian") { 1.0 } else { PI / 180.0 },
            eulers: said("eulerseq").unwrap_or("xyz").to_string(),
            autolimits: said("autolimits") != Some("false"),
            from_geoms: said("inertiafromgeom") == Some("true"),
            links: Vec::new(),
            joints: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The value of an attribute and the element that gives it: the element itself, or its class, or a class above that.
    fn find<'s>(&'s self, of: &'s Styled<'a, 't>, attribute: &str) -> Option<(Node<'a, 't>, &'a str)> {
        if let Some(value) = of.node.attribute(attribute) {
            return Some((of.node, value));
        }
        let mut class = Some(of.class.as_str());
        // Classes hang on each other without circles: each was found inside the one above.
        while let Some(found) = class.and_then(|c| self.classes.get(c)) {
            if let Some(node) = found.elements.get(of.tag)
                && let Some(value) = node.attribute(attribute)
            {
                return Some((*node, value));
            }
            class = found.above.as_deref();
        }
        None
    }

    fn word(&self, of: &Styled<'a, 't>, attribute: &str) -> Option<&'a str> {
        self.find(of, attribute).map(|(_, value)| value.trim())
    }

    fn list(&mut self, of: &Styled<'a, 't>, attribute: &str) -> Option<Vec<f64>> {
        let (node, text) = self.find(of, attribute)?;
        let read = self.file.list(node, attribute, text, self.faults)?;
        Some(read)
    }

    fn numbers<const N: usize>(&mut self, of: &Styled<'a, 't>, attribute: &str) -> Option<[f64; N]> {
        let list = self.list(of, attribute)?;
        let place = self.file.place(of.node);
        <[f64; N]>::try_from(list)
            .map_err(|list| {
                let what = format!("{attribute} has {} numbers instead of {N}", list.len());
                self.faults.add(Kind::Number, Some(&place), what, "write them with spaces between them");
            })
            .ok()
    }

    fn number(&mut self, of: &Styled<'a, 't>, attribute: &str) -> Option<f64> {
        self.list(of, attribute)?.first().copied()
    }

    fn styled(&self, node: Node<'a, 't>, class: &str) -> Styled<'a, 't> {
        let class = node.attribute("class").unwrap_or(class).to_string();
        Styled { node, tag: tag_of(node.tag_name().name()), class }
    }

    /// The body of the world that has most joints.
    fn trunk(&mut self, root: Node<'a, 't>) -> Option<Waiting<'a, 't>> {
        let mut found: Vec<(usize, Waiting)> = Vec::new();
        for world in children(root, "worldbody") {
            for waiting in self.below(world, None, "main") {
                let joints = waiting.node.descendants().filter(|n| n.has_tag_name("joint")).count();
                found.push((joints, waiting));
            }
        }
        let most = found.iter().map(|(joints, _)| *joints).max().filter(|joints| *joints > 0)?;
        let first = found.iter().position(|(joints, _)| *joints == most)?;
        let (_, trunk) = found.swap_remove(first);
        if !found.is_empty() {
            self.notes.push(format!("{} other bodies of the world are left out", found.len()));
        }
        Some(trunk)
    }

    /// The bodies in an element, through the <frame>s around them.
    fn below(&mut self, node: Node<'a, 't>, parent: Option<usize>, class: &str) -> Vec<Waiting<'a, 't>> {
        let mut found = Vec::new();
        let mut open = vec![(node, Isometry3::identity(), class.to_string())];
        while let Some((node, frame, class)) = open.pop() {
            for inner in node.children().filter(Node::is_element) {
                let class = inner.attribute("childclass").unwrap_or(&class).to_string();
                match inner.tag_name().name() {
                    "body" => found.push(Waiting { node: inner, parent, frame, class }),
                    "frame" => {
                        let styled = Styled { node: inner, tag: "frame", class: class.clone() };
                        let own = self.pose(&styled);
                        open.push((inner, frame * own, class));
                    }
                    _ => {}
                }
            }
        }
        found
    }

    /// The elements of one name in a body, through the <frame>s around them.
    fn within(&mut self, node: Node<'a, 't>, tag: &str, class: &str) -> Vec<(Styled<'a, 't>, Isometry3<f64>)> {
        let mut found = Vec::new();
        let mut open = vec![(node, Isometry3::identity(), class.to_string())];
        while let Some((node, frame, class)) = open.pop() {
            for inner in node.children().filter(Node::is_element) {
                match inner.tag_name().name() {
                    "frame" => {
                        let class = inner.attribute("childclass").unwrap_or(&class).to_string();
                        let own = self.pose(&Styled { node: inner, tag: "frame", class: class.clone() });
                        open.push((inner, frame * own, class));
                    }
                    name if name == tag => found.push((self.styled(inner, &class), frame)),
                    _ => {}
                }
            }
        }
        found
    }

    fn bodies(&mut self, trunk: Waiting<'a, 't>) {
        let mut open = vec![trunk];
        while let Some(Waiting { node, parent, frame, class }) = open.pop() {
            let place = self.file.place(node);
            let name = node.attribute("name").map(plain).filter(|name| !name.is_empty());
            let name = name.unwrap_or_else(|| format!("body{}", self.links.len() + 1));
            let geoms = self.within(node, "geom", &class);
            let masses = self.masses(node, &place, &geoms);
            let shapes = geoms.iter().filter_map(|(geom, at)| self.shape(geom, at)).collect();
            let link = Link { name, place, masses, shapes };
            let own = self.pose(&Styled { node, tag: "body", class: class.clone() });
            let mut joints = self.within(node, "joint", &class);
            joints.extend(self.within(node, "freejoint", &class));
            let last = match parent {
                Some(parent) => self.chain(parent, frame * own, link, &joints),
                None => {
                    let put = |(joint, _): &(Styled, Isometry3<f64>)| {
                        joint.tag == "freejoint" || joint.node.attribute("type") == Some("free")
                    };
                    if joints.iter().any(|joint| !put(joint)) {
                        let what = format!("the joints by which `{}` moves in the world are dropped", link.name);
                        self.notes.push(what);
                    }
                    self.links.push(link);
                    0
                }
            };
            let mut below = self.below(node, Some(last), &class);
            below.reverse();
            open.extend(below);
        }
    }

    /// Puts a body on its joints, of which all but the last carry links without mass.
    fn chain(
        &mut self,
        parent: usize,
        at: Isometry3<f64>,
        link: Link,
        joints: &[(Styled<'a, 't>, Isometry3<f64>)],
    ) -> usize {
        let (mut parent, mut frame) = (parent, at);
        let (name, place) = (link.name.clone(), link.place.clone());
        let mut last = Some(link);
        if joints.is_empty() {
            let child = self.links.len();
            self.links.extend(last.take());
            self.joints.push(Joint {
                name: format!("{name}_is_fixed"),
                place,
                kind: JointKind::Fixed,
                parent,
                child,
                frame,
                offset: Vector3::zeros(),
                axis: Vector3::x(),
                range: None,
                effort: None,
                velocity: None,
                gear: None,
                rotor: None,
                spring: Spring::default(),
                friction: Friction::default(),
            });
            return child;
        }
        for (k, (joint, around)) in joints.iter().enumerate() {
            let child = self.links.len();
            if k + 1 < joints.len() {
                let between = format!("{name}_{}", k + 1);
                self.links.push(Link { name: between, place: place.clone(), masses: Vec::new(), shapes: Vec::new() });
            } else {
                self.links.extend(last.take());
            }
            self.joint(parent, child, &frame, joint, around);
            (parent, frame) = (child, Isometry3::identity());
        }
        parent
    }

    fn joint(
        &mut self,
        parent: usize,
        child: usize,
        body: &Isometry3<f64>,
        of: &Styled<'a, 't>,
        around: &Isometry3<f64>,
    ) {
        let place = self.file.place(of.node);
        let anchor = around * nalgebra::Point3::from(self.numbers(of, "pos").unwrap_or([0.0; 3]));
        let axis = around.rotation * Vector3::from(self.numbers(of, "axis").unwrap_or([0.0, 0.0, 1.0]));
        let range: Option<[f64; 2]> = self.numbers(of, "range");
        let limited = match self.word(of, "limited") {
            Some("true") => true,
            Some("false") => false,
            _ => self.autolimits && range.is_some(),
        };
        let reference = self.number(of, "ref").unwrap_or(0.0);
        let range = range.filter(|_| limited).map(|r| r.map(|x| (x - reference) * self.angle));
        let name = of.node.attribute("name").map(plain).filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("{}_joint", self.links[child].name));
        if reference != 0.0 {
            self.notes.push(format!("angles of `{name}` count from the pose of the file (its ref is left out)"));
        }
        let kind = match self.word(of, "type").unwrap_or("hinge") {
            _ if of.tag == "freejoint" => JointKind::Free,
            "hinge" if range.is_some() => JointKind::Revolute,
            "hinge" => JointKind::Continuous,
            "free" => JointKind::Free,
            other => JointKind::Other(plain(other)),
        };
        let force: Option<[f64; 2]> = self.numbers(of, "actuatorfrcrange");
        let armature = self.number(of, "armature").filter(|a| *a > 0.0);
        let [damping, coulomb] = ["damping", "frictionloss"].map(|key| self.number(of, key).unwrap_or_default());
        let stiffness = self.number(of, "stiffness").unwrap_or_default();
        let rest = (self.number(of, "springref").unwrap_or_default() - reference) * self.angle;
        if self.word(of, "springdamper").is_some() {
            self.notes.push(format!("`springdamper` of `{name}` is left out"));
        }
        self.joints.push(Joint {
            name,
            place,
            kind,
            parent,
            child,
            frame: body * Translation3::from(anchor.coords),
            offset: -anchor.coords,
            axis,
            range,
            effort: force.map(|[lo, hi]| hi.min(-lo)).filter(|f| *f > 0.0),
            velocity: None,
            gear: None,
            rotor: armature,
            spring: Spring { stiffness, rest },
            friction: Friction { damping, coulomb },
        });
    }

    /// What drives the joints: gears, and the greatest forces.
    fn actuators(&mut self, root: Node<'a, 't>) {
        let all: Vec<Node> = children(root, "actuator").flat_map(|a| a.children().filter(Node::is_element)).collect();
        for node in all {
            let of = self.styled(node, "main");
            let kind = node.tag_name().name();
            let Some(joint) = self.word(&of, "joint").or(self.word(&of, "jointinparent")).map(plain) else { continue };
            let place = self.file.place(node);
            let Some(index) = self.joints.iter().position(|j| j.name == joint) else {
                let near = super::words::nearest(&joint, self.joints.iter().map(|j| j.name.as_str()));
                let remedy = near.map_or("name a joint of the file".into(), |near| format!("did you mean `{near}`?"));
                self.faults.add(
                    Kind::Missing,
                    Some(&place),
                    format!("it drives `{joint}`, which does not exist"),
                    remedy,
                );
                continue;
            };
            let gear = self.number(&of, "gear").unwrap_or(1.0).abs();
            let most = |range: Option<[f64; 2]>| range.map(|[lo, hi]| hi.min(-lo)).filter(|f| *f > 0.0);
            let limited = |reader: &Self, key: &str| reader.word(&of, key) != Some("false");
            let force = self.numbers(&of, "forcerange").filter(|_| limited(self, "forcelimited"));
            let control = self.numbers(&of, "ctrlrange").filter(|_| limited(self, "ctrllimited"));
            let gain = match kind {
                "motor" => Some(1.0),
                "general" if self.word(&of, "biastype").is_none_or(|b| b == "none") => {
                    Some(self.number(&of, "gainprm").unwrap_or(1.0))
                }
                _ => None,
            };
            let control = most(control).zip(gain).map(|(c, gain)| c * gain.abs()).filter(|c| *c > 0.0);
            let force = match (most(force), control) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            let joint = &mut self.joints[index];
            if gear > 0.0 {
                joint.gear = Some(gear);
                let torque = force.map(|f| f * gear);
                joint.effort = match (joint.effort, torque) {
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
            }
        }
        // The armature is at the joint, the specification's rotor at the motor.
        for joint in &mut self.joints {
            let gear = joint.gear.unwrap_or(1.0);
            joint.rotor = joint.rotor.map(|armature| armature / (gear * gear));
        }
    }

    fn equalities(&mut self, root: Node<'a, 't>) {
        let all: Vec<Node> = children(root, "equality").flat_map(|e| e.children().filter(Node::is_element)).collect();
        for node in all.into_iter().filter(|n| n.attribute("active") != Some("false")) {
            match node.tag_name().name() {
                "connect" | "weld" => {
                    let remedy = "take a file in which each leg is one chain: a linkage cannot be described";
                    let place = self.file.place(node);
                    self.faults.add(Kind::Loop, Some(&place), "links that hang on each other in a loop", remedy);
                }
                "joint" => {
                    let follower = node.attribute("joint1").map(plain);
                    for joint in self.joints.iter_mut().filter(|j| Some(&j.name) == follower.as_ref()) {
                        joint.kind = JointKind::Mimic;
                    }
                }
                _ => {}
            }
        }
    }

    /// Its size, m/s²; none where the file has no weight.
    fn gravity(&mut self, root: Node<'a, 't>) -> Option<f64> {
        let given = children(root, "option").filter(|option| option.has_attribute("gravity")).last();
        let Some(option) = given else { return Some(EARTH) };
        let of = Styled { node: option, tag: "option", class: "main".into() };
        let down = Vector3::from(self.numbers::<3>(&of, "gravity")?);
        let size = down.norm();
        if size == 0.0 {
            self.notes.push("the file has no gravity".into());
            return None;
        }
        if down.normalize().iter().all(|along| along.abs() < 0.999) {
            self.notes.push(format!("gravity is oblique in the file: {size} m/s² are taken to point down"));
        }
        Some(size)
    }

    fn settle_mass(&mut self, root: Node<'a, 't>) {
        let Some(total) = children(root, "compiler").find_map(|c| c.attribute("settotalmass")?.parse::<f64>().ok())
        else {
            return;
        };
        let sum: f64 = self.links.iter().flat_map(|l| &l.masses).map(|m| m.mass).sum();
        if total > 0.0 && sum > 0.0 {
            for mass in self.links.iter_mut().flat_map(|l| &mut l.masses) {
                mass.mass *= total / sum;
                mass.inertia *= total / sum;
            }
        }
    }

    /// The masses of a body: its <inertial>, or those of its geoms.
    fn masses(&mut self, node: Node<'a, 't>, place: &Place, geoms: &[(Styled<'a, 't>, Isometry3<f64>)]) -> Vec<Mass> {
        if let Some(inertial) = child(node, "inertial").filter(|_| !self.from_geoms) {
            let of = Styled { node: inertial, tag: "inertial", class: "main".into() };
            let frame = self.pose(&of);
            let at = self.file.place(inertial);
            let Some(mass) = self.number(&of, "mass").filter(|m| *m >= 0.0) else {
                self.faults.add(Kind::Inertia, Some(&at), "it has no mass", "write mass=\"…\" in kg");
                return Vec::new();
            };
            let inertia = if let Some(d) = self.numbers::<3>(&of, "diaginertia") {
                Matrix3::from_diagonal(&Vector3::from(d))
            } else if let Some([xx, yy, zz, xy, xz, yz]) = self.numbers(&of, "fullinertia") {
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            } else {
                Matrix3::zeros()
            };
            return vec![Mass { mass, frame, inertia }];
        }
        let mut masses = Vec::new();
        for (geom, around) in geoms {
            let given = self.number(geom, "mass");
            if given == Some(0.0) {
                continue;
            }
            let density = self.number(geom, "density").unwrap_or(DENSITY);
            let Some((volume, unit, frame)) = self.volume(geom) else {
                let place_of_geom = self.file.place(geom.node);
                if density > 0.0 || given.is_some() {
                    let remedy = "give the body an <inertial>, or save the compiled model and import that: mujoco.mj_saveLastXML";
                    let what =
                        format!("body `{}` has no <inertial>, and a mesh says nothing here", plain(&name_of(node)));
                    self.faults.add(Kind::Inertia, Some(&place_of_geom), what, remedy);
                }
                continue;
            };
            let mass = given.unwrap_or(density * volume);
            masses.push(Mass { mass, frame: around * frame, inertia: unit * mass });
        }
        let _ = place;
        masses
    }

    /// Volume, inertia of 1 kg and frame of a geom that has them.
    fn volume(&mut self, of: &Styled<'a, 't>) -> Option<(f64, Matrix3<f64>, Isometry3<f64>)> {
        if self.word(of, "type") == Some("ellipsoid") {
            let [a, b, c] = self.numbers(of, "size")?;
            let unit = Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / 5.0;
            return Some((4.0 / 3.0 * PI * a * b * c, Matrix3::from_diagonal(&unit), self.pose(of)));
        }
        let Shape { frame, solid } = self.solid(of)?;
        let (volume, [x, y, z]) = match solid {
            Solid::Sphere { radius } => (4.0 / 3.0 * PI * radius.powi(3), [0.4 * radius * radius; 3]),
            Solid::Box { half: [a, b, c] } => {
                (8.0 * a * b * c, [b * b + c * c, a * a + c * c, a * a + b * b].map(|s| s / 3.0))
            }
            Solid::Cylinder { radius: r, half: h } => {
                let across = r * r / 4.0 + h * h / 3.0;
                (2.0 * PI * r * r * h, [across, across, r * r / 2.0])
            }
            Solid::Capsule { radius: r, half: h } => {
                let (tube, ball) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
                let volume = tube + ball;
                let (t, b) = (tube / volume, ball / volume);
                let along = t * r * r / 2.0 + b * 0.4 * r * r;
                let across = t * (r * r / 4.0 + h * h / 3.0) + b * (0.4 * r * r + h * h + 0.75 * h * r);
                (volume, [across, across, along])
            }
        };
        Some((volume, Matrix3::from_diagonal(&Vector3::new(x, y, z)), frame))
    }

    /// What of a geom can touch the ground.
    fn shape(&mut self, of: &Styled<'a, 't>, around: &Isometry3<f64>) -> Option<Shape> {
        let collides = ["contype", "conaffinity"].iter().any(|key| self.word(of, key) != Some("0"));
        let shape = collides.then(|| self.solid(of)).flatten()?;
        Some(Shape { frame: around * shape.frame, solid: shape.solid })
    }

    fn solid(&mut self, of: &Styled<'a, 't>) -> Option<Shape> {
        let kind = self.word(of, "type").unwrap_or("sphere");
        if !["sphere", "capsule", "cylinder", "box"].contains(&kind) {
            return None;
        }
        let size = self.list(of, "size")?;
        let ends = self.numbers::<6>(of, "fromto").filter(|_| kind != "sphere");
        let (frame, half) = match ends {
            Some([a, b, c, x, y, z]) => {
                let (from, to) = (Vector3::new(a, b, c), Vector3::new(x, y, z));
                let turn = UnitQuaternion::rotation_between(&Vector3::z(), &(to - from));
                let turn = turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
                (Isometry3::from_parts(Translation3::from((from + to) / 2.0), turn), Some((to - from).norm() / 2.0))
            }
            None => (self.pose(of), None),
        };
        let at = |k: usize| size.get(k).copied();
        let solid = match kind {
            "sphere" => Solid::Sphere { radius: at(0)? },
            "capsule" => Solid::Capsule { radius: at(0)?, half: half.or(at(1))? },
            "cylinder" => Solid::Cylinder { radius: at(0)?, half: half.or(at(1))? },
            _ => Solid::Box { half: [at(0)?, half.map_or(at(1), |_| at(0))?, half.or(at(2))?] },
        };
        Some(Shape { frame, solid })
    }

    /// Where an element is and how it is turned.
    fn pose(&mut self, of: &Styled<'a, 't>) -> Isometry3<f64> {
        let place = Translation3::from(self.numbers(of, "pos").unwrap_or([0.0; 3]));
        Isometry3::from_parts(place, self.turn(of))
    }

    fn turn(&mut self, of: &Styled<'a, 't>) -> UnitQuaternion<f64> {
        let identity = UnitQuaternion::identity();
        if let Some([w, x, y, z]) = self.numbers(of, "quat") {
            return UnitQuaternion::try_new(nalgebra::Quaternion::new(w, x, y, z), 1e-12).unwrap_or(identity);
        }
        if let Some([x, y, z, angle]) = self.numbers(of, "axisangle") {
            let axis = Unit::try_new(Vector3::new(x, y, z), 1e-12);
            return axis.map_or(identity, |axis| UnitQuaternion::from_axis_angle(&axis, angle * self.angle));
        }
        if let Some(angles) = self.numbers::<3>(of, "euler") {
            let mut turn = identity;
            for (letter, angle) in self.eulers.chars().zip(angles) {
                let axis = match letter.to_ascii_lowercase() {
                    'x' => Vector3::x_axis(),
                    'y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                let next = UnitQuaternion::from_axis_angle(&axis, angle * self.angle);
                turn = if letter.is_ascii_lowercase() { turn * next } else { next * turn };
            }
            return turn;
        }
        if let Some([a, b, c, d, e, f]) = self.numbers(of, "xyaxes") {
            let x = Vector3::new(a, b, c);
            let y = Vector3::new(d, e, f);
            if let Some(x) = x.try_normalize(1e-12)
                && let Some(y) = (y - x * x.dot(&y)).try_normalize(1e-12)
            {
                let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
                return UnitQuaternion::from_rotation_matrix(&turn);
            }
        }
        if let Some(z) = self.numbers::<3>(of, "zaxis") {
            return UnitQuaternion::rotation_between(&Vector3::z(), &Vector3::from(z)).unwrap_or(identity);
        }
        identity
    }
}

fn name_of(node: Node) -> String {
    node.attribute("name").unwrap_or_default().to_string()
}

/// What elements are called where defaults are kept: all actuators share theirs.
fn tag_of(tag: &str) -> &'static str {
    match tag {
        "joint" => "joint",
        "freejoint" => "freejoint",
        "geom" => "geom",
        "motor" | "general" | "position" | "velocity" | "intvelocity" | "damper" | "cylinder" | "muscle"
        | "adhesion" => "actuator",
        _ => "other",
    }
}
