//! The typeface: how wide a text is, and the bytes to embed (Inter, SIL Open Font Licence, see `fonts/OFL.txt`).

use std::collections::BTreeMap;
use std::sync::LazyLock;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    Regular,
    Bold,
}

/// What a document has to know of a font, in its own units.
pub struct Face {
    pub units_per_em: f64,
    /// Width of each glyph.
    pub advances: Vec<u16>,
    /// The glyph of each character.
    pub glyphs: BTreeMap<char, u16>,
    /// Left, lower, right and upper edge of the box around all glyphs.
    pub bounds: [i16; 4],
    pub ascender: i16,
    pub descender: i16,
    pub capital_height: i16,
}

impl Face {
    /// Reads an OpenType file whose characters are in a table of format 4, as ours are.
    fn read(file: &[u8]) -> Option<Face> {
        let (head, lines, widths) = (table(file, "head")?, table(file, "hhea")?, table(file, "hmtx")?);
        let count = u16_at(table(file, "maxp")?, 4)?;
        // The last width is that of all further glyphs.
        let last = u16_at(lines, 34)?.checked_sub(1)?;
        Some(Face {
            units_per_em: f64::from(u16_at(head, 18)?),
            advances: (0..count)
                .map(|glyph| u16_at(widths, 4 * usize::from(glyph.min(last))))
                .collect::<Option<_>>()?,
            glyphs: glyphs(table(file, "cmap")?)?,
            bounds: [i16_at(head, 36)?, i16_at(head, 38)?, i16_at(head, 40)?, i16_at(head, 42)?],
            ascender: i16_at(lines, 4)?,
            descender: i16_at(lines, 6)?,
            capital_height: i16_at(table(file, "OS/2")?, 88)?,
        })
    }

    /// The glyph of a character; the one for what is missing, if there is none.
    pub fn glyph(&self, c: char) -> u16 {
        self.glyphs.get(&c).copied().unwrap_or(0)
    }
}

/// A table of an OpenType file.
fn table<'f>(file: &'f [u8], tag: &str) -> Option<&'f [u8]> {
    let entries = (0..usize::from(u16_at(file, 4)?)).map(|k| 12 + 16 * k);
    let entry = entries.into_iter().find(|at| file.get(*at..at + 4) == Some(tag.as_bytes()))?;
    file.get(u32_at(file, entry + 8)?..)?.get(..u32_at(file, entry + 12)?)
}

/// The glyph of each character, from the first table of characters.
fn glyphs(cmap: &[u8]) -> Option<BTreeMap<char, u16>> {
    const FORMAT: u16 = 4;
    let table = cmap.get(u32_at(cmap, 8)?..)?;
    if u16_at(table, 0)? != FORMAT {
        return None;
    }
    let size = usize::from(u16_at(table, 6)?);
    let [ends, starts, shifts, offsets] = [14, 16 + size, 16 + 2 * size, 16 + 3 * size];
    let mut glyphs = BTreeMap::new();
    for k in (0..size).step_by(2) {
        let (shift, offset) = (u16_at(table, shifts + k)?, usize::from(u16_at(table, offsets + k)?));
        let start = u16_at(table, starts + k)?;
        for code in start..=u16_at(table, ends + k)? {
            let glyph = match offset {
                0 => code.wrapping_add(shift),
                // From where the offset stands.
                _ => match u16_at(table, offsets + k + offset + 2 * usize::from(code - start)) {
                    None | Some(0) => 0,
                    Some(glyph) => glyph.wrapping_add(shift),
                },
            };
            if let (Some(c), true) = (char::from_u32(u32::from(code)), glyph > 0) {
                glyphs.insert(c, glyph);
            }
        }
    }
    Some(glyphs)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn i16_at(bytes: &[u8], at: usize) -> Option<i16> {
    Some(i16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?)).ok()
}

impl Weight {
    pub const ALL: [Weight; 2] = [Weight::Regular, Weight::Bold];

    /// As style sheets count.
    pub fn number(self) -> u16 {
        match self {
            Weight::Regular => 400,
            Weight::Bold => 600,
        }
    }

    /// The OpenType file.
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Weight::Regular => include_bytes!("fonts/Inter-Regular.otf"),
            Weight::Bold => include_bytes!("fonts/Inter-SemiBold.otf"),
        }
    }

    pub fn face(self) -> &'static Face {
        static FACES: LazyLock<[Face; 2]> =
            LazyLock::new(|| Weight::ALL.map(|w| Face::read(w.bytes()).expect("the embedded font is a font")));
        &FACES[usize::from(self == Weight::Bold)]
    }

    /// Width of a text, in the units of `size`.
    pub fn width(self, text: &str, size: f64) -> f64 {
        let face = self.face();
        // What is missing has no width here.
        let advance = |c: char| face.glyphs.get(&c).map_or(0, |glyph| face.advances[usize::from(*glyph)]);
        text.chars().map(|c| f64::from(advance(c))).sum::<f64>() * size / face.units_per_em
    }

    /// A text that is no wider than `room`: shortened at its end if need be.
    pub fn fit(self, text: &str, size: f64, room: f64) -> String {
        if self.width(text, size) <= room {
            return text.into();
        }
        let mut letters: Vec<char> = text.chars().collect();
        while letters.pop().is_some() {
            let short = format!("{}…", letters.iter().collect::<String>().trim_end());
            if self.width(&short, size) <= room {
                return short;
            }
        }
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of Inter, as other readers of fonts find them.
    #[test]
    fn the_embedded_fonts_can_be_read() {
        for weight in Weight::ALL {
            let face = weight.face();
            assert_eq!((face.units_per_em, face.advances.len()), (2816.0, 191));
            assert_eq!((face.ascender, face.descender, face.capital_height), (2728, -680, 2048));
            for c in "torque of haunch1, N·m: Γ ≥ 0, β, θ − 1·10 μ, q̇".chars().filter(|c| *c != '\u{307}') {
                assert!(face.glyph(c) > 0, "{weight:?} has no {c}");
            }
            assert_eq!(face.glyph('馬'), 0);
            // An em dash is wider than a hyphen, a text as wide as its letters.
            assert!(weight.width("—", 10.0) > 1.5 * weight.width("-", 10.0));
            assert!((weight.width("ab", 7.0) - weight.width("a", 7.0) - weight.width("b", 7.0)).abs() < 1e-12);
        }
        assert!(Weight::Bold.width("speed", 12.0) > Weight::Regular.width("speed", 12.0));
    }

    #[test]
    fn a_damaged_font_is_no_font() {
        let whole = Weight::Regular.bytes();
        for length in [0, 1, 11, 12, 40, 300] {
            assert!(Face::read(&whole[..length]).is_none(), "{length}");
        }
    }

    #[test]
    fn a_text_is_shortened_to_its_room_and_no_further() {
        let text = "torque–speed of a_joint_with_a_very_long_name";
        for room in [20.0, 80.0, 150.0, 400.0] {
            let short = Weight::Regular.fit(text, 11.0, room);
            assert!(Weight::Regular.width(&short, 11.0) <= room, "{short}");
            assert!(short == text || short.ends_with('…'));
            assert!(short == text || Weight::Regular.width(&short, 11.0) > room - 20.0, "{short}");
        }
    }
}
