//! What the page's animation needs: where everything is, moment by moment. Positions are in mm, forces in N.

use super::subject::Subject;
use crate::four_legs::Legs;
use crate::walk::{Moment, Point};
use serde_json::{Value, json};

/// Every how many moments of the figures one is shown.
const EVERY: usize = 2;

pub fn data(s: &Subject) -> Value {
    let d = s.description();
    let names: Vec<Value> = (0..2)
        .flat_map(|leg| {
            d.legs[leg]
                .members
                .iter()
                .map(move |m| json!({ "name": m.name, "leg": leg, "mount": millimetres(&[m.mount()]) }))
        })
        .collect();
    let per_half = s.walk.moments.iter().filter(|m| m.half_step == 0).count();
    let shown = s.walk.moments.iter().enumerate().filter(|(k, _)| (k % per_half).is_multiple_of(EVERY));
    let real = Legs::new(s.gait);
    let frames: Vec<Value> = shown
        .map(|(_, m)| {
            let chains: Vec<Value> = (0..2)
                .flat_map(|leg| (0..d.legs[leg].members.len()).map(move |member| (leg, member)))
                .map(|(leg, member)| millimetres(&m.chain(d, leg, member)))
                .collect();
            let forces: Vec<f64> =
                reactions(s, real.as_ref(), m).iter().flatten().map(|f| (10.0 * f).round() / 10.0).collect();
            json!([(m.time * 1e6).round() / 1e6, m.stance, millimetres(&[m.platform[0]]), forces, chains])
        })
        .collect();
    json!({
        "duration": s.walk.duration(),
        "travel": 1000.0 * s.walk.travel,
        "weight": d.total_mass() * d.gravity,
        "length": 1000.0 * d.leg_length(),
        "legs": names,
        "frames": frames,
    })
}

/// On every foot, in the order of the legs; equal shares where the real legs are not known.
fn reactions(s: &Subject, real: Option<&Legs>, m: &Moment) -> Vec<Point> {
    let known = real.and_then(|legs| Some((legs.whole.description(), legs.support(m).ok()?.reactions)));
    let of = |leg: usize, name: &str| match &known {
        Some((w, reactions)) => w.legs.iter().position(|l| l.name == name).map_or([0.0; 3], |k| reactions[k]),
        None if leg == m.stance => m.force.map(|f| f / s.description().legs[leg].members.len() as f64),
        None => [0.0; 3],
    };
    (0..2)
        .flat_map(|leg| s.description().legs[leg].members.iter().map(move |member| (leg, member.name)))
        .map(|(leg, name)| of(leg, name))
        .collect()
}

/// Coordinates one after another, to hundredths of a millimetre.
fn millimetres(points: &[Point]) -> Value {
    points.iter().flatten().map(|x| (x * 1e5).round() / 100.0).collect()
}
