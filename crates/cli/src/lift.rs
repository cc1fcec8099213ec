//! `piaffe lift`: the motion of a result, for the real legs.

use super::document::readback;
use super::output;
use clap::ValueEnum;
use piaffe_optimizer::four_legs::{Lift, RealLegs, Sharing, Verdict, csv, json};
use piaffe_optimizer::readback::Readback;
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A row per moment, a column per number; the row that ends a phase has the impulses.
    Csv,
    /// The same, with the impacts by themselves.
    Json,
}

/// How legs that move as one share what they do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shares {
    /// Of those within the limits of every foot and joint, the shares that cost least in what the result minimizes.
    LeastCost,
    /// Those that leave most room within the limits.
    MostRoom,
}

/// Writes the lifted motion of the result in `file` (`-`: standard input) to `out` (`-`: standard output).
pub fn run(file: &Path, format: Format, rate: f64, shares: Shares, out: &str) -> anyhow::Result<bool> {
    let Readback { result, gait, motion, .. } = readback(file)?;
    let ways = [Sharing::LeastCost(result.criterion), Sharing::MostRoom];
    let [least, room] = [Lift::close(gait, &motion, ways[0])?, Lift::close(gait, &motion, ways[1])?];
    let legs = RealLegs::of(&room);
    let [(sharing, here), (other, there)] = match shares {
        Shares::LeastCost => [(ways[0], least), (ways[1], room)],
        Shares::MostRoom => [(ways[1], room), (ways[0], least)],
    };
    let lift = Lift::at_rate(gait, &motion, rate, sharing)?;
    let mut told = Vec::new();
    if matches!(legs.verdict(), Verdict::BeyondLimits | Verdict::NoEquilibrium) {
        told.push(format!("{}; {}", legs.sentence(), whereabouts(&legs)));
    }
    told.push(legs.cost_of(&here, sharing, &result));
    if !legs.costs_alike(&here, &there) {
        told.push(format!("not written: {}", legs.cost_of(&there, other, &result)));
    }
    output::note(&told.join("; "));
    match format {
        Format::Json => output::json_to(out, &json(&lift))?,
        Format::Csv => output::bytes_to(out, csv(&lift).as_bytes())?,
    }
    Ok(true)
}

/// Where in what is written stands what the real legs cannot do.
fn whereabouts(legs: &RealLegs) -> String {
    let columns = "see the columns `margin` and `remainder`";
    let impacts = "`margin` and `remainder` of an impact stand among the `impacts` of --format json";
    match legs.between_and_at_impacts() {
        [_, true] => columns.into(),
        [true, false] => format!("{impacts}; the columns of the same names are of the moments between"),
        [false, false] => format!("{columns}; {impacts}"),
    }
}
