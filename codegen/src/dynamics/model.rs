//! A mechanism with its symbols and kinematics: what all kernels are derived from.

use super::kinematics::{Coordinates, Kinematics};
use super::quantities::Quantities;
use crate::expr::{Poly, Ring, Var, Vec3, add, cross, dot, subtract, zero};
use crate::mechanism::{Family, Mechanism, Mode};
use std::collections::BTreeMap;

/// Symbols, kinematics and mechanism of one gait.
pub struct Model {
    pub mechanism: Mechanism,
    pub quantities: Quantities,
    /// What stays symbolic of the robot: none, unless it is a family.
    pub parameters: Vec<Var>,
    pub ring: Ring,
    pub coordinates: Coordinates,
    pub kinematics: Kinematics,
}

/// Which point the positions of the bodies are measured from.
#[derive(Clone, Copy)]
pub enum Origin {
    /// The world's: positions contain p.
    World,
    /// The foot of a leg, taken to be at rest: p drops out.
    Foot(usize),
    /// The robot's own mass centre: p drops out. It falls, so that no weight is felt there.
    MassCentre,
}

impl From<Mode> for Origin {
    fn from(mode: Mode) -> Origin {
        match mode {
            Mode::Stance(leg) => Origin::Foot(leg),
            Mode::Flight => Origin::MassCentre,
        }
    }
}

impl Model {
    pub fn new(mechanism: &Mechanism) -> Model {
        Model::with(Ring::new(), mechanism, Quantities::constant(mechanism), Vec::new())
    }

    /// The model of a family of robots, with its parameters as symbols.
    pub fn of_family(family: &Family) -> Model {
        let mut ring = Ring::new();
        let parameters: Vec<Var> = family.parameters.iter().map(|p| ring.parameter(p.name.replace('.', "_"))).collect();
        let quantities = Quantities::of_family(family, &parameters);
        Model::with(ring, &family.mechanism, quantities, parameters)
    }

    fn with(mut ring: Ring, mechanism: &Mechanism, quantities: Quantities, parameters: Vec<Var>) -> Model {
        let coordinates = Coordinates::new(&mut ring, mechanism);
        let kinematics = Kinematics::new(&mut ring, mechanism, &quantities, &coordinates);
        Model { mechanism: mechanism.clone(), quantities, parameters, ring, coordinates, kinematics }
    }

    /// p as a vector (z = 0 where the platform does not move sideways).
    pub fn platform(&self) -> Vec3 {
        let mut p = [Poly::zero(), Poly::zero(), Poly::zero()];
        for (slot, symbol) in p.iter_mut().zip(&self.coordinates.p) {
            *slot = symbol[0].into();
        }
        p
    }

    /// Position of the foot of `leg` relative to the platform's mass centre.
    pub fn foot(&self, leg: usize) -> Vec3 {
        self.kinematics.feet[leg].clone()
    }

    /// The origin, relative to the platform's mass centre.
    pub fn place(&mut self, origin: Origin) -> Vec3 {
        match origin {
            Origin::World => self.platform().map(|x| -&x),
            Origin::Foot(leg) => self.foot(leg),
            Origin::MassCentre => self.own_mass_centre(),
        }
    }

    /// The robot's mass centre from the platform's.
    fn own_mass_centre(&mut self) -> Vec3 {
        let mut moment = zero();
        for body in &self.kinematics.bodies {
            for (sum, x) in moment.iter_mut().zip(&body.place.com) {
                *sum += &(x * &body.mass);
            }
        }
        let total = self.total_mass();
        let over_total = self.ring.reciprocal(total);
        moment.map(|m| &m * &over_total)
    }

    /// What counts as weight where places are measured from `origin`, m/s².
    pub fn gravity(&self, origin: Origin) -> Poly {
        match origin {
            Origin::MassCentre => Poly::zero(),
            _ => self.quantities.gravity.clone(),
        }
    }

    /// Mass centres of all bodies from `origin`.
    pub fn centres(&mut self, origin: Origin) -> Vec<Vec3> {
        let shift = self.place(origin);
        self.kinematics.bodies.iter().map(|b| subtract(&b.place.com, &shift)).collect()
    }

    pub fn total_mass(&self) -> Poly {
        self.kinematics.bodies.iter().fold(Poly::zero(), |sum, body| &sum + &body.mass)
    }

    /// First moment of mass about `origin`: total mass times the mass centre of the whole robot.
    pub fn first_moment(&mut self, origin: Origin) -> Vec3 {
        let mut moment = zero();
        let centres = self.centres(origin);
        for (body, centre) in self.kinematics.bodies.iter().zip(centres) {
            for (sum, c) in moment.iter_mut().zip(&centre) {
                *sum += &(c * &body.mass);
            }
        }
        moment
    }

    /// Mass centre of the whole robot from `origin`.
    pub fn centre_of_mass(&mut self, origin: Origin) -> Vec3 {
        let total = self.total_mass();
        let over_total = self.ring.reciprocal(total);
        self.first_moment(origin).map(|m| &m * &over_total)
    }

    pub fn rate(&mut self, v: &Vec3) -> Vec3 {
        [0, 1, 2].map(|i| self.ring.time_derivative(&v[i]))
    }

    /// Generalized momentum `∂T/∂Ẋk` for each of `coordinates`.
    pub fn momenta(&mut self, origin: Origin, coordinates: &[[Var; 3]]) -> Vec<Poly> {
        let mut momenta = vec![Poly::zero(); coordinates.len()];
        let centres = self.centres(origin);
        for (b, centre) in centres.iter().enumerate() {
            let velocity = self.rate(centre);
            let spin = self.kinematics.bodies[b].place.spin.clone();
            let angular = scaled(&spin, &self.kinematics.bodies[b].inertia);
            self.project(coordinates, b, centre, &velocity, &angular, &mut momenta);
        }
        self.add_rotors(coordinates, 1, &mut momenta);
        momenta
    }

    /// Generalized force `d/dt ∂T/∂Ẋk − ∂T/∂Xk + ∂V/∂Xk` for each of `coordinates`.
    pub fn generalized_forces(&mut self, origin: Origin, coordinates: &[[Var; 3]]) -> Vec<Poly> {
        let mut forces = vec![Poly::zero(); coordinates.len()];
        let gravity = self.gravity(origin);
        let centres = self.centres(origin);
        for (b, centre) in centres.iter().enumerate() {
            let velocity = self.rate(centre);
            let mut acceleration = self.rate(&velocity);
            acceleration[1] += &gravity;
            let spin = self.kinematics.bodies[b].place.spin.clone();
            let angular = scaled(&spin, &self.kinematics.bodies[b].inertia);
            let moment = add(&self.rate(&angular), &cross(&spin, &angular));
            self.project(coordinates, b, centre, &acceleration, &moment, &mut forces);
        }
        self.add_rotors(coordinates, 2, &mut forces);
        forces
    }

    /// Angular momentum σ about `origin` of a robot whose platform stays level, and dσ/dt less the
    /// moment of gravity. In a turn of the whole robot a body moves along z × r and spins about z;
    /// rotors do not turn in their motors, so they do not count.
    pub fn level_turn(&mut self, origin: Origin) -> (Poly, Poly) {
        let (mut sigma, mut balance) = (Poly::zero(), Poly::zero());
        let gravity = self.gravity(origin);
        for (b, centre) in self.centres(origin).iter().enumerate() {
            let velocity = self.rate(centre);
            let mut acceleration = self.rate(&velocity);
            acceleration[1] += &gravity;
            let body = &self.kinematics.bodies[b];
            let spin = &body.place.spin[2] * &body.inertia[2][2];
            sigma += &(&cross(centre, &velocity)[2] * &body.mass);
            sigma += &spin;
            balance += &(&cross(centre, &acceleration)[2] * &body.mass);
            balance += &self.ring.time_derivative(&spin);
        }
        (sigma, balance)
    }

    /// Adds `m ∂r/∂X·linear + ∂ω/∂Ẋ·angular` of body `b`.
    fn project(
        &self,
        coordinates: &[[Var; 3]],
        b: usize,
        centre: &Vec3,
        linear: &Vec3,
        angular: &Vec3,
        sums: &mut [Poly],
    ) {
        let mass = &self.kinematics.bodies[b].mass;
        let spin = &self.kinematics.bodies[b].place.spin;
        for (sum, [x, xd, _]) in sums.iter_mut().zip(coordinates) {
            let partial_velocity = [0, 1, 2].map(|i| self.ring.derivative(&centre[i], *x));
            *sum += &(&dot(&partial_velocity, linear) * mass);
            let partial_spin = [0, 1, 2].map(|i| self.ring.derivative(&spin[i], *xd));
            *sum += &dot(&partial_spin, angular);
        }
    }

    /// Rotors turn with their joints: `J n² q̇` (order 1) or `J n² q̈` (order 2).
    fn add_rotors(&self, coordinates: &[[Var; 3]], order: usize, sums: &mut [Poly]) {
        for (inertia, symbols) in self.quantities.rotor_inertia.iter().zip(&self.coordinates.q) {
            if let Some(k) = coordinates.iter().position(|c| c[0] == symbols[0]) {
                sums[k] += &(&Poly::from(symbols[order]) * inertia);
            }
        }
    }

    /// Matrix of partial derivatives.
    pub fn jacobian(&self, values: &[Poly], by: &[Var]) -> Vec<Vec<Poly>> {
        values.iter().map(|v| by.iter().map(|s| self.ring.derivative(v, *s)).collect()).collect()
    }

    /// Matrix of second derivatives, given the first ones.
    pub fn hessian(&self, gradient: &[Poly], by: &[Var]) -> Vec<Vec<Poly>> {
        let mut rows: Vec<Vec<Poly>> = Vec::with_capacity(by.len());
        for (i, first) in gradient.iter().enumerate() {
            let mut row: Vec<Poly> = rows.iter().map(|above| above[i].clone()).collect();
            row.extend(by[i..].iter().map(|s| self.ring.derivative(first, *s)));
            rows.push(row);
        }
        rows
    }

    /// The expression with these symbols set to zero.
    pub fn without(&mut self, p: &Poly, symbols: &[Var]) -> Poly {
        let map = symbols.iter().map(|s| (*s, Poly::zero())).collect::<BTreeMap<_, _>>();
        self.ring.substitute(p, &map)
    }

    /// Components that reactions and feet have: x, y and, where the platform rolls, z.
    pub fn components(&self, v: &Vec3) -> Vec<Poly> {
        v[..self.mechanism.positions()].to_vec()
    }

    pub fn symbols(&self, order: usize) -> (Vec<Var>, Vec<Var>) {
        let of = |list: &[[Var; 3]]| list.iter().map(|c| c[order]).collect();
        (of(&self.coordinates.p), of(&self.coordinates.q))
    }

    /// All of X (order 0), Ẋ (1) or Ẍ (2).
    pub fn x(&self, order: usize) -> Vec<Var> {
        self.coordinates.all().iter().map(|c| c[order]).collect()
    }

    /// All of q, q̇ or q̈.
    pub fn q(&self, order: usize) -> Vec<Var> {
        self.coordinates.q.iter().map(|c| c[order]).collect()
    }

    /// The prescribed coordinates Q, Q̇ or Q̈.
    pub fn prescribed(&self, order: usize) -> Vec<Var> {
        self.mechanism.prescribed().iter().map(|i| self.coordinates.q[*i][order]).collect()
    }

    /// β, β̇ or β̈.
    pub fn unactuated(&self, order: usize) -> Var {
        self.coordinates.q[self.mechanism.unactuated][order]
    }
}

/// Inertia times a vector in the body's axes.
pub fn scaled(v: &Vec3, inertia: &[Vec3; 3]) -> Vec3 {
    [0, 1, 2].map(|i| dot(v, &inertia[i]))
}
