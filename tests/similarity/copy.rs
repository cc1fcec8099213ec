//! Froude copies: a gait of a robot of the same shape and build, of another size and weight.

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
        let (nq, t) = (self.description.orientations(), self.by.time);
        let (gradient, blocks) = out.split_at_mut(3 * nq);
        scale(&mut gradient[nq..2 * nq], t);
        scale(&mut gradient[2 * nq..], t * t);
        for (block, factor) in blocks.chunks_mut(nq * nq).zip([1.0, t, t * t, t * t]) {
            scale(block, factor);
        }
    }

    /// Units of what a touchdown gives after q̇⁺.
    fn of_impact(&self) -> Vec<f64> {
        let mut units = vec![self.by.impulse(); self.description.positions()];
        units.extend([self.by.speed(); 2]);
        units
    }

    fn of_shared(&self) -> Vec<f64> {
        let leg = &self.description.legs[0];
        let mut units = vec![self.by.torque(); 2];
        units.resize(2 + 3 * (leg.end_joint - leg.first_joint), self.by.length);
        units
    }
}

fn scale(numbers: &mut [f64], factor: f64) {
    numbers.iter_mut().for_each(|x| *x *= factor);
}

fn times(numbers: &[f64], units: impl IntoIterator<Item = f64>) -> Vec<f64> {
    numbers.iter().zip(units).map(|(x, unit)| x * unit).collect()
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
        let units = [by.inertia(), by.turn(), by.turn(), by.length, by.torque()];
        out.iter_mut().zip(units).for_each(|(x, unit)| *x *= unit);
    }

    fn inverse(&self, leg: usize, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse(leg, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (nc, nq) = (self.description.positions(), self.description.orientations());
        let (by, square) = (&self.by, self.by.time * self.by.time);
        let (xdd, forces) = out.split_at_mut(nc + nq);
        scale(&mut xdd[..nc], by.length / square);
        scale(&mut xdd[nc..], 1.0 / square);
        let (torques, force) = forces.split_at_mut(self.description.joints());
        scale(torques, by.torque());
        scale(force, by.force());
    }

    fn momentum(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.momentum(leg, q, &self.rates(qd), out);
        out[0] *= self.by.turn();
        self.jacobian(&mut out[1..], &[self.by.turn()], 2);
    }

    fn inverse_jacobian(&self, leg: usize, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]) {
        self.gait.inverse_jacobian(leg, q, &self.rates(qd), &self.accelerations(actuated_dd), out);
        let (nc, nj) = (self.description.positions(), self.description.joints());
        let mut units = vec![self.by.torque(); nj];
        units.extend(vec![self.by.force(); nc]);
        out[0] /= self.by.time * self.by.time;
        let values = times(&out[1..1 + nj + nc], units.clone());
        out[1..1 + nj + nc].copy_from_slice(&values);
        units.push(self.by.torque());
        self.jacobian(&mut out[1 + nj + nc..], &units, 3);
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
        let nc = self.description.positions();
        scale(&mut out[..nc], self.by.speed());
        self.jacobian(&mut out[nc..], &vec![self.by.speed(); nc], 2);
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
        let units = [self.by.inertia(), self.by.turn(), self.by.inertia(), self.by.torque()];
        for (part, unit) in out.chunks_mut(self.description.prescribed()).zip(units) {
            scale(part, unit);
        }
    }

    fn touchdown(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        self.gait.touchdown(leg, q, &self.rates(qd), out);
        let nq = self.description.orientations();
        let mut units = vec![self.by.rate(); nq];
        units.extend(self.of_impact());
        let part = |out: &mut [f64], at: usize, units: &[f64]| {
            let values = times(&out[at..at + units.len()], units.iter().copied());
            out[at..at + units.len()].copy_from_slice(&values);
            let first = at + units.len();
            self.jacobian(&mut out[first..first + units.len() * 2 * nq], units, 2);
            first + units.len() * 2 * nq
        };
        let rest = part(out, 0, &units);
        if out.len() > rest {
            part(out, rest, &[self.by.turn(); 3]);
        }
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
        let others = times(others, [by.turn(), by.torque(), by.length, by.length, by.speed(), by.length]);
        self.gait.curvature(leg, q, &self.rates(qd), &self.accelerations(qdd), &n, &phi, &others, out);
        self.second(out);
    }

    fn touchdown_curvature(&self, leg: usize, q: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64], out: &mut [f64]) {
        let xi: Vec<f64> = xi.iter().map(|x| x * self.by.rate()).collect();
        let outputs = times(outputs, self.of_impact().into_iter().chain([self.by.turn(); 3]));
        self.gait.touchdown_curvature(leg, q, &self.rates(qd), &xi, &outputs, out);
        let nq = self.description.orientations();
        scale(&mut out[nq * nq..], self.by.time);
    }

    fn sharing(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        self.gait.sharing(leg, q, &self.rates(qd), &self.accelerations(qdd), out);
        let units = self.of_shared();
        let values = times(&out[..units.len()], units.iter().copied());
        out[..units.len()].copy_from_slice(&values);
        self.jacobian(&mut out[units.len()..], &units, 3);
    }

    fn sharing_curvature(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let weights = times(weights, self.of_shared());
        self.gait.sharing_curvature(leg, q, &self.rates(qd), &self.accelerations(qdd), &weights, out);
        self.second(out);
    }
}
