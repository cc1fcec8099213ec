//! The real robot for MuJoCo, in the pose and with the speed in which a walk begins. World axes have z up.

use super::frame;
use super::xml::{Xml, numbers};
use piaffe_model::Rotation;
use piaffe_model::units::Units;
use piaffe_model::{Body, Description, Leg, Member};
use piaffe_optimizer::walk::{Moment, Walk};

/// Links can be slender rods without inertia about themselves; MuJoCo wants some: this share of the robot's mass times the square
/// of its leg.
const LEAST_INERTIA: f64 = 1e-9;
/// Radii of the feet and the links, which are points and lines here, and half the platform's height, as shares of the leg. What is
/// round touches the ground beside the point as soon as a link leans: the smaller the less.
const FOOT: f64 = 1.0 / 500.0;
const LINK: f64 = 2.0 / 75.0;
const PLATFORM: f64 = 1.0 / 15.0;
/// Time step as a share of √(leg/gravity).
const TIME_STEP: f64 = 3e-3;

/// Of a contact: sliding, and what spinning and rolling have if nothing is said, m. Points do neither.
fn friction(d: &Description) -> String {
    numbers(&[d.limits.friction, 0.005, 0.0001])
}

/// A number that need not be exact.
fn about(x: f64) -> String {
    format!("{x:.1e}").parse().unwrap_or(x).to_string()
}

pub fn mjcf(walk: &Walk) -> String {
    let d = walk.description;
    let mut xml = Xml::new();
    xml.element("mujoco", &[("model", d.robot.into())], |x| {
        x.comment("Axes: x forward, y left, z up. Torques are those of one real leg's joint.");
        let units = Units::new(d);
        let least = about(LEAST_INERTIA * units.inertia());
        let compiler = [("angle", "radian".into()), ("autolimits", "true".into()), ("boundinertia", least)];
        x.leaf("compiler", &compiler);
        x.leaf("option", &[("gravity", numbers(&[0.0, 0.0, -d.gravity])), ("timestep", about(TIME_STEP * units.time))]);
        let links = [("contype", "0".into()), ("conaffinity", "0".into()), ("rgba", "0.6 0.65 0.7 1".into())];
        x.element("default", &[], |x| x.leaf("geom", &links));
        x.element("worldbody", &[], |x| {
            x.leaf("light", &[("pos", "0 0 3".into()), ("dir", "0 0 -1".into())]);
            let ground = [
                ("name", "ground".into()),
                ("type", "plane".into()),
                ("size", "0 0 0.5".into()),
                ("contype", "1".into()),
                ("conaffinity", "1".into()),
                ("friction", friction(d)),
                ("rgba", "0.9 0.92 0.94 1".into()),
            ];
            x.leaf("geom", &ground);
            platform(x, d);
        });
        x.element("actuator", &[], |x| {
            each_joint(d, |name, joint, members| {
                let most = d.joints[joint].max_torque / members;
                let range = numbers(&[-most, most]);
                x.leaf("motor", &[("name", name.into()), ("joint", name.into()), ("ctrlrange", range)]);
            });
        });
        x.element("keyframe", &[], |x| x.leaf("key", &start(d, &walk.moments[0])));
    });
    xml.finish()
}

/// Calls with each real joint: its name, the virtual leg's joint, how many share what that does.
fn each_joint(d: &Description, mut call: impl FnMut(&str, usize, f64)) {
    for leg in &d.legs {
        for member in leg.members.iter() {
            for (name, joint) in member.joints.iter().zip(leg.first_joint..) {
                call(name, joint, leg.members.len() as f64);
            }
        }
    }
}

fn inertial(x: &mut Xml, mass: f64, com: [f64; 3], inertia: &[[f64; 3]; 3]) {
    let t = frame::tensor(inertia);
    let at = [("mass", mass.to_string()), ("pos", numbers(&frame::vector(com)))];
    let diagonal = t[0][1] == 0.0 && t[0][2] == 0.0 && t[1][2] == 0.0;
    let tensor = match diagonal {
        true => ("diaginertia", numbers(&[t[0][0], t[1][1], t[2][2]])),
        false => ("fullinertia", numbers(&[t[0][0], t[1][1], t[2][2], t[0][1], t[0][2], t[1][2]])),
    };
    x.leaf("inertial", &[at[0].clone(), at[1].clone(), tensor]);
}

fn platform(x: &mut Xml, d: &Description) {
    let (body, length) = (&d.bodies[0], d.leg_length());
    x.element("body", &[("name", body.name.into())], |x| {
        x.leaf("freejoint", &[("name", "base".into())]);
        inertial(x, body.mass, body.com, &body.inertia);
        let mounts: Vec<[f64; 3]> =
            d.legs.iter().flat_map(|l| l.members.iter()).map(|m| frame::vector(m.mount())).collect();
        let half = |k: usize| mounts.iter().map(|m| m[k].abs()).fold(0.5 * PLATFORM * length, f64::max);
        x.leaf("geom", &[("type", "box".into()), ("size", numbers(&[half(0), half(1), PLATFORM * length]))]);
        for leg in &d.legs {
            for member in leg.members.iter() {
                limb(x, d, leg, member, &member.bodies, &member.joints);
            }
        }
    });
}

/// A link, with the rest of the leg inside.
fn limb(x: &mut Xml, d: &Description, leg: &Leg, member: &Member, bodies: &[Body], joints: &[&str]) {
    let (Some((body, rest)), Some((name, names))) = (bodies.split_first(), joints.split_first()) else { return };
    let end = frame::vector(rest.first().map_or(member.foot, |next| next.offset));
    let joint = body.coordinate.unwrap_or(leg.first_joint);
    let limits = &d.joints[joint];
    let share = leg.members.len() as f64;
    x.element("body", &[("name", body.name.into()), ("pos", numbers(&frame::vector(body.offset)))], |x| {
        let mut attributes = vec![
            ("name", name.to_string()),
            ("axis", numbers(&frame::axis(body.axis))),
            ("range", numbers(&limits.range)),
            ("armature", (limits.rotor_inertia / share).to_string()),
        ];
        if limits.has_spring() {
            attributes.push(("stiffness", (limits.stiffness / share).to_string()));
            attributes.push(("springref", limits.rest.to_string()));
        }
        if limits.has_friction() {
            attributes.push(("damping", (limits.damping / share).to_string()));
            attributes.push(("frictionloss", (limits.coulomb / share).to_string()));
        }
        x.leaf("joint", &attributes);
        inertial(x, body.mass, body.com, &body.inertia);
        let bone = numbers(&[[0.0; 3], end].concat());
        x.leaf("geom", &[("type", "capsule".into()), ("fromto", bone), ("size", about(LINK * d.leg_length()))]);
        if rest.is_empty() {
            x.leaf("site", &[("name", super::foot_name(d, member)), ("pos", numbers(&end))]);
            // The link ends where the sphere does.
            let (radius, length) = (FOOT * d.leg_length(), end.iter().map(|x| x * x).sum::<f64>().sqrt());
            let centre = end.map(|x| x * (1.0 - radius / length.max(radius)));
            let foot = [
                ("type", "sphere".into()),
                ("size", radius.to_string()),
                ("pos", numbers(&centre)),
                ("contype", "1".into()),
                ("conaffinity", "1".into()),
                ("friction", friction(d)),
            ];
            x.leaf("geom", &foot);
        }
        limb(x, d, leg, member, rest, names);
    });
}

/// Positions and velocities of a moment, in MuJoCo's order.
fn start(d: &Description, m: &Moment) -> [(&'static str, String); 3] {
    let (angle, rate) = match d.rotation {
        Rotation::None => (0.0, 0.0),
        _ => (m.q[d.joints()], m.qd[d.joints()]),
    };
    let axis = match d.rotation {
        Rotation::Roll => frame::axis(0),
        _ => frame::axis(2),
    };
    let (sin, cos) = libm::sincos(0.5 * angle);
    let mut position = frame::vector(m.platform[0]).to_vec();
    position.push(cos);
    position.extend(axis.map(|a| sin * a));
    let mut velocity = frame::vector(m.platform[1]).to_vec();
    velocity.extend(axis.map(|a| rate * a));
    each_joint(d, |_, joint, _| {
        position.push(m.q[joint]);
        velocity.push(m.qd[joint]);
    });
    [("name", "start".into()), ("qpos", numbers(&position)), ("qvel", numbers(&velocity))]
}
