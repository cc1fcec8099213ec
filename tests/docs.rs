//! What the documents say is so: every command in them runs, and the reference of the specification is the schemas'.

use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The documents of the book, and the README.
fn documents() -> Vec<PathBuf> {
    let docs = std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut list: Vec<PathBuf> = docs.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    list.push(root().join("README.md"));
    list.sort();
    list
}

/// Bodies of the fenced blocks of a language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.trim() == format!("```{language}") {
            found.push(lines.by_ref().take_while(|l| l.trim() != "```").collect::<Vec<_>>().join("\n"));
        }
    }
    found
}

#[test]
fn every_chapter_is_in_the_summary_and_every_link_leads_somewhere() {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    for file in documents() {
        let name = file.file_name().unwrap().to_str().unwrap();
        if name != "README.md" && name != "SUMMARY.md" {
            assert!(summary.contains(&format!("({name})")), "{name} is not in docs/SUMMARY.md");
        }
        let text = std::fs::read_to_string(&file).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = link.split('#').next().unwrap();
            let outside = target.contains("://") || target.is_empty();
            assert!(outside || file.parent().unwrap().join(target).exists(), "{name}: {link} leads nowhere");
        }
    }
}

/// Commands of a block: lines after `$`, with those that they are continued on.
fn commands(block: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut open = false;
    for line in block.lines() {
        match line.strip_prefix("$ ") {
            Some(command) => found.push(command.to_string()),
            None if open => found.last_mut().unwrap().push_str(&format!("\n{line}")),
            None => continue,
        }
        open = line.ends_with('\\');
    }
    found
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy(&from, &to) } else { assert!(std::fs::copy(from, to).is_ok()) }
    }
}

/// Each document's commands run one after another in a folder of their own with the specifications, where `piaffe` is this build's.
/// What starts with `cargo` builds the project and is another test's.
#[test]
fn commands_in_the_documents_run() {
    let program = Path::new(env!("CARGO_BIN_EXE_piaffe")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let mut count = 0;
    for file in documents() {
        let folder = tempfile::tempdir().unwrap();
        copy(&root().join("model-spec"), &folder.path().join("model-spec"));
        let text = std::fs::read_to_string(&file).unwrap();
        let all = blocks(&text, "console").into_iter().flat_map(|block| commands(&block));
        for command in all.filter(|c| !c.starts_with("cargo")) {
            let out = Command::new("sh")
                .args(["-ec", &command])
                .current_dir(folder.path())
                .env("PATH", &path)
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&out.stderr);
            assert!(out.status.success(), "{}: `{command}` fails: {said}", file.display());
            count += 1;
        }
    }
    assert!(count >= 8, "the documents have {count} commands only");
}

/// The tutorial changes the robot; its fragments must be what stands in the file.
#[test]
fn fragments_of_the_specification_are_real() {
    let robot = std::fs::read_to_string(root().join("model-spec/robot.toml")).unwrap();
    let gait = std::fs::read_to_string(root().join("model-spec/gaits/trot.toml")).unwrap();
    let squeeze = |text: &str| text.split('#').next().unwrap_or("").split_whitespace().collect::<String>();
    let known: Vec<String> = robot.lines().chain(gait.lines()).map(squeeze).collect();
    let tutorial = std::fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let fragments = blocks(&tutorial, "toml");
    assert!(!fragments.is_empty());
    for line in fragments.iter().flat_map(|f| f.lines()).map(squeeze).filter(|l| !l.is_empty()) {
        assert!(known.contains(&line), "the specification has no line `{line}`");
    }
}

/// `docs/specification.md` is written from the schemas; `BLESS=1` writes it anew.
#[test]
fn the_reference_is_that_of_the_schemas() {
    let mut text = String::from(
        "# The specification\n\nEvery key, its unit and its bounds; written from `model-spec/schema/`. A key without a \
         default must be there; of a gait's phases either `half_steps`, or `phases` and `cycle`.\n",
    );
    for (name, intro) in [("robot", "`robot.toml`"), ("gait", "`gaits/*.toml`")] {
        let file = root().join(format!("model-spec/schema/{name}.schema.json"));
        let schema: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let _ = write!(text, "\n## {intro}\n\n{}\n", schema["description"].as_str().unwrap());
        let mut rows = Vec::new();
        walk(&schema, "", &mut rows);
        text += "\n| key | what | type |\n|---|---|---|\n";
        for [key, what, kind] in rows {
            let _ = writeln!(text, "| `{key}` | {what} | {kind} |");
        }
    }
    let file = root().join("docs/specification.md");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&file, &text).unwrap();
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(found == text, "docs/specification.md is not that of the schemas: run this test with BLESS=1");
}

/// All keys below a schema: key, description, type with bounds.
fn walk(schema: &Value, at: &str, rows: &mut Vec<[String; 3]>) {
    let joined = |key: &str| if at.is_empty() { key.to_string() } else { format!("{at}.{key}") };
    for (key, value) in schema["properties"].as_object().into_iter().flatten() {
        rows.push([joined(key), cell(value["description"].as_str().unwrap_or("")), kind(value)]);
        walk(value, &joined(key), rows);
        walk(&value["items"], &format!("{}.NUMBER", joined(key)), rows);
    }
    let named = &schema["additionalProperties"];
    if named.is_object() {
        for form in named["anyOf"].as_array().map_or(vec![named], |forms| forms.iter().collect()) {
            let key = joined("NAME");
            rows.push([key.clone(), cell(form["description"].as_str().unwrap_or("")), kind(form)]);
            walk(form, &key, rows);
        }
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn kind(schema: &Value) -> String {
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(", ");
    }
    if let Some(forms) = schema["anyOf"].as_array() {
        return forms.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    let mut text = match schema["type"].as_str().unwrap_or("any") {
        "object" => "table".to_string(),
        "array" => match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
            (Some(a), Some(b)) if a == b => format!("{a} × {}", kind(&schema["items"])),
            _ => format!("list of {}", kind(&schema["items"])),
        },
        other => other.to_string(),
    };
    let number = |key: &str| schema[key].as_f64();
    if let Some(bound) = number("minimum") {
        let _ = write!(text, " ≥ {}", (bound * 1e4).round() / 1e4);
    }
    if let Some(bound) = number("exclusiveMinimum") {
        let _ = write!(text, " > {bound}");
    }
    if let Some(bound) = number("maximum") {
        let _ = write!(text, " ≤ {}", (bound * 1e4).round() / 1e4);
    }
    text
}
