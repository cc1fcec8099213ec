//! Joints and links → one platform and one chain per leg.
//!
//! Every name must resolve, the joints must form a tree (`tree.rs`), and every part must be used. Each leg is
//! the chain that starts at its first joint.

use super::Code;
use super::diagnostic::{At, Sink, Span};
use super::nearest::nearest;
use super::robot::{Body, LegPlaces, RawJoint, RawLeg};
use super::types::{Actuator, Joint, Leg, Link, Platform, Segment};

/// All named tables of a robot file; `None` stands for one with mistakes.
pub(super) struct Parts {
    pub links: Vec<(At<String>, Option<Body>)>,
    pub joints: Vec<RawJoint>,
    pub legs: Vec<RawLeg>,
    pub actuators: Vec<(At<String>, Option<Actuator>)>,
    /// Whether all four sections are there; else references to the missing ones mean nothing.
    pub whole: bool,
    /// Where the sections `joints` and `legs` are named.
    pub joints_at: Span,
    pub legs_at: Span,
}

/// Checks how the parts hang together and puts the legs together. `None` if anything is wrong.
pub(super) fn assemble(parts: Parts, sink: &mut Sink) -> Option<(Platform, Vec<Leg>, Vec<LegPlaces>)> {
    parts.check_mounts(sink);
    if !parts.whole || !parts.check_references(sink) {
        return None; // what follows would only repeat it
    }
    if !parts.check_tree(sink) {
        return None;
    }
    let platform = parts.platform(sink)?;
    let starts: Vec<_> = parts.legs.iter().map(|leg| parts.first_joint(leg, platform, sink)).collect();
    let starts: Option<Vec<usize>> = starts.into_iter().collect(); // after all legs had their say
    let chains: Vec<Vec<usize>> = starts?.into_iter().map(|joint| parts.chain(joint)).collect();
    parts.check_all_used(&chains, sink);
    parts.build(platform, &chains, sink)
}

impl Parts {
    fn link_names(&self) -> impl Iterator<Item = &str> {
        self.links.iter().map(|(name, _)| name.value.as_str())
    }

    /// Every name that is mentioned must be there.
    fn check_references(&self, sink: &mut Sink) -> bool {
        let links: Vec<&str> = self.link_names().collect();
        let joints: Vec<&str> = self.joints.iter().map(|j| j.name.value.as_str()).collect();
        let actuators: Vec<&str> = self.actuators.iter().map(|(n, _)| n.value.as_str()).collect();
        let mut good = true;
        for joint in &self.joints {
            for link in [&joint.parent, &joint.child] {
                good &= resolves(link.as_ref(), "link", &links, sink);
            }
            good &= resolves(joint.actuator.as_ref(), "actuator", &actuators, sink);
        }
        for leg in self.legs.iter().filter(|leg| leg.first_joint.is_some()) {
            good &= resolves(leg.first_joint.as_ref(), "joint", &joints, sink);
        }
        good
    }

    /// At least two legs, each at its own place.
    fn check_mounts(&self, sink: &mut Sink) {
        if self.whole && self.legs.len() < 2 {
            let title = format!("a robot needs at least two legs, this one has {}", self.legs.len());
            let help = "add another leg, for example hind_left = { mount = [x, y, z] }";
            sink.report(Code::TooFewLegs, title, &self.legs_at, "too few legs", help);
        }
        for (i, leg) in self.legs.iter().enumerate() {
            let Some(mount) = &leg.mount else { continue };
            let same = self.legs[..i].iter().find_map(|other| {
                let theirs = other.mount.as_ref()?;
                let farthest = theirs.value.iter().chain(&mount.value).fold(0.0, |far: f64, x| far.max(x.abs()));
                let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * farthest;
                theirs.value.iter().zip(&mount.value).all(close).then_some((other, theirs))
            });
            if let Some((other, theirs)) = same {
                let title =
                    format!("legs `{}` and `{}` are mounted at the same place", other.name.value, leg.name.value);
                let help = "give each leg its own mount = [x, y, z]: z is negative on the left, positive on the right";
                sink.report(Code::SameMount, title, &mount.span, "the same place", help);
                sink.beside(sink.label(&theirs.span, format!("`{}` is here already", other.name.value)));
            }
        }
    }

    /// Where a leg's chain starts.
    fn first_joint(&self, leg: &RawLeg, platform: usize, sink: &mut Sink) -> Option<usize> {
        let platform = &self.links[platform].0.value;
        let candidates = self.joints_below(platform);
        let names = || {
            let names: Vec<_> = candidates.iter().map(|&j| format!("\"{}\"", self.joints[j].name.value)).collect();
            names.join(" or ")
        };
        let Some(name) = &leg.first_joint else {
            if let [only] = candidates[..] {
                return Some(only);
            }
            let title = format!("leg `{}` could start with several joints", leg.name.value);
            let label = format!("{} joints hang on `{platform}`", candidates.len());
            let help = format!("add first_joint = {}", names());
            sink.report(Code::AmbiguousFirstJoint, title, &leg.name.span, label, help);
            return None;
        };
        let joint = self.joints.iter().position(|j| j.name.value == name.value)?;
        if candidates.contains(&joint) {
            return Some(joint);
        }
        let title =
            format!("leg `{}` starts with joint `{}`, which does not hang on the platform", leg.name.value, name.value);
        let help = format!("write first_joint = {}", names());
        sink.report(Code::NotOnPlatform, title, &name.span, "expected a joint of the platform", help);
        if let Some(parent) = &self.joints[joint].parent {
            sink.beside(sink.label(&parent.span, format!("`{}` hangs on this link", name.value)));
        }
        None
    }

    /// The joints of a chain, from the platform to the foot.
    fn chain(&self, first: usize) -> Vec<usize> {
        let mut chain = vec![first];
        let mut last = first;
        // The tree has no circles; the bound makes the end evident.
        while chain.len() < self.joints.len() {
            let below = self.joints[last].child.as_ref().map(|c| self.joints_below(&c.value));
            let Some(&next) = below.as_ref().and_then(|b| b.first()) else {
                break;
            };
            chain.push(next);
            last = next;
        }
        chain
    }

    /// A part that nothing uses is a misspelt one.
    fn check_all_used(&self, chains: &[Vec<usize>], sink: &mut Sink) {
        for (i, joint) in self.joints.iter().enumerate() {
            if !chains.iter().any(|chain| chain.contains(&i)) {
                let title = format!("joint `{}` is not used", joint.name.value);
                let help = format!("let a leg start with it (first_joint = \"{}\"), or remove it", joint.name.value);
                sink.report(Code::Unused, title, &joint.name.span, "part of no leg", help);
            }
        }
        for (actuator, _) in &self.actuators {
            let drives = |j: &RawJoint| j.actuator.as_ref().is_some_and(|a| a.value == actuator.value);
            if !self.joints.iter().any(drives) {
                let title = format!("actuator `{}` is not used", actuator.value);
                let help = format!("let a joint have actuator = \"{}\", or remove it", actuator.value);
                sink.report(Code::Unused, title, &actuator.span, "drives no joint", help);
            }
        }
    }

    /// The plain values, if every part could be read.
    fn build(
        &self,
        platform: usize,
        chains: &[Vec<usize>],
        sink: &mut Sink,
    ) -> Option<(Platform, Vec<Leg>, Vec<LegPlaces>)> {
        let Some(Body::Platform(platform, extent_at)) = &self.links.get(platform)?.1 else {
            return None;
        };
        let mut legs = Vec::new();
        let mut places = Vec::new();
        for (leg, chain) in self.legs.iter().zip(chains) {
            let mount = leg.mount.as_ref()?;
            let segments: Option<Vec<Segment>> = chain.iter().map(|&j| self.segment(j)).collect();
            legs.push(Leg { name: leg.name.value.clone(), mount: mount.value, chain: segments?, locked: Vec::new() });
            places.push(LegPlaces { name: leg.name.span.clone(), mount: mount.span.clone() });
        }
        check_reach(platform, &legs, extent_at, sink);
        Some((platform.clone(), legs, places))
    }

    fn segment(&self, joint: usize) -> Option<Segment> {
        let raw = &self.joints[joint];
        let actuator = raw.actuator.as_ref()?;
        let actuator = self.actuators.iter().find(|(name, _)| name.value == actuator.value)?.1.clone()?;
        let (name, axis) = (raw.name.value.clone(), raw.axis.value);
        let joint = Joint { name, axis, range: raw.range?, spring: raw.spring?, friction: raw.friction?, actuator };
        Some(Segment { joint, link: self.link(&raw.child.as_ref()?.value)?.clone() })
    }

    fn link(&self, name: &str) -> Option<&Link> {
        match self.links.iter().find(|(link, _)| link.value == name)? {
            (_, Some(Body::Link(link))) => Some(link),
            _ => None,
        }
    }
}

/// Every foot must reach out of the platform's extent: else that lies under the ground on which the foot stands.
fn check_reach(platform: &Platform, legs: &[Leg], at: &Span, sink: &mut Sink) {
    let Some(extent) = &platform.extent else { return };
    for leg in legs {
        let length: f64 = leg.chain.iter().map(|s| s.link.end.iter().map(|x| x * x).sum::<f64>().sqrt()).sum();
        let depth = |k: usize| 0.5 * extent.size[k] - (leg.mount[k] - extent.centre[k]).abs();
        let depth = (0..3).map(depth).fold(f64::INFINITY, f64::min);
        if depth > length {
            let title = format!("the foot of leg `{}` does not reach out of the platform's extent", leg.name);
            let help = format!(
                "the leg is {length:.4} m long and starts {depth:.4} m inside the box: sizes are whole edges, in m, and the \
                 centre is in the frame of the mounts"
            );
            sink.report(Code::ExtentHidesLeg, title, at, "a box around the whole leg", help);
            return;
        }
    }
}

/// Reports a name that does not exist; false also for one that could not be read.
fn resolves(name: Option<&At<String>>, what: &str, known: &[&str], sink: &mut Sink) -> bool {
    let Some(name) = name else { return false };
    if known.contains(&name.value.as_str()) {
        return true;
    }
    let help = match (nearest(&name.value, known.iter().copied()), known) {
        (Some(near), _) => format!("did you mean \"{near}\"?"),
        (None, []) => format!("describe it: [{what}s.{}]", name.value),
        (None, _) => format!("write one of {}, or describe it: [{what}s.{}]", known.join(", "), name.value),
    };
    let title = format!("there is no {what} `{}`", name.value);
    sink.report(Code::UnknownName, title, &name.span, format!("no such {what}"), help);
    false
}
