//! What is asked for beside a robot's files, for one run: other numbers, other limits, stronger motors, a load. It is written into
//! the files, so that what comes of them says it.

use crate::files::clash;
use crate::spec;
use crate::{RobotFiles, SpecFile};
use std::collections::BTreeSet;

/// Changes to a robot and its gaits; none unless they are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Numbers by their names.
    pub numbers: Vec<(String, f64)>,
    /// Tangential over vertical force.
    pub friction: Option<f64>,
    /// Height of the parabola above which the swing foot stays, m.
    pub swing_clearance: Option<f64>,
    /// On the stance leg, N.
    pub min_vertical_force: Option<f64>,
    /// Of the platform's mass centre above the ground, m.
    pub min_platform_height: Option<f64>,
    /// Shortest and longest phase on a foot, s.
    pub duration: Option<[f64; 2]>,
    /// All greatest torques times this.
    pub torque_scale: Option<f64>,
    /// Point masses on the platform.
    pub loads: Vec<Load>,
}

/// A point mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// kg.
    pub mass: f64,
    /// In the frame of the legs' mounts, m.
    pub at: [f64; 3],
}

impl Changes {
    /// Whether the robot stays as its files have it.
    pub fn is_empty(&self) -> bool {
        *self == Changes::default()
    }

    /// Writes the changes into the files: numbers first, whatever their order, so that motors are stronger and platforms heavier
    /// than these say.
    ///
    /// # Errors
    /// Everything that is not there to be changed, or is to be two things at once; the rest is changed all the same.
    pub fn apply(&self, files: &mut RobotFiles) -> Result<(), String> {
        let durations = self.durations(files);
        // What is wrong with the numbers themselves is told where they are set.
        let (wanted, _) = files.wanted(self.named());
        let clashes = |(_, name, value): &(usize, String, f64)| {
            wanted.get(name).filter(|other| *other != value).map(|other| clash(name, *value, *other))
        };
        let mut faults: Vec<String> = durations.iter().filter_map(clashes).collect();
        faults.sort();
        faults.dedup();
        for (gait, name, value) in durations {
            match spec::set(&files.gaits[gait].text, &name, value) {
                Some(text) => files.gaits[gait].text = text,
                None => faults.push(format!("{} has no number `{name}`", files.gaits[gait].path)),
            }
        }
        faults.extend(files.set_all(self.named().chain(self.limits())).err().into_iter().flatten());
        if let Some(scale) = self.torque_scale {
            let stronger: Vec<_> = torques(files).into_iter().map(|(name, value)| (name, scale * value)).collect();
            let stronger = stronger.iter().map(|(name, value)| (name.as_str(), *value));
            faults.extend(files.set_all(stronger).err().into_iter().flatten());
        }
        // Of files that describe no robot, whoever reads them says more.
        if spec::parse_robot(&files.robot.path, &files.robot.text).is_ok() {
            for Load { mass, at } in &self.loads {
                match spec::load(&files.robot.text, *mass, *at) {
                    Ok(loaded) => files.robot.text = loaded,
                    Err(why) => faults.push(why),
                }
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
    }

    /// Names of all numbers in these files that are not, or need not be, what the files have.
    pub fn names(&self, files: &RobotFiles) -> BTreeSet<String> {
        let named = self.numbers.iter().flat_map(|(name, _)| spec::alternatives(name));
        let limits = self.limits().map(|(name, _)| name.to_string());
        let durations = self.durations(files).into_iter().map(|(_, name, _)| name);
        let torques = self.torque_scale.map(|_| torques(files).into_iter().map(|(name, _)| name));
        let platform =
            spec::parse_robot(&files.robot.path, &files.robot.text).ok().map(|known| known.robot.platform.name);
        let platform = platform.filter(|_| !self.loads.is_empty()).map(|name| format!("links.{name}."));
        let of_platform = |name: &String| platform.as_ref().is_some_and(|platform| name.starts_with(platform));
        let carrying = files.numbers().into_iter().map(|(name, _)| name).filter(of_platform);
        named.chain(limits).chain(durations).chain(torques.into_iter().flatten()).chain(carrying).collect()
    }

    fn named(&self) -> impl Iterator<Item = (&str, f64)> {
        self.numbers.iter().map(|(name, value)| (name.as_str(), *value))
    }

    fn limits(&self) -> impl Iterator<Item = (&str, f64)> {
        let limits = [
            ("limits.friction", self.friction),
            ("limits.swing_clearance", self.swing_clearance),
            ("limits.min_vertical_force", self.min_vertical_force),
            ("limits.min_platform_height", self.min_platform_height),
        ];
        limits.into_iter().filter_map(|(name, value)| Some((name, value?)))
    }

    /// Of half steps, or of all phases in which a foot stands, in every gait: which gait, the number's name, and what it becomes.
    fn durations(&self, files: &RobotFiles) -> Vec<(usize, String, f64)> {
        let Some(duration) = self.duration else { return Vec::new() };
        let of_gait = |(k, gait): (usize, &SpecFile)| {
            let names = spec::numbers(&gait.text).into_iter().map(|number| number.name);
            let on_a_foot = names.filter_map(|name| {
                let (of, end) = name.rsplit_once('.')?;
                let own = of == "limits.half_step_duration" || spec::is_duration_on_a_foot(&gait.text, of);
                let value = duration[usize::from(end == "longest")];
                own.then_some((k, name, value))
            });
            on_a_foot.collect::<Vec<_>>()
        };
        files.gaits.iter().enumerate().flat_map(of_gait).collect()
    }
}

/// Greatest torques of the motors.
fn torques(files: &RobotFiles) -> Vec<(String, f64)> {
    let torque = |name: &str| name.starts_with("actuators.") && name.ends_with(".max_torque");
    files.numbers().into_iter().filter(|(name, _)| torque(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> RobotFiles {
        RobotFiles::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../model-spec").as_ref()).unwrap()
    }

    fn with(changes: &Changes) -> Result<RobotFiles, String> {
        let mut files = files();
        changes.apply(&mut files).map(|()| files)
    }

    fn set(numbers: &[(&str, f64)]) -> Changes {
        let numbers = numbers.iter().map(|(name, value)| (name.to_string(), *value)).collect();
        Changes { numbers, ..Changes::default() }
    }

    /// Whatever is asked for at once, nothing of it is lost.
    #[test]
    fn loads_and_stronger_motors_come_on_top_of_numbers() {
        let numbers = set(&[("links.platform.mass", 8.0), ("actuators.haunch_motor.max_torque", 50.0)]);
        let load = Load { mass: 2.0, at: [0.0; 3] };
        let all = with(&Changes { torque_scale: Some(0.5), loads: vec![load], ..numbers.clone() }).unwrap();
        assert_eq!(all.number("links.platform.mass"), Some(10.0));
        assert_eq!(all.number("actuators.haunch_motor.max_torque"), Some(25.0));
        let alone = with(&Changes { loads: vec![load], ..Changes::default() }).unwrap();
        assert_eq!(alone.number("links.platform.mass"), Some(files().number("links.platform.mass").unwrap() + 2.0));
    }

    #[test]
    fn what_is_to_be_two_things_is_told() {
        let twice =
            set(&[("links.thigh.mass", 1.2), ("links.{thigh,shin}.mass", 1.6), ("gravity", 3.7), ("gravity", 3.7)]);
        let why = with(&Changes { friction: Some(0.1), ..twice.clone() }).unwrap_err();
        assert_eq!(why, "`links.thigh.mass` cannot be both 1.2 and 1.6: give it once");
        let limit = Changes { friction: Some(0.1), ..set(&[("limits.friction", 1.0)]) };
        assert!(with(&limit).unwrap_err().contains("`limits.friction` cannot be both"));
        let name = "limits.half_step_duration.longest";
        let files = files();
        let name = if files.number(name).is_some() { name } else { "phases.1.duration.longest" };
        let duration = Changes { duration: Some([0.1, 0.5]), ..set(&[(name, 0.4)]) };
        assert!(with(&duration).unwrap_err().contains(&format!("`{name}` cannot be both 0.5 and 0.4")));
    }

    #[test]
    fn names_are_of_all_that_changes() {
        let load = Load { mass: 2.0, at: [0.1, 0.0, 0.0] };
        let changes = Changes {
            friction: Some(0.7),
            duration: Some([0.1, 0.5]),
            torque_scale: Some(2.0),
            loads: vec![load],
            ..set(&[("links.{thigh,shin}.mass", 1.3)])
        };
        let (before, after) = (files(), with(&changes).unwrap());
        let names = changes.names(&after);
        for (name, value) in after.numbers() {
            assert!(before.number(&name) == Some(value) || names.contains(&name), "{name} changes unsaid");
        }
    }
}
