//! The value of one key → a plain value within its bounds, or a message that says what to write instead.

use toml::de::DeValue;

use super::Code;
use super::decode::Names;
use super::diagnostic::{At, Sink, Span};
use super::keys::{Bound, Key, Way};
use super::nearest::nearest;
use super::view::is_within_bounds;

/// Numbers beyond this are mistakes in any unit used here, and would overflow in later products.
const LARGEST: f64 = 1e9;

/// The value of a key, with the key's definition.
pub(super) struct Field<'t> {
    pub path: String,
    pub key: &'static Key,
    /// In which way its file is written.
    pub way: Way,
    pub value: &'t DeValue<'t>,
    pub span: Span,
}

impl Field<'_> {
    /// How the key is written.
    pub fn advice(&self) -> String {
        format!("write {}", self.key.template(self.way))
    }

    pub fn wrong_type<T>(&self, sink: &mut Sink) -> Option<T> {
        self.wrong_type_at(self.value, &self.span, self.key.kind.words(), sink)
    }

    pub fn wrong_type_at<T>(&self, value: &DeValue<'_>, span: &Span, expected: &str, sink: &mut Sink) -> Option<T> {
        let title = format!("`{}` must be {expected}, not {}", self.path, found(value));
        let help = match value {
            DeValue::String(text) if expected == "a number" && text.parse::<f64>().is_ok() => {
                format!("remove the quotes: {text}")
            }
            _ => self.advice(),
        };
        sink.report(Code::WrongType, title, span, format!("expected {expected}"), help);
        None
    }

    pub fn word(&self, text: &str, words: &'static [&'static str], span: &Span, sink: &mut Sink) -> Option<At<usize>> {
        if let Some(value) = words.iter().position(|w| *w == text) {
            return Some(At { value, span: span.clone() });
        }
        let all: Vec<_> = words.iter().map(|w| format!("\"{w}\"")).collect();
        let all = all.join(", ");
        let help = match nearest(text, words.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("write one of {all}: {}", self.key.doc),
        };
        let title = format!("`{}` cannot be \"{text}\"", self.path);
        sink.report(Code::UnknownChoice, title, span, format!("must be one of {all}"), help);
        None
    }

    pub fn number(&self, value: &DeValue<'_>, span: &Span, bound: Bound, sink: &mut Sink) -> Option<f64> {
        let Some(number) = as_number(value) else {
            return self.wrong_type_at(value, span, "a number", sink);
        };
        let unit = if self.key.unit.is_empty() { String::new() } else { format!("{}, ", self.key.unit) };
        if number.is_nan() || number.abs() > LARGEST {
            let title = format!("`{}` is not a number that a robot can have", self.path);
            let label = format!("{unit}{}, at most 1e9", bound.text());
            sink.report(Code::NotFinite, title, span, label, self.advice());
        } else if !bound.admits(number) {
            let title = format!("`{}` must be {}", self.path, bound.text());
            let label = format!("{unit}{}", bound.text());
            sink.report(Code::OutOfBounds, title, span, label, self.bounds_advice(number, bound));
        } else if number != 0.0 && number.abs() < bound.least() {
            let title = format!("`{}` is too small to compute with: {number:?}", self.path);
            let least = bound.least();
            let (label, help) = match bound {
                Bound::Positive => (format!("{unit}at least {least:e}"), self.advice()),
                _ => {
                    let name = self.key.name;
                    (
                        format!("{unit}0, or at least {least:e} in size"),
                        format!("write 0.0 in `{name}` where there is none"),
                    )
                }
            };
            sink.report(Code::Vanishing, title, span, label, help);
        } else {
            return Some(number);
        }
        None
    }

    fn bounds_advice(&self, number: f64, bound: Bound) -> String {
        match bound {
            Bound::Angle => format!("angles are in rad: write {:.4} for {number} degrees", number.to_radians()),
            _ if number < 0.0 => format!("remove the sign: {:?}", -number),
            _ => self.advice(),
        }
    }

    pub fn numbers<const N: usize>(&self, bound: Bound, sink: &mut Sink) -> Option<At<[f64; N]>> {
        let DeValue::Array(items) = self.value else {
            return self.wrong_type(sink);
        };
        if !is_within_bounds(items.len(), &self.path, &self.span, sink) {
            return None;
        }
        let read: Vec<_> = items.iter().map(|item| self.number(item.get_ref(), &item.span(), bound, sink)).collect();
        let numbers: Option<Vec<f64>> = read.into_iter().collect();
        match <[f64; N]>::try_from(numbers?) {
            Ok(value) => Some(At { value, span: self.span.clone() }),
            Err(numbers) => {
                let title = format!("`{}` must be {}, not {}", self.path, self.key.kind.words(), numbers.len());
                let label = format!("expected {N} numbers");
                sink.report(Code::WrongCount, title, &self.span, label, self.advice());
                None
            }
        }
    }

    pub fn name_list(&self, items: &[toml::Spanned<DeValue<'_>>], span: &Span, sink: &mut Sink) -> Option<Names> {
        if !is_within_bounds(items.len(), &self.path, span, sink) {
            return None;
        }
        let read: Vec<_> = items
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::String(text) => Some(At { value: text.to_string(), span: item.span() }),
                other => self.wrong_type_at(other, &item.span(), "a name in quotes", sink),
            })
            .collect();
        let names: Option<Vec<_>> = read.into_iter().collect();
        Some(At { value: names?, span: span.clone() })
    }
}

/// Integers count as numbers; `None` for anything else.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(digits) if digits.radix() == 10 => digits.as_str().parse().ok(),
        DeValue::Integer(digits) => {
            let whole = i128::from_str_radix(digits.as_str(), digits.radix());
            Some(whole.map_or(f64::INFINITY, |w| w as f64))
        }
        _ => None,
    }
}

/// What a value is, in words.
pub(super) fn found(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a decimal number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
