//! Numbers of a specification changed where they stand, so that the files that come of it say all.
//!
//! Their names are the keys that lead to them, as in `links.thigh.mass`; of a list's elements those that say what they are:
//! `legs.fore_left.mount.x`, `joints.knee.range.lower`, `phases.1.duration.shortest`.

use super::format::may_be_absent;
use super::nearest::nearest;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A number in a file.
pub struct Number {
    pub name: String,
    pub value: f64,
    span: Range<usize>,
}

/// The text of a file with another number in it, where one stands or where one may be absent; `None` if no number there is called
/// like this.
pub fn set(text: &str, name: &str, value: f64) -> Option<String> {
    let (text, known) = set_all(text, &[(name, value)]);
    known[0].then_some(text)
}

/// The same with several numbers at once, whatever their order, and which of them the file has.
pub fn set_all(text: &str, wanted: &[(&str, f64)]) -> (String, Vec<bool>) {
    let (mut changed, mut have) = (text.to_string(), vec![false; wanted.len()]);
    // From behind: what is before stays where it is.
    for number in numbers(text).iter().rev() {
        if let Some(k) = wanted.iter().position(|(name, _)| *name == number.name) {
            changed.replace_range(number.span.clone(), &written(wanted[k].1));
            have[k] = true;
        }
    }
    for ((name, value), has) in wanted.iter().zip(&mut have) {
        if !*has
            && may_be_absent(name)
            && let Some(with) = insert(&changed, name, &written(*value))
        {
            (changed, *has) = (with, true);
        }
    }
    (changed, have)
}

/// The text of a file with a key that it lacks, before the first key of its table; `None` if there is no such table.
pub(super) fn insert(text: &str, name: &str, value: &str) -> Option<String> {
    let (path, key) = name.rsplit_once('.')?;
    let root = DeTable::parse(text).ok()?;
    let table = path.split('.').try_fold(root.get_ref(), |table, part| table.get(part)?.get_ref().as_table())?;
    let first = table.keys().map(|key| key.span().start).min()?;
    let line = text[..first].rfind('\n').map_or(0, |end| end + 1);
    let before = &text[line..first];
    let changed = match before.trim_end().chars().next_back() {
        // Inside of braces.
        Some('{' | ',') => {
            let (head, tail) = text.split_at(first);
            format!("{head}{key} = {value}, {tail}")
        }
        // A line of its own, below the table's name or behind it.
        _ => format!("{}{before}{key} = {value}\n{}", &text[..line], &text[line..]),
    };
    let there = |number: &Number| number.name == name || number.name.starts_with(&format!("{name}."));
    numbers(&changed).iter().any(there).then_some(changed)
}

/// The number of this name in the text of a file.
pub fn number(text: &str, name: &str) -> Option<f64> {
    numbers(text).into_iter().find(|number| number.name == name).map(|number| number.value)
}

/// The names that one with braces stands for, `links.{left,right}_shin.mass`; without braces it stands for itself.
pub fn alternatives(name: &str) -> Vec<String> {
    let Some((before, rest)) = name.split_once('{') else { return vec![name.into()] };
    let Some((inside, after)) = rest.split_once('}') else { return vec![name.into()] };
    let with = |part: &str| alternatives(&format!("{before}{}{after}", part.trim()));
    inside.split(',').flat_map(with).collect()
}

/// What to say where no file has a number of this name.
pub fn unknown<'t>(name: &str, texts: impl IntoIterator<Item = &'t str>) -> String {
    const SHOWN: usize = 12;
    let mut known: Vec<String> = texts.into_iter().flat_map(numbers).map(|number| number.name).collect();
    known.sort();
    known.dedup();
    if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
        return format!("there is no number `{name}`: did you mean `{near}`?");
    }
    // Those that stand in the same table, if it is one.
    let table = name.rsplit_once('.').map_or(String::new(), |(table, _)| format!("{table}."));
    let beside: Vec<String> = known.iter().filter(|known| known.starts_with(&table)).cloned().collect();
    let (whose, list) =
        if beside.is_empty() || table.is_empty() { ("there are", known) } else { ("beside it are", beside) };
    let more = if list.len() > SHOWN { format!(" and {} more", list.len() - SHOWN) } else { String::new() };
    format!("there is no number `{name}`; {whose} {}{more}", list[..list.len().min(SHOWN)].join(", "))
}

/// All numbers of a file, in its order; of one that is no TOML none.
pub fn numbers(text: &str) -> Vec<Number> {
    let mut numbers = Vec::new();
    if let Ok(table) = DeTable::parse(text) {
        in_table(table.get_ref(), "", &mut numbers);
    }
    numbers.sort_by_key(|number| number.span.start);
    numbers
}

/// Whether a name is that of the duration of a phase in which a foot stands: `phases.1.duration`.
pub fn is_duration_on_a_foot(text: &str, name: &str) -> bool {
    let stands = || {
        let number: usize = name.strip_prefix("phases.")?.strip_suffix(".duration")?.parse().ok()?;
        let table = DeTable::parse(text).ok()?;
        let phase = table.get_ref().get("phases")?.get_ref().as_array()?.get(number.checked_sub(1)?)?;
        let stance = phase.get_ref().as_table()?.get("stance")?.get_ref().as_array()?;
        Some(!stance.is_empty())
    };
    stands().unwrap_or(false)
}

fn in_table(table: &DeTable, path: &str, numbers: &mut Vec<Number>) {
    for (key, value) in table {
        let path = if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        in_value(value.get_ref(), value.span(), path, key.get_ref(), numbers);
    }
}

fn in_value(value: &DeValue, span: Range<usize>, name: String, key: &str, numbers: &mut Vec<Number>) {
    let read = match value {
        DeValue::Table(table) => return in_table(table, &name, numbers),
        DeValue::Array(elements) => {
            for (k, element) in elements.iter().enumerate() {
                let part = match element.get_ref() {
                    DeValue::Table(_) => (k + 1).to_string(),
                    _ => part(key, elements.len(), k),
                };
                let name = format!("{name}.{part}");
                in_value(element.get_ref(), element.span(), name, key, numbers);
            }
            return;
        }
        DeValue::Integer(number) => number.to_string().parse().ok(),
        DeValue::Float(number) => number.to_string().parse().ok(),
        _ => None,
    };
    numbers.extend(read.map(|value| Number { name, value, span }));
}

/// What the k-th element of a list is, of those that are no tables.
fn part(key: &str, length: usize, k: usize) -> String {
    let names: &[&str] = match (key, length) {
        ("products", 3) => &["yz", "zx", "xy"],
        ("range", 2) => &["lower", "upper"],
        (_, 2) if key.ends_with("duration") => &["shortest", "longest"],
        (_, 3) => &["x", "y", "z"],
        _ => &[],
    };
    names.get(k).map_or_else(|| (k + 1).to_string(), ToString::to_string)
}

/// As TOML has it: whole numbers without a point, since some must be whole.
fn written(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value:.0}") } else { format!("{value:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROBOT: &str = "gravity = 9.81 # m/s²\n[links.thigh]\nmass = 1.6 # kg\ncom = [0.0, -0.1, 0]\n[legs]\n\
                         a = { mount = [0.2, 0.0, -0.15] }\nb = { mount = [-0.2, 0.0, 0.15] }\n\
                         [joints.knee]\nrange = [-1.5, 0.0]\n";

    #[test]
    fn a_number_is_changed_where_it_stands_and_nothing_else() {
        let changed = set(ROBOT, "links.thigh.mass", 1.25).unwrap();
        assert_eq!(changed, ROBOT.replace("mass = 1.6 #", "mass = 1.25 #"));
        let changed = set(ROBOT, "links.thigh.com.z", 1e-7).unwrap();
        assert_eq!(changed, ROBOT.replace("-0.1, 0]", "-0.1, 1e-7]"));
        let changed = set(ROBOT, "joints.knee.range.lower", -2.0).unwrap();
        assert_eq!(changed, ROBOT.replace("[-1.5, 0.0]", "[-2, 0.0]"));
        assert_eq!(set(ROBOT, "links.thigh", 1.0), None);
        assert_eq!(set("[", "gravity", 1.0), None);
    }

    #[test]
    fn a_number_that_may_be_absent_is_put_beside_others() {
        let gait = "[limits]\n  friction = 1.0 # of feet\n";
        let changed = set(gait, "limits.min_platform_height", 0.25).unwrap();
        assert_eq!(changed, "[limits]\n  min_platform_height = 0.25\n  friction = 1.0 # of feet\n");
        let changed = set("limits = { friction = 1.0 }", "limits.body_clearance", 0.5).unwrap();
        assert_eq!(changed, "limits = { body_clearance = 0.5, friction = 1.0 }");
        let changed = set("limits.\"friction\" = 1.0\n", "limits.body_clearance", 0.5).unwrap();
        assert_eq!(changed, "limits.body_clearance = 0.5\nlimits.\"friction\" = 1.0\n");
        let changed = set(ROBOT, "links.thigh.foot_mass", 0.1).unwrap();
        assert_eq!(changed, ROBOT.replace("mass = 1.6", "foot_mass = 0.1\nmass = 1.6"));
        let joint = "[joints.knee]\nparent = \"a\"\nrange = [-1, 1]\n";
        let changed = set(joint, "joints.knee.damping", 0.5).unwrap();
        assert_eq!(changed, joint.replace("parent", "damping = 0.5\nparent"));
        assert_eq!(set(gait, "limits.swing_clearance", 1.0), None, "who has none must say so");
        assert_eq!(set("gravity = 9.81", "links.thigh.foot_mass", 1.0), None, "there is no such link");
        assert_eq!(set(gait, "limits.colour", 1.0), None);
    }

    #[test]
    fn phases_are_called_by_their_numbers() {
        for count in 1..=3 {
            let list: String = (0..count).map(|k| format!("[[phases]]\nduration = [0.{k}1, 0.5]\n")).collect();
            for (k, from) in ["[0.01,", "[0.11,", "[0.21,"].into_iter().take(count).enumerate() {
                let changed = set(&list, &format!("phases.{}.duration.shortest", k + 1), 0.125).unwrap();
                assert_eq!(changed, list.replace(from, "[0.125,"));
            }
        }
    }

    #[test]
    fn braces_stand_for_several_names() {
        assert_eq!(alternatives("gravity"), ["gravity"]);
        assert_eq!(alternatives("links.{a, b}_{c,d}.mass").len(), 4);
        assert_eq!(alternatives("links.{a, b}_{c,d}.mass")[1], "links.a_d.mass");
        assert_eq!(alternatives("links.{a.mass"), ["links.{a.mass"], "what is no pair of braces is part of the name");
    }

    #[test]
    fn who_is_not_named_stays() {
        let changed = set(ROBOT, "legs.b.mount.z", 0.125).unwrap();
        assert_eq!(changed, ROBOT.replace(", 0.15]", ", 0.125]"), "the other one is as far out");
    }

    #[test]
    fn several_numbers_are_set_whatever_their_order() {
        let both = [("legs.a.mount.z", 0.125), ("legs.b.mount.z", -0.25), ("links.thigh.foot_mass", 0.1)];
        let expected = ROBOT.replace("-0.15]", "0.125]").replace("0.15]", "-0.25]");
        let expected = expected.replace("mass = 1.6", "foot_mass = 0.1\nmass = 1.6");
        let mut back = both;
        back.reverse();
        for wanted in [both, back] {
            assert_eq!(set_all(ROBOT, &wanted), (expected.clone(), vec![true; 3]));
        }
        let (text, known) = set_all(ROBOT, &[("gravity", 1.62), ("links.tail.mass", 1.0)]);
        assert_eq!((text, known), (ROBOT.replace("9.81", "1.62"), vec![true, false]));
    }

    #[test]
    fn names_that_are_none_lead_to_those_that_are() {
        assert!(unknown("links.thigh.mas", [ROBOT]).ends_with("did you mean `links.thigh.mass`?"));
        assert!(
            unknown("links.thigh.temperature", [ROBOT]).contains("beside it are links.thigh.com.x, links.thigh.com.y")
        );
        assert!(unknown("zzzzzz", [ROBOT]).contains("there are gravity, joints.knee.range.lower"));
    }
}
