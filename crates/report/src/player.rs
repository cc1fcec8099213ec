//! What the page's animation needs: where everything is, moment by moment. Lengths are in thousandths of a leg's length and forces
//! in thousandths of the robot's weight, so that robots of any size are seen equally well.

use super::plot::rounded;
use super::scale::round_step;
use super::subject::Subject;
use piaffe_model::Mode;
use piaffe_optimizer::four_legs::{Legs, Sharing};
use piaffe_optimizer::walk::{Moment, Point};
use serde_json::{Value, json};

/// Every how many moments of the figures one is shown.
const EVERY: usize = 2;

pub fn data(s: &Subject) -> Value {
    let d = s.description();
    let metre = 1000.0 / d.leg_length();
    let lengths = |points: &[Point]| thousandths(points, metre);
    let names: Vec<Value> = (0..2)
        .flat_map(|leg| {
            d.legs[leg]
                .members
                .iter()
                .map(move |m| json!({ "name": m.name, "leg": leg, "mount": lengths(&[m.mount()]) }))
        })
        .collect();
    let mounts = d.legs.iter().flat_map(|leg| leg.members.iter()).map(|m| metre * m.mount()[2].abs());
    let widest = mounts.fold(0.0, f64::max);
    let of_phase = s.walk.moments.iter().filter(|m| m.phase == 0).count();
    let shown = s.walk.moments.iter().enumerate().filter(|(k, _)| (k % of_phase).is_multiple_of(EVERY));
    let real = Legs::new(s.gait);
    let frames: Vec<Value> = shown
        .map(|(_, m)| {
            let chains: Vec<Value> = (0..2)
                .flat_map(|leg| (0..d.legs[leg].members.len()).map(move |member| (leg, member)))
                .map(|(leg, member)| lengths(&m.chain(d, leg, member)))
                .collect();
            let forces = thousandths(&reactions(s, real.as_ref(), m), 1000.0 / d.weight());
            json!([rounded(m.time), m.mode.stance(), lengths(&[m.platform[0]]), forces, chains])
        })
        .collect();
    json!({
        "duration": s.walk.duration(),
        "travel": metre * s.walk.travel,
        "metre": metre,
        // Between lines on the floor, m, and from its middle to its edge.
        "tick": round_step(0.3 * d.leg_length()),
        "half": widest.max(0.53 * 1000.0) * 1.5,
        "legs": names,
        "frames": frames,
    })
}

/// On every foot, in the order of the legs; equal shares where the real legs are not known.
fn reactions(s: &Subject, real: Option<&Legs>, m: &Moment) -> Vec<Point> {
    let known =
        real.and_then(|legs| Some((legs.whole.description(), legs.instant(m, Sharing::MostRoom).ok()?.reactions)));
    let of = |leg: usize, name: &str| match &known {
        Some((w, reactions)) => w.legs.iter().position(|l| l.name == name).map_or([0.0; 3], |k| reactions[k]),
        None if m.mode == Mode::Stance(leg) => m.force.map(|f| f / s.description().legs[leg].members.len() as f64),
        None => [0.0; 3],
    };
    (0..2)
        .flat_map(|leg| s.description().legs[leg].members.iter().map(move |member| (leg, member.name)))
        .map(|(leg, name)| of(leg, name))
        .collect()
}

/// Coordinates one after another, times `unit`, to hundredths.
fn thousandths(points: &[Point], unit: f64) -> Value {
    points.iter().flatten().map(|x| (100.0 * unit * x).round() / 100.0).collect()
}
