//! Names: they appear in generated code and in references such as `leg1.haunch`.

use super::Code;
use super::diagnostic::{At, Sink};
use super::view::View;

const RULE: &str = "letters a to z, digits and _, a letter first";

/// Reports a name of a link, joint, leg or actuator that cannot be used.
pub(super) fn check(name: &At<String>, sink: &mut Sink) {
    if !is_usable(&name.value) {
        let title = format!("\"{}\" cannot be a name", name.value);
        sink.report(Code::BadName, title, &name.span, RULE, format!("write for example {}", usable(&name.value)));
    }
}

fn is_usable(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|c| c.is_ascii_alphabetic()) && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Whether a module can have this name.
pub fn is_of_rust(name: &str) -> bool {
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name != "_";
    begins && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !KEYWORDS.contains(&name)
}

/// A usable name like this one.
fn usable(name: &str) -> String {
    let cleaned: String = name.chars().take(40).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if is_usable(&cleaned) { cleaned } else { format!("a_{}", cleaned.trim_matches('_')) }
}

/// A robot's name: free text, but it must fit into a comment of one line.
pub(super) fn of_robot(root: &View<'_>, sink: &mut Sink) -> Option<String> {
    let name = root.text("name", sink)?;
    if name.value.trim().is_empty() || name.value.chars().any(char::is_control) {
        let label = "expected a few words on one line";
        let help = "write name = \"my robot\"";
        sink.report(Code::BadName, "this name is not a line of text", &name.span, label, help);
        return None;
    }
    Some(name.value)
}

/// A gait's name, given or the file's; it becomes the name of a Rust module.
pub(super) fn of_gait(path: &str, root: &View<'_>, sink: &mut Sink) -> Option<String> {
    let name = if root.has("name") {
        root.text("name", sink)?
    } else {
        let stem = std::path::Path::new(path).file_stem().and_then(|stem| stem.to_str());
        At { value: stem.unwrap_or_default().to_string(), span: root.at.clone() }
    };
    let (title, label) = if !is_usable(&name.value) {
        (format!("\"{}\" cannot be a gait's name", name.value), RULE)
    } else if KEYWORDS.contains(&name.value.as_str()) {
        (format!("the gait's name \"{}\" is a word of Rust", name.value), "it names the generated module")
    } else {
        return Some(name.value);
    };
    let usable = usable(&name.value);
    let gait = if KEYWORDS.contains(&usable.as_str()) { "_gait" } else { "" };
    sink.report(Code::BadName, title, &name.span, label, format!("write name = \"{usable}{gait}\""));
    None
}

const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self", "static", "struct", "super", "trait",
    "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];
