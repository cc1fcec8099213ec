//! Texts that come from outside: shown so that a terminal obeys none of them.
//!
//! Control characters move the cursor, change colours or rename windows; others turn the direction of writing or cannot be
//! seen. Each is shown as its number, as in `\u{1b}`.

use std::borrow::Cow;
use std::io::{Result, Write};

/// Whether a character does something else than to be seen. So do line feeds and tabs.
fn acts(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{feff}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

fn shown(text: &str, acts: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&acts) {
        return Cow::Borrowed(text);
    }
    let mut harmless = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if acts(c) { harmless.extend(c.escape_unicode()) } else { harmless.push(c) }
    }
    Cow::Owned(harmless)
}

/// A name or sentence from a file, on one line.
pub fn line(text: &str) -> Cow<'_, str> {
    shown(text, acts)
}

/// Words of our own with such texts in them, on several lines.
pub fn lines(text: &str) -> Cow<'_, str> {
    shown(text, |c| acts(c) && c != '\n' && c != '\t')
}

/// Writes nothing that acts but line feeds and tabs.
pub struct Harmless<W>(pub W);

impl<W: Write> Write for Harmless<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        // What is formatted arrives in whole characters.
        self.0.write_all(lines(&String::from_utf8_lossy(bytes)).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_is_shown_and_the_rest_is_left_alone() {
        let plain = "torque–speed of haunch₁, Γ ≥ 0 \u{1f434} 馬";
        assert!(matches!(line(plain), Cow::Borrowed(text) if text == plain));
        assert_eq!(
            line("a\u{1b}[31mb\u{9b}1m\r\n\u{7f}\u{202e}c"),
            "a\\u{1b}[31mb\\u{9b}1m\\u{d}\\u{a}\\u{7f}\\u{202e}c"
        );
        assert_eq!(lines("a\n\tb\u{7}"), "a\n\tb\\u{7}");
        let mut out = Harmless(Vec::new());
        let (name, word) = ("x\u{1b}]0;owned\u{7}", "é");
        writeln!(out, "{name}: {word}").unwrap();
        assert_eq!(String::from_utf8(out.0).unwrap(), "x\\u{1b}]0;owned\\u{7}: é\n");
    }
}
