//! The equations of motion of one gait as kernels: named groups of expressions to be evaluated together.
//!
//! `floating` holds the model in X = [p, q] (eq. 5), `stance` the one reduced to q by the stance foot
//! (eq. 6, 10), `turn` its angular momentum (eq. 8, 9), `impact` the passive impacts (eq. 11, 12), `staging` what of
//! eq. 8 and 9 can be evaluated before β is known, `heights` those of the body over the ground; `whole` is the real robot, which has no gait. All follow Kane's form `Σ m ∂v/∂Ẋ·a + ∂ω/∂Ẋ·(Iω̇ + ω×Iω)`.

mod closed_forms;
mod curvature;
mod floating;
mod heights;
mod impact;
mod kernel;
mod kinematics;
mod lumps;
mod model;
mod quantities;
mod sensitivity;
mod sharing;
mod solve;
mod staging;
mod stance;
mod turn;
mod whole;

pub use closed_forms::{Equation, Section, closed_forms};
pub use heights::lowest;
pub use kernel::{Input, Kernel, Output, Shape};
pub use lumps::{LUMPS, PARAMETERS};
pub use model::Model;
pub use quantities::{BodyQuantities, Quantities};
pub use whole::whole_kernels;

use crate::mechanism::{Family, Mechanism};
use crate::spec::Rotation;
use lumps::Lumps;
use turn::Turn;

/// All kernels of a gait, in the order in which they are emitted.
pub fn kernels(mechanism: &Mechanism) -> (Model, Vec<Kernel>) {
    let mut model = Model::new(mechanism);
    let kernels = derive(&mut model);
    (model, kernels)
}

fn derive(model: &mut Model) -> Vec<Kernel> {
    let mut kernels = floating::kernels(model);
    for leg in 0..2 {
        let turn = Turn::new(model, leg);
        kernels.extend(stance::kernels(model, leg, &turn));
        kernels.extend(staging::kernels(model, leg, &turn));
        kernels.extend(impact::kernels(model, leg));
        kernels.extend(curvature::kernels(model, leg, &turn));
        kernels.extend(heights::kernels(model, leg));
        if model.mechanism.rotation == Rotation::Roll {
            kernels.extend(sharing::kernels(model, leg));
        }
    }
    kernels.push(impact::both_feet(model));
    kernels
}

/// The kernels of a gait of a family of robots.
pub struct FamilyKernels {
    /// As those of one robot, but with the lumped parameters as their first input.
    pub gait: Vec<Kernel>,
    /// Gradients in the lumped parameters, which are their first input too.
    pub sensitivity: Vec<Kernel>,
    /// From the parameters: the mechanism's numbers, the lumped parameters and their Jacobian.
    pub parameters: [Kernel; 3],
}

/// All kernels of a gait of a family of robots.
pub fn family_kernels(family: &Family) -> (Model, FamilyKernels) {
    let mut model = Model::of_family(family);
    let mut gait = derive(&mut model);
    let weighted: Vec<_> = (0..2).flat_map(|leg| sensitivity::weighted(&mut model, leg)).collect();
    let mut lumps = Lumps::default();
    for value in gait.iter_mut().flat_map(|k| &mut k.outputs).flat_map(|o| &mut o.values) {
        *value = lumps.rewrite(&mut model.ring, value);
    }
    let weighted: Vec<_> = weighted.into_iter().map(|w| w.lumped(&mut model, &mut lumps)).collect();
    let mut sensitivity: Vec<Kernel> = weighted.into_iter().map(|w| w.gradient(&mut model, &lumps)).collect();
    for kernel in gait.iter_mut().chain(&mut sensitivity) {
        kernel.inputs.insert(0, Input { name: LUMPS, symbols: lumps.symbols.clone(), scalar: false });
    }
    let parameters = lumps.kernels(&model);
    (model, FamilyKernels { gait, sensitivity, parameters })
}
