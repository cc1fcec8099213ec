//! Which of the gaits that legs like these have the robot can do: each is asked for at a few speeds, with less clearance where there
//! is no motion with more, and what was found is written into its file.

use super::Import;
use super::gaits::{Candidate, Variant, file_name};
use piaffe_codegen::{RobotFiles, SpecFile};
use piaffe_interpreter::Robot;
use piaffe_model::Gait;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;

/// Speeds that are tried, in √(gravity · leg).
const SPEEDS: [f64; 4] = [0.15, 0.3, 0.5, 0.8];
/// Who does not walk at the slowest of these does at no faster one.
const SLOW: usize = 2;
/// Starts at a speed, where nothing has been found yet; then there is a neighbour to start from.
const STARTS: usize = 8;
const STARTS_BESIDE: usize = 2;
/// A gait that flies is worth a file where it needs less than this share of what the one on the ground needs.
const PAYS: f64 = 0.99;

/// What became of a candidate.
struct Outcome<'c> {
    candidate: &'c Candidate,
    variant: &'c Variant,
    criterion: Criterion,
    /// At each speed that was asked for, m/s, the least that was found.
    found: Vec<(f64, Option<f64>)>,
    /// What is in the way where nothing was found, of the slowest speed.
    obstacle: String,
}

impl Import {
    /// The same with the gaits that the robot can do, as far as a short search tells. `watch` is told what is tried
    /// next, and tells whether to go on. The same file gives the same gaits on any machine.
    #[must_use]
    pub fn tried(mut self, watch: &dyn Fn(&str) -> bool) -> Import {
        let candidates = self.candidates.iter().take_while(|candidate| watch(&candidate.name));
        let outcomes: Vec<Outcome> = candidates.map(|candidate| attempt(&self.robot, candidate)).collect();
        let verdicts: Vec<Verdict> = outcomes.iter().map(|outcome| verdict(outcome, &outcomes)).collect();
        // Who has none wants something to begin with all the same.
        let any = verdicts.iter().any(|verdict| verdict.found.is_some());
        self.gaits = if any { Vec::new() } else { untried(&self.candidates) };
        for Verdict { found, note } in verdicts {
            self.notes.extend(note);
            if let Some((found, text)) = found {
                self.gaits.push((file_name(&found.gait), text));
                self.found.push(found);
            }
        }
        self
    }
}

/// A gait that the robot can do.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub gait: String,
    /// At which a motion was found, from slow to fast, m/s.
    pub speeds: Vec<f64>,
}

/// A gait that is worth a file, with its text, and what a person should know of it.
struct Verdict {
    found: Option<(Found, String)>,
    note: Option<String>,
}

/// Files of the gaits that stay on the ground, with what is asked for first.
pub fn untried(candidates: &[Candidate]) -> Vec<(String, String)> {
    let grounded = candidates.iter().filter(|candidate| candidate.grounded.is_none());
    grounded.map(|candidate| (file_name(&candidate.name), candidate.file(&candidate.variants[0], &[]))).collect()
}

/// The first variant of which something is found, else the last one.
fn attempt<'c>(robot: &str, candidate: &'c Candidate) -> Outcome<'c> {
    let [first, less @ ..] = &candidate.variants;
    let mut outcome = attempt_variant(robot, candidate, first);
    for variant in less {
        if outcome.is_found() {
            break;
        }
        outcome = attempt_variant(robot, candidate, variant);
    }
    outcome
}

fn attempt_variant<'c>(robot: &str, candidate: &'c Candidate, variant: &'c Variant) -> Outcome<'c> {
    let (criterion, found) = (Criterion::Torque, Vec::new());
    let mut outcome = Outcome { candidate, variant, criterion, found, obstacle: String::new() };
    let file = |name: String, text: String| SpecFile { path: name, text };
    let files = RobotFiles {
        module: String::new(),
        robot: file("robot.toml".into(), robot.into()),
        gaits: vec![file(file_name(&candidate.name), candidate.file(variant, &[]))],
    };
    match Robot::new(files).and_then(|robot| robot.gait(&candidate.name)) {
        Ok(gait) => search(&gait, &mut outcome),
        Err(why) => outcome.obstacle = why.to_string(),
    }
    outcome
}

/// Looks for least torque, the smoother of the criteria, from slow to fast, until there is nothing any more. Where joints rub dry it
/// is torques that jump, and energy is the smoother.
fn search(gait: &dyn Gait, outcome: &mut Outcome) {
    let d = gait.description();
    if d.joints.iter().any(|joint| joint.coulomb > 0.0) {
        outcome.criterion = Criterion::Energy;
    }
    let natural = (d.gravity * d.leg_length()).sqrt();
    let mut known: Vec<Vec<f64>> = Vec::new();
    for (k, share) in SPEEDS.into_iter().enumerate() {
        let ended = if outcome.is_found() { known.is_empty() } else { k >= SLOW && !d.flies() };
        if ended {
            break;
        }
        let speed = rounded(share * natural, 2);
        let task = Task { gait, criterion: outcome.criterion, speed };
        let from = |starts| task.search(&Settings { starts: Some(starts), ..Settings::default() }, &known, &|_| {});
        let mut result = from(if known.is_empty() { STARTS } else { STARTS_BESIDE });
        if !result.is_optimal() && !known.is_empty() {
            // Before the robot is said to go no faster, its neighbour is not relied upon.
            result = from(STARTS);
        }
        if !result.is_optimal() && outcome.obstacle.is_empty() {
            outcome.obstacle = obstacle(&result);
        }
        known = result.theta().filter(|_| result.is_optimal()).into_iter().collect();
        outcome.found.push((speed, result.cost));
    }
}

fn obstacle(result: &GaitResult) -> String {
    let mut names: Vec<&str> = Vec::new();
    for conflict in &result.conflicts {
        if conflict.violation > 0.0 && !names.contains(&conflict.constraint.as_str()) {
            names.push(&conflict.constraint);
        }
    }
    if names.is_empty() { result.message.clone() } else { format!("in the way are {}", names.join(", ")) }
}

/// To so many digits.
fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits - 1).parse().unwrap_or(x)
}

fn verdict(outcome: &Outcome, all: &[Outcome]) -> Verdict {
    let candidate = outcome.candidate;
    let walk = candidate.grounded.as_ref().and_then(|name| all.iter().find(|other| other.candidate.name == *name));
    let mut runs = all.iter().filter(|other| other.candidate.grounded.as_ref() == Some(&candidate.name));
    let found = |name: &str, lines: &[String]| {
        let found = Found { gait: name.into(), speeds: outcome.speeds() };
        Some((found, candidate.file(outcome.variant, lines)))
    };
    match walk {
        // What is said of the walk says all.
        Some(_) if !outcome.is_found() => Verdict { found: None, note: None },
        None if !outcome.is_found() && runs.any(Outcome::is_found) => Verdict { found: None, note: None },
        None if !outcome.is_found() => {
            let note = format!("no {}: nothing was found {}: {}", candidate.name, outcome.asked(), outcome.obstacle);
            Verdict { found: None, note: Some(note) }
        }
        None => Verdict { found: found(&candidate.name, &outcome.lines()), note: None },
        Some(walk) if walk.is_found() && outcome.pays_beside(walk) => {
            Verdict { found: found(&candidate.name, &outcome.lines()), note: None }
        }
        Some(walk) if walk.is_found() => {
            let note =
                format!("no {}: it needs more than the {} wherever both go", candidate.name, walk.candidate.name);
            Verdict { found: None, note: Some(note) }
        }
        // Where only flight makes it possible, that is the gait.
        Some(walk) => {
            let name = &walk.candidate.name;
            let without = format!("without flight none was found {}", walk.asked());
            let lines = [outcome.lines(), vec![format!("It flies: {without}.")]].concat();
            Verdict {
                found: found(name, &lines),
                note: Some(format!("the {name} flies: {without}: {}", walk.obstacle)),
            }
        }
    }
}

impl Outcome<'_> {
    fn is_found(&self) -> bool {
        self.found.iter().any(|(_, cost)| cost.is_some())
    }

    fn speeds(&self) -> Vec<f64> {
        self.found.iter().filter(|(_, cost)| cost.is_some()).map(|(speed, _)| *speed).collect()
    }

    /// Whether it goes where the other does not, or needs less.
    fn pays_beside(&self, walk: &Outcome) -> bool {
        let beside = |speed: f64| walk.found.iter().find(|(known, _)| *known == speed).and_then(|(_, cost)| *cost);
        self.found.iter().any(|(speed, own)| own.is_some_and(|own| beside(*speed).is_none_or(|walk| own < PAYS * walk)))
    }

    /// What the gait's file says of it.
    fn lines(&self) -> Vec<String> {
        let mut reached: Vec<String> = Vec::new();
        let mut missed: Vec<String> = Vec::new();
        for (speed, cost) in &self.found {
            match cost {
                Some(cost) => reached.push(format!("{} at {speed} m/s", rounded(*cost, 5))),
                None => missed.push(format!("{speed}")),
            }
        }
        let (name, unit, reached) = (self.criterion.name(), self.criterion.unit(), reached.join(", "));
        let mut lines = vec![format!("Least {name} that a short search found, {unit} (local optima): {reached}.")];
        if !missed.is_empty() {
            lines.push(format!("It found nothing at {} m/s.", missed.join(", ")));
        }
        let asked = &self.candidate.variants[0];
        if self.variant != asked {
            let [now, first] = [self.variant, asked].map(|variant| 1e3 * variant.clearance);
            lines.push(format!("Swing feet keep {now:.1} mm off the ground: with {first:.1} mm it found nothing."));
        }
        lines
    }

    /// Speeds and clearances that were asked for.
    fn asked(&self) -> String {
        let speeds: Vec<String> = self.found.iter().map(|(speed, _)| speed.to_string()).collect();
        let clearances: Vec<String> =
            self.candidate.variants.iter().map(|v| format!("{:.1}", 1e3 * v.clearance)).collect();
        format!("at {} m/s with clearances of {} mm", speeds.join(", "), clearances.join(", "))
    }
}
