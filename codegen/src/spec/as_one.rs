//! Whether legs can move as one, or take each other's part: read off the expressions of their motion.
//!
//! Joint by joint such legs follow the same coordinates. So the difference of their feet is a sum of what the platform and each
//! link carry of it, and the feet move as one if its velocity vanishes identically; legs weigh alike if the difference of
//! their kinetic energies does. What is left of a difference tells which link it comes from.

use super::rigid::Rigid;
use super::types::{Actuator, Axis, Inertia, Joint, Leg, Link, Robot, Rotation};
use crate::expr::{Frame, Poly, Ring, Var, Vec3, add, cross, dot, rotate, zero};

/// Angles (rad) this close are equal, and lengths and masses to this share of the leg's.
const SAME: f64 = 1e-9;

/// The motion of two legs that follow the same coordinates.
pub(super) struct Motion {
    ring: Ring,
    /// Axes of the platform and of each link.
    frames: Vec<Frame>,
    /// Components of places and velocities that show: all, or those in the sagittal plane.
    seen: usize,
    /// The leg's, m.
    length: f64,
}

/// Where the links of a leg begin and where its foot is: its mount, then the ends of its links, each in the axes of what carries it.
type Places = Vec<[f64; 3]>;

/// The feet of two legs, apart by what the platform carries and what each link carries.
pub(super) struct Feet<'m> {
    motion: &'m mut Motion,
    apart: Places,
}

/// Why one leg is not to the gait what the other is.
pub(super) enum Unlike {
    /// In words.
    Link(String),
    /// This component of their mounts.
    Mount(usize),
}

impl Motion {
    /// Of legs built like `leg`, on a platform that rotates so.
    pub fn new(leg: &Leg, rotation: Rotation) -> Motion {
        let mut ring = Ring::new();
        let mut frames = vec![Frame::base(zero())];
        let own = match rotation {
            Rotation::None => None,
            Rotation::Pitch => Some(Axis::Pitch),
            Rotation::Roll => Some(Axis::Roll),
        };
        let turns = own.into_iter().chain(leg.chain.iter().map(|segment| segment.joint.axis));
        for (k, axis) in turns.enumerate() {
            let [coordinate, ..] = ring.coordinate(&format!("q{k}"));
            let frame = frames[frames.len() - 1].turned(&mut ring, axis.index(), coordinate);
            frames.push(frame);
        }
        frames.drain(..usize::from(own.is_some()));
        Motion { ring, frames, seen: if rotation == Rotation::Roll { 3 } else { 2 }, length: leg.length() }
    }

    /// The feet of two legs with these places.
    pub fn feet(&mut self, a: &Places, b: &Places) -> Feet<'_> {
        let same = SAME * self.length;
        let clear = |(a, b): (&f64, &f64)| if (a - b).abs() > same { a - b } else { 0.0 };
        let one = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|k| clear((&a[k], &b[k])));
        let apart = a.iter().zip(b).map(one).collect();
        Feet { motion: self, apart }
    }

    /// What remains of the difference of the kinetic energies of two bodies on link `k`, when its joint moves anyhow.
    fn energies_apart(&mut self, k: usize, a: &[Rigid], b: &[Rigid]) -> Weight {
        let names = &["x", "y", "z"][..self.seen];
        let joint: Vec<Var> = names.iter().map(|name| self.ring.symbol(*name)).collect();
        let mut moving = zero();
        moving.iter_mut().zip(&joint).for_each(|(slot, v)| *slot = (*v).into());
        let spin = self.frames[k + 1].spin(&mut self.ring);
        let energy = |body: &Rigid| {
            let velocity = add(&moving, &cross(&spin, &body.com.map(Poly::constant)));
            let angular = body.inertia.map(|row| dot(&spin, &row.map(Poly::constant)));
            let seen: Poly = velocity[..self.seen].iter().fold(Poly::zero(), |sum, v| &sum + &(v * v));
            &seen.scaled(0.5 * body.mass) + &dot(&spin, &angular).scaled(0.5)
        };
        let sum = |bodies: &[Rigid]| bodies.iter().fold(Poly::zero(), |sum, body| &sum + &energy(body));
        let difference = &sum(a) - &sum(b);
        let mass: f64 = a.iter().map(|body| body.mass).sum();
        let left = |degree: i32| {
            let negligible = SAME * mass * self.length.powi(2 - degree);
            difference.terms().any(|(monomial, c)| {
                let of_joint = monomial.iter().filter(|v| joint.contains(v)).count();
                of_joint == degree as usize && c.abs() > negligible
            })
        };
        Weight { mass: left(2), centre: left(1), inertia: left(0) }
    }
}

/// In what two bodies differ, as far as that matters for their energy.
struct Weight {
    mass: bool,
    centre: bool,
    inertia: bool,
}

impl Feet<'_> {
    /// The part of the difference that the platform (0) or a link carries.
    fn part(&mut self, k: usize, apart: [f64; 3]) -> Vec3 {
        let axes = self.motion.frames[k].rotation(&mut self.motion.ring);
        rotate(&axes, &apart.map(Poly::constant))
    }

    /// Whether a difference stays what it is and on the level: then feet touch the ground together and move as one.
    fn is_still(&mut self, difference: &Vec3) -> bool {
        let moves = |x: &Poly| !self.motion.ring.time_derivative(x).is_zero();
        difference[1].is_zero() && !difference[..self.motion.seen].iter().any(moves)
    }

    /// Why the feet do not move as one, if they do not.
    pub fn move_apart(mut self, a: &Leg, b: &Leg) -> Option<Unlike> {
        self.unlike(a, b, Feet::is_still)
    }

    /// Why the feet are not at one place, if they are not.
    pub fn are_apart(mut self, a: &Leg, b: &Leg) -> Option<Unlike> {
        self.unlike(a, b, |feet, difference| difference[..feet.motion.seen].iter().all(Poly::is_zero))
    }

    fn unlike(&mut self, a: &Leg, b: &Leg, alike: impl Fn(&mut Self, &Vec3) -> bool) -> Option<Unlike> {
        let parts: Vec<Vec3> = self.apart.clone().into_iter().enumerate().map(|(k, d)| self.part(k, d)).collect();
        if alike(self, &parts.iter().fold(zero(), |sum, part| add(&sum, part))) {
            return None;
        }
        let link = (1..parts.len()).find(|k| !alike(self, &parts[*k]));
        Some(match link {
            Some(k) => {
                let [s, t] = [a, b].map(|leg| &leg.chain[k - 1].link);
                Unlike::Link(format!("`{}` ends at {:?}, `{}` at {:?}", s.name, s.end, t.name, t.end))
            }
            None => {
                let mut along = |k: &usize| {
                    let part = self.part(0, [0, 1, 2].map(|i| if i == *k { self.apart[0][i] } else { 0.0 }));
                    !alike(self, &part)
                };
                Unlike::Mount((0..3).find(|k| along(k)).unwrap_or_default())
            }
        })
    }
}

impl Leg {
    /// How far its links reach, end to end, m.
    fn length(&self) -> f64 {
        let norm = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.chain.iter().map(|segment| norm(&segment.link.end)).sum()
    }

    /// With the mount at `mount`.
    pub(super) fn places(&self, mount: [f64; 3]) -> Places {
        std::iter::once(mount).chain(self.chain.iter().map(|segment| segment.link.end)).collect()
    }

    /// Its mirror image across the sagittal plane.
    pub(super) fn mirrored(&self) -> Leg {
        let mut image = self.clone();
        for segment in &mut image.chain {
            let Joint { axis, range: [low, high], .. } = segment.joint;
            if axis != Axis::Pitch {
                segment.joint.range = [-high, -low];
                segment.joint.spring.rest = 0.0 - segment.joint.spring.rest;
            }
            segment.link = segment.link.mirrored();
        }
        image
    }
}

impl Link {
    fn mirrored(&self) -> Link {
        let turned = |inertia: &Inertia| {
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| if (i == 2) == (j == 2) { inertia[i][j] } else { -inertia[i][j] }))
        };
        let inertia = turned(&self.inertia);
        Link { end: across(self.end), com: across(self.com), inertia, ..self.clone() }
    }
}

fn across([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, y, -z]
}

/// Why the joints of two legs cannot follow the same coordinates, if they cannot.
pub(super) fn driven_unlike(a: &Leg, b: &Leg, mirrored: bool) -> Option<String> {
    if a.chain.len() != b.chain.len() || a.chain.iter().zip(&b.chain).any(|(s, t)| s.joint.axis != t.joint.axis) {
        return Some("the legs have different joints".into());
    }
    a.chain.iter().zip(&b.chain).map(|(s, t)| (&s.joint, &t.joint)).find_map(|(s, t)| {
        let mirrored = if mirrored && t.axis != Axis::Pitch { "mirrored " } else { "" };
        if (0..2).any(|k| (s.range[k] - t.range[k]).abs() > SAME) {
            let (a, b) = (s.range, t.range);
            return Some(format!("the {mirrored}ranges of `{}` and `{}` differ: {a:?} and {b:?}", s.name, t.name));
        }
        if s.spring.stiffness != t.spring.stiffness || (s.spring.rest - t.spring.rest).abs() > SAME {
            let [a, b] =
                [s, t].map(|joint| format!("{} N·m/rad about {} rad", joint.spring.stiffness, joint.spring.rest));
            return Some(format!("the {mirrored}springs of `{}` and `{}` differ: {a} and {b}", s.name, t.name));
        }
        let same_motors = same_motor(&s.actuator, &t.actuator);
        let unlike = [(same_motors, "motors"), (s.friction == t.friction, "friction")];
        let (_, what) = unlike.into_iter().find(|(same, _)| !same)?;
        Some(format!("`{}` and `{}` have different {what}", s.name, t.name))
    })
}

/// Whether two motors are equal but for their names.
fn same_motor(a: &Actuator, b: &Actuator) -> bool {
    Actuator { name: String::new(), ..a.clone() } == Actuator { name: String::new(), ..b.clone() }
}

impl Robot {
    /// Where legs that move as one hang in the gait's model, from the platform's mass centre: at the mean of their mounts, m.
    pub(crate) fn hip(&self, legs: &[usize]) -> [f64; 3] {
        let share = 1.0 / legs.len() as f64;
        [0, 1, 2].map(|k| legs.iter().map(|leg| self.legs[*leg].mount[k]).sum::<f64>() * share - self.platform.com[k])
    }

    /// Why virtual leg 2 cannot take the part of virtual leg 1, if it cannot: where the platform rolls as its mirror
    /// image, else as it is.
    pub(super) fn exchange(&self, legs: &[Vec<usize>; 2], rotation: Rotation) -> Option<Unlike> {
        let mirrored = rotation == Rotation::Roll;
        let own = legs[0].iter().map(|leg| self.legs[*leg].clone()).collect::<Vec<_>>();
        let seen = |leg: &usize| if mirrored { self.legs[*leg].mirrored() } else { self.legs[*leg].clone() };
        let other: Vec<Leg> = legs[1].iter().map(seen).collect();
        let ([a, ..], [b, ..], Some(second)) = (&own[..], &other[..], legs[1].first()) else { return None };
        if let Some(why) = driven_unlike(a, b, mirrored) {
            return Some(Unlike::Link(why));
        }
        let mut motion = Motion::new(a, rotation);
        let [hip, other_hip] = [0, 1].map(|leg| self.hip(&legs[leg]));
        let other_hip = if mirrored { across(other_hip) } else { other_hip };
        let feet = motion.feet(&a.places(hip), &b.places(other_hip));
        let apart = feet.are_apart(a, &self.legs[*second]);
        if let Some(Unlike::Link(_)) = apart {
            return apart;
        }
        for (k, segment) in a.chain.iter().enumerate() {
            let rigid = |leg: &Leg| leg.chain[k].link.rigid();
            let [these, those] = [&own, &other].map(|legs| legs.iter().map(rigid).collect::<Vec<_>>());
            let apart = motion.energies_apart(k, &these, &those);
            let one = |bodies: Vec<Rigid>| bodies.into_iter().reduce(|sum, body| sum.with(&body));
            let as_given = legs[1].iter().map(|leg| rigid(&self.legs[*leg])).collect();
            let (Some(s), Some(t)) = (one(these), one(as_given)) else { return None };
            let name = &segment.link.name;
            let why = match apart {
                Weight { mass: true, .. } => format!("`{name}` weighs {} kg, its counterpart {} kg", s.mass, t.mass),
                Weight { centre: true, .. } => {
                    format!("the mass centre of `{name}` is at {:?}, that of its counterpart at {:?}", s.com, t.com)
                }
                Weight { inertia: true, .. } => format!("the inertia of `{name}` is not that of its counterpart"),
                _ => continue,
            };
            return Some(Unlike::Link(why));
        }
        apart
    }
}

#[cfg(test)]
mod tests {
    use super::super::rigid::{IDENTITY, apply, times, turn};
    use super::super::types::{Friction, Segment, Spring};
    use super::*;

    fn leg(axes: &[Axis], mount: [f64; 3], ends: &[[f64; 3]]) -> Leg {
        let segment = |(axis, end): (&Axis, &[f64; 3])| {
            let name = String::from("motor");
            let actuator = Actuator {
                name,
                gear: 1.0,
                max_torque: 1.0,
                unloaded_speed: 1.0,
                loaded_speed: 1.0,
                rotor_inertia: 0.0,
            };
            let joint = Joint {
                name: "joint".into(),
                axis: *axis,
                range: [-1.0, 1.0],
                spring: Spring::default(),
                friction: Friction::default(),
                actuator,
            };
            let (name, inertia) = ("link".into(), [[0.0; 3]; 3]);
            let link = Link { name, mass: 1.0, end: *end, com: [0.0; 3], inertia, foot_mass: 0.0, locked: Vec::new() };
            Segment { joint, link }
        };
        let chain = axes.iter().zip(ends).map(segment).collect();
        Leg { name: "leg".into(), mount, chain, locked: Vec::new() }
    }

    /// The foot from the platform's origin, in numbers.
    fn foot(leg: &Leg, rotation: Rotation, q: &[f64]) -> [f64; 3] {
        let mut axes = match rotation {
            Rotation::None => IDENTITY,
            Rotation::Pitch => turn(Axis::Pitch, q[0]),
            Rotation::Roll => turn(Axis::Roll, q[0]),
        };
        let mut at = apply(&axes, &leg.mount);
        for (segment, angle) in leg.chain.iter().zip(&q[1..]) {
            axes = times(&axes, &turn(segment.joint.axis, *angle));
            let arm = apply(&axes, &segment.link.end);
            at = [0, 1, 2].map(|k| at[k] + arm[k]);
        }
        at
    }

    /// Whether two feet keep their distance in what shows, on the level, from one posture to another.
    fn keep_apart(a: &Leg, b: &Leg, rotation: Rotation) -> bool {
        let seen = if rotation == Rotation::Roll { 3 } else { 2 };
        let apart = |q: &[f64]| {
            let (a, b) = (foot(a, rotation, q), foot(b, rotation, q));
            [0, 1, 2].map(|k| if k < seen { a[k] - b[k] } else { 0.0 })
        };
        let postures = [[0.3, -0.7, 1.1, 0.4], [-0.5, 0.2, 0.9, -1.3], [0.8, 0.6, -0.4, 0.7]];
        let first = apart(&postures[0]);
        let same = |other: [f64; 3]| first.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-12);
        first[1].abs() < 1e-12 && postures.iter().all(|q| same(apart(q)))
    }

    #[test]
    fn what_the_expressions_say_of_two_feet_is_what_their_places_do() {
        use Axis::{Pitch, Roll, Yaw};
        let ends = [[0.0, -0.1, 0.05], [0.02, -0.3, 0.0], [0.0, -0.25, 0.01]];
        let mut verdicts = Vec::new();
        for rotation in [Rotation::None, Rotation::Pitch, Rotation::Roll] {
            for axes in [[Pitch, Pitch, Pitch], [Roll, Pitch, Pitch], [Yaw, Roll, Pitch]] {
                if rotation != Rotation::Roll && axes[0] != Pitch {
                    continue;
                }
                let a = leg(&axes, [0.2, 0.0, 0.1], &ends);
                for place in 0..4 {
                    for k in 0..3 {
                        let mut b = a.clone();
                        match place {
                            0 => b.mount[k] += 0.03,
                            link => b.chain[link - 1].link.end[k] += 0.03,
                        }
                        let mut motion = Motion::new(&a, rotation);
                        let feet = motion.feet(&a.places(a.mount), &b.places(b.mount));
                        let found = feet.move_apart(&a, &b);
                        let as_one = keep_apart(&a, &b, rotation);
                        let right = match &found {
                            None => as_one,
                            Some(Unlike::Mount(along)) => !as_one && (0, k) == (place, *along),
                            Some(Unlike::Link(why)) => {
                                !as_one && place > 0 && why.contains(&format!("{:?}", b.chain[place - 1].link.end))
                            }
                        };
                        assert!(right, "{rotation:?} {axes:?}: part {place} along {k}");
                        verdicts.push(as_one);
                    }
                }
            }
        }
        // Along x what hangs on nothing but rolls is free; so is what is beside the plane.
        assert!(verdicts.iter().any(|as_one| *as_one) && verdicts.iter().any(|as_one| !as_one));
    }

    /// Legs that are made of other bodies, but move and weigh like each other's mirror images, can exchange their parts.
    #[test]
    fn legs_exchange_their_parts_if_their_energies_are_equal() {
        let (a, mut b) = (leg(&[Axis::Pitch], [0.0, 0.0, -0.1], &[[0.0, -0.3, 0.0]]), Vec::new());
        for z in [0.02, -0.02] {
            let mut half = leg(&[Axis::Pitch], [0.0, 0.0, 0.1], &[[0.0, -0.3, 0.0]]);
            let link = &mut half.chain[0].link;
            (link.mass, link.com[2]) = (0.5, z);
            b.push(half);
        }
        let platform = super::super::types::Platform {
            name: "platform".into(),
            mass: 1.0,
            com: [0.0; 3],
            inertia: [[0.0; 3]; 3],
            extent: None,
        };
        let mut legs = vec![a];
        legs.extend(b);
        let mut robot = Robot { name: "robot".into(), gravity: 9.81, platform, legs, written: Default::default() };
        let virtual_legs = [vec![0], vec![1, 2]];
        assert!(robot.exchange(&virtual_legs, Rotation::None).is_none());
        // Where the platform rolls, the halves resist more than what is in one place.
        let why = robot.exchange(&virtual_legs, Rotation::Roll);
        assert!(matches!(why, Some(Unlike::Link(why)) if why.contains("the inertia of `link`")));
        let of_halves = 2.0 * 0.5 * 0.02 * 0.02;
        let inertia = &mut robot.legs[0].chain[0].link.inertia;
        (inertia[0][0], inertia[1][1]) = (of_halves, of_halves);
        assert!(robot.exchange(&virtual_legs, Rotation::Roll).is_none());
        robot.legs[2].chain[0].link.mass = 0.6;
        let why = robot.exchange(&virtual_legs, Rotation::Roll);
        assert!(matches!(why, Some(Unlike::Link(why)) if why.contains("weighs")));
    }
}
