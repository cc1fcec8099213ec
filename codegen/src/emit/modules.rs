//! The registry of all gaits: a module for each, in those of their robots.

use super::whole::{whole_file_name, whole_module};
use super::{MATH, module_name, type_name};
use crate::spec::name;

/// Name of the module of a whole robot. Those of further ways to lock its joints have a number behind it.
pub(super) const WHOLE: &str = "whole";

/// What the program calls a gait: `trot`, or `rabbit/walk` for one whose robot has a module.
pub fn key(robot: &str, gait: &str) -> String {
    if robot.is_empty() { gait.into() } else { format!("{robot}/{gait}") }
}

/// Name of the generated file of a gait.
pub fn file_name(robot: &str, gait: &str) -> String {
    key(robot, &format!("{}.rs", module_name(gait)))
}

/// Modules in one place need different names that are names in Rust.
///
/// # Errors
/// What to rename.
pub fn check_modules(robots: &[(&str, Vec<String>)]) -> Result<(), String> {
    let reserved = ["math".to_string(), "gaits".to_string()];
    let is_whole = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()) == WHOLE;
    let mut top = reserved.to_vec();
    for (robot, gaits) in robots {
        let mut own = reserved.to_vec();
        let taken = if robot.is_empty() { &mut top } else { &mut own };
        for gait in gaits {
            let module = module_name(gait);
            if taken.contains(&module) || is_whole(&module) {
                let of = if robot.is_empty() { String::new() } else { format!(" of the robot `{robot}`") };
                return Err(format!("a gait{of} cannot be called `{gait}`: there is a module `{module}` already"));
            }
            taken.push(module);
        }
    }
    for (robot, _) in robots.iter().filter(|(robot, _)| !robot.is_empty()) {
        let why = if !name::is_of_rust(robot) {
            "this is no name in Rust"
        } else if *robot != module_name(robot) {
            "write it in small letters"
        } else if top.iter().any(|t| t == robot) || is_whole(robot) {
            "there is a gait or module of that name already"
        } else {
            top.push((*robot).to_string());
            continue;
        };
        return Err(format!("a robot's folder cannot be called `{robot}`: {why}"));
    }
    Ok(())
}

/// Source of the module that holds all gaits of a build; `wholes` tells how many whole robots each robot is.
pub fn registry_source(
    robots: &[(&str, Vec<String>)],
    wholes: &[usize],
    runtime: Option<&str>,
    origin: &str,
) -> String {
    let whole = |robot: usize| {
        (0..wholes[robot])
            .map(|n| module(&whole_module(n), "The whole robot", &whole_file_name(robots[robot].0, n)))
            .collect()
    };
    let mut source = tree(robots, file_name, whole, origin);
    if let Some(runtime) = runtime {
        let all: Vec<String> = paths(robots).iter().map(|(module, name)| format!("&{module}::{name}")).collect();
        let all = all.join(", ");
        source += &format!("/// All gaits of this build.\npub static GAITS: &[&dyn {runtime}::Gait] = &[{all}];\n");
    }
    source
}

/// The module and type of every gait.
pub(super) fn paths(robots: &[(&str, Vec<String>)]) -> Vec<(String, String)> {
    let of = |robot: &str, gait: &str| {
        let inside = if robot.is_empty() { String::new() } else { format!("{robot}::") };
        (inside + &module_name(gait), type_name(gait))
    };
    robots.iter().flat_map(|(robot, gaits)| gaits.iter().map(move |gait| of(robot, gait))).collect()
}

/// A module for each gait, in that of its robot with what `shared` has for the robot, and the one with the
/// elementary functions. `file` names the files to include.
pub(super) fn tree(
    robots: &[(&str, Vec<String>)],
    file: fn(&str, &str) -> String,
    shared: impl Fn(usize) -> String,
    origin: &str,
) -> String {
    let mut source =
        format!("// {origin}\n/// Elementary functions with pinned results.\npub mod math {{\n{MATH}\n}}\n");
    for (k, (robot, gaits)) in robots.iter().enumerate() {
        let gait_module = |gait: &String| {
            module(&module_name(gait), &format!("Generated dynamics of the {gait}"), &file(robot, gait))
        };
        let modules: String = gaits.iter().map(gait_module).collect();
        let items = shared(k) + &modules;
        if robot.is_empty() {
            source += &items;
        } else {
            source +=
                &format!("/// Gaits of the robot `{robot}`.\npub mod {robot} {{\n    use super::math;\n{items}}}\n");
        }
    }
    source
}

fn module(name: &str, what: &str, file: &str) -> String {
    format!(
        "/// {what}.\n#[rustfmt::skip]\n#[allow(clippy::all, clippy::pedantic)]\n\
         pub mod {name} {{\n    include!(concat!(env!(\"OUT_DIR\"), \"/{file}\"));\n}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_need_names_of_their_own() {
        let check = |robots: &[(&str, &[&str])]| {
            let robots: Vec<_> = robots.iter().map(|(r, g)| (*r, g.iter().map(|g| g.to_string()).collect())).collect();
            check_modules(&robots)
        };
        assert_eq!(check(&[("", &["trot", "amble"]), ("rabbit", &["walk"]), ("a1", &["trot"])]), Ok(()));
        for bad in [
            [("", &["trot", "Trot"][..]), ("rabbit", &["walk"])],
            [("", &["math"]), ("rabbit", &["walk"])],
            [("", &["trot"]), ("rabbit", &["whole"])],
            [("", &["whole2"]), ("rabbit", &["walk"])],
            [("", &["trot"]), ("whole", &["walk"])],
            [("", &["trot"]), ("rabbit", &["gaits"])],
            [("", &["trot"]), ("trot", &["walk"])],
            [("", &["trot"]), ("fn", &["walk"])],
            [("", &["trot"]), ("two words", &["walk"])],
            [("", &["trot"]), ("Rabbit", &["walk"])],
        ] {
            assert!(check(&bad).is_err(), "{bad:?}");
        }
    }
}
