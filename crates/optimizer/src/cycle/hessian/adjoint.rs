//! Multipliers of what is implicit: the collocation equations of (β, σ), and the balance of eq. 10 at every node.

use super::PhaseWork;
use crate::cycle::phase::Phase;
use crate::flow::{Flow, Mesh};
use crate::lgl::NODES;
use piaffe_model::units::Units;
use piaffe_model::{Description, FORWARD};

impl PhaseWork {
    /// Multipliers of the collocation equations, from the last element to the first.
    pub(super) fn adjoint(&mut self, d: &Description, units: &Units, p: &Phase, [beta, sigma]: [f64; 2]) {
        let nodes = p.mesh.nodes.len();
        self.omega.clear();
        self.omega.resize(nodes, [0.0; 2]);
        self.stationarity.clear();
        self.direct.clear();
        for node in 0..nodes {
            let direct = self.direct(d, p, node);
            let (by_beta, by_sigma, _) = p.flow.partials(node);
            self.direct.push(direct);
            self.stationarity.push([direct[0] + direct[1] * by_beta, direct[1] * by_sigma]);
        }
        let last = p.last();
        self.stationarity[last][0] -= beta;
        self.stationarity[last][1] -= sigma / units.angular_momentum();
        p.flow.adjoint(&p.mesh, p.duration(), &mut self.stationarity, &mut self.omega);
    }

    /// ∂L/∂β and ∂L/∂β̇ through the quantities of a node, β̈ eliminated; and the balance's multiplier.
    fn direct(&self, d: &Description, p: &Phase, node: usize) -> [f64; 3] {
        let nq = d.orientations();
        let entry = |row: &[f64], order: usize| row[order * nq + d.unactuated];
        let width = p.instants.width();
        let state = &self.states[node * width..][..width];
        let row = p.instants.balance(node);
        let balance = -entry(state, 2) / entry(row, 2);
        let (placement, shape) = (p.instants.placement(node), &p.shapes.placement);
        let travel = self.travel_weight(p, node) * placement[shape.p_q.index(FORWARD, d.unactuated)];
        let beta = entry(state, 0) + balance * entry(row, 0) + travel;
        let betad = entry(state, 1) + balance * entry(row, 1);
        [beta, betad, balance]
    }
}

impl Flow {
    /// Backward sweep: `stationarity` holds ∂L/∂(β, σ) per node at fixed rates; on return `omega`, zero before, holds the
    /// weights of T β̇ and T σ̇.
    fn adjoint(&self, mesh: &Mesh, t: f64, stationarity: &mut [[f64; 2]], omega: &mut [[f64; 2]]) {
        const M: usize = NODES - 1;
        let a = &mesh.lobatto.integral;
        let share = 1.0 / mesh.elements as f64;
        for e in (0..mesh.elements).rev() {
            let first = e * M;
            // Right side: −∂L/∂(β, σ) of the element's own nodes, with what ω already weighs.
            let mut right = [[0.0; 2]; M];
            for j in 1..NODES {
                let node = first + j;
                let (by_beta, by_sigma, moment) = self.partials(node);
                let [wb, ws] = omega[node];
                right[j - 1] = [
                    -(stationarity[node][0] + t * (wb * by_beta + ws * moment)),
                    -(stationarity[node][1] + t * wb * by_sigma),
                ];
            }
            let eta = self.system(mesh, e, t).solve_transposed(&right);
            let mut sums = [0.0; 2];
            for i in 1..NODES {
                for j in 0..NODES {
                    omega[first + j][0] -= share * a[i][j] * eta[i - 1][0];
                    omega[first + j][1] -= share * a[i][j] * eta[i - 1][1];
                }
                sums[0] += eta[i - 1][0];
                sums[1] += eta[i - 1][1];
            }
            stationarity[first][0] -= sums[0];
            stationarity[first][1] -= sums[1];
        }
    }
}
