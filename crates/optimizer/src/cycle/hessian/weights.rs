//! What every quantity of every instant weighs in the Lagrangian: ∂L/∂quantity at fixed Θ.

use super::PhaseWork;
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use crate::cycle::problem::{CLOSURE, equalities};
use crate::instant::direction;

impl Cycle<'_> {
    /// ∂L/∂(quantities) of half step `k`, and the gradient of its part of L.
    pub(super) fn weigh(&self, k: usize, lambda: &[f64], mu: &[f64], work: &mut PhaseWork) {
        let p = &self.phases[k];
        let count = p.instants.quantities.len();
        let nodes = p.mesh.nodes.len();
        let (t, per_work) = (p.duration(), self.per_work());
        work.weights.clear();
        work.weights.resize(nodes * count, 0.0);
        for (node, quantity, partial) in &p.cost.partials {
            work.weights[node * count + quantity] += t * partial * per_work;
        }
        let weights = &mut work.weights;
        self.weighted_path_rows(mu, |phase, node, constraint, multiplier| {
            if phase == k {
                constraint.partials(p.linearized(node), |quantity, partial| {
                    weights[node * count + quantity] -= multiplier * partial
                });
            }
        });
        self.weighted_dips(k, mu, |dip, multiplier| {
            for (i, share) in dip.lowest.shape.iter().enumerate() {
                let node = dip.first() + i;
                self.path[dip.constraint].partials(p.linearized(node), |quantity, partial| {
                    weights[node * count + quantity] -= multiplier * share * partial
                });
            }
        });
        let held = self.holding().zip(&lambda[equalities(self.description())..]);
        for ((_, joint, node), multiplier) in held.filter(|((phase, ..), _)| *phase == k) {
            weights[node * count + p.instants.quantities.rate(joint)] -= multiplier / self.units.rate();
        }
        let speed = lambda[self.speed_equation()];
        work.travel = -speed / self.units.length;

        // Gradient in the local parameters: all rows with their weights.
        let np = p.layout.len();
        let gradient = &mut work.gradient;
        gradient.fill(0.0);
        for node in 0..nodes {
            for (row, w) in p.instants.gradients(node).chunks(np).zip(&work.weights[node * count..]) {
                if *w != 0.0 {
                    gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
                }
            }
        }
        let last = p.last() * np;
        let terminal = [
            (work.travel, &p.travel_p[..]),
            (-lambda[CLOSURE * k], &p.stance.beta_p[last..][..np]),
            (-lambda[CLOSURE * k + 1] / self.units.angular_momentum(), &p.stance.sigma_p[last..][..np]),
        ];
        for (w, row) in terminal {
            gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
        }
        gradient[p.layout.duration()] += p.cost.value * per_work;
    }
}

impl PhaseWork {
    /// Weights of the swing foot's height and vertical velocity that the clearance stands for.
    pub(super) fn swing_weights(&self, p: &Phase, node: usize) -> (f64, f64) {
        let y = p.instants.quantities;
        let w = self.weights[node * y.len() + y.clearance()];
        if node == 0 || node == p.last() {
            (0.0, w * direction(usize::from(node == p.last())) * p.duration())
        } else {
            let s = p.mesh.nodes[node].0;
            (w / (4.0 * s * (1.0 - s)), 0.0)
        }
    }

    /// Weight of the platform's x at a node.
    pub(super) fn travel_weight(&self, p: &Phase, node: usize) -> f64 {
        if node == 0 {
            -self.travel
        } else if node == p.last() {
            self.travel
        } else {
            0.0
        }
    }
}
