//! The criteria (§4.3), one file each: integrals over s of what the instants hold.

mod drive;
mod energy;
mod sides;
mod torque;

pub use drive::{Drive, Partials};

use crate::flow::Mesh;
use crate::instant::Instants;
use crate::lgl::NODES;
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Mode};

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
    /// Jumps of the torque.
    pub turns: Vec<Turn>,
    /// By drive and element, where powers have which sign.
    pub signs: Vec<Signs>,
    /// ∂value/∂(dry friction) of each drive.
    pub by_coulomb: Vec<f64>,
    /// What is summed over.
    pub drives: Vec<Drive>,
    /// Of joints that are held still, those with dry friction.
    pub held: Vec<Drive>,
    /// Joints that do not turn around where they nearly do.
    pub going: Vec<Going>,
}

impl Integral {
    /// Room for the integral of any criterion over a mesh.
    pub fn new(description: &Description, mode: Mode, mesh: &Mesh) -> Integral {
        let drives = Drive::all(description, mode);
        let nodes = mesh.elements * NODES;
        let most = drives.iter().map(Drive::most).fold((0, 0), |sum, (a, b)| (sum.0 + a, sum.1 + b));
        Integral {
            value: 0.0,
            partials: Vec::with_capacity(most.0 * nodes),
            seconds: Vec::with_capacity(most.1 * nodes),
            kinks: Vec::with_capacity(drives.len() * nodes),
            turns: Vec::with_capacity(drives.len() * nodes),
            signs: Vec::with_capacity(drives.len() * mesh.elements),
            by_coulomb: vec![0.0; drives.len()],
            drives,
            held: Vec::new(),
            going: Vec::new(),
        }
    }

    /// Adds the derivatives of a function of something with this gradient, whose derivatives in that are `first` and `second`.
    fn add(&mut self, node: usize, gradient: &Partials, first: f64, second: f64) {
        for (k, (a, by_a)) in gradient.iter().enumerate() {
            self.partials.push((node, *a, first * by_a));
            if second != 0.0 {
                let pairs = gradient[k..].iter().map(|(b, by_b)| (node, *a, *b, second * by_a * by_b));
                self.seconds.extend(pairs);
            }
        }
    }
}

/// A simple root inside an element of a joint's power, or of its rate.
#[derive(Clone, Debug)]
pub struct Kink {
    /// Which of the drives.
    pub drive: usize,
    pub bend: Bend,
    /// First node of the element.
    pub first: usize,
    /// Values of the Lagrange polynomials at the root.
    pub shape: [f64; NODES],
    pub weight: f64,
    /// Slope of the power, or of the rate, at the root, per element.
    pub slope: f64,
}

/// A joint that goes on the same way in an element.
#[derive(Clone, Copy, Debug)]
pub struct Going {
    pub joint: usize,
    pub element: usize,
    /// Of its rate.
    pub sign: f64,
    /// Where it comes nearest to turning around.
    pub nearest: Nearest,
}

/// Where in an element a joint comes nearest to turning around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nearest {
    /// Where its rate is stationary.
    Inside,
    /// With the phase, which begins with the element.
    Beginning,
    /// With the phase, which ends with the element.
    End,
}

/// A power in an element in which dry friction keeps its sign.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    pub drive: usize,
    pub element: usize,
    /// The sign of dry friction; 0 without any.
    pub side: f64,
    /// ω with ∫ |power| = Σ ω power(node), per unit of the element.
    pub weights: [f64; NODES],
}

/// What vanishes at a kink.
#[derive(Clone, Copy, Debug)]
pub enum Bend {
    /// The power, where dry friction has this sign.
    Power { side: f64 },
    /// The rate.
    Rate,
}

impl Kink {
    /// Gradient of what vanishes.
    pub fn partials(&self, drive: &Drive, y: &[f64]) -> Partials {
        match self.bend {
            Bend::Power { side } => drive.power_partials(y, side),
            Bend::Rate => Partials::from_slice(&[(drive.rate(), 1.0)]),
        }
    }
}

/// A simple root of a joint's rate inside an element, at which its torque jumps: second derivative `a bᵀ + b aᵀ`, where a is the
/// gradient of the rate at the root.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Which of the drives.
    pub drive: usize,
    /// First node of the element.
    pub first: usize,
    /// Values of the Lagrange polynomials at the root.
    pub shape: [f64; NODES],
    /// b: weights of the gradients of the torque and of the rate at the nodes.
    pub by_torque: [f64; NODES],
    pub by_rate: [f64; NODES],
}

/// Integral of the integrand of `criterion` over one phase, per unit of s (multiply by T).
///
/// `smoothing` (W) rounds the kinks of |power| off, as √(power² + smoothing²) − smoothing; 0 for the criterion itself.
pub fn integrate(criterion: Criterion, smoothing: f64, mesh: &Mesh, instants: &Instants, integral: &mut Integral) {
    integral.value = 0.0;
    integral.partials.clear();
    integral.seconds.clear();
    integral.kinks.clear();
    integral.turns.clear();
    integral.signs.clear();
    integral.by_coulomb.clear();
    integral.by_coulomb.resize(integral.drives.len(), 0.0);
    match criterion {
        Criterion::Torque => torque::integrate(mesh, instants, integral),
        Criterion::Energy if smoothing > 0.0 => energy::integrate_smooth(smoothing, mesh, instants, integral),
        Criterion::Energy => energy::integrate(mesh, instants, integral),
    }
}
