//! `piaffe model`: what was generated for a gait, and its equations.

use super::digits::decimal;
use super::output;
use piaffe_model::{Description, Gait, Mode, Phase, Rotation, Then};
use serde_json::{Value, json};
use std::fmt::Write as _;

pub fn run(gait: &dyn Gait, latex: bool, json: Option<&str>) -> anyhow::Result<bool> {
    if let Some(target) = json {
        output::json_to(target, &as_json(gait.description()))?;
    }
    if json != Some("-") {
        let text = if latex { gait.latex().to_string() } else { as_text(gait.description()) };
        output::bytes_to("-", text.as_bytes())?;
    }
    Ok(true)
}

/// Names of X = [p, q], and what they are.
fn coordinates(d: &Description) -> Vec<(String, String)> {
    let platform = |axis: &&str| (axis.to_string(), "platform's mass centre, m".to_string());
    let mut list: Vec<_> = ["x", "y", "z"][..d.positions()].iter().map(platform).collect();
    list.extend(d.joints.iter().enumerate().map(|(j, joint)| (format!("q{}", j + 1), joint.name.to_string())));
    match d.rotation {
        Rotation::None => {}
        Rotation::Pitch => list.push(("theta".into(), "platform's pitch".into())),
        Rotation::Roll => list.push(("theta".into(), "platform's roll".into())),
    }
    list
}

/// The phases in words.
fn phases(d: &Description) -> String {
    let one = |phase: &Phase| match phase.mode {
        Mode::Stance(leg) => format!("on leg {}", leg + 1),
        Mode::Flight => "in flight".into(),
    };
    let list = d.phases.iter().map(one).collect::<Vec<_>>().join(", ");
    let then = match d.then {
        Then::Mirrored => "then mirrored",
        Then::Repeat => "then again",
    };
    format!("{list}, {then}")
}

fn as_json(d: &Description) -> Value {
    let list = coordinates(d);
    let names = |indices: &mut dyn Iterator<Item = usize>| -> Vec<&str> {
        indices.map(|k| list[d.positions() + k].0.as_str()).collect()
    };
    let bodies = d.bodies.iter().map(|b| {
        json!({
            "name": b.name, "parent": b.parent.map(|p| d.bodies[p].name), "joint": b.coordinate.map(|c| d.joints[c].name),
            "axis": b.parent.map(|_| ["x", "y", "z"][b.axis]), "offset": b.offset, "mass": b.mass, "com": b.com,
            "inertia": b.inertia,
        })
    });
    let legs = d.legs.iter().map(|leg| {
        let members = leg.members.iter().map(|m| json!({ "name": m.name, "mount": m.mount() }));
        let joints: Vec<&str> = d.joints[leg.first_joint..leg.end_joint].iter().map(|j| j.name).collect();
        json!({ "members": members.collect::<Vec<_>>(), "joints": joints, "foot": leg.foot })
    });
    let kernels = d.operations.iter().map(|o| {
        json!({
            "kernel": o.kernel, "derived": o.derived, "flops": o.flops, "divisions": o.divisions, "sincos": o.sincos,
            "bytes": o.bytes,
        })
    });
    json!({
        "gait": d.gait, "robot": d.robot, "fingerprint": d.fingerprint(), "gravity": d.gravity, "mass": d.total_mass(),
        "coordinates": list.iter().map(|(name, what)| json!({ "name": name, "what": what })).collect::<Vec<_>>(),
        "unactuated": names(&mut std::iter::once(d.unactuated)),
        "prescribed": names(&mut (0..d.prescribed()).map(|k| d.prescribed_index(k))),
        "phases": phases(d),
        "legs": legs.collect::<Vec<_>>(),
        "bodies": bodies.collect::<Vec<_>>(),
        "kernels": kernels.collect::<Vec<_>>(),
    })
}

fn as_text(d: &Description) -> String {
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments| {
        let _ = text.write_fmt(arguments);
        text.push('\n');
    };
    line(format_args!("The {} of the {}: {}\n", d.gait, d.robot, phases(d)));
    for (k, (name, what)) in coordinates(d).iter().enumerate() {
        let q = k.checked_sub(d.positions());
        let role = match q {
            None => "from the stance foot (eq. 3)",
            Some(q) if q == d.unactuated => "unactuated: β",
            Some(_) => "prescribed: in Q",
        };
        line(format_args!("{name:<6} {what:<28} {role}"));
    }
    line(format_args!(""));
    for (k, leg) in d.legs.iter().enumerate() {
        let members: Vec<&str> = leg.members.iter().map(|m| m.name).collect();
        line(format_args!("leg {}  stands for {}", k + 1, members.join(" and ")));
    }
    line(format_args!(
        "\n{:<12} {:>8} {:>25} {:>28} {:>32}",
        "body", "mass, kg", "joint from parent, m", "mass centre, m", "inertia x, y, z, kg·m²"
    ));
    for b in d.bodies.iter() {
        let [joint, com] = [b.offset, b.com].map(|v| v.map(|x| decimal(x, 4)).join(" "));
        let inertia = [0, 1, 2].map(|k| decimal(b.inertia[k][k], 4)).join(" ");
        line(format_args!("{:<12} {:>8} {joint:>25} {com:>28} {inertia:>32}", b.name, decimal(b.mass, 4)));
    }
    line(format_args!("{:<12} {:>8}", "in all", decimal(d.total_mass(), 4)));
    line(format_args!(
        "\n{:<24} {:>9} {:>9} {:>9} {:>8} {:>8}",
        "kernel", "derived", "factored", "divisions", "sin, cos", "bytes"
    ));
    for o in d.operations {
        line(format_args!(
            "{:<24} {:>9} {:>9} {:>9} {:>8} {:>8}",
            o.kernel, o.derived, o.flops, o.divisions, o.sincos, o.bytes
        ));
    }
    let sum = |of: fn(&piaffe_model::Operations) -> usize| d.operations.iter().map(of).sum::<usize>();
    line(format_args!(
        "{:<24} {:>9} {:>9} {:>9} {:>8} {:>8}",
        "in all",
        sum(|o| o.derived),
        sum(|o| o.flops),
        sum(|o| o.divisions),
        sum(|o| o.sincos),
        sum(|o| o.bytes)
    ));
    line(format_args!(
        "\nAdditions and multiplications as derived and as factored; divisions; pairs of sine and cosine; source."
    ));
    text
}
