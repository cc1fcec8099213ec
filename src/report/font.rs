//! The typeface: how wide a text is, and the bytes to embed (Inter, SIL Open Font Licence, see `fonts/OFL.txt`).

use std::sync::LazyLock;
use ttf_parser::Face;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    Regular,
    Bold,
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

    pub fn face(self) -> &'static Face<'static> {
        static FACES: LazyLock<[Face<'static>; 2]> =
            LazyLock::new(|| Weight::ALL.map(|w| Face::parse(w.bytes(), 0).expect("the embedded font is a font")));
        &FACES[usize::from(self == Weight::Bold)]
    }

    /// Width of a text, in the units of `size`.
    pub fn width(self, text: &str, size: f64) -> f64 {
        let face = self.face();
        let advance = |c: char| face.glyph_index(c).and_then(|g| face.glyph_hor_advance(g)).unwrap_or(0);
        text.chars().map(|c| f64::from(advance(c))).sum::<f64>() * size / f64::from(face.units_per_em())
    }
}
