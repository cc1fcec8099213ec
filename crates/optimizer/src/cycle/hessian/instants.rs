//! Second-order terms of all instants, in the local parameters of a phase: products of gradients of quantities, at one node or over several,
//! and then every node (`node`).

use super::PhaseWork;
use super::products::{product, square};
use crate::constraints::PathConstraint;
use crate::cycle::Cycle;
use crate::cycle::phase::Phase;
use crate::lgl::NODES;

impl Cycle<'_> {
    /// Second-order terms of all instants of phase `k`, in the local parameters.
    pub(super) fn instant_terms(&self, k: usize, mu: &[f64], work: &mut PhaseWork) {
        let (d, p) = (self.description(), &self.phases[k]);
        work.seconds.fill(0.0);
        self.products(p, work);
        self.kinks_of_power(p, work);
        self.turns(p, work);
        self.limits(k, mu, work);
        for node in 0..p.mesh.nodes.len() {
            work.node(self.gait, d, p, node);
        }
    }

    /// What the criterion's integral is multiplied by.
    fn scale_of_cost(&self, p: &Phase) -> f64 {
        p.duration() * self.per_work()
    }

    /// Products of quantities in the criterion: squares of torques, torque times rate, cones.
    fn products(&self, p: &Phase, work: &mut PhaseWork) {
        let count = p.instants.width().pow(2);
        let scale = self.scale_of_cost(p);
        for (node, a, b, second) in &p.cost.seconds {
            let (ga, gb) = (p.instants.gradient(*node, *a), p.instants.gradient(*node, *b));
            let w = &mut work.seconds[node * count..(node + 1) * count];
            if a == b {
                square(w, ga, second * scale);
            } else {
                // The gradient of a rate is sparse.
                product(w, gb, ga, second * scale);
            }
        }
    }

    /// Roots of a power, where its magnitude has kinks: they move.
    fn kinks_of_power(&self, p: &Phase, work: &mut PhaseWork) {
        let (d, scale) = (self.description(), self.scale_of_cost(p));
        let PhaseWork { local, h, .. } = work;
        for kink in &p.cost.kinks {
            local.fill(0.0);
            for (i, shape) in kink.shape.iter().enumerate().take(NODES) {
                let node = kink.first + i;
                let partials = kink.partials(&p.cost.drives[kink.drive], p.linearized(node));
                p.add_partials(d, node, &partials, *shape, local);
            }
            square(h, local, kink.weight * scale);
        }
    }

    /// Where a joint that rubs turns around: its power jumps, at a time that moves.
    fn turns(&self, p: &Phase, work: &mut PhaseWork) {
        let (d, scale) = (self.description(), self.scale_of_cost(p));
        for turn in &p.cost.turns {
            let drive = &p.cost.drives[turn.drive];
            let (mut a, mut b) = (p.no_parameters(), p.no_parameters());
            for i in 0..NODES {
                let node = turn.first + i;
                p.add_quantity(d, node, drive.rate(), turn.shape[i], &mut a);
                p.add_quantity(d, node, drive.rate(), turn.by_rate[i], &mut b);
                for (quantity, partial) in drive.torque_partials(p.linearized(node)) {
                    p.add_quantity(d, node, quantity, turn.by_torque[i] * partial, &mut b);
                }
            }
            product(&mut work.h, &a, &b, scale);
        }
    }

    /// The limits' own curvature, and that of their least values between nodes.
    fn limits(&self, k: usize, mu: &[f64], work: &mut PhaseWork) {
        let (d, p) = (self.description(), &self.phases[k]);
        let count = p.instants.width().pow(2);
        let PhaseWork { seconds, local, h, .. } = work;
        let mut bend = |node: usize, constraint: &PathConstraint, weight: f64| {
            constraint.curvature(p.linearized(node), |a, b, second| {
                let [a, b] = [a, b].map(|quantity| p.instants.gradient(node, quantity));
                product(&mut seconds[node * count..(node + 1) * count], a, b, weight * second);
            });
        };
        self.weighted_path_rows(k, mu, |node, constraint, multiplier| bend(node, constraint, -0.5 * multiplier));
        self.weighted_dips(k, mu, |dip, multiplier| {
            // The minimum moves: its slope's gradient twice, over the curvature in s.
            local.fill(0.0);
            let constraint = &p.path[dip.constraint];
            for (i, (share, by)) in dip.lowest.shape.iter().zip(&dip.lowest.slopes).enumerate() {
                let node = dip.first() + i;
                p.add_constraint(d, node, constraint, *by, local);
                bend(node, constraint, -0.5 * multiplier * share);
            }
            square(h, local, multiplier / dip.lowest.curvature);
            let Some(turn) = &dip.lowest.turn else { return };
            let (mut a, mut b) = (p.no_parameters(), p.no_parameters());
            let [by_value, by_rate] = &turn.bend;
            for i in 0..NODES {
                let node = dip.first() + i;
                p.add_quantity(d, node, turn.rate, dip.lowest.shape[i], &mut a);
                p.add_quantity(d, node, turn.rate, by_rate[i], &mut b);
                p.add_constraint(d, node, constraint, by_value[i], &mut b);
            }
            product(h, &a, &b, -multiplier);
        });
    }
}
