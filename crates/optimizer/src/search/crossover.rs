//! Where one gait becomes cheaper than another: solved for, both gaits optimized at the crossing.
//!
//! What is solved for are further results of both; a comparison follows from results alone.

use super::atlas::search_at;
use super::evidence::Effort;
use super::journal::Journal;
use super::local::Task;
use super::multi_start::{Expected, Settings};
use crate::result::GaitResult;
use piaffe_model::Gait;
use piaffe_model::motion::Criterion;
use piaffe_model::units::Units;
use serde::{Deserialize, Serialize};

/// Width to which a crossing is bisected, in the robot's unit of speed.
const BISECTION: f64 = 5e-5;

/// Two gaits over the speeds at which both go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    pub criterion: Criterion,
    pub gaits: [String; 2],
    /// First and last speed at which both have an optimum, m/s.
    pub common: [f64; 2],
    /// The cheaper one at the first of these speeds.
    pub cheaper: String,
    /// Where the other becomes cheaper, and so on; ascending.
    pub crossovers: Vec<Crossover>,
}

/// Where the cheaper of two gaits changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Crossover {
    /// Speeds just below and above, m/s.
    pub bracket: [f64; 2],
    /// Cheaper above.
    pub to: String,
    /// Of both gaits below and above; far apart where one of them jumps to another basin.
    pub costs: [[f64; 2]; 2],
}

impl Crossover {
    /// Whether gait 0 or 1 has another optimum above than below: its cost changes by more than from one speed to the other it could.
    pub fn jumps(&self, gait: usize) -> bool {
        let [below, above] = self.costs.map(|costs| costs[gait]);
        let [slow, fast] = self.bracket;
        (above / below - 1.0).abs() > STEEPEST * (fast / slow - 1.0).abs() + JUMP
    }
}

/// A cost changes by no more than so many percent with a percent of speed.
const STEEPEST: f64 = 20.0;
/// A share of the cost that is not to be mistaken for the solver's accuracy.
const JUMP: f64 = 1e-3;

/// Both gaits at one speed.
#[derive(Clone)]
struct Pair {
    speed: f64,
    results: [GaitResult; 2],
}

impl Pair {
    fn costs(&self) -> [f64; 2] {
        // Both are optima, and those have a cost.
        [0, 1].map(|k| self.results[k].cost.unwrap_or(f64::INFINITY))
    }

    /// Index of the cheaper gait.
    fn cheaper(&self) -> usize {
        let [a, b] = self.costs();
        usize::from(a > b)
    }
}

impl Comparison {
    /// Compares two gaits by their optima at the speeds at which both have one. `lines`: results of one criterion by speed.
    pub fn of(lines: [&[GaitResult]; 2]) -> Option<Comparison> {
        let pair = |a: &GaitResult| {
            let b = lines[1].iter().find(|b| b.speed == a.speed && b.is_optimal())?;
            a.is_optimal().then(|| Pair { speed: a.speed, results: [a.clone(), b.clone()] })
        };
        let pairs: Vec<Pair> = lines[0].iter().filter_map(pair).collect();
        let (first, last) = (pairs.first()?, pairs.last()?);
        let names = lines.map(|line| line[0].gait.clone());
        let changes = pairs.windows(2).filter(|w| w[0].cheaper() != w[1].cheaper());
        let crossovers = changes.map(|w| Crossover {
            bracket: [w[0].speed, w[1].speed],
            to: names[w[1].cheaper()].clone(),
            costs: [w[0].costs(), w[1].costs()],
        });
        Some(Comparison {
            criterion: lines[0][0].criterion,
            common: [first.speed, last.speed],
            cheaper: names[first.cheaper()].clone(),
            crossovers: crossovers.collect(),
            gaits: names,
        })
    }
}

/// Further optima of two gaits: at the speeds that only one of them has, the greatest ones among them, and next to where the
/// cheaper one changes.
pub fn solve(
    gaits: [&dyn Gait; 2],
    lines: [&[GaitResult]; 2],
    settings: &Settings,
    journal: &dyn Journal,
) -> [Vec<GaitResult>; 2] {
    let mut pairs = pairs(gaits, lines, settings, journal);
    let mut next_to = Vec::new();
    for w in pairs.windows(2).filter(|w| w[0].cheaper() != w[1].cheaper()) {
        next_to.extend(bisect(gaits, w[0].clone(), w[1].clone(), settings, journal));
    }
    pairs.extend(next_to);
    [0, 1].map(|k| {
        let known = |speed: f64| lines[k].iter().any(|r| r.speed == speed);
        let mut new: Vec<GaitResult> =
            pairs.iter().filter(|pair| !known(pair.speed)).map(|pair| pair.results[k].clone()).collect();
        new.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        new.dedup_by(|a, b| a.speed == b.speed);
        new
    })
}

/// Both gaits at the speeds of either, as far as both go.
fn pairs(gaits: [&dyn Gait; 2], lines: [&[GaitResult]; 2], settings: &Settings, journal: &dyn Journal) -> Vec<Pair> {
    let mut speeds: Vec<f64> = lines.iter().flat_map(|line| line.iter().map(|r| r.speed)).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let pair = |speed: f64| {
        let at = |k: usize| at(gaits[k], lines[k], speed, settings, journal);
        Some(Pair { speed, results: [at(0)?, at(1)?] })
    };
    speeds.into_iter().filter_map(pair).collect()
}

/// The optimum at a speed: that of the line, or found now between two of the line.
fn at(
    gait: &dyn Gait,
    line: &[GaitResult],
    speed: f64,
    settings: &Settings,
    journal: &dyn Journal,
) -> Option<GaitResult> {
    if let Some(known) = line.iter().find(|r| r.speed == speed) {
        return known.is_optimal().then(|| known.clone());
    }
    let below = line.iter().rfind(|r| r.is_optimal() && r.speed < speed)?;
    let above = line.iter().find(|r| r.is_optimal() && r.speed > speed)?;
    between(gait, [below, above], speed, settings, journal)
}

fn between(
    gait: &dyn Gait,
    ends: [&GaitResult; 2],
    speed: f64,
    settings: &Settings,
    journal: &dyn Journal,
) -> Option<GaitResult> {
    let from: Vec<Vec<f64>> = ends.into_iter().filter_map(GaitResult::theta).collect();
    // The ends come from wide searches: their basins are what counts.
    let settings = Settings { starts: Some(1), ..settings.clone() };
    let task = Task { gait, criterion: ends[0].criterion, speed };
    let (result, _) = search_at(&task, &settings, &from, Expected::Theirs(Effort::default()), journal);
    result.is_optimal().then_some(result)
}

/// Narrows down where the cheaper gait changes; stops early where no optimum is found in between.
fn bisect(
    gaits: [&dyn Gait; 2],
    mut below: Pair,
    mut above: Pair,
    settings: &Settings,
    journal: &dyn Journal,
) -> [Pair; 2] {
    // Both gaits are one robot's: their legs are equally long, or nearly.
    let width = BISECTION * Units::new(gaits[0].description()).speed();
    while above.speed - below.speed > width {
        let middle = [0.5, 0.4, 0.6].into_iter().find_map(|share| {
            let speed = below.speed + share * (above.speed - below.speed);
            let at = |k: usize| between(gaits[k], [&below.results[k], &above.results[k]], speed, settings, journal);
            Some(Pair { speed, results: [at(0)?, at(1)?] })
        });
        let Some(middle) = middle else { break };
        if middle.cheaper() == below.cheaper() {
            below = middle;
        } else {
            above = middle;
        }
    }
    [below, above]
}

#[cfg(test)]
mod tests {
    use super::Crossover;

    #[test]
    fn a_cost_that_changes_more_than_a_speed_explains_has_jumped() {
        let at = |bracket, costs| Crossover { bracket, to: "run".into(), costs };
        // From one speed to the next of a grid both rise; across a bisected bracket neither changes.
        let grid = at([1.0, 1.1], [[240.0, 260.0], [290.0, 280.0]]);
        let bisected = at([1.05518, 1.05530], [[255.37, 255.38], [255.41, 255.40]]);
        let jumped = at([1.05518, 1.05530], [[255.37, 300.0], [4911.7, 300.01]]);
        let steps = |x: &Crossover| [0, 1].map(|gait| x.jumps(gait));
        assert_eq!([steps(&grid), steps(&bisected), steps(&jumped)], [[false; 2], [false; 2], [true, false]]);
    }
}
