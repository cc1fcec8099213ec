//! What was derived, in files: whoever derives the same later, in this process or another, reads it instead.
//!
//! A file is named by a hash of all that its contents follow from: what is derived from, and the sources of the derivation. It begins
//! with a hash of that name and of the rest. What is damaged, cut off or foreign is as good as not there. Nothing that goes wrong
//! with a file is an error, since everything can be derived again.

use super::tape::Unrunnable;
use etcetera::base_strategy::{BaseStrategy, choose_base_strategy};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;

/// The environment variable that says where derivations are kept: a folder, or [`OFF`].
pub const VARIABLE: &str = "PIAFFE_CACHE";

/// Its value for: nowhere.
pub const OFF: &str = "off";

/// About so many bytes are kept, some thousand gaits; beyond them goes what was not used for longest.
const MOST: u64 = 256 << 20;

/// How the names of all files end, also while they are written: others in the folder are not ours.
const ENDING: &str = ".piaffe-derived";

/// Bytes of a hash.
const HASH: usize = 32;

/// Chosen once in a process.
static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();

/// Where derivations are kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Store {
    Nowhere,
    Folder(PathBuf),
}

impl Store {
    /// Where the user wants it: by `PIAFFE_CACHE`, else in the folder that the system has for such files. Nowhere if there is none.
    pub fn of_user() -> Store {
        match std::env::var_os(VARIABLE).filter(|place| !place.is_empty()) {
            Some(place) if place == OsStr::new(OFF) => Store::Nowhere,
            Some(place) => Store::Folder(place.into()),
            None => match choose_base_strategy() {
                Ok(user) => Store::Folder(user.cache_dir().join("piaffe")),
                Err(_) => Store::Nowhere,
            },
        }
    }

    /// From now on, for all of this process; until then nothing is kept. Who was first decides.
    pub fn choose(self) {
        FOLDER.get_or_init(|| match self {
            Store::Nowhere => None,
            Store::Folder(folder) => Some(folder),
        });
    }
}

/// What is derived from `subject`, which says all that it depends on.
pub fn stored<T: Serialize + DeserializeOwned>(
    subject: &str,
    derive: impl FnOnce() -> Result<T, Unrunnable>,
) -> Result<T, Unrunnable> {
    match FOLDER.get() {
        Some(Some(folder)) => stored_in(folder, subject, derive),
        _ => derive(),
    }
}

fn stored_in<T: Serialize + DeserializeOwned>(
    folder: &Path,
    subject: &str,
    derive: impl FnOnce() -> Result<T, Unrunnable>,
) -> Result<T, Unrunnable> {
    let key = key(subject);
    let file = folder.join(name(&key));
    if let Some(known) = read(&file, &key) {
        return Ok(known);
    }
    let derived = derive()?;
    // Who cannot write derives again.
    let _ = write(folder, &file, &key, &derived);
    Ok(derived)
}

/// Of all that a derivation follows from.
fn key(subject: &str) -> [u8; HASH] {
    let mut hasher = Sha256::new();
    for part in [piaffe_codegen::SOURCES, env!("SOURCES"), subject] {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().into()
}

fn name(key: &[u8; HASH]) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect::<String>() + ENDING
}

fn seal(key: &[u8; HASH], contents: &[u8]) -> [u8; HASH] {
    Sha256::new().chain_update(key).chain_update(contents).finalize().into()
}

fn read<T: DeserializeOwned>(path: &Path, key: &[u8; HASH]) -> Option<T> {
    // A pipe or a device may have no end, or never begin.
    path.metadata().ok().filter(fs::Metadata::is_file)?;
    let mut file = File::open(path).ok()?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).ok()?;
    let (sealed, contents) = bytes.split_at_checked(HASH)?;
    if sealed != seal(key, contents) {
        return None;
    }
    let found = postcard::from_bytes(contents).ok()?;
    // It was used: others go before it.
    let _ = file.set_modified(SystemTime::now());
    Some(found)
}

/// As a whole or not at all, whoever else is writing the same.
fn write<T: Serialize>(folder: &Path, path: &Path, key: &[u8; HASH], derived: &T) -> std::io::Result<()> {
    let contents = postcard::to_allocvec(derived).map_err(std::io::Error::other)?;
    fs::create_dir_all(folder)?;
    let mut file = tempfile::Builder::new().suffix(ENDING).tempfile_in(folder)?;
    file.write_all(&seal(key, &contents))?;
    file.write_all(&contents)?;
    file.persist(path)?;
    // To look at all files takes as long as some are derived: one write in so many does.
    if key[0] == 0 { tidy(folder, MOST) } else { Ok(()) }
}

/// Removes what was not used for longest, until no more than so many bytes are left.
fn tidy(folder: &Path, most: u64) -> std::io::Result<()> {
    let of = |entry: fs::DirEntry| {
        entry.file_name().to_str().filter(|name| name.ends_with(ENDING))?;
        let about = entry.metadata().ok().filter(fs::Metadata::is_file)?;
        Some((about.modified().ok()?, about.len(), entry.path()))
    };
    let mut files: Vec<(SystemTime, u64, PathBuf)> = fs::read_dir(folder)?.flatten().filter_map(of).collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, length, _)| length).sum();
    for (_, length, path) in files {
        if bytes <= most {
            break;
        }
        // What another process has removed is gone too.
        let _ = fs::remove_file(path);
        bytes -= length;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{ENDING, HASH, key, name, stored_in, tidy};
    use crate::derived::Derived;
    use crate::gait::mechanism;
    use crate::robot::Robot;
    use piaffe_codegen::mechanism::Mechanism;
    use std::cell::Cell;
    use std::fs;
    use std::path::Path;
    use std::time::{Duration, SystemTime};
    use tempfile::tempdir;

    /// Tells how often it was derived.
    fn stored(folder: &Path, subject: &str, derived: &Cell<usize>) -> Vec<f64> {
        let numbers = || {
            derived.set(derived.get() + 1);
            Ok(vec![0.1, -0.0, f64::MIN_POSITIVE, subject.len() as f64])
        };
        stored_in(folder, subject, numbers).unwrap()
    }

    fn bits(numbers: &[f64]) -> Vec<u64> {
        numbers.iter().map(|number| number.to_bits()).collect()
    }

    fn trot() -> Mechanism {
        let robot = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../model-spec")).unwrap();
        mechanism(robot.specified(), robot.specified_gait("trot").unwrap()).unwrap()
    }

    #[test]
    fn what_is_read_is_what_was_derived_to_the_bit() {
        let folder = tempdir().unwrap();
        let trot = trot();
        let derive = || Ok(Derived::of(&trot).unwrap());
        let bytes = |derived: &Derived| postcard::to_allocvec(derived).unwrap();
        let first = stored_in(folder.path(), "trot", derive).unwrap();
        let second = stored_in(folder.path(), "trot", || -> Result<Derived, _> {
            panic!("it was not read");
        });
        assert_eq!(bytes(&first), bytes(&second.unwrap()));
    }

    #[test]
    fn what_differs_is_derived_for_itself() {
        let (folder, count) = (tempdir().unwrap(), Cell::new(0));
        let of = |subject| stored(folder.path(), subject, &count)[3];
        assert_eq!([of("a"), of("ab"), of("a"), of("ab")], [1.0, 2.0, 1.0, 2.0]);
        assert_eq!(count.get(), 2);
    }

    #[test]
    fn damaged_and_foreign_files_are_as_good_as_none() {
        let (folder, count) = (tempdir().unwrap(), Cell::new(0));
        let file = folder.path().join(name(&key("trot")));
        let right = bits(&stored(folder.path(), "trot", &count));
        let whole = fs::read(&file).unwrap();
        let of_another = {
            stored(folder.path(), "amble", &count);
            fs::read(folder.path().join(name(&key("amble")))).unwrap()
        };
        let cut = (0..whole.len()).map(|length| whole[..length].to_vec());
        let flipped = (0..8 * whole.len()).map(|bit| {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        });
        let longer = [whole.as_slice(), b"more"].concat();
        let foreign = [of_another, longer, b"#!/bin/sh\n".to_vec(), vec![0; HASH], vec![0xff; 1 << 16]];
        for bytes in cut.chain(flipped).chain(foreign) {
            fs::write(&file, bytes).unwrap();
            count.set(0);
            assert_eq!(bits(&stored(folder.path(), "trot", &count)), right);
            assert_eq!(count.get(), 1, "a damaged file was trusted");
            assert_eq!(fs::read(&file).unwrap(), whole, "it was not written anew");
        }
    }

    #[test]
    fn where_nothing_can_be_written_everything_is_derived() {
        let (folder, count) = (tempdir().unwrap(), Cell::new(0));
        fs::write(folder.path().join("file"), "no folder").unwrap();
        let nowhere = folder.path().join("file/below");
        assert_eq!(stored(&nowhere, "trot", &count), stored(&nowhere, "trot", &count));
        // Where the file should be is a folder.
        fs::create_dir_all(folder.path().join(name(&key("trot"))).join("something")).unwrap();
        assert_eq!(stored(folder.path(), "trot", &count), stored(folder.path(), "trot", &count));
        assert_eq!(count.get(), 4);
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 2, "drafts were left: {left:?}");
    }

    #[test]
    fn many_may_write_the_same_at_once() {
        let folder = tempdir().unwrap();
        let right = bits(&stored(folder.path(), "trot", &Cell::new(0)));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let _ = fs::remove_file(folder.path().join(name(&key("trot"))));
                        assert_eq!(bits(&stored(folder.path(), "trot", &Cell::new(0))), right);
                    }
                });
            }
        });
    }

    #[test]
    fn what_was_not_used_for_longest_goes_first_and_nothing_of_others() {
        let (folder, count) = (tempdir().unwrap(), Cell::new(0));
        let at = |subject: &str| folder.path().join(name(&key(subject)));
        let long_ago = SystemTime::now() - Duration::from_secs(3600);
        for (k, subject) in ["first", "second", "third"].into_iter().enumerate() {
            stored(folder.path(), subject, &count);
            let file = fs::File::options().append(true).open(at(subject)).unwrap();
            file.set_modified(long_ago + Duration::from_secs(k as u64)).unwrap();
        }
        fs::write(folder.path().join("thesis.txt"), [0; 4096]).unwrap();
        fs::write(folder.path().join(format!("draft{ENDING}")), [0; 1 << 14]).unwrap();
        stored(folder.path(), "first", &count);
        let length = fs::metadata(at("first")).unwrap().len();
        tidy(folder.path(), length + (1 << 14)).unwrap();
        assert_eq!(["first", "second", "third"].map(|subject| at(subject).exists()), [true, false, false]);
        assert!(folder.path().join("thesis.txt").exists());
    }
}
