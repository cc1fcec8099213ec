//! `piaffe completions` and `piaffe manual`: the command line, for shells and for `man`.

use super::{command, output};
use anyhow::Context;
use clap_complete::{Shell, generate};
use std::path::Path;

pub fn completions(shell: Shell) -> anyhow::Result<bool> {
    let mut text = Vec::new();
    generate(shell, &mut command(), "piaffe", &mut text);
    output::bytes_to("-", &text)?;
    Ok(true)
}

/// `piaffe.1`, and a page for each command.
pub fn pages(folder: &Path) -> anyhow::Result<bool> {
    let cannot = || format!("cannot write the pages into {}", folder.display());
    std::fs::create_dir_all(folder).with_context(cannot)?;
    clap_mangen::generate_to(command(), folder).with_context(cannot)?;
    output::say!("{}", folder.join("piaffe.1").display());
    Ok(true)
}
