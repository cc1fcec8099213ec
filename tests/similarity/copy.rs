//! Froude copies: a gait of a robot of the same shape and build, of another size and weight.

use piaffe::model::shape::{Block, LateGradient, MomentumTerms};
use piaffe::model::{Body, Description, Gait, Mode, Spot};

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

    fn acceleration(&self) -> f64 {
        self.length / (self.time * self.time)
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
            joint.damping *= by.torque() * by.time;
            joint.stiffness *= by.torque();
            joint.coulomb *= by.torque();
        }
        d.phases.to_mut().iter_mut().for_each(|phase| phase.duration = phase.duration.map(|t| t * by.time));
        d.limits.min_vertical_force *= by.force();
        d.limits.swing_clearance *= by.length;
        d.limits.min_platform_height *= by.length;
        d.limits.body_clearance *= by.length;
        Copy { gait, description: d, by }
    }

    /// Rates of the copy as the original has them.
    fn rates(&self, qd: &[f64]) -> Vec<f64> {
        qd.iter().map(|x| x * self.by.time).collect()
    }

    /// Velocities of places, likewise.
    fn velocities(&self, v: &[f64]) -> Vec<f64> {
        v.iter().map(|x| x / self.by.speed()).collect()
    }

    fn accelerations(&self, qdd: &[f64]) -> Vec<f64> {
        qdd.iter().map(|x| x * self.by.time * self.by.time).collect()
    }

    /// Columns of a Jacobian in q, q̇ and so on: how many are of each, and by what a derivative in them grows.
    fn columns(&self, orders: usize) -> Vec<(usize, f64)> {
        (0..orders).map(|order| (self.description.orientations(), self.by.time.powi(order as i32))).collect()
    }

    /// Columns of one in what a landing is a function of: q, the mass centre's velocity, q̇.
    fn columns_of_landing(&self) -> Vec<(usize, f64)> {
        let velocity = (self.description.positions(), 1.0 / self.by.speed());
        let of_state = self.columns(2);
        vec![of_state[0], velocity, of_state[1]]
    }

    /// Scales rows of a Jacobian; `units` of the rows.
    fn jacobian(&self, out: &mut [f64], units: &[f64], columns: &[(usize, f64)]) {
        let size = columns.iter().map(|(count, _)| count).sum();
        for (row, unit) in out.chunks_mut(size).zip(units) {
            let mut rest = row;
            for (count, factor) in columns {
                let (part, others) = rest.split_at_mut(*count);
                scale(part, unit * factor);
                rest = others;
            }
        }
    }

    /// Gradient and second derivatives of a weighted sum: in (q, q̇, q̈), q·q̇, q·q̈ and q̇·q̇.
    fn second(&self, out: &mut [f64], [gradient, q_qd, q_qdd, qd_qd]: [Block; 4]) {
        let t = self.by.time;
        self.jacobian(gradient.of_mut(out), &[1.0], &self.columns(3));
        for (block, factor) in [(q_qd, t), (q_qdd, t * t), (qd_qd, t * t)] {
            scale(block.of_mut(out), factor);
        }
    }

    /// Scales values and their gradients.
    fn with_gradients(&self, out: &mut [f64], unit: f64, [values, rows]: [Block; 2], columns: &[(usize, f64)]) {
        scale(values.of_mut(out), unit);
        self.jacobian(rows.of_mut(out), &vec![unit; values.len()], columns);
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

    fn latex(&self) -> &str {
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
        reduced(mode: Mode, q: &[f64], qd: &[f64]);
        forward(mode: Mode, q: &[f64], qd: &[f64], gamma: &[f64]);
        impact(leg: usize, q: &[f64], xd: &[f64]);
        impact_both(q: &[f64], xd: &[f64]);
    }

    fn platform_velocity(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.platform_velocity(mode, q, &self.rates(qd), out);
        scale(out, self.by.speed());
    }

    fn momentum_terms(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.momentum_terms(mode, q, &self.rates(qd), out);
        let by = &self.by;
        let MomentumTerms { f1, f2, sigma, c, sigmadot, .. } = self.description.shape(mode).momentum_terms;
        let (inertia, turn) = (by.inertia(), by.turn());
        for (block, unit) in [(f1, inertia), (f2, turn), (sigma, turn), (c, by.length), (sigmadot, by.torque())] {
            scale(block.of_mut(out), unit);
        }
    }

    fn inverse(&self, mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse(mode, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (shape, nc) = (&self.description.shape(mode).inverse, self.description.positions());
        let (by, square) = (&self.by, self.by.time * self.by.time);
        let (p, q) = shape.xdd.of_mut(out).split_at_mut(nc);
        scale(p, by.acceleration());
        scale(q, 1.0 / square);
        scale(shape.gamma.of_mut(out), by.torque());
        scale(shape.f.of_mut(out), by.force());
    }

    fn momentum(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.momentum(mode, q, &self.rates(qd), out);
        let shape = &self.description.shape(mode).momentum;
        self.with_gradients(out, self.by.turn(), [shape.sigma, shape.sigma_w], &self.columns(2));
    }

    fn inverse_jacobian(&self, mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse_jacobian(mode, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (by, shape) = (&self.by, &self.description.shape(mode).inverse_jacobian);
        scale(shape.beta_dd.of_mut(out), 1.0 / (by.time * by.time));
        self.with_gradients(out, by.torque(), [shape.gamma, shape.gamma_w], &self.columns(3));
        self.with_gradients(out, by.force(), [shape.f, shape.f_w], &self.columns(3));
        self.jacobian(shape.balance_w.of_mut(out), &[by.torque()], &self.columns(3));
    }

    fn placement(&self, mode: Mode, q: &[f64], out: &mut [f64]) {
        self.gait.placement(mode, q, out);
        scale(out, self.by.length);
    }

    fn heights(&self, mode: Mode, q: &[f64], out: &mut [f64]) {
        self.gait.heights(mode, q, out);
        scale(out, self.by.length);
    }

    fn heights_curvature(&self, mode: Mode, q: &[f64], weights: &[f64], out: &mut [f64]) {
        let weights: Vec<f64> = weights.iter().map(|w| w * self.by.length).collect();
        self.gait.heights_curvature(mode, q, &weights, out);
    }

    fn swing_velocity(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.swing_velocity(mode, q, &self.rates(qd), out);
        let shape = &self.description.shape(mode).swing_velocity;
        self.with_gradients(out, self.by.speed(), [shape.v, shape.v_w], &self.columns(2));
    }

    fn early(&self, mode: Mode, actuated: &[f64], actuated_d: &[f64], out: &mut [f64]) {
        self.gait.early(mode, actuated, &self.rates(actuated_d), out);
    }

    fn late(&self, mode: Mode, early: &[f64], beta: f64, out: &mut [f64]) {
        self.gait.late(mode, early, beta, out);
        let units = [self.by.inertia(), self.by.turn(), self.by.torque()];
        out.iter_mut().zip(units.into_iter().cycle()).for_each(|(x, unit)| *x *= unit);
    }

    fn late_gradient(&self, mode: Mode, early: &[f64], beta: f64, out: &mut [f64]) {
        self.gait.late_gradient(mode, early, beta, out);
        let LateGradient { f1_q, f2_q, f2_qd, moment_q, .. } = self.description.shape(mode).late_gradient;
        let inertia = self.by.inertia();
        for (block, unit) in [(f1_q, inertia), (f2_q, self.by.turn()), (f2_qd, inertia), (moment_q, self.by.torque())] {
            scale(block.of_mut(out), unit);
        }
    }

    fn touchdown(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.touchdown(leg, q, &self.rates(qd), out);
        let (by, s) = (&self.by, &self.description.shapes.touchdown);
        self.with_gradients(out, by.rate(), [s.qd_plus, s.qd_plus_w], &self.columns(2));
        self.with_gradients(out, by.impulse(), [s.impulse, s.impulse_w], &self.columns(2));
        self.with_gradients(out, by.speed(), [s.leaving, s.leaving_w], &self.columns(2));
        self.with_gradients(out, by.speed(), [s.landing, s.landing_w], &self.columns(2));
        self.with_gradients(out, by.turn(), [s.couple, s.couple_w], &self.columns(2));
        self.with_gradients(out, by.turn(), [s.pitch, s.pitch_w], &self.columns(2));
    }

    fn curvature(
        &self,
        mode: Mode,
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
        let (to, mut others) = (&self.description.shape(mode).curvature.others, others.to_vec());
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
        self.gait.curvature(mode, q, &self.rates(qd), &self.accelerations(qdd), &n, &phi, &others, out);
        let shape = &self.description.shape(mode).curvature;
        self.second(out, [shape.gradient, shape.q_qd, shape.q_qdd, shape.qd_qd]);
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

    fn landing(&self, leg: usize, q: &[f64], v: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.landing(leg, q, &self.velocities(v), &self.rates(qd), out);
        let (by, s, columns) = (&self.by, &self.description.shapes.landing, self.columns_of_landing());
        self.with_gradients(out, by.rate(), [s.qd_plus, s.qd_plus_w], &columns);
        self.with_gradients(out, by.impulse(), [s.impulse, s.impulse_w], &columns);
        self.with_gradients(out, by.speed(), [s.landing, s.landing_w], &columns);
    }

    fn landing_curvature(
        &self,
        leg: usize,
        q: &[f64],
        v: &[f64],
        qd: &[f64],
        xi: &[f64],
        outputs: &[f64],
        out: &mut [f64],
    ) {
        let xi: Vec<f64> = xi.iter().map(|x| x * self.by.rate()).collect();
        let (by, shape, mut outputs) = (&self.by, &self.description.shapes.landing_curvature, outputs.to_vec());
        scale(shape.outputs.impulse.of_mut(&mut outputs), by.impulse());
        scale(shape.outputs.landing.of_mut(&mut outputs), by.speed());
        self.gait.landing_curvature(leg, q, &self.velocities(v), &self.rates(qd), &xi, &outputs, out);
        let columns = self.columns_of_landing();
        self.jacobian(shape.q_v.of_mut(out), &vec![1.0; q.len()], &columns[1..]);
        scale(shape.q_plus.of_mut(out), by.time);
    }

    fn takeoff(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        self.gait.takeoff(leg, q, &self.rates(qd), &self.accelerations(qdd), out);
        let (by, s) = (&self.by, &self.description.shapes.takeoff);
        self.with_gradients(out, by.length, [s.r, s.r_q], &self.columns(1));
        self.with_gradients(out, by.speed(), [s.v, s.v_w], &self.columns(2));
        self.with_gradients(out, by.acceleration(), [s.lift, s.lift_w], &self.columns(3));
    }

    fn takeoff_curvature(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let (by, shape, mut weights) = (&self.by, &self.description.shapes.takeoff_curvature, weights.to_vec());
        let to = &shape.weights;
        for (block, unit) in [(to.r, by.length), (to.v, by.speed()), (to.lift, by.acceleration())] {
            scale(block.of_mut(&mut weights), unit);
        }
        self.gait.takeoff_curvature(leg, q, &self.rates(qd), &self.accelerations(qdd), &weights, out);
        self.second(out, [shape.gradient, shape.q_qd, shape.q_qdd, shape.qd_qd]);
    }

    fn sharing(&self, mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        self.gait.sharing(mode, q, &self.rates(qd), &self.accelerations(qdd), out);
        let (by, shape) = (&self.by, &self.description.shape(mode).sharing);
        self.with_gradients(out, by.torque(), [shape.moment, shape.moment_w], &self.columns(3));
        self.with_gradients(out, by.length, [shape.levers, shape.levers_w], &self.columns(3));
    }

    fn sharing_curvature(&self, mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let (shape, mut weights) = (&self.description.shape(mode).sharing_curvature, weights.to_vec());
        let to = &shape.weights;
        scale(to.moment.of_mut(&mut weights), self.by.torque());
        scale(to.levers.of_mut(&mut weights), self.by.length);
        self.gait.sharing_curvature(mode, q, &self.rates(qd), &self.accelerations(qdd), &weights, out);
        self.second(out, [shape.gradient, shape.q_qd, shape.q_qdd, shape.qd_qd]);
    }
}
