//! Answers a study's points: derived once, sought from the base robot's optima, verified each by itself.

use crate::row::{Beyond, Optimum, Outcome, Pushed, Row, Slopes};
use crate::study::{FEW, Point, Study};
use piaffe_interpreter::{Family, Interpreted, Robot, Unloadable};
use piaffe_model::Gait;
use piaffe_model::motion::Motion;
use piaffe_optimizer::altered::Altered;
use piaffe_optimizer::constraints::sharing::applies;
use piaffe_optimizer::finite::not_finite;
use piaffe_optimizer::result::{GaitResult, Status};
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::{Expected, Found, Settings, search_from};
use piaffe_optimizer::sensitivity::{Sensitivity, sensitivities};
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
    /// Of each point of the first design the optima of the base robot.
    base: Vec<Known>,
}

/// Optima, as their variables Θ, the best first.
struct Known {
    /// Without limits at each real leg.
    virtual_legs: Vec<Vec<f64>>,
    /// With them, if they are asked for.
    real_legs: Vec<Vec<f64>>,
}

/// What was found of a point.
struct Answer {
    found: Found,
    /// The criterion of the optimum without limits at each real leg, where it was looked for too.
    virtual_cost: Option<f64>,
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
            let point = study.point(number);
            gaits.get(point.gait).map_or(Known::NOTHING, |gait| Known::new(study, &point, gait))
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
            Ok(gait) => match self.limited(&gait) {
                Ok(None) => self.of_gait(point, &gait, &self.found(point, &gait, None)),
                Ok(Some(limited)) => self.of_gait(point, &limited, &self.found(point, &gait, Some(&limited))),
                Err(why) => self.without(point, Outcome::NoRobot, why),
            },
            Err(why) => self.without(point, Outcome::NoRobot, brief(&why)),
        }
    }

    /// A point's whole result, as if it had been asked for alone: with its specification, and all that is told of an optimum.
    ///
    /// # Errors
    /// If there is no such robot.
    pub fn result(&self, number: usize) -> Result<(GaitResult, Interpreted), Unloadable> {
        let point = self.study.point(number);
        let gait = self.study.designs.robot(&self.study.robot, point.design)?.gait(point.gait)?;
        let result = {
            let limited = self.limited(&gait).map_err(Unloadable::Specification)?;
            let Answer { found, virtual_cost } = self.found(&point, &gait, limited.as_ref());
            let of: &dyn Gait = limited.as_ref().map_or(&gait, |limited| limited);
            let settings = self.settings(None);
            let result = GaitResult::new(of, point.criterion, point.speed, &found, &settings, || 0.0);
            let mut result = GaitResult { virtual_cost, ..result };
            result.examine(of, settings.examination);
            result
        };
        Ok((result, gait))
    }

    /// The gait with its limits at each real leg, if that is asked for.
    ///
    /// # Errors
    /// If they cannot be imposed there.
    fn limited<'g>(&self, gait: &'g Interpreted) -> Result<Option<Altered<'g>>, String> {
        self.study.real_legs.then(|| Altered::at_real_legs(gait)).transpose()
    }

    fn gait(&self, point: &Point) -> Result<Interpreted, Unloadable> {
        let robot = self.study.designs.robot_with(&self.study.robot, point.numbers)?;
        member(&self.families, point.gait, &robot)
    }

    fn settings(&self, starts: Option<usize>) -> Settings {
        Settings { starts, seed: self.study.search.seed, ..Settings::default() }
    }

    /// What is found of a gait; with its limits at each real leg from the best optimum without them too, as where it is asked for alone.
    fn found(&self, point: &Point, gait: &dyn Gait, limited: Option<&Altered>) -> Answer {
        let known = &self.base[point.number % self.study.of_design()];
        let found = self.sought(point, gait, &known.virtual_legs);
        let Some(limited) = limited else { return Answer { found, virtual_cost: None } };
        let cost = |motion: &Motion| {
            let verdict = Verdict::by_receipt(gait, point.criterion, point.speed, motion).ok()?;
            verdict.is_optimal().then(|| verdict.receipt.costs.of(point.criterion))
        };
        let virtual_cost = found.optima.iter().find_map(|optimum| cost(&optimum.local.motion));
        if !applies(limited.description()) {
            // Equal shares keep to them.
            return Answer { found, virtual_cost };
        }
        let best = found.optima.first().map(|optimum| optimum.local.theta.clone());
        let from: Vec<_> = best.into_iter().chain(known.real_legs.clone()).collect();
        Answer { found: self.sought(point, limited, &from), virtual_cost }
    }

    /// From these optima and from starts that know nothing of them.
    fn sought(&self, point: &Point, gait: &dyn Gait, known: &[Vec<f64>]) -> Found {
        let search = self.study.search;
        let task = Task { gait, criterion: point.criterion, speed: point.speed };
        let from = |starts| search_from(&task, &self.settings(starts), known, Expected::Nothing, &|_| {});
        let found = from(Some(search.starts.unwrap_or(FEW)));
        // Few starts do not settle that there is nothing.
        if found.optima.is_empty() && search.starts.is_none() { from(None) } else { found }
    }

    fn of_gait(&self, point: &Point, gait: &dyn Gait, answer: &Answer) -> Row {
        let found = &answer.found;
        let mut failed = None;
        for optimum in &found.optima {
            match self.verdict(point, gait, &optimum.local.motion) {
                Ok(verdict) if verdict.is_optimal() => {
                    let optimum = self.told(point, gait, &optimum.local.motion, verdict, answer);
                    if let Some(place) = not_finite(&optimum) {
                        let why = format!("{place} is not a finite number");
                        return self.without(point, Outcome::Searched(Status::ReceiptFailed), why);
                    }
                    return Row { optimum: Some(optimum), ..self.empty(point, Outcome::Searched(Status::Optimal)) };
                }
                Ok(verdict) => failed = failed.or(Some(format!("no receipt: {}", verdict.reasons.join("; ")))),
                Err(why) => failed = failed.or(Some(format!("the motion could not be re-derived: {why}"))),
            }
        }
        if let Some(why) = failed {
            return self.without(point, Outcome::Searched(Status::ReceiptFailed), why);
        }
        let GaitResult { status, message, conflicts, .. } =
            GaitResult::new(gait, point.criterion, point.speed, found, &self.settings(None), || 0.0);
        let conflict = conflicts.into_iter().map(|entry| entry.constraint).collect();
        Row { conflict, ..self.without(point, Outcome::Searched(status), message) }
    }

    fn verdict(&self, point: &Point, gait: &dyn Gait, motion: &Motion) -> Result<Verdict, piaffe_verify::VerifyError> {
        let judge = if self.asked(Beyond::Certificate) { Verdict::new } else { Verdict::by_receipt };
        judge(gait, point.criterion, point.speed, motion)
    }

    fn told(&self, point: &Point, gait: &dyn Gait, motion: &Motion, verdict: Verdict, answer: &Answer) -> Optimum {
        let kkt_residual = verdict.kkt_residual().unwrap_or(f64::INFINITY);
        let Verdict { receipt, certificate, .. } = verdict;
        let effort = answer.found.effort;
        let stability = self.asked(Beyond::Stability).then(|| stability(gait, motion).ok()).flatten();
        Optimum {
            costs: receipt.costs,
            virtual_cost: answer.virtual_cost,
            durations: motion.durations().collect(),
            step_length: receipt.step_length,
            violation: receipt.max_violation,
            cycle_error: receipt.cycle_error,
            kkt_residual,
            least: receipt.least,
            active: once(receipt.active.into_iter().map(|finding| finding.constraint)),
            starts: effort.starts,
            successes: effort.successes,
            optima: effort.optima,
            certificate: certificate.map(|certificate| certificate.standing),
            slopes: self.asked(Beyond::Slopes).then(|| self.slopes(point, gait, motion)).flatten(),
            stability: stability.map(|stability| Pushed {
                by_clock: Some(stability.clock.factor).filter(|factor| factor.is_finite()),
                by_phase: match stability.phase {
                    PhaseTracking::Map { factor, .. } => Some(factor).filter(|factor| factor.is_finite()),
                    _ => None,
                },
            }),
        }
    }

    fn slopes(&self, point: &Point, gait: &dyn Gait, motion: &Motion) -> Option<Slopes> {
        let all = sensitivities(gait, point.criterion, point.speed, motion).ok()?.slopes;
        let names = self.study.designs.names().iter().zip(point.numbers);
        Some(Slopes {
            speed: all.iter().find(|slope| slope.parameter == "speed")?.slope,
            numbers: names.map(|(name, value)| slope_in(&all, name, *value)).collect(),
        })
    }

    fn asked(&self, what: Beyond) -> bool {
        self.study.beyond.contains(&what)
    }

    fn without(&self, point: &Point, status: Outcome, why: String) -> Row {
        Row { reason: Some(why), ..self.empty(point, status) }
    }

    fn empty(&self, point: &Point, status: Outcome) -> Row {
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

impl Known {
    const NOTHING: Known = Known { virtual_legs: Vec::new(), real_legs: Vec::new() };

    /// What is found of the base robot, for a point of any design.
    fn new(study: &Study, point: &Point, gait: &Interpreted) -> Known {
        let settings = Settings { seed: study.search.seed, ..Settings::default() };
        let found = |gait: &dyn Gait, from: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let task = Task { gait, criterion: point.criterion, speed: point.speed };
            let found = search_from(&task, &settings, from, Expected::Nothing, &|_| {});
            found.optima.into_iter().take(CARRIED).map(|optimum| optimum.local.theta).collect()
        };
        let virtual_legs = found(gait, &[]);
        let limited = study.real_legs.then(|| Altered::at_real_legs(gait).ok()).flatten();
        let limited = limited.filter(|limited| applies(limited.description()));
        let real_legs = limited.map_or(Vec::new(), |limited| found(&limited, &virtual_legs));
        Known { virtual_legs, real_legs }
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

/// The slope in all numbers that a name with braces stands for, which have this value or minus it. None where one of them must stay
/// like a number that is not among them.
fn slope_in(all: &[Sensitivity], name: &str, value: f64) -> Option<f64> {
    let names = piaffe_codegen::spec::alternatives(name);
    let is_named = |number: &String| names.contains(number);
    let of_these: Vec<_> = all.iter().filter(|slope| slope.numbers.iter().any(is_named)).collect();
    let whole = !of_these.is_empty() && of_these.iter().all(|slope| slope.numbers.iter().all(is_named));
    let towards = |slope: &Sensitivity| if slope.value * value < 0.0 { -slope.slope } else { slope.slope };
    whole.then(|| of_these.into_iter().map(towards).sum())
}

#[cfg(test)]
mod tests {
    use super::{Sensitivity, slope_in};

    #[test]
    fn a_slope_is_in_all_numbers_of_a_name_and_in_no_other() {
        let of = |numbers: &[&str], value: f64, slope: f64| Sensitivity {
            parameter: numbers.join(","),
            numbers: numbers.iter().map(ToString::to_string).collect(),
            unit: "m".into(),
            value,
            slope,
            elasticity: 0.0,
        };
        let all = [of(&["fore.x", "hind.x"], 0.2, 3.0), of(&["shin.x"], -0.2, 5.0), of(&["com.x"], 0.0, 7.0)];
        let slope = |name: &str, value: f64| slope_in(&all, name, value);
        assert_eq!(slope("{fore,hind}.x", 0.2), Some(3.0));
        assert_eq!(slope("{fore,hind}.x", -0.2), Some(-3.0), "towards the other side");
        assert_eq!(slope("{fore,hind,shin}.x", 0.2), Some(-2.0), "what is of the other sign stays so");
        assert_eq!(slope("{fore,tail}.x", 0.2), None, "the hind one must stay like the fore one");
        assert_eq!(slope("{shin,tail}.x", -0.2), Some(5.0), "on some of them nothing depends");
        assert_eq!([slope("com.x", 0.0), slope("tail.x", 0.2)], [Some(7.0), None]);
    }
}
