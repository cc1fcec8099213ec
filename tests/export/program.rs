//! Optima, and what the program makes of them.

use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::result::GaitResult;
use piaffe::search::multi_start::{Settings, search};
use std::io::Write;
use std::process::{Command, Stdio};

/// The optimum at 0.6 m/s as the file that `piaffe optimize` writes.
pub fn optimum(gait: &dyn Gait, criterion: Criterion) -> (GaitResult, Motion) {
    optimum_at(gait, criterion, 0.6)
}

/// The same at any speed, m/s.
pub fn optimum_at(gait: &dyn Gait, criterion: Criterion, speed: f64) -> (GaitResult, Motion) {
    let settings = Settings::default();
    let found = search(gait, criterion, speed, &settings, &|_| {});
    let result = GaitResult::new(gait, criterion, speed, &found, &settings, || 0.0);
    let motion = result.motion().unwrap();
    (result, motion)
}

/// What a command writes about a result that it reads from its standard input.
pub fn piaffe(result: &GaitResult, arguments: &[&str]) -> Vec<u8> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_piaffe"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&serde_json::to_vec(result).unwrap()).unwrap();
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success());
    out.stdout
}
