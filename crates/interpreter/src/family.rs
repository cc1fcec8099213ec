//! A gait of many robots that differ in some numbers, derived once.
//!
//! What differs between a few robots, the samples, stays symbolic: a number of the mechanism that is not the same in all of them
//! is a parameter, and numbers that are equal in all of them, or opposite, are one. Nothing is assumed of how the mechanism's numbers
//! follow from the specification's: each member's are looked at, and one that is no member is derived by itself.

use super::derived::Derived;
use super::description::description;
use super::gait::{Interpreted, Kernels, mechanism};
use super::robot::{Robot, Unloadable};
use super::tape::{Tape, Unrunnable};
use piaffe_codegen::mechanism::{self, Mechanism, Parameter, Sign};
use piaffe_model::Description;

/// A gait with symbols for what differs between its robots.
pub struct Family {
    gait: String,
    numbers: Numbers,
    /// Of the first sample.
    description: Description,
    /// From the parameters what the kernels need of them.
    lumps: Tape,
    kernels: Kernels,
}

impl Family {
    /// The gait of this name for robots like these.
    ///
    /// # Errors
    /// If there are no robots, one has no such gait, or it cannot be derived.
    pub fn new(samples: &[Robot], gait: &str) -> Result<Family, Unloadable> {
        let mechanisms = samples.iter().map(|robot| of(robot, gait)).collect::<Result<Vec<_>, _>>()?;
        let none = || Unloadable::Specification("there is no robot".into());
        Family::of(&mechanisms, gait, mechanisms.first().ok_or_else(none)?)
            .map_err(|why| Unloadable::Gait { gait: gait.into(), why })
    }

    fn of(samples: &[Mechanism], gait: &str, first: &Mechanism) -> Result<Family, Unrunnable> {
        let numbers = Numbers::new(&samples.iter().map(Mechanism::numbers).collect::<Vec<_>>());
        let (derived, lumps) = Derived::of_family(&numbers.family(first))?;
        let description = description(first, gait, &derived);
        Ok(Family { gait: gait.into(), description, lumps, kernels: Kernels::new(derived.tapes), numbers })
    }

    /// The gait of a robot, with the numbers of [`Robot::gait`] but for rounding.
    ///
    /// # Errors
    /// If the robot has no such gait, or its numbers make some that are none.
    pub fn member(&self, robot: &Robot) -> Result<Interpreted, Unloadable> {
        let mechanism = of(robot, &self.gait)?;
        let numbers = mechanism.numbers();
        let Some(parameters) = self.numbers.parameters(&numbers) else { return robot.gait(&self.gait) };
        let mut lumps = vec![0.0; self.lumps.outputs()];
        self.lumps.evaluate(&[&parameters], &mut lumps);
        if let Some(number) = lumps.iter().find(|number| !number.is_finite()) {
            let why = Unrunnable::NotFinite { kernel: "lumps".into(), number: *number };
            return Err(Unloadable::Gait { gait: self.gait.clone(), why });
        }
        let mut description = self.description.clone();
        let mut all = numbers.into_iter().chain(mechanism.limiting_numbers());
        // As code has them: zero without a sign.
        description.for_each_number(&mut |number| *number = all.next().unwrap_or(f64::NAN) + 0.0);
        description.polynomial_order = mechanism.polynomial_order;
        robot.evaluated(&self.gait, description, self.kernels.with(&lumps))
    }
}

fn of(robot: &Robot, gait: &str) -> Result<Mechanism, Unloadable> {
    let (robot, gait) = (robot.specified(), robot.specified_gait(gait)?);
    mechanism(robot, gait).map_err(|why| Unloadable::Gait { gait: gait.name.clone(), why })
}

/// What a mechanism's numbers are ([`Mechanism::numbers`]): constants, or plus or minus a parameter.
struct Numbers {
    all: Vec<Number>,
    /// Of each parameter a number that is it: in the first sample it is this.
    parameters: Vec<(usize, f64)>,
}

#[derive(Clone, Copy)]
enum Number {
    Constant(f64),
    Parameter { index: usize, sign: f64 },
}

impl Numbers {
    fn new(samples: &[Vec<f64>]) -> Numbers {
        let mut numbers = Numbers { all: Vec::new(), parameters: Vec::new() };
        let first = samples.first().map_or(&[][..], Vec::as_slice);
        for (k, value) in first.iter().enumerate() {
            let at = |k: usize| samples.iter().map(move |sample| sample.get(k).copied().unwrap_or(f64::NAN));
            if at(k).all(|other| other == *value) {
                numbers.all.push(Number::Constant(*value));
                continue;
            }
            let is = |sign: f64, known: usize| at(k).zip(at(known)).all(|(a, b)| a == sign * b);
            let known = [1.0, -1.0].into_iter().find_map(|sign| {
                let index = numbers.parameters.iter().position(|(known, _)| is(sign, *known))?;
                Some(Number::Parameter { index, sign })
            });
            numbers.all.push(known.unwrap_or_else(|| {
                numbers.parameters.push((k, *value));
                Number::Parameter { index: numbers.parameters.len() - 1, sign: 1.0 }
            }));
        }
        numbers
    }

    /// For the derivation.
    fn family(&self, mechanism: &Mechanism) -> mechanism::Family {
        let constant = |number: &Number| if let Number::Constant(value) = number { *value } else { 0.0 };
        let slope = |number: &Number, parameter: usize| match number {
            Number::Parameter { index, sign } if *index == parameter => *sign,
            _ => 0.0,
        };
        let parameter = |(k, (_, value)): (usize, &(usize, f64))| Parameter {
            name: format!("p{k}"),
            unit: "",
            value: *value,
            sign: Sign::Any,
        };
        let count = self.parameters.len();
        mechanism::Family {
            mechanism: mechanism.unlimited(),
            parameters: self.parameters.iter().enumerate().map(parameter).collect(),
            base: self.all.iter().map(constant).collect(),
            slopes: (0..count).map(|p| self.all.iter().map(|number| slope(number, p)).collect()).collect(),
        }
    }

    /// The parameters with which these are the numbers, if there are such.
    fn parameters(&self, numbers: &[f64]) -> Option<Vec<f64>> {
        let values: Vec<f64> = self.parameters.iter().filter_map(|(k, _)| numbers.get(*k).copied()).collect();
        let is = |(number, value): (&Number, &f64)| match number {
            Number::Constant(constant) => constant == value,
            Number::Parameter { index, sign } => values.get(*index).is_some_and(|parameter| sign * parameter == *value),
        };
        (numbers.len() == self.all.len() && self.all.iter().zip(numbers).all(is)).then_some(values)
    }
}
