//! The physical numbers of the real robot under their names in the specification: `links.thigh.mass`.
//!
//! Their names are those under which they stand in the robot's file and can be set there. In a family numbers that the
//! specification makes equal stay one: a link that several legs share is one link, and mounts at the same distance to either
//! side are one distance, so that a symmetric robot stays symmetric. What is zero by geometry (a mount in the plane of the
//! others, a mass centre on its link's axis) stays zero there.

use crate::spec::{Inertia, Leg, Robot};
use std::fmt::Arguments;

/// A number of the real robot that can stay symbolic.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Where it stands in the specification, keys joined by dots.
    pub name: String,
    pub unit: &'static str,
    /// What the specification says.
    pub value: f64,
    pub sign: Sign,
}

/// Which values make sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Any,
    NonNegative,
    Positive,
}

/// A place in the robot's description that holds `±` a parameter. Most visitors need no name, so it is not written out.
pub struct Place<'r> {
    pub name: Arguments<'r>,
    /// What a family calls it, where that is another place.
    pub shared: Arguments<'r>,
    /// Whether that is minus this.
    pub opposite: bool,
    pub unit: &'static str,
    pub sign: Sign,
    /// The parameter is minus what stands there.
    pub negative: bool,
    pub number: &'r mut f64,
}

impl<'r> Place<'r> {
    pub fn new(name: Arguments<'r>, unit: &'static str, sign: Sign, negative: bool, number: &'r mut f64) -> Place<'r> {
        Place { name, shared: name, opposite: false, unit, sign, negative, number }
    }

    pub fn value(&self) -> f64 {
        if self.negative { -*self.number } else { *self.number }
    }

    pub fn set(self, value: f64) {
        *self.number = if self.negative { -value } else { value };
    }
}

/// All parameters of a robot, in the order in which the specification's tables are read.
pub fn parameters(robot: &Robot) -> Vec<Parameter> {
    let mut found: Vec<Parameter> = Vec::new();
    places(&mut robot.clone(), |place| {
        let name = place.shared.to_string();
        let stays_zero = place.value() == 0.0 && (place.sign == Sign::Any || !robot.written.contains(&name));
        if !stays_zero && found.iter().all(|p| p.name != name) {
            found.push(Parameter { name, unit: place.unit, value: place.value(), sign: place.sign });
        }
    });
    found
}

/// The parameters that `patterns` name: by their full names, or by tables such as `links.thigh`.
///
/// # Errors
/// If a pattern names none.
pub fn select(robot: &Robot, patterns: &[String]) -> Result<Vec<Parameter>, String> {
    let all = parameters(robot);
    let names = |parameter: &Parameter, pattern: &String| {
        parameter.name.strip_prefix(pattern.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    if let Some(pattern) = patterns.iter().find(|pattern| !all.iter().any(|p| names(p, pattern))) {
        let known: Vec<&str> = all.iter().map(|p| p.name.as_str()).collect();
        return Err(format!("the robot has no parameter `{pattern}`; it has {}", known.join(", ")));
    }
    Ok(all.into_iter().filter(|p| patterns.iter().any(|pattern| names(p, pattern))).collect())
}

/// The robot with the numbers for which `value` has one.
pub fn with(robot: &Robot, value: impl Fn(&str) -> Option<f64>) -> Robot {
    let mut changed = robot.clone();
    places(&mut changed, |place| {
        if let Some(value) = value(&place.shared.to_string()) {
            let value = if place.opposite { -value } else { value };
            place.set(value);
        }
    });
    changed
}

/// Visits all places, in the order in which the specification's tables are read, what is zero too.
pub fn places(robot: &mut Robot, mut visit: impl FnMut(Place)) {
    let names: Vec<String> = robot.legs.iter().map(|leg| leg.name.clone()).collect();
    let written = robot.written.clone();
    let mounts: Vec<_> = robot.legs.iter().map(|leg| [0, 1, 2].map(|k| shared_mount(&robot.legs, leg, k))).collect();
    let xyz = ["x", "y", "z"];
    visit(Place::new(format_args!("gravity"), "m/s²", Sign::Positive, false, &mut robot.gravity));
    let platform = &mut robot.platform;
    let name = &platform.name;
    visit(Place::new(format_args!("links.{name}.mass"), "kg", Sign::Positive, false, &mut platform.mass));
    for (number, axis) in platform.com.iter_mut().zip(xyz) {
        visit(Place::new(format_args!("links.{name}.com.{axis}"), "m", Sign::Any, false, number));
    }
    inertia(name, ["roll", "yaw", "pitch"], &mut platform.inertia, &mut visit);
    if let Some(extent) = &mut platform.extent {
        for (number, axis) in extent.size.iter_mut().zip(xyz) {
            let name = format_args!("links.{name}.extent.size.{axis}");
            visit(Place::new(name, "m", Sign::NonNegative, false, number));
        }
        for (number, axis) in extent.centre.iter_mut().zip(xyz) {
            visit(Place::new(format_args!("links.{name}.extent.centre.{axis}"), "m", Sign::Any, false, number));
        }
    }
    for (leg, mounts) in robot.legs.iter_mut().zip(mounts) {
        for ((number, mount), axis) in leg.mount.iter_mut().zip(mounts).zip(xyz) {
            let (first, opposite) = mount;
            let (name, shared) = (&leg.name, &names[first]);
            let name = format_args!("legs.{name}.mount.{axis}");
            let shared = format_args!("legs.{shared}.mount.{axis}");
            visit(Place { shared, opposite, ..Place::new(name, "m", Sign::Any, false, number) });
        }
        for segment in &mut leg.chain {
            let link = &mut segment.link;
            let name = &link.name;
            visit(Place::new(format_args!("links.{name}.mass"), "kg", Sign::Positive, false, &mut link.mass));
            for (key, sign, place) in [("length", Sign::Positive, &mut link.end), ("com", Sign::Any, &mut link.com)] {
                // Written as a distance along the link's axis.
                if written.contains(&format!("links.{name}.{key}")) {
                    visit(Place::new(format_args!("links.{name}.{key}"), "m", sign, true, &mut place[1]));
                    continue;
                }
                for (number, axis) in place.iter_mut().zip(xyz) {
                    visit(Place::new(format_args!("links.{name}.{key}.{axis}"), "m", Sign::Any, false, number));
                }
            }
            inertia(name, ["lateral", "axial", "swing"], &mut link.inertia, &mut visit);
            let foot = format_args!("links.{name}.foot_mass");
            visit(Place::new(foot, "kg", Sign::NonNegative, false, &mut link.foot_mass));
            let actuator = &mut segment.joint.actuator;
            let name = format_args!("actuators.{}.rotor_inertia", actuator.name);
            visit(Place::new(name, "kg·m²", Sign::NonNegative, false, &mut actuator.rotor_inertia));
        }
    }
}

/// Moments and products under their names in the specification.
fn inertia(link: &str, moments: [&str; 3], tensor: &mut Inertia, visit: &mut impl FnMut(Place)) {
    for (i, number) in tensor.as_flattened_mut().iter_mut().enumerate() {
        let (row, column) = (i / 3, i % 3);
        if row == column {
            let name = format_args!("links.{link}.inertia.{}", moments[row]);
            visit(Place::new(name, "kg·m²", Sign::NonNegative, false, number));
        } else {
            // Minus the product stands on either side of the diagonal.
            let axes = ["yz", "zx", "xy"][3 - row - column];
            visit(Place::new(format_args!("links.{link}.inertia.products.{axes}"), "kg·m²", Sign::Any, true, number));
        }
    }
}

/// Component `k` of a leg's mount: the first leg that is as far out, and whether this one is on the other side.
fn shared_mount(legs: &[Leg], leg: &Leg, k: usize) -> (usize, bool) {
    let number = leg.mount[k];
    let first = legs.iter().position(|other| other.mount[k].abs() == number.abs()).unwrap_or_default();
    (first, legs[first].mount[k] != number)
}
