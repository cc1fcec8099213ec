//! What can be changed on the robot: every number of a specification under its name there, and how the numbers of a
//! gait's mechanism follow from it.
//!
//! Where virtual legs share their links the reduction is affine in the robot's numbers, but a gear enters squared,
//! and links that a locked joint joins have a common mass centre. So slopes are taken at the specification's values,
//! by differences that leave rounding only.

use super::parameter::{parameters, with};
use super::{Actuated, Mechanism};
use crate::spec::{Gait, Limits, Robot};

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
    let physical: Vec<_> = parameters(robot).into_iter().map(|p| (p.name, p.unit, p.value)).collect();
    let numbers = |name: &str, value: f64| {
        let mut gait = gait.clone();
        let robot = if physical.iter().any(|known| known.0 == name) {
            with(robot, |other| (other == name).then_some(value))
        } else {
            let mut robot = robot.clone();
            let places = places(&mut robot, &mut gait.limits).into_iter().filter(|place| place.0 == name);
            places.for_each(|(_, _, number)| *number = value);
            robot
        };
        let robot = robot.locked(&gait.locked).ok()?;
        let mechanism = Mechanism::new(&robot, &gait);
        Some([mechanism.numbers(), mechanism.limiting_numbers()].concat())
    };
    let mut named: Vec<(String, &'static str, f64)> = physical.clone();
    for (name, unit, number) in places(&mut robot.clone(), &mut gait.limits.clone()) {
        if named.iter().all(|known| known.0 != name) {
            named.push((name, unit, *number));
        }
    }
    let lever = |(name, unit, value): (String, &'static str, f64)| {
        let size = if value == 0.0 { 1.0 } else { value.abs() };
        let difference = |h: f64| -> Option<Vec<f64>> {
            let (above, below) = (numbers(&name, value + h)?, numbers(&name, value - h)?);
            Some(above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h)).collect())
        };
        let (wide, narrow) = (difference(size * STEP)?, difference(size * STEP / 2.0)?);
        let slope = |(wide, narrow): (&f64, &f64)| rounded((4.0 * narrow - wide) / 3.0);
        let slopes = wide.iter().zip(&narrow).map(slope).enumerate().filter(|(_, slope)| *slope != 0.0).collect();
        Some(Lever { name, unit, value, slopes })
    };
    named.into_iter().filter_map(lever).filter(|lever| !lever.slopes.is_empty()).collect()
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

/// Where the specification has limits: name, unit, number.
fn places<'s>(robot: &'s mut Robot, limits: &'s mut Limits) -> Vec<(String, &'static str, &'s mut f64)> {
    let mut places = Vec::new();
    for segment in robot.legs.iter_mut().flat_map(|leg| &mut leg.chain) {
        let joint = &mut segment.joint;
        let [lower, upper] = &mut joint.range;
        places.push((format!("joints.{}.range.lower", joint.name), "rad", lower));
        places.push((format!("joints.{}.range.upper", joint.name), "rad", upper));
        let motor = &mut joint.actuator;
        let name = |key: &str| format!("actuators.{}.{key}", motor.name);
        places.push((name("gear"), "", &mut motor.gear));
        places.push((name("max_torque"), "N·m", &mut motor.max_torque));
        places.push((name("max_speed.unloaded"), "rev/min", &mut motor.unloaded_speed));
        places.push((name("max_speed.at_max_torque"), "rev/min", &mut motor.loaded_speed));
    }
    let [shortest, longest] = &mut limits.half_step_duration;
    places.extend([
        ("limits.friction".into(), "", &mut limits.friction),
        ("limits.min_vertical_force".into(), "N", &mut limits.min_vertical_force),
        ("limits.swing_clearance".into(), "m", &mut limits.swing_clearance),
        ("limits.half_step_duration.shortest".into(), "s", shortest),
        ("limits.half_step_duration.longest".into(), "s", longest),
        ("limits.min_platform_height".into(), "m", &mut limits.min_platform_height),
    ]);
    places
}
