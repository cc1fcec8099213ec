//! `piaffe report`: results as a page with figures.

use super::document::{self, Document, OVERVIEW, Stated};
use super::{input, output, robots, whole};
use anyhow::{Context, bail};
use piaffe_optimizer::result::GaitResult;
use piaffe_report::{Extremes, Record, Report};
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
            true if path.join(OVERVIEW).exists() => vec![path.join(OVERVIEW)],
            true => document::files(path)?,
            false => vec![path.clone()],
        };
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
    let record = |(gait, result)| match gait {
        Ok(gait) => Record::read(result, &[gait]),
        Err(why) => Record::unreadable(result, why),
    };
    let mut records: Vec<Record> = of_gaits.into_par_iter().map(record).collect();
    let keys = robots::keys().unwrap_or_default();
    let place = |r: &GaitResult| keys.iter().position(|key| *key == r.gait);
    records.sort_by(|a, b| {
        let (a, b) = (&a.result, &b.result);
        (a.criterion, place(a)).cmp(&(b.criterion, place(b))).then(a.speed.total_cmp(&b.speed))
    });
    let index = write(records, extremes, detail, out)?;
    output::say!("{}", index.display());
    if unread > 0 {
        bail!("{unread} results could not be read: the report is without them");
    }
    Ok(true)
}

/// Results that a report can tell apart: each once.
fn different(all: Vec<Stated>) -> anyhow::Result<Vec<GaitResult>> {
    let mut kept: Vec<Stated> = Vec::new();
    for stated in all {
        match kept.iter().find(|known| known.result.name() == stated.result.name()) {
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

/// Writes the report of these results; tells where its page is.
pub fn write(records: Vec<Record>, extremes: Extremes, detail: Option<f64>, out: &Path) -> anyhow::Result<PathBuf> {
    let report = Report::new(records, extremes, detail)?;
    let figures = out.join("figures");
    std::fs::create_dir_all(&figures).with_context(|| format!("cannot create {}", input::name(&figures)))?;
    [out, &figures].into_iter().for_each(whole::tidy);
    for file in report.files() {
        whole::write(&out.join(&file.path), &file.contents)?;
    }
    Ok(out.join("index.html"))
}
