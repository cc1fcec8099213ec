//! The layers keep to their imports: what ARCHITECTURE.md promises, read off the sources.

use std::path::{Path, PathBuf};

fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty());
    found
}

/// Lines of code that contain `pattern`, comments and unit tests aside.
fn lines_with<'a>(sources: &'a [(PathBuf, String)], pattern: &'a str) -> impl Iterator<Item = String> + 'a {
    sources.iter().flat_map(move |(path, text)| {
        let code = text.lines().take_while(|l| *l != "#[cfg(test)]").enumerate();
        let code = code.filter(|(_, l)| !l.trim_start().starts_with("//"));
        code.filter(move |(_, l)| l.contains(pattern)).map(|(n, l)| format!("{}:{}: {l}", path.display(), n + 1))
    })
}

fn none(found: impl Iterator<Item = String>, law: &str) {
    let found: Vec<String> = found.collect();
    assert!(found.is_empty(), "{law}:\n{}", found.join("\n"));
}

/// The crates that the crate in `folder` may use of this project.
fn uses(folder: &str) -> Vec<String> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("Cargo.toml");
    let manifest: toml::Table = std::fs::read_to_string(manifest).unwrap().parse().unwrap();
    let own = manifest["dependencies"].as_table().unwrap().keys().filter_map(|d| d.strip_prefix("piaffe-"));
    own.map(String::from).collect()
}

/// The compiler holds every crate to its manifest; this holds the manifests.
#[test]
fn crates_know_no_more_than_they_must() {
    let none: [&str; 0] = [];
    assert_eq!(uses("crates/number"), none, "kinds of numbers know no robot");
    assert_eq!(uses("crates/sqp"), none, "the solver knows no robot");
    assert_eq!(uses("crates/model"), none);
    assert_eq!(uses("codegen"), none, "the derivation knows no runtime");
    assert_eq!(uses("crates/verify"), ["model", "number"], "the verifier shares the description and the motion alone");
    assert_eq!(uses("crates/optimizer"), ["model", "number", "sqp", "verify"]);
    assert_eq!(
        uses("crates/import"),
        ["codegen", "interpreter", "model", "optimizer"],
        "it tries the gaits that it writes, and knows no robot of the build"
    );
    assert_eq!(uses("crates/interpreter"), ["codegen", "model"], "it derives what it gives, and asks nobody for more");
    assert_eq!(
        uses("crates/study"),
        ["codegen", "interpreter", "model", "optimizer", "verify"],
        "it knows no robot of the build"
    );
}

#[test]
fn the_verifier_uses_no_generated_kernel() {
    none(lines_with(&sources("crates/verify/src"), "dyn Gait"), "it derives the dynamics for itself");
}

#[test]
fn the_optimizer_reads_limits_for_itself() {
    for folder in ["constraints", "cost", "cycle", "flow", "instant"].map(|f| format!("crates/optimizer/src/{f}")) {
        none(lines_with(&sources(&folder), "piaffe_verify"), "what is optimized is read as it is verified");
    }
}

#[test]
fn nothing_below_the_command_line_prints() {
    let all = sources("crates");
    // What a build script prints is for cargo.
    let speaks = |path: &Path| path.components().any(|c| ["cli", "build.rs"].iter().any(|name| c.as_os_str() == *name));
    let below: Vec<_> = all.into_iter().filter(|(path, _)| !speaks(path)).collect();
    for print in ["println!", "eprintln!", "print!(", "dbg!"] {
        none(lines_with(&below, print), "a library file prints");
    }
}

#[test]
fn only_the_facade_of_codegen_touches_the_world() {
    let all_but = |facade: &[&str]| -> Vec<(PathBuf, String)> {
        let is_pure = |path: &Path| path.file_name().is_none_or(|file| !facade.iter().any(|one| file == *one));
        sources("codegen/src").into_iter().filter(|(path, _)| is_pure(path)).collect()
    };
    for word in ["println!", "std::env", "env::var", "fs::write", "fs::create"] {
        none(lines_with(&all_but(&["config.rs", "tests.rs"]), word), "a pass of codegen asks, writes or prints");
    }
    for word in ["std::fs", "fs::", "File::"] {
        none(lines_with(&all_but(&["config.rs", "files.rs", "tests.rs"]), word), "a pass of codegen reads");
    }
}

#[test]
fn no_source_is_unsafe() {
    for folder in ["src", "crates", "codegen/src", "codegen/support", "python/src"] {
        none(lines_with(&sources(folder), "unsafe ").filter(|l| !l.contains("\"")), "unsafe code");
    }
}

/// A platform's own sines and powers differ in their last bits from those of another: `clippy.toml` lists them.
#[test]
fn numbers_that_end_in_results_have_the_same_bits_everywhere() {
    let forbids = "#![cfg_attr(not(test), deny(clippy::disallowed_methods))]";
    const FOLDERS: [&str; 9] = [
        "codegen",
        "crates/export",
        "crates/interpreter",
        "crates/model",
        "crates/number",
        "crates/optimizer",
        "crates/sqp",
        "crates/study",
        "crates/verify",
    ];
    for folder in FOLDERS {
        let all = sources(&format!("{folder}/src"));
        let root = all.iter().find(|(path, _)| path.ends_with("src/lib.rs")).unwrap();
        assert!(root.1.lines().any(|line| line == forbids), "{folder}: nothing keeps it from the platform's sine");
        let allowed =
            lines_with(&all, "allow(clippy::disallowed_methods").filter(|line| !line.contains("reason = \"words: "));
        none(allowed, "a number depends on the platform");
    }
}

/// Half a minute of every first build. Where a dependency of the program asks for a feature of what the generator uses too, it has
/// to be said among the build dependencies as well.
#[test]
fn the_generator_is_compiled_once() {
    let listed = std::process::Command::new(env!("CARGO"))
        .args(["build", "--release", "--offline", "--unit-graph", "-Z", "unstable-options"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        // What would be compiled is listed by an option that is not stable yet.
        .env("RUSTC_BOOTSTRAP", "1")
        .output()
        .unwrap();
    let units: serde_json::Value = serde_json::from_slice(&listed.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&listed.stderr)));
    let units = units["units"].as_array().unwrap();
    let of = |name: &str| {
        let compiled = units.iter().filter(|unit| unit["mode"] == "build" && unit["target"]["name"] == name);
        compiled.map(|unit| unit["features"].to_string()).collect::<Vec<_>>()
    };
    let twice = ["anstyle", "either", "serde_core", "rayon", "toml"].map(|name| format!("{name} {:?}", of(name)));
    assert_eq!(of("piaffe_codegen").len(), 1, "of what it uses: {}", twice.join(", "));
}
