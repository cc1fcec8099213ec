//! A motion as a walk in the world: one whole step of the real robot, sampled in time.
//!
//! Everything comes from `Cycle`, which the optimizer uses too. What is added here is where things are: the
//! second half step of a mirrored gait, the footprints, and the real legs that a virtual leg stands for.

use crate::cycle::{Cycle, Sample, theta};
use crate::instant::{Glance, Quantities};
use crate::stance::Undefined;
use piaffe_model::motion::{Criterion, Motion};
use piaffe_model::{Body, Description, Gait, HalfSteps, Rotation};

/// A point or vector in world axes: forward, up, to the right.
pub type Point = [f64; 3];

/// One step: two half steps.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    pub description: &'a Description,
    pub half_steps: [Support; 2],
    /// In order of time. A half step's last moment and the next one's first are at the same time, before and
    /// after the impact.
    pub moments: Vec<Moment>,
    /// Forward travel in the whole step, m.
    pub travel: f64,
}

/// One half step.
#[derive(Clone, Copy, Debug)]
pub struct Support {
    /// When it begins, s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// The virtual leg in support.
    pub leg: usize,
}

/// The robot at one time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// From the beginning of the step, s.
    pub time: f64,
    /// 0 or 1.
    pub half_step: usize,
    /// Time as a share of the half step.
    pub share: f64,
    /// The virtual leg in support.
    pub stance: usize,
    /// Platform's mass centre, its velocity and acceleration; m, m/s, m/s².
    pub platform: [Point; 3],
    /// Coordinates q of the gait, with rates and accelerations; rad, rad/s, rad/s².
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Γ of every joint of the virtual legs, N·m.
    pub torque: Vec<f64>,
    /// Reaction on the virtual leg in support, N.
    pub force: Point,
    /// Foot of the virtual leg that swings, m.
    pub swing: Point,
}

impl<'a> Walk<'a> {
    /// The walk at equally spaced times, both ends of each half step among them.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    ///
    /// # Panics
    /// If the motion has not the numbers that the gait needs; `verify` tells.
    pub fn even(gait: &'a dyn Gait, motion: &Motion, intervals: usize) -> Result<Walk<'a>, Undefined> {
        Walk::new(gait, motion, |_| (0..=intervals).map(|k| k as f64 / intervals as f64).collect())
    }

    /// The walk at multiples of 1/`rate` (Hz), without the end, which is the beginning of the next step.
    ///
    /// # Errors, Panics
    /// As for [`Walk::even`].
    pub fn at_rate(gait: &'a dyn Gait, motion: &Motion, rate: f64) -> Result<Walk<'a>, Undefined> {
        Walk::new(gait, motion, |h| {
            let first = (h.start * rate).ceil() as u64;
            let shares = (first..).map(|k| (k as f64 / rate - h.start) / h.duration);
            shares.take_while(|s| *s < 1.0).collect()
        })
    }

    fn new(gait: &'a dyn Gait, motion: &Motion, shares: impl Fn(&Support) -> Vec<f64>) -> Result<Walk<'a>, Undefined> {
        let d = gait.description();
        // Neither criterion nor speed has a part in where the robot is.
        let cycle = Cycle::resolving(gait, Criterion::Torque, 1.0, &theta(motion))?;
        let mut moments = Vec::new();
        let mut stance_foot = [0.0; 3];
        let mut start = 0.0;
        let half_steps = [0, 1].map(|h| {
            let phase = h % d.phases();
            let duration = motion.half_steps[phase].duration;
            let leg = if h == phase { cycle.stance_leg(phase) } else { 1 - cycle.stance_leg(phase) };
            let support = Support { start, duration, leg };
            start += duration;
            support
        });
        for (h, support) in half_steps.iter().enumerate() {
            let phase = h % d.phases();
            let role = Role { gait, leg: support.leg, mirrored: h != phase && d.half_steps == HalfSteps::Mirrored };
            let last = cycle.last_node(phase);
            let landing = role.point(cycle.sample(phase, last).swing);
            if h == 0 {
                // The line of travel is midway between the footprints.
                stance_foot[2] = -0.5 * landing[2];
            }
            let mut glance = Glance::new(d, cycle.stance_leg(phase));
            for share in shares(support) {
                let sample = match share {
                    s if s <= 0.0 => cycle.sample(phase, 0),
                    s if s >= 1.0 => cycle.sample(phase, last),
                    s => {
                        cycle.glance(phase, s, &mut glance)?;
                        Sample::of(&glance, s)
                    }
                };
                let mut moment = role.moment(&sample, stance_foot);
                (moment.half_step, moment.time) = (h, support.start + share * support.duration);
                moments.push(moment);
            }
            // The foot lands on the ground: what is left of its height is rounding.
            stance_foot = [stance_foot[0] + landing[0], 0.0, stance_foot[2] + landing[2]];
        }
        Ok(Walk { description: d, half_steps, moments, travel: stance_foot[0] })
    }

    /// Duration of the step, s.
    pub fn duration(&self) -> f64 {
        self.half_steps.iter().map(|h| h.duration).sum()
    }
}

/// How a half step that defines the gait is performed: as it is, or by the other leg.
struct Role<'a> {
    gait: &'a dyn Gait,
    leg: usize,
    mirrored: bool,
}

impl Role<'_> {
    /// A vector of the gait's positions in world axes.
    fn point(&self, p: &[f64]) -> Point {
        let z = p.get(2).copied().unwrap_or(0.0);
        [p[0], p[1], if self.mirrored { -z } else { z }]
    }

    /// Values of all coordinates or joints, with the legs renamed.
    fn renamed(&self, values: &[f64]) -> Vec<f64> {
        let d = self.gait.description();
        let take = |k| {
            let (from, sign) = if self.mirrored { d.swapped(k) } else { (k, 1.0) };
            sign * values[from]
        };
        (0..values.len()).map(take).collect()
    }

    fn moment(&self, sample: &Sample, stance_foot: Point) -> Moment {
        let d = self.gait.description();
        let y = Quantities::new(d);
        let (nc, nj, shape) = (d.positions(), d.joints(), &d.shapes.inverse);
        let at = |p: Point| [0, 1, 2].map(|k| p[k] + stance_foot[k]);
        let [q, qd, qdd] = sample.state.map(|v| self.renamed(v));
        let prescribed: Vec<f64> = (0..d.prescribed()).map(|k| qdd[d.prescribed_index(k)]).collect();
        let mut velocity = vec![0.0; nc];
        self.gait.platform_velocity(self.leg, &q, &qd, &mut velocity);
        let mut inverse = shape.zeros();
        self.gait.inverse(self.leg, &q, &qd, &prescribed, &mut inverse);
        let plain = Role { gait: self.gait, leg: self.leg, mirrored: false };
        Moment {
            time: 0.0,
            half_step: 0,
            share: sample.share,
            stance: self.leg,
            platform: [
                at(self.point(sample.platform)),
                plain.point(&velocity),
                plain.point(&shape.xdd.of(&inverse)[..nc]),
            ],
            torque: self.renamed(&sample.quantities[y.torque(0)..][..nj]),
            force: self.point(&sample.quantities[y.force(0)..][..nc]),
            swing: at(self.point(sample.swing)),
            q,
            qd,
            qdd,
        }
    }
}

impl Moment {
    /// The joints of a real leg from the platform down, and its foot, m: of member `member` of virtual leg `leg`.
    pub fn chain(&self, d: &Description, leg: usize, member: usize) -> Vec<Point> {
        let member = &d.legs[leg].members[member];
        self.points(d, member.bodies.iter(), member.foot)
    }

    /// The same of a virtual leg.
    pub fn virtual_chain(&self, d: &Description, leg: usize) -> Vec<Point> {
        let leg = &d.legs[leg];
        let joints = leg.first_joint..leg.end_joint;
        let bodies = d.bodies.iter().filter(|b| b.coordinate.is_some_and(|c| joints.contains(&c)));
        self.points(d, bodies, leg.foot)
    }

    fn points<'b>(&self, d: &Description, bodies: impl Iterator<Item = &'b Body>, foot: Point) -> Vec<Point> {
        let (mut at, mut axes) = (self.platform[0], self.platform_axes(d));
        let mut points = Vec::new();
        for body in bodies {
            at = add(at, axes.turn(body.offset));
            points.push(at);
            axes = axes.rotated(body.axis, body.coordinate.map_or(0.0, |c| self.q[c]));
        }
        points.push(add(at, axes.turn(foot)));
        points
    }

    fn platform_axes(&self, d: &Description) -> Axes {
        let angle = self.q.last().copied().unwrap_or_default();
        match d.rotation {
            Rotation::None => Axes::WORLD,
            Rotation::Pitch => Axes::WORLD.rotated(2, angle),
            Rotation::Roll => Axes::WORLD.rotated(0, angle),
        }
    }
}

fn add(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] + b[k])
}

/// Axes of a body, as the columns of its rotation matrix.
#[derive(Clone, Copy)]
struct Axes([Point; 3]);

impl Axes {
    const WORLD: Axes = Axes([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// A vector of these axes in the world's.
    fn turn(&self, v: Point) -> Point {
        [0, 1, 2].map(|k| self.0[0][k] * v[0] + self.0[1][k] * v[1] + self.0[2][k] * v[2])
    }

    /// These axes, turned by `angle` about their own axis `axis`.
    fn rotated(&self, axis: usize, angle: f64) -> Axes {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let (sin, cos) = angle.sin_cos();
        let mut turned = *self;
        for k in 0..3 {
            turned.0[a][k] = cos * self.0[a][k] + sin * self.0[b][k];
            turned.0[b][k] = cos * self.0[b][k] - sin * self.0[a][k];
        }
        turned
    }
}
