//! Which real foot is on the ground when.

use super::figure::Figure;
use super::font::Weight;
use super::ink::Ink;
use super::scale::Scale;
use super::scene::{Anchor, Pen, Scene};
use super::subject::{Subject, spaced};
use piaffe_model::Mode;

const WIDTH: f64 = 440.0;
/// Left of the bars at least, for names.
const LEFT: f64 = 82.0;
const RIGHT: f64 = 16.0;
const ROW: f64 = 20.0;

pub fn figure(s: &Subject) -> Figure {
    let d = s.description();
    let mut feet: Vec<(usize, &str, [f64; 3])> =
        (0..2).flat_map(|leg| d.legs[leg].members.iter().map(move |m| (leg, m.name, m.mount()))).collect();
    // The fore legs first, and of those the left one.
    feet.sort_by(|a, b| b.2[0].total_cmp(&a.2[0]).then(a.2[2].total_cmp(&b.2[2])));
    let bottom = 8.0 + ROW * feet.len() as f64;
    let widest = feet.iter().map(|(_, name, _)| Weight::Regular.width(&spaced(name), 11.0)).fold(0.0, f64::max);
    let left = LEFT.max(widest + 14.0);
    // Long names make it wider, not its bars shorter.
    let width = WIDTH + left - LEFT;
    let mut scene = Scene::new(width, bottom + 34.0);
    let time = Scale { domain: [0.0, s.walk.duration()], range: [left, width - RIGHT] };
    for (row, (leg, name, _)) in feet.iter().enumerate() {
        let y = 8.0 + ROW * row as f64;
        scene.text([left - 10.0, y + 12.0], &spaced(name), 11.0, Anchor::End, Ink::Text);
        scene.line(&[[left, y + 8.0], [width - RIGHT, y + 8.0]], Pen::new(Ink::Grid, 1.0));
        for phase in s.walk.phases.iter().filter(|span| span.mode == Mode::Stance(*leg)) {
            let [a, b] = [phase.start, phase.start + phase.duration].map(|t| time.at(t));
            scene.rectangle([a, y + 2.0], [b - a, 12.0], Ink::Leg(*leg), 1.0);
        }
    }
    let ticks = time.ticks(5);
    for (tick, label) in &ticks.list {
        let x = time.at(*tick);
        scene.line(&[[x, bottom], [x, bottom + 4.0]], Pen::new(Ink::Axis, 1.0));
        scene.text([x, bottom + 16.0], label, 11.0, Anchor::Middle, Ink::Muted);
    }
    scene.line(&[[left, bottom], [width - RIGHT, bottom]], Pen::new(Ink::Axis, 1.0));
    scene.quantity([width - RIGHT, bottom + 30.0], ["time", "s"], ticks.power, 11.0, Anchor::End, Ink::Muted);
    let mut figure = Figure::drawing("footfall", "Footfall", scene, "Bars: the foot is on the ground.");
    figure.data = Some(serde_json::json!({
        "x": { "name": "time", "unit": "s", "domain": time.domain, "range": time.range },
        "y": { "unit": "", "domain": [0, 1], "range": [bottom, 6.0] },
        "time": true,
        "curves": [],
    }));
    figure
}
