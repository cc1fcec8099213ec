//! Where things are written to: words for a person, unless none are wanted, notes and errors, and JSON.

use super::harmless::{Harmless, lines};
use super::whole;
use anyhow::{Context, bail};
use piaffe_optimizer::finite::not_finite;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once, when the arguments are read.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Why words did not arrive, if some did not.
static LOST: OnceLock<std::io::Error> = OnceLock::new();

/// From now on nothing is said but errors and what was asked for with `-`.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Where words for a person go.
pub fn person() -> Box<dyn Write> {
    if is_quiet() { Box::new(std::io::sink()) } else { Box::new(Harmless(std::io::stdout().lock())) }
}

/// Says a line. A reader who has gone misses it.
pub fn line(text: std::fmt::Arguments) {
    match writeln!(person(), "{text}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => drop(LOST.set(error)),
        _ => {}
    }
}

/// Why a line that was said did not arrive, if one did not.
pub fn lost() -> Option<&'static std::io::Error> {
    LOST.get()
}

/// Like `println!`, but for a person who may want quiet and may be gone.
macro_rules! say {
    ($($words:tt)*) => { $crate::output::line(format_args!($($words)*)) };
}
pub(super) use say;

/// Says what a person should know beside the answer.
pub fn note(text: &str) {
    if !is_quiet() {
        eprintln!("note: {}", lines(text));
    }
}

/// Says what went wrong.
pub fn error(error: &anyhow::Error) {
    eprintln!("error: {}", lines(&format!("{error:#}")));
}

/// Writes a value as JSON to `path`, whole or not at all.
pub fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    whole::write(path, &json(value)?)
}

/// Whether there can be written to a file, before it is known what; to standard output for `-` and nowhere if there is none.
pub fn check(target: Option<&str>) -> anyhow::Result<()> {
    target.filter(|target| *target != "-").map_or(Ok(()), |target| whole::check(Path::new(target)))
}

/// Writes JSON to a file, or to standard output for `-`.
pub fn json_to(target: &str, value: &impl Serialize) -> anyhow::Result<()> {
    bytes_to(target, &json(value)?)
}

/// A value as JSON that can be read back: JSON has no infinite numbers.
pub fn json(value: &impl Serialize) -> anyhow::Result<Vec<u8>> {
    if let Some(place) = not_finite(value) {
        bail!("nothing was written: {place} is not a finite number");
    }
    let mut text = serde_json::to_vec_pretty(value)?;
    text.push(b'\n');
    Ok(text)
}

/// Writes bytes to a file, or to standard output for `-`.
pub fn bytes_to(target: &str, bytes: &[u8]) -> anyhow::Result<()> {
    if target != "-" {
        return whole::write(Path::new(target), bytes);
    }
    let mut out = std::io::stdout().lock();
    quiet_when_closed(out.write_all(bytes).and_then(|()| out.flush()))
}

/// A reader that has seen enough (`| head`) is no failure.
pub fn quiet_when_closed(result: std::io::Result<()>) -> anyhow::Result<()> {
    match result {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to standard output"),
    }
}
