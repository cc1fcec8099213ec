//! C1 (eq. 13): Σ Γj² by the quadrature of the collocation nodes.

use super::Integral;
use crate::flow::Mesh;
use crate::instant::Instants;

pub fn integrate(mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    for (node, weight) in mesh.weights.iter().copied().enumerate() {
        let y = instants.row(node);
        for k in 0..integral.drives.len() {
            let drive = &integral.drives[k];
            let (torque, weight) = (drive.torque(y), weight * drive.sharing);
            integral.value += weight * torque * torque;
            let first = 2.0 * weight * torque;
            drive.torque_curvature(y, |a, b, second| integral.seconds.push((node, a, b, first * second)));
            integral.add(node, &drive.torque_partials(y), first, 2.0 * weight);
        }
    }
}
