//! `piaffe report`: results as a page with figures.

use super::document::{self, Document, OVERVIEW, Stated};
use super::{input, output, robots, whole};
use anyhow::{Context, bail};
use piaffe_optimizer::result::GaitResult;
use piaffe_report::{Extremes, Record, Report};
use piaffe_study::difference::{changed, same_robot};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Reads results from files and folders and writes their report to `out`. What a result states is derived anew before it is
/// shown; what cannot be read is told and left out.
pub fn run(paths: &[PathBuf], detail: Option<f64>, out: &Path) -> anyhow::Result<bool> {
    let mut all = Vec::new();
    let mut extremes = Extremes::default();
    let mut unread = 0;
    for path in paths {
        let files = match path.is_dir() {
            // The results of a sweep are those that its overview names.
            true if path.join(OVERVIEW).exists() => Ok(vec![path.join(OVERVIEW)]),
            true => document::files(path),
            false => Ok(vec![path.clone()]),
        };
        let files = files.unwrap_or_else(|error| {
            output::error(&error);
            unread += 1;
            Vec::new()
        });
        for file in files {
            let results = match document::read(&file) {
                Ok(Document::Results(results)) => results,
                Ok(Document::Sweep(sweep)) => {
                    let results: Vec<GaitResult> = sweep.results.iter().map(|r| r.result.clone()).collect();
                    let audit = sweep.overview.audit(&sweep.value, &results);
                    if let Some(d) = audit.statements.iter().flat_map(|s| &s.differences).next() {
                        let (stated, found) = (&d.stated, &d.found);
                        bail!(
                            "{} states {stated} for {}, but its results give {found}; sweep again",
                            sweep.name,
                            d.place
                        );
                    }
                    extremes.maximum_speeds.extend(sweep.overview.extremes().maximum_speeds);
                    sweep.results.into_iter().map(Ok).collect()
                }
                Err(error) => vec![Err(error)],
            };
            for result in results {
                match result {
                    Ok(result) => all.push(result),
                    Err(error) => {
                        output::error(&error);
                        unread += 1;
                    }
                }
            }
        }
    }
    if all.is_empty() && unread > 0 {
        bail!("none of the results could be read");
    }
    // Gaits one after another: what is derived for one result is shared by all threads.
    let of_gaits: Vec<_> = different(all)?.into_iter().map(|result| (robots::of(&result), result)).collect();
    let names = designs(of_gaits.iter().map(|(_, result)| result));
    let record = |((gait, result), name): ((Result<_, String>, GaitResult), Option<String>)| match gait {
        Ok(gait) => Record::read(result, &[gait]).named(name),
        Err(why) => Record::unreadable(result, why).named(name),
    };
    let mut records: Vec<Record> = of_gaits.into_par_iter().zip(names).map(record).collect();
    let keys = robots::keys().unwrap_or_default();
    let place = |r: &GaitResult| keys.iter().position(|key| *key == r.gait);
    records.sort_by(|a, b| {
        let (a, b) = (&a.result, &b.result);
        (a.criterion, place(a)).cmp(&(b.criterion, place(b))).then(a.speed.total_cmp(&b.speed))
    });
    let index = write(records, extremes, detail, out)?;
    output::say!("{}", index.display());
    if unread > 0 {
        bail!("{unread} of what was given could not be read: the report is without it");
    }
    Ok(true)
}

/// Results that a report can tell apart: each once.
fn different(all: Vec<Stated>) -> anyhow::Result<Vec<GaitResult>> {
    let mut kept: Vec<Stated> = Vec::new();
    for stated in all {
        // Results of one task for different robots are told apart by what differs between these.
        let same = |known: &&Stated| {
            known.result.name() == stated.result.name() && known.result.fingerprint == stated.result.fingerprint
        };
        match kept.iter().find(same) {
            Some(known) if known.result == stated.result => {}
            Some(known) => {
                let (a, b, what) = (&known.name, &stated.name, stated.result.name());
                bail!("{a} and {b} are two different results of one task, {what}: give one of them");
            }
            None => kept.push(stated),
        }
    }
    Ok(kept.into_iter().map(|stated| stated.result).collect())
}

/// Numbers that a robot's name has on a page; with more it is the how-manieth.
const NAMED: usize = 3;

/// What tells the robot of each result from those of others, where there are several: its name, and of those with one name and gait
/// the numbers in which they differ.
fn designs<'r>(results: impl Iterator<Item = &'r GaitResult>) -> Vec<Option<String>> {
    let results: Vec<&GaitResult> = results.collect();
    let named = |result: &&GaitResult| {
        let alike = results.iter().filter(|r| (&r.gait, &r.robot) == (&result.gait, &result.robot));
        let mut robots: Vec<&GaitResult> = Vec::new();
        for other in alike {
            if robots.iter().all(|known| !same_robot(known, other)) {
                robots.push(other);
            }
        }
        let place = robots.iter().position(|robot| same_robot(robot, result))?;
        let mut names: Vec<String> = Vec::new();
        for other in robots.iter().filter_map(|robot| robot.specification.as_ref()) {
            let changed = result.specification.as_ref().map_or(Vec::new(), |own| changed(own, other));
            let new = changed.into_iter().filter_map(|number| Some(format!("{}={}", number.name, number.values.a?)));
            names.extend(new.filter(|name| !names.contains(name)).collect::<Vec<_>>());
        }
        let told = !names.is_empty() && names.len() <= NAMED;
        let numbers = (robots.len() > 1).then(|| if told { names.join(" ") } else { format!("robot {}", place + 1) });
        let name = results.iter().any(|r| r.robot != result.robot).then(|| result.robot.clone());
        let parts: Vec<String> = name.into_iter().chain(numbers).collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    };
    results.iter().map(named).collect()
}

/// Writes the report of these results; tells where its page is.
pub fn write(records: Vec<Record>, extremes: Extremes, detail: Option<f64>, out: &Path) -> anyhow::Result<PathBuf> {
    write_report(&Report::new(records, extremes, detail)?, out)
}

/// Writes the files of a report; tells where its page is.
pub fn write_report(report: &Report, out: &Path) -> anyhow::Result<PathBuf> {
    let figures = out.join("figures");
    std::fs::create_dir_all(&figures).with_context(|| format!("cannot create {}", input::name(&figures)))?;
    [out, &figures].into_iter().for_each(whole::tidy);
    for file in report.files() {
        whole::write(&out.join(&file.path), &file.contents)?;
    }
    Ok(out.join(report.file_name()))
}
