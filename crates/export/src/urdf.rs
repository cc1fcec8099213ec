//! The real robot as URDF. Axes: x forward, y left, z up; the base is the platform, at its mass centre.

use super::frame;
use super::xml::{Xml, numbers};
use piaffe_model::{Body, Description, Leg, Member};

pub fn urdf(d: &Description) -> String {
    let mut xml = Xml::new();
    xml.element("robot", &[("name", d.robot.into())], |x| {
        x.comment("Efforts are those of one real leg's joint; the speed limit is the unloaded one.");
        x.comment(&format!("URDF knows no gravity: this robot's is {} m/s².", d.gravity));
        let base = &d.bodies[0];
        link(x, base.name.into(), Some(base));
        for leg in &d.legs {
            for member in leg.members.iter() {
                limb(x, d, leg, member);
            }
        }
    });
    xml.finish()
}

fn limb(x: &mut Xml, d: &Description, leg: &Leg, member: &Member) {
    let mut parent = d.bodies[0].name.to_string();
    for (body, name) in member.bodies.iter().zip(member.joints.iter()) {
        let child = body.name.to_string();
        link(x, child.clone(), Some(body));
        let joint = body.coordinate.unwrap_or(leg.first_joint);
        let limits = &d.joints[joint];
        x.element("joint", &[("name", name.to_string()), ("type", "revolute".into())], |x| {
            ends(x, &parent, &child, body.offset);
            x.leaf("axis", &[("xyz", numbers(&frame::axis(body.axis)))]);
            let limit = [
                ("lower", limits.range[0].to_string()),
                ("upper", limits.range[1].to_string()),
                ("effort", (limits.max_torque / leg.members.len() as f64).to_string()),
                ("velocity", limits.unloaded_speed.to_string()),
            ];
            x.leaf("limit", &limit);
            if limits.has_friction() {
                let of_joint = |all: f64| (all / leg.members.len() as f64).to_string();
                let friction = [("damping", of_joint(limits.damping)), ("friction", of_joint(limits.coulomb))];
                x.leaf("dynamics", &friction);
            }
        });
        if limits.has_spring() {
            let stiffness = limits.stiffness / leg.members.len() as f64;
            let rest = limits.rest;
            x.comment(&format!(
                "URDF knows no springs: {name} has one of {stiffness} N·m/rad that rests at {rest} rad."
            ));
        }
        transmission(x, name, limits.gear, limits.rotor_inertia / leg.members.len() as f64);
        parent = child;
    }
    let foot = super::foot_name(d, member);
    link(x, foot.clone(), None);
    let name = format!("{foot}_fixed");
    x.element("joint", &[("name", name), ("type", "fixed".into())], |x| ends(x, &parent, &foot, member.foot));
}

/// The motor of a joint: its gear, and of its rotor what the joint feels, kg·m².
fn transmission(x: &mut Xml, joint: &str, gear: f64, reflected: f64) {
    x.element("transmission", &[("name", format!("{joint}_transmission"))], |x| {
        x.text("type", "transmission_interface/SimpleTransmission");
        x.element("joint", &[("name", joint.into())], |x| {
            x.text("hardwareInterface", "hardware_interface/EffortJointInterface");
        });
        x.element("actuator", &[("name", format!("{joint}_motor"))], |x| {
            x.text("mechanicalReduction", &gear.to_string());
            x.text("motorInertia", &(reflected / (gear * gear)).to_string());
        });
    });
}

fn ends(x: &mut Xml, parent: &str, child: &str, at: [f64; 3]) {
    x.leaf("parent", &[("link", parent.into())]);
    x.leaf("child", &[("link", child.into())]);
    x.leaf("origin", &[("xyz", numbers(&frame::vector(at)))]);
}

/// A link; one without a body is a point.
fn link(x: &mut Xml, name: String, body: Option<&Body>) {
    let Some(body) = body else { return x.leaf("link", &[("name", name)]) };
    x.element("link", &[("name", name)], |x| {
        x.element("inertial", &[], |x| {
            x.leaf("origin", &[("xyz", numbers(&frame::vector(body.com)))]);
            x.leaf("mass", &[("value", body.mass.to_string())]);
            let t = frame::tensor(&body.inertia);
            let entry = |name, i: usize, k: usize| (name, (t[i][k] + 0.0).to_string());
            let tensor = [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)];
            x.leaf("inertia", &tensor.map(|(name, i, k)| entry(name, i, k)));
        });
    });
}
