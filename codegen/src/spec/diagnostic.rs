//! What is said about a mistake in a specification: a stable code, where it is, and what to write instead.
//!
//! ```text
//! error[S006]: `links.thigh.mass` must be greater than 0
//!   --> robot.toml:14:8
//!    |
//! 14 | mass = -1.6
//!    |        ^^^^ kg, greater than 0
//!    |
//!    = help: …
//! ```

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::Code;
use super::name::is_visible;

/// Byte offsets into the text of one file.
pub type Span = Range<usize>;

/// A value and the place where it stands in its file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct At<T> {
    pub value: T,
    pub span: Span,
}

/// Some editors begin a text with it.
pub const BYTE_ORDER_MARK: char = '\u{feff}';

/// A specification file: the name that messages show, and its contents. Cheap to clone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    path: Arc<str>,
    text: Arc<str>,
}

impl Source {
    pub fn new(path: &str, text: &str) -> Self {
        Self { path: path.into(), text: text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text).into() }
    }

    /// The path as it shall be shown.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Without a byte-order mark: places count from behind it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of a byte offset, both from 1, columns counted in characters.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.text[..self.boundary(offset)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// The nearest character boundary at or before `offset`, inside the text.
    fn boundary(&self, offset: usize) -> usize {
        self.text.floor_char_boundary(offset)
    }
}

/// A place in a file and a few words about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub source: Source,
    pub span: Span,
    pub text: String,
}

impl Label {
    fn visible(&self) -> Label {
        let Source { path, text } = &self.source;
        let text = if text.is_ascii() { text.clone() } else { in_place(text).into() };
        let source = Source { path: visible(path, false).into(), text };
        Label { source, span: self.span.clone(), text: visible(&self.text, false) }
    }
}

/// A text whose every character can be seen; lines stay apart where `lines`.
pub(crate) fn visible(text: &str, lines: bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' if lines => shown.push(c),
            _ if is_visible(c) => shown.push(c),
            _ => shown.extend(c.escape_debug()),
        }
    }
    shown
}

/// A source with something to be seen for every character that cannot, of as many bytes. The renderer does so in ASCII.
fn in_place(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c.len_utf8() {
            _ if c.is_ascii() || is_visible(c) => shown.push(c),
            2 => shown.push('¿'),
            3 => shown.push('\u{fffd}'),
            _ => shown.extend(['\u{fffd}', '?']),
        }
    }
    shown
}

/// One mistake in a specification.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    pub code: Code,
    pub title: String,
    /// The offending text.
    pub primary: Label,
    /// What it contradicts, possibly in another file.
    pub secondary: Option<Label>,
    /// What to write instead.
    pub help: String,
}

impl Diagnostic {
    /// Line and column of the offending text, both from 1.
    pub fn line_column(&self) -> (usize, usize) {
        self.primary.source.line_column(self.primary.span.start)
    }

    /// The message with its source lines, carets and labels; plain text without colours.
    ///
    /// Names in it come from files: what would turn a terminal's colours on, or the direction of writing round, is escaped.
    pub fn render(&self) -> String {
        let shown = Diagnostic {
            code: self.code,
            title: visible(&self.title, false),
            primary: self.primary.visible(),
            secondary: self.secondary.as_ref().map(Label::visible),
            help: visible(&self.help, true),
        };
        shown.drawn()
    }

    fn drawn(&self) -> String {
        let title = Level::ERROR.primary_title(self.title.as_str()).id(self.code.as_str());
        let primary = snippet(&self.primary, AnnotationKind::Primary);
        let group = match &self.secondary {
            None => title.element(primary),
            Some(label) if label.source == self.primary.source => {
                title.element(primary.annotation(annotation(label, AnnotationKind::Context)))
            }
            Some(label) => title.element(primary).element(snippet(label, AnnotationKind::Context)),
        };
        Renderer::plain().render(&[group.element(Level::HELP.message(self.help.as_str()))])
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for Diagnostic {}

fn snippet(label: &Label, kind: AnnotationKind) -> Snippet<'_, annotate_snippets::Annotation<'_>> {
    Snippet::source(label.source.text()).path(label.source.path()).annotation(annotation(label, kind))
}

/// The renderer insists on spans inside the text and on character boundaries; here they become so.
fn annotation(label: &Label, kind: AnnotationKind) -> annotate_snippets::Annotation<'_> {
    let start = label.source.boundary(label.span.start);
    let end = label.source.text().ceil_char_boundary(label.span.end).max(start);
    kind.span(start..end).label(label.text.as_str())
}

/// Mistakes of one file that are kept. Nobody reads more, and files with very many are no specifications.
const MOST: usize = 200;

/// Characters of a title, a label or an advice. Names in them come from the file and may have any length.
const LONGEST: usize = 2000;

fn clipped(text: impl Into<String>) -> String {
    let mut text = text.into();
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// Collects the mistakes of one file.
#[derive(Debug)]
pub(super) struct Sink {
    source: Source,
    found: Vec<Diagnostic>,
    /// Whether the mistake that was reported last is not among them.
    dropped: bool,
}

impl Sink {
    pub fn new(source: Source) -> Self {
        Self { source, found: Vec::new(), dropped: false }
    }

    /// Records a mistake in this file.
    pub fn report(
        &mut self,
        code: Code,
        title: impl Into<String>,
        span: &Span,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.dropped = self.is_full();
        if self.dropped {
            return;
        }
        let primary = self.label(span, label);
        let (title, help) = (clipped(title), clipped(help));
        self.found.push(Diagnostic { code, title, primary, secondary: None, help });
    }

    /// Adds a second label to the mistake that was recorded last.
    pub fn beside(&mut self, label: Label) {
        if let Some(last) = self.found.last_mut().filter(|_| !self.dropped) {
            last.secondary = Some(label);
        }
    }

    /// A label into this file.
    pub fn label(&self, span: &Span, text: impl Into<String>) -> Label {
        Label { source: self.source.clone(), span: span.clone(), text: clipped(text) }
    }

    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Whether further mistakes are dropped.
    pub fn is_full(&self) -> bool {
        self.found.len() == MOST
    }

    /// The mistakes in the order of the file.
    pub fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.found.sort_by(|a, b| {
            (a.primary.span.start, a.primary.span.end, a.code).cmp(&(b.primary.span.start, b.primary.span.end, b.code))
        });
        self.found
    }
}
