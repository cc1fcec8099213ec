//! What the page's animation needs: where everything is, moment by moment. Positions are in mm, forces in N.

use super::subject::Subject;
use crate::walk::Point;
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
    let frames: Vec<Value> = shown
        .map(|(_, m)| {
            let chains: Vec<Value> = (0..2)
                .flat_map(|leg| (0..d.legs[leg].members.len()).map(move |member| (leg, member)))
                .map(|(leg, member)| millimetres(&m.chain(d, leg, member)))
                .collect();
            let feet = d.legs[m.stance].members.len() as f64;
            let share = m.force.map(|f| (10.0 * f / feet).round() / 10.0);
            json!([(m.time * 1e6).round() / 1e6, m.stance, millimetres(&[m.platform[0]]), share, chains])
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

/// Coordinates one after another, to hundredths of a millimetre.
fn millimetres(points: &[Point]) -> Value {
    points.iter().flatten().map(|x| (x * 1e5).round() / 100.0).collect()
}
