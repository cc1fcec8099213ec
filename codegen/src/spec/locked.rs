//! A gait may hold joints still: what they carry becomes part of the link on which they hang.

use super::Code;
use super::diagnostic::{At, Sink};
use super::nearest::nearest;
use super::rigid::{IDENTITY, Rigid, Rotation3, apply, times, turn};
use super::robot::RobotFile;
use super::types::{Axis, Inertia, Joint, Leg, Link, Locked, Platform, Robot, Segment};

/// A joint whose axis is no coordinate axis any more once others are locked, or one that points backward.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tilted {
    pub joint: String,
    /// Whether it is a coordinate axis turned round: angles about it would count backward.
    pub reversed: bool,
}

impl Robot {
    /// The robot with these joints held at their angles (rad), as a robot without them.
    ///
    /// The links keep the axes of the link on which they then hang: a chain below a locked pitch
    /// joint is bent, not turned.
    ///
    /// # Errors
    /// If that tilts the axis of another joint.
    pub fn locked(&self, angles: &[(String, f64)]) -> Result<Robot, Tilted> {
        if angles.is_empty() {
            return Ok(self.clone());
        }
        let mut platform = self.platform.clone();
        let mut legs = Vec::new();
        for leg in &self.legs {
            legs.push(lock(leg, angles, &mut platform)?);
        }
        let written = self.written.clone();
        Ok(Robot { name: self.name.clone(), gravity: self.gravity, platform, legs, written })
    }
}

/// The leg without its locked joints; links above its first joint become part of the platform.
fn lock(leg: &Leg, angles: &[(String, f64)], platform: &mut Platform) -> Result<Leg, Tilted> {
    let mut mount = leg.mount;
    let mut chain: Vec<Segment> = Vec::new();
    let mut on_platform = leg.locked.clone();
    // From the axes that the links are given in to those of the link that carries them now.
    let mut rotation = IDENTITY;
    for segment in &leg.chain {
        let Segment { joint, link } = segment;
        let angle = angles.iter().find(|(name, _)| *name == joint.name).map(|(_, angle)| *angle);
        let Some(angle) = angle else {
            let tilted = |reversed| Tilted { joint: joint.name.clone(), reversed };
            let axis = carried_axis(&rotation, joint.axis).map_err(tilted)?;
            let mut segment = segment.clone();
            segment.joint.axis = axis;
            segment.link.put(&link.rigid().moved(&rotation, [0.0; 3]));
            segment.link.end = apply(&rotation, &link.end);
            segment.link.locked.iter_mut().for_each(|locked| locked.at = apply(&rotation, &locked.at));
            chain.push(segment);
            continue;
        };
        rotation = times(&rotation, &turn(joint.axis, angle));
        let here = chain.last().map_or(mount, |above| above.link.end);
        let body = link.rigid().moved(&rotation, here);
        let further = apply(&rotation, &link.end);
        let end = [0, 1, 2].map(|i| here[i] + further[i]);
        let held = Locked { name: joint.name.clone(), at: here };
        match chain.last_mut() {
            Some(above) => {
                above.link.locked.push(held);
                let sum = above.link.rigid().with(&body);
                above.link.put(&sum);
                above.link.end = end;
            }
            None => {
                on_platform.push(held);
                let sum = platform.rigid().with(&body);
                (platform.mass, platform.com, platform.inertia) = (sum.mass, sum.com, sum.inertia);
                mount = end;
            }
        }
    }
    Ok(Leg { name: leg.name.clone(), mount, chain, locked: on_platform })
}

/// The coordinate axis that `axis` has become; else whether it has become one that is turned round.
fn carried_axis(rotation: &Rotation3, axis: Axis) -> Result<Axis, bool> {
    let direction = rotation.map(|row| row[axis.index()]);
    // As far as products of sines and cosines round.
    let along = |a: &Axis, sign: f64| sign * direction[a.index()] > 1.0 - 1e-12;
    let reversed = Axis::ALL.iter().any(|a| along(a, -1.0));
    Axis::ALL.into_iter().find(|a| along(a, 1.0)).ok_or(reversed)
}

impl Link {
    /// With its foot.
    pub(crate) fn rigid(&self) -> Rigid {
        let own = Rigid { mass: self.mass, com: self.com, inertia: self.inertia };
        own.with(&Rigid::point(self.foot_mass, self.end))
    }

    /// Gives the link this mass, mass centre and inertia, its foot included.
    pub(crate) fn put(&mut self, body: &Rigid) {
        (self.mass, self.com, self.inertia, self.foot_mass) = (body.mass, body.com, body.inertia, 0.0);
    }
}

impl Platform {
    fn rigid(&self) -> Rigid {
        Rigid { mass: self.mass, com: self.com, inertia: self.inertia }
    }
}

/// The robot as a gait that locks these joints sees it. Mistakes are reported where the gait names the joint.
pub(super) fn with_locked(angles: &[(At<String>, f64)], robot: &RobotFile, sink: &mut Sink) -> Option<RobotFile> {
    let joints: Vec<&Joint> = robot.robot.legs.iter().flat_map(|leg| &leg.chain).map(|s| &s.joint).collect();
    let mut good = true;
    let mut report = |at: &At<String>, code: Code, title: String, label: &str, help: String| {
        sink.report(code, title, &at.span, label, help);
        good = false;
    };
    for (name, angle) in angles {
        let Some(joint) = joints.iter().find(|j| j.name == name.value) else {
            let help = match nearest(&name.value, joints.iter().map(|j| j.name.as_str())) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "name a joint of the robot".into(),
            };
            report(name, Code::UnknownName, format!("there is no joint `{}`", name.value), "no such joint", help);
            continue;
        };
        let [low, high] = joint.range;
        if !(low..=high).contains(angle) {
            let title =
                format!("joint `{}` cannot be locked at {angle:?}: its stops are at {low:?} and {high:?}", name.value);
            let help =
                format!("write {} = {:?} or another angle of its range, rad", name.value, angle.clamp(low, high));
            report(name, Code::CannotLock, title, "beyond its stops", help);
        }
    }
    for leg in &robot.robot.legs {
        let is_locked = |s: &Segment| angles.iter().any(|(name, _)| name.value == s.joint.name);
        if let (true, Some(last)) = (leg.chain.iter().all(is_locked), leg.chain.last())
            && let Some((name, _)) = angles.iter().find(|(name, _)| name.value == last.joint.name)
        {
            let title = format!("leg `{}` has no joint left", leg.name);
            report(
                name,
                Code::CannotLock,
                title,
                "locks its last one",
                "leave at least one joint of every leg free".into(),
            );
        }
    }
    if !good {
        return None;
    }
    let plain: Vec<(String, f64)> = angles.iter().map(|(name, angle)| (name.value.clone(), *angle)).collect();
    match robot.robot.locked(&plain) {
        Ok(locked) => Some(RobotFile { robot: locked, ..robot.clone() }),
        Err(Tilted { joint, reversed }) => {
            let (name, _) = angles.iter().rfind(|(_, angle)| *angle != 0.0).or(angles.first())?;
            let (turns, would) = match reversed {
                true => ("turns round", format!("angles of `{joint}` would count backward")),
                false => ("tilts", format!("`{joint}` would turn about an oblique axis")),
            };
            let title = format!("locking `{}` {turns} the axis of joint `{joint}`", name.value);
            let help =
                "lock it at 0, or let it move: axes stay parallel to the platform's where all joints are at zero";
            sink.report(Code::CannotLock, title, &name.span, "turns what hangs on it", help);
            sink.beside(robot.axis_label(&joint, would));
            None
        }
    }
}

/// The inertia with these moments and products `[∫yz dm, ∫zx dm, ∫xy dm]`.
pub(super) fn tensor(moments: [f64; 3], products: [f64; 3]) -> Inertia {
    let [yz, zx, xy] = products.map(|p| 0.0 - p);
    [[moments[0], xy, zx], [xy, moments[1], yz], [zx, yz, moments[2]]]
}
