//! `piaffe sweep`: optima over speeds, greatest speeds and crossovers, resumed where an earlier run stopped.

use super::digits::decimal;
use super::document::OVERVIEW;
use super::journal::{Folder, effort};
use super::progress::{Counted, Progress};
use super::{output, report, speed};
use piaffe_model::digits::digits;
use piaffe_model::motion::Criterion;
use piaffe_model::{Contradiction, Gait};
use piaffe_optimizer::altered::Altered;
use piaffe_optimizer::examine::Examination;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::search::atlas::{self, VISITS};
use piaffe_optimizer::search::crossover::{Comparison, solve};
use piaffe_optimizer::search::fastest::{MaximumSpeed, maximum_speed};
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_report::overview::{Greatest, Overview};
use piaffe_report::{Record, is_one_speed, told_apart};
use piaffe_study::{multiples, steps};
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;

/// One gait over all speeds.
struct Line {
    gait: &'static dyn Gait,
    maximum: Option<MaximumSpeed>,
    /// Per criterion, by speed: the points of the sweep, the one at the greatest speed, and those next to crossovers.
    results: Vec<Vec<GaitResult>>,
}

pub fn run(
    gaits: &[&'static dyn Gait],
    real_legs: bool,
    criteria: &[Criterion],
    speeds: &[f64],
    path: &Path,
    settings: &Settings,
) -> anyhow::Result<bool> {
    let gaits = &if real_legs { at_real_legs(gaits)? } else { gaits.to_vec() };
    let visits = VISITS * (criteria.len() * speeds.len()) as u64;
    let work = gaits.iter().map(|g| visits * effort(*g)).sum();
    let folder = Folder::open(path, Progress::new(Counted::Work(work)).of("optima"))?;
    folder.compare(&gaits.iter().map(|g| *g as &dyn Gait).collect::<Vec<_>>(), criteria, speeds, settings);
    let of_gait = |gait: &&'static dyn Gait| atlas::Line {
        gait: *gait,
        results: atlas::sweep(*gait, criteria, speeds, settings, &folder),
    };
    let mut found: Vec<atlas::Line> = gaits.par_iter().map(of_gait).collect();
    folder.bar.set_message("from gait to gait");
    atlas::share(&mut found, settings, &folder);
    folder.bar.set_message("greatest speeds");
    let to_its_end =
        |(gait, found): (&&'static dyn Gait, atlas::Line)| line(*gait, found.results, criteria, settings, &folder);
    let mut lines: Vec<Line> = gaits.par_iter().zip(found).map(to_its_end).collect();
    folder.bar.set_message("crossovers");
    let mut further = Vec::new();
    for c in 0..criteria.len() {
        for (k, a) in lines.iter().enumerate() {
            for (l, b) in lines.iter().enumerate().skip(k + 1) {
                let [of_a, of_b] = solve([a.gait, b.gait], [&a.results[c], &b.results[c]], settings, &folder);
                further.extend([(k, c, of_a), (l, c, of_b)]);
            }
        }
    }
    for (line, c, results) in further {
        lines[line].add(c, results);
    }
    folder.bar.set_message("examination");
    lines.par_iter_mut().for_each(|line| line.examine(settings.examination));
    folder.bar.finish_and_clear();
    if let Some(error) = folder.failure() {
        return Err(error);
    }
    let all = || lines.iter().flat_map(|line| line.results.iter().flatten());
    for result in all() {
        folder.write(result)?;
    }
    let overview = Overview::new(&all().cloned().collect::<Vec<_>>(), &ends(&lines));
    output::write_json(&path.join(OVERVIEW), &overview)?;
    let any = all().any(GaitResult::is_optimal);
    let records = || lines.iter().flat_map(Line::records).collect();
    let page = any.then(|| report::write(records(), overview.clone().extremes(), None, path)).transpose()?;
    output::quiet_when_closed(tell(&lines, criteria, speeds, &overview))?;
    output::say!("results in {}", path.display());
    if let Some(page) = page {
        output::say!("To be seen in {}", page.display());
    }
    Ok(any)
}

/// The gaits with their limits at each real leg.
fn at_real_legs(gaits: &[&'static dyn Gait]) -> anyhow::Result<Vec<&'static dyn Gait>> {
    let altered = |gait: &&'static dyn Gait| {
        let altered = Altered::at_real_legs(*gait).map_err(anyhow::Error::msg)?;
        // Until the program ends, like all other gaits.
        Ok(Box::leak(Box::new(altered)) as &'static dyn Gait)
    };
    gaits.iter().map(altered).collect()
}

/// With the greatest speed, and the optima there.
fn line(
    gait: &'static dyn Gait,
    mut results: Vec<Vec<GaitResult>>,
    criteria: &[Criterion],
    settings: &Settings,
    folder: &Folder,
) -> Line {
    let mut maximum = maximum_speed(gait, &results.concat(), settings, folder);
    if let Some(maximum) = &mut maximum {
        let fastest = maximum.optima(gait, criteria, &results, settings, folder);
        for (line, new) in results.iter_mut().zip(fastest) {
            line.push(new);
            line.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        }
    }
    Line { gait, maximum, results }
}

impl Line {
    /// Adds results of a criterion at speeds that are not there yet.
    fn add(&mut self, criterion: usize, results: Vec<GaitResult>) {
        let line = &mut self.results[criterion];
        for result in results {
            let place = line.partition_point(|r| r.speed < result.speed);
            if line.get(place).is_none_or(|r| r.speed != result.speed) {
                line.insert(place, result);
            }
        }
    }

    /// Adds to all results what is told beyond their verdict.
    fn examine(&mut self, examination: Examination) {
        let gait = self.gait;
        self.results.par_iter_mut().flatten().for_each(|result| result.examine(gait, examination));
    }

    /// What keeps the gait from any motion, at whatever speed.
    fn contradictions(&self) -> Vec<Contradiction> {
        self.gait.description().contradictions()
    }

    fn records(&self) -> Vec<Record<'static>> {
        self.results.iter().flatten().map(|r| Record::issued(r.clone(), self.gait)).collect()
    }
}

/// Where the search found that the gaits end.
fn ends(lines: &[Line]) -> Vec<Greatest> {
    let end = |line: &Line| {
        let MaximumSpeed { speed, ended_by, .. } = line.maximum.clone()?;
        Some(Greatest { gait: line.gait.description().key.into(), speed, ended_by })
    };
    lines.iter().filter_map(end).collect()
}

fn tell(lines: &[Line], criteria: &[Criterion], speeds: &[f64], overview: &Overview) -> std::io::Result<()> {
    let mut out = output::person();
    let mut speeds: Vec<f64> = speeds.iter().copied().chain(overview.maximum_speeds.iter().map(|m| m.speed)).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    out.write_all(table(lines, criteria, &speeds).as_bytes())?;
    let told = |line: &&Line| line.contradictions().is_empty();
    for hole in lines.iter().filter(told).flat_map(|line| line.results.iter().flatten()).filter(|r| !r.is_optimal()) {
        writeln!(out, "{}, {} at {} m/s: {}", hole.gait, hole.criterion.name(), digits(hole.speed), hole.message)?;
    }
    for line in lines {
        let name = line.gait.description().key;
        match overview.maximum_speeds.iter().find(|m| m.gait == name) {
            Some(m) => {
                let weightiest = &m.ended_by[..m.ended_by.len().min(3)];
                let why = if weightiest.is_empty() { "no single constraint".into() } else { weightiest.join(", ") };
                writeln!(out, "{name} goes up to {} m/s; what stops it: {why}", decimal(m.speed, 3))?;
            }
            None if line.results.iter().flatten().any(GaitResult::is_optimal) => {
                writeln!(out, "{name}: no greatest speed found")?;
            }
            None if line.contradictions().is_empty() => writeln!(out, "{name}: no optimum at any of these speeds")?,
            None => line.contradictions().iter().try_for_each(|why| writeln!(out, "{name}: {why}"))?,
        }
    }
    for comparison in &overview.comparisons {
        writeln!(out, "{}", words(comparison, &overview.maximum_speeds))?;
    }
    Ok(())
}

/// Costs over speeds, a column per gait and criterion; a dash where no optimum was found, nothing where none was sought.
fn table(lines: &[Line], criteria: &[Criterion], speeds: &[f64]) -> String {
    let mut text = format!("{:>8}", "m/s");
    for criterion in criteria {
        for line in lines {
            text += &format!(" {:>16}", format!("{} {}", line.gait.description().key, criterion.name()));
        }
    }
    text.push('\n');
    for speed in speeds {
        text += &format!("{:>8}", decimal(*speed, 3));
        for c in 0..criteria.len() {
            for line in lines {
                let cell = match line.results[c].iter().find(|r| r.speed == *speed) {
                    Some(result) => result.cost.map_or("-".into(), |cost| decimal(cost, 4)),
                    None => String::new(),
                };
                text += &format!(" {cell:>16}");
            }
        }
        text.push('\n');
    }
    text
}

/// Which of two gaits is cheaper where, and why the comparison ends.
fn words(comparison: &Comparison, ends: &[Greatest]) -> String {
    let other = |name: &str| comparison.gaits.iter().find(|g| *g != name).map_or("", String::as_str).to_string();
    let [_, last] = comparison.common;
    let mut cheaper = comparison.cheaper.clone();
    let mut text = format!("{}: ", comparison.criterion.name());
    for x in &comparison.crossovers {
        let [below, above] = x.bracket;
        let at = if is_one_speed(x.bracket) {
            format!("at {}", decimal(0.5 * (below + above), 3))
        } else {
            let [below, above] = told_apart(x.bracket);
            format!("between {below} and {above}")
        };
        let jumps = [0, 1].into_iter().filter(|gait| x.jumps(*gait)).map(|gait| {
            let [below, above] = x.costs.map(|costs| decimal(costs[gait], 2));
            format!(
                ", where the {} jumps from {below} to {above}: no optimum was followed across",
                comparison.gaits[gait]
            )
        });
        text += &format!("{} overtakes {} {at} m/s{}; ", x.to, other(&x.to), jumps.collect::<String>());
        cheaper.clone_from(&x.to);
    }
    let until = match ends.iter().find(|end| end.speed == last) {
        Some(end) => format!("until the {} ends", end.gait),
        None => "to the end of the sweep".into(),
    };
    text + &format!("{cheaper} is cheaper than {} {until} at {} m/s", other(&cheaper), decimal(last, 3))
}

/// More speeds than this are a slip of the pen.
const MOST: usize = 10_000;

/// `0.1..1.6:0.1` or `0.3,0.6,0.9`, in m/s.
pub fn parse_speeds(text: &str) -> Result<Vec<f64>, String> {
    let number = |t: &str| speed(t.trim()).map_err(|why| format!("`{}` {why}", t.trim()));
    let mut speeds = if let Some((range, step)) = text.split_once(':') {
        let (from, to) = range.split_once("..").ok_or("a range reads FROM..TO:STEP, for example 0.1..1.6:0.1")?;
        let (from, to, step) = (number(from)?, number(to)?, number(step)?);
        if to < from {
            let [to, from, step] = [to, from, step].map(digits);
            return Err(format!("the range ends below its beginning: write {to}..{from}:{step}"));
        }
        let count = steps(from, to, step);
        if count >= MOST as f64 {
            return Err(format!("the range has {count:.3e} speeds, which is more than {MOST}: take a greater step"));
        }
        if from + step == from {
            let [from, step] = [from, step].map(digits);
            return Err(format!("a step of {step} is nothing beside {from}: take a greater step"));
        }
        multiples(from, step, count as usize)
    } else if text.contains("..") {
        return Err("a range reads FROM..TO:STEP, for example 0.1..1.6:0.1".into());
    } else {
        text.split(',').map(number).collect::<Result<Vec<_>, _>>()?
    };
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    match speeds.len() {
        count if count > MOST => Err(format!("these are {count} speeds, which is more than {MOST}")),
        _ => Ok(speeds),
    }
}

#[cfg(test)]
mod tests {
    use super::parse_speeds;

    #[test]
    fn ranges_and_lists_are_speeds() {
        assert_eq!(parse_speeds("0.1..0.4:0.1").unwrap(), [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(parse_speeds("0.6,0.3, 0.6").unwrap(), [0.3, 0.6]);
        assert_eq!(parse_speeds("1..1:1").unwrap(), [1.0]);
        assert_eq!(parse_speeds("0.1..1.6:0.1").unwrap().len(), 16);
        for bad in
            ["0.1..", "0.1..0.2", "fast", "1..0.5:0.1", "", ",", "0.6,", "0.6,-0.3", "0.6,nan", "0,0.6", "0.1..0.2:0"]
        {
            assert!(parse_speeds(bad).is_err(), "{bad}");
        }
    }

    /// However odd a range is: all its speeds are positive and finite, and they differ, or it is refused.
    #[test]
    fn ranges_have_no_speeds_that_are_none() {
        assert_eq!(parse_speeds("1e-10..3e-10:1e-10").unwrap(), [1e-10, 2e-10, 3e-10]);
        assert_eq!(parse_speeds("0.60001,0.60002").unwrap(), [0.60001, 0.60002]);
        let numbers = ["1e-320", "1e-12", "1e-9", "1e-5", "0.1", "0.6", "1", "1e3", "1e17", "1e300", "1e308", "inf"];
        let mut accepted = 0;
        for from in numbers {
            for to in numbers {
                for step in numbers {
                    let range = format!("{from}..{to}:{step}");
                    let Ok(speeds) = parse_speeds(&range) else { continue };
                    accepted += 1;
                    assert!(
                        !speeds.is_empty() && speeds.iter().all(|v| v.is_finite() && *v > 0.0),
                        "{range}: {speeds:?}"
                    );
                    assert!(speeds.is_sorted_by(|a, b| a < b), "{range}: {speeds:?}");
                }
            }
        }
        assert!(accepted > 50, "{accepted}");
    }
}
