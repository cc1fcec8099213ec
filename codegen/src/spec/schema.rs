//! JSON schemas of the two file formats, for completion and checks in an editor; written from `format.rs`.

use std::fmt::Write;

use super::format;
use super::keys::{Bound, Key, Kind, Table, Way};

/// JSON schema (draft 2020-12) of `robot.toml`.
pub fn robot_schema() -> String {
    schema(&format::ROBOT)
}

/// JSON schema (draft 2020-12) of a gait file.
pub fn gait_schema() -> String {
    schema(&format::GAIT)
}

fn schema(root: &Table) -> String {
    let mut out = String::from("{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n");
    let _ = write!(out, "  \"title\": {},\n  ", quoted(root.noun.trim_start_matches("a ")));
    let keys = table(root, root.doc, 1);
    let [keys, ways] = [keys.trim_start_matches("{\n").trim_start(), &ways(root)];
    // In the place of the brace at the end.
    let keys = keys.strip_suffix("\n}").unwrap_or(keys);
    let _ = write!(out, "{keys}{ways}\n}}\n");
    out
}

/// What the keys of one way demand and exclude, and those of the other, where a file can be written in two.
fn ways(root: &Table) -> String {
    let each: Vec<_> = Way::ALL.iter().filter_map(|way| demands(root, *way)).collect();
    if each.is_empty() { String::new() } else { format!(",\n  \"oneOf\": [\n    {}\n  ]", each.join(",\n    ")) }
}

/// What a file of this way must have and must not have in a table, beside what all have.
fn demands(table: &Table, way: Way) -> Option<String> {
    let required: Vec<_> =
        table.keys.iter().filter(|k| k.way.is_some() && k.is_required(way)).map(|k| k.name).collect();
    let of_key = |key: &Key| match &key.kind {
        _ if !key.is_of(way) => Some(format!("{}: false", quoted(key.name))),
        Kind::Table(inner) => demands(inner, way).map(|inner| format!("{}: {inner}", quoted(key.name))),
        _ => None,
    };
    let properties: Vec<_> = table.keys.iter().filter_map(of_key).collect();
    let parts = [
        (!required.is_empty()).then(|| format!("\"required\": {}", words(required.iter().copied()))),
        (!properties.is_empty()).then(|| format!("\"properties\": {{ {} }}", properties.join(", "))),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| format!("{{ {} }}", parts.join(", ")))
}

/// An object with fixed keys.
fn table(table: &Table, description: &str, depth: usize) -> String {
    let pad = "  ".repeat(depth);
    let required = table.keys.iter().filter(|k| k.default.is_none() && k.way.is_none()).map(|k| k.name);
    let properties: Vec<_> =
        table.keys.iter().map(|k| format!("{pad}  {}: {}", quoted(k.name), property(k, depth + 1))).collect();
    let end = "  ".repeat(depth - 1);
    format!(
        "{{\n{pad}\"description\": {},\n{pad}\"type\": \"object\",\n{pad}\"additionalProperties\": false,\n\
         {pad}\"required\": {},\n{pad}\"properties\": {{\n{}\n{pad}}}\n{end}}}",
        quoted(description),
        words(required),
        properties.join(",\n"),
    )
}

fn property(key: &Key, depth: usize) -> String {
    let pad = "  ".repeat(depth);
    let mut description = key.doc.to_string();
    if !key.unit.is_empty() {
        let _ = write!(description, " Unit: {}.", key.unit);
    }
    if let Some(default) = key.default {
        let _ = write!(description, " Default: {default}.");
    }
    let rest = match &key.kind {
        Kind::Table(inner) => {
            return table(inner, &description, depth + 1);
        }
        Kind::Tables(inner) => {
            format!("\"type\": \"array\", \"minItems\": 1, \"items\": {}\n{pad}", table(inner, inner.doc, depth + 1))
        }
        Kind::Map(forms) => format!(
            "\"type\": \"object\", \"minProperties\": 1,\n\
             {pad}  \"propertyNames\": {{ \"pattern\": \"^[A-Za-z][A-Za-z0-9_]{{0,99}}$\" }},\n\
             {pad}  \"additionalProperties\": {}\n{pad}",
            one_of(forms, depth + 1)
        ),
        kind => format!("{} ", value(kind)),
    };
    format!("{{ \"description\": {}, {rest}}}", quoted(&description))
}

/// A table of one of these forms.
fn one_of(forms: &[&Table], depth: usize) -> String {
    if let [only] = forms {
        return table(only, only.doc, depth + 1);
    }
    let pad = "  ".repeat(depth);
    let forms: Vec<_> = forms.iter().map(|form| format!("{pad}  {}", table(form, form.doc, depth + 2))).collect();
    format!("{{ \"anyOf\": [\n{}\n{pad}] }}", forms.join(",\n"))
}

/// The schema of a plain value, without its braces.
fn value(kind: &Kind) -> String {
    match kind {
        Kind::Text | Kind::Name => "\"type\": \"string\", \"minLength\": 1".into(),
        Kind::Choice(all) => format!("\"enum\": {}", words(all.iter().copied())),
        Kind::Order(all) => format!("\"enum\": {all:?}"),
        Kind::Number(bound) => number(*bound),
        Kind::Vector(bound) => list(*bound, 3),
        Kind::Pair(bound) => list(*bound, 2),
        Kind::Along(bound) => format!("\"anyOf\": [{{ {} }}, {{ {} }}]", number(*bound), list(Bound::Any, 3)),
        Kind::Choices(all) => {
            let all = words(all.iter().copied());
            format!("\"type\": \"array\", \"uniqueItems\": true, \"items\": {{ \"enum\": {all} }}")
        }
        Kind::NameLists => "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": \
             { \"type\": \"array\", \"minItems\": 1, \"uniqueItems\": true, \"items\": { \"type\": \"string\" } }"
            .into(),
        Kind::Coordinate => {
            "\"type\": \"string\", \"pattern\": \"^(platform|leg[12][.][A-Za-z][A-Za-z0-9_]*)$\"".into()
        }
        Kind::Angles => format!("\"type\": \"object\", \"additionalProperties\": {{ {} }}", number(Bound::Angle)),
        // Tables are written by `property`.
        Kind::Table(_) | Kind::Map(_) => "\"type\": \"object\"".into(),
        Kind::Tables(_) => "\"type\": \"array\"".into(),
    }
}

fn number(bound: Bound) -> String {
    let limits = match bound {
        Bound::Any => "",
        Bound::Positive => ", \"exclusiveMinimum\": 0",
        Bound::NonNegative => ", \"minimum\": 0",
        Bound::Angle => ", \"minimum\": -6.283185307179586, \"maximum\": 6.283185307179586",
    };
    format!("\"type\": \"number\"{limits}")
}

fn list(bound: Bound, length: usize) -> String {
    format!("\"type\": \"array\", \"minItems\": {length}, \"maxItems\": {length}, \"items\": {{ {} }}", number(bound))
}

fn words<'w>(all: impl Iterator<Item = &'w str>) -> String {
    format!("[{}]", all.map(quoted).collect::<Vec<_>>().join(", "))
}

/// A JSON string; the format's own texts contain no control characters.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
