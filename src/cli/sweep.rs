//! `piaffe sweep`: optima over speeds, resumed where an earlier run stopped.

use super::optimize::progress;
use super::{input, output};
use indicatif::ProgressBar;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::search::atlas::{Crossover, Journal, MaximumSpeed, crossovers, maximum_speed, sweep};
use piaffe::search::multi_start::Settings;
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The summary of a sweep, as it is written beside its points.
#[derive(Serialize)]
struct Summary {
    points: Vec<PointEntry>,
    maximum_speeds: Vec<MaximumSpeed>,
    crossovers: Vec<Crossover>,
}

#[derive(Serialize)]
struct PointEntry {
    gait: String,
    criterion: Criterion,
    speed: f64,
    status: piaffe::result::Status,
    cost: Option<f64>,
    durations: Vec<f64>,
    file: String,
}

/// Writes every result as it is found; finds those of earlier runs.
struct Folder {
    path: PathBuf,
    settings: Settings,
    bar: ProgressBar,
    failure: Mutex<Option<anyhow::Error>>,
}

/// Name of a point's file.
fn file(gait: &str, criterion: Criterion, speed: f64) -> String {
    format!("{gait}-{}-{speed:.4}.json", criterion.name())
}

impl Journal for Folder {
    fn known(&self, gait: &dyn Gait, criterion: Criterion, speed: f64) -> Option<GaitResult> {
        let d = gait.description();
        let path = self.path.join(file(d.gait, criterion, speed));
        let result: GaitResult = path.exists().then(|| input::read_json(&path.to_string_lossy()).ok()).flatten()?;
        // Another robot, version or search: to be done again.
        let same = result.fingerprint == d.fingerprint()
            && result.version == env!("CARGO_PKG_VERSION")
            && result.search.seed == self.settings.seed
            && result.speed == speed
            && result.criterion == criterion;
        same.then_some(result)
    }

    fn record(&self, result: &GaitResult) {
        let path = self.path.join(file(&result.gait, result.criterion, result.speed));
        if let (Err(error), Ok(mut failure)) = (output::write_json(&path, result), self.failure.lock()) {
            failure.get_or_insert(error);
        }
    }

    fn advance(&self) {
        self.bar.inc(1);
    }
}

pub fn run(
    gaits: &[&'static dyn Gait],
    criteria: &[Criterion],
    speeds: &[f64],
    folder: &Path,
    settings: &Settings,
) -> anyhow::Result<bool> {
    std::fs::create_dir_all(folder).map_err(|e| anyhow::anyhow!("cannot create {}: {e}", folder.display()))?;
    let bar = progress((gaits.len() * criteria.len() * speeds.len()) as u64, "points");
    let journal = Folder { path: folder.into(), settings: settings.clone(), bar, failure: Mutex::new(None) };
    let lines: Vec<Vec<Vec<GaitResult>>> =
        gaits.par_iter().map(|gait| sweep(*gait, criteria, speeds, settings, &journal)).collect();
    journal.bar.set_message("greatest speeds");
    let maximum_speeds: Vec<MaximumSpeed> = gaits
        .par_iter()
        .zip(&lines)
        .filter_map(|(gait, lines)| maximum_speed(*gait, &lines.iter().flatten().collect::<Vec<_>>(), settings))
        .collect();
    journal.bar.finish_and_clear();
    if let Some(error) = journal.failure.into_inner().ok().flatten() {
        return Err(error);
    }
    let mut crossings = Vec::new();
    for c in 0..criteria.len() {
        for a in 0..lines.len() {
            for b in a + 1..lines.len() {
                crossings.extend(crossovers(&lines[a][c], &lines[b][c]));
            }
        }
    }
    table(&lines, criteria, speeds)?;
    for m in &maximum_speeds {
        let why = m.ended_by.first().map_or("no single constraint", String::as_str);
        println!("{:<8} goes up to {:.3} m/s: then {why}", m.gait, m.speed);
    }
    for x in &crossings {
        println!("{:<8} {} overtakes {} at {:.2} m/s", x.criterion.name(), x.faster, x.slower, x.speed);
    }
    let points = lines
        .iter()
        .flatten()
        .flatten()
        .map(|r| PointEntry {
            gait: r.gait.clone(),
            criterion: r.criterion,
            speed: r.speed,
            status: r.status,
            cost: r.cost,
            durations: r.durations.clone(),
            file: file(&r.gait, r.criterion, r.speed),
        })
        .collect();
    output::write_json(&folder.join("sweep.json"), &Summary { points, maximum_speeds, crossovers: crossings })?;
    println!("results in {}", folder.display());
    Ok(lines.iter().flatten().flatten().any(GaitResult::is_optimal))
}

/// Costs over speeds, a column per gait and criterion; a dash where there is no optimum.
fn table(lines: &[Vec<Vec<GaitResult>>], criteria: &[Criterion], speeds: &[f64]) -> anyhow::Result<()> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let mut text = format!("{:>8}", "m/s");
    for (c, criterion) in criteria.iter().enumerate() {
        for line in lines {
            let gait = line[c].first().map_or("", |r| r.gait.as_str());
            text += &format!(" {:>16}", format!("{gait} {}", criterion.name()));
        }
    }
    text.push('\n');
    for (k, speed) in speeds.iter().enumerate() {
        text += &format!("{speed:>8.3}");
        for c in 0..criteria.len() {
            for line in lines {
                text += &format!(" {:>16}", line[c][k].cost.map_or("-".into(), |cost| format!("{cost:.4}")));
            }
        }
        text.push('\n');
    }
    output::quiet_when_closed(out.write_all(text.as_bytes()))
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
