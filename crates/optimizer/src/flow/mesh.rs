//! Where a phase is looked at: elements, their nodes, and the polynomials' basis at each.

use crate::lgl::{Lobatto, NODES};
use crate::trajectory::{Basis, Jet};

/// Discretization of one phase.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub elements: usize,
    pub lobatto: Lobatto,
    pub basis: Basis,
    /// s of every collocation node and the basis there.
    pub nodes: Vec<(f64, Jet)>,
    /// Quadrature weight of each collocation node on [0, 1].
    pub weights: Vec<f64>,
}

impl Mesh {
    pub fn new(elements: usize, order: usize) -> Mesh {
        let (lobatto, basis) = (Lobatto::new(), Basis::new(order));
        let mut nodes = Vec::new();
        for e in 0..elements {
            let first = usize::from(e > 0);
            for c in &lobatto.nodes[first..] {
                let s = (e as f64 + c) / elements as f64;
                nodes.push((s, basis.jet(s)));
            }
        }
        let mut weights = vec![0.0; nodes.len()];
        for e in 0..elements {
            for (j, w) in lobatto.weights.iter().enumerate() {
                weights[e * (NODES - 1) + j] += w / elements as f64;
            }
        }
        Mesh { elements, lobatto, basis, nodes, weights }
    }

    /// Element that contains `s`.
    pub fn element(&self, s: f64) -> usize {
        ((s * self.elements as f64) as usize).min(self.elements - 1)
    }
}
