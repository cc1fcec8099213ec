//! `piaffe export`: a result for other software.

use super::{input, output};
use anyhow::Context;
use clap::ValueEnum;
use piaffe::export::{controller, mjcf, npz, table, urdf};
use piaffe::gaits::GAITS;
use piaffe::readback::Readback;
use piaffe::walk::Walk;
use std::io::{IsTerminal, Write};
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A row per moment: platform, coordinates, torques, reaction, feet.
    Csv,
    /// The joints' polynomials, for a controller.
    Json,
    /// The same numbers as csv, as arrays for numpy.
    Npz,
    /// The robot with all real legs, for MuJoCo, with a keyframe where the walk begins.
    Mjcf,
    /// The robot with all real legs, for ROS and others.
    Urdf,
}

/// Writes the result in `file` (`-`: standard input) to `out` (`-`: standard output); tables at `rate` per second.
pub fn run(file: &str, format: Format, rate: f64, out: &str) -> anyhow::Result<bool> {
    let Readback { gait, motion, .. } = Readback::new(input::read_json(file)?, GAITS)?;
    let contents = match format {
        Format::Csv => table::csv(&Walk::at_rate(gait, &motion, rate)?).into_bytes(),
        Format::Npz => npz::npz(&Walk::at_rate(gait, &motion, rate)?)?,
        Format::Json => serde_json::to_vec_pretty(&controller::controller(gait, &motion))?,
        Format::Mjcf => mjcf::mjcf(&Walk::even(gait, &motion, 1)?).into_bytes(),
        Format::Urdf => urdf::urdf(gait.description()).into_bytes(),
    };
    if out != "-" {
        output::write_file(Path::new(out), &contents)?;
        return Ok(true);
    }
    let mut stdout = std::io::stdout().lock();
    if format == Format::Npz && stdout.is_terminal() {
        anyhow::bail!("npz is not for terminals: write --out FILE.npz");
    }
    output::quiet_when_closed(stdout.write_all(&contents).and_then(|()| stdout.flush())).context("cannot write")?;
    Ok(true)
}
