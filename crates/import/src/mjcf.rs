//! MJCF → [`Model`]: bodies, hinges, inertias (given, or those of the geoms), what drives the joints, and the classes from
//! which all of them take their defaults.

use super::Rigid;
use super::fault::{Faults, Kind};
use super::model::{EARTH, Format, Friction, Joint, Kind as JointKind, Link, Mass, Model, Rotor, Shape, Solid, Spring};
use super::xml::{File, child, children, name, plain};
use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, Translation3, Unit, UnitQuaternion, Vector3};
use piaffe_model::digits::digits;
use roxmltree::Node;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::iter::Sum;

/// kg/m³ of a geom that says nothing else.
const DENSITY: f64 = 1000.0;

/// How a file is had that says by itself what it leaves to MuJoCo's compiler.
pub const SAVE: &str = "save what MuJoCo compiles of it, and import that: python -c 'import mujoco; s = mujoco.MjSpec.from_file(\"FILE\"); \
                    s.compiler.saveinertial = True; s.compile(); print(s.to_xml())' > saved.xml";

pub fn read(file: &File, faults: &mut Faults) -> Option<Model> {
    let root = file.root();
    let included: Vec<Node> = root.descendants().filter(|n| n.has_tag_name("include")).collect();
    for node in &included {
        let other = plain(node.attribute("file").unwrap_or("another file"));
        let remedy = format!("import {other} if that is the robot; else {SAVE}");
        faults.add(
            Kind::Format,
            Some(&file.place(*node)),
            format!("it includes {other}, and one file is read"),
            remedy,
        );
    }
    for tag in ["replicate", "attach", "composite", "flexcomp"] {
        for node in root.descendants().filter(|n| n.has_tag_name(tag)) {
            faults.add(Kind::Format, Some(&file.place(node)), "it makes bodies that are not in the file", SAVE);
        }
    }
    // Where no body is put anywhere, the world's coordinates are those of the bodies.
    let poses = ["pos", "quat", "euler", "axisangle", "xyaxes", "zaxis"];
    let put = |n: &Node| n.has_tag_name("body") && poses.iter().any(|pose| n.has_attribute(*pose));
    let global = |n: &Node| n.attribute("coordinate") == Some("global") && root.descendants().any(|body| put(&body));
    for node in children(root, "compiler").filter(global) {
        let remedy = "load and save it with MuJoCo 2.3.3 or older, and import what was saved";
        faults.add(Kind::Format, Some(&file.place(node)), "its coordinates are the world's, not the bodies'", remedy);
    }
    if !faults.is_empty() {
        return None;
    }
    let mut reader = Reader::new(file, faults);
    let Some((trunk, others)) = reader.trunk(root) else {
        let remedy = "give a file with <body>s in its <worldbody>";
        faults.add(Kind::Format, Some(&file.place(root)), "no body of this file has joints on it", remedy);
        return None;
    };
    reader.bodies(trunk);
    reader.actuators(root);
    reader.equalities(root);
    reader.settle_mass(others);
    let (gravity, up) = reader.gravity(root);
    reader.say();
    let Reader { links, joints, mut notes, .. } = reader;
    if child(root, "tendon").is_some() {
        notes.push("tendons are dropped".into());
    }
    let name = root.attribute("model").map(plain).filter(|name| !name.is_empty()).unwrap_or_else(|| "robot".into());
    Some(Model { name, format: Format::Mjcf, links, joints, gravity, up, notes })
}

/// Attributes that elements of a class take where they have none of their own.
#[derive(Default)]
struct Class<'a, 't> {
    /// One that was found before: classes hang on each other without circles.
    above: Option<usize>,
    /// Several may say something of all actuators; the last one counts.
    elements: BTreeMap<&'static str, Vec<Node<'a, 't>>>,
}

/// The class of all elements that have no other one, whatever it is called.
const MAIN: usize = 0;

/// What MuJoCo's compiler makes of the masses of bodies.
struct Compiler {
    /// Whether the geoms give inertias: instead of <inertial>, only where there is none, or never.
    from_geoms: Option<bool>,
    /// Of the geoms that do.
    groups: Option<[f64; 2]>,
    /// The least mass and moments of any body; kg, kg·m².
    least: [f64; 2],
    /// Whether moments that no body has become their mean.
    balance: bool,
    /// Of all bodies together, kg.
    total: Option<f64>,
}

struct Reader<'a, 't, 'f> {
    file: &'a File<'t>,
    faults: &'f mut Faults,
    classes: Vec<Class<'a, 't>>,
    class_names: BTreeMap<&'a str, usize>,
    /// rad in one unit of the file's angles.
    angle: f64,
    eulers: String,
    autolimits: bool,
    compiler: Compiler,
    /// The trunk in the world.
    trunk_turn: UnitQuaternion<f64>,
    links: Vec<Link>,
    joints: Vec<Joint>,
    /// Bodies with a mass and no inertia, and those whose moments were balanced.
    points: Vec<String>,
    balanced: Vec<String>,
    /// Joints whose springs or dampers are not in proportion.
    curved: Vec<String>,
    notes: Vec<String>,
}

/// An element with the class that it takes its defaults from.
#[derive(Clone)]
struct Styled<'a, 't> {
    node: Node<'a, 't>,
    tag: &'static str,
    class: usize,
}

/// A body that is yet to be read.
struct Waiting<'a, 't> {
    node: Node<'a, 't>,
    parent: Option<usize>,
    /// Of the <frame>s around it.
    frame: Isometry3<f64>,
    class: usize,
}

impl<'a, 't, 'f> Reader<'a, 't, 'f> {
    fn new(file: &'a File<'t>, faults: &'f mut Faults) -> Self {
        let root = file.root();
        let said = |key: &str| children(root, "compiler").filter(|c| c.has_attribute(key)).last();
        let word = |key: &str| said(key).and_then(|c| c.attribute(key));
        let number = |key: &str, faults: &mut Faults| said(key).and_then(|c| file.number(c, key, faults));
        let compiler = Compiler {
            from_geoms: match word("inertiafromgeom") {
                Some("true") => Some(true),
                Some("false") => Some(false),
                _ => None,
            },
            groups: said("inertiagrouprange").and_then(|c| file.numbers(c, "inertiagrouprange", faults)),
            least: ["boundmass", "boundinertia"].map(|key| number(key, faults).unwrap_or(0.0)),
            balance: word("balanceinertia") == Some("true"),
            total: number("settotalmass", faults).filter(|total| *total > 0.0),
        };
        let mut classes = vec![Class::default()];
        let mut class_names = BTreeMap::new();
        let mut open: Vec<(Node, usize)> = children(root, "default").map(|n| (n, MAIN)).collect();
        open.iter().filter_map(|(n, _)| n.attribute("class")).for_each(|name| {
            class_names.insert(name, MAIN);
        });
        class_names.insert("main", MAIN);
        open.reverse();
        while let Some((node, own)) = open.pop() {
            for element in node.children().filter(Node::is_element) {
                match element.tag_name().name() {
                    "default" => {
                        let named = element.attribute("class");
                        let known = named.and_then(|name| class_names.get(name).copied());
                        let class = known.unwrap_or_else(|| {
                            classes.push(Class { above: Some(own), ..Class::default() });
                            classes.len() - 1
                        });
                        class_names.extend(named.map(|name| (name, class)));
                        open.push((element, class));
                    }
                    tag => classes[own].elements.entry(tag_of(tag)).or_default().push(element),
                }
            }
        }
        Reader {
            file,
            faults,
            classes,
            class_names,
            angle: if word("angle") == Some("radian") { 1.0 } else { PI / 180.0 },
            eulers: word("eulerseq").unwrap_or("xyz").to_string(),
            autolimits: word("autolimits") != Some("false"),
            compiler,
            trunk_turn: UnitQuaternion::identity(),
            links: Vec::new(),
            joints: Vec::new(),
            points: Vec::new(),
            balanced: Vec::new(),
            curved: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The class that an attribute names, or else the one that is there.
    fn class(&mut self, node: Node<'a, 't>, attribute: &str, otherwise: usize) -> usize {
        let Some(named) = node.attribute(attribute) else { return otherwise };
        self.class_names.get(named).copied().unwrap_or_else(|| {
            let near = super::words::nearest(named, self.class_names.keys().copied());
            let remedy = near.map_or("name a class of <default>".into(), |near| format!("did you mean `{near}`?"));
            let what = format!("there is no class `{}` of defaults", plain(named));
            self.faults.add(Kind::Missing, Some(&self.file.place(node)), what, remedy);
            otherwise
        })
    }

    /// What says something of an element: the class above all first, the element itself last.
    fn line(&self, of: &Styled<'a, 't>) -> Vec<Node<'a, 't>> {
        let mut line = vec![of.node];
        let mut class = Some(of.class);
        while let Some(here) = class.and_then(|c| self.classes.get(c)) {
            line.extend(here.elements.get(of.tag).into_iter().flatten().rev());
            class = here.above;
        }
        line.reverse();
        line
    }

    /// Those of them that have an attribute, with what it is.
    fn all(&self, of: &Styled<'a, 't>, attribute: &str) -> Vec<(Node<'a, 't>, &'a str)> {
        self.line(of).into_iter().filter_map(|node| Some((node, node.attribute(attribute)?))).collect()
    }

    /// The value of an attribute and the element that gives it: the element itself, or its class, or a class above that.
    fn find(&self, of: &Styled<'a, 't>, attribute: &str) -> Option<(Node<'a, 't>, &'a str)> {
        self.all(of, attribute).pop()
    }

    /// Numbers of which an element may give the first ones, and leave the others as its class has them.
    fn overlaid(&mut self, of: &Styled<'a, 't>, attribute: &str) -> Option<Vec<f64>> {
        let mut numbers: Vec<f64> = Vec::new();
        for (node, text) in self.all(of, attribute) {
            let given = self.file.list(node, attribute, text, self.faults)?;
            numbers = given.iter().chain(numbers.get(given.len()..).unwrap_or_default()).copied().collect();
        }
        (!numbers.is_empty()).then_some(numbers)
    }

    /// Whether a range counts.
    fn limited(&self, of: &Styled<'a, 't>, key: &str) -> bool {
        match self.word(of, key) {
            Some("true") => true,
            Some("false") => false,
            _ => self.autolimits,
        }
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

    fn styled(&mut self, node: Node<'a, 't>, class: usize) -> Styled<'a, 't> {
        let class = self.class(node, "class", class);
        Styled { node, tag: tag_of(node.tag_name().name()), class }
    }

    /// The body of the world that has most joints, and the others.
    fn trunk(&mut self, root: Node<'a, 't>) -> Option<(Waiting<'a, 't>, Vec<Waiting<'a, 't>>)> {
        let mut found: Vec<(usize, Waiting)> = Vec::new();
        for world in children(root, "worldbody") {
            for waiting in self.below(world, None, MAIN) {
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
        Some((trunk, found.into_iter().map(|(_, other)| other).collect()))
    }

    /// The bodies in an element, through the <frame>s around them.
    fn below(&mut self, node: Node<'a, 't>, parent: Option<usize>, class: usize) -> Vec<Waiting<'a, 't>> {
        let mut found = Vec::new();
        let mut open = vec![(node, Isometry3::identity(), class)];
        while let Some((node, frame, class)) = open.pop() {
            for inner in node.children().filter(Node::is_element) {
                let class = self.class(inner, "childclass", class);
                match inner.tag_name().name() {
                    "body" => found.push(Waiting { node: inner, parent, frame, class }),
                    "frame" => {
                        let styled = Styled { node: inner, tag: "frame", class };
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
    fn within(&mut self, node: Node<'a, 't>, tag: &str, class: usize) -> Vec<(Styled<'a, 't>, Isometry3<f64>)> {
        let mut found = Vec::new();
        let mut open = vec![(node, Isometry3::identity(), class)];
        while let Some((node, frame, class)) = open.pop() {
            for inner in node.children().filter(Node::is_element) {
                match inner.tag_name().name() {
                    "frame" => {
                        let class = self.class(inner, "childclass", class);
                        let own = self.pose(&Styled { node: inner, tag: "frame", class });
                        open.push((inner, frame * own, class));
                    }
                    name if name == tag => found.push((self.styled(inner, class), frame)),
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
            let named = node.attribute("name").map(name).filter(|name| !name.is_empty());
            let name = named.unwrap_or_else(|| format!("body{}", self.links.len() + 1));
            let geoms = self.within(node, "geom", class);
            let masses = self.masses(node, &name, &geoms);
            let shapes = geoms.iter().filter_map(|(geom, at)| self.shape(geom, at)).collect();
            let link = Link { name, place, masses, shapes };
            let own = self.pose(&Styled { node, tag: "body", class });
            let mut joints = self.within(node, "joint", class);
            joints.extend(self.within(node, "freejoint", class));
            let last = match parent {
                Some(parent) => self.chain(parent, frame * own, link, &joints),
                None => {
                    let free = |(joint, _): &(Styled<'a, 't>, Isometry3<f64>)| {
                        joint.tag == "freejoint" || self.word(joint, "type") == Some("free")
                    };
                    if !joints.iter().all(free) {
                        let what = format!("the joints by which `{}` moves in the world are dropped", link.name);
                        self.notes.push(what);
                    }
                    self.trunk_turn = (frame * own).rotation;
                    self.links.push(link);
                    0
                }
            };
            let mut below = self.below(node, Some(last), class);
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
                slides: false,
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
                spring_is_derived: false,
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
        let range = range.filter(|_| self.limited(of, "limited"));
        let slides = self.word(of, "type") == Some("slide");
        let unit = if slides { 1.0 } else { self.angle };
        let reference = self.number(of, "ref").unwrap_or(0.0);
        let range = range.map(|r| r.map(|x| (x - reference) * unit));
        let named = of.node.attribute("name").map(name).filter(|name| !name.is_empty());
        let name = named.unwrap_or_else(|| format!("{}_joint", self.links[child].name));
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
        let force = force.filter(|_| self.limited(of, "actuatorfrclimited"));
        let armature = self.number(of, "armature").filter(|a| *a > 0.0);
        let coulomb = self.number(of, "frictionloss").unwrap_or_default();
        let [damping, stiffness] = ["damping", "stiffness"].map(|key| {
            let all = self.list(of, key).unwrap_or_default();
            if all.iter().skip(1).any(|x| *x != 0.0) {
                self.curved.push(format!("`{name}`"));
            }
            all.first().copied().unwrap_or_default()
        });
        let rest = (self.number(of, "springref").unwrap_or_default() - reference) * unit;
        let derived = self.list(of, "springdamper").unwrap_or_default();
        self.joints.push(Joint {
            name,
            place,
            kind,
            slides,
            parent,
            child,
            frame: body * Translation3::from(anchor.coords),
            offset: -anchor.coords,
            axis,
            range,
            effort: force.map(|[lo, hi]| hi.min(-lo)).filter(|f| *f > 0.0),
            velocity: None,
            gear: None,
            rotor: armature.map(Rotor::AtJoint),
            spring: Spring { stiffness, rest },
            spring_is_derived: derived.len() == 2 && derived.iter().all(|x| *x > 0.0),
            friction: Friction { damping, coulomb },
        });
    }

    /// What drives the joints: gears, and the greatest forces.
    fn actuators(&mut self, root: Node<'a, 't>) {
        let all: Vec<Node> = children(root, "actuator").flat_map(|a| a.children().filter(Node::is_element)).collect();
        let mut drives: BTreeMap<usize, Vec<Drive>> = BTreeMap::new();
        for node in all {
            let of = self.styled(node, MAIN);
            let Some(joint) = self.word(&of, "joint").or(self.word(&of, "jointinparent")).map(name) else { continue };
            let Some(index) = self.joints.iter().position(|j| j.name == joint) else {
                let near = super::words::nearest(&joint, self.joints.iter().map(|j| j.name.as_str()));
                let remedy = near.map_or("name a joint of the file".into(), |near| format!("did you mean `{near}`?"));
                let what = format!("it drives `{}`, which does not exist", plain(&joint));
                self.faults.add(Kind::Missing, Some(&self.file.place(node)), what, remedy);
                continue;
            };
            let drive = self.drive(&of);
            drives.entry(index).or_default().push(drive);
        }
        for (index, drives) in drives {
            // One with a gear of 0 drives nothing.
            let drives: Vec<Drive> = drives.into_iter().filter(|drive| drive.gear != Some(0.0)).collect();
            let joint = &mut self.joints[index];
            joint.gear = drives.iter().find_map(|drive| drive.gear).map(f64::abs);
            if let Some(gear) = joint.gear
                && drives.iter().any(|drive| drive.gear.unwrap_or(1.0).abs() != gear)
            {
                let (name, gear) = (&joint.name, digits(gear));
                self.notes.push(format!(
                    "`{name}` has actuators with several gears: that of its motor is taken to be {gear}"
                ));
            }
            // What drives a joint together adds up; if one of them has no limit, the sum has none.
            let sum = drives.iter().map(|drive| drive.torque).sum::<Option<Torque>>();
            let torque = sum.map(|Torque([low, high])| high.min(-low)).filter(|most| *most > 0.0 && most.is_finite());
            joint.effort = match (joint.effort, torque) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
        }
    }

    fn drive(&mut self, of: &Styled<'a, 't>) -> Drive {
        let gear = self.number(of, "gear");
        let force = self.numbers::<2>(of, "forcerange").filter(|_| self.limited(of, "forcelimited"));
        let control = self.numbers::<2>(of, "ctrlrange").filter(|_| self.limited(of, "ctrllimited"));
        let gain = match of.node.tag_name().name() {
            "motor" => Some(1.0),
            "general" => self.gain(of),
            _ => None,
        };
        let control = control.zip(gain).map(|(range, gain)| Torque(range).times(gain));
        let force = match (force.map(Torque), control) {
            (Some(Torque([a, b])), Some(Torque([c, d]))) => Some(Torque([a.max(c), b.min(d)])),
            (a, b) => a.or(b),
        };
        Drive { gear, torque: force.map(|force| force.times(gear.unwrap_or(1.0))) }
    }

    /// N or N·m for a control of 1, if that alone makes the force. Defaults of any actuator make one of this kind for all.
    fn gain(&mut self, of: &Styled<'a, 't>) -> Option<f64> {
        let mut gain = Some(1.0);
        for node in self.line(of) {
            match node.tag_name().name() {
                "motor" => gain = Some(1.0),
                "general" => {
                    let given =
                        node.attribute("gainprm").and_then(|text| self.file.list(node, "gainprm", text, self.faults));
                    let given = given.and_then(|numbers| numbers.first().copied());
                    gain = match node.attribute("biastype").map(str::trim) {
                        Some("none") => given.or(gain).or(Some(1.0)),
                        Some(_) => None,
                        None => gain.map(|gain| given.unwrap_or(gain)),
                    };
                }
                _ => gain = None,
            }
        }
        gain
    }

    fn equalities(&mut self, root: Node<'a, 't>) {
        let all: Vec<Node> = children(root, "equality").flat_map(|e| e.children().filter(Node::is_element)).collect();
        for node in all {
            let class = self.class(node, "class", MAIN);
            if self.word(&Styled { node, tag: "equality", class }, "active") == Some("false") {
                continue;
            }
            match node.tag_name().name() {
                "connect" | "weld" => {
                    let remedy = "take a file in which each leg is one chain: a linkage cannot be described";
                    let place = self.file.place(node);
                    self.faults.add(Kind::Loop, Some(&place), "links that hang on each other in a loop", remedy);
                }
                "joint" => {
                    let follower = node.attribute("joint1").map(name);
                    for joint in self.joints.iter_mut().filter(|j| Some(&j.name) == follower.as_ref()) {
                        joint.kind = JointKind::Mimic;
                    }
                }
                _ => {}
            }
        }
    }

    /// Its size, m/s², none where the file has no weight; and against where it points in the trunk's frame.
    fn gravity(&mut self, root: Node<'a, 't>) -> (Option<f64>, Option<Vector3<f64>>) {
        let given = children(root, "option").filter(|option| option.has_attribute("gravity")).last();
        let down = match given {
            Some(option) => self.file.numbers(option, "gravity", self.faults).map(Vector3::from),
            None => Some(Vector3::new(0.0, 0.0, -EARTH)),
        };
        let Some(down) = down else { return (None, None) };
        let size = down.norm();
        if size == 0.0 {
            self.notes.push("the file has no gravity".into());
            return (None, None);
        }
        if down.normalize().iter().all(|along| along.abs() < 0.999) {
            self.notes.push(format!("gravity is oblique in the file: {size} m/s² are taken to point down"));
            return (Some(size), None);
        }
        (Some(size), Some(self.trunk_turn.inverse() * -down.normalize()))
    }

    /// All masses are scaled to what the file says that they are together, those of the other bodies too.
    fn settle_mass(&mut self, others: Vec<Waiting<'a, 't>>) {
        let Some(total) = self.compiler.total else { return };
        let mut sum: f64 = self.links.iter().flat_map(|l| &l.masses).map(|m| m.mass).sum();
        let mut open = others;
        while let Some(Waiting { node, class, .. }) = open.pop() {
            let geoms = self.within(node, "geom", class);
            sum += self.masses(node, &name_of(node), &geoms).iter().map(|m| m.mass).sum::<f64>();
            open.extend(self.below(node, None, class));
        }
        if sum > 0.0 {
            let share = total / sum;
            for mass in self.links.iter_mut().flat_map(|l| &mut l.masses) {
                mass.mass *= share;
                mass.inertia *= share;
            }
            self.notes.push(format!("all masses are scaled to {} kg together, as the file says", digits(total)));
        }
    }

    /// The masses of a body: its <inertial>, or those of its geoms, as the compiler leaves them.
    fn masses(&mut self, node: Node<'a, 't>, name: &str, geoms: &[(Styled<'a, 't>, Isometry3<f64>)]) -> Vec<Mass> {
        let given = child(node, "inertial");
        let masses = match (given, self.compiler.from_geoms) {
            (Some(inertial), Some(true)) => {
                let of_geoms = self.masses_of_geoms(name, geoms);
                if of_geoms.is_empty() { self.given_mass(inertial, name) } else { of_geoms }
            }
            (Some(inertial), _) => self.given_mass(inertial, name),
            (None, Some(false)) => Vec::new(),
            (None, _) => self.masses_of_geoms(name, geoms),
        };
        self.compiled(masses, name)
    }

    fn given_mass(&mut self, inertial: Node<'a, 't>, name: &str) -> Vec<Mass> {
        let of = Styled { node: inertial, tag: "inertial", class: MAIN };
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
            if mass > 0.0 && self.compiler.least[1] <= 0.0 {
                self.points.push(format!("`{name}`"));
            }
            Matrix3::zeros()
        };
        vec![Mass { mass, frame, inertia }]
    }

    fn masses_of_geoms(&mut self, name: &str, geoms: &[(Styled<'a, 't>, Isometry3<f64>)]) -> Vec<Mass> {
        let mut masses = Vec::new();
        for (geom, around) in geoms {
            let group = self.number(geom, "group").unwrap_or(0.0);
            if self.compiler.groups.is_some_and(|[first, last]| !(first..=last).contains(&group)) {
                continue;
            }
            let (given, density) = (self.number(geom, "mass"), self.number(geom, "density").unwrap_or(DENSITY));
            // Planes have no mass.
            if given.unwrap_or(density) == 0.0 || self.word(geom, "type") == Some("plane") {
                continue;
            }
            let place = self.file.place(geom.node);
            let Some((volume, unit, frame)) = self.volume(geom) else {
                let is_mesh = self.find(geom, "mesh").is_some() || !SOLIDS.contains(&self.kind_of(geom));
                if is_mesh {
                    let what = format!("body `{name}` has no <inertial>, and a mesh says nothing here");
                    let remedy = format!("give the body an <inertial>; or {SAVE}");
                    self.faults.add(Kind::Inertia, Some(&place), what, remedy);
                } else {
                    let what = format!("its size is not known, of which body `{name}` has its mass");
                    self.faults.add(
                        Kind::Inertia,
                        Some(&place),
                        what,
                        "write size=\"…\" in m, all its numbers above 0",
                    );
                }
                continue;
            };
            let mass = given.unwrap_or(density * volume);
            masses.push(Mass { mass, frame: around * frame, inertia: unit * mass });
        }
        masses
    }

    /// A body's masses as one, with the least that the file admits, and moments balanced where it says so.
    fn compiled(&mut self, masses: Vec<Mass>, name: &str) -> Vec<Mass> {
        let Compiler { least: [mass, moment], balance, .. } = self.compiler;
        if mass <= 0.0 && moment <= 0.0 && !balance {
            return masses;
        }
        let whole = masses.iter().map(Mass::rigid).fold(Rigid::NOTHING, |sum, next| sum.with(&next));
        if !whole.inertia.iter().all(|x| x.is_finite()) {
            return masses;
        }
        let eigen = SymmetricEigen::new(whole.inertia);
        let mut moments = eigen.eigenvalues.map(|own| own.max(moment));
        if balance && moments.max() > 0.5 * moments.sum() * (1.0 + 1e-12) {
            moments = Vector3::repeat(moments.mean());
            self.balanced.push(format!("`{name}`"));
        }
        let axes = eigen.eigenvectors;
        let inertia = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        vec![Mass { mass: whole.mass.max(mass), frame: Translation3::from(whole.com).into(), inertia }]
    }

    fn say(&mut self) {
        let all = [&self.points, &self.balanced, &self.curved];
        let [points, balanced, curved] = all.map(|names| super::words::short_list(names));
        if !points.is_empty() {
            self.notes.push(super::words::point_masses(&points));
        }
        if !balanced.is_empty() {
            self.notes.push(format!(
                "the moments of inertia of {balanced} become their mean, for they are no body's (balanceinertia of the file)"
            ));
        }
        if !curved.is_empty() {
            self.notes.push(format!(
                "of `stiffness` and `damping` of {curved} the first number is taken: what is not in proportion is left out"
            ));
        }
    }

    /// Volume, inertia of 1 kg and frame of a geom that has them.
    fn volume(&mut self, of: &Styled<'a, 't>) -> Option<(f64, Matrix3<f64>, Isometry3<f64>)> {
        let shape = self.solid(of)?;
        let [volume, x, y, z] = match self.word(of, "shellinertia") == Some("true") {
            true => shell(&shape.solid),
            false => full(&shape.solid),
        };
        Some((volume, Matrix3::from_diagonal(&Vector3::new(x, y, z)), shape.frame)).filter(|_| volume > 0.0)
    }

    /// What of a geom can touch the ground.
    fn shape(&mut self, of: &Styled<'a, 't>, around: &Isometry3<f64>) -> Option<Shape> {
        let collides = ["contype", "conaffinity"].iter().any(|key| self.word(of, key) != Some("0"));
        let shape = collides.then(|| self.solid(of)).flatten()?;
        Some(Shape { frame: around * shape.frame, solid: shape.solid })
    }

    fn kind_of(&self, of: &Styled<'a, 't>) -> &'a str {
        self.word(of, "type").unwrap_or("sphere")
    }

    fn solid(&mut self, of: &Styled<'a, 't>) -> Option<Shape> {
        let kind = self.kind_of(of);
        if !SOLIDS.contains(&kind) {
            return None;
        }
        let size = self.overlaid(of, "size")?;
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
        // Between two ends the length is theirs, and what is across has one number.
        let three = || Some([at(0)?, half.map_or(at(1), |_| at(0))?, half.or(at(2))?]);
        let solid = match kind {
            "sphere" => Solid::Sphere { radius: at(0)? },
            "capsule" => Solid::Capsule { radius: at(0)?, half: half.or(at(1))? },
            "cylinder" => Solid::Cylinder { radius: at(0)?, half: half.or(at(1))? },
            "ellipsoid" => Solid::Ellipsoid { half: three()? },
            _ => Solid::Box { half: three()? },
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
    name(node.attribute("name").unwrap_or_default())
}

/// Geoms of which the size says all.
const SOLIDS: [&str; 5] = ["sphere", "capsule", "cylinder", "box", "ellipsoid"];

/// Volume, m³, and moments of inertia of 1 kg, m², of a solid.
fn full(solid: &Solid) -> [f64; 4] {
    let across = |[a, b, c]: [f64; 3], share: f64| [b * b + c * c, a * a + c * c, a * a + b * b].map(|s| s * share);
    let with = |volume: f64, [x, y, z]: [f64; 3]| [volume, x, y, z];
    match *solid {
        Solid::Sphere { radius: r } => with(4.0 / 3.0 * PI * r.powi(3), [0.4 * r * r; 3]),
        Solid::Box { half } => with(8.0 * half.iter().product::<f64>(), across(half, 1.0 / 3.0)),
        Solid::Ellipsoid { half } => with(4.0 / 3.0 * PI * half.iter().product::<f64>(), across(half, 1.0 / 5.0)),
        Solid::Cylinder { radius: r, half: h } => {
            let across = r * r / 4.0 + h * h / 3.0;
            [2.0 * PI * r * r * h, across, across, r * r / 2.0]
        }
        Solid::Capsule { radius: r, half: h } => {
            let (tube, ball) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
            let volume = tube + ball;
            let (t, b) = (tube / volume, ball / volume);
            let along = t * r * r / 2.0 + b * 0.4 * r * r;
            let across = t * (r * r / 4.0 + h * h / 3.0) + b * (0.4 * r * r + h * h + 0.75 * h * r);
            [volume, across, across, along]
        }
    }
}

/// Surface, m², and moments of inertia of 1 kg on it, m². An ellipsoid's are approximate, as MuJoCo has them: no closed form is
/// known of its surface (Thomsen's formula), and its shell is as thick along each axis.
fn shell(solid: &Solid) -> [f64; 4] {
    match *solid {
        Solid::Sphere { radius: r } => [4.0 * PI * r * r, r * r / 1.5, r * r / 1.5, r * r / 1.5],
        Solid::Box { half: [a, b, c] } => {
            // Two faces across each axis: what they share of the surface.
            let faces = [b * c, c * a, a * b];
            let sum: f64 = faces.iter().sum();
            let half = [a, b, c];
            // ∫x² over the surface: the faces across x are at ±a, on the others x² is a third of a² on the mean.
            let square = |k: usize| half[k] * half[k] * (faces[k] + (sum - faces[k]) / 3.0) / sum;
            let [x, y, z] = [square(0), square(1), square(2)];
            [8.0 * sum, y + z, x + z, x + y]
        }
        Solid::Ellipsoid { half: [a, b, c] } => {
            let power = 1.6075;
            let mean = [a * b, b * c, c * a].map(|s| s.powf(power)).iter().sum::<f64>() / 3.0;
            let bulge = 2.0 * a * b * c / (a * b + b * c + c * a);
            let moment = |p: f64, q: f64| (p * p + q * q + bulge * (p + q)) / 5.0;
            [4.0 * PI * mean.powf(1.0 / power), moment(b, c), moment(a, c), moment(a, b)]
        }
        Solid::Cylinder { radius: r, half: h } => {
            let (tube, lids) = (4.0 * PI * r * h, 2.0 * PI * r * r);
            let surface = tube + lids;
            let (t, l) = (tube / surface, lids / surface);
            let across = t * (r * r / 2.0 + h * h / 3.0) + l * (r * r / 4.0 + h * h);
            [surface, across, across, t * r * r + l * r * r / 2.0]
        }
        Solid::Capsule { radius: r, half: h } => {
            let (tube, ball) = (4.0 * PI * r * h, 4.0 * PI * r * r);
            let surface = tube + ball;
            let (t, b) = (tube / surface, ball / surface);
            // The centre of half a sphere is r/2 from its middle.
            let across = t * (r * r / 2.0 + h * h / 3.0) + b * (r * r / 1.5 + h * h + h * r);
            [surface, across, across, t * r * r + b * r * r / 1.5]
        }
    }
}

/// An actuator of a joint.
struct Drive {
    gear: Option<f64>,
    /// On the joint; `None` where nothing limits it.
    torque: Option<Torque>,
}

/// The least and the greatest torque, N·m.
#[derive(Clone, Copy)]
struct Torque([f64; 2]);

impl Torque {
    fn times(self, factor: f64) -> Torque {
        let [a, b] = self.0.map(|x| x * factor);
        Torque([a.min(b), a.max(b)])
    }
}

impl Sum for Torque {
    fn sum<I: Iterator<Item = Torque>>(all: I) -> Torque {
        all.fold(Torque([0.0; 2]), |Torque([a, b]), Torque([c, d])| Torque([a + c, b + d]))
    }
}

/// What elements are called where defaults are kept: all actuators share theirs.
fn tag_of(tag: &str) -> &'static str {
    match tag {
        "joint" => "joint",
        "freejoint" => "freejoint",
        "geom" => "geom",
        "equality" => "equality",
        "motor" | "general" | "position" | "velocity" | "intvelocity" | "damper" | "cylinder" | "muscle"
        | "adhesion" | "dcmotor" => "actuator",
        _ => "other",
    }
}
