//! Text → TOML table, or what is wrong with its syntax.

use toml::de::DeTable;

use super::Code;
use super::diagnostic::Sink;

/// Parses a whole file; `None` if it is not TOML.
pub(super) fn document<'t>(text: &'t str, sink: &mut Sink) -> Option<DeTable<'t>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        return Some(table.into_inner());
    }
    let mut errors: Vec<_> = errors.into_iter().map(|e| (e.span().unwrap_or(0..0), e.message().to_string())).collect();
    errors.sort_by_key(|(span, _)| span.start);
    // After a slip the parser stumbles on, line by line, until it finds its feet: only the first of each
    // such run says anything useful.
    let mut stumbled: Option<usize> = None;
    for (span, message) in errors {
        let gap = stumbled.and_then(|from| text.get(from..span.start));
        let follows = gap.is_some_and(|gap| gap.lines().filter(|l| !is_blank(l)).count() <= 2);
        stumbled = Some(span.start);
        if !follows {
            let (label, help) = syntax_advice(message);
            sink.report(Code::Syntax, "this is not TOML", &span, label, help);
        }
    }
    None
}

fn is_blank(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with('#')
}

/// The parser's words, and what to write instead.
fn syntax_advice(message: String) -> (String, &'static str) {
    let help = if message.contains("duplicate key") {
        "give each key once; remove or rename one of them"
    } else if message.contains("array") {
        "put a comma after each element of a list, and ] at its end"
    } else if message.contains("recurs") {
        "the specification has no lists or keys nested this deeply"
    } else if message.contains("string") {
        "put texts in quotes: name = \"text\""
    } else {
        "write `key = value`, texts in quotes, numbers with a point (0.15), or a header such as [links.thigh]"
    };
    (message, help)
}
