//! Text and JSON from a file or standard input, with errors that say where.

use super::harmless::line;
use super::whole;
use anyhow::{Context, bail};
use piaffe_codegen::RobotFiles;
use piaffe_codegen::spec::BYTE_ORDER_MARK;
use serde::de::{DeserializeOwned, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};
use std::fmt;
use std::io::Read;
use std::path::Path;

/// No input of ours is larger, in bytes; without an end, a device would fill the memory.
const LARGEST: u64 = 1 << 28;

/// What to call `file` in words.
pub fn name(file: &Path) -> String {
    if is_standard(file) { "standard input".into() } else { line(&file.to_string_lossy()).into_owned() }
}

/// Whether `file` stands for standard input.
pub fn is_standard(file: &Path) -> bool {
    file.as_os_str() == "-"
}

/// What is in `file`, or comes from standard input for `-`. From now on it is not written over.
pub fn read(file: &Path) -> anyhow::Result<Vec<u8>> {
    let cannot = || format!("cannot read {}", name(file));
    let mut bytes = Vec::new();
    let read = if is_standard(file) {
        std::io::stdin().lock().take(LARGEST + 1).read_to_end(&mut bytes)
    } else {
        std::fs::File::open(file).and_then(|f| f.take(LARGEST + 1).read_to_end(&mut bytes))
    };
    let length = read.with_context(cannot)?;
    if length as u64 > LARGEST {
        bail!("{}: it has more than {} MB", cannot(), LARGEST >> 20);
    }
    if !is_standard(file) {
        whole::protect(file);
    }
    Ok(bytes)
}

/// The files of a robot's folder. From now on they are not written over.
///
/// # Errors
/// What is missing or cannot be read.
pub fn robot(folder: &Path) -> Result<RobotFiles, String> {
    let files = RobotFiles::read(folder)?;
    std::iter::once(&files.robot).chain(&files.gaits).for_each(|file| whole::protect(Path::new(&file.path)));
    Ok(files)
}

/// The text of `file`, or of standard input for `-`.
pub fn read_text(file: &Path) -> anyhow::Result<String> {
    String::from_utf8(read(file)?).with_context(|| format!("cannot read {}: it is no text", name(file)))
}

/// Reads and parses `file`, or standard input for `-`.
pub fn read_json<T: DeserializeOwned>(file: &Path) -> anyhow::Result<T> {
    parse_json(file, &read_text(file)?)
}

/// Parses what was read from `file`, or from standard input for `-`. Texts in it are made harmless.
pub fn parse_json<T: DeserializeOwned>(file: &Path, text: &str) -> anyhow::Result<T> {
    let name = name(file);
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    if text.trim().is_empty() {
        bail!("{name} is empty: JSON was expected");
    }
    let at = |e: serde_json::Error| {
        let excerpt = text.lines().nth(e.line().saturating_sub(1)).unwrap_or_default();
        let start = e.column().saturating_sub(40);
        let excerpt: String = excerpt.chars().skip(start).take(60).collect();
        anyhow::anyhow!("{name}:{}:{}: {}\n  | {}", e.line(), e.column(), line(&e.to_string()), line(&excerpt))
    };
    let Unique(mut value) = serde_json::from_str(text).map_err(at)?;
    // For its places in errors; what is used is read from the harmless value.
    drop(serde_json::from_str::<T>(text).map_err(at)?);
    disarm(&mut value);
    serde_json::from_value(value).with_context(|| name.clone())
}

/// JSON in which no key stands twice: who reads the first and who reads the last would read different things.
struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Unique, D::Error> {
        deserializer.deserialize_any(AnyJson).map(Unique)
    }
}

struct AnyJson;

impl<'de> Visitor<'de> for AnyJson {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if map.contains_key(&key) {
                return Err(A::Error::custom(format!("duplicate field `{key}`")));
            }
            let Unique(value) = entries.next_value()?;
            map.insert(key, value);
        }
        Ok(map.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(Unique(value)) = elements.next_element()? {
            list.push(value);
        }
        Ok(list.into())
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }
}

/// The entry of a result that holds files.
const SPECIFICATION: &str = "specification";

/// Makes all texts in a value harmless.
fn disarm(value: &mut Value) {
    match value {
        Value::String(text) => *text = line(text).into_owned(),
        Value::Array(items) => items.iter_mut().for_each(disarm),
        Value::Object(map) => {
            let entries = std::mem::take(map);
            map.extend(entries.into_iter().map(|(key, mut value)| {
                // The files of a robot are read as they are, to the byte, and never shown but by their own messages.
                if key != SPECIFICATION {
                    disarm(&mut value);
                }
                (line(&key).into_owned(), value)
            }));
        }
        _ => {}
    }
}
