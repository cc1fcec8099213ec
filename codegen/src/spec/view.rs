//! A TOML table seen through its form (`format.rs`): unknown and missing keys are reported as it is opened.
//! Its values are read by the getters in `decode.rs`.

use toml::de::{DeTable, DeValue};

use super::Code;
use super::diagnostic::{At, Sink, Span};
use super::field::{Field, found};
use super::format::TWO_WAYS;
use super::keys::{Key, Kind, Table, Way};
use super::name;
use super::nearest::nearest;

/// No table or list of a specification has more entries. What is checked of each, and of each beside all others, then stays
/// a matter of milliseconds.
const MOST: usize = 256;

/// Reports a table or list with more entries than a specification has.
pub(super) fn is_within_bounds(entries: usize, path: &str, span: &Span, sink: &mut Sink) -> bool {
    if entries > MOST {
        let title = match path {
            "" => format!("the file has {entries} keys"),
            _ => format!("`{path}` has {entries} entries"),
        };
        let help = "none of them was looked at: write a robot, or a gait, with fewer";
        sink.report(Code::WrongCount, title, span, format!("at most {MOST}"), help);
    }
    entries <= MOST
}

/// One table of the file together with its form.
pub(super) struct View<'t> {
    entries: &'t DeTable<'t>,
    form: &'static Table,
    /// In which way the file is written, and the key that says so.
    way: (Way, Option<Said>),
    /// Dotted path for messages, empty at the root.
    path: String,
    /// Where the table is named.
    pub at: Span,
}

/// A key that is there, and where.
type Said = At<&'static str>;

impl<'t> View<'t> {
    /// Takes hold of a whole file; reports its unknown and its missing keys.
    pub fn of_file(entries: &'t DeTable<'t>, form: &'static Table, sink: &mut Sink) -> Self {
        let says = |key: &'static Key| {
            let span = entries.get_key_value(key.name)?.0.span();
            Some((key.way?, At { value: key.name, span }))
        };
        // Where there are keys of both, the long way is the one that says all.
        let said = form.keys.iter().filter_map(says).min_by_key(|(way, _)| *way != Way::Long);
        let way = said.map_or((Way::Short, None), |(way, key)| (way, Some(key)));
        Self { entries, form, way, path: String::new(), at: 0..0 }.checked(sink)
    }

    /// Takes hold of a table in it.
    fn within(&self, entries: &'t DeTable<'t>, form: &'static Table, path: String, at: Span, sink: &mut Sink) -> Self {
        Self { entries, form, way: self.way.clone(), path, at }.checked(sink)
    }

    fn checked(self, sink: &mut Sink) -> Self {
        if is_within_bounds(self.entries.len(), &self.path, &self.at, sink) {
            self.check_keys(sink);
            self.check_way(sink);
        }
        self
    }

    fn check_keys(&self, sink: &mut Sink) {
        let known = || self.form.keys.iter().map(|k| k.name);
        let mut meant = Vec::new();
        for (key, span) in self.names() {
            if known().any(|k| k == key) || sink.is_full() {
                continue;
            }
            let absent = known().filter(|k| !self.entries.contains_key(*k));
            let suggestion = nearest(key, absent).or_else(|| nearest(key, known()));
            let help = match suggestion {
                Some(near) if self.entries.contains_key(near) => {
                    format!("`{near}` is there already: remove `{key}`")
                }
                Some(near) => format!("did you mean `{near}`?"),
                None => {
                    let all: Vec<_> = known().map(|k| format!("`{k}`")).collect();
                    format!("the keys of {} are {}", self.form.noun, all.join(", "))
                }
            };
            meant.extend(suggestion);
            let title = format!("unknown key `{}`", self.join(key));
            sink.report(Code::UnknownKey, title, &span, format!("not a key of {}", self.form.noun), help);
        }
        self.check_missing(&meant, sink);
    }

    /// Reports the absent keys, except those that an unknown key was meant to be.
    fn check_missing(&self, meant: &[&str], sink: &mut Sink) {
        let (way, said) = &self.way;
        let required = self.form.keys.iter().filter(|k| k.is_required(*way));
        let missing: Vec<&Key> =
            required.filter(|k| !self.entries.contains_key(k.name) && !meant.contains(&k.name)).collect();
        if missing.is_empty() {
            return;
        }
        let names: Vec<_> = missing.iter().map(|k| format!("`{}`", k.name)).collect();
        let names = names.join(", ");
        let title = if self.path.is_empty() {
            format!("{} needs {names}", self.form.noun)
        } else {
            format!("`{}` needs {names}", self.path)
        };
        let lines: Vec<_> = missing.iter().map(|k| k.template(*way)).collect();
        let (label, mut help) = match &lines[..] {
            [line] => ("a key is missing here", format!("add {line}")),
            _ => ("keys are missing here", format!("add\n{}", lines.join("\n"))),
        };
        if self.path.is_empty() && said.is_none() && missing.iter().any(|k| k.way.is_some()) {
            help = format!("{help}\n{TWO_WAYS}");
        }
        sink.report(Code::MissingKey, title, &self.at, label, help);
    }

    /// Reports the keys that stand only in a file that is written in the other way.
    fn check_way(&self, sink: &mut Sink) {
        let (way, Some(said)) = &self.way else {
            return;
        };
        let here = |key: &&Key| !key.is_of(*way) && self.entries.contains_key(key.name);
        let keys: Vec<&Key> = self.form.keys.iter().filter(here).collect();
        let Some(first) = keys.first() else {
            return;
        };
        let names: Vec<_> = keys.iter().map(|k| format!("`{}`", self.join(k.name))).collect();
        let goes = if keys.len() == 1 { "does" } else { "do" };
        let title = format!("{} {goes} not go with `{}`", names.join(" and "), said.value);
        let help = format!("{TWO_WAYS}: remove what is too much");
        sink.report(Code::TwoWays, title, &self.key_span(first.name), "says it in the other way", help);
        sink.beside(sink.label(&said.span, "beside this key"));
    }

    /// All keys with their places, in the order of the file.
    pub fn names(&self) -> Vec<(&'t str, Span)> {
        let mut names: Vec<_> = self.entries.iter().map(|(k, _)| (k.get_ref().as_ref(), k.span())).collect();
        names.sort_by_key(|(_, span)| span.start);
        names
    }

    /// Whether the file is written in the short way.
    pub fn is_short(&self) -> bool {
        self.way.0 == Way::Short
    }

    /// Whether the table was read as one of this form.
    pub fn is(&self, form: &'static Table) -> bool {
        std::ptr::eq(self.form, form)
    }

    pub fn has(&self, name: &str) -> bool {
        self.entries.contains_key(name)
    }

    /// Which tables of a map have the key `inner`; reports nothing.
    pub fn peek(&self, name: &str, inner: &str) -> Vec<(String, bool)> {
        let Some(DeValue::Table(entries)) = self.entries.get(name).map(|v| v.get_ref()) else {
            return Vec::new();
        };
        let has = |value: &DeValue<'_>| value.as_table().is_some_and(|t| t.contains_key(inner));
        entries.iter().map(|(key, value)| (key.get_ref().to_string(), has(value.get_ref()))).collect()
    }

    /// How long the list under a key is, if it is one, and where it stands.
    pub fn list_length(&self, name: &str) -> Option<(usize, Span)> {
        let value = self.entries.get(name)?;
        value.get_ref().as_array().map(|items| (items.len(), value.span()))
    }

    /// Dotted path of a key of this table.
    pub fn join(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) }
    }

    /// The key's definition, its value and where that stands.
    pub fn field(&self, name: &str) -> Option<Field<'t>> {
        let key = self.form.keys.iter().find(|k| k.name == name)?;
        let value = self.entries.get(name)?;
        Some(Field { path: self.join(name), key, way: self.way.0, value: value.get_ref(), span: value.span() })
    }

    /// Where the key's name stands.
    pub fn key_span(&self, name: &str) -> Span {
        self.entries.get_key_value(name).map_or(self.at.clone(), |(key, _)| key.span())
    }

    /// A table of a known form.
    pub fn table(&self, name: &str, sink: &mut Sink) -> Option<View<'t>> {
        let field = self.field(name)?;
        let (Kind::Table(form), DeValue::Table(entries)) = (&field.key.kind, field.value) else {
            return field.wrong_type(sink);
        };
        Some(self.within(entries, form, field.path, self.key_span(name), sink))
    }

    /// The tables of a list, each called by its number, from 1.
    pub fn tables(&self, name: &str, sink: &mut Sink) -> Option<Vec<Option<View<'t>>>> {
        let field = self.field(name)?;
        let (Kind::Tables(form), DeValue::Array(items)) = (&field.key.kind, field.value) else {
            return field.wrong_type(sink);
        };
        if !is_within_bounds(items.len(), &field.path, &self.key_span(name), sink) {
            return None;
        }
        let views = items.iter().enumerate().map(|(k, item)| match item.get_ref() {
            DeValue::Table(entries) => {
                Some(self.within(entries, form, format!("{}.{}", field.path, k + 1), item.span(), sink))
            }
            other => field.wrong_type_at(other, &item.span(), "a table", sink),
        });
        Some(views.collect())
    }

    /// The named tables of a map, in the order of the file; `form` picks each one's form.
    pub fn map(
        &self,
        name: &str,
        sink: &mut Sink,
        mut form: impl FnMut(&str, &DeTable<'t>) -> &'static Table,
    ) -> Option<Vec<(At<String>, Option<View<'t>>)>> {
        let field = self.field(name)?;
        let DeValue::Table(entries) = field.value else {
            return field.wrong_type(sink);
        };
        if !is_within_bounds(entries.len(), &field.path, &self.key_span(name), sink) {
            return None;
        }
        let mut names: Vec<_> = entries.iter().collect();
        names.sort_by_key(|(key, _)| key.span().start);
        let views = names
            .into_iter()
            .map(|(key, value)| {
                let child = At { value: key.get_ref().to_string(), span: key.span() };
                name::check(&child, sink);
                let path = format!("{}.{}", field.path, child.value);
                let view = match value.get_ref() {
                    DeValue::Table(inner) => {
                        let form = form(&child.value, inner);
                        Some(self.within(inner, form, path, key.span(), sink))
                    }
                    other => {
                        let title = format!("`{path}` must be a table, not {}", found(other));
                        let help = format!("write [{path}], and its keys on the lines below");
                        sink.report(Code::WrongType, title, &value.span(), "expected a table", help);
                        None
                    }
                };
                (child, view)
            })
            .collect();
        Some(views)
    }
}
