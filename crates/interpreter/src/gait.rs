//! A gait that is evaluated as it was derived.

use super::derived::Derived;
use super::description::description;
use super::kept::text;
use super::tape::Unrunnable;
use super::twins::{Tapes, Twins, Which};
use super::whole::Whole;
use piaffe_codegen::mechanism::{Mechanism, levers};
use piaffe_codegen::spec;
use piaffe_codegen::typeset::latex;
use piaffe_model::{Description, Gait, Lever, Mode, Specification, whole};
use std::sync::OnceLock;

/// A gait of a specification, derived when it was loaded: what a build would make of it, with the same bits.
///
/// What only some ask for (the whole robot, the closed forms, what the numbers of the specification are to the gait's) is derived
/// when it is asked for. What its description gives out for ever stays for as long as the program: a few kilobytes for each gait, and
/// nothing for each member of a family.
pub struct Interpreted {
    robot: spec::Robot,
    gait: spec::Gait,
    specification: Specification,
    description: Description,
    kernels: Kernels,
    /// Whether it is a member of a family.
    of_many: bool,
    whole: OnceLock<Option<Whole>>,
    latex: OnceLock<String>,
    levers: OnceLock<Vec<Lever>>,
}

impl Interpreted {
    /// The gait of a robot, both validated and read from `specification`, under the name `key`.
    ///
    /// # Errors
    /// If the numbers of the robot make some that are none, or a kernel is too large.
    pub fn new(
        robot: &spec::Robot,
        gait: &spec::Gait,
        specification: Specification,
        key: &str,
    ) -> Result<Interpreted, Unrunnable> {
        let mechanism = mechanism(robot, gait)?;
        let derived = Derived::of(&mechanism)?;
        let description = description(&mechanism, key, &derived);
        let kernels = Kernels::new(derived.tapes);
        let interpreted = Interpreted::member(robot, gait, specification, description, kernels);
        Ok(Interpreted { of_many: false, ..interpreted })
    }

    /// The gait of a member of a family, with this description and these kernels.
    pub(crate) fn member(
        robot: &spec::Robot,
        gait: &spec::Gait,
        specification: Specification,
        description: Description,
        kernels: Kernels,
    ) -> Interpreted {
        Interpreted {
            robot: robot.clone(),
            gait: gait.clone(),
            specification,
            description,
            kernels,
            of_many: true,
            whole: OnceLock::new(),
            latex: OnceLock::new(),
            levers: OnceLock::new(),
        }
    }
}

/// What the gait makes of a robot.
pub fn mechanism(robot: &spec::Robot, gait: &spec::Gait) -> Result<Mechanism, Unrunnable> {
    Ok(Mechanism::new(&locked(robot, gait)?, gait))
}

/// The robot whose joints that the gait holds still are gone.
fn locked(robot: &spec::Robot, gait: &spec::Gait) -> Result<spec::Robot, Unrunnable> {
    robot.locked(&gait.locked).map_err(|tilted| Unrunnable::Tilted { joint: tilted.joint })
}

/// A structure with the tapes of all kernels, and the trait's methods that evaluate them. An input is `numbers` or a `number`; not
/// every gait has a kernel that is there `if needed`.
macro_rules! gait {
    ($($name:ident $([$of:ident: $ty:ty])? ($($input:ident: $kind:ident),*) $(if $needed:ident)?;)*) => {
        /// The tapes of all kernels.
        pub struct Kernels {
            $($name: Twins,)*
        }

        impl Kernels {
            pub fn new(mut tapes: Tapes) -> Kernels {
                let kernels = Kernels { $($name: gait!(take $($needed)? tapes stringify!($name)),)* };
                tapes.end();
                kernels
            }

            /// With these numbers for their first inputs.
            pub fn with(&self, first: &[f64]) -> Kernels {
                Kernels { $($name: self.$name.with(first),)* }
            }
        }

        impl Gait for Interpreted {
            fn description(&self) -> &Description {
                &self.description
            }

            fn specification(&self) -> Option<&Specification> {
                Some(&self.specification)
            }

            fn levers(&self) -> &[Lever] {
                self.levers.get_or_init(|| levers(&self.robot, &self.gait).into_iter().map(lever).collect())
            }

            fn latex(&self) -> &str {
                self.latex.get_or_init(|| {
                    let mechanism = mechanism(&self.robot, &self.gait);
                    mechanism.map_or(String::new(), |mechanism| latex(&self.robot, &self.gait, &mechanism))
                })
            }

            fn whole(&self) -> Option<&dyn whole::Whole> {
                let whole = self.whole.get_or_init(|| Whole::new(&locked(&self.robot, &self.gait).ok()?, self.of_many).ok());
                whole.as_ref().map(|whole| whole as &dyn whole::Whole)
            }

            $(fn $name(&self, $($of: $ty,)? $($input: gait!(type $kind),)* out: &mut [f64]) {
                let which = 0 $(+ $of.which())?;
                self.kernels.$name.evaluate(which, &[$(gait!(slice $kind $input)),*], out);
            })*
        }
    };
    (take needed $tapes:ident $name:expr) => { $tapes.take_any($name) };
    (take $tapes:ident $name:expr) => { $tapes.take($name) };
    (type numbers) => { &[f64] };
    (type number) => { f64 };
    (slice numbers $input:ident) => { $input };
    (slice number $input:ident) => { std::slice::from_ref(&$input) };
}

gait! {
    inertia(q: numbers);
    bias(q: numbers, qd: numbers);
    inertia_and_bias(q: numbers, qd: numbers);
    energy(x: numbers, xd: numbers);
    centre_of_mass(x: numbers, xd: numbers);
    foot[leg: usize](x: numbers);
    foot_jacobian[leg: usize](q: numbers);
    foot_bias[leg: usize](q: numbers, qd: numbers);
    angular_momentum[leg: usize](x: numbers, xd: numbers);
    platform_velocity[mode: Mode](q: numbers, qd: numbers);
    momentum_terms[mode: Mode](q: numbers, qd: numbers);
    reduced[mode: Mode](q: numbers, qd: numbers);
    forward[mode: Mode](q: numbers, qd: numbers, gamma: numbers);
    inverse[mode: Mode](q: numbers, qd: numbers, actuated_dd: numbers);
    momentum[mode: Mode](q: numbers, qd: numbers);
    inverse_jacobian[mode: Mode](q: numbers, qd: numbers, actuated_dd: numbers);
    placement[mode: Mode](q: numbers);
    heights[mode: Mode](q: numbers);
    swing_velocity[mode: Mode](q: numbers, qd: numbers);
    early[mode: Mode](actuated: numbers, actuated_d: numbers);
    late[mode: Mode](early: numbers, beta: number);
    late_gradient[mode: Mode](early: numbers, beta: number);
    impact[leg: usize](q: numbers, xd: numbers);
    touchdown[leg: usize](q: numbers, qd: numbers) if needed;
    curvature[mode: Mode](q: numbers, qd: numbers, qdd: numbers, n: numbers, phi: numbers, others: numbers);
    heights_curvature[mode: Mode](q: numbers, weights: numbers);
    touchdown_curvature[leg: usize](q: numbers, qd: numbers, xi: numbers, outputs: numbers) if needed;
    landing[leg: usize](q: numbers, v: numbers, qd: numbers) if needed;
    landing_curvature[leg: usize](q: numbers, v: numbers, qd: numbers, xi: numbers, outputs: numbers) if needed;
    takeoff[leg: usize](q: numbers, qd: numbers, qdd: numbers) if needed;
    takeoff_curvature[leg: usize](q: numbers, qd: numbers, qdd: numbers, weights: numbers) if needed;
    sharing[mode: Mode](q: numbers, qd: numbers, qdd: numbers) if needed;
    sharing_curvature[mode: Mode](q: numbers, qd: numbers, qdd: numbers, weights: numbers) if needed;
    impact_both(q: numbers, xd: numbers);
}

fn lever(lever: piaffe_codegen::mechanism::Lever) -> Lever {
    Lever {
        name: text(&lever.name),
        numbers: lever.numbers.iter().map(|name| text(name)).collect(),
        unit: lever.unit,
        value: lever.value + 0.0,
        slopes: lever.slopes.into(),
    }
}
