//! A lifted motion as a table, and as JSON.

use super::lift::Lift;
use super::limits::Limits;
use crate::walk::Point;
use serde::Serialize;
use serde_json::{Value, json};

const AXES: [&str; 3] = ["x", "y", "z"];

/// One row of all numbers, which the table's columns are made of.
#[derive(Serialize)]
struct Row {
    t: f64,
    /// Of all phases of the step, 1-based.
    phase: usize,
    /// Platform's mass centre, its velocity and acceleration; world axes.
    position: Point,
    velocity: Point,
    acceleration: Point,
    /// How the platform is turned: w, x, y, z.
    quaternion: [f64; 4],
    /// Angular velocity and acceleration in the platform's axes.
    omega: Point,
    omegad: Point,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    torque: Vec<f64>,
    /// On every foot, world axes.
    force: Vec<Point>,
    /// Least margin of the limits on the legs in support, in flight of all legs.
    margin: f64,
    /// The largest part that the equations of motion lack, of weight or weight × leg length: nothing but rounding, if reactions
    /// meet them at all.
    remainder: f64,
}

fn rows<'l>(lift: &'l Lift<'_>) -> impl Iterator<Item = Row> + 'l {
    lift.instants.iter().map(|i| {
        let p = &i.posture;
        let three = |v: &[f64], at: usize| [v[at], v[at + 1], v[at + 2]];
        Row {
            t: i.time,
            phase: i.phase + 1,
            position: p.position,
            velocity: p.outside(three(&p.u, 0)),
            acceleration: p.outside(three(&p.ud, 0)),
            quaternion: p.quaternion(),
            omega: p.omega(),
            omegad: three(&p.ud, 3),
            q: p.q.clone(),
            qd: p.rates().to_vec(),
            qdd: p.ud[6..].to_vec(),
            torque: i.torque.clone(),
            force: i.reactions.clone(),
            margin: i.room,
            remainder: i.lack.share,
        }
    })
}

fn names(lift: &Lift) -> (Vec<&'static str>, Vec<&'static str>) {
    let w = lift.legs.whole.description();
    (w.joints.iter().map(|j| j.name).collect(), w.legs.iter().map(|l| l.name).collect())
}

/// A row per moment and one per impact (the last of a phase, where the impulses are not zero); SI units.
pub fn csv(lift: &Lift) -> String {
    let (joints, legs) = names(lift);
    let mut header: Vec<String> = vec!["t".into(), "phase".into()];
    for of in ["", "d", "dd"] {
        header.extend(AXES.map(|axis| format!("{axis}{of}")));
    }
    header.extend(["w", "x", "y", "z"].map(|part| format!("quaternion_{part}")));
    for of in ["omega", "omegad"] {
        header.extend(AXES.map(|axis| format!("{of}_{axis}")));
    }
    for of in ["q", "qd", "qdd", "torque"] {
        header.extend(joints.iter().map(|name| format!("{of}_{name}")));
    }
    for of in ["force", "impulse"] {
        header.extend(legs.iter().flat_map(|leg| AXES.map(|axis| format!("{of}_{leg}_{axis}"))));
    }
    header.extend(["margin", "remainder"].map(String::from));
    let mut text = header.join(",");
    text.push('\n');
    for (row, instant) in rows(lift).zip(&lift.instants) {
        let impact = lift.impacts.iter().find(|i| (i.phase, i.time) == (instant.phase, instant.time));
        let impulse = impact.map_or(vec![0.0; 3 * legs.len()], |i| i.impulses.concat());
        let platform = [&[row.t, row.phase as f64][..], &row.position, &row.velocity, &row.acceleration].concat();
        let turn = [&row.quaternion[..], &row.omega, &row.omegad].concat();
        let joints = [row.q, row.qd, row.qdd, row.torque].concat();
        let all = [platform, turn, joints, row.force.concat(), impulse, vec![row.margin, row.remainder]].concat();
        text += &all.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// The same with the impacts by themselves: velocities before and after, impulses.
pub fn json(lift: &Lift) -> Value {
    let (joints, legs) = names(lift);
    let limits = Limits { legs: &lift.legs };
    let impacts = lift.impacts.iter().map(|i| {
        let after: Vec<f64> = i.posture.u.iter().zip(&i.change).map(|(u, change)| u + change).collect();
        let speeds = |u: &[f64]| {
            json!({
                "velocity": i.posture.outside([u[0], u[1], u[2]]),
                "omega": &u[3..6],
                "qd": &u[6..],
            })
        };
        json!({
            "t": i.time,
            "phase": i.phase + 1,
            "before": speeds(&i.posture.u),
            "after": speeds(&after),
            "impulse": i.impulses,
            "margin": i.margin,
            "remainder": i.lack.share,
            "binding": i.binding.iter().map(|(l, weight)| json!({ "limit": limits.name(*l), "weight": weight })).collect::<Vec<_>>(),
        })
    });
    json!({
        "robot": lift.legs.description.robot,
        "gait": lift.legs.description.key,
        "axes": "world x forward, y up, z to the right; omega and omegad in the platform's axes; rad, m, s, N",
        "joints": joints,
        "legs": legs,
        "durations": lift.durations,
        "travel": lift.travel,
        "moments": rows(lift).collect::<Vec<_>>(),
        "impacts": impacts.collect::<Vec<_>>(),
    })
}
