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

#[test]
fn the_solver_knows_no_robot() {
    let solver = sources("src/sqp");
    none(
        lines_with(&solver, "crate::").filter(|l| !l.contains("crate::sqp")),
        "src/sqp imports from the rest of the crate",
    );
}

#[test]
fn the_verifier_shares_nothing_but_the_description_and_the_motion() {
    let verifier = sources("src/verify");
    let own = ["crate::verify", "crate::number", "crate::model", "crate::motion"];
    none(lines_with(&verifier, "crate::").filter(|l| !own.iter().any(|o| l.contains(o))), "src/verify imports more");
    none(lines_with(&verifier, "Gait").filter(|l| !l.contains("GaitResult")), "src/verify uses generated kernels");
}

#[test]
fn the_optimizer_reads_limits_for_itself() {
    for folder in ["src/constraints", "src/cost", "src/cycle", "src/instant", "src/stance"] {
        none(lines_with(&sources(folder), "verify::"), "what is optimized is read as it is verified");
    }
}

#[test]
fn kinds_of_numbers_know_no_robot() {
    none(
        lines_with(&sources("src/number"), "crate::").filter(|l| !l.contains("crate::number")),
        "src/number imports more",
    );
}

#[test]
fn the_certificate_knows_the_verifiers_physics_alone() {
    let certificate = sources("src/certificate");
    let own = ["crate::certificate", "crate::verify", "crate::number", "crate::model", "crate::motion"];
    none(lines_with(&certificate, "crate::").filter(|l| !own.iter().any(|o| l.contains(o))), "it imports more");
}

#[test]
fn nothing_below_the_command_line_prints() {
    let all = sources("src");
    let below: Vec<_> = all.into_iter().filter(|(p, _)| !p.components().any(|c| c.as_os_str() == "cli")).collect();
    for print in ["println!", "eprintln!", "print!(", "dbg!"] {
        none(lines_with(&below, print), "a library file prints");
    }
}

#[test]
fn codegen_knows_no_runtime_and_only_its_facade_touches_the_world() {
    let codegen = sources("codegen/src");
    none(lines_with(&codegen, "use piaffe::"), "codegen imports the runtime");
    let pure: Vec<_> = codegen
        .into_iter()
        .filter(|(p, _)| p.file_name().is_none_or(|f| f != "config.rs" && f != "tests.rs"))
        .collect();
    for word in ["println!", "std::env", "std::fs", "env::var"] {
        none(lines_with(&pure, word), "a pass of codegen reads, writes or prints");
    }
}

#[test]
fn no_source_is_unsafe() {
    for folder in ["src", "codegen/src", "codegen/support"] {
        none(lines_with(&sources(folder), "unsafe ").filter(|l| !l.contains("\"")), "unsafe code");
    }
}
