//! Answers a study's points: derived once, sought from the base robot's optima, verified each by itself.

use crate::row::{Beyond, Optimum, Pushed, Row, Slopes, Status};
use crate::study::{FEW, Point, Study};
use piaffe_interpreter::{Family, Interpreted, Robot, Unloadable};
use piaffe_model::Gait;
use piaffe_model::motion::{Criterion, Motion};
use piaffe_optimizer::finite::not_finite;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::{Expected, Found, Settings, search, search_from};
use piaffe_optimizer::sensitivity::sensitivities;
use piaffe_optimizer::stability::{PhaseTracking, stability};
use piaffe_optimizer::verdict::Verdict;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Optima of the base robot from which a point is sought, the best ones.
const CARRIED: usize = 3;

/// A study whose points can be answered.
pub struct Answers<'s> {
    study: &'s Study,
    /// Of each gait what its designs have in common.
    families: BTreeMap<&'s str, Result<Family, String>>,
    /// Of each point of the first design the optima of the base robot, as their variables Θ.
    base: Vec<Vec<Vec<f64>>>,
}

impl<'s> Answers<'s> {
    /// Derives the gaits and finds the base robot's optima, which takes some seconds. The study must have no
    /// [`faults`](Study::faults).
    pub fn new(study: &'s Study) -> Answers<'s> {
        // What differs is what differs between these; designs that are no robots have their say in their rows.
        let extremes = study.designs.extremes().into_iter().filter_map(|k| study.designs.robot(&study.robot, k).ok());
        let samples: Vec<Robot> = std::iter::once(study.robot.clone()).chain(extremes).collect();
        let family = |gait: &'s String| (gait.as_str(), Family::new(&samples, gait).map_err(|why| why.to_string()));
        let families: BTreeMap<_, _> = study.gaits.iter().map(family).collect();
        let of_base = |gait: &'s String| Some((gait.as_str(), member(&families, gait, &study.robot).ok()?));
        let gaits: BTreeMap<&str, Interpreted> = study.gaits.iter().filter_map(of_base).collect();
        let optima = |number: usize| {
            let Point { gait, criterion, speed, .. } = study.point(number);
            let settings = Settings { starts: None, seed: study.search.seed, ..Settings::default() };
            let found = gaits.get(gait).map(|gait| search(gait, criterion, speed, &settings, &|_| {}));
            let optima = found.into_iter().flat_map(|found| found.optima).take(CARRIED);
            optima.map(|optimum| optimum.local.theta).collect()
        };
        let base = (0..study.of_design()).into_par_iter().map(optima).collect();
        Answers { study, families, base }
    }

    /// The answers to these points, in their order; on all threads.
    pub fn rows(&self, points: &[usize]) -> Vec<Row> {
        points.par_iter().map(|point| self.row(*point)).collect()
    }

    /// The answer to a point.
    pub fn row(&self, number: usize) -> Row {
        self.answer(&self.study.point(number))
    }

    /// The answer to a point of a study of which this one is the [outline](Study::outline).
    pub fn answer(&self, point: &Point) -> Row {
        match self.gait(point) {
            Ok(gait) => self.of_gait(point, &gait),
            Err(why) => self.without(point, Status::NoRobot, brief(&why)),
        }
    }

    /// A point's whole result, as if it had been asked for alone: with its specification, and all that is told of an optimum.
    ///
    /// # Errors
    /// If there is no such robot.
    pub fn result(&self, number: usize) -> Result<(GaitResult, Interpreted), Unloadable> {
        let point = self.study.point(number);
        let gait = self.study.designs.robot(&self.study.robot, point.design)?.gait(point.gait)?;
        let found = self.found(&point, &gait);
        let settings = self.settings(None);
        let mut result = GaitResult::new(&gait, point.criterion, point.speed, &found, &settings, || 0.0);
        result.examine(&gait, settings.examination);
        Ok((result, gait))
    }

    fn gait(&self, point: &Point) -> Result<Interpreted, Unloadable> {
        let robot = self.study.designs.robot_with(&self.study.robot, point.numbers)?;
        member(&self.families, point.gait, &robot)
    }

    fn settings(&self, starts: Option<usize>) -> Settings {
        Settings { starts, seed: self.study.search.seed, ..Settings::default() }
    }

    fn found(&self, point: &Point, gait: &dyn Gait) -> Found {
        let (search, known) = (self.study.search, &self.base[point.number % self.study.of_design()]);
        let task = Task { gait, criterion: point.criterion, speed: point.speed };
        let from = |starts| search_from(&task, &self.settings(starts), known, Expected::Nothing, &|_| {});
        let found = from(Some(search.starts.unwrap_or(FEW)));
        // Few starts do not settle that there is nothing.
        if found.optima.is_empty() && search.starts.is_none() { from(None) } else { found }
    }

    fn of_gait(&self, point: &Point, gait: &dyn Gait) -> Row {
        let found = self.found(point, gait);
        let mut failed = None;
        for optimum in &found.optima {
            match self.verdict(point, gait, &optimum.local.motion) {
                Ok(verdict) if verdict.is_optimal() => {
                    let optimum = self.told(point, gait, &optimum.local.motion, verdict, &found);
                    if let Some(place) = not_finite(&optimum) {
                        let why = format!("{place} is not a finite number");
                        return self.without(point, Status::ReceiptFailed, why);
                    }
                    return Row { optimum: Some(optimum), ..self.empty(point, Status::Optimal) };
                }
                Ok(verdict) => failed = failed.or(Some(format!("no receipt: {}", verdict.reasons.join("; ")))),
                Err(why) => failed = failed.or(Some(format!("the motion could not be re-derived: {why}"))),
            }
        }
        if let Some(why) = failed {
            return self.without(point, Status::ReceiptFailed, why);
        }
        let GaitResult { status, message, conflicts, .. } =
            GaitResult::new(gait, point.criterion, point.speed, &found, &self.settings(None), || 0.0);
        let conflict = conflicts.into_iter().map(|entry| entry.constraint).collect();
        Row { conflict, ..self.without(point, status.into(), message) }
    }

    fn verdict(&self, point: &Point, gait: &dyn Gait, motion: &Motion) -> Result<Verdict, piaffe_verify::VerifyError> {
        let judge = if self.asked(Beyond::Certificate) { Verdict::new } else { Verdict::by_receipt };
        judge(gait, point.criterion, point.speed, motion)
    }

    fn told(&self, point: &Point, gait: &dyn Gait, motion: &Motion, verdict: Verdict, found: &Found) -> Optimum {
        let kkt_residual = verdict.kkt_residual().unwrap_or(f64::INFINITY);
        let Verdict { receipt, certificate, .. } = verdict;
        let stability = self.asked(Beyond::Stability).then(|| stability(gait, motion).ok()).flatten();
        Optimum {
            costs: receipt.costs,
            durations: motion.half_steps.iter().map(|h| h.duration).collect(),
            step_length: receipt.step_length,
            violation: receipt.max_violation,
            cycle_error: receipt.cycle_error,
            kkt_residual,
            least: receipt.least,
            active: once(receipt.active.into_iter().map(|finding| finding.constraint)),
            starts: found.effort.starts,
            successes: found.effort.successes,
            optima: found.effort.optima,
            certificate: certificate.map(|certificate| certificate.standing),
            slopes: self
                .asked(Beyond::Slopes)
                .then(|| self.slopes(point.criterion, point.speed, gait, motion))
                .flatten(),
            stability: stability.map(|stability| Pushed {
                by_clock: Some(stability.clock.factor).filter(|factor| factor.is_finite()),
                by_phase: match stability.phase {
                    PhaseTracking::Map { factor, .. } => Some(factor).filter(|factor| factor.is_finite()),
                    _ => None,
                },
            }),
        }
    }

    fn slopes(&self, criterion: Criterion, speed: f64, gait: &dyn Gait, motion: &Motion) -> Option<Slopes> {
        let all = sensitivities(gait, criterion, speed, motion).ok()?.slopes;
        let of = |name: &str| all.iter().find(|slope| slope.numbers.iter().any(|number| number == name));
        Some(Slopes {
            speed: of("speed")?.slope,
            numbers: self.study.designs.names().iter().map(|name| Some(of(&first(name))?.slope)).collect(),
        })
    }

    fn asked(&self, what: Beyond) -> bool {
        self.study.beyond.contains(&what)
    }

    fn without(&self, point: &Point, status: Status, why: String) -> Row {
        Row { reason: Some(why), ..self.empty(point, status) }
    }

    fn empty(&self, point: &Point, status: Status) -> Row {
        Row {
            point: point.number,
            design: point.design,
            numbers: point.numbers.to_vec(),
            gait: point.gait.into(),
            criterion: point.criterion,
            speed: point.speed,
            status,
            reason: None,
            conflict: Vec::new(),
            optimum: None,
        }
    }
}

/// The gait of a robot, by what it has in common with others.
fn member(
    families: &BTreeMap<&str, Result<Family, String>>,
    gait: &str,
    robot: &Robot,
) -> Result<Interpreted, Unloadable> {
    match families.get(gait) {
        Some(Ok(family)) => family.member(robot),
        // What cannot be derived for all may be for one.
        _ => robot.gait(gait),
    }
}

/// Names in their order, each once: what is active in several phases is named once.
fn once(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept: Vec<String> = Vec::new();
    for name in names {
        if !kept.contains(&name) {
            kept.push(name);
        }
    }
    kept
}

/// What is wrong with a specification in a line; all of it is told where the robot is asked for alone.
fn brief(why: &Unloadable) -> String {
    why.to_string().lines().next().unwrap_or_default().into()
}

/// The first of the names that one with braces stands for.
fn first(name: &str) -> String {
    piaffe_codegen::spec::alternatives(name).into_iter().next().unwrap_or_default()
}
