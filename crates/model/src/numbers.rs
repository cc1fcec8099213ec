//! The numbers of a description in one fixed order, and how they follow from those of the specification.

use super::{Body, Description};
use std::borrow::Cow;

/// Numbers of the specification that change together: something that can be changed on the robot, or in what is asked of it.
///
/// Legs that the gait moves as one or that mirror each other must stay alike, so that what they have in the same place changes by the same
/// share.
#[derive(Clone, Debug)]
pub struct Lever {
    /// Where they stand in the specification, what differs in braces: `links.{left_shin,right_shin}.mass`.
    pub name: &'static str,
    /// Where each stands, such as `links.left_shin.mass`.
    pub numbers: Cow<'static, [&'static str]>,
    pub unit: &'static str,
    /// Of the first.
    pub value: f64,
    /// Which of [`Description::numbers`] change with it, and by how much per unit.
    pub slopes: Cow<'static, [(usize, f64)]>,
}

impl Description {
    /// All numbers: first what is measured (gravity; of each body offset, mass, mass centre and inertia; of each joint the
    /// rotor's inertia; of each leg the foot, and of its members their bodies, feet and spots; the platform's corners), then
    /// what no equation of motion contains (of each joint its range, greatest torque, unloaded and loaded speed, its spring's
    /// stiffness and rest, damping and dry friction; the ground's friction, vertical force, clearance, shortest and longest duration of each phase, platform height, body clearance).
    pub fn numbers(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.clone().for_each_number(&mut |number| numbers.push(*number));
        numbers
    }

    /// A description whose numbers are `slopes`, by index, and else 0: a direction in which a description can change.
    pub fn direction(&self, slopes: &[(usize, f64)]) -> Description {
        let (mut direction, mut index) = (self.clone(), 0);
        direction.for_each_number(&mut |number| {
            *number = slopes.iter().rev().find(|(of, _)| *of == index).map_or(0.0, |(_, slope)| *slope);
            index += 1;
        });
        direction
    }

    /// Visits all numbers in their order.
    pub fn for_each_number(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.for_each_measured(visit);
        for joint in self.joints.to_mut() {
            joint.range.iter_mut().for_each(&mut *visit);
            visit(&mut joint.max_torque);
            visit(&mut joint.unloaded_speed);
            visit(&mut joint.loaded_speed);
            visit(&mut joint.stiffness);
            visit(&mut joint.rest);
            visit(&mut joint.damping);
            visit(&mut joint.coulomb);
        }
        let l = &mut self.limits;
        visit(&mut l.friction);
        visit(&mut l.min_vertical_force);
        visit(&mut l.swing_clearance);
        self.phases.to_mut().iter_mut().flat_map(|phase| &mut phase.duration).for_each(&mut *visit);
        visit(&mut l.min_platform_height);
        visit(&mut l.body_clearance);
    }

    /// Visits the measured numbers in their order.
    pub(super) fn for_each_measured(&mut self, visit: &mut impl FnMut(&mut f64)) {
        visit(&mut self.gravity);
        self.bodies.to_mut().iter_mut().for_each(|body| body.for_each_measured(visit));
        self.joints.to_mut().iter_mut().for_each(|joint| visit(&mut joint.rotor_inertia));
        for leg in &mut self.legs {
            leg.foot.iter_mut().for_each(&mut *visit);
            for member in leg.members.to_mut() {
                member.bodies.to_mut().iter_mut().for_each(|body| body.for_each_measured(visit));
                member.foot.iter_mut().for_each(&mut *visit);
                member.spots.to_mut().iter_mut().flat_map(|spot| &mut spot.at).for_each(&mut *visit);
            }
        }
        self.corners.to_mut().iter_mut().flat_map(|corner| &mut corner.at).for_each(visit);
    }
}

impl Body {
    fn for_each_measured(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.offset.iter_mut().for_each(&mut *visit);
        visit(&mut self.mass);
        self.com.iter_mut().chain(self.inertia.as_flattened_mut()).for_each(visit);
    }
}
