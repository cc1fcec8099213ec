//! The equations of motion of one gait as kernels: named groups of expressions to be evaluated together.
//!
//! `floating` holds the model in X = [p, q] (eq. 5), `mode` the one reduced to q by a stance foot or by free fall
//! (eq. 6, 10), `turn` its angular momentum (eq. 8, 9), `transition` take-off, landing and the passive impacts (eq. 11, 12), `staging` what of
//! eq. 8 and 9 can be evaluated before β is known, `heights` those of the body over the ground; `whole` is the real robot, which has no gait. All follow Kane's form `Σ m ∂v/∂Ẋ·a + ∂ω/∂Ẋ·(Iω̇ + ω×Iω)`.

mod closed_forms;
mod curvature;
mod floating;
mod heights;
mod kernel;
mod kinematics;
mod lumps;
mod mode;
mod model;
mod quantities;
mod sensitivity;
mod sharing;
mod solve;
mod staging;
mod transition;
mod turn;
mod whole;

pub use closed_forms::{Equation, Section, closed_forms};
pub use heights::lowest;
pub use kernel::{Block, Input, Kernel, Of, Output, Shape};
pub use lumps::{LUMPS, PARAMETERS};
pub use model::Model;
pub use quantities::{BodyQuantities, Quantities};
pub use whole::whole_kernels;

use crate::mechanism::{Family, Mechanism, Mode};
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
    let transitions = model.mechanism.transitions.clone();
    for mode in model.mechanism.modes.clone() {
        let turn = Turn::new(model, mode);
        kernels.extend(mode::kernels(model, mode, &turn));
        kernels.extend(staging::kernels(model, mode, &turn));
        if let Mode::Stance(leg) = mode {
            kernels.push(transition::impact(model, leg));
        }
        let into = transitions.iter().filter(|t| t.to == mode);
        kernels.extend(into.clone().map(|t| transition::kernel(model, *t)));
        kernels.push(curvature::kernel(model, mode, &turn));
        kernels.extend(into.map(|t| transition::curvature(model, *t)));
        kernels.extend(heights::kernels(model, mode));
        if let (Mode::Stance(leg), Rotation::Roll) = (mode, model.mechanism.rotation) {
            kernels.extend(sharing::kernels(model, leg));
        }
    }
    kernels.push(transition::both_feet(model));
    kernels
}

/// What is derived of a gait of a family of robots. The kernels of the gait are as those of one robot, but with the lumped
/// parameters as their first input.
pub struct FamilyKernels {
    pub gait: Vec<Kernel>,
    /// From the parameters the lumped ones.
    pub lumps: Kernel,
}

/// What is derived beside it where gradients in the parameters are wanted.
pub struct Gradients {
    /// From the parameters the mechanism's numbers.
    pub numbers: Kernel,
    /// From the parameters the Jacobian of the lumped ones.
    pub jacobian: Kernel,
    /// Gradients in the lumped parameters, which are their first input too.
    pub sensitivity: Vec<Kernel>,
}

/// The kernels of a gait of a family of robots.
pub fn family_kernels(family: &Family) -> (Model, FamilyKernels) {
    let mut model = Model::of_family(family);
    let mut gait = derive(&mut model);
    let lumps = lumped(&mut model, &mut gait);
    gait.iter_mut().for_each(|kernel| take(kernel, &lumps));
    let lumps = lumps.kernel(&model);
    (model, FamilyKernels { gait, lumps })
}

/// The same with gradients: there are lumped parameters more, on which these alone depend.
pub fn family_kernels_with_gradients(family: &Family) -> (Model, FamilyKernels, Gradients) {
    let mut model = Model::of_family(family);
    let mut gait = derive(&mut model);
    let weighted = sensitivity::weighted(&mut model);
    let mut lumps = lumped(&mut model, &mut gait);
    let weighted: Vec<_> = weighted.into_iter().map(|w| w.lumped(&mut model, &mut lumps)).collect();
    let mut sensitivity: Vec<Kernel> = weighted.into_iter().map(|w| w.gradient(&mut model, &lumps)).collect();
    gait.iter_mut().chain(&mut sensitivity).for_each(|kernel| take(kernel, &lumps));
    let gradients = Gradients { numbers: lumps::numbers(&model), jacobian: lumps.jacobian(&model), sensitivity };
    let lumps = lumps.kernel(&model);
    (model, FamilyKernels { gait, lumps }, gradients)
}

/// Rewrites kernels in lumped parameters.
fn lumped(model: &mut Model, kernels: &mut [Kernel]) -> Lumps {
    let mut lumps = Lumps::default();
    for value in kernels.iter_mut().flat_map(|k| &mut k.outputs).flat_map(|o| &mut o.values) {
        *value = lumps.rewrite(&mut model.ring, value);
    }
    lumps
}

/// Gives a kernel the lumped parameters.
fn take(kernel: &mut Kernel, lumps: &Lumps) {
    kernel.inputs.insert(0, Input::new(LUMPS, lumps.symbols.clone()));
}
