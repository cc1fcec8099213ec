//! Robots and their gaits.

use crate::error::{Error, SpecificationError};
use crate::work::{Stop, apart, work};
use piaffe::import::{Direction, FootPoint, Lock, Options, Setting, Stops, import};
use piaffe::interpreter::{Interpreted, Unloadable};
use piaffe::model::Gait as _;
use piaffe::model::digits::digits;
use piaffe_codegen::{Changes, Load, RobotFiles, SpecFile, spec};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Entries of a dictionary, in its order.
fn entries<'py, T: FromPyObjectOwned<'py>>(given: &Bound<'py, PyMapping>) -> PyResult<Vec<(String, T)>> {
    given.items()?.iter().map(|item| item.extract()).collect()
}

/// Names alone, or with what belongs to them.
fn named<'py, T: FromPyObjectOwned<'py>>(given: Option<&Bound<'py, PyAny>>) -> PyResult<Vec<(String, Option<T>)>> {
    match given.map(|given| (given, given.cast::<PyMapping>())) {
        None => Ok(Vec::new()),
        Some((_, Ok(mapping))) => entries(mapping),
        Some((names, Err(_))) => Ok(names.extract::<Vec<String>>()?.into_iter().map(|name| (name, None)).collect()),
    }
}

/// A number for all joints that have none, or those of some; by a gear of nothing no motor turns a joint.
fn settings(option: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Setting>> {
    let setting = |joint, value: f64| match option {
        "gear" if !(value.is_finite() && value > 0.0) => {
            Err(Error::new_err(format!("`{option}` is {}: give a positive number", digits(value))))
        }
        _ if !(value.is_finite() && value >= 0.0) => {
            Err(Error::new_err(format!("`{option}` is {}: give a number that is not negative", digits(value))))
        }
        _ => Ok(Setting { joint, value }),
    };
    match given.map(|given| (given, given.cast::<PyMapping>())) {
        None => Ok(Vec::new()),
        Some((_, Ok(each))) => entries(each)?.into_iter().map(|(joint, value)| setting(Some(joint), value)).collect(),
        Some((all, Err(_))) => Ok(vec![setting(None, all.extract()?)?]),
    }
}

fn direction(option: &str, axis: Option<String>) -> PyResult<Option<Direction>> {
    let read = |axis: String| axis.parse().map_err(|why| Error::new_err(format!("`{option}` is \"{axis}\": it {why}")));
    axis.map(read).transpose()
}

pub fn unloadable(why: Unloadable) -> PyErr {
    match why {
        Unloadable::NoGait { .. } => Error::new_err(why.to_string()),
        Unloadable::Specification(_) | Unloadable::Gait { .. } => SpecificationError::new_err(why.to_string()),
    }
}

/// A robot as its files describe it: `Robot(robot, gaits)` with the text of `robot.toml` and those of the gaits by name.
///
/// Robots do not change; they are equal if their files are, and travel to other processes.
#[pyclass(frozen, module = "piaffe")]
#[derive(Clone)]
pub struct Robot {
    robot: piaffe::Robot,
    notes: Vec<String>,
}

impl Robot {
    pub fn of(files: RobotFiles, notes: Vec<String>) -> PyResult<Robot> {
        let files = RobotFiles { module: String::new(), ..files };
        Ok(Robot { robot: piaffe::Robot::new(files).map_err(unloadable)?, notes })
    }

    pub fn robot(&self) -> &piaffe::Robot {
        &self.robot
    }

    fn texts(&self) -> (&str, BTreeMap<String, &str>) {
        let files = self.robot.files();
        let gaits = self.robot.gaits().into_iter().zip(files.gaits.iter().map(|file| &*file.text));
        (&files.robot.text, gaits.collect())
    }
}

#[pymethods]
impl Robot {
    #[new]
    #[pyo3(signature = (robot, gaits, notes = Vec::new()))]
    fn new(robot: String, gaits: BTreeMap<String, String>, notes: Vec<String>) -> PyResult<Robot> {
        let gaits = gaits.into_iter().map(|(name, text)| SpecFile { path: format!("{name}.toml"), text }).collect();
        let robot = SpecFile { path: "robot.toml".into(), text: robot };
        Robot::of(RobotFiles { module: String::new(), robot, gaits }, notes)
    }

    /// The robot of a folder with `robot.toml` and `gaits/*.toml`.
    #[staticmethod]
    fn from_toml(folder: PathBuf) -> PyResult<Robot> {
        let files = RobotFiles::read(&folder).map_err(|why| match folder.is_dir() {
            true => SpecificationError::new_err(why),
            false => PyOSError::new_err(why),
        })?;
        Robot::of(files, Vec::new())
    }

    /// The robot of a URDF or MJCF. What the file does not say is given, or assumed and told in `notes`.
    ///
    /// `lock` names joints that are held still (arms, heads), or gives each an angle of the file, rad; `*` and `?` match several,
    /// a `/` at the end all joints below too. `foot` names links that touch the ground, or gives each the point of it that does,
    /// m. `effort` (N·m), `velocity` (rad/s), `gear` (motor turns per turn of the joint) and `rotor` (kg·m² at the motor) are
    /// numbers for all joints that have none, or by joint. `range` has stops by joint, rad. `forward` and `up` are axes of the root
    /// link, such as "-y". Legs that differ by no more than the share `alike` are made alike. `mend` takes the nearest possible
    /// inertia also where the file would be refused for one that no body has. With `tried`, the gaits are those that the robot can do, which takes seconds;
    /// else those that legs like these have.
    #[staticmethod]
    #[pyo3(signature = (
        path, *, lock = None, foot = None, effort = None, velocity = None, gear = None, rotor = None, range = None, forward = None,
        up = None, alike = 1e-3, mend = false, tried = true
    ))]
    #[allow(clippy::too_many_arguments)]
    fn from_urdf(
        py: Python<'_>,
        path: PathBuf,
        lock: Option<&Bound<'_, PyAny>>,
        foot: Option<&Bound<'_, PyAny>>,
        effort: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        gear: Option<&Bound<'_, PyAny>>,
        rotor: Option<&Bound<'_, PyAny>>,
        range: Option<&Bound<'_, PyMapping>>,
        forward: Option<String>,
        up: Option<String>,
        alike: f64,
        mend: bool,
        tried: bool,
    ) -> PyResult<Robot> {
        if !(0.0..=0.5).contains(&alike) {
            return Err(Error::new_err(format!("`alike` is {}, and must be between 0 and 0.5", digits(alike))));
        }
        let ranges: Vec<(String, [f64; 2])> = range.map(entries).transpose()?.unwrap_or_default();
        if let Some((joint, [low, high])) =
            ranges.iter().find(|(_, [low, high])| low.is_nan() || high.is_nan() || low >= high)
        {
            return Err(Error::new_err(format!(
                "`range` of {joint} is [{low:?}, {high:?}]: give the lower stop first, rad"
            )));
        }
        let options = Options {
            locks: named(lock)?.into_iter().map(|(pattern, angle)| Lock { pattern, angle }).collect(),
            feet: named::<[f64; 3]>(foot)?
                .into_iter()
                .map(|(link, at)| FootPoint { link, point: at.map(From::from) })
                .collect(),
            efforts: settings("effort", effort)?,
            velocities: settings("velocity", velocity)?,
            gears: settings("gear", gear)?,
            rotors: settings("rotor", rotor)?,
            ranges: ranges.into_iter().map(|(joint, range)| Stops { joint, range }).collect(),
            forward: direction("forward", forward)?,
            up: direction("up", up)?,
            alike,
            mend,
        };
        let name = path.display();
        let text =
            std::fs::read_to_string(&path).map_err(|why| PyOSError::new_err(format!("cannot read {name}: {why}")))?;
        let made = import(&text, &options)
            .map_err(|faults| SpecificationError::new_err(format!("cannot import {name}: {faults}")))?;
        let made = match tried {
            true => work(py, None, Stop::default(), |stop| made.tried(&|_| !stop.is_wanted()))?,
            false => made,
        };
        let gaits = made.gaits.into_iter().map(|(path, text)| SpecFile { path, text }).collect();
        let robot = SpecFile { path: "robot.toml".into(), text: made.robot };
        Robot::of(RobotFiles { module: String::new(), robot, gaits }, made.notes)
    }

    /// As the specification calls it.
    #[getter]
    fn name(&self) -> String {
        self.robot.name().into()
    }

    /// Names of its gaits.
    #[getter]
    fn gaits(&self) -> Vec<String> {
        self.robot.gaits()
    }

    /// Names of those that a study asks about where none is named: those that never leave the ground; where all fly, all.
    #[getter]
    fn usual_gaits(&self) -> Vec<String> {
        self.robot.usual_gaits()
    }

    /// What an import took, assumed and dropped, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The specification: paths in the robot's folder, and their texts.
    #[getter]
    fn files(&self) -> BTreeMap<String, &str> {
        let (robot, gaits) = self.texts();
        let gaits = gaits.into_iter().map(|(name, text)| (format!("gaits/{name}.toml"), text));
        gaits.chain([("robot.toml".into(), robot)]).collect()
    }

    /// The numbers of the specification, by the names with which `set` changes them. Those that are not the same in all gaits are not
    /// the robot's: `differing` has them, and `Gait.numbers` those of one gait.
    #[getter]
    fn numbers(&self) -> BTreeMap<String, f64> {
        let differing = self.differing();
        let all = self.robot.files().numbers().into_iter();
        all.filter(|(name, _)| !differing.contains_key(name)).collect()
    }

    /// Numbers that are not the same in all gaits that have them: each with its value by gait. `set` gives all gaits one.
    #[getter]
    fn differing(&self) -> BTreeMap<String, BTreeMap<String, f64>> {
        let mut by_name: BTreeMap<String, BTreeMap<String, f64>> = BTreeMap::new();
        let (_, gaits) = self.texts();
        for (gait, text) in &gaits {
            for number in spec::numbers(text) {
                by_name.entry(number.name).or_default().insert(gait.clone(), number.value);
            }
        }
        for (name, values) in &mut by_name {
            // What a gait does not say, it means.
            let Some(default) = spec::default_of(name).and_then(|default| default.parse().ok()) else { continue };
            for gait in gaits.keys() {
                values.entry(gait.clone()).or_insert(default);
            }
        }
        by_name.retain(|_, values| values.values().any(|value| values.values().next() != Some(value)));
        by_name
    }

    /// What is wrong with these names, if they are to be those of numbers.
    fn unknown(&self, names: Vec<String>) -> Vec<String> {
        let files = self.robot.files();
        // Any number will do: none is used.
        names.iter().filter_map(|name| files.clone().set(name, 1.0).err()).collect()
    }

    /// Derives a gait: 30 to 170 ms for those that are shipped.
    fn gait(&self, py: Python<'_>, name: &str) -> PyResult<Gait> {
        Gait::new(py, self, name)
    }

    /// The same robot with other numbers, by the keys that lead to them: `{"links.thigh.mass": 1.2, "limits.friction": 0.8}`.
    fn set(&self, numbers: BTreeMap<String, f64>) -> PyResult<Robot> {
        let numbers = numbers.iter().map(|(name, value)| (name.as_str(), *value));
        Ok(Robot { robot: self.robot.with_all(numbers).map_err(unloadable)?, notes: self.notes.clone() })
    }

    /// The robot with a point mass (kg) on its platform, at a point in the frame of the legs' mounts (forward, up, right), m.
    fn loaded(&self, mass: f64, at: [f64; 3]) -> PyResult<Robot> {
        if !(mass.is_finite() && mass > 0.0 && at.iter().all(|x| x.is_finite())) {
            return Err(Error::new_err(format!("a load of {mass:?} kg at {at:?}: give a positive mass and a point")));
        }
        let changes = Changes { loads: vec![Load { mass, at }], ..Changes::default() };
        Ok(Robot { robot: self.robot.changed(&changes).map_err(unloadable)?, notes: self.notes.clone() })
    }

    fn __getnewargs__(&self) -> (&str, BTreeMap<String, &str>, Vec<String>) {
        let (robot, gaits) = self.texts();
        (robot, gaits, self.notes.clone())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Robot>().is_ok_and(|other| self.texts() == other.get().texts())
    }

    fn __hash__(&self) -> u64 {
        piaffe::model::hash(&format!("{:?}", self.texts()))
    }

    fn __repr__(&self) -> String {
        format!("<piaffe.Robot {}: {}>", self.name(), self.gaits().join(", "))
    }
}

/// A gait of a robot, with its dynamics derived.
///
/// It does not change, and is derived anew where it arrives in another process.
#[pyclass(frozen, module = "piaffe")]
#[derive(Clone)]
pub struct Gait {
    robot: Robot,
    name: String,
    derived: Arc<Interpreted>,
}

impl Gait {
    pub fn derived(&self) -> Arc<Interpreted> {
        self.derived.clone()
    }
}

#[pymethods]
impl Gait {
    #[new]
    fn new(py: Python<'_>, robot: &Robot, name: &str) -> PyResult<Gait> {
        let derived = apart(py, || robot.robot.gait(name))?.map_err(unloadable)?;
        Ok(Gait { robot: robot.clone(), name: name.into(), derived: Arc::new(derived) })
    }

    /// As its robot calls it.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn robot(&self) -> Robot {
        self.robot.clone()
    }

    /// The same gait of the robot with other numbers: `Robot.set`.
    fn set(&self, py: Python<'_>, numbers: BTreeMap<String, f64>) -> PyResult<Gait> {
        self.robot.set(numbers)?.gait(py, &self.name)
    }

    /// The numbers of its specification, the robot's and its own, by the names with which `set` changes them.
    #[getter]
    fn numbers(&self) -> BTreeMap<String, f64> {
        let (robot, gaits) = self.robot.texts();
        let own = gaits.get(&self.name).copied().unwrap_or_default();
        [robot, own].into_iter().flat_map(spec::numbers).map(|number| (number.name, number.value)).collect()
    }

    /// The numbers on which it depends, with their units. Those that must stay alike have one name, what differs in braces.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<BTreeMap<&'static str, (f64, &'static str)>> {
        let levers = apart(py, || self.derived.levers())?;
        Ok(levers.iter().map(|lever| (lever.name, (lever.value, lever.unit))).collect())
    }

    fn __getnewargs__(&self) -> (Robot, &str) {
        (self.robot.clone(), &self.name)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let texts = |gait: &Gait| gait.robot.robot.specification(&gait.name);
        other.cast::<Gait>().is_ok_and(|other| self.name == other.get().name && texts(self) == texts(other.get()))
    }

    fn __hash__(&self) -> u64 {
        piaffe::model::hash(&self.derived.description().fingerprint())
    }

    fn __repr__(&self) -> String {
        format!("<piaffe.Gait {} of {}>", self.name, self.derived.description().robot)
    }
}
