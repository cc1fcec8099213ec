//! The modules of a build: one for each gait, in that of its robot. Modules in one place need different names.

use super::diagnostic::{Diagnostic, Label, Source};
use super::{Code, name};

/// A robot of a build, by the files that say what it and its gaits are called.
pub(crate) struct Named<'s> {
    /// Its folder, which names the module of its gaits; empty where they need none.
    pub folder: &'s str,
    pub file: &'s Source,
    /// Names of its gaits with their files.
    pub gaits: Vec<(&'s str, Source)>,
}

/// All gaits and robots whose modules would have a name that cannot be, or one that is taken.
pub(crate) fn mistakes(robots: &[Named]) -> Vec<Diagnostic> {
    let mut mistakes = Vec::new();
    // Names of modules beside each other, and who has them.
    let mut top: Vec<(String, Label)> = Vec::new();
    for robot in robots {
        let mut own = Vec::new();
        let taken = if robot.folder.is_empty() { &mut top } else { &mut own };
        for (gait, source) in &robot.gaits {
            let label = Label { source: source.clone(), span: name::place_of_gait(source), text: "this gait".into() };
            claim(name::module_name(gait), label, taken, &mut mistakes, || {
                (format!("the gait \"{gait}\" has the module of another one"), "write another name = \"…\"".into())
            });
        }
    }
    for robot in robots.iter().filter(|robot| !robot.folder.is_empty()) {
        let folder = robot.folder;
        let label = Label { source: robot.file.clone(), span: 0..0, text: "the robot of this folder".into() };
        if let Some(why) = name::unusable_as_folder(folder) {
            let title = format!("a robot's folder cannot be called `{folder}`: {why}");
            let help = "rename the folder: small letters, digits and _, a letter first; for example my_robot".into();
            mistakes.push(Diagnostic { code: Code::BadName, title, primary: label, secondary: None, help });
            continue;
        }
        claim(folder.to_string(), label, &mut top, &mut mistakes, || {
            let title = format!("the robot's folder `{folder}` has the module of a gait or of another robot");
            (title, "rename the folder, or the gait".into())
        });
    }
    mistakes
}

/// Takes a module's name, or says who has it.
fn claim(
    module: String,
    label: Label,
    taken: &mut Vec<(String, Label)>,
    mistakes: &mut Vec<Diagnostic>,
    told: impl FnOnce() -> (String, String),
) {
    match taken.iter().find(|(name, _)| *name == module) {
        None => taken.push((module, label)),
        Some((_, first)) => {
            let (title, help) = told();
            let primary = Label { text: format!("its module would be `{module}`"), ..label };
            let secondary = Some(Label { text: "and so would this one's".into(), ..first.clone() });
            mistakes.push(Diagnostic { code: Code::BadName, title, primary, secondary, help });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(robots: &[(&str, &[&'static str])]) -> Vec<Code> {
        let source = Source::new("a.toml", "name = \"a\"");
        let gaits = |names: &[&'static str]| names.iter().map(|name| (*name, source.clone())).collect();
        let robots: Vec<Named> =
            robots.iter().map(|(folder, names)| Named { folder, file: &source, gaits: gaits(names) }).collect();
        mistakes(&robots).iter().map(|d| d.code).collect()
    }

    #[test]
    fn modules_need_names_of_their_own() {
        assert_eq!(found(&[("", &["trot", "amble"]), ("rabbit", &["walk"]), ("a1", &["trot"])]), []);
        assert_eq!(found(&[("", &["trot", "Trot", "TROT"]), ("rabbit", &["walk"])]), [Code::BadName; 2]);
        assert_eq!(found(&[("", &["trot"]), ("trot", &["walk"])]), [Code::BadName]);
        assert_eq!(found(&[("", &["trot"]), ("rabbit", &["walk", "Walk"])]), [Code::BadName]);
        for folder in
            ["whole", "whole2", "math", "gaits", "family", "fn", "self", "two words", "Rabbit", "é", "a\n", "std"]
        {
            assert_eq!(found(&[("", &["trot"]), (folder, &["walk"])]), [Code::BadName], "{folder:?}");
        }
    }
}
