//! `piaffe verify`: what results state, derived anew.

use super::document::{self, Document};
use super::{input, output, robots};
use anyhow::bail;
use piaffe_optimizer::audit::{Audit, Refusal, Statement, Verdict};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Differences of a statement that are printed.
const SHOWN: usize = 3;

/// What is written of a result.
#[derive(Serialize)]
struct Entry {
    /// Its file, and which of the file's results it is if there are several.
    file: String,
    confirmed: bool,
    /// Whether that is said of the robot whose files it carries, which is none of those here.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    of_others: bool,
    #[serde(flatten)]
    audit: Audit,
}

/// Checks results and sweeps' overviews; true if all that they state about their motions was confirmed. One that cannot be
/// read does not keep the others from being checked.
pub fn run(files: &[PathBuf], json: Option<&str>) -> anyhow::Result<bool> {
    output::check(json)?;
    let mut entries = Vec::new();
    let mut unread = 0;
    let mut told = Ok(());
    for file in files.iter().flat_map(|file| in_folder(file)) {
        for audit in file.map_or_else(|error| vec![Err(error)], |file| audits(&file)) {
            match audit {
                Ok(entry) => {
                    if json != Some("-") {
                        told = told.and(print(&entry));
                    }
                    entries.push(entry);
                }
                Err(error) => {
                    output::error(&error);
                    unread += 1;
                }
            }
        }
    }
    if let Some(target) = json {
        output::json_to(target, &entries)?;
    }
    output::quiet_when_closed(told)?;
    if unread > 0 {
        bail!("{unread} of {} results could not be read", unread + entries.len());
    }
    Ok(entries.iter().all(|entry| entry.confirmed))
}

/// A file, or those of a folder.
fn in_folder(path: &Path) -> Vec<anyhow::Result<PathBuf>> {
    if input::is_standard(path) || !path.is_dir() {
        return vec![Ok(path.into())];
    }
    match document::files(path) {
        Ok(files) => files.into_iter().map(Ok).collect(),
        Err(error) => vec![Err(error)],
    }
}

/// The audits of all that is in a file, each with its name.
fn audits(file: &Path) -> Vec<anyhow::Result<Entry>> {
    match document::read(file) {
        Ok(Document::Results(results)) => {
            let audit = |stated: document::Stated| {
                let audit = match robots::of(&stated.result) {
                    Ok(gait) => Audit::new(&stated.value, &stated.result, &[gait]),
                    Err(why) => {
                        let refusal = Refusal::Because(Verdict::NotChecked, why);
                        Audit::against(&stated.value, &stated.result, Err(&refusal))
                    }
                };
                Entry::new(stated.name, robots::is_of_others(&stated.result), audit)
            };
            results.into_iter().map(|r| r.map(audit)).collect()
        }
        Ok(Document::Sweep(sweep)) => {
            let results: Vec<_> = sweep.results.iter().map(|stated| stated.result.clone()).collect();
            vec![Ok(Entry::new(sweep.name, false, sweep.overview.audit(&sweep.value, &results)))]
        }
        Err(error) => vec![Err(error)],
    }
}

impl Entry {
    fn new(file: String, of_others: bool, audit: Audit) -> Entry {
        Entry { file, confirmed: audit.is_confirmed(), of_others, audit }
    }
}

fn print(Entry { file, of_others, audit, .. }: &Entry) -> std::io::Result<()> {
    let mut out = output::person();
    let verdict = match audit.is_confirmed() {
        true if audit.is_of_no_motion() => "states no motion",
        true => "confirmed",
        false => "not confirmed",
    };
    writeln!(out, "{file}: {}, {verdict}", audit.name)?;
    if *of_others {
        writeln!(out, "  of the robot whose files it carries, which is not the one here")?;
    }
    // What has one reason is said once.
    for alike in audit.statements.chunk_by(|a, b| a.reason.is_some() && a.reason == b.reason) {
        let names: Vec<&str> = alike.iter().map(|s| s.entry.as_str()).collect();
        let Some(Statement { verdict, reason, differences, .. }) = alike.first() else { continue };
        let word = match verdict {
            Verdict::Confirmed => "confirmed",
            Verdict::NotConfirmed => "NOT CONFIRMED",
            Verdict::NotChecked => "not checked",
            Verdict::NotDerivable => "not derivable",
        };
        match reason {
            Some(reason) => writeln!(out, "  {}\n    {word}: {reason}", names.join(", "))?,
            None => writeln!(out, "  {:<18} {word}", names.join(", "))?,
        }
        for d in differences.iter().take(SHOWN) {
            writeln!(out, "    {}: stated {}, found {}", d.place, d.stated, d.found)?;
        }
        if differences.len() > SHOWN {
            writeln!(out, "    and {} more", differences.len() - SHOWN)?;
        }
    }
    Ok(())
}
