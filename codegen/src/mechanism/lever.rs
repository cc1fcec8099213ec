//! What can be changed on the robot: the numbers of a specification under their names there, and how the numbers of a gait's
//! mechanism follow from them.
//!
//! Legs that a gait moves as one, or that mirror each other in it, must stay alike: a calf that is longer than the other three
//! makes no robot that can walk so. So the numbers that these legs have in the same place are one lever ([`Lever::numbers`]), which
//! changes all of them by the same share; those of them that are zero are another one, which changes them by as much.
//!
//! Where virtual legs share their links the mechanism's numbers are affine in the robot's, but a gear enters squared,
//! and links that a locked joint joins have a common mass centre. So slopes are taken at the specification's values,
//! by differences that leave rounding only.

use super::parameter::{Place, Sign};
use super::{Actuated, Mechanism, parameter};
use crate::spec::{Axis, Gait, Leg, Robot, Rotation, Spring, Then};
use std::collections::BTreeSet;
use std::fmt::Arguments;

/// Numbers of the specification that change together.
#[derive(Clone, Debug, PartialEq)]
pub struct Lever {
    /// Where they stand, keys joined by dots, and what differs between them in braces: `links.{left_shin,right_shin}.mass`.
    pub name: String,
    /// Each of them.
    pub numbers: Vec<String>,
    pub unit: &'static str,
    /// Of the first.
    pub value: f64,
    /// Which of the mechanism's numbers depend on it ([`Mechanism::numbers`], then [`Mechanism::limiting_numbers`]), and how much.
    pub slopes: Vec<(usize, f64)>,
}

/// Step of the differences, as a share of the value.
const STEP: f64 = 1.0 / 1024.0;

/// A number that changes by less than this share of its natural size, when a value doubles, has cancelled to rounding.
const CANCELLED: f64 = 1e-11;

/// A number of the specification.
struct Number {
    name: String,
    unit: &'static str,
    value: f64,
}

/// All levers of a gait on which its mechanism depends. Both must have passed validation.
pub fn levers(robot: &Robot, gait: &Gait) -> Vec<Lever> {
    let numbers = numbers(robot, gait);
    let lever = |group: Vec<&Number>| {
        let first = group.first()?;
        let names: Vec<String> = group.iter().map(|number| number.name.clone()).collect();
        let mut lever =
            Lever { name: braced(&names), numbers: names, unit: first.unit, value: first.value, slopes: Vec::new() };
        lever.slopes = lever.slopes(robot, gait)?;
        (!lever.slopes.is_empty()).then_some(lever)
    };
    let centre = format!("links.{}.com.z", robot.platform.name);
    let in_the_middle = |number: &&Number| number.name == centre || number.name.ends_with(".mount.z");
    let groups = tied(&numbers, robot, gait).into_iter().flat_map(|group| {
        let (some, zero): (Vec<_>, Vec<_>) = group.into_iter().partition(|number| number.value != 0.0);
        // What is in the middle between mirror images stays there.
        let stays = !some.is_empty() && zero.iter().any(in_the_middle);
        [some, if stays { Vec::new() } else { zero }]
    });
    groups.filter_map(lever).collect()
}

impl Lever {
    /// Robot and gait with a value that is greater by `by`.
    pub fn moved(&self, robot: &Robot, gait: &Gait, by: f64) -> (Robot, Gait) {
        let sides = Sides::new(robot);
        let (mut robot, mut gait) = (robot.clone(), gait.clone());
        places(&mut robot, &mut gait, |place| {
            let own = place.name.to_string();
            if self.numbers.contains(&own) {
                let value = place.value();
                let change = if self.value == 0.0 {
                    by * sides.of(&own) * sides.of(&self.numbers[0])
                } else {
                    by * value / self.value
                };
                place.set(value + change);
            }
        });
        (robot, gait)
    }

    fn slopes(&self, robot: &Robot, gait: &Gait) -> Option<Vec<(usize, f64)>> {
        let numbers = |by: f64| {
            let (robot, gait) = self.moved(robot, gait, by);
            let mechanism = robot.locked(&gait.locked).map(|robot| Mechanism::new(&robot, &gait));
            mechanism.ok().map(|m| [m.numbers(), m.limiting_numbers()].concat())
        };
        let mechanism = robot.locked(&gait.locked).map(|robot| Mechanism::new(&robot, gait)).ok()?;
        let ((mass, length), sizes) = (mechanism.size(), mechanism.sizes());
        // A step from zero is one of the robot's size.
        let natural = match self.unit {
            "m" => length,
            // A foot's, beside which its link must not weigh nothing.
            "kg" => lightest(robot),
            "kg·m²" => mass * length * length,
            "N" => mass * mechanism.gravity,
            _ => 1.0,
        };
        let size = if self.value == 0.0 { natural } else { self.value.abs() };
        let difference = |h: f64| -> Option<Vec<f64>> {
            let (above, below) = (numbers(h)?, numbers(-h)?);
            Some(above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h)).collect())
        };
        let (wide, narrow) = (difference(size * STEP)?, difference(size * STEP / 2.0)?);
        let slope = |(wide, narrow): (&f64, &f64)| rounded((4.0 * narrow - wide) / 3.0);
        // What only limits follows from one number each, and cancels nothing.
        let rounding = |k: usize| sizes.get(k).map_or(0.0, |natural| CANCELLED * natural / size);
        let slopes = wide.iter().zip(&narrow).map(slope).enumerate();
        Some(slopes.filter(|(k, slope)| *slope != 0.0 && slope.abs() >= rounding(*k)).collect())
    }
}

/// The mass of the lightest link of a leg, kg.
fn lightest(robot: &Robot) -> f64 {
    let links = robot.legs.iter().flat_map(|leg| &leg.chain).map(|segment| segment.link.mass);
    links.fold(f64::INFINITY, f64::min)
}

/// All numbers of a specification that are not zero, those that are written there as zeros, and limits.
fn numbers(robot: &Robot, gait: &Gait) -> Vec<Number> {
    let (mut numbers, mut known) = (Vec::new(), BTreeSet::new());
    places(&mut robot.clone(), &mut gait.clone(), |place| {
        let name = place.name.to_string();
        let stands = place.value() != 0.0 || robot.written.contains(&name) || name.starts_with("limits.");
        if stands && known.insert(name.clone()) {
            numbers.push(Number { name, unit: place.unit, value: place.value() });
        }
    });
    numbers
}

/// The numbers in groups that stay alike, in the order of their first ones.
fn tied<'n>(numbers: &'n [Number], robot: &Robot, gait: &Gait) -> Vec<Vec<&'n Number>> {
    let mut group: Vec<usize> = (0..numbers.len()).collect();
    let find = |name: &str| numbers.iter().position(|number| number.name == name);
    let mut tie = |a: &str, b: &str| {
        if let (Some(a), Some(b)) = (find(a), find(b)) {
            let (first, second) = (group[a].min(group[b]), group[a].max(group[b]));
            group.iter_mut().filter(|of| **of == second).for_each(|of| *of = first);
        }
    };
    let mut tie_tables = |a: String, b: String| {
        for number in numbers {
            if let Some(rest) = number.name.strip_prefix(a.as_str()) {
                tie(&format!("{a}{rest}"), &format!("{b}{rest}"));
            }
        }
    };
    let mirrored = gait.phases.then == Then::Mirrored;
    let sets = if mirrored { vec![gait.virtual_legs.concat()] } else { gait.virtual_legs.to_vec() };
    let mut crossed = Vec::new();
    for set in &sets {
        for other in &set[1..] {
            let (a, b) = (&robot.legs[set[0]], &robot.legs[*other]);
            tie_tables(format!("legs.{}.", a.name), format!("legs.{}.", b.name));
            if a.chain.len() != b.chain.len() {
                // Joints that differ are locked; what hangs on them stands in other places.
                continue;
            }
            for (s, t) in a.chain.iter().zip(&b.chain) {
                tie_tables(format!("links.{}.", s.link.name), format!("links.{}.", t.link.name));
                let motors = [s, t].map(|segment| format!("actuators.{}.", segment.joint.actuator.name));
                let [motor, counterpart] = motors;
                tie_tables(motor, counterpart);
                let across = gait.virtual_legs[0].contains(&set[0]) != gait.virtual_legs[0].contains(other);
                if gait.rotation == Rotation::Roll && across && s.joint.axis != Axis::Pitch {
                    crossed.push((s.joint.name.clone(), t.joint.name.clone()));
                } else {
                    tie_tables(format!("joints.{}.", s.joint.name), format!("joints.{}.", t.joint.name));
                }
            }
        }
    }
    for (a, b) in crossed {
        // A mirror image turns the other way.
        tie(&format!("joints.{a}.range.lower"), &format!("joints.{b}.range.upper"));
        tie(&format!("joints.{a}.range.upper"), &format!("joints.{b}.range.lower"));
        let alike = ["stiffness", "rest_angle", "damping", "coulomb"];
        alike.iter().for_each(|key| tie(&format!("joints.{a}.{key}"), &format!("joints.{b}.{key}")));
    }
    if mirrored && gait.rotation == Rotation::Roll {
        // The hips are mirror images about the mass centre.
        let centre = format!("links.{}.com.z", robot.platform.name);
        robot.legs.iter().for_each(|leg| tie(&centre, &format!("legs.{}.mount.z", leg.name)));
    }
    let members = |k: usize| numbers.iter().zip(&group).filter(move |(_, of)| **of == k).map(|(number, _)| number);
    (0..numbers.len()).map(|k| members(k).collect()).filter(|group: &Vec<_>| !group.is_empty()).collect()
}

/// On which side of the robot a number's leg is, so that of numbers that are zero mirror images stay so.
struct Sides(Vec<(String, f64)>);

impl Sides {
    fn new(robot: &Robot) -> Sides {
        let of_leg = |leg: &Leg| {
            let side = if leg.mount[2] < 0.0 { -1.0 } else { 1.0 };
            let links = leg.chain.iter().map(|segment| format!("links.{}.", segment.link.name));
            let joints = leg.chain.iter().filter(|segment| segment.joint.axis != Axis::Pitch);
            let joints = joints.map(|segment| format!("joints.{}.", segment.joint.name));
            let tables = links.chain(joints).chain([format!("legs.{}.", leg.name)]);
            tables.map(|table| (table, side)).collect::<Vec<_>>()
        };
        Sides(robot.legs.iter().flat_map(of_leg).collect())
    }

    /// −1 for what is on the left and changes its sign with the side: places across, products with these, and angles of joints that
    /// do not pitch.
    fn of(&self, name: &str) -> f64 {
        let ends = [".z", ".yz", ".zx", ".range.lower", ".range.upper", ".rest_angle"];
        let changes = ends.iter().any(|end| name.ends_with(end));
        let table = self.0.iter().find(|(table, _)| name.starts_with(table.as_str()));
        table.filter(|_| changes).map_or(1.0, |(_, side)| *side)
    }
}

/// Names as one: what differs in braces, between dots or underscores.
fn braced(names: &[String]) -> String {
    let [first, others @ ..] = names else { return String::new() };
    let bounded = |text: &str| text.rfind(['.', '_']).map_or(0, |at| at + 1);
    let common = |a: &str, b: &str| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
    let prefix = others.iter().fold(first.len(), |length, name| length.min(common(first, name)));
    if others.is_empty() || prefix == first.len() {
        return first.clone();
    }
    let prefix = bounded(&first[..prefix]);
    let backward = |name: &str| name[prefix..].bytes().rev().collect::<Vec<_>>();
    let ends: Vec<Vec<u8>> = names.iter().map(|name| backward(name)).collect();
    let same = |other: &Vec<u8>| ends[0].iter().zip(other).take_while(|(a, b)| a == b).count();
    let suffix = ends[1..].iter().fold(ends[0].len(), |length, end| length.min(same(end)));
    let suffix = &first[first.len() - suffix..];
    let suffix = suffix.find(['.', '_']).map_or("", |at| &suffix[at..]);
    let middles: Vec<&str> = names.iter().map(|name| &name[prefix..name.len() - suffix.len()]).collect();
    format!("{}{{{}}}{suffix}", &first[..prefix], middles.join(","))
}

/// To the digits that differences can give.
fn rounded(slope: f64) -> f64 {
    if slope == 0.0 { 0.0 } else { format!("{slope:.10e}").parse().unwrap_or(slope) }
}

impl Mechanism {
    /// Numbers that no equation of motion contains: of each joint its range, greatest torque, speed limits, spring and friction; then the
    /// gait's limits.
    pub fn limiting_numbers(&self) -> Vec<f64> {
        let of_joint = |j: &Actuated| {
            [
                j.range[0],
                j.range[1],
                j.max_torque,
                j.unloaded_speed,
                j.loaded_speed,
                j.stiffness,
                j.rest,
                j.damping,
                j.coulomb,
            ]
        };
        let l = &self.limits;
        let of_gait = [l.friction, l.min_vertical_force, l.swing_clearance];
        let durations = self.phases.iter().flat_map(|phase| phase.duration);
        let heights = [l.min_platform_height, l.body_clearance];
        self.joints.iter().flat_map(of_joint).chain(of_gait).chain(durations).chain(heights).collect()
    }

    /// The same with zero for each of them: mechanisms that differ in nothing else have the same equations of motion.
    pub fn unlimited(&self) -> Mechanism {
        let mut unlimited = self.clone();
        for j in &mut unlimited.joints {
            j.range = [0.0; 2];
            [j.max_torque, j.unloaded_speed, j.loaded_speed, j.stiffness, j.rest, j.damping, j.coulomb] = [0.0; 7];
        }
        unlimited.phases.iter_mut().for_each(|phase| phase.duration = [0.0; 2]);
        let l = &mut unlimited.limits;
        [l.friction, l.min_vertical_force, l.swing_clearance] = [0.0; 3];
        [l.min_platform_height, l.body_clearance] = [0.0; 2];
        unlimited
    }
}

/// Visits all numbers of a specification: those of the robot, then what only limits.
fn places(robot: &mut Robot, gait: &mut Gait, mut visit: impl FnMut(Place)) {
    parameter::places(robot, &mut visit);
    let mut add = |name: Arguments, unit, number: &mut f64| {
        visit(Place::new(name, unit, Sign::Any, false, number));
    };
    for segment in robot.legs.iter_mut().flat_map(|leg| &mut leg.chain) {
        let joint = &mut segment.joint;
        let ([lower, upper], name) = (&mut joint.range, &joint.name);
        add(format_args!("joints.{name}.range.lower"), "rad", lower);
        add(format_args!("joints.{name}.range.upper"), "rad", upper);
        let Spring { stiffness, rest } = &mut joint.spring;
        // Without a spring it does not matter where it would rest.
        if *stiffness != 0.0 {
            add(format_args!("joints.{name}.rest_angle"), "rad", rest);
        }
        add(format_args!("joints.{name}.stiffness"), "N·m/rad", stiffness);
        add(format_args!("joints.{name}.damping"), "N·m·s/rad", &mut joint.friction.damping);
        // Where a joint has no dry friction, the program does not ask which way it turns.
        if joint.friction.coulomb != 0.0 {
            add(format_args!("joints.{name}.coulomb"), "N·m", &mut joint.friction.coulomb);
        }
        let motor = &mut joint.actuator;
        let name = &motor.name;
        add(format_args!("actuators.{name}.gear"), "", &mut motor.gear);
        add(format_args!("actuators.{name}.max_torque"), "N·m", &mut motor.max_torque);
        add(format_args!("actuators.{name}.max_speed.unloaded"), "rev/min", &mut motor.unloaded_speed);
        add(format_args!("actuators.{name}.max_speed.at_max_torque"), "rev/min", &mut motor.loaded_speed);
    }
    let limits = &mut gait.limits;
    add(format_args!("limits.friction"), "", &mut limits.friction);
    add(format_args!("limits.min_vertical_force"), "N", &mut limits.min_vertical_force);
    add(format_args!("limits.swing_clearance"), "m", &mut limits.swing_clearance);
    for (k, phase) in gait.phases.list.iter_mut().enumerate() {
        for (end, number) in ["shortest", "longest"].into_iter().zip(&mut phase.duration) {
            if gait.phases.half_steps {
                add(format_args!("limits.half_step_duration.{end}"), "s", number);
            } else {
                add(format_args!("phases.{}.duration.{end}", k + 1), "s", number);
            }
        }
    }
    add(format_args!("limits.min_platform_height"), "m", &mut limits.min_platform_height);
    add(format_args!("limits.body_clearance"), "m", &mut limits.body_clearance);
}
