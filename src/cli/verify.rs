//! `piaffe verify`: what results state, derived anew.

use super::{input, output};
use piaffe::audit::{Audit, Statement, Verdict};
use piaffe::gaits::GAITS;
use piaffe::result::GaitResult;
use serde_json::Value;
use std::io::Write;

/// Differences of a statement that are printed.
const SHOWN: usize = 3;

/// Checks results; true if all that they state about their motions was confirmed.
pub fn run(files: &[String], json: Option<&str>) -> anyhow::Result<bool> {
    let mut audits = Vec::new();
    for file in files {
        let text = input::read_text(file)?;
        let result: GaitResult = input::parse_json(file, &text)?;
        let stated: Value = input::parse_json(file, &text)?;
        let audit = Audit::new(&stated, &result, GAITS);
        if json != Some("-") {
            output::quiet_when_closed(print(file, &audit))?;
        }
        audits.push(audit);
    }
    if let Some(target) = json {
        output::json_to(target, &audits)?;
    }
    Ok(audits.iter().all(Audit::is_confirmed))
}

fn print(file: &str, audit: &Audit) -> std::io::Result<()> {
    let mut out = output::person();
    let verdict = if audit.is_confirmed() { "confirmed" } else { "not confirmed" };
    writeln!(out, "{file}: {}, {verdict}", audit.name)?;
    for statement in &audit.statements {
        let Statement { entry, verdict, reason, differences } = statement;
        let word = match verdict {
            Verdict::Confirmed => "confirmed",
            Verdict::NotConfirmed => "NOT CONFIRMED",
            Verdict::NotChecked => "not checked",
        };
        match reason {
            Some(reason) => writeln!(out, "  {entry:<18} {word}: {reason}")?,
            None => writeln!(out, "  {entry:<18} {word}")?,
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
