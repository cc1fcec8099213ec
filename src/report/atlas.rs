//! Gaits over speeds, in the shape of figs. 12 and 13: what they cost, how they step, and which limits they meet.

use super::figure::Figure;
use super::ink::Ink;
use super::plot::{Axis, Curve, Limit, Plot};
use super::scene::{Anchor, Dash, Pen, Scene};
use super::subject::spaced;
use crate::motion::Criterion;
use crate::overview::Greatest;
use crate::result::GaitResult;
use crate::search::crossover::Comparison;
use std::collections::BTreeMap;

/// What a sweep tells beside its points; see [`Overview`](crate::overview::Overview).
#[derive(Clone, Debug, Default)]
pub struct Extremes {
    pub maximum_speeds: Vec<Greatest>,
    pub comparisons: Vec<Comparison>,
}

/// Where one gait becomes cheaper than another.
pub struct Crossing {
    pub criterion: Criterion,
    pub slower: String,
    pub faster: String,
    /// m/s.
    pub speed: f64,
}

/// A sweep's results, line by line.
pub struct Atlas {
    /// All results of a gait and criterion, by speed.
    lines: Vec<Vec<GaitResult>>,
    gaits: Vec<String>,
    extremes: Extremes,
}

impl Atlas {
    /// An atlas of the results, if they are of more than one speed.
    pub fn new(results: &[GaitResult], extremes: Extremes) -> Option<Atlas> {
        let mut gaits: Vec<String> = Vec::new();
        let mut lines: Vec<Vec<GaitResult>> = Vec::new();
        for r in results {
            if !gaits.contains(&r.gait) {
                gaits.push(r.gait.clone());
            }
            match lines.iter_mut().find(|l| l[0].gait == r.gait && l[0].criterion == r.criterion) {
                Some(line) => line.push(r.clone()),
                None => lines.push(vec![r.clone()]),
            }
        }
        lines.iter_mut().for_each(|line| line.sort_by(|a, b| a.speed.total_cmp(&b.speed)));
        let longest = lines.iter().map(Vec::len).max().unwrap_or(0);
        (longest > 1).then_some(Atlas { lines, gaits, extremes })
    }

    pub fn figures(&self) -> Vec<Figure> {
        let mut figures: Vec<Figure> =
            Criterion::ALL.into_iter().filter(|c| self.of(*c).next().is_some()).map(|c| self.cost(c)).collect();
        figures.push(self.shape("durations", "Half steps over speed", "duration", "s", |r| r.durations.clone()));
        figures.push(
            self.shape("step-lengths", "Travel over speed", "length", "m", |r| r.step_length.into_iter().collect()),
        );
        figures.extend(self.activity());
        figures
    }

    fn of(&self, criterion: Criterion) -> impl Iterator<Item = &Vec<GaitResult>> {
        self.lines.iter().filter(move |l| l[0].criterion == criterion)
    }

    fn ink(&self, gait: &str) -> Ink {
        Ink::gait(self.gaits.iter().position(|g| g == gait).unwrap_or(0))
    }

    fn speed_axis(&self) -> Axis {
        let all =
            self.lines.iter().flatten().map(|r| r.speed).chain(self.extremes.maximum_speeds.iter().map(|m| m.speed));
        Axis::new("speed", "m/s").over([0.0, 1.04 * all.fold(0.0, f64::max)])
    }

    /// Where the cheaper of two gaits changes, for one criterion.
    pub fn crossings(&self, criterion: Criterion) -> Vec<Crossing> {
        let of = self.extremes.comparisons.iter().filter(|c| c.criterion == criterion);
        let crossings = of.flat_map(|c| {
            c.crossovers.iter().map(|x| {
                let slower = c.gaits.iter().find(|g| **g != x.to).unwrap_or(&x.to).clone();
                Crossing { criterion, slower, faster: x.to.clone(), speed: 0.5 * (x.bracket[0] + x.bracket[1]) }
            })
        });
        crossings.collect()
    }

    pub fn maximum_speeds(&self) -> &[Greatest] {
        &self.extremes.maximum_speeds
    }

    /// Fig. 12 or 13.
    fn cost(&self, criterion: Criterion) -> Figure {
        let title = match criterion {
            Criterion::Energy => "Energy criterion versus speed",
            Criterion::Torque => "Torque criterion versus speed",
        };
        let mut plot = Plot::new(title, self.speed_axis(), Axis::new("", criterion.unit()));
        for line in self.of(criterion) {
            let gait = &line[0].gait;
            let points = runs(line, |r| r.cost);
            let mut curve = Curve::new(gait, self.ink(gait), points);
            curve.dots = true;
            plot.curves.push(curve);
        }
        // What is dear at its fastest would flatten the rest.
        let top = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]).fold(0.0, f64::max);
        plot.y.domain = Some([0.0, 1.06 * top]);
        for x in self.crossings(criterion) {
            let name = format!("{} overtakes {} at {:.2}", x.faster, x.slower, x.speed);
            plot.limits.push(Limit { name, points: vec![[x.speed, 0.0], [x.speed, 1.06 * top]] });
        }
        for m in &self.extremes.maximum_speeds {
            let Some(curve) = plot.curves.iter_mut().find(|c| c.name == m.gait) else { continue };
            curve.name = format!("{} (up to {:.2} m/s)", m.gait, m.speed);
        }
        let caption = match criterion {
            Criterion::Energy => "As fig. 12: C2, the actuators' work per metre.",
            Criterion::Torque => "As fig. 13: C1, the torques' squares per metre.",
        };
        Figure::plot(&format!("speed-{}", criterion.name()), &plot, caption)
    }

    fn shape(
        &self,
        name: &str,
        title: &str,
        axis: &'static str,
        unit: &'static str,
        values: impl Fn(&GaitResult) -> Vec<f64>,
    ) -> Figure {
        let mut plot = Plot::new(title, self.speed_axis(), Axis::new(axis, unit));
        for line in &self.lines {
            let count = line.iter().map(|r| values(r).len()).max().unwrap_or(0);
            for k in 0..count {
                let (gait, criterion) = (&line[0].gait, line[0].criterion);
                let which = if count > 1 { format!(" {}", k + 1) } else { String::new() };
                let points = runs(line, |r| values(r).get(k).copied());
                let dash = if criterion == Criterion::Energy { Dash::Solid } else { Dash::Dashed };
                let mut curve =
                    Curve::new(format!("{gait}{which}, {}", criterion.name()), self.ink(gait), points).dash(dash);
                curve.width = if k == 0 { 1.8 } else { 1.1 };
                plot.curves.push(curve);
            }
        }
        Figure::plot(
            name,
            &plot,
            "Solid: least energy; dashed: least torque. Thin: the second half step, where it differs.",
        )
    }

    /// Which limits have no room to spare, over speed.
    fn activity(&self) -> Vec<Figure> {
        self.lines.iter().filter_map(|line| activity(line, self.ink(&line[0].gait))).collect()
    }
}

/// Points of a line; broken where there is no optimum.
fn runs(line: &[GaitResult], value: impl Fn(&GaitResult) -> Option<f64>) -> Vec<Vec<[f64; 2]>> {
    let points: Vec<Option<[f64; 2]>> =
        line.iter().map(|r| if r.is_optimal() { value(r).map(|v| [r.speed, v]) } else { None }).collect();
    points
        .split(Option::is_none)
        .map(|run| run.iter().flatten().copied().collect())
        .filter(|r: &Vec<_>| !r.is_empty())
        .collect()
}

fn activity(line: &[GaitResult], ink: Ink) -> Option<Figure> {
    let mut rows: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for r in line {
        for finding in r.receipt.iter().flat_map(|receipt| &receipt.findings).filter(|_| r.is_optimal()) {
            let speeds = rows.entry(&finding.constraint).or_default();
            if speeds.last() != Some(&r.speed) {
                speeds.push(r.speed);
            }
        }
    }
    if rows.is_empty() {
        return None;
    }
    let (gait, criterion) = (spaced(&line[0].gait), line[0].criterion.name());
    let speeds: Vec<f64> = line.iter().filter(|r| r.is_optimal()).map(|r| r.speed).collect();
    let (left, row, width) = (190.0, 17.0, 384.0);
    let column = (width - left - 6.0) / speeds.len() as f64;
    let bottom = 30.0 + row * rows.len() as f64;
    let mut scene = Scene::new(width, bottom + 34.0);
    let title = format!("Active limits: {gait}, {criterion}");
    scene.write([4.0, 15.0], &title, 13.0, super::font::Weight::Bold, Anchor::Start, Ink::Text);
    for (k, (name, active)) in rows.iter().enumerate() {
        let y = 30.0 + row * k as f64;
        scene.text([left - 8.0, y + 11.0], name, 10.0, Anchor::End, Ink::Text);
        for (i, speed) in speeds.iter().enumerate() {
            let x = left + column * i as f64;
            let on = active.contains(speed);
            scene.rectangle([x + 0.75, y + 2.0], [column - 1.5, row - 4.0], if on { ink } else { Ink::Grid }, 1.0);
        }
    }
    let every = (speeds.len() as f64 / 6.0).ceil().max(1.0) as usize;
    for (i, speed) in speeds.iter().enumerate().step_by(every) {
        let x = left + column * (i as f64 + 0.5);
        scene.line(&[[x, bottom], [x, bottom + 3.0]], Pen::new(Ink::Axis, 1.0));
        scene.text([x, bottom + 15.0], &format!("{speed}"), 10.0, Anchor::Middle, Ink::Muted);
    }
    scene.text([width - 6.0, bottom + 29.0], "speed, m/s", 11.0, Anchor::End, Ink::Muted);
    let mut figure = Figure::drawing(
        &format!("active-{}-{criterion}", line[0].gait.replace('/', "-")),
        &title,
        scene,
        "Filled: the limit has no room to spare somewhere in the step.",
    );
    figure.wide = false;
    Some(figure)
}
