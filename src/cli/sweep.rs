//! `piaffe sweep`: optima over speeds, greatest speeds and crossovers, resumed where an earlier run stopped.

use super::journal::{Folder, effort, file};
use super::{output, report};
use indicatif::{ProgressBar, ProgressStyle};
use piaffe::altered::Altered;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::result::{GaitResult, Status};
use piaffe::search::atlas::{VISITS, sweep};
use piaffe::search::crossover::{Comparison, compare};
use piaffe::search::fastest::{MaximumSpeed, maximum_speed};
use piaffe::search::multi_start::Settings;
use rayon::prelude::*;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// One gait over all speeds.
struct Line {
    gait: &'static dyn Gait,
    maximum: Option<MaximumSpeed>,
    /// Per criterion: the points of the sweep, then the one at the greatest speed.
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
    let folder = Folder::open(path, progress(gaits.iter().map(|g| visits * effort(*g)).sum()))?;
    folder.compare(&gaits.iter().map(|g| *g as &dyn Gait).collect::<Vec<_>>(), criteria, speeds, settings);
    let lines: Vec<Line> = gaits.par_iter().map(|gait| line(*gait, criteria, speeds, settings, &folder)).collect();
    folder.bar.set_message("crossovers");
    let mut comparisons = Vec::new();
    for c in 0..criteria.len() {
        for (k, a) in lines.iter().enumerate() {
            for b in &lines[k + 1..] {
                comparisons.extend(compare([a.gait, b.gait], [&a.results[c], &b.results[c]], settings, &folder));
            }
        }
    }
    folder.bar.finish_and_clear();
    if let Some(error) = folder.failure() {
        return Err(error);
    }
    let all = || lines.iter().flat_map(|line| line.results.iter().flatten());
    for result in all() {
        folder.write(result)?;
    }
    let summary = serde_json::to_value(Summary::new(&lines, &comparisons))?;
    output::write_json(&path.join("sweep.json"), &summary)?;
    output::quiet_when_closed(tell(&lines, criteria, speeds, &comparisons))?;
    output::say!("results in {}", path.display());
    let any = all().any(GaitResult::is_optimal);
    if any {
        let page = report::write(all().cloned().collect(), serde_json::from_value(summary)?, None, path)?;
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

fn line(gait: &'static dyn Gait, criteria: &[Criterion], speeds: &[f64], settings: &Settings, folder: &Folder) -> Line {
    let mut results = sweep(gait, criteria, speeds, settings, folder);
    let maximum = maximum_speed(gait, &results.concat(), settings, folder);
    for (line, criterion) in results.iter_mut().zip(criteria) {
        let new = maximum.iter().filter(|m| !speeds.contains(&m.speed));
        line.extend(new.map(|m| m.optimum(gait, *criterion, settings, folder)));
        line.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    }
    Line { gait, maximum, results }
}

/// A bar in units of effort, with what is left; hidden where standard error is no terminal.
fn progress(effort: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {bar:30} {percent} % {elapsed}, about {eta} left");
    let bar = if output::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(effort) };
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message("optima")
}

/// What `sweep.json` holds.
#[derive(Serialize)]
struct Summary<'a> {
    points: Vec<PointEntry<'a>>,
    maximum_speeds: Vec<MaximumEntry<'a>>,
    comparisons: &'a [Comparison],
}

#[derive(Serialize)]
struct PointEntry<'a> {
    gait: &'a str,
    criterion: Criterion,
    speed: f64,
    status: Status,
    cost: Option<f64>,
    durations: &'a [f64],
    /// Costs of all local optima that were found.
    local_optima: Vec<f64>,
    file: String,
}

#[derive(Serialize)]
struct MaximumEntry<'a> {
    gait: &'a str,
    speed: f64,
    ended_by: &'a [String],
}

impl<'a> Summary<'a> {
    fn new(lines: &'a [Line], comparisons: &'a [Comparison]) -> Summary<'a> {
        let point = |r: &'a GaitResult| PointEntry {
            gait: &r.gait,
            criterion: r.criterion,
            speed: r.speed,
            status: r.status,
            cost: r.cost,
            durations: &r.durations,
            local_optima: r.local_optima.iter().map(|o| o.cost).collect(),
            file: file(&r.gait, r.criterion, r.speed),
        };
        let maximum = |line: &'a Line| {
            let MaximumSpeed { speed, ended_by, .. } = line.maximum.as_ref()?;
            Some(MaximumEntry { gait: line.gait.description().key, speed: *speed, ended_by })
        };
        Summary {
            points: lines.iter().flat_map(|line| line.results.iter().flatten()).map(point).collect(),
            maximum_speeds: lines.iter().filter_map(maximum).collect(),
            comparisons,
        }
    }
}

fn tell(lines: &[Line], criteria: &[Criterion], speeds: &[f64], comparisons: &[Comparison]) -> std::io::Result<()> {
    let mut out = output::person();
    out.write_all(table(lines, criteria, speeds).as_bytes())?;
    for line in lines {
        let name = line.gait.description().key;
        match &line.maximum {
            Some(m) => {
                let weightiest = &m.ended_by[..m.ended_by.len().min(3)];
                let why = if weightiest.is_empty() { "no single constraint".into() } else { weightiest.join(", ") };
                writeln!(out, "{name} goes up to {:.3} m/s; what stops it: {why}", m.speed)?;
            }
            None => writeln!(out, "{name}: no greatest speed found")?,
        }
    }
    for comparison in comparisons {
        writeln!(out, "{}", words(comparison, lines))?;
    }
    Ok(())
}

/// Costs over speeds, a column per gait and criterion; a dash where there is no optimum.
fn table(lines: &[Line], criteria: &[Criterion], speeds: &[f64]) -> String {
    let mut text = format!("{:>8}", "m/s");
    for criterion in criteria {
        for line in lines {
            text += &format!(" {:>16}", format!("{} {}", line.gait.description().key, criterion.name()));
        }
    }
    text.push('\n');
    for speed in speeds {
        text += &format!("{speed:>8.3}");
        for c in 0..criteria.len() {
            for line in lines {
                let cost = line.results[c].iter().find(|r| r.speed == *speed).and_then(|r| r.cost);
                text += &format!(" {:>16}", cost.map_or("-".into(), |cost| format!("{cost:.4}")));
            }
        }
        text.push('\n');
    }
    text
}

/// Which of two gaits is cheaper where, and why the comparison ends.
fn words(comparison: &Comparison, lines: &[Line]) -> String {
    let other = |name: &str| comparison.gaits.iter().find(|g| *g != name).map_or("", String::as_str).to_string();
    let [_, last] = comparison.common;
    let mut cheaper = comparison.cheaper.clone();
    let mut text = format!("{}: ", comparison.criterion.name());
    for x in &comparison.crossovers {
        let [below, above] = x.bracket;
        let at = match above - below < 1e-3 {
            true => format!("at {:.3}", 0.5 * (below + above)),
            false => format!("between {below:.3} and {above:.3}"),
        };
        text += &format!("{} overtakes {} {at} m/s; ", x.to, other(&x.to));
        cheaper.clone_from(&x.to);
    }
    let ends = lines.iter().find(|line| line.maximum.as_ref().is_some_and(|m| m.speed == last));
    let until = match ends.map(|line| line.gait.description().key) {
        Some(gait) => format!("until the {gait} ends"),
        None => "to the end of the sweep".into(),
    };
    text + &format!("{cheaper} is cheaper than {} {until} at {last:.3} m/s", other(&cheaper))
}

/// `0.1..1.6:0.1` or `0.3,0.6,0.9`, in m/s.
pub fn parse_speeds(text: &str) -> Result<Vec<f64>, String> {
    let number = |t: &str| match t.trim().parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        _ => Err(format!("`{t}` is not a positive speed; write 0.1..1.6:0.1 or 0.3,0.6,0.9")),
    };
    let mut speeds = if let Some((range, step)) = text.split_once(':') {
        let (from, to) = range.split_once("..").ok_or("a range reads FROM..TO:STEP, for example 0.1..1.6:0.1")?;
        let (from, to, step) = (number(from)?, number(to)?, number(step)?);
        let count = ((to - from) / step + 1e-9).floor();
        if !(0.0..10_000.0).contains(&count) {
            return Err("the range has no or too many speeds".into());
        }
        // Multiples of the step, free of accumulated rounding.
        (0..=count as usize).map(|k| ((from + k as f64 * step) * 1e9).round() / 1e9).collect()
    } else {
        text.split(',').map(number).collect::<Result<Vec<_>, _>>()?
    };
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    Ok(speeds)
}

#[cfg(test)]
mod tests {
    use super::parse_speeds;

    #[test]
    fn ranges_and_lists_are_speeds() {
        assert_eq!(parse_speeds("0.1..0.4:0.1").unwrap(), [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(parse_speeds("0.6,0.3").unwrap(), [0.3, 0.6]);
        assert!(parse_speeds("0.1..").is_err() && parse_speeds("fast").is_err() && parse_speeds("1..0.5:0.1").is_err());
    }
}
