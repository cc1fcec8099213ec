//! Validity of the impact (§4.2, eq. 12): the impulse pushes and does not slide, the other foot leaves.
//!
//! Impulse upward; tangential impulse at most μ times it; vertical velocity of the leaving foot ≥ 0, if one stood. With limits at each
//! real leg also the friction of each foot, and what the impact pitches the robot to either side.

use super::sharing::{BALANCED, applies, first, length, offsets, pitches, second};
use piaffe_model::shape::{LandingCurvatureOutputs, TouchdownCurvatureOutputs};
use piaffe_model::units::Units;
use piaffe_model::{Description, FORWARD, Limit, SIDEWAYS, Transition, UP};
use piaffe_number::Scalar;

/// Formulas on the results of a touchdown's or a landing's kernel.
#[derive(Clone, Debug)]
pub struct ImpactConstraints<T = f64> {
    friction: T,
    spatial: bool,
    /// The robot's units of an impulse and of a velocity.
    unit: f64,
    speed: f64,
    /// Where the results stand.
    y: TouchdownCurvatureOutputs,
    /// The real feet that land, from the virtual foot along Xf, if their limits count.
    feet: Vec<f64>,
    /// The unit of what the impact pitches the robot, where that is limited.
    pitching: Option<f64>,
}

/// What an impact may pitch the robot, in its unit: what the verdict on the real legs lets be lacking, but for rounding.
const PITCHED: f64 = BALANCED - 1e-6;

impl<T: Scalar> ImpactConstraints<T> {
    /// Of such a transition, with this coefficient of friction; none where nothing lands.
    pub fn with(description: &Description, transition: Transition, friction: T) -> Option<ImpactConstraints<T>> {
        let units = Units::new(description);
        let landing = transition.lands().filter(|_| applies(description));
        let y = match transition {
            Transition::Touchdown(_) => description.shapes.touchdown_curvature.outputs,
            Transition::Landing(_) => {
                let LandingCurvatureOutputs { impulse, landing, len } = description.shapes.landing_curvature.outputs;
                TouchdownCurvatureOutputs { impulse, landing, len, ..TouchdownCurvatureOutputs::NONE }
            }
            Transition::TakeOff(_) => return None,
        };
        Some(ImpactConstraints {
            friction,
            spatial: description.is_spatial(),
            unit: units.impulse(),
            speed: units.speed(),
            y,
            feet: landing.map_or(Vec::new(), |leg| offsets(&description.legs[leg])),
            pitching: pitches(description).then(|| units.angular_momentum()),
        })
    }

    /// Which limit value `i` is.
    pub fn limit(&self, i: usize) -> Limit {
        match (i, self.spatial) {
            (0, _) => Limit::VerticalImpulse,
            (1, _) | (2, false) => Limit::ImpulseFriction,
            _ if i < self.of_virtual_leg() => Limit::Leaving,
            _ if i < self.of_legs() => Limit::ImpulseFrictionOfFoot,
            _ => Limit::Pitching,
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.of_legs() + if self.pitching.is_some() { 2 } else { 0 }
    }

    fn of_legs(&self) -> usize {
        self.of_virtual_leg() + self.feet.len()
    }

    /// If value `i` is of pitching: to which side, and its unit.
    fn side(&self, i: usize) -> Option<(f64, f64)> {
        let side = i.checked_sub(self.of_legs())?;
        Some((if side == 0 { 1.0 } else { -1.0 }, self.pitching?))
    }

    fn of_virtual_leg(&self) -> usize {
        let of_impulse = if self.spatial { 2 } else { 3 };
        of_impulse + self.y.leaving.len()
    }

    /// `μ I_y − |(I_x, I_z)|` of a real foot from the results of a touchdown; see `sharing`.
    fn friction_of_foot<S: Scalar>(&self, friction: S, foot: usize, y: impl Fn(usize) -> S) -> S {
        let over = 0.5 / self.feet[foot];
        let vertical = y(1).scale(0.5) + y(3).scale(over);
        let lateral = y(2).scale(0.5) + y(4).scale(over);
        friction * vertical - length([y(0).scale(0.5), lateral], self.unit)
    }

    /// Where impulse and couple stand among a touchdown's results.
    fn index(&self, k: usize) -> usize {
        let components = self.y.impulse.len();
        k.checked_sub(components).map_or_else(|| self.y.impulse.place(k), |k| self.y.couple.place(k))
    }

    /// Scaled value `i` from (impulse…, leaving, landing, couple…, pitch).
    pub fn value(&self, i: usize, y: &[T]) -> T {
        if let Some((side, unit)) = self.side(i) {
            return T::from(PITCHED) - self.y.pitch.value(y).scale(side / unit);
        }
        let (mu, unit) = (self.friction, T::from(self.unit));
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            return self.friction_of_foot(mu, foot, |k| y[self.index(k)]) / unit;
        }
        let impulse = self.y.impulse.of(y);
        match (i, self.spatial) {
            (0, _) => impulse[UP] / unit,
            (1, true) => (mu * impulse[UP] - norm(impulse)) / unit,
            (1, false) => (mu * impulse[UP] + impulse[FORWARD]) / unit,
            (2, false) => (mu * impulse[UP] - impulse[FORWARD]) / unit,
            _ => self.y.leaving.value(y) / T::from(self.speed),
        }
    }
}

impl ImpactConstraints {
    pub fn new(description: &Description, transition: Transition) -> Option<ImpactConstraints> {
        ImpactConstraints::with(description, transition, description.limits.friction)
    }

    /// Calls `add(index in (impulse…, leaving, landing, couple…, pitch), partial derivative)` for value `i`.
    pub fn partials(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, f64)) {
        if let Some((side, unit)) = self.side(i) {
            return add(self.y.pitch.place(0), -side / unit);
        }
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            let own: [f64; 5] = std::array::from_fn(|k| y[self.index(k)]);
            let gradient = first(&own, |v| self.friction_of_foot(self.friction.into(), foot, |k| v[k]));
            return (0..5).for_each(|k| add(self.index(k), gradient[k] / self.unit));
        }
        let (mu, impulse) = (self.friction / self.unit, self.y.impulse);
        match (i, self.spatial) {
            (0, _) => add(impulse.place(UP), 1.0 / self.unit),
            (1, true) => {
                let norm = norm(impulse.of(y)).max(TINY * self.unit);
                for k in [FORWARD, SIDEWAYS].map(|component| impulse.place(component)) {
                    add(k, -y[k] / norm / self.unit);
                }
                add(impulse.place(UP), mu);
            }
            (1, false) | (2, false) => {
                add(impulse.place(UP), mu);
                add(impulse.place(FORWARD), if i == 1 { 1.0 } else { -1.0 } / self.unit);
            }
            _ => add(self.y.leaving.place(0), 1.0 / self.speed),
        }
    }

    /// Calls `add(index, index, second derivative)` for value `i`.
    pub fn curvature(&self, i: usize, y: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        if self.side(i).is_some() {
            return;
        }
        if let Some(foot) = i.checked_sub(self.of_virtual_leg()) {
            let own: [f64; 5] = std::array::from_fn(|k| y[self.index(k)]);
            let hessian = second(&own, |v| self.friction_of_foot(self.friction.into(), foot, |k| v[k]));
            for (a, row) in hessian.iter().enumerate() {
                row.iter().enumerate().for_each(|(b, x)| add(self.index(a), self.index(b), x / self.unit));
            }
            return;
        }
        if !(self.spatial && i == 1) {
            return;
        }
        let norm = norm(self.y.impulse.of(y)).max(TINY * self.unit);
        let tangential = [FORWARD, SIDEWAYS].map(|component| self.y.impulse.place(component));
        for a in tangential {
            for b in tangential {
                let unit = if a == b { 1.0 } else { 0.0 };
                add(a, b, (y[a] * y[b] / (norm * norm) - unit) / norm / self.unit);
            }
        }
    }
}

/// Below this share of its unit a tangential impulse has no direction.
const TINY: f64 = 1e-13;

/// Norm of the tangential part of an impulse in space.
fn norm<T: Scalar>(impulse: &[T]) -> T {
    (impulse[FORWARD] * impulse[FORWARD] + impulse[SIDEWAYS] * impulse[SIDEWAYS]).sqrt()
}
