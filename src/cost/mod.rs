//! The criteria (§4.3), one file each: integrals over s of what the instants hold.

mod energy;
mod torque;

use crate::instant::Instants;
use crate::lgl::NODES;
use crate::model::Description;
use crate::motion::Criterion;
use crate::stance::Mesh;

/// Integral over s ∈ [0, 1] of a criterion's integrand, and its partial derivatives.
#[derive(Clone, Debug)]
pub struct Integral {
    pub value: f64,
    /// (node, quantity, partial derivative).
    pub partials: Vec<(usize, usize, f64)>,
    /// (node, quantity, quantity, second derivative), each unordered pair once.
    pub seconds: Vec<(usize, usize, usize, f64)>,
    /// Kinks of |power|: second derivative `weight · ∇power(root) ∇power(root)ᵀ` each.
    pub kinks: Vec<Kink>,
}

impl Integral {
    /// Room for the integral of any criterion over a mesh.
    pub fn new(description: &Description, mesh: &Mesh) -> Integral {
        let samples = description.joints() * mesh.elements * NODES;
        Integral {
            value: 0.0,
            partials: Vec::with_capacity(2 * samples),
            seconds: Vec::with_capacity(3 * samples),
            kinks: Vec::with_capacity(samples),
        }
    }
}

/// A simple root of a joint's power inside an element.
#[derive(Clone, Debug)]
pub struct Kink {
    pub joint: usize,
    /// First node of the element.
    pub first: usize,
    /// Values of the Lagrange polynomials at the root.
    pub shape: [f64; NODES],
    pub weight: f64,
    /// Slope of the power at the root, per element.
    pub slope: f64,
}

/// Integral of the integrand of `criterion` over one half step, per unit of s (multiply by T).
///
/// `smoothing` (W) rounds the kinks of |power| off, as √(power² + smoothing²) − smoothing; 0 for the criterion itself.
pub fn integrate(
    criterion: Criterion,
    smoothing: f64,
    description: &Description,
    mesh: &Mesh,
    instants: &Instants,
    integral: &mut Integral,
) {
    integral.value = 0.0;
    integral.partials.clear();
    integral.seconds.clear();
    integral.kinks.clear();
    match criterion {
        Criterion::Torque => torque::integrate(description, mesh, instants, integral),
        Criterion::Energy if smoothing > 0.0 => {
            energy::integrate_smooth(smoothing, description, mesh, instants, integral)
        }
        Criterion::Energy => energy::integrate(description, mesh, instants, integral),
    }
}
