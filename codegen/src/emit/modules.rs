//! The registry of all gaits: a module for each, in those of their robots.

use super::MATH;
use super::whole::{whole_file_name, whole_module};
use crate::spec::name::{module_name, type_name};

/// What the program calls a gait: `trot`, or `rabbit/walk` for one whose robot has a module.
pub fn key(robot: &str, gait: &str) -> String {
    if robot.is_empty() { gait.into() } else { format!("{robot}/{gait}") }
}

/// Name of the generated file of a gait.
pub fn file_name(robot: &str, gait: &str) -> String {
    key(robot, &format!("{}.rs", module_name(gait)))
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
