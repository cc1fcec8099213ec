//! Real legs that move as one are one leg (§2.1): its hip is the mean of theirs, its masses and
//! inertias are their sums.

use super::types::{Actuator, Axis, Inertia, Joint, Leg, Robot, Rotation};

/// Angles (rad) this close are equal, and lengths, masses and inertias to this share.
pub(super) const SAME: f64 = 1e-9;

impl Robot {
    /// The virtual leg of these legs, which must move alike; called like the first of them.
    pub fn virtual_leg(&self, members: &[usize]) -> Leg {
        let legs: Vec<&Leg> = members.iter().map(|&leg| &self.legs[leg]).collect();
        let share = 1.0 / legs.len() as f64;
        let mut leg = legs[0].clone();
        for (axis, x) in leg.mount.iter_mut().enumerate() {
            *x = legs.iter().map(|leg| leg.mount[axis]).sum::<f64>() * share;
        }
        for (depth, segment) in leg.chain.iter_mut().enumerate() {
            for other in &legs[1..] {
                let sum = segment.link.rigid().with(&other.chain[depth].link.rigid());
                segment.link.put(&sum);
            }
        }
        leg
    }
}

/// Legs seen as parts of a gait: what of them matters, and what makes them equal.
#[derive(Clone, Copy, Debug)]
pub(super) enum Likeness {
    /// Alike in the sagittal plane; how far beside it things are does not matter.
    InPlane,
    /// Alike in space.
    InSpace,
    /// Mirror images across the sagittal plane.
    Mirrored,
}

impl Leg {
    /// How far its links reach, end to end, m.
    pub(super) fn length(&self) -> f64 {
        let norm = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.chain.iter().map(|segment| norm(&segment.link.end)).sum()
    }
}

impl Likeness {
    /// Of legs that move as one.
    pub fn of_pair(rotation: Rotation) -> Likeness {
        if rotation == Rotation::Roll { Likeness::InSpace } else { Likeness::InPlane }
    }

    /// Of legs that exchange their roles.
    pub fn of_exchange(rotation: Rotation) -> Likeness {
        if rotation == Rotation::Roll { Likeness::Mirrored } else { Likeness::InPlane }
    }

    /// The first axis along which the points differ, beside a length.
    pub fn apart(self, a: &[f64; 3], b: &[f64; 3], length: f64) -> Option<usize> {
        let sign = |k: usize| if k == 2 && matches!(self, Likeness::Mirrored) { -1.0 } else { 1.0 };
        let axes = if matches!(self, Likeness::InPlane) { 2 } else { 3 };
        (0..axes).find(|&k| (a[k] - sign(k) * b[k]).abs() > SAME * length)
    }

    fn same_inertia(self, a: &Inertia, b: &Inertia) -> bool {
        let scale = (0..3).fold(0.0f64, |s, k| s.max(a[k][k]).max(b[k][k]));
        let entry = |i: usize, j: usize| {
            let sign = if matches!(self, Likeness::Mirrored) && (i == 2) != (j == 2) { -1.0 } else { 1.0 };
            (a[i][j] - sign * b[i][j]).abs() <= SAME * scale
        };
        match self {
            Likeness::InPlane => entry(2, 2),
            _ => (0..3).all(|i| (i..3).all(|j| entry(i, j))),
        }
    }

    /// The range of a joint's counterpart.
    fn range(self, joint: &Joint) -> [f64; 2] {
        let [low, high] = joint.range;
        if matches!(self, Likeness::Mirrored) && joint.axis != Axis::Pitch { [-high, -low] } else { [low, high] }
    }
}

/// Why two legs cannot move alike, if they cannot.
pub(super) fn moves_unlike(a: &Leg, b: &Leg, likeness: Likeness) -> Option<String> {
    if a.chain.len() != b.chain.len() || a.chain.iter().zip(&b.chain).any(|(s, t)| s.joint.axis != t.joint.axis) {
        return Some("the legs have different joints".into());
    }
    for (s, t) in a.chain.iter().zip(&b.chain) {
        let range = likeness.range(&t.joint);
        if (0..2).any(|k| (s.joint.range[k] - range[k]).abs() > SAME) {
            let mirrored = if range == t.joint.range { "" } else { "mirrored " };
            return Some(format!(
                "the {mirrored}ranges of `{}` and `{}` differ: {:?} and {range:?}",
                s.joint.name, t.joint.name, s.joint.range
            ));
        }
        if !same_motor(&s.joint.actuator, &t.joint.actuator) {
            return Some(format!("`{}` and `{}` have different motors", s.joint.name, t.joint.name));
        }
        if likeness.apart(&s.link.end, &t.link.end, a.length()).is_some() {
            let (a, b) = (s.link.end, t.link.end);
            return Some(format!("`{}` ends at {a:?}, `{}` at {b:?}", s.link.name, t.link.name));
        }
    }
    None
}

/// Why one leg does not weigh what the other weighs, if it does not.
pub(super) fn weighs_unlike(a: &Leg, b: &Leg, likeness: Likeness) -> Option<String> {
    let length = a.length();
    a.chain.iter().zip(&b.chain).find_map(|(s, t)| {
        let (s, t) = (&s.link, &t.link);
        if (s.mass - t.mass).abs() > SAME * s.mass {
            Some(format!("`{}` weighs {} kg, its counterpart {} kg", s.name, s.mass, t.mass))
        } else if likeness.apart(&s.com, &t.com, length).is_some() {
            Some(format!("the mass centre of `{}` is at {:?}, that of its counterpart at {:?}", s.name, s.com, t.com))
        } else if !likeness.same_inertia(&s.inertia, &t.inertia) {
            Some(format!("the inertia of `{}` is not that of its counterpart", s.name))
        } else {
            None
        }
    })
}

/// Whether two motors are equal but for their names.
fn same_motor(a: &Actuator, b: &Actuator) -> bool {
    Actuator { name: String::new(), ..a.clone() } == Actuator { name: String::new(), ..b.clone() }
}
