//! Reads the values of a table, each as its key's kind says, and reports what does not fit.
//!
//! Every getter returns `None` for an absent key, and for a bad value after it has said why; callers read all
//! keys of a table before they give up on it, so that one run finds as many mistakes as it can.

use toml::de::DeValue;

use super::Code;
use super::diagnostic::{At, Sink};
use super::keys::{Bound, Kind};
use super::view::{View, is_within_bounds};

/// A list of names, and a list of such lists, each with its place.
pub(super) type Names = At<Vec<At<String>>>;
pub(super) type NameLists = At<Vec<Names>>;

impl View<'_> {
    pub fn text(&self, name: &str, sink: &mut Sink) -> Option<At<String>> {
        let field = self.field(name)?;
        match field.value {
            DeValue::String(text) => Some(At { value: text.to_string(), span: field.span }),
            _ => field.wrong_type(sink),
        }
    }

    /// What one of the key's words stands for; `meant` has as many things as the key has words, in their order.
    pub fn choice<T: Copy, const N: usize>(&self, name: &str, meant: [T; N], sink: &mut Sink) -> Option<At<T>> {
        let field = self.field(name)?;
        let (Kind::Choice(words), DeValue::String(text)) = (&field.key.kind, field.value) else {
            return field.wrong_type(sink);
        };
        assert_eq!(words.len(), N, "what `{name}` may be");
        field.word(text, words, &field.span, sink).map(|word| At { value: meant[word.value], span: word.span })
    }

    /// A list of the key's words, each as its index among them.
    pub fn choices(&self, name: &str, sink: &mut Sink) -> Option<At<Vec<usize>>> {
        let field = self.field(name)?;
        let (Kind::Choices(words), DeValue::Array(items)) = (&field.key.kind, field.value) else {
            return field.wrong_type(sink);
        };
        if !is_within_bounds(items.len(), &field.path, &field.span, sink) {
            return None;
        }
        let chosen: Vec<_> = items
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::String(text) => field.word(text, words, &item.span(), sink),
                _ => field.wrong_type_at(item.get_ref(), &item.span(), "a text in quotes", sink),
            })
            .collect();
        let chosen: Option<Vec<At<usize>>> = chosen.into_iter().collect();
        let chosen = chosen?;
        for (i, word) in chosen.iter().enumerate() {
            if chosen[..i].iter().any(|w| w.value == word.value) {
                let title = format!("`{}` names \"{}\" twice", field.path, words[word.value]);
                sink.report(Code::WrongCount, title, &word.span, "named before", "remove one of them");
                return None;
            }
        }
        Some(At { value: chosen.into_iter().map(|w| w.value).collect(), span: field.span })
    }

    pub fn order(&self, name: &str, sink: &mut Sink) -> Option<At<i64>> {
        let field = self.field(name)?;
        let (Kind::Order(orders), DeValue::Integer(digits)) = (&field.key.kind, field.value) else {
            return field.wrong_type(sink);
        };
        let value = i64::from_str_radix(digits.as_str(), digits.radix()).ok();
        match value.filter(|v| orders.contains(v)) {
            Some(value) => Some(At { value, span: field.span }),
            None => {
                let title = format!("`{}` cannot be {digits}", field.path);
                let label = format!("must be {}", field.key.kind.shape(field.way));
                sink.report(Code::UnknownChoice, title, &field.span, label, field.advice());
                None
            }
        }
    }

    pub fn number(&self, name: &str, sink: &mut Sink) -> Option<At<f64>> {
        let field = self.field(name)?;
        let Kind::Number(bound) = field.key.kind else {
            return None;
        };
        let value = field.number(field.value, &field.span, bound, sink)?;
        Some(At { value, span: field.span })
    }

    pub fn vector(&self, name: &str, sink: &mut Sink) -> Option<At<[f64; 3]>> {
        let field = self.field(name)?;
        let Kind::Vector(bound) = field.key.kind else {
            return None;
        };
        field.numbers(bound, sink)
    }

    pub fn pair(&self, name: &str, sink: &mut Sink) -> Option<At<[f64; 2]>> {
        let field = self.field(name)?;
        let Kind::Pair(bound) = field.key.kind else {
            return None;
        };
        let pair: At<[f64; 2]> = field.numbers(bound, sink)?;
        let [low, high] = pair.value;
        if low < high {
            return Some(pair);
        }
        let title = format!("`{}` does not rise", field.path);
        let help = match low == high {
            true => format!("write a lower and a higher value: {}", field.key.template(field.way)),
            false => format!("write the lower value first: {} = [{high:?}, {low:?}]", field.key.name),
        };
        sink.report(Code::ReversedRange, title, &pair.span, "lowest first, highest second", help);
        None
    }

    /// A point of a link: a distance along it (it points along -y), or a vector.
    pub fn along(&self, name: &str, sink: &mut Sink) -> Option<[f64; 3]> {
        let field = self.field(name)?;
        match (field.value, &field.key.kind) {
            (DeValue::Array(_), _) => field.numbers(Bound::Any, sink).map(|at| at.value),
            (DeValue::Float(_) | DeValue::Integer(_), Kind::Along(bound)) => {
                let along = field.number(field.value, &field.span, *bound, sink)?;
                // 0 - along, not -along: a mass centre in the joint is at 0, not at -0.
                Some([0.0, 0.0 - along, 0.0])
            }
            _ => field.wrong_type(sink),
        }
    }

    /// Angles under names, in the order of the file.
    pub fn angles(&self, name: &str, sink: &mut Sink) -> Option<Vec<(At<String>, f64)>> {
        let field = self.field(name)?;
        let DeValue::Table(entries) = field.value else {
            return field.wrong_type(sink);
        };
        if !is_within_bounds(entries.len(), &field.path, &field.span, sink) {
            return None;
        }
        let mut entries: Vec<_> = entries.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let read: Vec<_> = entries
            .into_iter()
            .map(|(key, value)| {
                let angle = field.number(value.get_ref(), &value.span(), Bound::Angle, sink)?;
                Some((At { value: key.get_ref().to_string(), span: key.span() }, angle))
            })
            .collect();
        read.into_iter().collect()
    }

    /// Lists of names.
    pub fn name_lists(&self, name: &str, sink: &mut Sink) -> Option<NameLists> {
        let field = self.field(name)?;
        let DeValue::Array(lists) = field.value else {
            return field.wrong_type(sink);
        };
        if !is_within_bounds(lists.len(), &field.path, &field.span, sink) {
            return None;
        }
        let mut all = Some(Vec::new());
        for list in lists.iter() {
            let read = match list.get_ref() {
                DeValue::Array(items) => field.name_list(items, &list.span(), sink),
                other => field.wrong_type_at(other, &list.span(), "a list of names", sink),
            };
            all = all.zip(read).map(|(mut all, read)| {
                all.push(read);
                all
            });
        }
        Some(At { value: all?, span: field.span })
    }
}
