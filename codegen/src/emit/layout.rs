//! How generated code is laid out: what is too long for a line is broken, a list into an item per line, a sum
//! before its signs.

use std::fmt::Debug;

/// Width of a line.
const WIDTH: usize = 110;
const INDENT: &str = "    ";

/// A piece of code.
pub enum Layout {
    /// Never broken.
    Word(String),
    /// Broken before `+` and `-` where it is too long.
    Sum(String),
    /// Items between brackets, with commas.
    List { open: String, items: Vec<Layout>, close: String },
}

impl Layout {
    pub fn list(open: impl Into<String>, items: impl IntoIterator<Item = Layout>, close: impl Into<String>) -> Layout {
        Layout::List { open: open.into(), items: items.into_iter().collect(), close: close.into() }
    }

    /// A value whose form for debugging is Rust: a number, a text, an option or an array of these.
    pub fn value(value: impl Debug) -> Layout {
        Layout::Word(format!("{value:?}"))
    }

    /// A number, zero without a sign.
    pub fn float(value: f64) -> Layout {
        Layout::value(value + 0.0)
    }

    pub fn floats<const N: usize>(values: [f64; N]) -> Layout {
        Layout::value(values.map(|v| v + 0.0))
    }

    /// A struct's value: its type and its fields with their names.
    pub fn record<'n>(ty: String, fields: impl IntoIterator<Item = (&'n str, Layout)>) -> Layout {
        Layout::list(ty + " { ", fields.into_iter().map(|(name, value)| value.after(&format!("{name}: "))), " }")
    }

    /// With this before it.
    pub fn after(self, text: &str) -> Layout {
        match self {
            Layout::Word(word) => Layout::Word(text.to_string() + &word),
            Layout::Sum(sum) => Layout::Sum(text.to_string() + &sum),
            Layout::List { open, items, close } => Layout::List { open: text.to_string() + &open, items, close },
        }
    }

    /// Writes it after what `out` ends in, whose line begins with `depth` indents.
    pub fn write(&self, out: &mut String, depth: usize) {
        match self {
            Layout::Word(text) => out.push_str(text),
            Layout::Sum(text) => sum(out, text, depth),
            Layout::List { open, items, close } if column(out) + self.width() < WIDTH => {
                out.push_str(open);
                for (k, item) in items.iter().enumerate() {
                    out.push_str(if k == 0 { "" } else { ", " });
                    item.write(out, depth);
                }
                out.push_str(close);
            }
            Layout::List { open, items, close } => {
                out.push_str(open.trim_end());
                for item in items {
                    indent(out, depth + 1);
                    item.write(out, depth + 1);
                    out.push(',');
                }
                indent(out, depth);
                out.push_str(close.trim_start());
            }
        }
    }

    /// On one line.
    fn width(&self) -> usize {
        match self {
            Layout::Word(text) | Layout::Sum(text) => text.len(),
            Layout::List { open, items, close } => {
                open.len() + items.iter().map(|i| i.width() + ", ".len()).sum::<usize>() + close.len()
            }
        }
    }
}

/// Where the next character goes.
fn column(out: &str) -> usize {
    out.len() - out.rfind('\n').map_or(0, |at| at + 1)
}

fn sum(out: &mut String, text: &str, depth: usize) {
    let mut rest = text;
    while column(out) + rest.len() >= WIDTH {
        let room = &rest.as_bytes()[..rest.len().min(WIDTH.saturating_sub(column(out)))];
        // The last sign that still fits.
        let Some(at) = room.windows(3).rposition(|w| w == b" + " || w == b" - ") else { break };
        out.push_str(&rest[..at]);
        indent(out, depth + 1);
        rest = &rest[at + 1..];
    }
    out.push_str(rest);
}

/// A new line.
pub fn indent(out: &mut String, depth: usize) {
    out.push('\n');
    (0..depth).for_each(|_| out.push_str(INDENT));
}

/// A statement on a line of its own.
pub fn line(out: &mut String, text: &str, depth: usize) {
    indent(out, depth);
    sum(out, text, depth);
}
