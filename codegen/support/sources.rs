//! Tells one state of a crate's sources from another.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A hash of all files below these folders: of their paths and of what is in them.
pub fn hash(folders: &[&str]) -> io::Result<u64> {
    let mut hasher = DefaultHasher::new();
    for folder in folders {
        for file in files(Path::new(folder))? {
            file.to_string_lossy().replace('\\', "/").hash(&mut hasher);
            fs::read(file)?.hash(&mut hasher);
        }
    }
    Ok(hasher.finish())
}

/// In the order of their names.
fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    entries.sort();
    let mut files = Vec::new();
    for entry in entries {
        if entry.is_dir() { files.extend(self::files(&entry)?) } else { files.push(entry) }
    }
    Ok(files)
}
