//! Everything that constraints and criteria look at, at each instant of a half step.
//!
//! The *quantities* of an instant are the torques of all joints, the reaction, the joints' angles and
//! rates, and the swing foot's clearance; each with its gradient in the half step's parameters.

use crate::model::{Description, Gait};
use crate::stance::{Layout, Mesh, Prescribed, Stance, basis_derivatives};

/// Where each quantity stands.
#[derive(Clone, Copy, Debug)]
pub struct Quantities {
    joints: usize,
    components: usize,
}

impl Quantities {
    pub fn new(description: &Description) -> Quantities {
        Quantities { joints: description.joints(), components: description.positions() }
    }

    /// Γj, N·m.
    pub fn torque(&self, joint: usize) -> usize {
        joint
    }

    /// Component of the reaction at the stance foot, N.
    pub fn force(&self, component: usize) -> usize {
        self.joints + component
    }

    /// Joint angle, rad.
    pub fn angle(&self, joint: usize) -> usize {
        self.joints + self.components + joint
    }

    /// Joint rate, rad/s.
    pub fn rate(&self, joint: usize) -> usize {
        2 * self.joints + self.components + joint
    }

    /// Height of the swing foot over `4 s (1 − s)`: the height of the parabola that it touches, m.
    /// At both ends its limit: the vertical speed times T/4, up or down.
    pub fn clearance(&self) -> usize {
        3 * self.joints + self.components
    }

    pub fn len(&self) -> usize {
        self.clearance() + 1
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}

/// The quantities at all nodes of a half step.
#[derive(Clone, Debug)]
pub struct Instants {
    pub quantities: Quantities,
    layout: Layout,
    /// One row of quantities per node.
    pub values: Vec<f64>,
    /// Per node and quantity a row of derivatives in the local parameters.
    gradients: Vec<f64>,
    /// q̈, p and swing foot per node, for reports.
    pub states: Vec<State>,
    /// Kernel results per node, kept between evaluation and differentiation.
    inverse: Vec<Vec<f64>>,
    placement: Vec<Vec<f64>>,
    swing: [Vec<f64>; 2],
    prescribed: Prescribed,
    betadd_p: Vec<f64>,
}

/// The configuration at one node.
#[derive(Clone, Debug, Default)]
pub struct State {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
}

impl Instants {
    pub fn new(description: &Description, mesh: &Mesh) -> Instants {
        let quantities = Quantities::new(description);
        let layout = Layout::new(description, &mesh.basis);
        let (nq, nj, nc) = (description.orientations(), description.joints(), description.positions());
        let n = mesh.nodes.len();
        let rows = nj + nc + 1;
        Instants {
            quantities,
            layout,
            values: vec![0.0; n * quantities.len()],
            gradients: vec![0.0; n * quantities.len() * layout.len()],
            states: vec![State { q: vec![0.0; nq], qd: vec![0.0; nq] }; n],
            inverse: vec![vec![0.0; 1 + nj + nc + rows * 3 * nq]; n],
            placement: vec![vec![0.0; 2 * nc + 2 * nc * nq]; n],
            swing: [vec![0.0; nc + nc * 2 * nq], vec![0.0; nc + nc * 2 * nq]],
            prescribed: Prescribed::new(layout.prescribed),
            betadd_p: vec![0.0; layout.len()],
        }
    }

    /// Value of a quantity at a node.
    pub fn value(&self, node: usize, quantity: usize) -> f64 {
        self.values[node * self.quantities.len() + quantity]
    }

    /// Gradient of a quantity at a node in the local parameters.
    pub fn gradient(&self, node: usize, quantity: usize) -> &[f64] {
        let np = self.layout.len();
        &self.gradients[(node * self.quantities.len() + quantity) * np..][..np]
    }

    /// Position of the platform's mass centre from the stance foot at a node, m.
    pub fn platform(&self, description: &Description, node: usize) -> &[f64] {
        &self.placement[node][..description.positions()]
    }

    /// Gradient of the platform's x at a node, in the local parameters.
    pub fn platform_x_gradient(&self, description: &Description, mesh: &Mesh, stance: &Stance, parameters: &[f64], node: usize, out: &mut [f64]) {
        let (nq, nc) = (description.orientations(), description.positions());
        let row = &self.placement[node][2 * nc..2 * nc + nq];
        self.chain(description, mesh, stance, parameters, node, &[(row, Order::Value)], out);
    }

    /// Evaluates all quantities; `stance` must have been integrated.
    pub fn evaluate(&mut self, gait: &dyn Gait, leg: usize, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let d = gait.description();
        let (nq, nj, nc) = (d.orientations(), d.joints(), d.positions());
        let t = parameters[self.layout.duration()];
        let last = mesh.collocation() - 1;
        let y = self.quantities;
        for (k, (s, jet)) in mesh.nodes.iter().enumerate() {
            self.prescribed.evaluate(&self.layout, &mesh.basis, jet, parameters);
            let state = &mut self.states[k];
            for j in 0..self.layout.prescribed {
                state.q[d.prescribed_index(j)] = self.prescribed.q[j];
                state.qd[d.prescribed_index(j)] = self.prescribed.qd[j];
            }
            state.q[d.unactuated] = stance.beta[k];
            state.qd[d.unactuated] = stance.betad[k];
            gait.inverse_jacobian(leg, &state.q, &state.qd, &self.prescribed.qdd, &mut self.inverse[k]);
            gait.placement(leg, &state.q, &mut self.placement[k]);
            let values = &mut self.values[k * y.len()..(k + 1) * y.len()];
            values[..nj + nc].copy_from_slice(&self.inverse[k][1..1 + nj + nc]);
            values[y.angle(0)..y.angle(0) + nj].copy_from_slice(&state.q[..nj]);
            values[y.rate(0)..y.rate(0) + nj].copy_from_slice(&state.qd[..nj]);
            values[y.clearance()] = if k == 0 || k == last {
                let end = usize::from(k == last);
                gait.swing_velocity(leg, &state.q, &state.qd, &mut self.swing[end]);
                let direction = if k == 0 { 1.0 } else { -1.0 };
                direction * self.swing[end][1] * t / 4.0
            } else {
                self.placement[k][nc + 1] / (4.0 * s * (1.0 - s))
            };
            debug_assert_eq!(state.q.len(), nq);
        }
    }

    /// Gradients of all quantities; `stance` must have been differentiated.
    pub fn differentiate(&mut self, description: &Description, mesh: &Mesh, stance: &Stance, parameters: &[f64]) {
        let d = description;
        let (nq, nj, nc, np) = (d.orientations(), d.joints(), d.positions(), self.layout.len());
        let y = self.quantities;
        let t = parameters[self.layout.duration()];
        let last = mesh.collocation() - 1;
        let mut gradients = std::mem::take(&mut self.gradients);
        for k in 0..mesh.nodes.len() {
            let inverse = &self.inverse[k];
            let row = |r: usize| &inverse[1 + nj + nc + r * 3 * nq..][..3 * nq];
            let block = &mut gradients[k * y.len() * np..(k + 1) * y.len() * np];
            // β̈ follows from the balance (eq. 10): its row tells how.
            let balance = row(nj + nc);
            let f1 = balance[2 * nq + d.unactuated];
            let mut betadd_p = std::mem::take(&mut self.betadd_p);
            let parts = [(&balance[..nq], Order::Value), (&balance[nq..2 * nq], Order::Rate), (&balance[2 * nq..], Order::Acceleration(None))];
            self.chain(d, mesh, stance, parameters, k, &parts, &mut betadd_p);
            for value in &mut betadd_p {
                *value /= -f1;
            }
            for r in 0..nj + nc {
                let row = row(r);
                let parts = [(&row[..nq], Order::Value), (&row[nq..2 * nq], Order::Rate), (&row[2 * nq..], Order::Acceleration(Some(&betadd_p)))];
                self.chain(d, mesh, stance, parameters, k, &parts, &mut block[r * np..(r + 1) * np]);
            }
            self.betadd_p = betadd_p;
            let unit = |j: usize| {
                let mut row = [0.0; 32];
                row[j] = 1.0;
                row
            };
            for j in 0..nj {
                let row = unit(j);
                let at = |quantity: usize| quantity * np..(quantity + 1) * np;
                self.chain(d, mesh, stance, parameters, k, &[(&row[..nq], Order::Value)], &mut block[at(y.angle(j))]);
                self.chain(d, mesh, stance, parameters, k, &[(&row[..nq], Order::Rate)], &mut block[at(y.rate(j))]);
            }
            let out = &mut block[y.clearance() * np..(y.clearance() + 1) * np];
            if k == 0 || k == last {
                let swing = &self.swing[usize::from(k == last)];
                let row = &swing[nc + 2 * nq..nc + 4 * nq];
                self.chain(d, mesh, stance, parameters, k, &[(&row[..nq], Order::Value), (&row[nq..], Order::Rate)], out);
                let direction = if k == 0 { 0.25 } else { -0.25 };
                for value in out.iter_mut() {
                    *value *= direction * t;
                }
                out[self.layout.duration()] += direction * swing[1];
            } else {
                let s = mesh.nodes[k].0;
                let row = &self.placement[k][2 * nc + nc * nq + nq..][..nq];
                self.chain(d, mesh, stance, parameters, k, &[(row, Order::Value)], out);
                for value in out.iter_mut() {
                    *value /= 4.0 * s * (1.0 - s);
                }
            }
        }
        self.gradients = gradients;
    }

    /// Chain rule from rows of partial derivatives in q, q̇ or q̈ to the local parameters.
    fn chain(&self, d: &Description, mesh: &Mesh, stance: &Stance, parameters: &[f64], node: usize, parts: &[(&[f64], Order)], out: &mut [f64]) {
        let layout = &self.layout;
        let (jet, t, np) = (&mesh.nodes[node].1, parameters[layout.duration()], layout.len());
        out.fill(0.0);
        for (row, order) in parts {
            for j in 0..layout.prescribed {
                let partial = row[d.prescribed_index(j)];
                if partial == 0.0 {
                    continue;
                }
                let mut by_duration = 0.0;
                for i in 0..layout.per_joint {
                    let [value, rate, acceleration] = basis_derivatives(&mesh.basis, jet, t, i);
                    out[layout.joint(j, i)] += partial * order.pick(value, rate, acceleration);
                    // ∂/∂T of basis·p: Q grows with the rates, Q̇ and Q̈ shrink with 1/T, 1/T².
                    let p = parameters[layout.joint(j, i)];
                    let is_rate = mesh.basis.is_rate(i);
                    let exponent = match order {
                        Order::Value => f64::from(u8::from(is_rate)),
                        Order::Rate => f64::from(u8::from(is_rate)) - 1.0,
                        Order::Acceleration(_) => f64::from(u8::from(is_rate)) - 2.0,
                    };
                    by_duration += exponent * order.pick(value, rate, acceleration) * p / t;
                }
                out[layout.duration()] += partial * by_duration;
            }
            let partial = row[d.unactuated];
            let sensitivity = match order {
                Order::Value => &stance.beta_p[node * np..(node + 1) * np],
                Order::Rate => &stance.betad_p[node * np..(node + 1) * np],
                Order::Acceleration(Some(betadd_p)) => betadd_p,
                Order::Acceleration(None) => continue,
            };
            for (o, s) in out.iter_mut().zip(sensitivity) {
                *o += partial * s;
            }
        }
    }
}

/// Which time derivative of q a row of partial derivatives belongs to.
enum Order<'a> {
    Value,
    Rate,
    /// With β̈'s sensitivities, or without (as the balance that determines them needs).
    Acceleration(Option<&'a [f64]>),
}

impl Order<'_> {
    fn pick(&self, value: f64, rate: f64, acceleration: f64) -> f64 {
        match self {
            Order::Value => value,
            Order::Rate => rate,
            Order::Acceleration(_) => acceleration,
        }
    }
}
