//! `piaffe verify`: what results state, derived anew.

use super::{input, output};
use anyhow::bail;
use piaffe::audit::{Audit, Statement, Verdict};
use piaffe::gaits::GAITS;
use piaffe::result::GaitResult;
use serde::Serialize;
use serde_json::Value;
use std::io::Write;

/// Differences of a statement that are printed.
const SHOWN: usize = 3;

/// What is written of a file.
#[derive(Serialize)]
struct Entry<'a> {
    file: &'a str,
    confirmed: bool,
    #[serde(flatten)]
    audit: Audit,
}

/// Checks results; true if all that they state about their motions was confirmed. One that cannot be read does not keep
/// the others from being checked.
pub fn run(files: &[String], json: Option<&str>) -> anyhow::Result<bool> {
    let mut entries = Vec::new();
    for file in files {
        match audit(file) {
            Ok(audit) => {
                if json != Some("-") {
                    output::quiet_when_closed(print(file, &audit))?;
                }
                entries.push(Entry { file, confirmed: audit.is_confirmed(), audit });
            }
            Err(error) => eprintln!("error: {error:#}"),
        }
    }
    if let Some(target) = json {
        output::json_to(target, &entries)?;
    }
    if entries.len() < files.len() {
        bail!("{} of {} results could not be read", files.len() - entries.len(), files.len());
    }
    Ok(entries.iter().all(|entry| entry.confirmed))
}

fn audit(file: &str) -> anyhow::Result<Audit> {
    let text = input::read_text(file)?;
    let result: GaitResult = input::parse_json(file, &text)?;
    let stated: Value = input::parse_json(file, &text)?;
    Ok(Audit::new(&stated, &result, GAITS))
}

fn print(file: &str, audit: &Audit) -> std::io::Result<()> {
    let mut out = output::person();
    let verdict = if audit.is_confirmed() { "confirmed" } else { "not confirmed" };
    writeln!(out, "{file}: {}, {verdict}", audit.name)?;
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
