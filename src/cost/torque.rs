//! C1 (eq. 13): Σ Γj² by the quadrature of the collocation nodes.

use super::Integral;
use crate::instant::Instants;
use crate::model::Description;
use crate::stance::Mesh;

pub fn integrate(description: &Description, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (node, weight) in mesh.weights.iter().copied().enumerate() {
        for j in 0..description.joints() {
            let quantity = instants.quantities.torque(j);
            let torque = instants.value(node, quantity);
            integral.value += weight * torque * torque;
            integral.partials.push((node, quantity, 2.0 * weight * torque));
            integral.seconds.push((node, quantity, quantity, 2.0 * weight));
        }
    }
}
