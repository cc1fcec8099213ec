//! Families of robots: gaits whose generated dynamics keep numbers of the robot symbolic.
//!
//! A build with parameters generates a [`Family`] per gait. A [`Parametric`] gait of it is a gait like any other, of
//! the robot with the given values, and can tell how what it computes depends on them.

use super::{Body, Description, Gait, Leg, Mode, Rotation, Then};
use crate::digits::digits;
use crate::units::Units;
use nalgebra::Matrix3;

/// A number of the real robot that distinguishes the members of a family.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Where it stands in the specification, such as `links.thigh.mass`.
    pub name: &'static str,
    pub unit: &'static str,
    /// The specification's.
    pub value: f64,
    pub sign: Sign,
}

/// Which values a parameter can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Any,
    NonNegative,
    Positive,
}

/// A gait of one robot of a family, or why no robot can have these numbers.
pub type Member = Result<Box<dyn Parametric>, Unfit>;

/// A gait of all robots that differ in some parameters.
pub struct Family {
    /// That of the specification's robot.
    pub description: &'static Description,
    pub parameters: &'static [Parameter],
    /// The member with these values, one for each parameter.
    pub member: fn(&[f64]) -> Member,
}

/// Values of parameters that no robot of the family has.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    #[error("the family has {expected} parameters, {found} values are given")]
    Count { found: usize, expected: usize },
    #[error("the family has no parameter `{name}`; it has {known}")]
    Unknown { name: String, known: String },
    #[error("{name} = {} {unit}: it must be {must}", digits(*.value))]
    Value { name: &'static str, value: f64, unit: &'static str, must: &'static str },
    #[error(
        "the inertia of {body} is one that no rigid body can have: no moment about any axis exceeds the sum of the other \
         two, but it is {inertia:?} kg·m²"
    )]
    Inertia { body: &'static str, inertia: [[f64; 3]; 3] },
    #[error("the halves of the {gait} mirror each other, but {first} and {second} are no mirror images")]
    Mirror { gait: &'static str, first: &'static str, second: &'static str },
}

impl Family {
    /// The member that differs from the specification's robot in the named parameters.
    ///
    /// # Errors
    /// If there is no such parameter, or no such robot.
    pub fn with(&self, changes: &[(&str, f64)]) -> Result<Box<dyn Parametric>, Unfit> {
        let mut values = self.nominal();
        for (name, value) in changes {
            let Some(k) = self.parameters.iter().position(|p| p.name == *name) else {
                let known: Vec<&str> = self.parameters.iter().map(|p| p.name).collect();
                return Err(Unfit::Unknown { name: (*name).into(), known: known.join(", ") });
            };
            values[k] = *value;
        }
        (self.member)(&values)
    }

    /// The specification's values.
    pub fn nominal(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}

/// A gait of one robot of a family. Sensitivities are gradients in the *lumped* parameters, the few
/// combinations of parameters on which the dynamics depend; `pull_back` makes one in the parameters of them.
#[allow(clippy::too_many_arguments)]
pub trait Parametric: Gait + Send {
    /// The member with these parameters.
    ///
    /// # Errors
    /// If no robot has them.
    fn with(parameters: &[f64]) -> Result<Self, Unfit>
    where
        Self: Sized;

    fn parameters(&self) -> &[f64];
    fn lumps(&self) -> &[f64];
    /// ∂lumps/∂parameters.
    fn lumps_jacobian(&self, out: &mut [f64]);

    /// Gradient of the weighted sum of an instant's outputs; weights as for [`Gait::curvature`].
    fn sensitivity(
        &self,
        mode: Mode,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        n: &[f64],
        phi: &[f64],
        others: &[f64],
        out: &mut [f64],
    );
    /// Gradient of the weighted sum of f1, f2 and c (eq. 8, 9).
    fn terms_sensitivity(&self, mode: Mode, q: &[f64], qd: &[f64], weights: &[f64], out: &mut [f64]);
    /// Gradient of the weighted sum of a touchdown's results; weights as for [`Gait::touchdown_curvature`].
    fn touchdown_sensitivity(&self, leg: usize, q: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd, xi, outputs);
        out.fill(f64::NAN);
    }
    /// The same of a landing; weights as for [`Gait::landing_curvature`].
    fn landing_sensitivity(
        &self,
        leg: usize,
        q: &[f64],
        v: &[f64],
        qd: &[f64],
        xi: &[f64],
        outputs: &[f64],
        out: &mut [f64],
    ) {
        let _ = (leg, q, v, qd, xi, outputs);
        out.fill(f64::NAN);
    }
    /// The same of a take-off; weights as for [`Gait::takeoff_curvature`].
    fn takeoff_sensitivity(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd, qdd, weights);
        out.fill(f64::NAN);
    }

    /// The gradient in the parameters from one in the lumped parameters.
    fn pull_back(&self, by_lump: &[f64]) -> Vec<f64> {
        let mut gradient = vec![0.0; self.parameters().len()];
        let mut jacobian = vec![0.0; by_lump.len() * gradient.len()];
        self.lumps_jacobian(&mut jacobian);
        for (row, weight) in jacobian.chunks(gradient.len().max(1)).zip(by_lump) {
            for (sum, slope) in gradient.iter_mut().zip(row) {
                *sum += weight * slope;
            }
        }
        gradient
    }
}

/// For the registry of a build: a member behind the trait.
///
/// # Errors
/// If no robot has these parameters.
pub fn member<M: Parametric + 'static>(parameters: &[f64]) -> Result<Box<dyn Parametric>, Unfit> {
    Ok(Box::new(M::with(parameters)?))
}

/// For generated members: what a member is made of, and its parameters, checked. `numbers` computes the
/// mechanism's numbers: gravity; of each body offset, mass, mass centre and inertia; of each joint the
/// rotor's inertia; of each leg the foot, and of its members their bodies, feet and spots; corners.
///
/// # Errors
/// If no robot has these parameters.
pub fn fit<const P: usize, const N: usize>(
    specified: &Description,
    parameters: &[Parameter; P],
    values: &[f64],
    numbers: fn(&[f64; P]) -> [f64; N],
) -> Result<(Description, [f64; P]), Unfit> {
    let values: [f64; P] = values.try_into().map_err(|_| Unfit::Count { found: values.len(), expected: P })?;
    for (p, value) in parameters.iter().zip(values) {
        let (fits, must) = match p.sign {
            Sign::Any => (true, ""),
            Sign::NonNegative => (value >= 0.0, "zero or more"),
            Sign::Positive => (value > 0.0, "positive"),
        };
        let must = if value.is_finite() { must } else { "finite" };
        if !(fits && value.is_finite()) {
            return Err(Unfit::Value { name: p.name, value, unit: p.unit, must });
        }
    }
    let mut description = specified.clone();
    let mut measured = numbers(&values).into_iter();
    description.for_each_measured(&mut |number| *number = measured.next().unwrap_or(f64::NAN));
    description.check_inertias()?;
    description.check_mirror()?;
    Ok((description, values))
}

impl Description {
    fn check_inertias(&self) -> Result<(), Unfit> {
        for body in self.bodies.iter() {
            // ∫ r rᵀ dm has no negative eigenvalue; some slack, since that of a flat plate is zero.
            let inertia = Matrix3::from(body.inertia);
            let second = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
            if second.symmetric_eigenvalues().min() < -1e-9 * inertia.trace() {
                return Err(Unfit::Inertia { body: body.name, inertia: body.inertia });
            }
        }
        Ok(())
    }

    /// Where the halves of a cycle mirror each other, so must the legs: across the sagittal plane if the platform
    /// rolls, else as seen from the side.
    fn check_mirror(&self) -> Result<(), Unfit> {
        if self.then == Then::Repeat {
            return Ok(());
        }
        let bodies = |leg: &Leg| {
            let joints = leg.first_joint..leg.end_joint;
            self.bodies.iter().filter(move |b| b.coordinate.is_some_and(|c| joints.contains(&c)))
        };
        let rolls = self.rotation == Rotation::Roll;
        let [first, second] = &self.legs;
        let units = Units::new(self);
        for (a, b) in bodies(first).zip(bodies(second)) {
            if !same(&seen(a, &units, rolls, 1.0), &seen(b, &units, rolls, -1.0)) {
                return Err(Unfit::Mirror { gait: self.gait, first: a.name, second: b.name });
            }
        }
        Ok(())
    }
}

/// What of a body matters, in the robot's units: all of it if the platform rolls, with `side` ±1 for the side on which z points
/// outward; else what shows from the side.
fn seen(body: &Body, units: &Units, rolls: bool, side: f64) -> Vec<f64> {
    let [offset, com] = [body.offset, body.com].map(|v| v.map(|x| x / units.length));
    let inertia = body.inertia.map(|row| row.map(|x| x / units.inertia()));
    let mut numbers = vec![body.mass / units.mass, offset[0], offset[1], com[0], com[1], inertia[2][2]];
    if rolls {
        numbers.extend([side * offset[2], side * com[2], side * inertia[0][2], side * inertia[1][2]]);
        numbers.extend([inertia[0][0], inertia[1][1], inertia[0][1]]);
    }
    numbers
}

/// Equal but for rounding.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-9 * x.abs().max(y.abs()).max(1e-3))
}
