//! What is written: files, whole or not at all, and words for a person, unless none are wanted.

use anyhow::Context;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once, when the arguments are read.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on nothing is said but errors and what was asked for with `-`.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Where words for a person go.
pub fn person() -> Box<dyn Write> {
    if is_quiet() { Box::new(std::io::sink()) } else { Box::new(std::io::stdout().lock()) }
}

/// Says a line. A reader who has gone misses it.
pub fn line(text: std::fmt::Arguments) {
    let _ = writeln!(person(), "{text}");
}

/// Like `println!`, but for a person who may want quiet and may be gone.
macro_rules! say {
    ($($words:tt)*) => { $crate::cli::output::line(format_args!($($words)*)) };
}
pub(super) use say;

/// Writes a file; a reader never sees half of it. What stands there and is no file (a device, a pipe) is written to, not
/// replaced; nor is a link.
pub fn write_file(path: &Path, contents: &[u8]) -> anyhow::Result<()> {
    let there = path.canonicalize().ok();
    let path = there.as_deref().unwrap_or(path);
    if path.metadata().is_ok_and(|m| !m.is_file() && !m.is_dir()) {
        let written = std::fs::OpenOptions::new().write(true).open(path).and_then(|mut f| f.write_all(contents));
        return quiet_when_closed(written).with_context(|| format!("cannot write {}", path.display()));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file =
        tempfile::NamedTempFile::new_in(folder).with_context(|| format!("cannot write into {}", folder.display()))?;
    file.write_all(contents).with_context(|| format!("cannot write {}", path.display()))?;
    file.as_file().sync_all()?;
    #[cfg(unix)]
    {
        // Temporary files are private; a result is as readable as any other file.
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.persist(path).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(())
}

/// Writes a value as JSON to `path`, whole or not at all.
pub fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let mut text = serde_json::to_vec_pretty(value)?;
    text.push(b'\n');
    write_file(path, &text)
}

/// Writes JSON to a file, or to standard output for `-`.
pub fn json_to(target: &str, value: &impl Serialize) -> anyhow::Result<()> {
    if target == "-" {
        let mut out = std::io::stdout().lock();
        let result =
            serde_json::to_writer_pretty(&mut out, value).map_err(std::io::Error::from).and_then(|()| writeln!(out));
        return quiet_when_closed(result);
    }
    write_json(Path::new(target), value)
}

/// A reader that has seen enough (`| head`) is no failure.
pub fn quiet_when_closed(result: std::io::Result<()>) -> anyhow::Result<()> {
    match result {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}
