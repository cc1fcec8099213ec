//! What is drawn, whatever it is drawn on. Lengths in points, x to the right, y down.

use super::font::Weight;
use super::ink::Ink;
use std::collections::BTreeMap;

pub type Xy = [f64; 2];

#[derive(Clone, Debug)]
pub struct Scene {
    pub width: f64,
    pub height: f64,
    pub marks: Vec<Mark>,
    /// Of some marks, by their places, the number of what they stand for: a page brings them to life.
    pub numbers: BTreeMap<usize, usize>,
}

#[derive(Clone, Debug)]
pub enum Mark {
    Line { points: Vec<Xy>, pen: Pen },
    Area { points: Vec<Xy>, ink: Ink, opacity: f64 },
    Dot { at: Xy, radius: f64, ink: Ink, opacity: f64 },
    Text { at: Xy, text: String, size: f64, weight: Weight, anchor: Anchor, ink: Ink },
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    pub ink: Ink,
    pub width: f64,
    pub dash: Dash,
    pub opacity: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    Solid,
    Dashed,
    Dotted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Dash {
    /// Lengths of dash and gap; none for a solid line.
    pub fn pattern(self) -> Option<[f64; 2]> {
        match self {
            Dash::Solid => None,
            Dash::Dashed => Some([5.0, 3.0]),
            Dash::Dotted => Some([1.0, 3.2]),
        }
    }

    /// The dashes of the k-th kind of joint.
    pub fn of(k: usize) -> Dash {
        [Dash::Solid, Dash::Dashed, Dash::Dotted][k % 3]
    }
}

impl Pen {
    pub fn new(ink: Ink, width: f64) -> Pen {
        Pen { ink, width, dash: Dash::Solid, opacity: 1.0 }
    }

    pub fn dash(self, dash: Dash) -> Pen {
        Pen { dash, ..self }
    }

    pub fn opacity(self, opacity: f64) -> Pen {
        Pen { opacity, ..self }
    }
}

impl Scene {
    pub fn new(width: f64, height: f64) -> Scene {
        Scene { width, height, marks: Vec::new(), numbers: BTreeMap::new() }
    }

    /// The last mark stands for what has this number.
    pub fn number(&mut self, number: usize) {
        self.numbers.extend(self.marks.len().checked_sub(1).map(|last| (last, number)));
    }

    pub fn line(&mut self, points: &[Xy], pen: Pen) {
        if points.len() > 1 {
            self.marks.push(Mark::Line { points: points.to_vec(), pen });
        }
    }

    pub fn area(&mut self, points: &[Xy], ink: Ink, opacity: f64) {
        self.marks.push(Mark::Area { points: points.to_vec(), ink, opacity });
    }

    pub fn rectangle(&mut self, [x, y]: Xy, [w, h]: Xy, ink: Ink, opacity: f64) {
        self.area(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]], ink, opacity);
    }

    pub fn dot(&mut self, at: Xy, radius: f64, ink: Ink) {
        self.marks.push(Mark::Dot { at, radius, ink, opacity: 1.0 });
    }

    /// A circle with paper in it.
    pub fn ring(&mut self, at: Xy, radius: f64, ink: Ink) {
        self.dot(at, radius, ink);
        self.dot(at, radius - 1.4, Ink::Paper);
    }

    pub fn text(&mut self, at: Xy, text: &str, size: f64, anchor: Anchor, ink: Ink) {
        self.write(at, text, size, Weight::Regular, anchor, ink);
    }

    /// A quantity with its unit, and between them the power of ten that numbers beside it leave out.
    pub fn quantity(&mut self, at: Xy, words: [&str; 2], power: i32, size: f64, anchor: Anchor, ink: Ink) {
        let [name, unit] = words;
        let before = if name.is_empty() { String::new() } else { format!("{name}, ") };
        if power == 0 {
            let text = if unit.is_empty() { name.into() } else { before + unit };
            return self.text(at, &text, size, anchor, ink);
        }
        let (ten, exponent) = (before + "10", power.to_string().replace('-', "−"));
        let width = |text: &str, size: f64| Weight::Regular.width(text, size);
        let small = 0.72 * size;
        let ends = [width(&ten, size), width(&exponent, small), width(&format!(" {unit}"), size)];
        let all: f64 = ends.iter().sum();
        let start = match anchor {
            Anchor::Start => at[0],
            Anchor::Middle => at[0] - 0.5 * all,
            Anchor::End => at[0] - all,
        };
        self.text([start, at[1]], &ten, size, Anchor::Start, ink);
        self.text([start + ends[0], at[1] - 0.4 * size], &exponent, small, Anchor::Start, ink);
        if !unit.is_empty() {
            let after = start + ends[0] + ends[1] + width(" ", size);
            self.text([after, at[1]], unit, size, Anchor::Start, ink);
        }
    }

    pub fn write(&mut self, at: Xy, text: &str, size: f64, weight: Weight, anchor: Anchor, ink: Ink) {
        self.marks.push(Mark::Text { at, text: text.into(), size, weight, anchor, ink });
    }
}
