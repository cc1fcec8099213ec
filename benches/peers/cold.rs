//! One cold optimization per line of input, for `run.py`: the same start and the same problem as for others.
//!
//! Reads lines `GAIT CRITERION SPEED [START]`, answers each with a line of JSON: the numbers of the gait, the
//! walk that it starts from (the first without START), and the time and cost of one optimization from it, receipt included.

use piaffe::cycle::Cycle;
use piaffe::gaits::GAITS;
use piaffe::model::{Description, Rotation};
use piaffe::motion::Criterion;
use piaffe::search::local::Task;
use piaffe::search::multi_start::start;
use piaffe::sqp::Control;
use piaffe::verdict::GRID;
use piaffe::verify::verify;
use serde_json::{Value, json};
use std::io::BufRead;
use std::time::Instant;

fn main() {
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        match answer(&line) {
            Some(answer) => println!("{answer}"),
            None => println!("{}", json!({"error": format!("`{line}` is not GAIT CRITERION SPEED [START]")})),
        }
    }
}

fn answer(line: &str) -> Option<Value> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (gait, criterion, speed, index) = match words[..] {
        [gait, criterion, speed] => (gait, criterion, speed, 0),
        [gait, criterion, speed, index] => (gait, criterion, speed, index.parse().ok()?),
        _ => return None,
    };
    let gait = GAITS.iter().copied().find(|g| g.description().gait == gait)?;
    let criterion = Criterion::ALL.into_iter().find(|c| c.name() == criterion)?;
    let speed: f64 = speed.parse().ok()?;

    let started = Instant::now();
    let theta = start(gait, criterion, speed, 1, index);
    let local = Task { gait, criterion, speed }.descend(&theta, &mut |_| Control::Continue);
    let receipt = verify(gait.description(), &local.motion, speed, GRID);
    let seconds = started.elapsed().as_secs_f64();

    let mut cycle = Cycle::new(gait, criterion, speed);
    cycle.simulate(&theta).ok()?;
    let cost = receipt.ok().filter(|_| local.status.is_optimal()).map(|r| r.costs.of(criterion));
    Some(json!({"description": numbers(gait.description()), "start": cycle.motion(), "seconds": seconds, "cost": cost}))
}

fn numbers(d: &Description) -> Value {
    let bodies: Vec<Value> = d
        .bodies
        .iter()
        .map(|b| {
            json!({"parent": b.parent, "coordinate": b.coordinate, "axis": b.axis, "offset": b.offset, "mass": b.mass,
            "com": b.com, "inertia": b.inertia})
        })
        .collect();
    let joints: Vec<Value> = d
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            json!({"range": joint.range, "max_torque": joint.max_torque, "unloaded_speed": joint.unloaded_speed,
            "loaded_speed": joint.loaded_speed, "rotor": joint.gear * joint.gear * joint.rotor_inertia,
            "hangs": d.hangs_on_platform(j)})
        })
        .collect();
    let legs: Vec<Value> = d.legs.iter().map(|l| json!({"body": l.foot_body, "foot": l.foot})).collect();
    let swapped: Vec<(usize, f64)> = (0..d.orientations()).map(|k| d.swapped(k)).collect();
    let l = &d.limits;
    json!({"gravity": d.gravity, "spatial": d.is_spatial(), "order": d.polynomial_order, "unactuated": d.unactuated,
        "rotation": match d.rotation { Rotation::None => Value::Null, Rotation::Roll => json!(0), Rotation::Pitch => json!(2) },
        "phases": d.phases.len(), "bodies": bodies, "joints": joints, "legs": legs, "swapped": swapped,
        "friction": l.friction, "min_vertical_force": l.min_vertical_force, "swing_clearance": l.swing_clearance,
        "durations": d.phases.iter().map(|phase| phase.duration).collect::<Vec<_>>(), "min_height": l.min_platform_height})
}
