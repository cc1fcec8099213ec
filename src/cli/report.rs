//! `piaffe report`: results as a page with figures.

use super::{input, output};
use anyhow::{Context, bail};
use piaffe::gaits::GAITS;
use piaffe::readback::Readback;
use piaffe::report::{Extremes, Report};
use piaffe::result::GaitResult;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Reads results from files and folders and writes their report to `out`. What a result states is derived anew before it is shown.
pub fn run(results: &[PathBuf], detail: Option<f64>, out: &Path) -> anyhow::Result<bool> {
    let mut all = Vec::new();
    let mut extremes = Extremes::default();
    for path in results {
        if path.is_dir() {
            all.extend(folder(path)?);
            let summary = path.join("sweep.json");
            if summary.exists() {
                extremes = input::read_json(&summary.to_string_lossy())?;
            }
        } else {
            all.push(input::read_json::<GaitResult>(&path.to_string_lossy())?);
        }
    }
    let read = |result: GaitResult| match result.is_optimal() {
        true => Readback::new(result, GAITS).map(|readback| readback.result),
        false => Ok(result),
    };
    let all = all.into_par_iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let index = write(all, extremes, detail, out)?;
    output::say!("{}", index.display());
    Ok(true)
}

/// Writes the report of these results; tells where its page is.
pub fn write(results: Vec<GaitResult>, extremes: Extremes, detail: Option<f64>, out: &Path) -> anyhow::Result<PathBuf> {
    let report = Report::new(results, extremes, detail, GAITS)?;
    let figures = out.join("figures");
    std::fs::create_dir_all(&figures).with_context(|| format!("cannot create {}", figures.display()))?;
    for file in report.files() {
        output::write_file(&out.join(&file.path), &file.contents)?;
    }
    Ok(out.join("index.html"))
}

/// All results in a folder, by gait, criterion and speed.
fn folder(path: &Path) -> anyhow::Result<Vec<GaitResult>> {
    let cannot = || format!("cannot read the folder {}", path.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).with_context(cannot)? {
        let file = entry.with_context(cannot)?.path();
        let is_result =
            file.extension().is_some_and(|e| e == "json") && file.file_name().is_some_and(|n| n != "sweep.json");
        files.extend(is_result.then_some(file));
    }
    files.sort();
    if files.is_empty() {
        bail!("{} has no results (*.json); `piaffe sweep --out {0}` makes some", path.display());
    }
    let mut results: Vec<GaitResult> =
        files.iter().map(|f| input::read_json(&f.to_string_lossy())).collect::<Result<_, _>>()?;
    let place = |r: &GaitResult| GAITS.iter().position(|g| g.description().key == r.gait);
    results.sort_by(|a, b| (a.criterion, place(a)).cmp(&(b.criterion, place(b))).then(a.speed.total_cmp(&b.speed)));
    Ok(results)
}
