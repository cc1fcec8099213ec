//! Hands the crate a hash of its own sources.

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rustc-env=SOURCES={:016x}", piaffe_codegen::sources::hash(&["src"])?);
    Ok(())
}
