//! The whole robot in quasi-velocities: A u̇ + H = Sᵀ Γ + D F, with the platform free in space.
//!
//! u = [velocity of the platform's mass centre, angular velocity of the platform, q̇], the first two in the
//! platform's axes; u̇ = [acceleration of the mass centre, angular acceleration, q̈] in the same axes. Seen from the
//! platform, nothing depends on where it is, and on how it is turned only which way is up: no angles of the platform,
//! and A is a function of the joints alone. The equations are projections on partial velocities: e, e × r and
//! ∂r/∂q for the point at r from the platform's mass centre.

use super::kernel::Kernel;
use super::kinematics::Tree;
use super::model::scaled;
use super::quantities::BodyQuantities;
use crate::expr::{Frame, Poly, Ring, Var, Vec3, add, cross, dot, zero};
use crate::mechanism::Whole;
use std::collections::BTreeMap;

/// Symbols and kinematics of the whole robot.
struct Model<'w> {
    whole: &'w Whole,
    ring: Ring,
    up: [Var; 3],
    /// Acceleration of the platform's mass centre.
    acceleration: [Var; 3],
    /// Angular velocity and acceleration.
    omega: [[Var; 2]; 3],
    q: Vec<[Var; 3]>,
    tree: Tree,
}

/// The kernels of the whole robot.
pub fn whole_kernels(whole: &Whole) -> (Ring, Vec<Kernel>) {
    let mut model = Model::new(whole);
    let kernels = vec![model.equations_of_motion(), model.feet(), model.feet_bias()];
    (model.ring, kernels)
}

impl Model<'_> {
    fn new(whole: &Whole) -> Model<'_> {
        let mut ring = Ring::new();
        let axes = ["x", "y", "z"];
        let up = axes.map(|axis| ring.symbol(format!("up_{axis}")));
        let acceleration = axes.map(|axis| ring.symbol(format!("acceleration_{axis}")));
        let omega = axes.map(|axis| ring.speed(&format!("omega_{axis}")));
        let q: Vec<[Var; 3]> = (1..=whole.joints.len()).map(|j| ring.coordinate(&format!("q{j}"))).collect();
        let numbers: Vec<BodyQuantities> = whole.bodies.iter().map(BodyQuantities::constant).collect();
        let platform = Frame::base(omega.map(|w| w[0].into()));
        let tree = Tree::new(&mut ring, platform, &whole.bodies, &numbers, &q);
        Model { whole, ring, up, acceleration, omega, q, tree }
    }

    /// `Σ m ∂v/∂u·(a − g) + ∂ω/∂u·(Iω̇ + ω × Iω)` for each of u.
    fn forces(&mut self) -> Vec<Poly> {
        let mut forces = vec![Poly::zero(); 6 + self.q.len()];
        for b in 0..self.whole.bodies.len() {
            let numbers = BodyQuantities::constant(&self.whole.bodies[b]);
            let at = self.tree.bodies[b].com.clone();
            let mut acceleration = add(&self.acceleration.map(Poly::from), &self.swing(&at));
            for (a, up) in acceleration.iter_mut().zip(self.up) {
                *a += &Poly::from(up).scaled(self.whole.gravity);
            }
            let force = acceleration.map(|a| &a * &numbers.mass);
            let spin = self.tree.bodies[b].spin.clone();
            let momentum = scaled(&spin, &numbers.inertia);
            let moment = add(&self.rate(&momentum), &cross(&spin, &momentum));
            let turning = cross(&at, &force);
            for k in 0..3 {
                forces[k] += &force[k];
                forces[3 + k] += &turning[k];
            }
            let speeds = self.omega.iter().map(|w| w[0]).chain(self.q.iter().map(|q| q[1]));
            for (k, speed) in speeds.enumerate() {
                let partial = [0, 1, 2].map(|i| self.ring.derivative(&spin[i], speed));
                forces[3 + k] += &dot(&partial, &moment);
            }
            for (k, q) in self.q.iter().enumerate() {
                let partial = [0, 1, 2].map(|i| self.ring.derivative(&at[i], q[0]));
                forces[6 + k] += &dot(&partial, &force);
            }
        }
        // Rotors turn with their joints.
        for (k, (q, joint)) in self.q.iter().zip(&self.whole.joints).enumerate() {
            forces[6 + k] += &Poly::from(q[2]).scaled(joint.rotor_inertia);
        }
        forces
    }

    fn rate(&mut self, v: &Vec3) -> Vec3 {
        [0, 1, 2].map(|i| self.ring.time_derivative(&v[i]))
    }

    /// Acceleration of a point of the robot beyond that of the platform's mass centre, in the platform's axes.
    fn swing(&mut self, at: &Vec3) -> Vec3 {
        let omega = self.omega.map(|w| Poly::from(w[0]));
        let velocity = add(&cross(&omega, at), &self.rate(at));
        add(&self.rate(&velocity), &cross(&omega, &velocity))
    }

    /// u̇.
    fn accelerations(&self) -> Vec<Var> {
        let turning = self.omega.iter().map(|w| w[1]);
        self.acceleration.iter().copied().chain(turning).chain(self.q.iter().map(|q| q[2])).collect()
    }

    fn without_accelerations(&mut self, list: &[Poly]) -> Vec<Poly> {
        let none: BTreeMap<Var, Poly> = self.accelerations().into_iter().map(|a| (a, Poly::zero())).collect();
        list.iter().map(|p| self.ring.substitute(p, &none)).collect()
    }

    fn equations_of_motion(&mut self) -> Kernel {
        let forces = self.forces();
        let accelerations = self.accelerations();
        // It is symmetric, but for the last digit of a number.
        let entry = |i: usize, j: usize| self.ring.derivative(&forces[i.min(j)], accelerations[i.max(j)]);
        let all = 0..forces.len();
        let inertia = all.clone().map(|i| all.clone().map(|j| entry(i, j)).collect()).collect();
        let bias = self.without_accelerations(&forces);
        Kernel::new(
            "inertia_and_bias",
            "Inertia matrix A(q) of the whole robot, symmetric positive definite, and its velocity and gravity terms \
             H: A u̇ + H = Sᵀ Γ + D F. `up` and `omega` are in the platform's axes.",
        )
        .input("up", self.up.to_vec())
        .input("omega", self.omega.iter().map(|w| w[0]).collect())
        .input("q", self.q.iter().map(|q| q[0]).collect())
        .input("qd", self.q.iter().map(|q| q[1]).collect())
        .matrix("a", inertia, "A")
        .vector("h", bias, "H")
    }

    /// Feet from the platform's mass centre, in the platform's axes.
    fn places(&mut self) -> Vec<Vec3> {
        let legs = &self.whole.legs;
        let foot = |leg: &crate::mechanism::WholeLeg| {
            self.tree.point(&mut self.ring, leg.foot_body, &leg.foot.map(Poly::constant))
        };
        legs.iter().map(foot).collect()
    }

    fn feet(&mut self) -> Kernel {
        let feet = self.places();
        let mut jacobian: Vec<Vec<Poly>> = Vec::new();
        let unit = |k: usize| {
            let mut unit = zero();
            unit[k] = Poly::constant(1.0);
            unit
        };
        jacobian.extend((0..3).map(|k| feet.iter().flat_map(|_| unit(k)).collect()));
        jacobian.extend((0..3).map(|k| feet.iter().flat_map(|at| cross(&unit(k), at)).collect()));
        let partial = |q: Var| feet.iter().flatten().map(|x| self.ring.derivative(x, q)).collect();
        jacobian.extend(self.q.iter().map(|q| partial(q[0])));
        Kernel::new("feet", "Feet from the platform's mass centre, and D = (∂ḋ/∂u)ᵀ: in the platform's axes, m.")
            .input("q", self.q.iter().map(|q| q[0]).collect())
            .vector("d", feet.iter().flatten().cloned().collect(), "d of every leg")
            .matrix("jacobian", jacobian, "D: a row per component of u, three columns per leg")
    }

    fn feet_bias(&mut self) -> Kernel {
        let accelerations: Vec<Poly> = self.places().iter().flat_map(|at| self.swing(at)).collect();
        let bias = self.without_accelerations(&accelerations);
        Kernel::new("feet_bias", "Velocity terms of the feet's accelerations: d̈ = Dᵀu̇ + h, platform axes, m/s².")
            .input("omega", self.omega.iter().map(|w| w[0]).collect())
            .input("q", self.q.iter().map(|q| q[0]).collect())
            .input("qd", self.q.iter().map(|q| q[1]).collect())
            .vector("h", bias, "h of every leg")
    }
}
