//! A mechanism whose numbers are expressions in parameters of the real robot.
//!
//! Where legs that move as one share their links, the mechanism's numbers are sums, means and
//! multiples of the robot's: affine in them. So its coefficients are what it makes of unit robots,
//! in which one number is 1 and all others are 0.

use super::Mechanism;
use super::parameter::{Parameter, parameters, with};
use crate::spec::{Gait, Robot};

/// The mechanisms of all robots that differ in some parameters.
#[derive(Clone, Debug)]
pub struct Family {
    /// That of the specification.
    pub mechanism: Mechanism,
    pub parameters: Vec<Parameter>,
    /// [`Mechanism::numbers`] where all parameters are zero.
    pub base: Vec<f64>,
    /// What each parameter adds to these per unit.
    pub slopes: Vec<Vec<f64>>,
}

impl Family {
    /// The family of `robot` in `chosen` parameters.
    ///
    /// # Errors
    /// If the mechanism is not affine in them: where a virtual leg, a locked joint or a foot makes one body of several.
    pub fn new(robot: &Robot, gait: &Gait, chosen: Vec<Parameter>) -> Result<Family, String> {
        let not_affine = || {
            format!(
                "the {} joins links with parameters of their own into one body or leg: a family needs legs that move as one to \
                 share their links, and no locked joints between links, nor feet of some mass on links, whose numbers are parameters",
                gait.name
            )
        };
        if !shares_links(robot, gait) {
            return Err(not_affine());
        }
        let mechanism = |robot: &Robot| -> Result<Mechanism, String> {
            let robot = robot.locked(&gait.locked).map_err(|t| format!("`{}` is tilted", t.joint))?;
            Ok(Mechanism::new(&robot, gait))
        };
        let is_chosen = |name: &str| chosen.iter().any(|p| p.name == name);
        let rest = with(robot, |name| is_chosen(name).then_some(0.0));
        let all = parameters(robot);
        let unit = |of: &str| with(robot, |name| all.iter().any(|p| p.name == name).then_some(f64::from(name == of)));
        let slopes = chosen.iter().map(|p| Ok(mechanism(&unit(&p.name))?.numbers()));
        let family = Family {
            mechanism: mechanism(robot)?,
            base: mechanism(&rest)?.numbers(),
            slopes: slopes.collect::<Result<_, String>>()?,
            parameters: chosen,
        };
        // Another robot: every number changes by a share of its own.
        let value = |k: usize| family.parameters[k].value * (1.0 + 0.1 / (k + 2) as f64);
        let changed = with(robot, |name| family.parameters.iter().position(|p| p.name == name).map(value));
        if family.gives(&mechanism(&changed)?.numbers(), value) { Ok(family) } else { Err(not_affine()) }
    }

    /// Whether these are the mechanism's numbers for the parameters' values, but for rounding beside the robot's size.
    fn gives(&self, numbers: &[f64], value: impl Fn(usize) -> f64) -> bool {
        let affine = |i: usize| self.slopes.iter().enumerate().fold(self.base[i], |sum, (k, s)| sum + s[i] * value(k));
        let same = |(i, (number, size)): (usize, (&f64, f64))| {
            (affine(i) - number).abs() <= 1e-9 * number.abs().max(1e-6 * size)
        };
        numbers.iter().zip(self.mechanism.sizes()).enumerate().all(same)
    }
}

/// Whether legs that move as one are made of the same links.
fn shares_links(robot: &Robot, gait: &Gait) -> bool {
    let links = |leg: &usize| robot.legs[*leg].chain.iter().map(|segment| segment.link.name.as_str());
    gait.virtual_legs.iter().all(|legs| legs.iter().all(|leg| links(leg).eq(links(&legs[0]))))
}
