//! `piaffe lift`: the motion of a result, for the real legs.

use super::document::readback;
use super::output;
use clap::ValueEnum;
use piaffe_optimizer::four_legs::{Lift, RealLegs, Verdict, csv, json};
use piaffe_optimizer::readback::Readback;
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A row per moment, a column per number; the row that ends a phase has the impulses.
    Csv,
    /// The same, with the impacts by themselves.
    Json,
}

/// Writes the lifted motion of the result in `file` (`-`: standard input) to `out` (`-`: standard output).
pub fn run(file: &Path, format: Format, rate: f64, out: &str) -> anyhow::Result<bool> {
    let Readback { gait, motion, .. } = readback(file)?;
    let lift = Lift::at_rate(gait, &motion, rate)?;
    let legs = RealLegs::of(&lift);
    if matches!(legs.verdict(), Verdict::BeyondLimits | Verdict::NoEquilibrium) {
        output::note(&format!("{}; see the columns `margin` and `remainder`", legs.sentence()));
    }
    match format {
        Format::Json => output::json_to(out, &json(&lift))?,
        Format::Csv => output::bytes_to(out, csv(&lift).as_bytes())?,
    }
    Ok(true)
}
