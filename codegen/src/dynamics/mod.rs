//! The equations of motion of one gait as kernels: named groups of expressions to be evaluated together.
//!
//! `floating` holds the model in X = [p, q] (eq. 5), `stance` the one reduced to q by the stance foot
//! (eq. 6, 8–10), `impact` the passive impacts (eq. 11, 12), `staging` what of eq. 8 and 9 can be
//! evaluated before β is known. All follow Kane's form `Σ m ∂v/∂Ẋ·a + ∂ω/∂Ẋ·(Iω̇ + ω×Iω)`.

mod curvature;
mod floating;
mod impact;
mod kernel;
mod kinematics;
mod model;
mod quantities;
mod solve;
mod staging;
mod stance;

pub use kernel::{Input, Kernel, Output, Shape};
pub use model::Model;
pub use quantities::{BodyQuantities, Quantities};

use crate::mechanism::Mechanism;

/// All kernels of a gait, in the order in which they are emitted.
pub fn kernels(mechanism: &Mechanism) -> (Model, Vec<Kernel>) {
    let mut model = Model::new(mechanism);
    let mut kernels = floating::kernels(&mut model);
    for leg in 0..2 {
        kernels.extend(stance::kernels(&mut model, leg));
        kernels.extend(staging::kernels(&mut model, leg));
        kernels.extend(impact::kernels(&mut model, leg));
        kernels.extend(curvature::kernels(&mut model, leg));
    }
    kernels.push(impact::both_feet(&mut model));
    (model, kernels)
}
