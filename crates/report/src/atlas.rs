//! Gaits over speeds, in the shape of figs. 12 and 13: what they cost, how they step, and which limits they meet.
//!
//! All of it, which gait is cheaper where too, is read off the confirmed results. What is said is what is drawn.

use super::figure::Figure;
use super::font::Weight;
use super::ink::Ink;
use super::number::significant;
use super::plot::{Axis, Curve, Event, Place, Plot};
use super::record::Record;
use super::scale::Scale;
use super::scene::{Anchor, Dash, Pen, Scene, Xy};
use super::subject::spaced;
use crate::overview::Greatest;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::origin::under_its_limits;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::search::branch::connected;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How far the cell of a speed without neighbours reaches to either side, as a share of it.
const ALONE: f64 = 0.03;

/// What a sweep tells beside its points; see [`Overview`](crate::overview::Overview). It is an account of a search, which no
/// motion confirms.
#[derive(Clone, Debug, Default)]
pub struct Extremes {
    pub maximum_speeds: Vec<Greatest>,
}

/// Brackets narrower than this are told as one speed, m/s per m/s.
const NARROW: f64 = 1e-3;

/// Whether two speeds are so near to each other that one of them tells both.
pub fn is_one_speed([below, above]: [f64; 2]) -> bool {
    above - below <= NARROW * above
}

/// Two speeds with as many digits as tell them apart.
pub fn told_apart(speeds: [f64; 2]) -> [String; 2] {
    let tell = |digits| speeds.map(|v| significant(v, digits));
    (3..9).map(tell).find(|[a, b]| a != b).unwrap_or_else(|| tell(9))
}

/// Where one gait becomes cheaper than another.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    pub criterion: Criterion,
    pub slower: String,
    pub faster: String,
    /// Speeds at which both have an optimum, just below and above, m/s.
    pub bracket: [f64; 2],
    /// Where the drawn lines cross; nowhere if one of them jumps in between.
    pub at: Option<Xy>,
}

impl Crossing {
    /// Where it is, in words.
    pub fn place(&self) -> String {
        let [below, above] = self.bracket;
        match self.at {
            Some([speed, _]) if is_one_speed(self.bracket) => format!("at {} m/s", significant(speed, 4)),
            _ => {
                let [below, above] = told_apart([below, above]);
                format!("between {below} and {above} m/s")
            }
        }
    }
}

/// The fastest optimum of a gait among the results, beside what a sweep says of it.
pub struct Fastest<'a> {
    pub gait: &'a str,
    /// m/s.
    pub speed: f64,
    /// Limits without room to spare there, whatever is minimized.
    pub active: Vec<String>,
    /// Whether a sweep calls it the greatest speed.
    pub is_greatest: bool,
}

/// Optima of one gait and criterion, by speed.
struct Line {
    gait: String,
    criterion: Criterion,
    points: Vec<Point>,
    /// Whether the optimum at a speed and the next one are of one branch.
    connected: Vec<bool>,
}

/// A speed of a line.
struct Point {
    speed: f64,
    /// The best of the confirmed optima there.
    optimum: Option<Optimum>,
}

struct Optimum {
    result: GaitResult,
    cost: f64,
    transport: f64,
}

/// A sweep's results, line by line.
pub struct Atlas {
    lines: Vec<Line>,
    gaits: Vec<String>,
    extremes: Extremes,
}

impl Atlas {
    /// An atlas of the results, if there is a gait and criterion with optima at more than one speed.
    pub fn new(records: &[Record], extremes: Extremes) -> Option<Atlas> {
        let mut gaits: Vec<String> = Vec::new();
        let mut groups: Vec<(String, Criterion, Vec<&Record>)> = Vec::new();
        for record in records {
            let (gait, criterion) = (record.variant(), record.result.criterion);
            if !gaits.contains(&gait) {
                gaits.push(gait.clone());
            }
            match groups.iter_mut().find(|g| (&g.0, g.1) == (&gait, criterion)) {
                Some(group) => group.2.push(record),
                None => groups.push((gait, criterion, vec![record])),
            }
        }
        let several = |g: &(String, Criterion, Vec<&Record>)| {
            let mut confirmed = g.2.iter().filter(|r| r.is_confirmed()).map(|r| r.result.speed);
            let first = confirmed.next();
            confirmed.any(|speed| Some(speed) != first)
        };
        if !groups.iter().any(several) {
            return None;
        }
        let lines = groups.into_par_iter().map(|(gait, criterion, records)| Line::new(gait, criterion, &records));
        Some(Atlas { lines: lines.collect(), gaits, extremes })
    }

    pub fn figures(&self) -> Vec<Figure> {
        let mut figures: Vec<Figure> =
            Criterion::ALL.into_iter().filter(|c| self.of(*c).next().is_some()).map(|c| self.cost(c)).collect();
        figures.push(self.shape("transport", "Cost of transport over speed", ["E/(m g d)", ""], |o| vec![o.transport]));
        figures
            .push(self.shape("durations", "Durations over speed", ["duration", "s"], |o| o.result.durations.clone()));
        figures.push(self.shape("step-lengths", "Travel over speed", ["length", "m"], |o| {
            o.result.step_length.into_iter().collect()
        }));
        figures.extend(self.lines.iter().filter_map(|line| self.activity(line)));
        figures
    }

    fn of(&self, criterion: Criterion) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(move |l| l.criterion == criterion)
    }

    fn ink(&self, gait: &str) -> Ink {
        Ink::gait(self.gaits.iter().position(|g| g == gait).unwrap_or(0))
    }

    fn speed_axis(&self) -> Axis {
        let all = self.lines.iter().flat_map(Line::optima).map(|(speed, _)| speed);
        Axis::new("speed", "m/s").over([0.0, 1.04 * all.fold(0.0, f64::max)])
    }

    /// Where the cheaper of two gaits of a robot changes, for one criterion.
    pub fn crossings(&self, criterion: Criterion) -> Vec<Crossing> {
        let lines: Vec<&Line> = self.of(criterion).collect();
        let pairs = lines.iter().enumerate().flat_map(|(k, a)| lines[k + 1..].iter().map(move |b| [*a, *b]));
        // What a heavy robot spends says nothing of a light one's gaits.
        let mut all: Vec<Crossing> = pairs.filter(|[a, b]| a.robot() == b.robot()).flat_map(crossings).collect();
        all.sort_by(|a, b| a.bracket[0].total_cmp(&b.bracket[0]));
        all
    }

    /// Whether any line jumps.
    pub fn jumps(&self) -> bool {
        self.lines.iter().any(|line| line.jumps().next().is_some())
    }

    /// The fastest optima of all gaits.
    pub fn fastest(&self) -> Vec<Fastest<'_>> {
        self.gaits.iter().filter_map(|gait| self.fastest_of(gait)).collect()
    }

    fn fastest_of<'a>(&'a self, gait: &'a str) -> Option<Fastest<'a>> {
        let optima = || self.lines.iter().filter(|l| l.gait == gait).flat_map(Line::optima);
        let speed = optima().map(|(speed, _)| speed).max_by(f64::total_cmp)?;
        let mut active: Vec<String> = Vec::new();
        for name in optima().filter(|(v, _)| *v == speed).flat_map(|(_, o)| limits(&o.result)) {
            if !active.iter().any(|known| known == name) {
                active.push(name.into());
            }
        }
        let told = |m: &Greatest| m.speed == speed && optima().any(|(_, o)| o.result.gait == m.gait);
        let is_greatest = self.extremes.maximum_speeds.iter().any(told);
        Some(Fastest { gait, speed, active, is_greatest })
    }

    /// Greatest speeds of which a sweep tells, but no result here.
    pub fn unfounded(&self) -> Vec<&Greatest> {
        // A line may be called by more than its gait: by its robot, by where its limits hold.
        let is_of = |line: &Line, m: &Greatest| line.optima().any(|(_, o)| o.result.gait == m.gait);
        let founded = |m: &Greatest| {
            let mut own = self.lines.iter().filter(|line| is_of(line, m));
            own.any(|line| self.fastest_of(&line.gait).is_some_and(|fastest| fastest.speed == m.speed))
        };
        self.extremes.maximum_speeds.iter().filter(|m| !founded(m)).collect()
    }

    /// Fig. 12 or 13.
    fn cost(&self, criterion: Criterion) -> Figure {
        let title = match criterion {
            Criterion::Energy => "Energy criterion versus speed",
            Criterion::Torque => "Torque criterion versus speed",
        };
        let mut plot = Plot::new(title, self.speed_axis(), Axis::new("", criterion.unit()));
        for line in self.of(criterion) {
            let mut curve = line.curve(line.gait.clone(), self.ink(&line.gait), |o| Some(o.cost));
            curve.dots = true;
            let greatest = self.fastest_of(&line.gait).filter(|f| f.is_greatest);
            if let Some(fastest) = greatest.filter(|f| line.optima().any(|(speed, _)| speed == f.speed)) {
                curve.name = format!("{} (up to {} m/s)", spaced(&line.gait), significant(fastest.speed, 4));
            }
            plot.curves.push(curve);
        }
        let top = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]).fold(0.0, f64::max);
        plot.y.domain = Some([0.0, 1.06 * top]);
        for x in self.crossings(criterion) {
            let name = format!("{} overtakes {} {}", spaced(&x.faster), spaced(&x.slower), x.place());
            let place = x.at.map_or(Place::Within(x.bracket), Place::At);
            plot.events.push(Event { name, place });
        }
        let caption = match criterion {
            Criterion::Energy => "As fig. 12: C2, the actuators' work per metre.",
            Criterion::Torque => "As fig. 13: C1, the torques' squares per metre.",
        };
        Figure::plot(&format!("speed-{}", criterion.name()), &plot, format!("{caption}{}", self.of_jumps()))
    }

    /// What the rings mean, where there are any.
    fn of_jumps(&self) -> &'static str {
        if self.jumps() { " Between two rings the optimum jumps to another branch." } else { "" }
    }

    fn shape(
        &self,
        name: &str,
        title: &str,
        [axis, unit]: [&'static str; 2],
        values: impl Fn(&Optimum) -> Vec<f64>,
    ) -> Figure {
        let mut plot = Plot::new(title, self.speed_axis(), Axis::new(axis, unit));
        let mut thin = false;
        for line in &self.lines {
            let count = line.optima().map(|(_, o)| values(o).len()).max().unwrap_or(0);
            for k in 0..count {
                let which = if count > 1 { format!(" {}", k + 1) } else { String::new() };
                let name = format!("{}{which}, {}", line.gait, line.criterion.name());
                let dash = if line.criterion == Criterion::Energy { Dash::Solid } else { Dash::Dashed };
                let mut curve = line.curve(name, self.ink(&line.gait), |o| values(o).get(k).copied()).dash(dash);
                curve.width = if k == 0 { 1.8 } else { 1.1 };
                thin |= k > 0;
                plot.curves.push(curve);
            }
        }
        let thin = if thin { " Thin: the phases after the first." } else { "" };
        let caption = format!("Solid: least energy; dashed: least torque.{thin}{}", self.of_jumps());
        Figure::plot(name, &plot, caption)
    }

    /// Which limits have no room to spare, over speed.
    fn activity(&self, line: &Line) -> Option<Figure> {
        let mut rows: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for (speed, optimum) in line.optima() {
            for name in limits(&optimum.result) {
                let speeds = rows.entry(name).or_default();
                if speeds.last() != Some(&speed) {
                    speeds.push(speed);
                }
            }
        }
        if rows.is_empty() {
            return None;
        }
        let ink = self.ink(&line.gait);
        let (gait, criterion) = (spaced(&line.gait), line.criterion.name());
        let widest = rows.keys().map(|name| Weight::Regular.width(name, 10.0)).fold(0.0, f64::max);
        let (left, row, across) = (widest + 14.0, 17.0, 210.0);
        let width = (left + across + 14.0).max(384.0);
        let speed = Scale { domain: self.speed_axis().domain.unwrap_or([0.0, 1.0]), range: [left, width - 14.0] };
        let bottom = 30.0 + row * rows.len() as f64;
        let mut scene = Scene::new(width, bottom + 36.0);
        let title = format!("Active limits: {gait}, {criterion}");
        scene.write(
            [4.0, 15.0],
            &Weight::Bold.fit(&title, 13.0, width - 8.0),
            13.0,
            Weight::Bold,
            Anchor::Start,
            Ink::Text,
        );
        let cells = line.cells();
        for (k, (name, active)) in rows.iter().enumerate() {
            let y = 30.0 + row * k as f64;
            scene.text([left - 8.0, y + 11.0], name, 10.0, Anchor::End, Ink::Text);
            for (at, ends) in &cells {
                let [a, b] = ends.map(|v| speed.at(v).clamp(left, width - 14.0));
                let gap = (0.2 * (b - a)).min(0.75);
                let on = active.contains(at);
                scene.rectangle(
                    [a + gap, y + 2.0],
                    [b - a - 2.0 * gap, row - 4.0],
                    if on { ink } else { Ink::Grid },
                    1.0,
                );
            }
        }
        let ticks = speed.roomy_ticks(5, |label| Weight::Regular.width(label, 11.0));
        scene.line(&[[left, bottom], [width - 14.0, bottom]], Pen::new(Ink::Axis, 1.0));
        for (tick, label) in &ticks.list {
            let x = speed.at(*tick);
            scene.line(&[[x, bottom], [x, bottom + 4.0]], Pen::new(Ink::Axis, 1.0));
            scene.text([x, bottom + 16.0], label, 11.0, Anchor::Middle, Ink::Muted);
        }
        scene.quantity([width - 14.0, bottom + 30.0], ["speed", "m/s"], ticks.power, 11.0, Anchor::End, Ink::Muted);
        let mut figure = Figure::drawing(
            &format!("active-{}-{criterion}", line.gait.replace(['/', ' ', ',', '='], "-")),
            &title,
            scene,
            "Filled: the limit has no room to spare somewhere in the step. Each cell reaches half way to the next speed.",
        );
        figure.wide = false;
        Some(figure)
    }
}

/// Limits without room to spare, as the receipt found them.
fn limits(result: &GaitResult) -> impl Iterator<Item = &str> {
    result.receipt.iter().flat_map(|receipt| &receipt.findings).map(|finding| finding.constraint.as_str())
}

impl Line {
    fn new(gait: String, criterion: Criterion, records: &[&Record]) -> Line {
        let mut records = records.to_vec();
        // At one speed the best of what is confirmed comes first.
        let key = |r: &Record| (r.is_confirmed(), r.result.cost.unwrap_or(f64::INFINITY));
        records.sort_by(|a, b| {
            let by_speed = a.result.speed.total_cmp(&b.result.speed);
            by_speed.then_with(|| key(b).0.cmp(&key(a).0)).then_with(|| key(a).1.total_cmp(&key(b).1))
        });
        records.dedup_by(|later, kept| later.result.speed == kept.result.speed);
        let connected = records.par_windows(2).map(|pair| of_one_branch(pair[0], pair[1])).collect();
        let point = |record: &&Record| {
            let known = record.is_confirmed().then_some(record.result.cost).flatten().zip(record.cost_of_transport());
            let optimum = known.map(|(cost, transport)| Optimum { result: record.result.clone(), cost, transport });
            Point { speed: record.result.speed, optimum }
        };
        Line { gait, criterion, points: records.iter().map(point).collect(), connected }
    }

    fn robot(&self) -> Option<&str> {
        self.optima().next().map(|(_, optimum)| optimum.result.robot.as_str())
    }

    fn optima(&self) -> impl Iterator<Item = (f64, &Optimum)> {
        self.points.iter().filter_map(|p| Some((p.speed, p.optimum.as_ref()?)))
    }

    /// Indices of points after which it jumps to another branch.
    fn jumps(&self) -> impl Iterator<Item = usize> + '_ {
        let jumps = |k: &usize| !self.connected[*k] && self.points[*k..=*k + 1].iter().all(|p| p.optimum.is_some());
        (0..self.connected.len()).filter(jumps)
    }

    /// A curve through a value of its optima: broken where there is none, and where it jumps.
    fn curve(&self, name: String, ink: Ink, value: impl Fn(&Optimum) -> Option<f64>) -> Curve {
        let at = |k: usize| Some([self.points[k].speed, value(self.points[k].optimum.as_ref()?)?]);
        let mut segments: Vec<Vec<Xy>> = Vec::new();
        for k in 0..self.points.len() {
            let Some(point) = at(k) else { continue };
            match segments.last_mut() {
                Some(run) if k > 0 && self.connected[k - 1] => run.push(point),
                _ => segments.push(vec![point]),
            }
        }
        let mut curve = Curve::new(spaced(&name), ink, segments);
        curve.jumps = self.jumps().flat_map(|k| [at(k), at(k + 1)]).flatten().collect();
        curve
    }

    /// The drawn cost at a speed within an unbroken part.
    fn drawn(&self, speed: f64) -> Option<f64> {
        let k = self.points.iter().rposition(|p| p.speed <= speed)?;
        let (here, cost) = (self.points[k].speed, self.points[k].optimum.as_ref()?.cost);
        if here == speed {
            return Some(cost);
        }
        let next = self.connected[k].then(|| &self.points[k + 1])?;
        Some(cost + (speed - here) / (next.speed - here) * (next.optimum.as_ref()?.cost - cost))
    }

    /// Optima with the speeds half way to their neighbours.
    fn cells(&self) -> Vec<(f64, [f64; 2])> {
        let speeds: Vec<f64> = self.points.iter().map(|p| p.speed).collect();
        let middle = |a: usize| Some(0.5 * (speeds.get(a)? + speeds.get(a + 1)?));
        let cell = |k: usize| {
            let before = k.checked_sub(1).and_then(middle);
            let after = middle(k);
            // At the ends as far as on the other side.
            let half = before.map(|b| speeds[k] - b).or(after.map(|a| a - speeds[k])).unwrap_or(ALONE * speeds[k]);
            let other = after.map(|a| a - speeds[k]).unwrap_or(half);
            [before.unwrap_or(speeds[k] - half), speeds[k] + other]
        };
        (0..speeds.len()).filter(|k| self.points[*k].optimum.is_some()).map(|k| (speeds[k], cell(k))).collect()
    }
}

fn of_one_branch(a: &Record, b: &Record) -> bool {
    let Some(gait) = a.gait().filter(|_| b.is_confirmed()) else { return false };
    under_its_limits(&a.result, gait, |gait| connected(gait, &a.result, &b.result)).unwrap_or(false)
}

/// Where the cheaper of two lines changes: between speeds at which both have an optimum.
fn crossings([a, b]: [&Line; 2]) -> Vec<Crossing> {
    let both: Vec<(f64, f64)> = a
        .optima()
        .filter_map(|(speed, here)| {
            let (_, there) = b.optima().find(|(other, _)| *other == speed)?;
            Some((speed, here.cost - there.cost))
        })
        .collect();
    let changes = both.windows(2).filter(|pair| (pair[0].1 > 0.0) != (pair[1].1 > 0.0));
    changes
        .map(|pair| {
            let bracket = [pair[0].0, pair[1].0];
            let [slower, faster] = if pair[0].1 > 0.0 { [b, a] } else { [a, b] }.map(|line| line.gait.clone());
            Crossing { criterion: a.criterion, slower, faster, bracket, at: drawn_crossing([a, b], bracket) }
        })
        .collect()
}

/// Where the drawn lines cross between two speeds, if both are unbroken there.
fn drawn_crossing([a, b]: [&Line; 2], [from, to]: [f64; 2]) -> Option<Xy> {
    let inside =
        |line: &Line| line.points.iter().map(|p| p.speed).filter(|v| (from..=to).contains(v)).collect::<Vec<_>>();
    let mut speeds = [inside(a), inside(b)].concat();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    // The differences at all speeds where either line may bend.
    let apart = |speed: f64| Some(a.drawn(speed)? - b.drawn(speed)?);
    let unbroken = [a, b].iter().all(|line| {
        let gaps = line.points.windows(2).zip(&line.connected);
        gaps.filter(|(pair, _)| pair[0].speed >= from && pair[1].speed <= to).all(|(_, connected)| *connected)
    });
    if !unbroken {
        return None;
    }
    speeds.windows(2).find_map(|pair| {
        let [before, after] = [apart(pair[0])?, apart(pair[1])?];
        if (before > 0.0) == (after > 0.0) {
            return None;
        }
        let speed = pair[0] + before / (before - after) * (pair[1] - pair[0]);
        Some([speed, a.drawn(speed)?])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A line through these speeds and costs; `jumps` says after which of them it jumps.
    fn line(gait: &str, points: &[[f64; 2]], jumps: &[usize]) -> Line {
        let point = |[speed, cost]: &[f64; 2]| {
            let result = json!({ "gait": gait, "robot": "r", "criterion": "energy", "speed": speed, "status": "optimal",
                "message": "", "polynomial_order": 4, "fingerprint": "", "seconds": 0, "version": "",
                "search": { "starts": 0, "successes": 0, "informed": 0, "optima": 0, "seed": 1, "alone": 0 } });
            let result = serde_json::from_value(result).unwrap();
            Point { speed: *speed, optimum: Some(Optimum { result, cost: *cost, transport: 0.0 }) }
        };
        let connected = (1..points.len()).map(|k| !jumps.contains(&(k - 1))).collect();
        Line { gait: gait.into(), criterion: Criterion::Energy, points: points.iter().map(point).collect(), connected }
    }

    #[test]
    fn a_crossing_is_where_the_drawn_lines_cross() {
        let walk = line("walk", &[[0.2, 1.0], [0.4, 2.0], [0.8, 6.0]], &[]);
        let run = line("run", &[[0.2, 4.0], [0.6, 2.0], [0.8, 3.0]], &[]);
        let [found] = <[Crossing; 1]>::try_from(crossings([&walk, &run])).unwrap();
        assert_eq!((found.slower.as_str(), found.faster.as_str(), found.bracket), ("walk", "run", [0.2, 0.8]));
        // On the walk's part from (0.4, 2) to (0.8, 6) and the run's from (0.2, 4) to (0.6, 2).
        let [speed, cost] = found.at.unwrap();
        assert!(
            (cost - (2.0 + 10.0 * (speed - 0.4))).abs() < 1e-12 && (cost - (4.0 - 5.0 * (speed - 0.2))).abs() < 1e-12
        );
        assert_eq!(found.place(), "between 0.200 and 0.800 m/s");
        let near = Crossing { bracket: [speed - 1e-5, speed + 1e-5], ..found };
        assert_eq!(near.place(), "at 0.4667 m/s");
    }

    /// On a page of several robots lines have more in their names than their gaits.
    #[test]
    fn lines_of_several_robots_keep_to_their_own() {
        let of_robot = |robot: &str, points: &[[f64; 2]]| {
            let mut line = line("trot", points, &[]);
            for optimum in line.points.iter_mut().filter_map(|point| point.optimum.as_mut()) {
                optimum.result.robot = robot.into();
            }
            Line { gait: format!("trot, {robot}"), ..line }
        };
        let lines = vec![of_robot("light", &[[0.2, 1.0], [0.8, 9.0]]), of_robot("heavy", &[[0.2, 5.0], [0.8, 6.0]])];
        let gaits = lines.iter().map(|line| line.gait.clone()).collect();
        let told = |speed: f64| Greatest { gait: "trot".into(), speed, ended_by: Vec::new() };
        let atlas = Atlas { lines, gaits, extremes: Extremes { maximum_speeds: vec![told(0.8), told(0.9)] } };
        assert!(atlas.crossings(Criterion::Energy).is_empty(), "a robot overtakes another");
        assert!(atlas.fastest().iter().all(|fastest| fastest.is_greatest));
        assert_eq!(atlas.unfounded(), [&told(0.9)]);
    }

    #[test]
    fn where_a_line_jumps_nothing_is_drawn_and_no_single_speed_is_told() {
        let walk = line("walk", &[[0.2, 1.0], [0.4, 2.0], [0.6, 9.0]], &[1]);
        let run = line("run", &[[0.2, 5.0], [0.4, 5.0], [0.6, 5.0]], &[]);
        let curve = walk.curve("walk".into(), Ink::Text, |o| Some(o.cost));
        assert_eq!(curve.segments, [vec![[0.2, 1.0], [0.4, 2.0]], vec![[0.6, 9.0]]]);
        assert_eq!(curve.jumps, [[0.4, 2.0], [0.6, 9.0]]);
        let [found] = <[Crossing; 1]>::try_from(crossings([&walk, &run])).unwrap();
        assert_eq!((found.at, found.place().as_str()), (None, "between 0.400 and 0.600 m/s"));
        assert!(crossings([&run, &line("slow", &[[0.2, 6.0], [0.4, 7.0]], &[])]).is_empty());
    }
}
