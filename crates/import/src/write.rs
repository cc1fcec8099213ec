//! The specification's text.

use super::Rigid;
use super::fault::Place;
use super::model::{EARTH, Format};
use super::robot::{Joint, Leg, Motor, Robot, Source};
use super::words::identifier;
use nalgebra::Vector3;
use std::fmt::Write;

const AXES: [&str; 3] = ["roll", "yaw", "pitch"];

/// `robot.toml`, with `notes` in its head.
pub fn robot(robot: &Robot, format: Format, notes: &[String]) -> String {
    let mut out = String::from("#:schema ../schema/robot.schema.json\n");
    let name = &robot.name;
    let file = format.name();
    put(
        &mut out,
        &format!(
            "# Imported from the {file} of \"{name}\". Axes: x forward, y up, z to the right. Angles are those of"
        ),
    );
    put(&mut out, "# the file, with the opposite sign where the axis is said to be turned round.");
    put(&mut out, "#");
    for note in notes {
        put(&mut out, &format!("# - {note}"));
    }
    let (gravity, assumed) = match robot.gravity {
        Some(given) => (given, ""),
        None => (EARTH, "; assumed"),
    };
    put(&mut out, &format!("\nname = \"{name}\"\ngravity = {:<24}# m/s²{assumed}", number(gravity)));
    put(&mut out, &format!("\n[links.{}]", robot.platform_name));
    inertial(&mut out, &robot.platform, ["roll", "yaw", "pitch"], "");
    for leg in &robot.legs {
        for (depth, segment) in leg.segments.iter().enumerate() {
            put(&mut out, &format!("\n[links.{}]", segment.link.name));
            called(&mut out, &segment.link.name, &segment.link.source);
            let to = if depth + 1 < leg.segments.len() { "next joint" } else { "foot" };
            let length = format!("length = {}  # m, to the {to}\n", vector(&segment.link.end));
            inertial(&mut out, &segment.link.rigid, ["lateral", "axial", "swing"], &length);
        }
    }
    let motors = Motors::of(robot);
    for leg in &robot.legs {
        joints(&mut out, leg, &robot.platform_name, &motors);
    }
    put(&mut out, "\n[legs]");
    for leg in &robot.legs {
        let first = leg.segments.first().map(|s| s.joint.name.as_str()).unwrap_or_default();
        put(&mut out, &format!("{} = {{ mount = {}, first_joint = \"{first}\" }}", leg.name, vector(&leg.mount)));
    }
    motors.write(&mut out);
    out
}

/// The robot's name as a folder's name, none of those that the folder has for other things, or that its gaits have.
pub fn folder<'g>(name: &str, gaits: impl IntoIterator<Item = &'g str>) -> String {
    let name = identifier(name).to_lowercase();
    let taken = ["gaits", "schema"].into_iter().chain(gaits).any(|taken| taken == name);
    if taken || piaffe_codegen::spec::unusable_as_folder(&name).is_some() { format!("{name}_robot") } else { name }
}

/// What the file calls it, if that is something else.
fn called(out: &mut String, name: &str, source: &Source) {
    if source.name != name {
        put(out, &format!("# \"{}\" in the file", source.name));
    }
}

fn put(out: &mut String, line: &str) {
    out.push_str(line);
    out.push('\n');
}

/// Twelve significant digits: beyond any data sheet, and free of the noise of sums.
pub fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    if rounded.abs() < 1e-15 { "0.0".into() } else { format!("{rounded:?}") }
}

fn vector(v: &Vector3<f64>) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

fn inertial(out: &mut String, body: &Rigid, keys: [&str; 3], length: &str) {
    let i = &body.inertia;
    let _ = write!(out, "mass = {}  # kg\n{length}com = {}  # m\ninertia = {{ ", number(body.mass), vector(&body.com));
    for (k, key) in keys.iter().enumerate() {
        let _ = write!(out, "{key} = {}, ", number(i[(k, k)]));
    }
    // ∫yz dm = −Iyz
    let products = Vector3::new(-i[(1, 2)], -i[(2, 0)], -i[(0, 1)]);
    put(out, &format!("products = {} }}  # kg·m²", vector(&products)));
}

fn joints(out: &mut String, leg: &Leg, platform: &str, motors: &Motors) {
    let mut parent = platform;
    for segment in &leg.segments {
        let Joint { name, source, axis, sign, range, spring, friction, motor } = &segment.joint;
        let turned = if *sign < 0.0 { "  # turned round: the angle is minus the file's" } else { "" };
        put(out, &format!("\n[joints.{name}]"));
        called(out, name, source);
        put(out, &format!("parent = \"{parent}\"\nchild = \"{}\"", segment.link.name));
        put(out, &format!("axis = \"{}\"{turned}", AXES[*axis]));
        put(out, &format!("range = [{}, {}]  # rad", number(range[0]), number(range[1])));
        if !spring.is_none() {
            put(out, &format!("stiffness = {}  # N·m/rad", number(spring.stiffness)));
            put(out, &format!("rest_angle = {}  # rad", number(spring.rest)));
        }
        for (key, unit, x) in [("damping", "N·m·s/rad", friction.damping), ("coulomb", "N·m", friction.coulomb)] {
            if x != 0.0 {
                put(out, &format!("{key} = {}  # {unit}", number(x)));
            }
        }
        put(out, &format!("actuator = \"{}\"", motors.name(motor)));
        parent = &segment.link.name;
    }
}

/// The joints and links of which a part of the text is, by the header above it: what the file calls them, and where they are.
pub fn sources<'r>(robot: &'r Robot, header: &str) -> Vec<&'r Place> {
    let segments = || robot.legs.iter().flat_map(|leg| &leg.segments);
    let motors = Motors::of(robot);
    let Some((kind, name)) = header.trim_matches(['[', ']']).split_once('.') else { return Vec::new() };
    match kind {
        "links" if name == robot.platform_name => vec![&robot.platform_place],
        "links" => segments().filter(|s| s.link.name == name).map(|s| &s.link.source.place).collect(),
        "joints" => segments().filter(|s| s.joint.name == name).map(|s| &s.joint.source.place).collect(),
        "actuators" => {
            segments().filter(|s| motors.name(&s.joint.motor) == name).map(|s| &s.joint.source.place).collect()
        }
        _ => Vec::new(),
    }
}

/// The different motors; joints with the same limits share one.
struct Motors(Vec<Motor>);

impl Motors {
    fn of(robot: &Robot) -> Motors {
        let mut all = Vec::new();
        for joint in robot.legs.iter().flat_map(|l| &l.segments).map(|s| &s.joint) {
            if !all.contains(&joint.motor) {
                all.push(joint.motor);
            }
        }
        Motors(all)
    }

    fn name(&self, motor: &Motor) -> String {
        let index = self.0.iter().position(|m| m == motor).unwrap_or_default();
        if self.0.len() == 1 { "motor".into() } else { format!("motor{}", index + 1) }
    }

    fn write(&self, out: &mut String) {
        for motor in &self.0 {
            let gear = motor.gear.unwrap_or(1.0);
            let speed = number(motor.velocity * gear * 60.0 / std::f64::consts::TAU);
            put(out, &format!("\n[actuators.{}]", self.name(motor)));
            put(
                out,
                &match motor.gear {
                    Some(gear) => format!("gear = {}", number(gear)),
                    None => "gear = 1.0                        # assumed".into(),
                },
            );
            put(out, &format!("max_torque = {}  # N·m", number(motor.effort / gear)));
            put(
                out,
                &format!(
                    "max_speed = {{ unloaded = {speed}, at_max_torque = {speed} }}  # rev/min: {} rad/s at the joint",
                    number(motor.velocity)
                ),
            );
            put(
                out,
                &match motor.rotor {
                    Some(rotor) => format!("rotor_inertia = {}  # kg·m²", number(rotor.at_motor(motor.gear))),
                    None => "rotor_inertia = 0.0               # kg·m²; assumed".into(),
                },
            );
        }
    }
}
