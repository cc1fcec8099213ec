//! The whole robot that the virtual legs stand for.

use super::derived::DerivedWhole;
use super::description::body;
use super::kept::text;
use super::tape::Unrunnable;
use super::twins::Twins;
use piaffe_codegen::mechanism;
use piaffe_codegen::spec::Robot;
use piaffe_model::whole::{self, Description, Joint, Leg};

pub struct Whole {
    description: Description,
    inertia_and_bias: Twins,
    feet: Twins,
    feet_bias: Twins,
}

impl Whole {
    /// Of a robot whose locked joints are gone. One of many robots is not asked about again: what is derived of it is not kept.
    pub fn new(robot: &Robot, of_many: bool) -> Result<Whole, Unrunnable> {
        let whole = mechanism::Whole::new(robot);
        let derived = if of_many { DerivedWhole::derive(&whole) } else { DerivedWhole::of(&whole) };
        let DerivedWhole { shapes, mut tapes } = derived?;
        let joint = |j: &mechanism::WholeJoint| Joint { name: text(&j.name), rotor_inertia: j.rotor_inertia };
        let leg = |l: &mechanism::WholeLeg| Leg {
            name: text(&l.name),
            joints: l.joints.clone(),
            foot_body: l.foot_body,
            foot: l.foot.map(|x| x + 0.0),
        };
        let [inertia_and_bias, feet, feet_bias] =
            ["inertia_and_bias", "feet", "feet_bias"].map(|kernel| tapes.take(kernel));
        tapes.end();
        Ok(Whole {
            description: Description {
                robot: text(&whole.robot),
                gravity: whole.gravity,
                bodies: whole.bodies.iter().map(body).collect(),
                joints: whole.joints.iter().map(joint).collect(),
                legs: whole.legs.iter().map(leg).collect(),
                shapes: whole::Shapes::named("", &|name| shapes.block(name)),
            },
            inertia_and_bias,
            feet,
            feet_bias,
        })
    }
}

impl whole::Whole for Whole {
    fn description(&self) -> &Description {
        &self.description
    }

    fn inertia_and_bias(&self, up: &[f64], omega: &[f64], q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.inertia_and_bias.evaluate(0, &[up, omega, q, qd], out);
    }

    fn feet(&self, q: &[f64], out: &mut [f64]) {
        self.feet.evaluate(0, &[q], out);
    }

    fn feet_bias(&self, omega: &[f64], q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.feet_bias.evaluate(0, &[omega, q, qd], out);
    }
}
