//! What is given beside the file: which of it counts for a joint or a link, and what of it names nothing or does nothing.

use super::fault::{Faults, Kind};
use super::foot;
use super::limbs::Limbs;
use super::model::Model;
use super::words::{fits, nearest};
use super::{Options, Setting};
use piaffe_model::digits::digits;

impl Options {
    /// The numbers for joints, each with its option and whether it may be zero.
    fn settings(&self) -> [(&'static str, &[Setting], bool); 4] {
        [
            ("effort", &self.efforts, false),
            ("velocity", &self.velocities, false),
            ("gear", &self.gears, false),
            ("rotor", &self.rotors, true),
        ]
    }
}

/// Which setting counts for a joint: the last one that names it; if the file has none, the last one that is for all.
pub fn chosen(settings: &[Setting], joint: &str, file_has_one: bool) -> Option<usize> {
    let named = settings.iter().rposition(|s| s.joint.as_ref().is_some_and(|pattern| fits(pattern, joint)));
    named.or_else(|| settings.iter().rposition(|s| s.joint.is_none()).filter(|_| !file_has_one))
}

/// Which of the stops that are given count for a joint: the last ones that name it.
pub fn chosen_stops(options: &Options, joint: &str) -> Option<usize> {
    options.ranges.iter().rposition(|stops| fits(&stops.joint, joint))
}

/// Says what of the options can be none of this file's.
pub fn check(model: &Model, options: &Options, faults: &mut Faults) {
    let joints = || model.joints.iter().map(|joint| joint.name.as_str());
    let links = || model.links.iter().map(|link| link.name.as_str());
    let mut named = |option: &str, pattern: &str, what: &str, names: Vec<&str>| {
        if names.iter().any(|name| fits(pattern, name)) {
            return;
        }
        let remedy = match nearest(pattern, names.into_iter()) {
            Some(near) => format!("did you mean --{option} {near}?"),
            None => format!("name a {what} of the file, or a pattern with * and ?"),
        };
        faults.add(Kind::Option, None, format!("--{option} {pattern}: there is no such {what}"), remedy);
    };
    for lock in &options.locks {
        named("lock", lock.pattern.strip_suffix('/').unwrap_or(&lock.pattern), "joint", joints().collect());
    }
    for foot in &options.feet {
        named("foot", &foot.link, "link", links().collect());
    }
    for stops in &options.ranges {
        named("range", &stops.joint, "joint", joints().collect());
    }
    for (option, settings, _) in options.settings() {
        for pattern in settings.iter().filter_map(|s| s.joint.as_ref()) {
            named(option, pattern, "joint", joints().collect());
        }
    }
    for (option, settings, zero) in options.settings() {
        for setting in settings {
            let least = if zero { setting.value >= 0.0 } else { setting.value > 0.0 };
            if !(least && setting.value.is_finite()) {
                let more = if zero { "0 or more" } else { "more than 0" };
                let what = format!("--{option} {}: no joint has that", words(setting));
                faults.add(Kind::Option, None, what, format!("give a number that is {more}"));
            }
        }
    }
}

fn words(setting: &Setting) -> String {
    let value = digits(setting.value);
    setting.joint.as_ref().map_or(value.clone(), |joint| format!("{joint}={value}"))
}

/// What changes nothing, a sentence each, with why.
pub fn idle(model: &Model, limbs: &Limbs, options: &Options) -> Vec<String> {
    let bodies = &limbs.tree.bodies;
    let moving: Vec<_> =
        limbs.legs.iter().flat_map(|leg| &leg.chain).filter_map(|b| bodies[*b].joint.as_ref()).collect();
    let moving: Vec<_> = moving.into_iter().map(|m| &model.joints[m.joint]).collect();
    let mut idle = Vec::new();
    let mut say = |option: &str, words: String, why: &str| {
        idle.push(format!("--{option} {words} changes nothing: {why}"));
    };
    let still = "it names no joint that moves in a leg";
    let later = "for all that it names another one counts";
    for (option, settings, _) in options.settings() {
        let has = |joint: &super::model::Joint| match option {
            "effort" => joint.effort.is_some(),
            "velocity" => joint.velocity.is_some(),
            "gear" => joint.gear.is_some(),
            _ => joint.rotor.is_some(),
        };
        let used: Vec<_> = moving.iter().map(|joint| chosen(settings, &joint.name, has(joint))).collect();
        for (_, setting) in settings.iter().enumerate().filter(|(k, _)| !used.contains(&Some(*k))) {
            let names = |pattern: &String| moving.iter().any(|joint| fits(pattern, &joint.name));
            let why = match &setting.joint {
                Some(pattern) if !names(pattern) => still,
                None if moving.iter().all(|joint| has(joint)) => {
                    "the file has one for every joint that moves (JOINT=… takes the place of it)"
                }
                _ => later,
            };
            say(option, words(setting), why);
        }
    }
    let used: Vec<_> = moving.iter().map(|joint| chosen_stops(options, &joint.name)).collect();
    for (_, stops) in options.ranges.iter().enumerate().filter(|(k, _)| !used.contains(&Some(*k))) {
        let names = moving.iter().any(|joint| fits(&stops.joint, &joint.name));
        say("range", stops.joint.clone(), if names { later } else { still });
    }
    let feet = limbs.legs.iter().map(|leg| model.links[leg.foot.link].name.as_str());
    let used: Vec<_> = feet.filter_map(|link| foot::given(options, link)).collect();
    for foot in options.feet.iter().filter(|foot| !used.iter().any(|used| std::ptr::eq(*used, *foot))) {
        say("foot", foot.link.clone(), "no leg ends in a link that it names, or another one counts there");
    }
    idle
}
