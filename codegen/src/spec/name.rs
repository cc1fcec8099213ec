//! Names: what a specification may call its parts, and what becomes of a gait's name in Rust.
//!
//! Links, joints, legs and actuators are only ever texts in generated code, so a plain word is enough. A gait becomes a
//! module and a type, a robot's folder a module; these must be identifiers that nothing else there is called.

use super::Code;
use super::diagnostic::{At, Sink, Source, Span};
use super::syntax;
use super::view::View;

/// What stands for all gaits of a robot where gaits are named.
pub const ALL: &str = "all";

const RULE: &str = "letters a to z, digits and _, a letter first, 100 at most";

/// Most characters of a name: it becomes part of the names of files.
pub(super) const LONGEST: usize = 100;

/// Reports a name of a link, joint, leg or actuator that cannot be used.
pub(super) fn check(name: &At<String>, sink: &mut Sink) {
    if !is_usable(&name.value) {
        let title = format!("\"{}\" cannot be a name", shortened(&name.value));
        sink.report(Code::BadName, title, &name.span, RULE, format!("write for example {}", usable(&name.value)));
    }
}

fn is_usable(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|c| c.is_ascii_alphabetic())
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.len() <= LONGEST
}

/// A usable name like this one.
fn usable(name: &str) -> String {
    let cleaned: String = name.chars().take(40).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if is_usable(&cleaned) { cleaned } else { format!("a_{}", cleaned.trim_matches('_')) }
}

/// The beginning of a name that may be of any length.
fn shortened(name: &str) -> String {
    let beginning: String = name.chars().take(LONGEST).collect();
    if beginning.len() < name.len() { beginning + "…" } else { beginning }
}

/// A robot's name: free text that is a line of visible characters. Nothing else could be told apart where it is shown,
/// and characters that turn the direction of writing would do so to all that follows.
pub(super) fn of_robot(root: &View<'_>, sink: &mut Sink) -> Option<String> {
    let name = root.text("name", sink)?;
    let unseen = name.value.chars().find(|c| !is_visible(*c));
    let (title, help) = if let Some(c) = unseen {
        let title = format!("the robot's name has the character U+{:04X} in it, which cannot be seen", u32::from(c));
        (title, "write letters, digits, signs and plain spaces, on one line")
    } else if name.value.trim().is_empty() {
        ("this name is empty".into(), "write name = \"my robot\"")
    } else if name.value.chars().count() > LONGEST {
        (format!("the robot's name has more than {LONGEST} characters"), "write a shorter one, and more in a comment")
    } else {
        return Some(name.value);
    };
    sink.report(Code::BadName, title, &name.span, "expected a few words on one line", help);
    None
}

/// Whether a character shows itself: no control or format character, no space but the plain one, nothing unassigned.
pub(super) fn is_visible(c: char) -> bool {
    if c.is_ascii() {
        return (' '..='~').contains(&c);
    }
    // Behind a letter, where accents that join it are let stand.
    let mut text = *b"a----";
    let end = 1 + c.encode_utf8(&mut text[1..]).len();
    std::str::from_utf8(&text[..end]).is_ok_and(|text| text.escape_debug().nth(1) != Some('\\'))
}

/// A gait's name, given or the file's; it becomes the name of a Rust module, and that of a type in it.
pub(super) fn of_gait(path: &str, root: &View<'_>, sink: &mut Sink) -> Option<String> {
    let name = if root.has("name") {
        root.text("name", sink)?
    } else {
        let stem = std::path::Path::new(path).file_stem().and_then(|stem| stem.to_str());
        At { value: stem.unwrap_or_default().to_string(), span: root.at.clone() }
    };
    let (title, label) = if !is_usable(&name.value) {
        (format!("\"{}\" cannot be a gait's name", shortened(&name.value)), RULE.to_string())
    } else if name.value == ALL {
        (format!("a gait cannot be called \"{ALL}\": the word stands for all gaits"), "could not be asked for".into())
    } else if let Some(why) = unusable_in_rust(&name.value) {
        (format!("a gait cannot be called \"{}\": {why}", name.value), "names a module and a type".to_string())
    } else {
        return Some(name.value);
    };
    let usable = usable(&name.value);
    let gait = if usable == ALL || unusable_in_rust(&usable).is_some() { "_gait" } else { "" };
    sink.report(Code::BadName, title, &name.span, label, format!("write name = \"{usable}{gait}\""));
    None
}

/// Where a gait's file gives its name; its beginning where the name is the file's.
pub(crate) fn place_of_gait(source: &Source) -> Span {
    let mut sink = Sink::new(source.clone());
    let root = syntax::document(source.text(), &mut sink);
    root.and_then(|root| root.get("name").map(|name| name.span())).unwrap_or(0..0)
}

/// A name as that of a Rust module: lower case, `_` for everything else.
pub fn module_name(name: &str) -> String {
    let mut result: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    if result.starts_with(|c: char| c.is_ascii_digit()) || result.is_empty() {
        result.insert(0, '_');
    }
    result
}

/// A name as that of a Rust type: `trot` → `Trot`.
pub fn type_name(name: &str) -> String {
    let mut result = String::new();
    let mut upper = true;
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            result.push(if upper { c.to_ascii_uppercase() } else { c });
        }
        upper = !c.is_ascii_alphanumeric();
    }
    result
}

/// Why the module and the type of a gait cannot be called what they would be.
fn unusable_in_rust(name: &str) -> Option<String> {
    let (module, ty) = (module_name(name), type_name(name));
    if let Some(why) = unusable_as_module(&module) {
        return Some(format!("its module would be `{module}`, {why}"));
    }
    let item = ty.strip_prefix(OF_FLIGHT).unwrap_or(&ty);
    let taken = ITEMS.contains(&item) || !ty.starts_with(|c: char| c.is_ascii_alphabetic());
    taken.then(|| format!("its type would be `{ty}`, which the generated code has or needs itself"))
}

/// Why the folder of a further robot cannot have this name: it is that of a module.
pub fn unusable_as_folder(name: &str) -> Option<&'static str> {
    if !is_identifier(name) || name.len() > LONGEST {
        Some("it names a module in Rust: letters a to z, digits and _, a letter first")
    } else if name != module_name(name) {
        Some("it names a module in Rust: write it in small letters")
    } else if name == FAMILIES_FOLDER {
        Some("the generated code of families is kept in a folder of that name")
    } else {
        unusable_as_module(name)
    }
}

fn is_identifier(name: &str) -> bool {
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name != "_";
    begins && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn unusable_as_module(module: &str) -> Option<&'static str> {
    let numbered = [EMBEDDING, WHOLE].contains(&module.trim_end_matches(|c: char| c.is_ascii_digit()));
    if KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(module)) {
        Some("a word of Rust")
    } else if numbered || MODULES.contains(&module) {
        Some("which the generated code has itself")
    } else if LIBRARIES.contains(&module) {
        Some("the name of a library that generated code needs")
    } else if DEVICES.contains(&module) {
        Some("which cannot name a file on Windows")
    } else {
        None
    }
}

/// Name of the module with the kernels of gaits that move their robot alike. Those of further ways have a number behind it.
pub const EMBEDDING: &str = "embedding";

/// Name of the module of a whole robot. Those of further ways to lock its joints have a number behind it.
pub const WHOLE: &str = "whole";

/// Folder of the generated files of families.
pub const FAMILIES_FOLDER: &str = "family";

/// Modules and files beside those of gaits and robots.
const MODULES: &[&str] = &["math", "gaits", "families", "specification"];

const LIBRARIES: &[&str] = &["std", "core", "alloc", "proc_macro", "piaffe"];

/// Files of these names are devices on Windows, whatever their extension.
const DEVICES: &[&str] = &[
    "con", "prn", "aux", "nul", "com1", "com2", "com3", "com4", "com5", "com6", "com7", "com8", "com9", "lpt1", "lpt2",
    "lpt3", "lpt4", "lpt5", "lpt6", "lpt7", "lpt8", "lpt9",
];

/// What is before the name of a type that a kernel of flight returns; behind it is the name of its twin of stance.
pub const OF_FLIGHT: &str = "Flight";

/// What a gait's module names or defines beside the gait's type, but for types of flight; `tests/laws.rs` compares.
pub const ITEMS: &[&str] = &[
    "CentreOfMass",
    "Curvature",
    "DESCRIPTION",
    "Energy",
    "Forward",
    "Heights",
    "HeightsCurvature",
    "Impact",
    "ImpactBoth",
    "InertiaAndBias",
    "Inverse",
    "InverseJacobian",
    "LEVERS",
    "Landing",
    "LandingCurvature",
    "Late",
    "LateGradient",
    "Momentum",
    "MomentumTerms",
    "N",
    "None",
    "Ok",
    "Option",
    "PARAMETERS",
    "Placement",
    "Reduced",
    "Result",
    "SPECIFICATION",
    "Self",
    "Sharing",
    "SharingCurvature",
    "Some",
    "SwingVelocity",
    "T",
    "Takeoff",
    "TakeoffCurvature",
    "Touchdown",
    "TouchdownCurvature",
];

const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super", "trait", "true",
    "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_rust_or_the_generated_code_needs() {
        for good in [
            "trot",
            "Trot",
            "a_b",
            "x1",
            "f64",
            "flight",
            "flying",
            "str",
            "test",
            "union",
            "description",
            "clone",
            "a__",
        ] {
            assert_eq!(unusable_in_rust(good), None, "{good}");
        }
        let keywords = ["fn", "Fn", "FN", "SELF", "Self", "self_", "Self__", "dyn", "gen", "async"];
        let items = [
            "Option",
            "option",
            "some",
            "none",
            "ok",
            "t",
            "DESCRIPTION",
            "impact",
            "Inverse_Jacobian",
            "takeoff",
            "Landing",
            "flight_late",
        ];
        let modules = [
            "Math",
            "gaits",
            "specification",
            "Families",
            "whole",
            "WHOLE2",
            "embedding",
            "Embedding3",
            "std",
            "core",
            "piaffe",
            "con",
            "LPT1",
        ];
        for bad in keywords.iter().chain(&items).chain(&modules) {
            assert!(unusable_in_rust(bad).is_some(), "{bad}");
        }
    }

    #[test]
    fn visible_characters() {
        for good in "aZ9 _-'\"\\é猫ñ\u{301}😀µ".chars() {
            assert!(is_visible(good), "{good:?}");
        }
        for bad in
            "\n\t\0\u{1b}\u{7f}\u{85}\u{a0}\u{ad}\u{200b}\u{200d}\u{200e}\u{202e}\u{2028}\u{2066}\u{feff}\u{e000}"
                .chars()
        {
            assert!(!is_visible(bad), "{bad:?}");
        }
    }
}
