//! Elements and attributes with their places; numbers that are numbers.

use super::fault::{Faults, ImportError, Kind, Place};
use piaffe_codegen::spec::BYTE_ORDER_MARK;
use roxmltree::{Document, Node, ParsingOptions};

/// A text that roxmltree can read: blanks before the XML declaration and zeros at the end are cut off, and prefixes that nobody declared
/// are declared on the root, so that tags of no concern cannot refuse a file.
pub struct Prepared {
    text: String,
    /// Lines that were cut off at the beginning.
    skipped: usize,
}

impl Prepared {
    pub fn new(text: &str) -> Result<Prepared, ImportError> {
        let start = text.find(|c: char| !c.is_whitespace() && c != BYTE_ORDER_MARK).unwrap_or(text.len());
        let skipped = text[..start].matches('\n').count();
        let text = text[start..].trim_end_matches(|c: char| c == '\0' || c.is_whitespace());
        let mut prepared = Prepared { text: text.to_string(), skipped };
        // Every turn declares another prefix.
        for _ in 0..100 {
            match parse(&prepared.text).map(|_| ()) {
                Ok(()) => return Ok(prepared),
                Err(roxmltree::Error::UnknownNamespace(prefix, _)) if prepared.declare(&prefix) => {}
                Err(e) => return Err(prepared.not_xml(&placed(&e))),
            }
        }
        Err(prepared.not_xml(&"more than 100 prefixes that nobody declares"))
    }

    /// Declares a prefix in the root's tag; false if there is none.
    fn declare(&mut self, prefix: &str) -> bool {
        let mut from = 0;
        while let Some(at) = self.text[from..].find('<').map(|at| at + from) {
            let rest = &self.text[at..];
            let skip = |end: &str| rest.find(end).map(|n| at + n + end.len());
            let next = if rest.starts_with("<!--") {
                skip("-->")
            } else if rest.starts_with("<?") || rest.starts_with("<!") {
                skip(">")
            } else {
                let end = rest[1..].find(|c: char| c.is_whitespace() || c == '>' || c == '/');
                let Some(end) = end.map(|n| at + 1 + n) else { return false };
                self.text.insert_str(end, &format!(" xmlns:{prefix}=\"undeclared:{prefix}\""));
                return true;
            };
            let Some(next) = next else { return false };
            from = next;
        }
        false
    }

    fn not_xml(&self, error: &dyn std::fmt::Display) -> ImportError {
        let mut faults = Faults::default();
        let skipped = match self.skipped {
            0 => String::new(),
            n => format!(" (line 1 is line {} of the file)", n + 1),
        };
        faults.add(
            Kind::Syntax,
            None,
            format!("this is no XML: {error}{skipped}"),
            "give a URDF or MJCF file; `xmllint --noout FILE` shows the place",
        );
        ImportError(faults.take())
    }

    pub fn document(&self) -> Result<File<'_>, ImportError> {
        let document = parse(&self.text).map_err(|e| self.not_xml(&placed(&e)))?;
        let newlines = self.text.match_indices('\n').map(|(at, _)| at).collect();
        Ok(File { document, newlines, skipped: self.skipped })
    }
}

/// What is wrong, with line and column even where the reader leaves them out.
fn placed(error: &roxmltree::Error) -> String {
    let (words, place) = (error.to_string(), error.pos().to_string());
    if words.contains(&place) { words } else { format!("{words} at {place}") }
}

fn parse(text: &str) -> Result<Document<'_>, roxmltree::Error> {
    Document::parse_with_options(
        text,
        ParsingOptions { allow_dtd: true, nodes_limit: 4_000_000, ..ParsingOptions::default() },
    )
}

/// A parsed file.
pub struct File<'t> {
    document: Document<'t>,
    /// Where lines end, in bytes.
    newlines: Vec<usize>,
    skipped: usize,
}

impl<'t> File<'t> {
    pub fn root(&self) -> Node<'_, 't> {
        self.document.root_element()
    }

    pub fn place(&self, node: Node) -> Place {
        let line = self.newlines.partition_point(|at| *at < node.range().start) + 1 + self.skipped;
        let name = node.attribute("name").map(|name| format!(" name=\"{}\"", plain(name))).unwrap_or_default();
        Place { element: format!("<{}{name}>", plain(node.tag_name().name())), line }
    }

    /// The numbers of an attribute; `None` where it is absent, or after what is wrong with it was said.
    pub fn numbers<const N: usize>(&self, node: Node, attribute: &str, faults: &mut Faults) -> Option<[f64; N]> {
        let text = node.attribute(attribute)?;
        let numbers = self.list(node, attribute, text, faults)?;
        <[f64; N]>::try_from(numbers)
            .map_err(|numbers| {
                let place = self.place(node);
                let what = format!("{attribute}=\"{}\" has {} numbers instead of {N}", plain(text), numbers.len());
                faults.add(Kind::Number, Some(&place), what, "write them with spaces between them");
            })
            .ok()
    }

    pub fn number(&self, node: Node, attribute: &str, faults: &mut Faults) -> Option<f64> {
        self.numbers(node, attribute, faults).map(|[x]| x)
    }

    /// Numbers with spaces between them, as many as there are.
    pub fn list(&self, node: Node, attribute: &str, text: &str, faults: &mut Faults) -> Option<Vec<f64>> {
        let read: Result<Vec<f64>, &str> = text
            .split_whitespace()
            .map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or(word))
            .collect();
        read.map_err(|word| {
            let place = self.place(node);
            let what = format!("{attribute}=\"{}\": \"{}\" is no finite number", plain(text), plain(word));
            faults.add(Kind::Number, Some(&place), what, "write a decimal number such as 0.25");
        })
        .ok()
    }
}

/// The first child element of this name.
pub fn child<'a, 't>(node: Node<'a, 't>, name: &'static str) -> Option<Node<'a, 't>> {
    children(node, name).next()
}

pub fn children<'a, 't: 'a>(node: Node<'a, 't>, name: &'static str) -> impl Iterator<Item = Node<'a, 't>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// A name, without characters that are not seen, and without what would end a string.
pub fn name(text: &str) -> String {
    let clean = |c: char| if c.escape_debug().next() == Some('\\') { '_' } else { c };
    text.trim().chars().map(clean).collect()
}

/// A text for one line of a comment or a terminal.
pub fn plain(text: &str) -> String {
    name(text).chars().take(100).collect()
}
