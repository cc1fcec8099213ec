//! A motion as a walk in the world: one whole step of the real robot, sampled in time.
//!
//! Everything comes from `Cycle`, which the optimizer uses too. What is added here is where things are: the
//! second half of a mirrored gait, the footprints, and the real legs that a virtual leg stands for.

use crate::cycle::{Cycle, Sample, theta};
use crate::flow::Undefined;
use crate::instant::{Glance, Quantities};
use crate::passive::Passive;
use crate::swing::swings;
use piaffe_model::motion::{Criterion, Motion};
use piaffe_model::{Body, Description, Gait, Mode, Rotation, Then, Transition, other_leg};

/// A point or vector in world axes: forward, up, to the right.
pub type Point = [f64; 3];

/// One whole step: all phases, of a gait that mirrors itself twice.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    pub description: &'a Description,
    pub phases: Vec<Span>,
    /// In order of time. A phase's last moment and the next one's first are at the same time, before and
    /// after the transition.
    pub moments: Vec<Moment>,
    /// Forward travel in the whole step, m.
    pub travel: f64,
}

/// One phase of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// When it begins, s.
    pub start: f64,
    /// s.
    pub duration: f64,
    pub mode: Mode,
}

/// The robot at one time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// From the beginning of the step, s.
    pub time: f64,
    /// Which of the walk's phases.
    pub phase: usize,
    /// Time as a share of the phase.
    pub share: f64,
    pub mode: Mode,
    /// What ends its phase.
    pub transition: Transition,
    /// Platform's mass centre, its velocity and acceleration; m, m/s, m/s².
    pub platform: [Point; 3],
    /// Mass centre of the robot and its velocity; m, m/s. In flight a parabola.
    pub centre: [Point; 2],
    /// Coordinates q of the gait, with rates and accelerations; rad, rad/s, rad/s².
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Γ of every joint's motor of the virtual legs, springs and friction overcome, N·m.
    pub torque: Vec<f64>,
    /// Reaction on the virtual leg in support, N; in flight zero.
    pub force: Point,
    /// Feet of both virtual legs, m.
    pub feet: [Point; 2],
}

impl<'a> Walk<'a> {
    /// The walk at equally spaced times, both ends of each phase among them.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    ///
    /// # Panics
    /// If the motion has not the numbers that the gait needs; `verify` tells.
    pub fn even(gait: &'a dyn Gait, motion: &Motion, intervals: usize) -> Result<Walk<'a>, Undefined> {
        Walk::new(gait, motion, |_, _, _| Ok(even(intervals)))
    }

    /// The same, with the last moment before and the first after dry friction of a joint changes its sign: there its motor's torque jumps.
    ///
    /// # Errors, Panics
    /// As for [`Walk::even`].
    pub fn even_between_turns(gait: &'a dyn Gait, motion: &Motion, intervals: usize) -> Result<Walk<'a>, Undefined> {
        Walk::new(gait, motion, |cycle, phase, _| with_turns(cycle, phase, even(intervals)))
    }

    /// The walk at multiples of 1/`rate` (Hz), without the end, which is the beginning of the next step.
    ///
    /// # Errors, Panics
    /// As for [`Walk::even`].
    pub fn at_rate(gait: &'a dyn Gait, motion: &Motion, rate: f64) -> Result<Walk<'a>, Undefined> {
        Walk::new(gait, motion, |_, _, h| {
            let first = (h.start * rate).ceil() as u64;
            let shares = (first..).map(|k| (k as f64 / rate - h.start) / h.duration);
            Ok(shares.take_while(|s| *s < 1.0).collect())
        })
    }

    /// `shares` are those of a phase of the cycle at which moments are.
    fn new(
        gait: &'a dyn Gait,
        motion: &Motion,
        shares: impl Fn(&Cycle, usize, &Span) -> Result<Vec<f64>, Undefined>,
    ) -> Result<Walk<'a>, Undefined> {
        let d = gait.description();
        // Neither criterion nor speed has a part in where the robot is.
        let cycle = Cycle::resolving(gait, Criterion::Torque, 1.0, &theta(motion))?;
        let count = d.phases.len();
        let rounds = if d.then == Then::Mirrored { 2 } else { 1 };
        let passive = Passive::all(d);
        let (mut phases, mut moments) = (Vec::new(), Vec::new());
        // Where positions of a phase are from: the stance foot, or the ground below the mass centre at take-off.
        let (mut origin, mut start) = ([0.0; 3], 0.0);
        for phase in 0..rounds * count {
            let (k, role) = (phase % count, Role { gait, passive: &passive, mirrored: phase >= count });
            let mode = role.mode(d.phases[k].mode);
            let span = Span { start, duration: motion.phases[k].duration, mode };
            let ends = [0, cycle.last_node(k)].map(|node| cycle.sample(k, node));
            if phase == 0 {
                // The line of travel is midway between the footprints.
                origin[2] = -0.5 * role.feet(&ends[1], mode, [0.0; 3])[other_leg(mode.stance().unwrap_or_default())][2];
            }
            let mut glance = Glance::new(d, k);
            for share in shares(&cycle, k, &span)? {
                let [first, last] = ends.each_ref();
                let mut moment = match share {
                    s if s <= 0.0 => role.moment(first, mode, origin),
                    s if s >= 1.0 => role.moment(last, mode, origin),
                    s => {
                        cycle.glance(k, s, &mut glance)?;
                        role.moment(&Sample::of(&glance, s), mode, origin)
                    }
                };
                (moment.phase, moment.time) = (phase, span.start + share * span.duration);
                moment.transition = role.transition(d.transition(k));
                moments.push(moment);
            }
            // The foot lands on the ground: what is left of its height is rounding.
            let last = role.feet(&ends[1], mode, origin);
            origin = match role.transition(d.transition(k)) {
                Transition::Touchdown(leg) | Transition::Landing(leg) => [last[leg][0], 0.0, last[leg][2]],
                Transition::TakeOff(_) => {
                    let next = &cycle.sample((k + 1) % count, 0);
                    let (here, there) = (role.point(&ends[1].platform), role.point(&next.platform));
                    [origin[0] + here[0] - there[0], 0.0, origin[2]]
                }
            };
            start += span.duration;
            phases.push(span);
        }
        let travel = origin[0];
        Ok(Walk { description: d, phases, moments, travel })
    }

    /// Duration of the step, s.
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.duration).sum()
    }
}

/// Of a phase, both ends among them.
fn even(intervals: usize) -> Vec<f64> {
    (0..=intervals).map(|k| k as f64 / intervals as f64).collect()
}

/// These shares of a phase, and between two where dry friction changes its sign, the last share before that and the first after.
fn with_turns(cycle: &Cycle, phase: usize, shares: Vec<f64>) -> Result<Vec<f64>, Undefined> {
    let d = cycle.description();
    let rubbing: Vec<(usize, Passive)> =
        Passive::all(d).into_iter().enumerate().filter_map(|(joint, passive)| Some((joint, passive?))).collect();
    if rubbing.iter().all(|(_, passive)| passive.coulomb == 0.0) {
        return Ok(shares);
    }
    let mut glance = Glance::new(d, phase);
    let mut rates = |share: f64| {
        cycle.glance(phase, share, &mut glance)?;
        Ok::<Numbers, Undefined>(rubbing.iter().map(|(joint, _)| glance.state.qd[*joint]).collect())
    };
    let mut with = Vec::with_capacity(shares.len());
    let mut before: Option<(f64, Numbers)> = None;
    for share in shares {
        let now = rates(share)?;
        if let Some((from, before)) = &before {
            let first = with.len();
            for (k, (_, passive)) in rubbing.iter().enumerate() {
                let (old, new) = (passive.side(before[k]), passive.side(now[k]));
                if old != new {
                    let mut side = |share: f64| Ok(passive.side(rates(share)?[k]));
                    with.push(border(*from, share, |share| Ok(side(share)? == old))?[0]);
                    with.push(border(*from, share, |share| Ok(side(share)? != new))?[1]);
                }
            }
            with[first..].sort_by(f64::total_cmp);
        }
        with.push(share);
        before = Some((share, now));
    }
    with.dedup();
    Ok(with)
}

/// The neighbours between which `holds` ends, which it does at `low` and not at `high`.
fn border(
    mut low: f64,
    mut high: f64,
    mut holds: impl FnMut(f64) -> Result<bool, Undefined>,
) -> Result<[f64; 2], Undefined> {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Ok([low, high]);
        } else if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Of a moment, on the way to it.
type Numbers = smallvec::SmallVec<[f64; 16]>;

/// How a phase of the gait is performed: as it is, or by the other legs.
struct Role<'a> {
    gait: &'a dyn Gait,
    /// Of each joint.
    passive: &'a [Option<Passive>],
    mirrored: bool,
}

impl Role<'_> {
    fn mode(&self, mode: Mode) -> Mode {
        if self.mirrored { mode.exchanged() } else { mode }
    }

    fn leg(&self, leg: usize) -> usize {
        if self.mirrored { other_leg(leg) } else { leg }
    }

    fn transition(&self, transition: Transition) -> Transition {
        match transition {
            Transition::Touchdown(lands) => Transition::Touchdown(self.leg(lands)),
            Transition::Landing(lands) => Transition::Landing(self.leg(lands)),
            Transition::TakeOff(leaves) => Transition::TakeOff(self.leg(leaves)),
        }
    }

    /// A vector of the gait's positions in world axes.
    fn point(&self, p: &[f64]) -> Point {
        let z = p.get(2).copied().unwrap_or(0.0);
        [p[0], p[1], if self.mirrored { -z } else { z }]
    }

    /// Feet of both legs; one that stands is at the origin of the phase's positions.
    fn feet(&self, sample: &Sample, mode: Mode, origin: Point) -> [Point; 2] {
        let mut feet = [origin; 2];
        let components = self.gait.description().positions();
        // In the order of the legs as the phase calls them.
        for (leg, foot) in self.mode(mode).swinging().zip(sample.feet.chunks(components)) {
            feet[self.leg(leg)] = add(origin, self.point(foot));
        }
        feet
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

    fn moment(&self, sample: &Sample, mode: Mode, origin: Point) -> Moment {
        let d = self.gait.description();
        let (y, shape) = (Quantities::new(d, mode), &d.shape(mode).inverse);
        let (nc, nj) = (d.positions(), d.joints());
        let [q, qd, qdd] = sample.state.map(|v| self.renamed(v));
        let prescribed: Numbers = (0..d.prescribed()).map(|k| qdd[d.prescribed_index(k)]).collect();
        let mut velocity = [0.0; 3];
        let velocity = &mut velocity[..nc];
        self.gait.platform_velocity(mode, &q, &qd, velocity);
        velocity.iter_mut().zip(sample.centre_velocity).for_each(|(v, centre)| *v += centre);
        let mut inverse = shape.zeros();
        self.gait.inverse(mode, &q, &qd, &prescribed, &mut inverse);
        let plain = Role { mirrored: false, ..*self };
        let platform = add(origin, self.point(&sample.platform));
        let centre_shape = &d.shapes.centre_of_mass;
        let mut centre = centre_shape.zeros();
        let together = |a: &[f64], b: &[f64]| a.iter().chain(b).copied().collect::<Numbers>();
        let (x, xd) = (together(&platform[..nc], &q), together(velocity, &qd));
        self.gait.centre_of_mass(&x, &xd, &mut centre);
        let mut motors = Numbers::from_slice(&sample.quantities[y.torque(0)..][..nj]);
        let moves = sample.state[0].iter().zip(sample.state[1]);
        for ((motor, passive), (angle, rate)) in motors.iter_mut().zip(self.passive).zip(moves) {
            passive.iter().for_each(|passive| *motor += passive.torque(*angle, *rate));
        }
        let force = match y.components() {
            0 => [0.0; 3],
            components => self.point(&sample.quantities[y.force(0)..][..components]),
        };
        Moment {
            time: 0.0,
            phase: 0,
            share: sample.share,
            mode,
            transition: Transition::Touchdown(0),
            platform: [platform, plain.point(velocity), plain.point(&shape.xdd.of(&inverse)[..nc])],
            centre: [centre_shape.position, centre_shape.velocity].map(|block| plain.point(block.of(&centre))),
            torque: self.renamed(&motors),
            force,
            feet: self.feet(sample, mode, origin),
            q,
            qd,
            qdd,
        }
    }
}

impl Walk<'_> {
    /// The curve above which the foot of a leg stays, at a moment, per height of it; zero on the ground.
    pub fn clearance_curve(&self, leg: usize, m: &Moment) -> f64 {
        let (d, count) = (self.description, self.description.phases.len());
        let durations: Vec<f64> = self.phases[..count].iter().map(|phase| phase.duration).collect();
        let leg = if m.phase >= count { other_leg(leg) } else { leg };
        let swings = swings(d, m.phase % count);
        swings.iter().find(|swing| swing.leg == leg).map_or(0.0, |swing| swing.height(&durations, m.share))
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
        let (sin, cos) = libm::sincos(angle);
        let mut turned = *self;
        for k in 0..3 {
            turned.0[a][k] = cos * self.0[a][k] + sin * self.0[b][k];
            turned.0[b][k] = cos * self.0[b][k] - sin * self.0[a][k];
        }
        turned
    }
}
