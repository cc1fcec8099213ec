//! A plot: two axes with their units, curves, limits, and what a reader who points at it is told.

use super::font::Weight;
use super::ink::Ink;
use super::scale::{Scale, domain};
use super::scene::{Anchor, Dash, Pen, Scene, Xy};
use serde_json::{Value, json};

const WIDTH: f64 = 384.0;
/// Left of the axes at least, for labels.
const LEFT: f64 = 48.0;
const RIGHT: f64 = 14.0;
const PLOT_HEIGHT: f64 = 188.0;
const BOTTOM: f64 = 36.0;
const LEGEND_ROW: f64 = 17.0;
/// A sample of a curve before its name.
const KEY: f64 = 22.0;
const SMALL: f64 = 11.0;
/// Of a limit's name.
const SMALL_NAME: f64 = 10.0;
/// Labels of the second axis, about.
const ROWS: usize = 5;

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
    /// Of each segment the number of what it stands for, where it stands for something.
    pub numbers: Vec<usize>,
    /// Whether each point is marked.
    pub dots: bool,
    /// Ends of segments between which the quantity jumps: ringed.
    pub jumps: Vec<Xy>,
    pub width: f64,
}

/// A limit: dashed, with its name at its end.
#[derive(Clone, Debug)]
pub struct Limit {
    pub name: String,
    pub points: Vec<Xy>,
}

/// Something that happens on the first axis, with what happens in a line of its own.
#[derive(Clone, Debug)]
pub struct Event {
    pub name: String,
    pub place: Place,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a point: circled.
    At(Xy),
    /// Somewhere in an interval: tinted.
    Within([f64; 2]),
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
    pub events: Vec<Event>,
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
        let (name, numbers, jumps) = (name.into(), Vec::new(), Vec::new());
        Curve { name, ink, dash: Dash::Solid, segments, numbers, dots: false, jumps, width: 1.8 }
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
            events: Vec::new(),
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
            let width = KEY + width(&curve.name) + 14.0;
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

    /// The axes. The drawing gets wider where labels are, not the axes shorter.
    fn scales(&self) -> [Scale; 2] {
        let rows = self.legend().len() + self.events.len() + usize::from(self.note.is_some());
        let top = 26.0 + LEGEND_ROW * rows as f64 + 12.0;
        let all = || self.curves.iter().flat_map(Curve::points).chain(self.forbidden.iter().flatten());
        let x = self.x.domain.unwrap_or_else(|| {
            let ends = all().map(|p| p[0]);
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        });
        let y = self.y.domain.unwrap_or_else(|| domain(all().map(|p| p[1])));
        let y = Scale { domain: y, range: [top + PLOT_HEIGHT, top] };
        let labels = y.ticks(ROWS).list.into_iter().map(|(_, label)| width(&label));
        let more = (labels.fold(0.0, f64::max) + 12.0 - LEFT).max(0.0);
        [Scale { domain: x, range: [LEFT + more, WIDTH - RIGHT + more] }, y]
    }

    pub fn scene(&self) -> Scene {
        let [x, y] = self.scales();
        let [bottom, top] = y.range;
        let [left, right] = x.range;
        let (across, up) = (x.roomy_ticks(5, width), y.ticks(ROWS));
        let mut scene = Scene::new(right + RIGHT, bottom + BOTTOM);
        self.head(&mut scene, up.power);

        for span in &self.spans {
            let [a, b] = span.interval.map(|v| x.at(v).clamp(left, right));
            scene.rectangle([a, top], [b - a, bottom - top], span.ink, 0.07);
            if Weight::Regular.width(&span.name, 10.0) < b - a {
                scene.text([0.5 * (a + b), top - 4.0], &span.name, 10.0, Anchor::Middle, span.ink);
            }
        }
        for (tick, label) in &up.list {
            let at = y.at(*tick);
            let ink = if *tick == 0.0 { Ink::Axis } else { Ink::Grid };
            scene.line(&[[left, at], [right, at]], Pen::new(ink, 1.0));
            scene.text([left - 6.0, at + 4.0], label, SMALL, Anchor::End, Ink::Muted);
        }
        for (tick, label) in &across.list {
            let at = x.at(*tick);
            scene.line(&[[at, bottom], [at, bottom + 4.0]], Pen::new(Ink::Axis, 1.0));
            scene.text([at, bottom + 16.0], label, SMALL, Anchor::Middle, Ink::Muted);
        }
        scene.line(&[[left, bottom], [right, bottom]], Pen::new(Ink::Axis, 1.0));
        scene.quantity(
            [right, bottom + 30.0],
            [self.x.name, self.x.unit],
            across.power,
            SMALL,
            Anchor::End,
            Ink::Muted,
        );

        let place = |p: &Xy| [x.at(p[0]), y.at(p[1])];
        for region in &self.forbidden {
            let clipped: Vec<Xy> = region.iter().map(|p| [x.at(p[0]), y.at(p[1]).clamp(top, bottom)]).collect();
            scene.area(&clipped, Ink::Limit, 0.14);
        }
        for event in &self.events {
            match event.place {
                Place::At(p) => scene.ring(place(&p), 5.2, Ink::Text),
                Place::Within(ends) => {
                    let [a, b] = ends.map(|v| x.at(v).clamp(left, right));
                    let [a, b] = if b - a < 3.0 { [0.5 * (a + b) - 1.5, 0.5 * (a + b) + 1.5] } else { [a, b] };
                    scene.rectangle([a, top], [b - a, bottom - top], Ink::Text, 0.12);
                }
            }
        }
        let mut named = Vec::new();
        for limit in &self.limits {
            draw_limit(&mut scene, limit, [x, y], &mut named);
        }
        for curve in &self.curves {
            for (k, segment) in curve.segments.iter().enumerate() {
                let points: Vec<Xy> = segment.iter().map(place).collect();
                scene.line(&points, Pen::new(curve.ink, curve.width).dash(curve.dash));
                for at in points.iter().filter(|_| curve.dots) {
                    scene.dot(*at, 2.4, curve.ink);
                    curve.numbers.get(k).into_iter().for_each(|number| scene.number(*number));
                }
            }
            for jump in &curve.jumps {
                scene.ring(place(jump), 3.4, curve.ink);
            }
        }
        scene
    }

    fn head(&self, scene: &mut Scene, power: i32) {
        let unit = width(self.y.name) + width(self.y.unit) + if power == 0 { 8.0 } else { 32.0 };
        let title = Weight::Bold.fit(&self.title, 13.0, WIDTH - LEFT - unit);
        scene.write([LEFT, 15.0], &title, 13.0, Weight::Bold, Anchor::Start, Ink::Text);
        let after = LEFT + Weight::Bold.width(&title, 13.0) + 7.0;
        scene.quantity([after, 15.0], [self.y.name, self.y.unit], power, SMALL, Anchor::Start, Ink::Muted);
        let mut at = 34.0;
        for row in self.legend() {
            for (x, curve) in row {
                let line = [[x, at - 4.0], [x + 17.0, at - 4.0]];
                scene.line(&line, Pen::new(curve.ink, 2.2).dash(curve.dash));
                if curve.dots {
                    scene.dot([x + 8.5, at - 4.0], 2.6, curve.ink);
                }
                let name = Weight::Regular.fit(&curve.name, SMALL, WIDTH - x - KEY);
                scene.text([x + KEY, at], &name, SMALL, Anchor::Start, Ink::Text);
            }
            at += LEGEND_ROW;
        }
        let fit = |text: &str, x: f64| Weight::Regular.fit(text, SMALL, WIDTH - x);
        for event in &self.events {
            match event.place {
                Place::At(_) => scene.ring([LEFT + 8.5, at - 4.0], 5.2, Ink::Text),
                Place::Within(_) => scene.rectangle([LEFT + 4.0, at - 9.5], [9.0, 11.0], Ink::Text, 0.2),
            }
            scene.text([LEFT + KEY, at], &fit(&event.name, LEFT + KEY), SMALL, Anchor::Start, Ink::Text);
            at += LEGEND_ROW;
        }
        if let Some(note) = &self.note {
            scene.text([LEFT, at], &fit(note, LEFT), SMALL, Anchor::Start, Ink::Muted);
        }
    }

    /// What the page needs to tell values: the axes' places and the curves' numbers.
    pub fn data(&self) -> Value {
        let [x, y] = self.scales();
        let curves: Vec<Value> = self
            .curves
            .iter()
            .map(|c| {
                let [xs, ys] = [0, 1].map(|k| c.points().map(|p| rounded(p[k])).collect::<Vec<_>>());
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

/// The part of a limit within the axes; its name at an end, over or under it, where no other name stands.
fn draw_limit(scene: &mut Scene, limit: &Limit, [x, y]: [Scale; 2], named: &mut Vec<[Xy; 2]>) {
    let [bottom, top] = y.range;
    let points: Vec<Xy> = limit.points.iter().map(|p| [x.at(p[0]), y.at(p[1])]).collect();
    if points.iter().all(|p| p[1] < top - 0.5 || p[1] > bottom + 0.5) {
        return;
    }
    let clamped: Vec<Xy> = points.iter().map(|p| [p[0], p[1].clamp(top, bottom)]).collect();
    scene.line(&clamped, Pen::new(Ink::Limit, 1.2).dash(Dash::Dashed));
    let (Some(start), Some(end)) = (clamped.first(), clamped.last()) else { return };
    let [left, right] = x.range;
    let name = Weight::Regular.fit(&limit.name, SMALL_NAME, right - left - 6.0);
    let wide = Weight::Regular.width(&name, SMALL_NAME);
    let places = [(end, right - 3.0 - wide), (start, left + 3.0)].into_iter().flat_map(|(at, from)| {
        let boxed = move |baseline: f64| [[from, baseline - 9.0], [from + wide, baseline + 2.5]];
        [at[1] - 4.0, at[1] + 11.0].map(boxed)
    });
    let within = |[a, b]: &[Xy; 2]| a[1] >= top && b[1] <= bottom;
    let apart = |[a, b]: &[Xy; 2], [c, d]: &[Xy; 2]| b[0] < c[0] || d[0] < a[0] || b[1] < c[1] || d[1] < a[1];
    if let Some(free) = places.into_iter().find(|p| within(p) && named.iter().all(|other| apart(p, other))) {
        scene.text([free[0][0], free[1][1] - 2.5], &name, SMALL_NAME, Anchor::Start, Ink::Limit);
        named.push(free);
    }
}

fn width(label: &str) -> f64 {
    Weight::Regular.width(label, SMALL)
}

/// Six significant digits: more than a figure can show, and short.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
