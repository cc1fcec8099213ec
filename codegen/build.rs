//! Hands the crate a hash of its own sources.

#[path = "support/sources.rs"]
mod sources;

const FOLDERS: [&str; 2] = ["src", "support"];

fn main() -> std::io::Result<()> {
    FOLDERS.iter().for_each(|folder| println!("cargo::rerun-if-changed={folder}"));
    println!("cargo::rustc-env=SOURCES={:016x}", sources::hash(&FOLDERS)?);
    Ok(())
}
