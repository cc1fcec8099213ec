//! Dynamics of a tree of rigid bodies in numbers: Newton and Euler, projected on partial velocities.
//!
//! With X = [p, q], a body's velocities are linear in Ẋ: v = Σ vₖ Ẋₖ, ω = Σ ωₖ Ẋₖ. The vₖ and ωₖ are
//! its partial velocities, and eq. 5 is, component by component,
//!
//! ```text
//! Σ_bodies  m (a − g)·vₖ + (I α + ω × I ω)·ωₖ  =  generalized force on Ẋₖ
//! ```
//!
//! A is the part linear in Ẍ and H the rest. Everything is 3-D and in world axes (Xf forward, Yf up,
//! Zf right) with positions from the platform's mass centre; nothing here is symbolic, and nothing is
//! shared with the generated code but the numbers of the specification. In a gait without z the
//! motion across the sagittal plane, and so the depth of the hips, is ignored; where nothing turns out
//! of that plane either, the same can be computed within it ([`Geometry`]).

use super::geometry::{Geometry, Space, Vec3};
use super::numbers::Numbers;
use num_traits::Zero;
use piaffe_model::{Description, Rotation};
use piaffe_number::Scalar;

/// A mechanism at one state. The workspace is allocated once; no method allocates.
#[derive(Clone, Debug)]
pub struct Multibody<'a, T: Scalar = f64, G: Geometry<T> = Space> {
    description: &'a Description,
    numbers: Numbers<T>,
    frames: Vec<Frame<T, G>>,
    coms: Vec<Point<G::Vector>>,
    /// Body that coordinate k of q turns on its parent (θ: the platform on the world).
    carriers: Vec<usize>,
    /// Whether coordinate k moves body b, at `k * bodies + b`.
    moves: Vec<bool>,
    feet: [Point<G::Vector>; 2],
}

/// A body: where it is and how it moves, relative to the platform's mass centre.
#[derive(Clone, Copy, Debug)]
struct Frame<T: Scalar, G: Geometry<T>> {
    axes: G::Axes,
    /// Axis of the body's joint.
    axis: G::Spin,
    spin: G::Spin,
    spin_rate: G::Spin,
    joint: Point<G::Vector>,
}

/// A point with its motion relative to the platform's mass centre; m, m/s, m/s².
#[derive(Clone, Copy, Debug)]
pub struct Point<V = Vec3> {
    pub position: V,
    pub velocity: V,
    pub acceleration: V,
}

impl<'a> Multibody<'a> {
    pub fn new(description: &'a Description) -> Self {
        Multibody::with(description, Numbers::new(description))
    }
}

impl<'a, T: Scalar, G: Geometry<T>> Multibody<'a, T, G> {
    /// The mechanism of `description` with other numbers.
    pub fn with(description: &'a Description, numbers: Numbers<T>) -> Self {
        let count = description.bodies.len();
        let mut carriers = vec![0; description.orientations()];
        let mut moves = vec![false; carriers.len() * count];
        for (b, body) in description.bodies.iter().enumerate() {
            for k in 0..carriers.len() {
                let inherited = body.parent.is_some_and(|parent| moves[k * count + parent]);
                let turned_by_theta = b == 0 && k == description.joints();
                moves[k * count + b] = inherited || turned_by_theta || body.coordinate == Some(k);
            }
            if let Some(k) = body.coordinate {
                carriers[k] = b;
            }
        }
        let still = Frame::still();
        let origin = still.joint;
        Multibody {
            description,
            numbers,
            frames: vec![still; count],
            coms: vec![origin; count],
            carriers,
            moves,
            feet: [origin; 2],
        }
    }

    pub fn description(&self) -> &'a Description {
        self.description
    }

    pub fn numbers(&self) -> &Numbers<T> {
        &self.numbers
    }

    /// Number of components of X.
    pub fn size(&self) -> usize {
        self.description.positions() + self.description.orientations()
    }

    /// Moves the mechanism to q, q̇, q̈ (rad, rad/s, rad/s²), with p at rest in the origin.
    ///
    /// Each list has one number per coordinate of q. With q̈ = 0, accelerations are those that come from velocities alone.
    pub fn set(&mut self, q: &[T], qd: &[T], qdd: &[T]) {
        let axis = if self.description.rotation == Rotation::Roll { 0 } else { 2 };
        let theta = self.description.joints();
        let bodies = self.description.bodies.iter().zip(&self.numbers.bodies);
        for (b, ((body, numbers), com)) in bodies.zip(&mut self.coms).enumerate() {
            let (above, here) = self.frames.split_at_mut(b);
            let Some(frame) = here.first_mut() else { continue };
            match body.parent.and_then(|parent| above.get(parent)) {
                Some(parent) => {
                    parent.locate(&numbers.offset, &mut frame.joint);
                    frame.follow(parent);
                }
                None => frame.rest(),
            }
            match body.coordinate {
                Some(k) => frame.turn(body.axis, q[k], qd[k], qdd[k]),
                None if b == 0 && theta < q.len() => frame.turn(axis, q[theta], qd[theta], qdd[theta]),
                None => {}
            }
            frame.locate(&numbers.com, com);
        }
        for ((foot, leg), arm) in self.feet.iter_mut().zip(&self.description.legs).zip(&self.numbers.feet) {
            self.frames[leg.foot_body].locate(arm, foot);
        }
        if !self.description.is_spatial() {
            self.coms.iter_mut().chain(&mut self.feet).for_each(Point::flatten::<T, G>);
        }
    }

    /// The foot of a leg, relative to the platform's mass centre.
    pub fn foot(&self, leg: usize) -> &Point<G::Vector> {
        &self.feet[leg]
    }

    /// The mass centre of a body, relative to the platform's.
    pub fn com(&self, body: usize) -> &Point<G::Vector> {
        &self.coms[body]
    }

    /// The robot's mass centre, relative to the platform's.
    pub fn centre(&self) -> Point<G::Vector> {
        let mut mass = T::zero();
        let mut sum =
            Point { position: G::Vector::zero(), velocity: G::Vector::zero(), acceleration: G::Vector::zero() };
        for (com, body) in self.coms.iter().zip(&self.numbers.bodies) {
            mass += body.mass;
            sum.position += com.position * body.mass;
            sum.velocity += com.velocity * body.mass;
            sum.acceleration += com.acceleration * body.mass;
        }
        let share = T::from(1.0) / mass;
        Point { position: sum.position * share, velocity: sum.velocity * share, acceleration: sum.acceleration * share }
    }

    /// Its partial velocity in q̇ₖ.
    pub fn partial_velocity_of_centre(&self, k: usize) -> G::Vector {
        let (mut mass, mut sum) = (T::zero(), G::Vector::zero());
        for (b, body) in self.numbers.bodies.iter().enumerate() {
            mass += body.mass;
            sum += self.partial_velocity(k, b, self.coms[b].position) * body.mass;
        }
        sum * (T::from(1.0) / mass)
    }

    /// The part straight up of an arm in the axes of a body.
    pub fn rise(&self, body: usize, arm: &Vec3<T>) -> T {
        G::rise(&self.frames[body].axes, arm)
    }

    /// Angular velocity of a body, rad/s.
    pub fn spin(&self, body: usize) -> G::Spin {
        self.frames[body].spin
    }

    /// Whether coordinate `k` of q moves a body relative to the platform's mass centre.
    pub fn moves(&self, k: usize, body: usize) -> bool {
        self.moves[k * self.frames.len() + body]
    }

    /// Axis of coordinate `k` of q, and where it is.
    pub fn axis(&self, k: usize) -> (G::Spin, G::Vector) {
        let carrier = &self.frames[self.carriers[k]];
        (carrier.axis, carrier.joint.position)
    }

    /// Partial velocity in q̇ₖ of the point of a body that is at `position`, m.
    pub fn partial_velocity(&self, k: usize, body: usize, position: G::Vector) -> G::Vector {
        if !self.moves(k, body) {
            return G::Vector::zero();
        }
        let (axis, joint) = self.axis(k);
        let velocity = G::swirl(axis, position - joint);
        if self.description.is_spatial() { velocity } else { G::flattened(velocity) }
    }

    /// Partial angular velocity of a body in q̇ₖ.
    pub fn partial_spin(&self, k: usize, body: usize) -> G::Spin {
        if self.moves(k, body) { self.axis(k).0 } else { G::Spin::zero() }
    }

    /// Angular momentum of a body about its mass centre if it turned at `spin`.
    pub fn spin_momentum(&self, body: usize, spin: G::Spin) -> G::Spin {
        G::spin_momentum(&self.frames[body].axes, &self.numbers.bodies[body], spin)
    }

    /// Moment that a body's own rotation takes, about its mass centre: I α + ω × I ω, N·m.
    pub fn spin_moment(&self, body: usize) -> G::Spin {
        let frame = &self.frames[body];
        G::spin_moment(&frame.axes, &self.numbers.bodies[body], frame.spin, frame.spin_rate)
    }
}

/// The equations of motion as a whole, in space.
impl<'a, T: Scalar> Multibody<'a, T> {
    /// A(q) of eq. 5, row-major, kg, kg·m and kg·m².
    pub fn inertia(&self, out: &mut [T]) {
        let n = self.size();
        out.fill(T::zero());
        for (b, body) in self.numbers.bodies.iter().enumerate() {
            for column in 0..n {
                let (u, s) = self.partials(column, b);
                let (momentum, spin_momentum) = (u * body.mass, self.spin_momentum(b, s));
                for row in 0..=column {
                    let (v, w) = self.partials(row, b);
                    out[row * n + column] += v.dot(&momentum) + w.dot(&spin_momentum);
                }
            }
        }
        for row in 0..n {
            out[row * n + row] += self.rotor(row);
            (0..row).for_each(|column| out[row * n + column] = out[column * n + row]);
        }
    }

    /// H(q, q̇) of eq. 5 where [`Multibody::set`] was given q̈ = 0, N and N·m.
    pub fn bias(&self, out: &mut [T]) {
        for (k, sum) in out.iter_mut().enumerate().take(self.size()) {
            *sum = T::zero();
            for (b, body) in self.numbers.bodies.iter().enumerate() {
                let (v, w) = self.partials(k, b);
                let mut acceleration = self.com(b).acceleration;
                acceleration.y += self.numbers.gravity;
                *sum += body.mass * v.dot(&acceleration) + w.dot(&self.spin_moment(b));
            }
        }
    }

    /// D of eq. 3, one row per coordinate of X: ḋ = DᵀẊ.
    pub fn foot_jacobian(&self, leg: usize, out: &mut [T]) {
        let nc = self.description.positions();
        let body = self.description.legs[leg].foot_body;
        for (k, row) in out.chunks_exact_mut(nc).enumerate().take(self.size()) {
            let v = if k < nc { unit(k) } else { self.partial_velocity(k - nc, body, self.feet[leg].position) };
            row.copy_from_slice(&v.as_slice()[..nc]);
        }
    }

    /// Kinetic and potential energy (zero at y = 0) with the platform at `p` and moving at `pd`, J.
    pub fn energy(&self, p: &Vec3<T>, pd: &Vec3<T>, qd: &[T]) -> (T, T) {
        let (mut kinetic, mut potential) = (T::zero(), T::zero());
        let half = T::from(0.5);
        for (b, body) in self.numbers.bodies.iter().enumerate() {
            let com = self.com(b);
            let (spin, velocity) = (self.spin(b), pd + com.velocity);
            kinetic += half * body.mass * velocity.dot(&velocity) + half * spin.dot(&self.spin_momentum(b, spin));
            potential += body.mass * self.numbers.gravity * (p.y + com.position.y);
        }
        for (joint, rate) in self.numbers.joints.iter().zip(qd) {
            kinetic += half * joint.rotor_inertia * *rate * *rate;
        }
        (kinetic, potential)
    }

    /// Partial velocities of a body's mass centre and spin in Ẋₖ.
    fn partials(&self, k: usize, body: usize) -> (Vec3<T>, Vec3<T>) {
        let positions = self.description.positions();
        if k < positions {
            return (unit(k), Vec3::zeros());
        }
        let k = k - positions;
        (self.partial_velocity(k, body, self.coms[body].position), self.partial_spin(k, body))
    }

    /// Inertia that a rotor adds to coordinate `k` of X: it turns with its joint, gear² times as heavy.
    fn rotor(&self, k: usize) -> T {
        let joint = k.checked_sub(self.description.positions()).and_then(|j| self.numbers.joints.get(j));
        joint.map_or(T::zero(), |j| j.rotor_inertia)
    }
}

impl<V> Point<V> {
    /// Leaves out its motion across the sagittal plane.
    fn flatten<T: Scalar, G: Geometry<T, Vector = V>>(&mut self)
    where
        V: Copy,
    {
        self.velocity = G::flattened(self.velocity);
        self.acceleration = G::flattened(self.acceleration);
    }
}

impl<T: Scalar, G: Geometry<T>> Frame<T, G> {
    /// The world's axes.
    fn still() -> Self {
        let (zero, still) = (G::Vector::zero(), G::Spin::zero());
        let origin = Point { position: zero, velocity: zero, acceleration: zero };
        Frame { axes: G::upright(), axis: still, spin: still, spin_rate: still, joint: origin }
    }

    /// Moves `point` to where this body has it: `arm` away from its joint, in its own axes.
    fn locate(&self, arm: &Vec3<T>, point: &mut Point<G::Vector>) {
        let arm = G::in_world(&self.axes, G::seen(arm));
        let swirl = G::swirl(self.spin, arm);
        point.position = self.joint.position + arm;
        point.velocity = self.joint.velocity + swirl;
        point.acceleration = self.joint.acceleration + G::swirl(self.spin_rate, arm) + G::swirl(self.spin, swirl);
    }

    /// Takes over the world's axes, at rest.
    fn rest(&mut self) {
        (self.axes, self.spin, self.spin_rate) = (G::upright(), G::Spin::zero(), G::Spin::zero());
    }

    /// Takes over the rotation and spin of the body above.
    fn follow(&mut self, above: &Self) {
        (self.axes, self.spin, self.spin_rate) = (above.axes, above.spin, above.spin_rate);
    }

    /// Turns the frame about its own axis 0, 1 or 2.
    fn turn(&mut self, axis: usize, angle: T, rate: T, acceleration: T) {
        G::turn(&mut self.axes, axis, angle.sin_cos());
        self.axis = G::axis(&self.axes, axis);
        self.spin_rate += self.axis * acceleration + G::precession(self.spin, self.axis) * rate;
        self.spin += self.axis * rate;
    }
}

fn unit<T: Scalar>(k: usize) -> Vec3<T> {
    let mut v = Vec3::zeros();
    v[k] = T::from(1.0);
    v
}
