//! `piaffe dynamics`: the generated kernels at given states, as JSON.

use super::{input, output};
use piaffe_model::Gait;
use piaffe_optimizer::states::{States, evaluate};
use std::path::Path;

pub fn run(gait: &dyn Gait, file: &Path) -> anyhow::Result<bool> {
    let states: States = input::read_json(file)?;
    output::json_to("-", &evaluate(gait, &states)?)?;
    Ok(true)
}
