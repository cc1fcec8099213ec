//! `piaffe export`: a result for other software.

use super::document::readback;
use super::output;
use clap::ValueEnum;
use piaffe_export::{controller, mjcf, npz, table, urdf};
use piaffe_optimizer::readback::Readback;
use piaffe_optimizer::walk::Walk;
use std::io::IsTerminal;
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
pub fn run(file: &Path, format: Format, rate: f64, out: &str) -> anyhow::Result<bool> {
    let Readback { gait, motion, .. } = readback(file)?;
    let contents = match format {
        Format::Csv => table::csv(&Walk::at_rate(gait, &motion, rate)?).into_bytes(),
        Format::Npz => npz::npz(&Walk::at_rate(gait, &motion, rate)?)?,
        Format::Json => output::json(&controller::controller(gait, &motion))?,
        Format::Mjcf => mjcf::mjcf(&Walk::even(gait, &motion, 1)?).into_bytes(),
        Format::Urdf => urdf::urdf(gait.description()).into_bytes(),
    };
    if out == "-" && format == Format::Npz && std::io::stdout().is_terminal() {
        anyhow::bail!("npz is not for terminals: write --out FILE.npz");
    }
    output::bytes_to(out, &contents)?;
    Ok(true)
}
