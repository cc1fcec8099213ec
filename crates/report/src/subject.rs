//! What a report is about: a result and the walk that it describes.

use super::plot::{Axis, Plot, Span};
use super::record::Record;
use super::scene::{Dash, Xy};
use super::{ink::Ink, plot::Curve};
use piaffe_model::motion::Motion;
use piaffe_model::{Description, Gait, Mode};
use piaffe_optimizer::flow::Undefined;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::walk::{self, Moment, Walk};

/// Intervals per phase with which curves are drawn.
const INTERVALS: usize = 80;

/// Joints that are shown together.
pub struct Kind {
    /// As the specification would have it.
    pub name: String,
    /// At least one.
    pub joints: Vec<usize>,
}

pub struct Subject<'a> {
    /// Names it on the page and in files; no other has the same.
    pub id: String,
    /// What tells it from others in words: [`Record::variant`].
    pub variant: String,
    pub result: GaitResult,
    pub gait: &'a dyn Gait,
    pub motion: Motion,
    pub walk: Walk<'a>,
    /// The criterion, per metre of travel.
    pub cost: f64,
    /// Energy per weight and distance.
    pub transport: f64,
}

impl<'a> Subject<'a> {
    /// Follows the motion of a confirmed result; of any other there is none.
    ///
    /// # Errors
    /// If its motion cannot be followed.
    pub fn new(record: &Record<'a>, id: String) -> Result<Option<Subject<'a>>, Undefined> {
        let (Some(gait), Some(motion), result) = (record.gait(), record.result.motion(), record.result.clone()) else {
            return Ok(None);
        };
        let (Some(cost), Some(transport)) = (result.cost, record.cost_of_transport()) else { return Ok(None) };
        let walk = Walk::even(gait, &motion, INTERVALS)?;
        Ok(Some(Subject { id, variant: record.variant(), result, gait, motion, walk, cost, transport }))
    }

    pub fn description(&self) -> &'a Description {
        self.walk.description
    }

    /// The real legs of a virtual leg in words.
    pub fn leg_name(&self, leg: usize) -> String {
        let members = &self.description().legs[leg].members;
        members.iter().map(|m| spaced(m.name)).collect::<Vec<_>>().join(" + ")
    }

    /// The same, as short as a figure needs it: what the legs have in common, or the virtual leg's number.
    pub fn short_leg_name(&self, leg: usize) -> String {
        let members = &self.description().legs[leg].members;
        let mut parts = members.first().map_or("", |m| m.name).split('_');
        let common = parts.find(|part| members.iter().all(|m| m.name.split('_').any(|p| p == *part)));
        match common {
            Some(part) if members.len() > 1 => format!("{part} legs"),
            _ => match members.as_ref() {
                [only] => spaced(only.name),
                _ => format!("leg {}", leg + 1),
            },
        }
    }

    /// How far down its leg a joint is.
    fn depth(&self, joint: usize) -> usize {
        joint - self.description().legs[self.leg_of(joint)].first_joint
    }

    pub fn leg_of(&self, joint: usize) -> usize {
        usize::from(joint >= self.description().legs[1].first_joint)
    }

    /// What a joint is called in every leg: its name without the leg's number.
    fn called(&self, joint: usize) -> &'static str {
        let name = self.description().joints[joint].name;
        name.strip_suffix(&(self.leg_of(joint) + 1).to_string()).unwrap_or(name)
    }

    /// The joints, those together that are called alike and of which this is the same.
    pub fn kinds<K: PartialEq>(&self, alike: impl Fn(usize) -> K) -> Vec<Kind> {
        let mut kinds: Vec<Kind> = Vec::new();
        for j in 0..self.description().joints() {
            let same = |known: &&mut Kind| {
                let first = known.joints[0];
                self.called(first) == self.called(j) && alike(first) == alike(j)
            };
            match kinds.iter_mut().find(same) {
                Some(known) => known.joints.push(j),
                None => kinds.push(Kind { name: self.called(j).into(), joints: vec![j] }),
            }
        }
        // Where legs have different ones of a name, it is also told whose they are.
        let names: Vec<String> = kinds.iter().map(|kind| kind.name.clone()).collect();
        for kind in &mut kinds {
            if names.iter().filter(|name| **name == kind.name).count() > 1 {
                kind.name += &format!("_of_leg_{}", self.leg_of(kind.joints[0]) + 1);
            }
        }
        kinds
    }

    /// A value over time, phase by phase.
    pub fn over_time(&self, value: impl Fn(&Moment) -> f64) -> Vec<Vec<Xy>> {
        by_phase(&self.walk, value)
    }

    /// The same at `times` as many moments.
    pub fn finely(&self, times: usize, value: impl Fn(&Moment) -> f64) -> Vec<Vec<Xy>> {
        let fine = Walk::even(self.gait, &self.motion, times * INTERVALS);
        by_phase(fine.as_ref().unwrap_or(&self.walk), value)
    }

    /// A plot over the time of the walk, with the phases tinted by the leg in support.
    pub fn time_plot(&self, title: impl Into<String>, unit: &'static str) -> Plot {
        let time = Axis::new("time", "s").over([0.0, self.walk.duration()]);
        let mut plot = Plot::new(title, time, Axis::new("", unit));
        plot.over_time = true;
        plot.spans = self.spans();
        plot
    }

    pub fn spans(&self) -> Vec<Span> {
        let span = |phase: &walk::Span| {
            let (name, ink) = self.mode(phase.mode);
            Span { name, interval: [phase.start, phase.start + phase.duration], ink }
        };
        self.walk.phases.iter().map(span).collect()
    }

    /// A mode in words, and its colour.
    pub fn mode(&self, mode: Mode) -> (String, Ink) {
        match mode {
            Mode::Stance(leg) => (format!("on {}", self.short_leg_name(leg)), Ink::Leg(leg)),
            Mode::Flight => ("in flight".into(), Ink::Muted),
        }
    }

    /// A curve for every joint of `joints`.
    pub fn joint_curves(
        &self,
        joints: impl Iterator<Item = usize>,
        value: impl Fn(&Moment, usize) -> f64,
    ) -> Vec<Curve> {
        let curve = |j: usize| {
            let name = self.description().joints[j].name;
            let segments = self.over_time(|m| value(m, j));
            Curve::new(name, Ink::Leg(self.leg_of(j)), segments).dash(Dash::of(self.depth(j)))
        };
        joints.map(curve).collect()
    }
}

fn by_phase(walk: &Walk, value: impl Fn(&Moment) -> f64) -> Vec<Vec<Xy>> {
    let of_phase = |k| walk.moments.iter().filter(move |m| m.phase == k).map(|m| [m.time, value(m)]).collect();
    (0..walk.phases.len()).map(of_phase).collect()
}

/// A name of the specification for a reader. What is a number's, `links.fore_thigh.mass=1.6`, is left as it is written.
pub fn spaced(name: &str) -> String {
    let word = |word: &str| if word.contains('=') { word.to_string() } else { word.replace('_', " ") };
    name.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A name of the specification at the beginning of a line.
pub fn capital(name: &str) -> String {
    let name = spaced(name);
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}
