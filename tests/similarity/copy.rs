//! Froude copies: a gait of a robot of the same shape and build, of another size and weight.

use piaffe::model::shape::{Block, LateGradient, MomentumTerms};
use piaffe::model::{Body, Description, Gait, Spot};

/// By what factor each dimension grows; gravity stays.
#[derive(Clone, Copy, Debug)]
pub struct Factors {
    pub mass: f64,
    pub length: f64,
    pub time: f64,
}

impl Factors {
    pub fn new(length: f64, mass: f64) -> Factors {
        Factors { mass, length, time: length.sqrt() }
    }

    pub fn speed(&self) -> f64 {
        self.length / self.time
    }

    fn rate(&self) -> f64 {
        1.0 / self.time
    }

    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }

    fn torque(&self) -> f64 {
        self.force() * self.length
    }

    fn inertia(&self) -> f64 {
        self.mass * self.length * self.length
    }

    /// Of an angular momentum.
    fn turn(&self) -> f64 {
        self.inertia() / self.time
    }

    fn impulse(&self) -> f64 {
        self.mass * self.speed()
    }

    /// Of the criteria per metre, energy and torque.
    pub fn costs(&self) -> [f64; 2] {
        [self.force(), self.torque() * self.torque() * self.time / self.length]
    }
}

/// The generated dynamics of a gait, as those of a copy of its robot.
pub struct Copy<'a> {
    gait: &'a dyn Gait,
    description: Description,
    by: Factors,
}

impl<'a> Copy<'a> {
    pub fn new(gait: &'a dyn Gait, by: Factors) -> Copy<'a> {
        let mut d = gait.description().clone();
        let body = |b: &mut Body| {
            b.offset = b.offset.map(|x| x * by.length);
            b.com = b.com.map(|x| x * by.length);
            b.mass *= by.mass;
            b.inertia = b.inertia.map(|row| row.map(|x| x * by.inertia()));
        };
        let spot = |s: &mut Spot| s.at = s.at.map(|x| x * by.length);
        d.bodies.to_mut().iter_mut().for_each(body);
        for leg in &mut d.legs {
            leg.foot = leg.foot.map(|x| x * by.length);
            for member in leg.members.to_mut() {
                member.bodies.to_mut().iter_mut().for_each(body);
                member.foot = member.foot.map(|x| x * by.length);
                member.spots.to_mut().iter_mut().for_each(spot);
            }
        }
        d.corners.to_mut().iter_mut().for_each(spot);
        for joint in d.joints.to_mut() {
            joint.max_torque *= by.torque();
            joint.unloaded_speed *= by.rate();
            joint.loaded_speed *= by.rate();
            joint.rotor_inertia *= by.inertia();
        }
        d.limits.min_vertical_force *= by.force();
        d.limits.swing_clearance *= by.length;
        d.limits.half_step_duration = d.limits.half_step_duration.map(|t| t * by.time);
        d.limits.min_platform_height *= by.length;
        d.limits.body_clearance *= by.length;
        Copy { gait, description: d, by }
    }

    /// Rates of the copy as the original has them.
    fn rates(&self, qd: &[f64]) -> Vec<f64> {
        qd.iter().map(|x| x * self.by.time).collect()
    }

    fn accelerations(&self, qdd: &[f64]) -> Vec<f64> {
        qdd.iter().map(|x| x * self.by.time * self.by.time).collect()
    }

    /// Scales rows of a Jacobian whose columns are as many q, q̇ and so on; `units` of the rows.
    fn jacobian(&self, out: &mut [f64], units: &[f64], orders: usize) {
        let nq = self.description.orientations();
        for (row, unit) in out.chunks_mut(orders * nq).zip(units) {
            for (order, part) in row.chunks_mut(nq).enumerate() {
                let factor = unit * self.by.time.powi(order as i32);
                part.iter_mut().for_each(|x| *x *= factor);
            }
        }
    }

    /// Gradient and second derivatives of a weighted sum.
    fn second(&self, out: &mut [f64]) {
        let (nq, t, shape) = (self.description.orientations(), self.by.time, &self.description.shapes.curvature);
        let gradient = shape.gradient.of_mut(out);
        scale(&mut gradient[nq..2 * nq], t);
        scale(&mut gradient[2 * nq..], t * t);
        for (block, factor) in [(shape.q_qd, t), (shape.q_qdd, t * t), (shape.qd_qd, t * t)] {
            scale(block.of_mut(out), factor);
        }
    }

    /// Scales values and their gradients in q, q̇ and so on.
    fn with_gradients(&self, out: &mut [f64], unit: f64, [values, rows]: [Block; 2], orders: usize) {
        scale(values.of_mut(out), unit);
        self.jacobian(rows.of_mut(out), &vec![unit; values.len()], orders);
    }
}

fn scale(numbers: &mut [f64], factor: f64) {
    numbers.iter_mut().for_each(|x| *x *= factor);
}

/// Kernels that nobody asks for here.
macro_rules! absent {
    ($($name:ident($($argument:ident: $type:ty),*);)*) => {
        $(fn $name(&self, $(_: $type,)* out: &mut [f64]) {
            out.fill(f64::NAN);
        })*
    };
}

impl Gait for Copy<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn latex(&self) -> &'static str {
        self.gait.latex()
    }

    absent! {
        inertia(q: &[f64]);
        bias(q: &[f64], qd: &[f64]);
        inertia_and_bias(q: &[f64], qd: &[f64]);
        energy(x: &[f64], xd: &[f64]);
        centre_of_mass(x: &[f64], xd: &[f64]);
        foot(leg: usize, x: &[f64]);
        foot_jacobian(leg: usize, q: &[f64]);
        foot_bias(leg: usize, q: &[f64], qd: &[f64]);
        angular_momentum(leg: usize, x: &[f64], xd: &[f64]);
        reduced(leg: usize, q: &[f64], qd: &[f64]);
        forward(leg: usize, q: &[f64], qd: &[f64], gamma: &[f64]);
        impact(leg: usize, q: &[f64], xd: &[f64]);
        impact_both(q: &[f64], xd: &[f64]);
    }

    fn platform_velocity(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.platform_velocity(leg, q, &self.rates(qd), out);
        scale(out, self.by.speed());
    }

    fn momentum_terms(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.momentum_terms(leg, q, &self.rates(qd), out);
        let by = &self.by;
        let MomentumTerms { f1, f2, sigma, c, sigmadot, .. } = self.description.shapes.momentum_terms;
        let (inertia, turn) = (by.inertia(), by.turn());
        for (block, unit) in [(f1, inertia), (f2, turn), (sigma, turn), (c, by.length), (sigmadot, by.torque())] {
            scale(block.of_mut(out), unit);
        }
    }

    fn inverse(&self, leg: usize, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse(leg, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (shape, nc) = (&self.description.shapes.inverse, self.description.positions());
        let (by, square) = (&self.by, self.by.time * self.by.time);
        let (p, q) = shape.xdd.of_mut(out).split_at_mut(nc);
        scale(p, by.length / square);
        scale(q, 1.0 / square);
        scale(shape.gamma.of_mut(out), by.torque());
        scale(shape.f.of_mut(out), by.force());
    }

    fn momentum(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.momentum(leg, q, &self.rates(qd), out);
        let shape = &self.description.shapes.momentum;
        self.with_gradients(out, self.by.turn(), [shape.sigma, shape.sigma_w], 2);
    }

    fn inverse_jacobian(&self, leg: usize, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse_jacobian(leg, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (by, shape) = (&self.by, &self.description.shapes.inverse_jacobian);
        scale(shape.beta_dd.of_mut(out), 1.0 / (by.time * by.time));
        self.with_gradients(out, by.torque(), [shape.gamma, shape.gamma_w], 3);
        self.with_gradients(out, by.force(), [shape.f, shape.f_w], 3);
        self.jacobian(shape.balance_w.of_mut(out), &[by.torque()], 3);
    }

    fn placement(&self, leg: usize, q: &[f64], out: &mut [f64]) {
        self.gait.placement(leg, q, out);
        scale(out, self.by.length);
    }

    fn heights(&self, leg: usize, q: &[f64], out: &mut [f64]) {
        self.gait.heights(leg, q, out);
        scale(out, self.by.length);
    }

    fn heights_curvature(&self, leg: usize, q: &[f64], weights: &[f64], out: &mut [f64]) {
        let weights: Vec<f64> = weights.iter().map(|w| w * self.by.length).collect();
        self.gait.heights_curvature(leg, q, &weights, out);
    }

    fn swing_velocity(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.swing_velocity(leg, q, &self.rates(qd), out);
        let shape = &self.description.shapes.swing_velocity;
        self.with_gradients(out, self.by.speed(), [shape.v, shape.v_w], 2);
    }

    fn early(&self, leg: usize, actuated: &[f64], actuated_d: &[f64], out: &mut [f64]) {
        self.gait.early(leg, actuated, &self.rates(actuated_d), out);
    }

    fn late(&self, leg: usize, early: &[f64], beta: f64, out: &mut [f64]) {
        self.gait.late(leg, early, beta, out);
        let units = [self.by.inertia(), self.by.turn(), self.by.torque()];
        out.iter_mut().zip(units.into_iter().cycle()).for_each(|(x, unit)| *x *= unit);
    }

    fn late_gradient(&self, leg: usize, early: &[f64], beta: f64, out: &mut [f64]) {
        self.gait.late_gradient(leg, early, beta, out);
        let LateGradient { f1_q, f2_q, f2_qd, moment_q, .. } = self.description.shapes.late_gradient;
        let inertia = self.by.inertia();
        for (block, unit) in [(f1_q, inertia), (f2_q, self.by.turn()), (f2_qd, inertia), (moment_q, self.by.torque())] {
            scale(block.of_mut(out), unit);
        }
    }

    fn touchdown(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.touchdown(leg, q, &self.rates(qd), out);
        let (by, s) = (&self.by, &self.description.shapes.touchdown);
        self.with_gradients(out, by.rate(), [s.qd_plus, s.qd_plus_w], 2);
        self.with_gradients(out, by.impulse(), [s.impulse, s.impulse_w], 2);
        self.with_gradients(out, by.speed(), [s.leaving, s.leaving_w], 2);
        self.with_gradients(out, by.speed(), [s.landing, s.landing_w], 2);
        self.with_gradients(out, by.turn(), [s.couple, s.couple_w], 2);
        self.with_gradients(out, by.turn(), [s.pitch, s.pitch_w], 2);
    }

    fn curvature(
        &self,
        leg: usize,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        n: &[f64],
        phi: &[f64],
        others: &[f64],
        out: &mut [f64],
    ) {
        let by = &self.by;
        let n: Vec<f64> = n.iter().map(|x| x * by.torque()).collect();
        let phi: Vec<f64> = phi.iter().map(|x| x * by.force()).collect();
        let (to, mut others) = (&self.description.shapes.curvature.others, others.to_vec());
        for (block, unit) in [
            (to.sigma, by.turn()),
            (to.sigmad, by.torque()),
            (to.swing_height, by.length),
            (to.platform_x, by.length),
            (to.swing_velocity, by.speed()),
            (to.platform_height, by.length),
        ] {
            scale(block.of_mut(&mut others), unit);
        }
        self.gait.curvature(leg, q, &self.rates(qd), &self.accelerations(qdd), &n, &phi, &others, out);
        self.second(out);
    }

    fn touchdown_curvature(&self, leg: usize, q: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64], out: &mut [f64]) {
        let xi: Vec<f64> = xi.iter().map(|x| x * self.by.rate()).collect();
        let (by, shape, mut outputs) = (&self.by, &self.description.shapes.touchdown_curvature, outputs.to_vec());
        let to = &shape.outputs;
        for (block, unit) in [
            (to.impulse, by.impulse()),
            (to.leaving, by.speed()),
            (to.landing, by.speed()),
            (to.couple, by.turn()),
            (to.pitch, by.turn()),
        ] {
            scale(block.of_mut(&mut outputs), unit);
        }
        self.gait.touchdown_curvature(leg, q, &self.rates(qd), &xi, &outputs, out);
        scale(shape.q_qd.of_mut(out), by.time);
        scale(shape.q_plus.of_mut(out), by.time);
    }

    fn sharing(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        self.gait.sharing(leg, q, &self.rates(qd), &self.accelerations(qdd), out);
        let (by, shape) = (&self.by, &self.description.shapes.sharing);
        self.with_gradients(out, by.torque(), [shape.moment, shape.moment_w], 3);
        self.with_gradients(out, by.length, [shape.levers, shape.levers_w], 3);
    }

    fn sharing_curvature(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let (to, mut weights) = (&self.description.shapes.sharing_curvature.weights, weights.to_vec());
        scale(to.moment.of_mut(&mut weights), self.by.torque());
        scale(to.levers.of_mut(&mut weights), self.by.length);
        self.gait.sharing_curvature(leg, q, &self.rates(qd), &self.accelerations(qdd), &weights, out);
        self.second(out);
    }
}
