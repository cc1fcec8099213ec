//! A plot: two axes with their units, curves, limits, and what a reader who points at it is told.

use super::font::Weight;
use super::ink::Ink;
use super::scale::{Scale, domain};
use super::scene::{Anchor, Dash, Pen, Scene, Xy};
use serde_json::{Value, json};

const WIDTH: f64 = 384.0;
const LEFT: f64 = 48.0;
const RIGHT: f64 = 14.0;
const PLOT_HEIGHT: f64 = 188.0;
const BOTTOM: f64 = 36.0;
const LEGEND_ROW: f64 = 17.0;
const SMALL: f64 = 11.0;

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    pub name: &'static str,
    pub unit: &'static str,
    /// Fitted to the curves where not given.
    pub domain: Option<[f64; 2]>,
}

/// Values over the first axis. Segments are not connected with each other.
#[derive(Clone, Debug)]
pub struct Curve {
    pub name: String,
    pub ink: Ink,
    pub dash: Dash,
    pub segments: Vec<Vec<Xy>>,
    /// Whether each point is marked.
    pub dots: bool,
    pub width: f64,
}

/// A limit: dashed, with its name at its end.
#[derive(Clone, Debug)]
pub struct Limit {
    pub name: String,
    pub points: Vec<Xy>,
}

/// An interval of the first axis, tinted, with a name at its top.
#[derive(Clone, Debug)]
pub struct Span {
    pub name: String,
    pub interval: [f64; 2],
    pub ink: Ink,
}

#[derive(Clone, Debug)]
pub struct Plot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub curves: Vec<Curve>,
    pub limits: Vec<Limit>,
    pub spans: Vec<Span>,
    /// Where the motion may not be: filled.
    pub forbidden: Vec<Vec<Xy>>,
    /// A remark under the legend.
    pub note: Option<String>,
    /// Whether the first axis is the time of the walk.
    pub over_time: bool,
}

impl Axis {
    pub fn new(name: &'static str, unit: &'static str) -> Axis {
        Axis { name, unit, domain: None }
    }

    pub fn over(self, domain: [f64; 2]) -> Axis {
        Axis { domain: Some(domain), ..self }
    }
}

impl Curve {
    pub fn new(name: impl Into<String>, ink: Ink, segments: Vec<Vec<Xy>>) -> Curve {
        Curve { name: name.into(), ink, dash: Dash::Solid, segments, dots: false, width: 1.8 }
    }

    pub fn dash(self, dash: Dash) -> Curve {
        Curve { dash, ..self }
    }

    fn points(&self) -> impl Iterator<Item = &Xy> {
        self.segments.iter().flatten()
    }
}

impl Plot {
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Plot {
        Plot {
            title: title.into(),
            x,
            y,
            curves: Vec::new(),
            limits: Vec::new(),
            spans: Vec::new(),
            forbidden: Vec::new(),
            note: None,
            over_time: false,
        }
    }

    /// The curves of the legend, row by row, each with its place in the row.
    fn legend(&self) -> Vec<Vec<(f64, &Curve)>> {
        let mut rows: Vec<Vec<(f64, &Curve)>> = vec![Vec::new()];
        let mut x = LEFT;
        for curve in self.curves.iter().filter(|c| !c.name.is_empty()) {
            let width = 22.0 + Weight::Regular.width(&curve.name, SMALL) + 14.0;
            if x + width > WIDTH && x > LEFT {
                rows.push(Vec::new());
                x = LEFT;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, curve));
            }
            x += width;
        }
        if rows.iter().all(Vec::is_empty) || self.curves.len() < 2 { Vec::new() } else { rows }
    }

    fn scales(&self) -> [Scale; 2] {
        let top = 26.0 + LEGEND_ROW * (self.legend().len() + usize::from(self.note.is_some())) as f64 + 12.0;
        let all = || self.curves.iter().flat_map(Curve::points).chain(self.forbidden.iter().flatten());
        let x = self.x.domain.unwrap_or_else(|| {
            let ends = all().map(|p| p[0]);
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        });
        let y = self.y.domain.unwrap_or_else(|| domain(all().map(|p| p[1])));
        [Scale { domain: x, range: [LEFT, WIDTH - RIGHT] }, Scale { domain: y, range: [top + PLOT_HEIGHT, top] }]
    }

    pub fn scene(&self) -> Scene {
        let [x, y] = self.scales();
        let [bottom, top] = y.range;
        let [left, right] = x.range;
        let mut scene = Scene::new(WIDTH, bottom + BOTTOM);
        self.head(&mut scene);

        for span in &self.spans {
            let [a, b] = span.interval.map(|v| x.at(v).clamp(left, right));
            scene.rectangle([a, top], [b - a, bottom - top], span.ink, 0.07);
            if Weight::Regular.width(&span.name, 10.0) < b - a {
                scene.text([0.5 * (a + b), top - 4.0], &span.name, 10.0, Anchor::Middle, span.ink);
            }
        }
        for tick in y.ticks(5) {
            let at = y.at(tick);
            let ink = if tick == 0.0 { Ink::Axis } else { Ink::Grid };
            scene.line(&[[left, at], [right, at]], Pen::new(ink, 1.0));
            scene.text([left - 6.0, at + 4.0], &y.label(tick, 5), SMALL, Anchor::End, Ink::Muted);
        }
        for tick in x.ticks(5) {
            let at = x.at(tick);
            scene.line(&[[at, bottom], [at, bottom + 4.0]], Pen::new(Ink::Axis, 1.0));
            scene.text([at, bottom + 16.0], &x.label(tick, 5), SMALL, Anchor::Middle, Ink::Muted);
        }
        scene.line(&[[left, bottom], [right, bottom]], Pen::new(Ink::Axis, 1.0));
        scene.text([right, bottom + 30.0], &words(&self.x), SMALL, Anchor::End, Ink::Muted);

        let place = |p: &Xy| [x.at(p[0]), y.at(p[1])];
        for region in &self.forbidden {
            let clipped: Vec<Xy> = region.iter().map(|p| [x.at(p[0]), y.at(p[1]).clamp(top, bottom)]).collect();
            scene.area(&clipped, Ink::Limit, 0.14);
        }
        let mut named = Vec::new();
        for limit in &self.limits {
            draw_limit(&mut scene, limit, [x, y], &mut named);
        }
        for curve in &self.curves {
            for segment in &curve.segments {
                let points: Vec<Xy> = segment.iter().map(place).collect();
                scene.line(&points, Pen::new(curve.ink, curve.width).dash(curve.dash));
                for at in points.iter().filter(|_| curve.dots) {
                    scene.dot(*at, 2.4, curve.ink);
                }
            }
        }
        scene
    }

    fn head(&self, scene: &mut Scene) {
        scene.write([LEFT, 15.0], &self.title, 13.0, Weight::Bold, Anchor::Start, Ink::Text);
        let after = LEFT + Weight::Bold.width(&self.title, 13.0) + 7.0;
        let unit = if self.y.name.is_empty() { self.y.unit.to_string() } else { words(&self.y) };
        scene.text([after, 15.0], &unit, SMALL, Anchor::Start, Ink::Muted);
        let mut at = 34.0;
        for row in self.legend() {
            for (x, curve) in row {
                let line = [[x, at - 4.0], [x + 17.0, at - 4.0]];
                scene.line(&line, Pen::new(curve.ink, 2.2).dash(curve.dash));
                if curve.dots {
                    scene.dot([x + 8.5, at - 4.0], 2.6, curve.ink);
                }
                scene.text([x + 22.0, at], &curve.name, SMALL, Anchor::Start, Ink::Text);
            }
            at += LEGEND_ROW;
        }
        if let Some(note) = &self.note {
            scene.text([LEFT, at], note, SMALL, Anchor::Start, Ink::Muted);
        }
    }

    /// What the page needs to tell values: the axes' places and the curves' numbers.
    pub fn data(&self) -> Value {
        let [x, y] = self.scales();
        let curves: Vec<Value> = self
            .curves
            .iter()
            .map(|c| {
                let [xs, ys] = [0, 1].map(|k| c.points().map(|p| significant(p[k])).collect::<Vec<_>>());
                json!({ "name": c.name, "ink": c.ink.name(), "x": xs, "y": ys })
            })
            .collect();
        json!({
            "x": { "name": self.x.name, "unit": self.x.unit, "domain": x.domain, "range": x.range },
            "y": { "unit": self.y.unit, "domain": y.domain, "range": y.range },
            "time": self.over_time,
            "curves": curves,
        })
    }
}

/// The part of a limit within the axes; its name at its right end, or at its left one where another name stands there.
fn draw_limit(scene: &mut Scene, limit: &Limit, [x, y]: [Scale; 2], named: &mut Vec<f64>) {
    let [bottom, top] = y.range;
    let points: Vec<Xy> = limit.points.iter().map(|p| [x.at(p[0]), y.at(p[1])]).collect();
    if points.iter().all(|p| p[1] < top - 0.5 || p[1] > bottom + 0.5) {
        return;
    }
    let clamped: Vec<Xy> = points.iter().map(|p| [p[0], p[1].clamp(top, bottom)]).collect();
    scene.line(&clamped, Pen::new(Ink::Limit, 1.2).dash(Dash::Dashed));
    let (Some(start), Some(end)) = (clamped.first(), clamped.last()) else { return };
    if start[0] == end[0] {
        // Beside an upright line, on its wider side.
        let right = end[0] - x.range[0] < x.range[1] - end[0];
        let (shift, anchor) = if right { (4.0, Anchor::Start) } else { (-4.0, Anchor::End) };
        scene.text([end[0] + shift, top + 9.0], &limit.name, 10.0, anchor, Ink::Limit);
        return;
    }
    let height = if end[1] < top + 14.0 { end[1] + 12.0 } else { end[1] - 4.0 };
    let taken = named.iter().any(|other| (other - height).abs() < 12.0);
    let (at, anchor) = if taken { (x.range[0] + 3.0, Anchor::Start) } else { (x.range[1] - 3.0, Anchor::End) };
    scene.text([at, height], &limit.name, 10.0, anchor, Ink::Limit);
    named.push(height);
}

fn words(axis: &Axis) -> String {
    match (axis.name, axis.unit) {
        (name, "") => name.into(),
        ("", unit) => unit.into(),
        (name, unit) => format!("{name}, {unit}"),
    }
}

/// Six significant digits: more than a figure can show, and short.
pub fn significant(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
