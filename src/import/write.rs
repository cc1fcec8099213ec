//! The specification's text.

use super::legs::{Leg, identifier};
use super::tree::{Body, Tree};
use super::{Import, Rigid};
use nalgebra::Vector3;
use std::fmt::Write;

const AXES: [&str; 3] = ["roll", "yaw", "pitch"];

pub fn specification(name: &str, tree: &Tree, legs: &[Leg]) -> Import {
    let mut notes = tree.notes.clone();
    notes.insert(0, "visual and collision geometry is dropped".into());
    notes.push("gears are taken to be 1, so that torques and speeds are the joints'; rotor inertias to be 0".into());
    notes.push("the greatest torque is taken to be there at any speed: URDF knows no line between them".into());
    for leg in legs {
        notes.push(format!("leg `{}` ends in a point: the origin of link `{}`", leg.name, leg.foot_link));
    }
    let mut out = String::from("#:schema ../schema/robot.schema.json\n");
    put(
        &mut out,
        &format!(
            "# Imported from the URDF of \"{}\". Axes: x forward, y up, z to the right. Angles are URDF's,",
            plain(name)
        ),
    );
    put(&mut out, "# with the opposite sign where the axis is said to be turned round.");
    put(&mut out, "#");
    for note in &notes {
        put(&mut out, &format!("# - {note}"));
    }
    put(&mut out, &format!("\nname = \"{}\"\ngravity = 9.81                    # m/s²; assumed", plain(name)));
    let platform = &tree.bodies[0];
    put(&mut out, &format!("\n[links.{}]", identifier(&platform.name)));
    inertial(&mut out, &platform.rigid, &Vector3::zeros(), ["roll", "yaw", "pitch"], "");
    for leg in legs {
        for (depth, b) in leg.chain.iter().enumerate() {
            let body = &tree.bodies[*b];
            let end = leg.chain.get(depth + 1).map_or(leg.foot, |next| tree.bodies[*next].origin) - body.origin;
            put(&mut out, &format!("\n[links.{}]", identifier(&body.name)));
            let length = format!(
                "length = {}  # m, to the {}\n",
                vector(&end),
                if depth + 1 < leg.chain.len() { "next joint" } else { "foot" }
            );
            inertial(&mut out, &body.rigid, &body.origin, ["lateral", "axial", "swing"], &length);
        }
    }
    for body in &tree.bodies {
        joint(&mut out, tree, body);
    }
    put(&mut out, "\n[legs]");
    for leg in legs {
        let first = &tree.bodies[leg.chain[0]];
        let joint = first.joint.as_ref().map(|j| identifier(&j.name)).unwrap_or_default();
        put(&mut out, &format!("{} = {{ mount = {}, first_joint = \"{joint}\" }}", leg.name, vector(&first.origin)));
    }
    actuators(&mut out, tree);
    let gaits = gaits(tree, legs);
    if gaits.is_empty() {
        notes.push("which legs move together is not evident: write a gait".into());
    } else {
        notes.push("the limits of the gaits (friction, clearance, durations) are assumed".into());
    }
    Import { folder: identifier(name).to_lowercase(), robot: out, gaits, notes }
}

fn put(out: &mut String, line: &str) {
    out.push_str(line);
    out.push('\n');
}

fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_control() || matches!(c, '"' | '\\') { '_' } else { c }).collect()
}

/// Twelve significant digits: beyond any data sheet, and free of the noise of sums.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    if rounded.abs() < 1e-15 { "0.0".into() } else { format!("{rounded:?}") }
}

fn vector(v: &Vector3<f64>) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

fn inertial(out: &mut String, body: &Rigid, origin: &Vector3<f64>, keys: [&str; 3], length: &str) {
    let i = &body.inertia;
    let _ = write!(
        out,
        "mass = {}  # kg\n{length}com = {}  # m\ninertia = {{ ",
        number(body.mass),
        vector(&(body.com - origin))
    );
    for (k, key) in keys.iter().enumerate() {
        let _ = write!(out, "{key} = {}, ", number(i[(k, k)]));
    }
    // ∫yz dm = −Iyz
    let products = Vector3::new(-i[(1, 2)], -i[(2, 0)], -i[(0, 1)]);
    put(out, &format!("products = {} }}  # kg·m²", vector(&products)));
}

fn joint(out: &mut String, tree: &Tree, body: &Body) {
    let (Some(joint), Some(parent)) = (&body.joint, body.parent) else { return };
    let name = identifier(&joint.name);
    let turned = if joint.sign < 0.0 { "  # turned round: the angle is minus URDF's" } else { "" };
    put(out, &format!("\n[joints.{name}]"));
    put(
        out,
        &format!("parent = \"{}\"\nchild = \"{}\"", identifier(&tree.bodies[parent].name), identifier(&body.name)),
    );
    put(out, &format!("axis = \"{}\"{turned}", AXES[joint.axis]));
    put(out, &format!("range = [{}, {}]  # rad", number(joint.range[0]), number(joint.range[1])));
    put(out, &format!("actuator = \"{}\"", motor(tree, joint.effort, joint.velocity)));
}

/// Joints with the same limits share a motor.
fn motor(tree: &Tree, effort: f64, velocity: f64) -> String {
    let all = motors(tree);
    let index = all.iter().position(|m| *m == (effort, velocity)).unwrap_or_default();
    if all.len() == 1 { "motor".into() } else { format!("motor{}", index + 1) }
}

fn motors(tree: &Tree) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    for joint in tree.bodies.iter().filter_map(|b| b.joint.as_ref()) {
        if !all.contains(&(joint.effort, joint.velocity)) {
            all.push((joint.effort, joint.velocity));
        }
    }
    all
}

fn actuators(out: &mut String, tree: &Tree) {
    for (effort, velocity) in motors(tree) {
        let speed = number(velocity * 60.0 / std::f64::consts::TAU);
        put(out, &format!("\n[actuators.{}]", motor(tree, effort, velocity)));
        put(out, "gear = 1.0                        # assumed");
        put(out, &format!("max_torque = {}  # N·m", number(effort)));
        put(
            out,
            &format!(
                "max_speed = {{ unloaded = {speed}, at_max_torque = {speed} }}  # rev/min: {} rad/s",
                number(velocity)
            ),
        );
        put(out, "rotor_inertia = 0.0               # kg·m²; assumed");
    }
}

/// A trot for four legs, a walk for two; what leaves their plane is locked.
fn gaits(tree: &Tree, legs: &[Leg]) -> Vec<(String, String)> {
    let joint = |b: &usize| tree.bodies[*b].joint.as_ref();
    let aside: Vec<String> = legs
        .iter()
        .flat_map(|leg| leg.chain.iter().filter_map(joint))
        .filter(|j| j.axis != 2)
        .map(|j| format!("{} = 0.0", identifier(&j.name)))
        .collect();
    let locked = if aside.is_empty() { String::new() } else { format!("locked = {{ {} }}\n", aside.join(", ")) };
    let mount = |leg: &Leg| tree.bodies[leg.chain[0]].origin;
    let reach = legs.iter().map(|l| (l.foot - mount(l)).norm()).fold(0.0, f64::max);
    let weight = 9.81 * tree.bodies.iter().map(|b| b.rigid.mass).sum::<f64>();
    let limits = format!(
        "\n[limits]                                  # all assumed\nfriction = 0.6                            # tangential / vertical force\n\
         min_vertical_force = {}                 # N\nswing_clearance = {}                   # m\nhalf_step_duration = [0.05, 2.0]          # s\n",
        number((0.05 * weight).round()),
        number((0.05 * reach * 1000.0).round() / 1000.0)
    );
    let schema = "#:schema ../../schema/gait.schema.json\n";
    match legs {
        [a, b] => {
            let text = format!(
                "{schema}# Walking: one leg after the other; the platform pitches.\n\nvirtual_legs = [[\"{}\"], [\"{}\"]]\n{locked}\
                 platform = {{ moves = [\"x\", \"y\"], rotates = \"pitch\" }}\nunactuated = \"platform\"\nhalf_steps = \"mirrored\"\n{limits}",
                a.name, b.name
            );
            vec![("walk.toml".into(), text)]
        }
        [_, _, _, _] => {
            let middle = legs.iter().map(|l| mount(l).x).sum::<f64>() / 4.0;
            let at = |fore: bool, right: bool| {
                legs.iter().find(|l| (mount(l).x > middle) == fore && (mount(l).z > 0.0) == right)
            };
            let (Some(fl), Some(fr), Some(hl), Some(hr)) =
                (at(true, false), at(true, true), at(false, false), at(false, true))
            else {
                return Vec::new();
            };
            let Some(haunch) = fl.chain.iter().filter_map(joint).find(|j| j.axis == 2) else { return Vec::new() };
            let text = format!(
                "{schema}# Trot: the legs of a diagonal move together; the platform stays level.\n\n\
                 virtual_legs = [[\"{}\", \"{}\"], [\"{}\", \"{}\"]]\n{locked}platform = {{ moves = [\"x\", \"y\"], rotates = \"none\" }}\n\
                 unactuated = \"leg1.{}\"\nhalf_steps = \"mirrored\"\n{limits}",
                fl.name,
                hr.name,
                fr.name,
                hl.name,
                identifier(&haunch.name)
            );
            vec![("trot.toml".into(), text)]
        }
        _ => Vec::new(),
    }
}
