//! Legs on a platform as the specification has them, with all that its text needs, or what is missing for that.

use super::fault::{Faults, Kind, Place};
use super::inertia;
use super::limbs::{Limb, Limbs};
use super::model::{EARTH, Format, Friction, Kind as JointKind, Model, Rotor, Spring};
use super::options::{chosen, chosen_stops};
use super::words::{Identifiers, identifier, short_list};
use super::{Options, ROUNDED, Rigid, Setting, nearest_axis};
use nalgebra::{Matrix3, Vector3};
use piaffe_model::digits::digits;
use std::f64::consts::TAU;

/// A robot in the specification's axes.
#[derive(Clone, Debug)]
pub struct Robot {
    pub name: String,
    pub platform_name: String,
    pub platform_place: Place,
    /// From the root's origin.
    pub platform: Rigid,
    pub legs: Vec<Leg>,
    /// m/s²; `None` where it is to be assumed.
    pub gravity: Option<f64>,
}

#[derive(Clone, Debug)]
pub struct Leg {
    pub name: String,
    pub mount: Vector3<f64>,
    pub segments: Vec<Segment>,
    /// What its foot is.
    pub foot: String,
}

/// A joint with the link that it carries.
#[derive(Clone, Debug)]
pub struct Segment {
    pub joint: Joint,
    pub link: Link,
}

#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub source: Source,
    /// 0, 1, 2: roll, yaw, pitch.
    pub axis: usize,
    /// −1 where the specification's angle is the negative of the file's.
    pub sign: f64,
    pub range: [f64; 2],
    pub spring: Spring,
    pub friction: Friction,
    pub motor: Motor,
}

/// What the file calls something, and where it stands.
#[derive(Clone, Debug)]
pub struct Source {
    pub name: String,
    pub place: Place,
}

/// What drives a joint: at the joint, N·m and rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    pub effort: f64,
    pub velocity: f64,
    pub gear: Option<f64>,
    pub rotor: Option<Rotor>,
}

#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    pub source: Source,
    /// From its joint.
    pub rigid: Rigid,
    /// The next joint or the foot, from its joint, m.
    pub end: Vector3<f64>,
}

pub const PITCH: usize = 2;

impl Leg {
    /// Length of the stretched leg, m.
    pub fn reach(&self) -> f64 {
        self.segments.iter().map(|s| s.link.end.norm()).sum()
    }

    /// Joints that a gait in the plane moves: the first two that swing the leg.
    pub fn swings(&self) -> impl Iterator<Item = &Joint> {
        self.segments.iter().map(|s| &s.joint).filter(|j| j.axis == PITCH).take(2)
    }
}

impl Robot {
    /// m/s².
    pub fn fall(&self) -> f64 {
        self.gravity.unwrap_or(EARTH)
    }

    pub fn weight(&self) -> f64 {
        let legs: f64 = self.legs.iter().flat_map(|l| &l.segments).map(|s| s.link.rigid.mass).sum();
        self.fall() * (self.platform.mass + legs)
    }

    pub fn reach(&self) -> f64 {
        self.legs.iter().map(Leg::reach).fold(0.0, f64::max)
    }
}

/// Puts the legs together; what is missing goes to `faults`.
pub fn assemble(
    model: &Model,
    limbs: &Limbs,
    options: &Options,
    faults: &mut Faults,
    notes: &mut Vec<String>,
) -> Robot {
    let mut making = Making {
        model,
        limbs,
        options,
        faults,
        notes,
        links: Identifiers::among(model.links.iter().map(|link| link.name.as_str())),
        joints: Identifiers::among(model.joints.iter().map(|joint| joint.name.as_str())),
        legs: Identifiers::default(),
        tilt: 0.0,
        turning: Vec::new(),
        cut: Vec::new(),
        size: limbs.tree.bodies.iter().map(|b| b.origin.norm()).fold(0.0, f64::max),
    };
    let root = &limbs.tree.bodies[0];
    let place = &model.links[root.link].place;
    if root.rigid.mass <= 0.0 {
        let remedy = "give it an <inertial>, or put its mass on a link that is fixed to it";
        making.faults.add(Kind::Inertia, Some(place), "the trunk has no mass", remedy);
    }
    let platform_name = making.links.distinct(&model.links[root.link].name);
    let platform = Rigid { inertia: making.possible(&root.rigid, root.link), ..root.rigid };
    let legs = limbs.legs.iter().map(|limb| making.leg(limb)).collect();
    making.say();
    let name = if model.name.is_empty() { "robot".to_string() } else { model.name.clone() };
    let platform_place = place.clone();
    let mut robot = Robot { name, platform_name, platform_place, platform, legs, gravity: model.gravity };
    apart(&mut robot, notes);
    robot
}

struct Making<'m> {
    model: &'m Model,
    limbs: &'m Limbs,
    options: &'m Options,
    faults: &'m mut Faults,
    notes: &'m mut Vec<String>,
    links: Identifiers,
    joints: Identifiers,
    legs: Identifiers,
    /// The greatest tilt of an axis that was straightened, rad.
    tilt: f64,
    /// Joints without stops, and those whose stops were cut to one turn.
    turning: Vec<String>,
    cut: Vec<String>,
    /// From the root to the farthest joint, m.
    size: f64,
}

impl Making<'_> {
    fn leg(&mut self, limb: &Limb) -> Leg {
        let bodies = &self.limbs.tree.bodies;
        let mut segments = Vec::new();
        for (depth, b) in limb.chain.iter().enumerate() {
            let body = &bodies[*b];
            let next = limb.chain.get(depth + 1).map_or(limb.foot.point, |next| bodies[*next].origin);
            let source = &self.model.links[body.link];
            if body.rigid.mass <= 0.0 {
                let above = body.joint.as_ref().map_or("JOINT", |j| &self.model.joints[j.joint].name);
                let remedy = format!("give it an <inertial>, or hold the joint that carries it: --lock {above}");
                self.faults.add(Kind::Inertia, Some(&source.place), "it moves but has no mass", remedy);
            }
            let inertia = self.possible(&body.rigid, body.link);
            let rigid = Rigid { com: body.rigid.com - body.origin, inertia, ..body.rigid };
            let link = Link {
                name: self.links.distinct(&source.name),
                source: Source { name: source.name.clone(), place: source.place.clone() },
                rigid,
                end: next - body.origin,
            };
            if let Some(joint) = body.joint.as_ref().and_then(|moving| self.joint(moving.joint, &moving.axis)) {
                segments.push(Segment { joint, link });
            }
        }
        let name = self.leg_name(limb);
        let foot = format!("{} link `{}`", limb.foot.how.words(), self.model.links[limb.foot.link].name);
        Leg { name: self.legs.distinct(&name), mount: bodies[limb.chain[0]].origin, segments, foot }
    }

    /// What the joints' names of the chain begin with, or else the foot's name.
    fn leg_name(&self, limb: &Limb) -> String {
        let joints = limb.chain.iter().filter_map(|b| self.limbs.tree.bodies[*b].joint.as_ref());
        let names: Vec<&str> = joints.map(|j| self.model.joints[j.joint].name.as_str()).collect();
        let common = names.iter().skip(1).fold(names.first().copied().unwrap_or_default(), |common, name| {
            let equal = common.chars().zip(name.chars()).take_while(|(a, b)| a == b);
            &common[..equal.map(|(a, _)| a.len_utf8()).sum()]
        });
        let common = if names.len() > 1 { common.trim_end_matches(['_', '-', '.']) } else { "" };
        let known = self.limbs.legs.iter().filter(|other| {
            let first = other.chain.first().and_then(|b| self.limbs.tree.bodies[*b].joint.as_ref());
            first.is_some_and(|j| self.model.joints[j.joint].name.starts_with(common))
        });
        // What all legs begin with tells none of them from the others.
        let common = if known.count() > 1 { "" } else { common };
        identifier(if common.is_empty() { &self.model.links[limb.foot.link].name } else { common })
    }

    fn joint(&mut self, index: usize, axis: &Vector3<f64>) -> Option<Joint> {
        let joint = &self.model.joints[index];
        let (axis, sign, tilt) = nearest_axis(axis);
        if tilt > ROUNDED {
            let what = format!("its axis is {:.1}° off the trunk's, all joints at zero", tilt.to_degrees());
            let remedy = "hold it still: --lock JOINT; or align the root link with the axes of its legs";
            self.faults.add(Kind::ObliqueAxis, Some(&joint.place), what, remedy);
        }
        self.tilt = self.tilt.max(tilt);
        let motor = self.motor(index);
        let range = self.range(index);
        let (motor, [low, high]) = (motor?, range?);
        let range = if sign < 0.0 { [0.0 - high, 0.0 - low] } else { [low, high] };
        let (name, friction) = (self.joints.distinct(&joint.name), joint.friction);
        let source = Source { name: joint.name.clone(), place: joint.place.clone() };
        if joint.spring_is_derived {
            let what = "its spring and damping follow from the inertia of the whole robot (springdamper)";
            let remedy = format!("write its stiffness and damping instead; or {}", super::mjcf::SAVE);
            self.faults.add(Kind::Joint, Some(&joint.place), what, remedy);
        }
        let spring = if sign < 0.0 { joint.spring.turned() } else { joint.spring };
        if spring.stiffness < 0.0 {
            let what = "the stiffness of its spring is less than none";
            self.faults.add(Kind::Number, Some(&joint.place), what, "remove the sign of its stiffness");
        }
        if !spring.is_none() && spring.rest.abs() > TAU {
            let what = format!("its spring rests at {:.3} rad, more than a turn away", spring.rest);
            self.faults.add(
                Kind::Number,
                Some(&joint.place),
                what,
                "give a springref within a turn, in the file's unit of angles",
            );
        }
        if friction.damping < 0.0 || friction.coulomb < 0.0 {
            let what = "its friction is less than none: it would drive the joint";
            self.faults.add(Kind::Number, Some(&joint.place), what, "remove the sign of its damping or its friction");
        }
        Some(Joint { name, source, axis, sign, range, spring, friction, motor })
    }

    fn motor(&mut self, index: usize) -> Option<Motor> {
        let joint = &self.model.joints[index];
        let effort = setting(&self.options.efforts, &joint.name, joint.effort);
        let velocity = setting(&self.options.velocities, &joint.name, joint.velocity);
        let mut positive = |value: Option<f64>, what: &str, option: &str, unit: &str| {
            let value = value.filter(|v| *v > 0.0 && v.is_finite());
            if value.is_none() {
                let remedy = format!("give it in {unit}: --{option} JOINT=…, or --{option} … for all that have none");
                self.faults.add(Kind::Limit, Some(&joint.place), format!("it has no {what}"), remedy);
            }
            value
        };
        let effort = positive(effort, "greatest torque (effort)", "effort", "N·m");
        let velocity = positive(velocity, "greatest speed (velocity)", "velocity", "rad/s");
        let gear = setting(&self.options.gears, &joint.name, joint.gear);
        let rotor = match chosen(&self.options.rotors, &joint.name, joint.rotor.is_some()) {
            Some(given) => Some(Rotor::AtMotor(self.options.rotors[given].value)),
            None => joint.rotor,
        };
        Some(Motor { effort: effort?, velocity: velocity?, gear, rotor })
    }

    /// Stops in the file's sense of rotation, within one turn to either side.
    fn range(&mut self, index: usize) -> Option<[f64; 2]> {
        let joint = &self.model.joints[index];
        let given = chosen_stops(self.options, &joint.name).map(|k| self.options.ranges[k].range);
        let range = match joint.kind {
            JointKind::Continuous => given,
            _ => given.or(joint.range),
        };
        let Some([low, high]) = range else {
            if joint.kind == JointKind::Continuous {
                self.turning.push(format!("`{}`", joint.name));
                return Some([-WHOLE_TURN, WHOLE_TURN]);
            }
            let remedy = "give them in rad: --range JOINT=LOW,HIGH; or make it continuous";
            self.faults.add(Kind::Limit, Some(&joint.place), "it has no stops (lower, upper)", remedy);
            return None;
        };
        if low >= high {
            let remedy = format!("write the lower one first, in rad, or give them: --range {}=LOW,HIGH", joint.name);
            let what = format!("its stops are at {} and {} rad", digits(low), digits(high));
            self.faults.add(Kind::Limit, Some(&joint.place), what, remedy);
            return None;
        }
        let degrees = low.abs().max(high.abs()) <= 360.0;
        if low <= -2.0 * TAU && high >= 2.0 * TAU && !degrees {
            self.turning.push(format!("`{}`", joint.name));
            return Some([-WHOLE_TURN, WHOLE_TURN]);
        }
        if low < -2.0 * TAU || high > 2.0 * TAU {
            let [a, b] = [low, high].map(f64::to_radians);
            let are = if degrees { ": these are degrees" } else { "" };
            let what = format!("its stops are at {} and {} rad, several turns away{are}", digits(low), digits(high));
            let written = match self.model.format {
                Format::Urdf => format!("lower=\"{a:.4}\" upper=\"{b:.4}\""),
                Format::Mjcf => format!("range=\"{a:.4} {b:.4}\""),
            };
            let name = &joint.name;
            let remedy = match degrees {
                true => format!(
                    "write {written}, or give them: --range {name}={a:.4},{b:.4}; if it has none: --range {name}=-6.28,6.28"
                ),
                false => format!("count from another zero, or give them: --range {name}=LOW,HIGH"),
            };
            self.faults.add(Kind::Limit, Some(&joint.place), what, remedy);
            return None;
        }
        if low < -WHOLE_TURN || high > WHOLE_TURN {
            self.cut.push(format!("`{}`", joint.name));
        }
        let cut = [low.max(-WHOLE_TURN), high.min(WHOLE_TURN)];
        if cut[0] >= cut[1] {
            let what = format!("its stops are at {} and {} rad, more than a turn from zero", digits(low), digits(high));
            let remedy = format!("count from another zero, or give them: --range {}=LOW,HIGH", joint.name);
            self.faults.add(Kind::Limit, Some(&joint.place), what, remedy);
            return None;
        }
        Some(cut)
    }

    /// The inertia of a body, mended where it is a body's but for rounding or for what does not matter in the plane.
    fn possible(&mut self, rigid: &Rigid, link: usize) -> Matrix3<f64> {
        let source = &self.model.links[link];
        if rigid.mass <= 0.0 {
            return rigid.inertia;
        }
        // As little as a mass has that is spread over a millionth of the robot's size.
        if rigid.inertia.amax() <= 1e-12 * rigid.mass * self.size * self.size {
            return Matrix3::zeros();
        }
        let mended = inertia::nearest_possible(&rigid.inertia);
        if mended.change == 0.0 {
            return rigid.inertia;
        }
        let share = format!("{:.2} %", mended.change * 100.0);
        if mended.change <= 0.01 || mended.swing_is_kept || self.options.mend {
            let kept = match mended.swing_is_kept {
                true => {
                    " of the greatest moment; its moment about the transverse axis, all that a gait in the plane sees, is kept"
                }
                false => " of the greatest moment",
            };
            self.notes.push(format!(
                "the inertia of `{}` is none that a body can have: it is changed to the nearest that is one, by {share}{kept}",
                source.name
            ));
            return mended.inertia;
        }
        let moments = rigid.inertia.diagonal();
        let what = format!(
            "no body has its moments of inertia (forward {:.3e}, up {:.3e}, across {:.3e} kg·m²): none exceeds the sum of the others",
            moments.x, moments.y, moments.z
        );
        let remedy =
            format!("correct its <inertial>, or let the nearest possible one be taken, changed by {share}: --mend");
        self.faults.add(Kind::Inertia, Some(&source.place), what, remedy);
        rigid.inertia
    }

    fn say(&mut self) {
        for (what, names) in [("links", &self.links.changed), ("joints", &self.joints.changed)] {
            if !names.is_empty() {
                let pairs: Vec<String> = names.iter().map(|(name, made)| format!("`{name}` is `{made}`")).collect();
                self.notes.push(format!(
                    "names of {what} that a specification does not admit are changed (robot.toml has both): {}",
                    short_list(&pairs)
                ));
            }
        }
        if self.tilt > 1e-6 && self.tilt <= ROUNDED {
            let tilt = self.tilt;
            self.notes
                .push(format!("axes of joints are straightened by up to {tilt:.1e} rad, as far as rounding goes"));
        }
        if !self.turning.is_empty() {
            let list = self.turning.join(", ");
            self.notes.push(format!("{list} without stops: one turn to either side is taken"));
        }
        if !self.cut.is_empty() {
            self.notes.push(format!("the ranges of {} are cut to one turn to either side", self.cut.join(", ")));
        }
    }
}

/// One turn, and not more than that in as many digits as are written.
const WHOLE_TURN: f64 = TAU * (1.0 - 1e-9);

/// The value for a joint: what is given for its name, else what the file has, else what is given for all.
fn setting(settings: &[Setting], joint: &str, file: Option<f64>) -> Option<f64> {
    chosen(settings, joint, file.is_some()).map(|k| settings[k].value).or(file)
}

/// Legs at one place, as in planar models: they are put apart sideways, which does not matter in the plane.
fn apart(robot: &mut Robot, notes: &mut Vec<String>) {
    let step = 0.1 * robot.reach();
    let is_right = |leg: &Leg| {
        let name = leg.name.to_lowercase();
        name.contains("right") || name.starts_with("r_") || name.ends_with("_r")
    };
    for k in 1..robot.legs.len() {
        let same = |i: usize| (robot.legs[i].mount - robot.legs[k].mount).amax() < 1e-9;
        let Some(other) = (0..k).find(|i| same(*i)) else { continue };
        let side = if is_right(&robot.legs[other]) { -1.0 } else { 1.0 };
        robot.legs[other].mount.z -= side * step;
        robot.legs[k].mount.z += side * step;
        notes.push(format!(
            "`{}` and `{}` hang at one place: they are put {:.0} mm apart sideways, which does not matter in the plane",
            robot.legs[other].name,
            robot.legs[k].name,
            2e3 * step
        ));
    }
}
