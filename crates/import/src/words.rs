//! Names: those that a specification admits, patterns that match them, and what a name tells of a link.

use super::xml::plain;
use std::collections::{BTreeMap, BTreeSet};

/// A name that the specification admits.
pub fn identifier(name: &str) -> String {
    let cleaned: String = name.chars().take(80).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if cleaned.starts_with(|c: char| c.is_ascii_alphabetic()) { cleaned } else { format!("a_{cleaned}") }
}

/// Identifiers of names, each its own.
#[derive(Default)]
pub struct Identifiers {
    /// Names that are identifiers as they stand: no other one becomes one of them.
    kept: BTreeSet<String>,
    taken: BTreeSet<String>,
    /// Names that are none, and what became of them.
    pub changed: BTreeMap<String, String>,
}

impl Identifiers {
    /// For these names, and others.
    pub fn among<'n>(names: impl Iterator<Item = &'n str>) -> Identifiers {
        let kept = names.filter(|name| identifier(name) == *name).map(String::from).collect();
        Identifiers { kept, ..Identifiers::default() }
    }

    /// An identifier like `name` that nothing else has.
    pub fn distinct(&mut self, name: &str) -> String {
        let like = identifier(name);
        let mut made = like.clone();
        let mut number = 1;
        while self.taken.contains(&made) || (made != name && self.kept.contains(&made)) {
            number += 1;
            made = format!("{like}_{number}");
        }
        self.taken.insert(made.clone());
        if made != name {
            self.changed.insert(name.into(), made.clone());
        }
        made
    }
}

/// Whether a name fits a pattern in which `*` stands for any letters and `?` for one.
pub fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // Where the last star stood, and how far it reaches.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        if p < pattern.len() && pattern[p] == '*' {
            star = Some((p, n));
            p += 1;
        } else if p < pattern.len() && (pattern[p] == '?' || pattern[p] == name[n]) {
            (p, n) = (p + 1, n + 1);
        } else if let Some((at, reach)) = star {
            star = Some((at, reach + 1));
            (p, n) = (at + 1, reach + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// The name that is most like this one, if any is much like it.
pub fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<String> {
    let name = plain(name).to_lowercase();
    let scored = known.map(|k| (distance(&name, &k.to_lowercase()), k));
    let (distance, nearest) = scored.min_by_key(|(d, _)| *d)?;
    (distance <= name.chars().count() / 3).then(|| nearest.to_string())
}

fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut before = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let here = row[j + 1];
            row[j + 1] = (before + usize::from(x != *y)).min(here + 1).min(row[j] + 1);
            before = here;
        }
    }
    row[b.len()]
}

/// Whether a link goes by a foot's name.
pub fn is_foot(name: &str) -> bool {
    has(name, &["foot", "feet", "toe", "tip", "contact", "sole"])
}

/// Whether a name belongs to a leg.
pub fn is_leg(name: &str) -> bool {
    is_foot(name)
        || has(name, &["leg", "thigh", "calf", "shin", "shank", "knee", "hip", "ankle", "haunch", "kfe", "hfe"])
}

/// Whether a name belongs to what hangs on a robot and is no leg.
pub fn is_other_limb(name: &str) -> bool {
    let limbs = [
        "arm", "hand", "finger", "gripper", "wrist", "elbow", "palm", "thumb", "head", "neck", "tail", "jaw", "camera",
        "lidar", "eye",
    ];
    has(name, &limbs)
}

/// Whether a name is of an arm, or of a foreleg where it stands.
pub fn is_of_foreleg(name: &str) -> bool {
    has(
        name,
        &["hand", "finger", "wrist", "elbow", "palm", "thumb", "shoulder", "scapula", "humerus", "radius", "ulna"],
    )
}

/// The first names, and how many more there are.
pub fn short_list(names: &[String]) -> String {
    match names {
        [first, second, third, _, ..] => format!("{first}, {second}, {third} and {} more", names.len() - 3),
        _ => names.join(", "),
    }
}

/// What is said of links with a mass and no inertia.
pub fn point_masses(names: &str) -> String {
    format!("{names}: a mass without moments of inertia in the file, which is taken to be in one point")
}

fn has(name: &str, words: &[&str]) -> bool {
    let name = name.to_lowercase();
    words.iter().any(|word| name.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_a_shell() {
        for (pattern, name, expected) in [
            ("*", "", true),
            ("arm_*", "arm_1", true),
            ("arm_*", "farm_1", false),
            ("*wheel*", "fl_wheel_joint", true),
            ("f?_hip", "fl_hip", true),
            ("f?_hip", "f_hip", false),
            ("a*b*c", "a_b_b_c", true),
            ("a*b*c", "a_c_b", false),
            ("knee", "knee", true),
        ] {
            assert_eq!(fits(pattern, name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn identifiers_are_distinct() {
        let mut names = Identifiers::default();
        let made = ["leg-a", "leg_a", "leg_a_2", "2"].map(|name| names.distinct(name));
        assert_eq!(made, ["leg_a", "leg_a_2", "leg_a_2_2", "a_2"]);
        // A name that may stay as it is stays, whatever else looks like it.
        let mut names = Identifiers::among(["leg.a", "leg_a"].into_iter());
        assert_eq!(["leg.a", "leg_a"].map(|name| names.distinct(name)), ["leg_a_2", "leg_a"]);
        assert_eq!(names.changed.into_iter().collect::<Vec<_>>(), [("leg.a".into(), "leg_a_2".into())]);
    }
}
