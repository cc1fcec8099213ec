//! A gait with some numbers changed that its dynamics do not contain: limits, ranges, friction, the polynomials' order.

use crate::constraints::sharing::obstacle;
use piaffe_model::whole::Whole;
use piaffe_model::{Description, Gait, Lever, Mode, Specification};

/// The generated dynamics of a gait under another description.
pub struct Altered<'a> {
    gait: &'a dyn Gait,
    description: Description,
}

impl<'a> Altered<'a> {
    /// `None` if the change touches what the generated code has folded in: bodies, rotors, gravity, coordinates.
    pub fn new(gait: &'a dyn Gait, change: impl FnOnce(&mut Description)) -> Option<Altered<'a>> {
        let mut description = gait.description().clone();
        change(&mut description);
        (folded(&description) == folded(gait.description())).then_some(Altered { gait, description })
    }

    /// The same gait with polynomials of another order (eq. 15).
    pub fn of_order(gait: &'a dyn Gait, order: usize) -> Altered<'a> {
        Altered { gait, description: Description { polynomial_order: order, ..gait.description().clone() } }
    }

    /// The same gait with its limits at each real leg too.
    ///
    /// # Errors
    /// If they cannot be imposed there.
    pub fn at_real_legs(gait: &'a dyn Gait) -> Result<Altered<'a>, String> {
        let mut description = gait.description().clone();
        description.limits.real_legs = true;
        match obstacle(&description) {
            Some(obstacle) => Err(obstacle),
            None => Ok(Altered { gait, description }),
        }
    }
}

/// What the generated code depends on, as text.
fn folded(d: &Description) -> String {
    let rotors: Vec<f64> = d.joints.iter().map(|j| j.gear * j.gear * j.rotor_inertia).collect();
    let frame = (d.gravity, d.rotation, d.then, d.unactuated);
    let modes: Vec<_> = d.phases.iter().map(|phase| phase.mode).collect();
    format!("{frame:?} {modes:?} {:?} {:?} {:?} {rotors:?}", d.bodies, d.legs, d.corners)
}

macro_rules! delegate {
    ($($name:ident($($argument:ident: $type:ty),*);)*) => {
        $(#[inline]
        fn $name(&self, $($argument: $type,)* out: &mut [f64]) {
            self.gait.$name($($argument,)* out);
        })*
    };
}

impl Gait for Altered<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    /// Without what is altered.
    fn specification(&self) -> Option<&Specification> {
        self.gait.specification()
    }

    /// Of other limits than the specification's none is known.
    fn levers(&self) -> &[Lever] {
        if self.description.numbers() == self.gait.description().numbers() { self.gait.levers() } else { &[] }
    }

    fn latex(&self) -> &str {
        self.gait.latex()
    }

    fn whole(&self) -> Option<&dyn Whole> {
        self.gait.whole()
    }

    delegate! {
        inertia(q: &[f64]);
        bias(q: &[f64], qd: &[f64]);
        inertia_and_bias(q: &[f64], qd: &[f64]);
        energy(x: &[f64], xd: &[f64]);
        centre_of_mass(x: &[f64], xd: &[f64]);
        foot(leg: usize, x: &[f64]);
        foot_jacobian(leg: usize, q: &[f64]);
        foot_bias(leg: usize, q: &[f64], qd: &[f64]);
        angular_momentum(leg: usize, x: &[f64], xd: &[f64]);
        platform_velocity(mode: Mode, q: &[f64], qd: &[f64]);
        momentum_terms(mode: Mode, q: &[f64], qd: &[f64]);
        reduced(mode: Mode, q: &[f64], qd: &[f64]);
        forward(mode: Mode, q: &[f64], qd: &[f64], gamma: &[f64]);
        inverse(mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64]);
        momentum(mode: Mode, q: &[f64], qd: &[f64]);
        inverse_jacobian(mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64]);
        placement(mode: Mode, q: &[f64]);
        heights(mode: Mode, q: &[f64]);
        swing_velocity(mode: Mode, q: &[f64], qd: &[f64]);
        early(mode: Mode, actuated: &[f64], actuated_d: &[f64]);
        late(mode: Mode, early: &[f64], beta: f64);
        late_gradient(mode: Mode, early: &[f64], beta: f64);
        impact(leg: usize, q: &[f64], xd: &[f64]);
        touchdown(leg: usize, q: &[f64], qd: &[f64]);
        curvature(mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], n: &[f64], phi: &[f64], others: &[f64]);
        heights_curvature(mode: Mode, q: &[f64], weights: &[f64]);
        touchdown_curvature(leg: usize, q: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64]);
        landing(leg: usize, q: &[f64], v: &[f64], qd: &[f64]);
        landing_curvature(leg: usize, q: &[f64], v: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64]);
        takeoff(leg: usize, q: &[f64], qd: &[f64], qdd: &[f64]);
        takeoff_curvature(leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64]);
        sharing(mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64]);
        sharing_curvature(mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64]);
        impact_both(q: &[f64], xd: &[f64]);
    }
}
