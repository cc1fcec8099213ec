//! A robot of a specification drawn as it stands, so that a mistake in it is seen: from its right and from behind, with its
//! joints, feet and mass centre. It needs no generated code.

use piaffe_codegen::spec::{Axis, Leg, Robot};
use std::fmt::Write;

/// Where a leg's joints are, and its foot at the end, in the platform's frame, m.
type Chain = Vec<[f64; 3]>;

/// Share of the greatest depth at which it stands.
const CROUCH: f64 = 0.9;
/// Pixels of the drawing's longer side, and around it.
const SIZE: f64 = 420.0;
const MARGIN: f64 = 36.0;
/// A view's words need as much.
const NARROW: f64 = 290.0;

/// The drawing as SVG.
pub fn svg(robot: &Robot) -> String {
    let height = robot.legs.iter().map(|leg| -deepest(leg)).fold(f64::INFINITY, f64::min) * CROUCH;
    let legs: Vec<Chain> = robot.legs.iter().map(|leg| stand(leg, -height)).collect();
    let ground = legs.iter().filter_map(|chain| chain.last()).map(|foot| foot[1]).fold(f64::INFINITY, f64::min);
    let com = robot.platform.com;
    let points = || legs.iter().flatten().chain([&com]);
    let reach = |axis: usize| {
        let all = || points().map(move |p| p[axis]);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    };
    let (x, y, z) = (reach(0), reach(1), reach(2));
    let widest = (x[1] - x[0]).max(y[1] - ground).max(z[1] - z[0]).max(1e-9);
    let scale = SIZE / widest;
    let width = |r: [f64; 2]| ((r[1] - r[0]) * scale + 2.0 * MARGIN).max(NARROW);
    let tall = (y[1] - ground) * scale + 2.0 * MARGIN + 20.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0}\" height=\"{tall:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width(x) + width(z)
    );
    let views = [
        (0, x, 0.0, "from the right; forward is to the right"),
        (2, z, width(x), "from behind; its right is to the right"),
    ];
    for (axis, range, left, words) in views {
        let at = |p: &[f64; 3]| [left + MARGIN + (p[axis] - range[0]) * scale, 20.0 + MARGIN + (y[1] - p[1]) * scale];
        let _ = writeln!(out, "<text x=\"{:.1}\" y=\"18\">{words}</text>", left + MARGIN);
        let level = 20.0 + MARGIN + (y[1] - ground) * scale;
        let (from, to) = (left + MARGIN / 2.0, left + width(range) - MARGIN / 2.0);
        let _ = writeln!(out, "<path d=\"M{from:.1} {level:.1}H{to:.1}\" stroke=\"#999\"/>");
        // The platform: its legs' mounts, about its mass centre.
        for chain in &legs {
            let [[a, b], [c, d]] = [at(&com), at(&chain[0])];
            let _ = writeln!(
                out,
                "<path d=\"M{a:.1} {b:.1}L{c:.1} {d:.1}\" stroke=\"#bbb\" stroke-width=\"6\" stroke-linecap=\"round\"/>"
            );
        }
        let mut labels: Vec<f64> = Vec::new();
        for (leg, chain) in robot.legs.iter().zip(&legs).rev() {
            let colour = if leg.mount[2] < 0.0 { "#c0632b" } else { "#2b6cb0" };
            let path: Vec<String> = chain.iter().map(at).map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
            let _ =
                writeln!(out, "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\"/>", path.join("L"));
            for point in chain {
                let [x, y] = at(point);
                let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{colour}\"/>");
            }
            let [x, y] = chain.last().map(at).unwrap_or_default();
            // Of feet behind each other one is named.
            if labels.iter().any(|other| (other - x).abs() < 30.0) {
                continue;
            }
            labels.push(x);
            let _ = writeln!(
                out,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"{colour}\">{}</text>",
                y + 16.0,
                leg.name
            );
        }
        let [x, y] = at(&com);
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" fill=\"none\" stroke=\"black\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\"/>"
        );
    }
    out + "</svg>\n"
}

/// The lowest height of the foot below the mount that the stops admit, m.
fn deepest(leg: &Leg) -> f64 {
    let posture = best(leg, |foot| foot[1] - leg.mount[1] + (foot[0] - leg.mount[0]).abs());
    let foot = chain(leg, &posture).last().copied().unwrap_or(leg.mount);
    foot[1] - leg.mount[1]
}

/// The leg with its foot below its mount, at this height from it.
fn stand(leg: &Leg, height: f64) -> Chain {
    let posture = best(leg, |foot| (foot[1] - leg.mount[1] - height).hypot(foot[0] - leg.mount[0]));
    chain(leg, &posture)
}

/// Angles within the stops that make something of the foot least: of the joints that swing the leg, the others nearest to zero.
fn best(leg: &Leg, of: impl Fn(&[f64; 3]) -> f64) -> Vec<f64> {
    let stops: Vec<[f64; 2]> = leg.chain.iter().map(|s| s.joint.range.map(|x| x.clamp(-3.2, 3.2))).collect();
    let swings: Vec<usize> = (0..stops.len()).filter(|k| leg.chain[*k].joint.axis == Axis::Pitch).collect();
    let rest = || stops.iter().map(|[low, high]| 0.0f64.clamp(*low, *high)).collect::<Vec<f64>>();
    let value = |angles: &[f64]| chain(leg, angles).last().map_or(f64::INFINITY, &of);
    let mut best = rest();
    for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let mut angles = rest();
        for k in &swings {
            angles[*k] = stops[*k][0] + share * (stops[*k][1] - stops[*k][0]);
        }
        // Steps that shrink whenever none of them helps.
        let mut step = 0.3;
        while step > 1e-5 {
            let before = value(&angles);
            for k in &swings {
                for change in [step, -step] {
                    let mut tried = angles.clone();
                    tried[*k] = (tried[*k] + change).clamp(stops[*k][0], stops[*k][1]);
                    if value(&tried) < value(&angles) {
                        angles = tried;
                    }
                }
            }
            if value(&angles) >= before {
                step *= 0.5;
            }
        }
        if value(&angles) < value(&best) - 1e-6 {
            best = angles;
        }
    }
    best
}

fn chain(leg: &Leg, angles: &[f64]) -> Chain {
    let mut points = vec![leg.mount];
    let mut at = leg.mount;
    let mut turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (segment, angle) in leg.chain.iter().zip(angles) {
        let (sin, cos) = angle.sin_cos();
        let i = segment.joint.axis.index();
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for row in &mut turn {
            (row[j], row[k]) = (row[j] * cos + row[k] * sin, row[k] * cos - row[j] * sin);
        }
        for (x, row) in at.iter_mut().zip(&turn) {
            *x += row.iter().zip(&segment.link.end).map(|(r, e)| r * e).sum::<f64>();
        }
        points.push(at);
    }
    points
}
