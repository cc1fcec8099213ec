//! The whole robot in the motion of a gait.

use crate::passive::Passive;
use crate::walk::{Moment, Point};
use piaffe_model::whole::Whole;
use piaffe_model::{Description, Gait, Rotation};

/// Which real legs and joints stand behind the virtual ones.
pub struct Legs<'a> {
    pub whole: &'a dyn Whole,
    pub description: &'a Description,
    /// Of each joint of the whole robot the virtual leg's.
    pub joints: Vec<usize>,
    /// Of each real leg the virtual one.
    pub legs: Vec<usize>,
    /// Of each joint of the whole robot its part of what the virtual leg's has to overcome.
    pub passive: Vec<Option<Passive>>,
}

/// The whole robot at one instant. Axes of a [`Whole`]: speeds u and their derivatives in those of the platform.
#[derive(Clone, Debug)]
pub struct Posture {
    /// Platform's mass centre, m.
    pub position: Point,
    /// The platform's axes x, y, z in the world's.
    pub axes: [Point; 3],
    /// rad.
    pub q: Vec<f64>,
    pub u: Vec<f64>,
    /// u̇.
    pub ud: Vec<f64>,
}

impl<'a> Legs<'a> {
    /// `None` if the gait has no whole robot (see [`Gait::whole`]).
    pub fn new(gait: &'a dyn Gait) -> Option<Legs<'a>> {
        let (whole, description) = (gait.whole()?, gait.description());
        let w = whole.description();
        let (mut joints, mut legs) = (vec![0; w.joints.len()], vec![0; w.legs.len()]);
        for (k, virtual_leg) in description.legs.iter().enumerate() {
            for member in virtual_leg.members.iter() {
                let real = w.legs.iter().position(|leg| leg.name == member.name)?;
                legs[real] = k;
                w.legs[real].joints.clone().zip(virtual_leg.first_joint..).for_each(|(j, of)| joints[j] = of);
            }
        }
        let of_virtual = Passive::all(description);
        let passive =
            joints.iter().map(|j| of_virtual[*j].map(|passive| passive.shared(sharing(description, *j)))).collect();
        Some(Legs { whole, description, joints, legs, passive })
    }

    /// The real legs of a virtual one.
    pub fn members(&self, leg: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.legs.len()).filter(move |real| self.legs[*real] == leg)
    }

    /// How many legs share what the virtual leg of a real joint does.
    pub fn sharing(&self, joint: usize) -> f64 {
        sharing(self.description, self.joints[joint])
    }

    /// Whether dry friction has the same sign in all joints.
    pub fn rubs_alike(&self, a: &Posture, b: &Posture) -> bool {
        let mut joints = self.passive.iter().zip(a.rates().iter().zip(b.rates()));
        joints.all(|(passive, (a, b))| passive.is_none_or(|passive| passive.side(*a) == passive.side(*b)))
    }

    /// The robot's weight, N.
    pub fn weight(&self) -> f64 {
        self.whole.description().total_mass() * self.description.gravity
    }

    /// Its momentum at the speed √(g × leg length), N·s.
    pub fn momentum(&self) -> f64 {
        self.whole.description().total_mass() * (self.description.gravity * self.description.leg_length()).sqrt()
    }

    /// The axis about which the model of virtual legs lets the platform turn, or would: 0 for x, 2 for z.
    pub fn axis(&self) -> usize {
        if self.description.rotation == Rotation::Roll { 0 } else { 2 }
    }

    /// The whole robot at a moment of the gait's walk.
    pub fn posture(&self, m: &Moment) -> Posture {
        let axes = self.axes(&m.q);
        let [position, velocity, acceleration] = m.platform;
        let q = self.joints.iter().map(|j| m.q[*j]).collect();
        let (u, ud) = (self.speeds(&axes, velocity, &m.qd), self.speeds(&axes, acceleration, &m.qdd));
        Posture { position, axes, q, u, ud }
    }

    /// u, or its derivative, from the motion of the platform's mass centre in world axes and that of q.
    pub fn speeds(&self, axes: &[Point; 3], platform: Point, q: &[f64]) -> Vec<f64> {
        let mut turning = [0.0; 3];
        match self.description.rotation {
            Rotation::None => {}
            Rotation::Pitch => turning[2] = q[self.description.joints()],
            Rotation::Roll => turning[0] = q[self.description.joints()],
        }
        let mut u = Vec::with_capacity(6 + self.joints.len());
        u.extend(inside(axes, platform).into_iter().chain(turning));
        u.extend(self.joints.iter().map(|j| q[*j]));
        u
    }

    fn axes(&self, q: &[f64]) -> [Point; 3] {
        let (sin, cos) = libm::sincos(q.get(self.description.joints()).copied().unwrap_or_default());
        match self.description.rotation {
            Rotation::None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Rotation::Pitch => [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]],
            Rotation::Roll => [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]],
        }
    }
}

impl Posture {
    /// The vertical in the platform's axes.
    pub fn up(&self) -> Point {
        inside(&self.axes, [0.0, 1.0, 0.0])
    }

    /// Angular velocity in the platform's axes, rad/s.
    pub fn omega(&self) -> Point {
        [self.u[3], self.u[4], self.u[5]]
    }

    /// Rates of the joints, rad/s.
    pub fn rates(&self) -> &[f64] {
        &self.u[6..]
    }

    /// A vector of the world in the platform's axes.
    pub fn inside(&self, v: Point) -> Point {
        inside(&self.axes, v)
    }

    /// A vector in the platform's axes in the world's.
    pub fn outside(&self, v: Point) -> Point {
        [0, 1, 2].map(|k| (0..3).map(|a| self.axes[a][k] * v[a]).sum())
    }

    /// How the platform is turned, as a unit quaternion (w, x, y, z).
    pub fn quaternion(&self) -> [f64; 4] {
        let r = |i: usize, j: usize| self.axes[j][i];
        // Turns of a gait's platform stay far from half a turn, where this would be inaccurate.
        let w = 0.5 * (1.0 + r(0, 0) + r(1, 1) + r(2, 2)).max(0.0).sqrt();
        [w, (r(2, 1) - r(1, 2)) / (4.0 * w), (r(0, 2) - r(2, 0)) / (4.0 * w), (r(1, 0) - r(0, 1)) / (4.0 * w)]
    }
}

/// How many legs share what a joint of a virtual leg does.
fn sharing(d: &Description, joint: usize) -> f64 {
    d.legs[usize::from(joint >= d.legs[1].first_joint)].members.len() as f64
}

fn inside(axes: &[Point; 3], v: Point) -> Point {
    axes.map(|axis| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2])
}
