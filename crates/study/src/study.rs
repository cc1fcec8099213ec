//! What is asked: every design with every gait, criterion and speed, a numbered point each.

use crate::designs::{Designs, placeless};
use crate::row::Beyond;
use piaffe_interpreter::Robot;
use piaffe_model::hash;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::altered::Altered;
use piaffe_optimizer::optimize::Unaskable;
use std::collections::BTreeSet;

/// A question to many robots.
///
/// The answer to a point follows from the study alone: neither threads, nor which other points were asked for, nor interruptions
/// change a bit of it.
#[derive(Clone, Debug)]
pub struct Study {
    /// The robot whose numbers are changed.
    pub robot: Robot,
    pub designs: Designs,
    /// Names of the robot's gaits.
    pub gaits: Vec<String>,
    pub criteria: Vec<Criterion>,
    /// Mean forward speeds, m/s.
    pub speeds: Vec<f64>,
    /// Whether limits hold at each real leg too, whose cost is then the least.
    pub real_legs: bool,
    pub search: Search,
    /// What is told of an optimum beyond its receipt.
    pub beyond: BTreeSet<Beyond>,
}

/// How widely to look for the optimum of a point.
///
/// Every point is sought from the optima of the base robot (for the same gait, criterion and speed, of as many starts as the
/// evidence asks for), and from starts that know nothing of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// So many starts, the first of which is the default walk; by default [`FEW`], and as many as the evidence asks for where all
    /// these lead to no optimum.
    pub starts: Option<usize>,
    /// Of the random starts.
    pub seed: u64,
}

/// Starts at a point that know of no optimum, by default.
pub const FEW: usize = 1;

impl Default for Search {
    fn default() -> Search {
        Search { starts: None, seed: 1 }
    }
}

/// A question of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Point<'s> {
    /// From 0.
    pub number: usize,
    /// From 0.
    pub design: usize,
    /// The design's, in the order of the study's names.
    pub numbers: &'s [f64],
    pub gait: &'s str,
    pub criterion: Criterion,
    /// m/s.
    pub speed: f64,
}

impl Study {
    /// Everything that is wrong with the question; empty if it can be asked.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = self.designs.faults(&self.robot);
        let known = self.robot.gaits();
        for gait in self.gaits.iter().filter(|gait| !known.contains(gait)) {
            faults.push(format!("the robot has no gait `{gait}`; it has {}", known.join(", ")));
        }
        let unaskable = self.speeds.iter().filter_map(|speed| Unaskable::of(*speed));
        faults.extend(unaskable.map(|why| why.to_string()));
        faults.extend(self.gaits.iter().filter(|_| self.real_legs).filter_map(|gait| self.not_at_real_legs(gait)));
        let lists = [
            ("design", self.designs.count()),
            ("gait", self.gaits.len()),
            ("criterion", self.criteria.len()),
            ("speed", self.speeds.len()),
        ];
        faults.extend(lists.iter().filter(|(_, count)| *count == 0).map(|(what, _)| format!("there is no {what}")));
        faults
    }

    /// Why limits cannot be imposed at each real leg of a gait, if they cannot. What has no such gait is another fault.
    fn not_at_real_legs(&self, gait: &str) -> Option<String> {
        Altered::at_real_legs(&self.robot.gait(gait).ok()?).err()
    }

    /// How many questions it has.
    pub fn points(&self) -> usize {
        self.designs.count() * self.of_design()
    }

    /// How many of them are of one design.
    pub fn of_design(&self) -> usize {
        self.gaits.len() * self.criteria.len() * self.speeds.len()
    }

    /// The greatest number of phases that one of its gaits has.
    pub fn phases(&self) -> usize {
        self.gaits.iter().filter_map(|gait| self.robot.phases(gait)).max().unwrap_or(0)
    }

    /// The question of this number, below [`points`](Study::points): design by design, gait by gait, criterion by criterion.
    pub fn point(&self, number: usize) -> Point<'_> {
        let (rest, speed) = (number / self.speeds.len(), number % self.speeds.len());
        let (rest, criterion) = (rest / self.criteria.len(), rest % self.criteria.len());
        let (design, gait) = (rest / self.gaits.len(), rest % self.gaits.len());
        Point {
            number,
            design,
            numbers: self.designs.numbers(design),
            gait: &self.gaits[gait],
            criterion: self.criteria[criterion],
            speed: self.speeds[speed],
        }
    }

    /// The same question to those designs alone that have all that differs. What answers it answers all points of this one
    /// ([`Answers::answer`](crate::Answers::answer)), with the same bits, and is soon sent elsewhere.
    pub fn outline(&self) -> Study {
        let extremes = self.designs.extremes().into_iter().map(|design| self.designs.numbers(design).to_vec());
        let designs = Designs::of(self.designs.names().to_vec(), extremes);
        Study { designs, ..self.clone() }
    }

    /// Tells one study from another: a hash of all that its answers depend on.
    pub fn fingerprint(&self) -> String {
        let Study { robot, designs, gaits, criteria, speeds, real_legs, search, beyond } = self;
        let version = env!("CARGO_PKG_VERSION");
        let asked = format!(
            "{version} {:?} {designs:?} {gaits:?} {criteria:?} {speeds:?} {real_legs} {search:?} {beyond:?}",
            placeless(robot.files())
        );
        format!("{:016x}", hash(&asked))
    }
}
