//! The interface between generated dynamics and everything that uses them.
//!
//! A build generates one type per gait that implements [`Gait`]. Kernels take slices and write their
//! outputs, one after another and row-major, into `out`; the generated modules also have every
//! kernel as a function over arrays, with its documentation and operation counts. Coordinates,
//! frames and units: X = [p, q], world axes Xf forward, Yf up, Zf to the right; SI.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod contradiction;
#[allow(clippy::disallowed_methods, reason = "words: how many digits a person reads")]
pub mod digits;
pub mod family;
mod fingerprint;
pub mod limit;
pub mod motion;
mod numbers;
pub mod shape;
mod specification;
pub mod units;
pub mod whole;

use crate::motion::Costs;
pub use contradiction::Contradiction;
pub use fingerprint::hash;
pub use limit::Limit;
pub use numbers::Lever;
pub use specification::Specification;
use std::borrow::Cow;

/// What a gait is made of, in numbers.
#[derive(Clone, Debug)]
pub struct Description {
    /// What the command line calls it: `trot`, or `rabbit/walk` for a gait of a further robot.
    pub key: &'static str,
    pub gait: &'static str,
    pub robot: &'static str,
    /// m/s², along −Yf.
    pub gravity: f64,
    pub rotation: Rotation,
    /// What the gait does, in the order in which it does it.
    pub phases: Cow<'static, [Phase]>,
    /// What follows the last of them.
    pub then: Then,
    /// Parents precede children; body 0 is the platform.
    pub bodies: Cow<'static, [Body]>,
    /// Of what the platform fills.
    pub corners: Cow<'static, [Spot]>,
    pub joints: Cow<'static, [Joint]>,
    pub legs: [Leg; 2],
    /// Index of β in q.
    pub unactuated: usize,
    /// Order of the joint polynomials (eq. 15).
    pub polynomial_order: usize,
    /// What must stay above the ground.
    pub points: &'static [Point],
    /// Which of these can be the lowest: whose heights [`Gait::heights`] gives.
    pub lowest: &'static [usize],
    pub limits: Limits,
    /// Where everything stands in what the kernels give.
    pub shapes: &'static shape::Shapes,
    /// What each generated kernel costs.
    pub operations: &'static [Operations],
}

/// Components of what points somewhere, in world axes.
pub const FORWARD: usize = 0;
pub const UP: usize = 1;
pub const SIDEWAYS: usize = 2;

/// How the platform may rotate: θ is the last of q, about Zf or about Xf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    None,
    Pitch,
    Roll,
}

/// The leg beside this one (0 or 1).
#[inline]
pub const fn other_leg(leg: usize) -> usize {
    1 - leg
}

/// A contact mode: what stands on the ground. The unit for which dynamics are derived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Single support on the foot of this leg (0 or 1).
    Stance(usize),
    /// Nothing stands: the mass centre flies like a stone, and nothing turns the robot about it.
    Flight,
}

impl Mode {
    /// The leg that stands.
    pub fn stance(self) -> Option<usize> {
        match self {
            Mode::Stance(leg) => Some(leg),
            Mode::Flight => None,
        }
    }

    /// The same when the legs have exchanged roles.
    pub fn exchanged(self) -> Mode {
        match self {
            Mode::Stance(leg) => Mode::Stance(other_leg(leg)),
            Mode::Flight => Mode::Flight,
        }
    }

    /// The legs whose feet are in the air, in the order in which kernels give them.
    pub fn swinging(self) -> impl Iterator<Item = usize> + Clone {
        (0..2).filter(move |leg| self != Mode::Stance(*leg))
    }
}

/// A mode for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    pub mode: Mode,
    /// Shortest and longest, s.
    pub duration: [f64; 2],
}

/// What follows the last phase of a gait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// The same with the legs' roles exchanged: the phases are half a cycle.
    Mirrored,
    /// The first phase again: they are the whole cycle.
    Repeat,
}

/// What happens between two phases. Legs are called as in the phase before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transition {
    /// The foot of this leg lands in a passive impact (eq. 12), and the other one leaves.
    Touchdown(usize),
    /// The foot of this leg lands out of flight, likewise.
    Landing(usize),
    /// The foot of this leg, at rest so far, leaves into flight: all velocities stay.
    TakeOff(usize),
}

impl Transition {
    /// The leg whose foot lands.
    pub fn lands(self) -> Option<usize> {
        match self {
            Transition::Touchdown(leg) | Transition::Landing(leg) => Some(leg),
            Transition::TakeOff(_) => None,
        }
    }
}

/// A rigid body and the joint that carries it.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: &'static str,
    pub parent: Option<usize>,
    /// Index of its joint's coordinate in q.
    pub coordinate: Option<usize>,
    /// Axis of its joint: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Its joint in the parent's axes, m.
    pub offset: [f64; 3],
    pub mass: f64,
    /// Mass centre from its joint in its own axes, m.
    pub com: [f64; 3],
    /// Tensor about the mass centre in its own axes, kg·m².
    pub inertia: [[f64; 3]; 3],
}

/// An actuated joint; N·m, rad and rad/s at the joint.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: &'static str,
    pub range: [f64; 2],
    pub gear: f64,
    pub max_torque: f64,
    pub unloaded_speed: f64,
    /// Speed limit at `max_torque`.
    pub loaded_speed: f64,
    pub rotor_inertia: f64,
    /// What its motor overcomes besides the dynamics is `stiffness · (q − rest) + damping · q̇ + coulomb · sign q̇`: a spring beside it,
    /// N·m/rad.
    pub stiffness: f64,
    /// Where the spring does nothing, rad.
    pub rest: f64,
    /// Viscous friction, N·m·s/rad.
    pub damping: f64,
    /// Dry friction, N·m.
    pub coulomb: f64,
}

/// A joint rests while its rate is below this share of √(gravity/leg): what there is of a rate then is rounding, and dry friction
/// asks nothing of the motor.
pub const RESTING_RATE: f64 = 1e-6;

impl Joint {
    /// Whether a spring acts beside its motor.
    pub fn has_spring(&self) -> bool {
        self.stiffness != 0.0
    }

    /// Whether its motor has friction to overcome.
    pub fn has_friction(&self) -> bool {
        self.damping != 0.0 || self.coulomb != 0.0
    }
}

/// A virtual leg.
#[derive(Clone, Debug)]
pub struct Leg {
    /// The real legs that it stands for. They move alike; how they share torques and reactions
    /// is in `four_legs`.
    pub members: Cow<'static, [Member]>,
    pub first_joint: usize,
    pub end_joint: usize,
    pub foot_body: usize,
    /// Foot from the joint of `foot_body`, m.
    pub foot: [f64; 3],
}

/// A real leg.
#[derive(Clone, Debug)]
pub struct Member {
    pub name: &'static str,
    /// Its own links from the platform down, with the virtual leg's coordinates. The parent of the first is the
    /// platform (0), of the others the link before (1, 2, …). Their names are theirs alone in the robot.
    pub bodies: Cow<'static, [Body]>,
    /// Names of its joints from the platform down, theirs alone in the robot.
    pub joints: Cow<'static, [&'static str]>,
    /// Foot from the joint of the last link, m.
    pub foot: [f64; 3],
    /// Its joints, also those that the gait holds still.
    pub spots: Cow<'static, [Spot]>,
}

/// A point of a body.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// 0: the platform; k: the k-th link of its leg.
    pub body: usize,
    /// In the axes of the body, from its joint (from the mass centre for the platform), m.
    pub at: [f64; 3],
}

/// A spot as a part of the gait: what moves it. Where the halves of a cycle mirror each other a leg also takes the part of
/// its counterpart, and where the platform rolls it does so as its own mirror image.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// As reports show it.
    pub name: &'static str,
    /// The real leg whose spot it is, as (virtual leg, member); `None`: one of the platform's corners.
    pub of: Option<(usize, usize)>,
    /// Which of its spots.
    pub spot: usize,
    /// The virtual leg with which it moves; of no matter for the platform's.
    pub leg: usize,
    /// As a mirror shows it that exchanges left and right.
    pub mirrored: bool,
}

impl Point {
    /// How many links lead to it.
    pub fn links(&self, d: &Description) -> usize {
        match self.of {
            Some((leg, member)) => d.legs[leg].members[member].spots[self.spot].body,
            None => d.corners[self.spot].body,
        }
    }

    /// The body that moves like its k-th link, the platform before the first.
    pub fn body(&self, d: &Description, k: usize) -> usize {
        let leg = &d.legs[self.leg];
        if k == 0 { 0 } else { leg.foot_body + k - (leg.end_joint - leg.first_joint) }
    }
}

impl Member {
    /// Its first joint from the platform's mass centre, in the platform's axes, m.
    pub fn mount(&self) -> [f64; 3] {
        self.bodies.first().map_or(self.foot, |b| b.offset)
    }
}

/// Limits of §6.1.
#[derive(Clone, Debug)]
pub struct Limits {
    pub friction: f64,
    /// N.
    pub min_vertical_force: f64,
    /// Height of the swing parabola, m.
    pub swing_clearance: f64,
    /// Of the platform's mass centre above the ground, m.
    pub min_platform_height: f64,
    /// Of everything but feet above the ground, m.
    pub body_clearance: f64,
    /// Whether contact, torques and speeds must also hold at each real leg (see `constraints::sharing`), not only at the
    /// virtual legs.
    pub real_legs: bool,
}

/// Floating-point operations of a generated kernel.
#[derive(Clone, Copy, Debug)]
pub struct Operations {
    pub kernel: &'static str,
    pub flops: usize,
    pub divisions: usize,
    pub sincos: usize,
    /// What `flops` would be of the expressions as they are derived.
    pub derived: usize,
    /// Length of the source.
    pub bytes: usize,
}

impl Description {
    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// Whether it moves in space: p has a z where the platform rolls. Else it stays in the sagittal plane.
    pub fn is_spatial(&self) -> bool {
        self.rotation == Rotation::Roll
    }

    /// Number of position coordinates p, and of components of a reaction.
    pub fn positions(&self) -> usize {
        if self.is_spatial() { 3 } else { 2 }
    }

    /// Number of coordinates q: joints, then θ where the platform rotates.
    pub fn orientations(&self) -> usize {
        self.joints.len() + usize::from(self.rotation != Rotation::None)
    }

    /// Number of prescribed coordinates Q: all of q but β.
    pub fn prescribed(&self) -> usize {
        self.orientations() - 1
    }

    /// Index in q of the k-th prescribed coordinate.
    pub fn prescribed_index(&self, k: usize) -> usize {
        if k < self.unactuated { k } else { k + 1 }
    }

    /// All of q from its prescribed coordinates and β; of the rates likewise.
    pub fn complete<T: Copy>(&self, prescribed: &[T], beta: T) -> Vec<T> {
        let mut all = prescribed.to_vec();
        all.insert(self.unactuated.min(all.len()), beta);
        all
    }

    pub fn total_mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).sum()
    }

    /// N.
    pub fn weight(&self) -> f64 {
        self.total_mass() * self.gravity
    }

    /// Energy per weight and distance, E/(m g d): a number without a unit, by which robots of any size compare. It is that of
    /// the motion with these costs, whichever of them it minimizes.
    pub fn cost_of_transport(&self, costs: &Costs) -> f64 {
        costs.energy / self.weight()
    }

    /// Whether some phase is a flight.
    pub fn flies(&self) -> bool {
        self.has(Mode::Flight)
    }

    /// Whether some phase has this mode.
    pub fn has(&self, mode: Mode) -> bool {
        self.phases.iter().any(|phase| phase.mode == mode)
    }

    /// The mode of the `i`-th phase of a motion without end, 0 being the gait's first: with the legs' names of that one.
    pub fn mode(&self, i: isize) -> Mode {
        let count = self.phases.len() as isize;
        let mode = self.phases[i.rem_euclid(count) as usize].mode;
        let exchanged = self.then == Then::Mirrored && i.div_euclid(count).rem_euclid(2) == 1;
        if exchanged { mode.exchanged() } else { mode }
    }

    /// What ends phase `k`.
    pub fn transition(&self, k: usize) -> Transition {
        match (self.phases[k].mode, self.mode(k as isize + 1)) {
            (Mode::Stance(leg), Mode::Flight) => Transition::TakeOff(leg),
            (Mode::Stance(from), to) => Transition::Touchdown(to.stance().unwrap_or(other_leg(from))),
            (Mode::Flight, to) => Transition::Landing(to.stance().unwrap_or_default()),
        }
    }

    /// Whether the legs exchange roles after phase `k`.
    pub fn exchanges(&self, k: usize) -> bool {
        self.then == Then::Mirrored && k + 1 == self.phases.len()
    }

    /// Where the coordinate `index` of q in the phase after `k` comes from: index and sign.
    pub fn renamed(&self, k: usize, index: usize) -> (usize, f64) {
        if self.exchanges(k) { self.swapped(index) } else { (index, 1.0) }
    }

    /// Shapes of the kernels of a mode.
    pub fn shape(&self, mode: Mode) -> &'static shape::ModeShapes {
        match mode {
            Mode::Stance(_) => &self.shapes.stance,
            Mode::Flight => &self.shapes.flight,
        }
    }

    /// Joints whose torques are independent. Where the platform does not rotate, the unactuated
    /// joint's torque balances the others on the platform (eq. 1).
    pub fn independent_torques(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints.len()).filter(|j| *j != self.unactuated)
    }

    /// Length of a straight leg, m.
    pub fn leg_length(&self) -> f64 {
        self.reach(0)
    }

    /// Length of this leg when it is straight, m.
    fn reach(&self, leg: usize) -> f64 {
        let leg = &self.legs[leg];
        let links = self.bodies.iter().filter(|b| b.parent.is_some_and(|p| p != 0));
        let inner = links.filter(|b| b.coordinate.is_some_and(|c| (leg.first_joint..leg.end_joint).contains(&c)));
        inner.map(|b| norm(&b.offset)).sum::<f64>() + norm(&leg.foot)
    }

    /// Hip of a virtual leg from the platform's mass centre, in its axes, m.
    pub fn hip(&self, leg: usize) -> [f64; 3] {
        let first = self.legs[leg].first_joint;
        let body = self.bodies.iter().find(|b| b.parent == Some(0) && b.coordinate == Some(first));
        body.map_or([0.0; 3], |b| b.offset)
    }

    /// Whether the joint connects a leg to the platform.
    pub fn hangs_on_platform(&self, joint: usize) -> bool {
        self.bodies.iter().any(|b| b.parent == Some(0) && b.coordinate == Some(joint))
    }

    /// Where the coordinate `k` of q comes from when the legs swap roles: index and sign.
    pub fn swapped(&self, k: usize) -> (usize, f64) {
        let [a, b] = &self.legs;
        if k >= self.joints.len() {
            return (k, if self.rotation == Rotation::Roll { -1.0 } else { 1.0 });
        }
        let from =
            if k < b.first_joint { b.first_joint + (k - a.first_joint) } else { a.first_joint + (k - b.first_joint) };
        // A mirror image turns the other way about every axis that lies in the plane of the mirror.
        let turns = |b: &&Body| b.coordinate == Some(k) && b.axis != 2;
        let mirrored = self.rotation == Rotation::Roll && self.bodies.iter().any(|b| turns(&b));
        (from, if mirrored { -1.0 } else { 1.0 })
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Generated dynamics of one gait. `leg` is 0 or 1: the leg named. In flight positions are from the mass centre, which falls: there is
/// neither weight nor reaction, and σ̇ = 0. Of modes and transitions that a gait does
/// not have there are no numbers: NaN.
#[allow(clippy::too_many_arguments)]
pub trait Gait: Sync {
    fn description(&self) -> &Description;
    /// What it was derived from; of families nothing, since their members have numbers of their own.
    fn specification(&self) -> Option<&Specification> {
        None
    }
    /// The numbers of the specification on which the gait depends; of families none, since they have parameters.
    fn levers(&self) -> &[Lever] {
        &[]
    }
    /// The closed forms of eq. 2–5, 8 and 9 with the names of the robot's parameters: a LaTeX document.
    fn latex(&self) -> &str;
    /// The real robot that the virtual legs stand for. Members of families have none: it is generated with numbers.
    fn whole(&self) -> Option<&dyn whole::Whole> {
        None
    }

    /// A(q): n × n.
    fn inertia(&self, q: &[f64], out: &mut [f64]);
    /// H(q, q̇): n.
    fn bias(&self, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// A, then H.
    fn inertia_and_bias(&self, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// Kinetic, potential energy.
    fn energy(&self, x: &[f64], xd: &[f64], out: &mut [f64]);
    /// Mass centre of the robot, its velocity.
    fn centre_of_mass(&self, x: &[f64], xd: &[f64], out: &mut [f64]);
    /// Foot position d.
    fn foot(&self, leg: usize, x: &[f64], out: &mut [f64]);
    /// D: n × nc.
    fn foot_jacobian(&self, leg: usize, q: &[f64], out: &mut [f64]);
    /// Hᵢ: nc.
    fn foot_bias(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// σ about the foot, absolute velocities.
    fn angular_momentum(&self, leg: usize, x: &[f64], xd: &[f64], out: &mut [f64]);

    /// ṗ with the stance foot at rest.
    fn platform_velocity(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// f1, f2, σ, c, σ̇ (eq. 8, 9).
    fn momentum_terms(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// Aq, Hq (eq. 6).
    fn reduced(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// Ẍ, F from the independent torques.
    fn forward(&self, mode: Mode, q: &[f64], qd: &[f64], gamma: &[f64], out: &mut [f64]);
    /// Ẍ, Γ (all joints), F from Q̈.
    fn inverse(&self, mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]);
    /// σ, ∂σ/∂(q, q̇).
    fn momentum(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]);
    /// β̈, Γ, F, ∂(Γ, F, balance)/∂(q, q̇, q̈).
    fn inverse_jacobian(&self, mode: Mode, q: &[f64], qd: &[f64], actuated_dd: &[f64], out: &mut [f64]);
    /// p, swing foot, ∂p/∂q, ∂swing/∂q; from the stance foot.
    fn placement(&self, mode: Mode, q: &[f64], out: &mut [f64]);
    /// Heights over the ground of the description's `lowest` points, ∂/∂q.
    fn heights(&self, mode: Mode, q: &[f64], out: &mut [f64]);
    /// Swing foot's velocity, its Jacobian in (q, q̇).
    fn swing_velocity(&self, mode: Mode, q: &[f64], qd: &[f64], out: &mut [f64]);

    /// What eq. 8 and 9 need of (Q, Q̇) alone.
    fn early(&self, mode: Mode, actuated: &[f64], actuated_d: &[f64], out: &mut [f64]);
    /// f1, f2, σ̇, then their derivatives in β.
    fn late(&self, mode: Mode, early: &[f64], beta: f64, out: &mut [f64]);
    /// ∂f1/∂Q, ∂f2/∂Q, ∂f2/∂Q̇, ∂σ̇/∂Q.
    fn late_gradient(&self, mode: Mode, early: &[f64], beta: f64, out: &mut [f64]);

    /// Impact on the foot of `leg` (eq. 12): Ẋ⁺, impulse.
    fn impact(&self, leg: usize, q: &[f64], xd: &[f64], out: &mut [f64]);
    /// Impact on the foot of `leg` after support on the other: q̇⁺, impulse, leaving, landing, Jacobian in (q, q̇⁻);
    /// where the platform rolls also couple, pitch, and their Jacobian.
    fn touchdown(&self, leg: usize, q: &[f64], qd: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd);
        out.fill(f64::NAN);
    }
    /// Gradient and second derivatives (q·q, q·q̇, q·q̈, q̇·q̇) of the weighted sum of an instant's outputs;
    /// `n` weighs the torque of every joint, then the balance of eq. 10.
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
    );
    /// Gradient in q and second derivatives (q·q) of the weighted sum of [`Gait::heights`].
    fn heights_curvature(&self, mode: Mode, q: &[f64], weights: &[f64], out: &mut [f64]);
    /// Second derivatives (q·q, q·q̇⁻, q·q̇⁺) of a touchdown's weighted results.
    fn touchdown_curvature(&self, leg: usize, q: &[f64], qd: &[f64], xi: &[f64], outputs: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd, xi, outputs);
        out.fill(f64::NAN);
    }
    /// Impact on the foot of `leg` after a flight: q̇⁺, impulse, landing, Jacobian in (q, v⁻, q̇⁻), v the
    /// mass centre's velocity.
    fn landing(&self, leg: usize, q: &[f64], v: &[f64], qd: &[f64], out: &mut [f64]) {
        let _ = (leg, q, v, qd);
        out.fill(f64::NAN);
    }
    /// Second derivatives (q·q, q·(v⁻, q̇⁻), q·q̇⁺) of a landing's weighted results.
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
        let _ = (leg, q, v, qd, xi, outputs);
        out.fill(f64::NAN);
    }
    /// What begins when the foot of `leg` leaves the ground at rest: mass centre from it, its velocity, the foot's vertical
    /// acceleration, ∂/∂(q, q̇, q̈).
    fn takeoff(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd, qdd);
        out.fill(f64::NAN);
    }
    /// Gradient and second derivatives, as of [`Gait::curvature`], of a take-off's weighted results.
    fn takeoff_curvature(&self, leg: usize, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let _ = (leg, q, qd, qdd, weights);
        out.fill(f64::NAN);
    }
    /// Where the platform rolls: moment (y, z) about the stance foot, ∂foot/∂q of its leg, ∂(these)/∂(q, q̇, q̈). Elsewhere
    /// the real legs share equally: not numbers.
    fn sharing(&self, mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        let _ = (mode, q, qd, qdd);
        out.fill(f64::NAN);
    }
    /// Gradient and second derivatives, as of [`Gait::curvature`], of the weighted sum of what [`Gait::sharing`] gives.
    fn sharing_curvature(&self, mode: Mode, q: &[f64], qd: &[f64], qdd: &[f64], weights: &[f64], out: &mut [f64]) {
        let _ = (mode, q, qd, qdd, weights);
        out.fill(f64::NAN);
    }
    /// Both feet stay (eq. 11): Ẋ⁺, impulses on foot 1 and 2, pivots, scale.
    fn impact_both(&self, q: &[f64], xd: &[f64], out: &mut [f64]);
}
