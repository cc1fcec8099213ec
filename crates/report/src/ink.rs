//! Colours by what they stand for. They are told apart with any colour vision (after Okabe and Ito), and curves
//! that share one differ in their dashes.

/// What a mark is drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    Text,
    Muted,
    Axis,
    Grid,
    /// Limits that a motion must keep to.
    Limit,
    /// Virtual leg 0 or 1 and everything of it.
    Leg(usize),
    /// Component x, y, z of a vector.
    Component(usize),
    /// One of several gaits.
    Gait(usize),
    Paper,
}

/// Every ink with its name in style sheets, on light and on dark paper.
const PALETTE: [(Ink, &str, u32, u32); 17] = [
    (Ink::Text, "text", 0x1b2127, 0xe8ebee),
    (Ink::Muted, "muted", 0x5c6873, 0x9ba7b3),
    (Ink::Axis, "axis", 0x9aa5af, 0x5d6973),
    (Ink::Grid, "grid", 0xe4e8ec, 0x2b333b),
    (Ink::Limit, "limit", 0x4a545e, 0xb9c3cc),
    (Ink::Leg(0), "leg0", 0x0069ab, 0x5eb6ec),
    (Ink::Leg(1), "leg1", 0xcc5200, 0xf0974e),
    (Ink::Component(0), "component0", 0x00805d, 0x3cc39a),
    (Ink::Component(1), "component1", 0x1b2127, 0xe8ebee),
    (Ink::Component(2), "component2", 0xb0578c, 0xe29bc6),
    (Ink::Gait(0), "gait0", 0x0069ab, 0x5eb6ec),
    (Ink::Gait(1), "gait1", 0x00805d, 0x3cc39a),
    (Ink::Gait(2), "gait2", 0xcc5200, 0xf0974e),
    (Ink::Gait(3), "gait3", 0xb0578c, 0xe29bc6),
    (Ink::Gait(4), "gait4", 0x8a7400, 0xdcc94a),
    (Ink::Gait(5), "gait5", 0x1b2127, 0xe8ebee),
    (Ink::Paper, "paper", 0xffffff, 0x14191e),
];

impl Ink {
    /// The ink of the k-th of any number of gaits.
    pub fn gait(k: usize) -> Ink {
        Ink::Gait(k % 6)
    }

    fn entry(self) -> (&'static str, u32, u32) {
        let found = PALETTE.iter().find(|(ink, ..)| *ink == self).unwrap_or(&PALETTE[0]);
        (found.1, found.2, found.3)
    }

    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// Red, green and blue on light paper, 0 to 1.
    pub fn rgb(self) -> [f32; 3] {
        let value = self.entry().1;
        [16, 8, 0].map(|shift| (value >> shift & 255) as f32 / 255.0)
    }
}

/// The palette as CSS variables, for light or dark paper.
pub fn variables(dark: bool) -> String {
    PALETTE
        .iter()
        .map(|(_, name, light, night)| format!("--{name}:#{:06x};", if dark { night } else { light }))
        .collect()
}

/// Rules by which marks in an SVG get their inks. `value` says how an ink is written.
fn rules(value: impl Fn(Ink) -> String) -> String {
    let one = |ink: &Ink| {
        let (name, value) = (ink.name(), value(*ink));
        format!(".s-{name}{{stroke:{value}}}.f-{name}{{fill:{value}}}")
    };
    PALETTE.iter().map(|(ink, ..)| one(ink)).collect()
}

/// For a file of its own: on light paper.
pub fn fixed_rules() -> String {
    rules(|ink| format!("#{:06x}", ink.entry().1))
}

/// For a page that defines the variables.
pub fn page_rules() -> String {
    rules(|ink| format!("var(--{})", ink.name()))
}
