//! Files, whole or not at all.
//!
//! A file is written beside its place, as a *draft*, and then moved there in one step. A draft is locked while it is
//! written: what a run that was killed left behind is unlocked, and the next run that comes by clears it away.
//!
//! What a run was given to read it does not write over.

use super::harmless::line;
use anyhow::Context;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{File, OpenOptions, Permissions};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Files that this run was given to read.
static GIVEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// From now on a file is not written over, by whatever name.
pub fn protect(path: &Path) {
    let file = path.canonicalize().ok().filter(|file| file.is_file());
    GIVEN.lock().unwrap_or_else(PoisonError::into_inner).extend(file);
}

fn is_given(path: &Path) -> bool {
    let file = path.canonicalize().ok();
    file.is_some_and(|file| GIVEN.lock().unwrap_or_else(PoisonError::into_inner).contains(&file))
}

/// How the name of a draft ends.
const DRAFT: &str = ".piaffe-draft";

/// As many may write to one file at a time.
const MOST_DRAFTS: usize = 64;

/// As many links may lead from one to the other.
const MOST_LINKS: usize = 40;

/// Writes a file; a reader never sees half of it. It keeps the permissions it had; a new one has those that `umask` gives. A link
/// is written through, also to what is not there yet; a device or a pipe is written to.
pub fn write(path: &Path, contents: &[u8]) -> anyhow::Result<()> {
    let written = match allowed(path) {
        Ok(Destination::Stream) => OpenOptions::new().write(true).open(path).and_then(|mut f| f.write_all(contents)),
        Ok(Destination::File(file)) => replace(&file, contents),
        Err(error) => Err(error),
    };
    match written {
        // A reader that has seen enough is no failure.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.with_context(|| cannot(path)),
    }
}

/// Whether a file can be written, before it is known what is to be in it: what takes long should not fail in its last step.
///
/// # Errors
/// Why not, as far as that can be seen.
pub fn check(path: &Path) -> anyhow::Result<()> {
    let there = |file: PathBuf| if folder_of(&file).is_dir() { Ok(()) } else { Err(no_folder(folder_of(&file))) };
    let writable = allowed(path).and_then(|destination| match destination {
        Destination::Stream => Ok(()),
        Destination::File(file) => there(file),
    });
    writable.with_context(|| cannot(path))
}

fn cannot(path: &Path) -> String {
    format!("cannot write {}", line(&path.to_string_lossy()))
}

fn no_folder(folder: &Path) -> Error {
    Error::new(ErrorKind::NotFound, format!("there is no folder {}", line(&folder.to_string_lossy())))
}

/// What a path leads to, unless it was given to be read.
fn allowed(path: &Path) -> Result<Destination> {
    match destination(path)? {
        Destination::File(_) if is_given(path) => {
            Err(Error::new(ErrorKind::AlreadyExists, "this is what was read: write to another file"))
        }
        destination => Ok(destination),
    }
}

/// Clears away the drafts that runs which were killed left in a folder.
pub fn tidy(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().ends_with(DRAFT) {
            clear(&entry.path());
        }
    }
}

/// What a path leads to.
enum Destination {
    /// Something that takes bytes and keeps none.
    Stream,
    File(PathBuf),
}

fn destination(path: &Path) -> Result<Destination> {
    match path.metadata() {
        Ok(there) if there.is_dir() => Err(Error::new(ErrorKind::IsADirectory, "this is a folder")),
        Ok(there) if !there.is_file() => Ok(Destination::Stream),
        // What is open but has no name any more, such as /dev/fd/1, can only be written to.
        Ok(_) => Ok(path.canonicalize().map_or(Destination::Stream, Destination::File)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Destination::File(end_of_links(path)?)),
        Err(error) => Err(error),
    }
}

/// Where a chain of links that leads nowhere yet wants to lead.
fn end_of_links(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let Ok(next) = path.read_link() else { return Ok(path) };
        path = folder_of(&path).join(next);
    }
    Err(Error::new(ErrorKind::InvalidInput, "its links lead in a circle"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn replace(path: &Path, contents: &[u8]) -> Result<()> {
    let Some(name) = path.file_name() else {
        return Err(Error::new(ErrorKind::InvalidInput, "this names no file"));
    };
    let there = path.metadata().ok().map(|there| there.permissions());
    if there.is_some() {
        // Who may not write to a file may not replace it either.
        OpenOptions::new().write(true).open(path)?;
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(no_folder(folder));
    }
    let mut draft = Draft::begin(folder, name, there).map_err(|error| match error.kind() {
        ErrorKind::PermissionDenied => {
            let why =
                format!("files are written whole, for which {} must be writable", line(&folder.to_string_lossy()));
            Error::new(ErrorKind::PermissionDenied, why)
        }
        _ => error,
    })?;
    draft.file.write_all(contents)?;
    draft.file.sync_all()?;
    draft.become_file(path)
}

/// A file that is not in its place yet; it is removed unless it gets there.
struct Draft {
    path: PathBuf,
    file: File,
    done: bool,
}

impl Draft {
    /// Begins a draft of the file `name`, with these permissions or those that `umask` gives.
    fn begin(folder: &Path, name: &OsStr, permissions: Option<Permissions>) -> Result<Draft> {
        // Names have an end, and may be at it.
        let name: String = name.to_string_lossy().chars().take(40).collect();
        for n in 0..MOST_DRAFTS {
            let path = folder.join(format!(".{name}.{n}{DRAFT}"));
            clear(&path);
            let file = match new(&path) {
                Ok(file) => file,
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
            };
            // Where there are no locks nobody clears anything away; where there are, who was faster has it.
            if matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock)) || !is_at(&file, &path) {
                continue;
            }
            let draft = Draft { path, file, done: false };
            if let Some(permissions) = permissions {
                draft.file.set_permissions(permissions)?;
            }
            return Ok(draft);
        }
        Err(Error::new(ErrorKind::ResourceBusy, "too many are writing to it"))
    }

    fn become_file(mut self, path: &Path) -> Result<()> {
        std::fs::rename(&self.path, path)?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.done {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// A file that was not there before: never what somebody else put there, or a link to it.
fn new(path: &Path) -> Result<File> {
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// Removes a draft that nobody is writing.
fn clear(path: &Path) {
    if !path.symlink_metadata().is_ok_and(|there| there.is_file()) {
        return;
    }
    let Ok(file) = OpenOptions::new().write(true).open(path) else { return };
    if file.try_lock().is_ok() && is_at(&file, path) {
        let _ = std::fs::remove_file(path);
    }
}

/// Whether this open file still is the one at the path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |m: std::fs::Metadata| (m.dev(), m.ino());
    let (open, there) = (file.metadata().map(identity), path.symlink_metadata().map(identity));
    matches!((open, there), (Ok(a), Ok(b)) if a == b)
}

/// An open file cannot be removed or replaced there.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}
