//! Text and JSON from a file or standard input, with errors that say where.

use anyhow::{Context, bail};
use serde::de::DeserializeOwned;
use std::io::Read;

/// The text of `file`, or of standard input for `-`.
pub fn read_text(file: &str) -> anyhow::Result<String> {
    if file != "-" {
        return std::fs::read_to_string(file).with_context(|| format!("cannot read {file}"));
    }
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).context("cannot read standard input as UTF-8 text")?;
    Ok(text)
}

/// Reads and parses `file`, or standard input for `-`.
pub fn read_json<T: DeserializeOwned>(file: &str) -> anyhow::Result<T> {
    parse_json(file, &read_text(file)?)
}

/// Parses what was read from `file`, or from standard input for `-`.
pub fn parse_json<T: DeserializeOwned>(file: &str, text: &str) -> anyhow::Result<T> {
    let name = if file == "-" { "standard input" } else { file };
    if text.trim().is_empty() {
        bail!("{name} is empty: JSON was expected");
    }
    serde_json::from_str(text).map_err(|e| {
        let line = text.lines().nth(e.line().saturating_sub(1)).unwrap_or_default();
        let start = e.column().saturating_sub(40);
        let excerpt: String = line.chars().skip(start).take(60).collect();
        anyhow::anyhow!("{name}:{}:{}: {e}\n  | {excerpt}", e.line(), e.column())
    })
}
