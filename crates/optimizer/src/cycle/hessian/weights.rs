//! What every quantity of every instant weighs in the Lagrangian: ∂L/∂quantity at fixed Θ.

use super::PhaseWork;
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use crate::swing::Factor;
use piaffe_sqp::combine;

impl Cycle<'_> {
    /// ∂L/∂(quantities) of phase `k`, and the gradient of its part of L.
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
        self.weighted_path_rows(k, mu, |node, constraint, multiplier| {
            constraint.partials(p.linearized(node), |quantity, partial| {
                weights[node * count + quantity] -= multiplier * partial
            });
        });
        self.weighted_dips(k, mu, |dip, multiplier| {
            for (i, share) in dip.lowest.shape.iter().enumerate() {
                let node = dip.first() + i;
                p.path[dip.constraint].partials(p.linearized(node), |quantity, partial| {
                    weights[node * count + quantity] -= multiplier * share * partial
                });
            }
            for (node, quantity, by) in dip.of_turn() {
                weights[node * count + quantity] -= multiplier * by;
            }
        });
        for (row, (_, joint, node)) in self.rows.holding().filter(|(_, (phase, ..))| *phase == k) {
            weights[node * count + p.instants.quantities.rate(joint)] -= lambda[row] / self.units.rate();
        }
        let speed = lambda[self.speed_equation()];
        work.travel = -speed / self.units.length;
        let touchdown = self.rows.of(k).touchdown.map_or(0.0, |row| lambda[row]);
        work.landing = -touchdown / self.units.length;

        // The same in the states, and from there in the local parameters: all rows with their weights.
        let (np, width) = (p.layout.len(), p.instants.width());
        let gradient = &mut work.gradient;
        gradient.fill(0.0);
        work.states.fill(0.0);
        for (node, state) in work.states.chunks_mut(width).enumerate() {
            combine(&work.weights[node * count..][..count], p.instants.gradients(node), state);
            p.pull(self.description(), node, state, gradient);
        }
        let last = p.last() * np;
        let [beta, sigma] = self.closures(k, lambda);
        let terminal = [
            (work.travel, &p.travel_p[..]),
            (-beta, &p.flow.beta_p[last..][..np]),
            (-sigma / self.units.angular_momentum(), &p.flow.sigma_p[last..][..np]),
        ];
        for (w, row) in terminal {
            gradient.iter_mut().zip(row).for_each(|(g, r)| *g += w * r);
        }
        gradient[p.layout.duration()] += p.cost.value * per_work;
        if let Some(fall) = p.fall(self.description()) {
            fall.add_height_gradient(1.0, work.landing, &mut gradient[p.layout.duration()..]);
        }
    }
}

impl PhaseWork {
    /// What the clearance of a foot at a node is made of, and the clearance's weight.
    pub(super) fn of_clearance(&self, p: &Phase, node: usize, foot: usize) -> (Factor, f64) {
        let y = p.instants.quantities;
        let factor = p.instants.factor(&p.mesh, node, foot);
        (factor, self.weights[node * y.len() + y.clearance(foot)])
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
