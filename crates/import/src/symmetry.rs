//! Symmetry as people mean it: legs that agree to what a file rounds are made alike, and it is said what that changed.
//!
//! Left and right legs are mirror images of each other. Fore and hind legs that are to move as one need the same lengths,
//! stops and motors in the plane; what they weigh is their own. What was identified joint by joint, rotors, friction and
//! springs, differs more than a file rounds, and becomes the mean of counterparts; each such change is said.

use super::Rigid;
use super::model::{Friction, Rotor, Spring};
use super::robot::{Leg, Motor, PITCH, Robot};
use nalgebra::Vector3;
use piaffe_model::digits::few;

/// Which legs belong together: pairs of a left and a right one, from fore to hind.
pub struct Arrangement {
    pub pairs: Vec<[usize; 2]>,
    /// Whether all legs have the same lengths, stops and motors in the plane.
    pub alike: bool,
    /// Why legs differ, a sentence each.
    pub differences: Vec<String>,
}

impl Arrangement {
    /// What follows where legs are not alike, and what to do about it.
    pub fn consequence(&self) -> Option<String> {
        let follows = match self.pairs.len() {
            1 => "each of the two steps is found for itself",
            2 => "diagonal legs do not move as one, and there is no trot",
            3 => "there is no tripod",
            _ => "there is no gait of alternating legs",
        };
        (!self.alike).then(|| format!("since legs differ, {follows}: {MEANT_ALIKE}"))
    }
}

/// What to do about legs that should not differ.
pub const MEANT_ALIKE: &str = "if they are meant to be alike, let more of a difference pass (--alike SHARE, 0.001 if it is not given), or give \
                               joints the same motors and stops (--effort, --velocity, --gear, --range with JOINT=…)";

/// Sorts the legs and makes alike those that differ by no more than the share `tolerance`.
pub fn arrange(robot: &mut Robot, tolerance: f64, notes: &mut Vec<String>) -> Option<Arrangement> {
    let pairs = pairs(robot)?;
    let (mut differences, mut weights) = (Vec::new(), Vec::new());
    let mut side = Likening { tolerance, scale: robot.reach(), greatest: 0.0, which: String::new() };
    let before: Vec<Leg> = robot.legs.clone();
    for [left, right] in &pairs {
        let (a, b) = two(&mut robot.legs, *left, *right);
        match side.mirror(a, b) {
            Ok(unequal) => weights.extend(unequal),
            Err(why) => differences.push(why),
        }
    }
    let mut alike = differences.is_empty();
    if alike {
        // The stops that all share so far, or a third leg could share none with the second.
        let mut shared_by_all = robot.legs[pairs[0][0]].clone();
        for [other, _] in &pairs[1..] {
            let other = &robot.legs[*other];
            if let Err(why) = side.same_plane(&shared_by_all, other) {
                differences.push(why);
                alike = false;
                break;
            }
            for (s, t) in shared_by_all.segments.iter_mut().zip(&other.segments) {
                s.joint.range = shared(s.joint.range, t.joint.range);
            }
        }
    }
    if alike {
        side.one_plane(&mut robot.legs);
    }
    side.say(notes);
    for (old, new) in before.iter().zip(&robot.legs) {
        for (old, new) in old.segments.iter().zip(&new.segments) {
            let (was, is) = (&old.joint.motor, &new.joint.motor);
            if was.gear != is.gear {
                notes.push(format!(
                    "the gear of `{}` is the one that the file gives for its counterpart",
                    new.joint.name
                ));
            }
            // As the joint feels them, whatever is known of its gear.
            let felt = |motor: &Motor| motor.rotor.map(|rotor| rotor.at_joint(is.gear));
            match (felt(was), felt(is)) {
                (Some(p), Some(q)) if (p - q).abs() > EXACT * p.abs().max(q.abs()) => notes.push(format!(
                    "the rotor of `{}` is the mean of it and its counterparts: {q:.3e} instead of {p:.3e} kg·m² at the joint",
                    new.joint.name
                )),
                (None, Some(_)) => notes.push(format!(
                    "the rotor of `{}` is the one that the file gives for its counterpart",
                    new.joint.name
                )),
                _ => {}
            }
            let (was, is) = (old.joint.friction, new.joint.friction);
            if was != is {
                notes.push(format!(
                    "the friction of `{}` is the mean of it and its counterparts: {:.3e} N·m·s/rad and {:.3e} N·m instead of {:.3e} \
                     and {:.3e}",
                    new.joint.name, is.damping, is.coulomb, was.damping, was.coulomb
                ));
            }
            let (was, is) = (old.joint.spring, new.joint.spring);
            if was != is {
                notes.push(format!(
                    "the spring of `{}` is the mean of it and its counterparts: {:.3e} N·m/rad about {:.4} rad instead of {:.3e} about {:.4}",
                    new.joint.name, is.stiffness, is.rest, was.stiffness, was.rest
                ));
            }
            let moved = (0..2).any(|k| (old.joint.range[k] - new.joint.range[k]).abs() > 1e-9);
            if moved {
                let ([a, b], [c, d]) = (old.joint.range, new.joint.range);
                notes.push(format!(
                    "the stops of `{}` are those that its counterparts share: {c:.4} and {d:.4} instead of {a:.4} and {b:.4} rad",
                    new.joint.name
                ));
            }
        }
    }
    differences.extend(weights);
    Some(Arrangement { pairs, alike, differences })
}

fn two(legs: &mut [Leg], a: usize, b: usize) -> (&mut Leg, &mut Leg) {
    let (low, high) = (a.min(b), a.max(b));
    let (head, tail) = legs.split_at_mut(high);
    if a < b { (&mut head[low], &mut tail[0]) } else { (&mut tail[0], &mut head[low]) }
}

/// As many legs to the left as to the right, each beside its counterpart.
fn pairs(robot: &Robot) -> Option<Vec<[usize; 2]>> {
    let legs = &robot.legs;
    let sideways = |k: &usize| legs[*k].mount.z + legs[*k].segments.iter().map(|s| s.link.end.z).sum::<f64>();
    // Two legs are a pair, beside each other or not.
    if let [a, b] = &legs[..] {
        let swapped = a.mount.z > b.mount.z;
        return Some(vec![if swapped { [1, 0] } else { [0, 1] }]);
    }
    let mut left: Vec<usize> = (0..legs.len()).filter(|k| sideways(k) < 0.0).collect();
    let mut right: Vec<usize> = (0..legs.len()).filter(|k| sideways(k) >= 0.0).collect();
    if left.len() != right.len() || left.is_empty() {
        return None;
    }
    for side in [&mut left, &mut right] {
        side.sort_by(|a, b| legs[*b].mount.x.total_cmp(&legs[*a].mount.x));
        let apart = |pair: &[usize]| legs[pair[0]].mount.x - legs[pair[1]].mount.x > 1e-3 * robot.reach();
        if !side.windows(2).all(apart) {
            return None;
        }
    }
    Some(left.into_iter().zip(right).map(|(l, r)| [l, r]).collect())
}

/// Makes legs alike, and remembers what it changed.
struct Likening {
    /// Shares of lengths, masses and inertias that count as rounding.
    tolerance: f64,
    /// Length of the legs, m.
    scale: f64,
    /// The greatest change, as a share, and of what.
    greatest: f64,
    which: String,
}

/// The least share of the narrower range that is enough for two joints to have one.
const SHARED: f64 = 0.25;

/// What the specification takes for equal: nothing has to be changed.
const EXACT: f64 = 1e-9;

impl Likening {
    /// One number from two that are meant to be the same; `None` if they are not.
    fn mean(&mut self, a: f64, b: f64, scale: f64, what: impl Fn() -> String) -> Option<f64> {
        let share = if a == b { 0.0 } else { (a - b).abs() / scale };
        if share > self.tolerance || share.is_nan() {
            return None;
        }
        if (a - b).abs() <= EXACT * scale.min(1.0) {
            return Some(a);
        }
        if share > self.greatest {
            (self.greatest, self.which) = (share, what());
        }
        Some(0.5 * (a + b))
    }

    /// Left and right become mirror images, but for what they weigh where that differs; else why they are none.
    fn mirror(&mut self, a: &mut Leg, b: &mut Leg) -> Result<Option<String>, String> {
        self.same_kind(a, b, true)?;
        let scale = self.scale;
        for axis in 0..3 {
            let sign = if axis == 2 { -1.0 } else { 1.0 };
            if let Some(x) = self.mean(a.mount[axis], sign * b.mount[axis], scale, || "mounts of legs".into()) {
                (a.mount[axis], b.mount[axis]) = (x, sign * x);
            }
        }
        let mut unequal = None;
        for (s, t) in a.segments.iter_mut().zip(&mut b.segments) {
            for axis in 0..3 {
                let sign = if axis == 2 { -1.0 } else { 1.0 };
                let what = || format!("lengths of `{}` and `{}`", s.link.name, t.link.name);
                if let Some(x) = self.mean(s.link.end[axis], sign * t.link.end[axis], scale, what) {
                    (s.link.end[axis], t.link.end[axis]) = (x, sign * x);
                }
            }
            let mirrored = s.joint.axis != PITCH;
            let other = if mirrored { [0.0 - t.joint.range[1], 0.0 - t.joint.range[0]] } else { t.joint.range };
            let shared = shared(s.joint.range, other);
            s.joint.range = shared;
            t.joint.range = if mirrored { [0.0 - shared[1], 0.0 - shared[0]] } else { shared };
            let motor = one_motor(&s.joint.motor, &t.joint.motor);
            (s.joint.motor, t.joint.motor) = (motor, motor);
            let seen = |spring: Spring| if mirrored { spring.turned() } else { spring };
            let spring = mean_spring(&[s.joint.spring, seen(t.joint.spring)]);
            (s.joint.spring, t.joint.spring) = (spring, seen(spring));
            let friction = mean(&[s.joint.friction, t.joint.friction]);
            (s.joint.friction, t.joint.friction) = (friction, friction);
            let names = [s.link.name.clone(), t.link.name.clone()];
            if self.weigh(&mut s.link.rigid, &mut t.link.rigid, &names).is_none() {
                let [a, b] = names;
                unequal.get_or_insert_with(|| format!("`{a}` and `{b}` weigh differently"));
            }
        }
        Ok(unequal)
    }

    /// Makes two links weigh the same in the plane, and beside it where they nearly do.
    fn weigh(&mut self, a: &mut Rigid, b: &mut Rigid, names: &[String; 2]) -> Option<()> {
        let scale = a.mass.max(b.mass);
        let size = a.inertia.amax().max(b.inertia.amax());
        let what = |of: &str| format!("{of} of `{}` and `{}`", names[0], names[1]);
        // One that differs too much leaves all as they are, and nothing to tell.
        let before = (self.greatest, self.which.clone());
        let all = self.weights(a, b, scale, size, &what);
        if all.is_none() {
            (self.greatest, self.which) = before;
        }
        let [mass, x, y, swing] = all?;
        (a.mass, b.mass) = (mass, mass);
        (a.com.x, b.com.x, a.com.y, b.com.y) = (x, x, y, y);
        (a.inertia[(2, 2)], b.inertia[(2, 2)]) = (swing, swing);
        if let Some(z) = self.mean(a.com.z, -b.com.z, self.scale, || what("mass centres")) {
            (a.com.z, b.com.z) = (z, -z);
        }
        for i in 0..3 {
            for j in i..3 {
                let sign = if (i == 2) != (j == 2) { -1.0 } else { 1.0 };
                if let Some(x) = self.mean(a.inertia[(i, j)], sign * b.inertia[(i, j)], size, || what("inertias")) {
                    (a.inertia[(i, j)], a.inertia[(j, i)]) = (x, x);
                    (b.inertia[(i, j)], b.inertia[(j, i)]) = (sign * x, sign * x);
                }
            }
        }
        Some(())
    }

    /// Mass, mass centre and inertia in the plane, if all of them are meant to be the same.
    fn weights(
        &mut self,
        a: &Rigid,
        b: &Rigid,
        scale: f64,
        size: f64,
        what: &dyn Fn(&str) -> String,
    ) -> Option<[f64; 4]> {
        Some([
            self.mean(a.mass, b.mass, scale, || what("masses"))?,
            self.mean(a.com.x, b.com.x, self.scale, || what("mass centres"))?,
            self.mean(a.com.y, b.com.y, self.scale, || what("mass centres"))?,
            self.mean(a.inertia[(2, 2)], b.inertia[(2, 2)], size, || what("inertias"))?,
        ])
    }

    /// Whether two legs have the same joints, lengths, stops and motors in the plane; else why not.
    fn same_kind(&self, a: &Leg, b: &Leg, left_and_right: bool) -> Result<(), String> {
        let pair = format!("`{}` and `{}`", a.name, b.name);
        // Beside the plane only what the joints are made of matters, for a gait holds them still.
        let plane = |leg: &Leg| leg.segments.iter().map(|s| s.joint.axis == PITCH).collect::<Vec<_>>();
        if plane(a) != plane(b) {
            return Err(format!("legs {pair} have different joints"));
        }
        let close = |p: f64, q: f64, scale: f64| (p - q).abs() <= self.tolerance * scale;
        for (s, t) in a.segments.iter().zip(&b.segments) {
            let names = format!("`{}` and `{}`", s.joint.name, t.joint.name);
            let ends = [s.link.end, t.link.end];
            if !(close(ends[0].x, ends[1].x, self.scale) && close(ends[0].y, ends[1].y, self.scale)) {
                let mirrored = close(ends[0].x, -ends[1].x, self.scale) && close(ends[0].y, ends[1].y, self.scale);
                return Err(match mirrored && !left_and_right {
                    true => format!("legs {pair} bend opposite ways: their links are mirror images, fore and aft"),
                    false => {
                        let apart = (ends[0] - ends[1]).xy().amax() / self.scale;
                        format!(
                            "`{}` and `{}` have different lengths: [{:.4}, {:.4}] and [{:.4}, {:.4}] m ({:.2} % of a leg)",
                            s.link.name,
                            t.link.name,
                            ends[0].x,
                            ends[0].y,
                            ends[1].x,
                            ends[1].y,
                            100.0 * apart
                        )
                    }
                });
            }
            if s.joint.axis != PITCH && !left_and_right {
                continue;
            }
            let other = t.joint.range;
            let other = if s.joint.axis != PITCH { [0.0 - other[1], 0.0 - other[0]] } else { other };
            let [low, high] = shared(s.joint.range, other);
            let narrow = (s.joint.range[1] - s.joint.range[0]).min(other[1] - other[0]);
            if high - low < SHARED * narrow {
                let [p, q] = [s.joint.range, other].map(|[a, b]| format!("[{a:.3}, {b:.3}]"));
                return Err(format!("{names} share hardly any angles: {p} and {q} rad"));
            }
            let (m, n) = (&s.joint.motor, &t.joint.motor);
            let same = |p: Option<f64>, q: Option<f64>| p.zip(q).is_none_or(|(p, q)| close(p, q, p.abs().max(q.abs())));
            let both = |p: f64, q: f64, unit: &str| format!("{} and {}{unit}", few(p), few(q));
            let differ = [
                (!close(m.effort, n.effort, m.effort)).then(|| both(m.effort, n.effort, " N·m")),
                (!close(m.velocity, n.velocity, m.velocity)).then(|| both(m.velocity, n.velocity, " rad/s")),
                m.gear
                    .zip(n.gear)
                    .filter(|_| !same(m.gear, n.gear))
                    .map(|(p, q)| "gears of ".to_string() + &both(p, q, "")),
            ];
            let differ: Vec<String> = differ.into_iter().flatten().collect();
            if !differ.is_empty() {
                return Err(format!("{names} have different motors: {}", differ.join(", ")));
            }
        }
        Ok(())
    }

    /// Whether a fore and a hind leg can move as one; else why not.
    fn same_plane(&self, a: &Leg, b: &Leg) -> Result<(), String> {
        self.same_kind(a, b, false)?;
        let (y, z) = (a.mount.y, b.mount.y);
        if (y - z).abs() > self.tolerance * self.scale {
            let apart = (y - z).abs() * 1e3;
            return Err(format!("`{}` and `{}` hang at different heights, {apart:.1} mm apart", a.name, b.name));
        }
        Ok(())
    }

    /// Gives all legs the same lengths, stops and motors in the plane.
    fn one_plane(&mut self, legs: &mut [Leg]) {
        let Some(mut model) = legs.first().cloned() else { return };
        for (depth, segment) in model.segments.iter_mut().enumerate() {
            let motors: Vec<Motor> = legs.iter().map(|l| l.segments[depth].joint.motor).collect();
            segment.joint.motor.rotor = mean_rotor(&motors);
            let all: Vec<Friction> = legs.iter().map(|l| l.segments[depth].joint.friction).collect();
            segment.joint.friction = mean(&all);
            let all: Vec<Spring> = legs.iter().map(|l| l.segments[depth].joint.spring).collect();
            segment.joint.spring = mean_spring(&all);
        }
        for other in &legs[1..] {
            let mean = |likening: &mut Self, a: f64, b: f64, name: &str| {
                likening.mean(a, b, likening.scale, || format!("lengths of `{name}` and its counterparts")).unwrap_or(a)
            };
            model.mount.y = mean(self, model.mount.y, other.mount.y, &other.name);
            for (s, t) in model.segments.iter_mut().zip(&other.segments) {
                s.link.end.x = mean(self, s.link.end.x, t.link.end.x, &t.link.name);
                s.link.end.y = mean(self, s.link.end.y, t.link.end.y, &t.link.name);
                s.joint.range = shared(s.joint.range, t.joint.range);
                let rotor = s.joint.motor.rotor;
                s.joint.motor = one_motor(&s.joint.motor, &t.joint.motor);
                s.joint.motor.rotor = rotor.or(s.joint.motor.rotor);
            }
        }
        for leg in legs {
            leg.mount.y = model.mount.y;
            for (s, t) in leg.segments.iter_mut().zip(&model.segments) {
                s.link.end = Vector3::new(t.link.end.x, t.link.end.y, s.link.end.z);
                if s.joint.axis == PITCH {
                    s.joint.range = t.joint.range;
                    s.joint.spring = t.joint.spring;
                    s.joint.friction = t.joint.friction;
                    s.joint.motor = t.joint.motor;
                }
            }
        }
    }

    fn say(&self, notes: &mut Vec<String>) {
        if self.greatest > 0.0 {
            notes.push(format!(
                "legs that differ by no more than {} % are made alike: numbers are changed by up to {:.2e} % ({})",
                self.tolerance * 100.0,
                self.greatest * 50.0,
                self.which
            ));
        }
    }
}

fn shared(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// The spring that does on the mean what these do; of equal ones as it is.
fn mean_spring(all: &[Spring]) -> Spring {
    let Some(first) = all.first().filter(|first| all.iter().any(|spring| spring != *first)) else {
        return all.first().copied().unwrap_or_default();
    };
    let sum: f64 = all.iter().map(|spring| spring.stiffness).sum();
    let rest = all.iter().map(|spring| spring.stiffness * spring.rest).sum::<f64>() / sum;
    Spring { stiffness: sum / all.len() as f64, rest: if sum > 0.0 { rest } else { first.rest } }
}

/// What joints rub that must rub alike; of equal ones as it is.
fn mean(all: &[Friction]) -> Friction {
    let mean = |of: fn(&Friction) -> f64| match all.windows(2).all(|pair| of(&pair[0]) == of(&pair[1])) {
        true => all.first().map_or(0.0, of),
        false => all.iter().map(of).sum::<f64>() / all.len() as f64,
    };
    Friction { damping: mean(|f| f.damping), coulomb: mean(|f| f.coulomb) }
}

/// What both are. A gear or rotor that the file gives for one of them is the other's too; rotors that were identified one by
/// one are the mean of them.
fn one_motor(a: &Motor, b: &Motor) -> Motor {
    Motor { gear: a.gear.or(b.gear), rotor: mean_rotor(&[*a, *b]), ..*a }
}

/// The rotor of joints that must have the same: the mean of those that are given; of equal ones as it is.
fn mean_rotor(motors: &[Motor]) -> Option<Rotor> {
    let given: Vec<Rotor> = motors.iter().filter_map(|motor| motor.rotor).collect();
    let first = *given.first()?;
    if given.iter().all(|rotor| *rotor == first) {
        return Some(first);
    }
    let gear = motors.iter().find_map(|motor| motor.gear);
    let mean = |of: &dyn Fn(&Rotor) -> f64| given.iter().map(of).sum::<f64>() / given.len() as f64;
    Some(match given.iter().all(|rotor| matches!(rotor, Rotor::AtMotor(_))) {
        true => Rotor::AtMotor(mean(&|rotor| rotor.at_motor(gear))),
        false => Rotor::AtJoint(mean(&|rotor| rotor.at_joint(gear))),
    })
}
