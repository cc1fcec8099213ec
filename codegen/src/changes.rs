//! What is asked for beside a robot's files, for one run: other numbers, other limits, stronger motors, a load. It is written into
//! the files, so that what comes of them says it.

use crate::RobotFiles;
use crate::spec;

/// Changes to a robot and its gaits; none unless they are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Numbers by their names, in the order in which they are set.
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

    /// Writes the changes into the files. Numbers that are named come last, and have the last word.
    ///
    /// # Errors
    /// Everything that is not there to be changed.
    pub fn apply(&self, files: &mut RobotFiles) -> Result<(), String> {
        let mut missing = Vec::new();
        let limits = [
            ("friction", self.friction),
            ("swing_clearance", self.swing_clearance),
            ("min_vertical_force", self.min_vertical_force),
            ("min_platform_height", self.min_platform_height),
        ];
        for (limit, value) in limits {
            missing.extend(value.and_then(|value| files.set(&format!("limits.{limit}"), value).err()));
        }
        if let Some(duration) = self.duration {
            missing.extend(self.set_durations(files, duration).err());
        }
        if let Some(scale) = self.torque_scale {
            let torque = |name: &str| name.starts_with("actuators.") && name.ends_with(".max_torque");
            for (name, value) in files.numbers().into_iter().filter(|(name, _)| torque(name)) {
                missing.extend(files.set(&name, scale * value).err());
            }
        }
        for Load { mass, at } in &self.loads {
            match spec::load(&files.robot.text, *mass, *at) {
                Ok(loaded) => files.robot.text = loaded,
                Err(why) => missing.push(why),
            }
        }
        missing.extend(self.numbers.iter().filter_map(|(name, value)| files.set(name, *value).err()));
        if missing.is_empty() { Ok(()) } else { Err(missing.join("\n")) }
    }

    /// Of half steps, or of all phases in which a foot stands, in every gait.
    fn set_durations(&self, files: &mut RobotFiles, duration: [f64; 2]) -> Result<(), String> {
        for gait in &mut files.gaits {
            for name in spec::numbers(&gait.text).into_iter().map(|number| number.name) {
                let Some((of, end)) = name.rsplit_once('.') else { continue };
                if of != "limits.half_step_duration" && !spec::is_duration_on_a_foot(&gait.text, of) {
                    continue;
                }
                let value = duration[usize::from(end == "longest")];
                gait.text = spec::set(&gait.text, &name, value)
                    .ok_or_else(|| format!("{} has no number `{name}`", gait.path))?;
            }
        }
        Ok(())
    }
}
