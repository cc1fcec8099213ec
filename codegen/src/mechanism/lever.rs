//! What can be changed on the robot: every number of a specification under its name there, and how the numbers of a
//! gait's mechanism follow from it.
//!
//! Where virtual legs share their links the reduction is affine in the robot's numbers, but a gear enters squared,
//! and links that a locked joint joins have a common mass centre. So slopes are taken at the specification's values,
//! by differences that leave rounding only.

use super::parameter::{Place, Sign};
use super::{Actuated, Mechanism, parameter};
use crate::spec::{Gait, Limits, Robot};
use std::fmt::Arguments;

/// A number of the specification.
#[derive(Clone, Debug, PartialEq)]
pub struct Lever {
    /// Where it stands, keys joined by dots.
    pub name: String,
    pub unit: &'static str,
    pub value: f64,
    /// Which of the mechanism's numbers depend on it ([`Mechanism::numbers`], then [`Mechanism::limiting_numbers`]), and how much.
    pub slopes: Vec<(usize, f64)>,
}

/// Step of the differences, as a share of the value.
const STEP: f64 = 1.0 / 1024.0;

/// All numbers that a gait depends on. Both must have passed validation.
pub fn levers(robot: &Robot, gait: &Gait) -> Vec<Lever> {
    let mut named: Vec<(String, &'static str, f64)> = Vec::new();
    // What stands at each place, as a number of the list.
    let mut at = Vec::new();
    places(&mut robot.clone(), &mut gait.limits.clone(), |place| {
        let name = place.name.to_string();
        let known = named.iter().position(|known| known.0 == name);
        at.push(known.unwrap_or(named.len()));
        if known.is_none() {
            named.push((name, place.unit, place.value()));
        }
    });
    let (mut robot, mut gait) = (robot.clone(), gait.clone());
    let lever = |(k, (name, unit, value)): (usize, (String, &'static str, f64))| {
        let set = |robot: &mut Robot, gait: &mut Gait, value: f64| {
            let mut at = at.iter();
            places(robot, &mut gait.limits, |place| {
                if at.next() == Some(&k) {
                    place.set(value);
                }
            });
        };
        let mut numbers = |changed: f64| {
            set(&mut robot, &mut gait, changed);
            let mechanism = robot.locked(&gait.locked).map(|robot| Mechanism::new(&robot, &gait));
            set(&mut robot, &mut gait, value);
            mechanism.ok().map(|m| [m.numbers(), m.limiting_numbers()].concat())
        };
        let size = if value == 0.0 { 1.0 } else { value.abs() };
        let mut difference = |h: f64| -> Option<Vec<f64>> {
            let (above, below) = (numbers(value + h)?, numbers(value - h)?);
            Some(above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h)).collect())
        };
        let (wide, narrow) = (difference(size * STEP)?, difference(size * STEP / 2.0)?);
        let slope = |(wide, narrow): (&f64, &f64)| rounded((4.0 * narrow - wide) / 3.0);
        let slopes = wide.iter().zip(&narrow).map(slope).enumerate().filter(|(_, slope)| *slope != 0.0).collect();
        Some(Lever { name, unit, value, slopes })
    };
    named.into_iter().enumerate().filter_map(lever).filter(|lever| !lever.slopes.is_empty()).collect()
}

/// To the digits that differences can give; what cancels to rounding is zero.
fn rounded(slope: f64) -> f64 {
    if slope == 0.0 {
        return 0.0;
    }
    let rounded = format!("{slope:.10e}").parse().unwrap_or(slope);
    if f64::abs(rounded) < 1e-12 { 0.0 } else { rounded }
}

impl Mechanism {
    /// Numbers that only limit: of each joint its range, greatest torque and speed limits; then the gait's limits.
    pub fn limiting_numbers(&self) -> Vec<f64> {
        let of_joint = |j: &Actuated| [j.range[0], j.range[1], j.max_torque, j.unloaded_speed, j.loaded_speed];
        let l = &self.limits;
        let [shortest, longest] = l.half_step_duration;
        let of_gait = [l.friction, l.min_vertical_force, l.swing_clearance, shortest, longest, l.min_platform_height];
        self.joints.iter().flat_map(of_joint).chain(of_gait).collect()
    }
}

/// Visits all numbers of a specification: those of the robot, then what only limits.
fn places(robot: &mut Robot, limits: &mut Limits, mut visit: impl FnMut(Place)) {
    parameter::places(robot, &mut visit);
    let mut add = |name: Arguments, unit, number: &mut f64| {
        visit(Place { name, unit, sign: Sign::Any, negative: false, number });
    };
    for segment in robot.legs.iter_mut().flat_map(|leg| &mut leg.chain) {
        let joint = &mut segment.joint;
        let ([lower, upper], name) = (&mut joint.range, &joint.name);
        add(format_args!("joints.{name}.range.lower"), "rad", lower);
        add(format_args!("joints.{name}.range.upper"), "rad", upper);
        let motor = &mut joint.actuator;
        let name = &motor.name;
        add(format_args!("actuators.{name}.gear"), "", &mut motor.gear);
        add(format_args!("actuators.{name}.max_torque"), "N·m", &mut motor.max_torque);
        add(format_args!("actuators.{name}.max_speed.unloaded"), "rev/min", &mut motor.unloaded_speed);
        add(format_args!("actuators.{name}.max_speed.at_max_torque"), "rev/min", &mut motor.loaded_speed);
    }
    let [shortest, longest] = &mut limits.half_step_duration;
    add(format_args!("limits.friction"), "", &mut limits.friction);
    add(format_args!("limits.min_vertical_force"), "N", &mut limits.min_vertical_force);
    add(format_args!("limits.swing_clearance"), "m", &mut limits.swing_clearance);
    add(format_args!("limits.half_step_duration.shortest"), "s", shortest);
    add(format_args!("limits.half_step_duration.longest"), "s", longest);
    add(format_args!("limits.min_platform_height"), "m", &mut limits.min_platform_height);
}
