//! Which chains of a robot are its legs, and what is held still: a leg is what can reach the ground.
//!
//! Starting from the joints that a person holds, one proposal after another holds more of them, until what moves are legs.

use super::fault::{Faults, Kind};
use super::foot::{self, Foot};
use super::model::{Kind as JointKind, Model};
use super::tree::{Body, Held, Skeleton, Tree};
use super::words::{fits, is_leg, is_of_foreleg, is_other_limb, short_list};
use super::{Options, nearest_axis};
use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use piaffe_model::digits::digits;
use std::collections::{BTreeMap, BTreeSet};

/// The share of the greatest depth that a leg must reach.
const DEPTH: f64 = 0.7;
/// Joints of a chain beyond which it is no leg, and takes long.
const LONGEST: usize = 12;
/// A foot is in the middle that is not farther from it than this share of the others.
const MIDDLE: f64 = 0.05;
/// Feet on either side of the middle are farther apart than this share of the depth.
const ASTRIDE: f64 = 0.04;
/// Places are one that are no farther apart than this share of the depth.
const ONE_PLACE: f64 = 0.02;
/// Whoever stands on arms has them no higher than this share of the depth, all joints at zero.
const STANDS: f64 = 0.15;
/// Feet of one leg are not farther apart than this share of the depth.
const ONE_LEG: f64 = 0.35;

/// The legs on their tree.
pub struct Limbs {
    pub tree: Tree,
    pub legs: Vec<Limb>,
    /// Chains of legs, also of those without a foot.
    pub chains: Vec<Vec<usize>>,
    /// How far they reach below and above their mounts, m.
    pub reach: Vec<[f64; 2]>,
    pub notes: Vec<String>,
}

/// A chain of bodies from the platform to a foot.
pub struct Limb {
    /// Indices into the tree's bodies.
    pub chain: Vec<usize>,
    pub foot: Foot,
}

/// Joints to hold, and why.
struct Proposal {
    joints: BTreeSet<usize>,
    why: String,
}

pub fn find(
    model: &Model,
    skeleton: &Skeleton,
    options: &Options,
    axes: &UnitQuaternion<f64>,
    faults: &mut Faults,
) -> Limbs {
    let mut search = Search { model, skeleton, options, notes: Vec::new(), held: Held::new() };
    search.hold_what_is_given(faults);
    // Each round holds at least one joint more.
    loop {
        let tree = Tree::new(model, skeleton, &search.held, axes);
        let parts = search.split(&tree);
        let proposals = search.propose(&tree, &parts);
        if proposals.is_empty() {
            return search.settle(tree, parts.legs, faults);
        }
        proposals.into_iter().for_each(|proposal| search.hold(proposal));
    }
}

struct Search<'m> {
    model: &'m Model,
    skeleton: &'m Skeleton,
    options: &'m Options,
    held: Held,
    notes: Vec<String>,
}

impl Search<'_> {
    fn hold_what_is_given(&mut self, faults: &mut Faults) {
        for lock in &self.options.locks {
            let (pattern, subtree) = match lock.pattern.strip_suffix('/') {
                Some(pattern) => (pattern, true),
                None => (lock.pattern.as_str(), false),
            };
            let matched: Vec<usize> =
                (0..self.model.joints.len()).filter(|j| fits(pattern, &self.model.joints[*j].name)).collect();
            if !matched.is_empty() && matched.iter().all(|j| self.model.joints[*j].kind == JointKind::Fixed) && !subtree
            {
                self.notes.push(format!("--lock {} changes nothing: the joint is fixed in the file", lock.pattern));
            }
            let mut all = matched.clone();
            if subtree {
                let mut open: Vec<usize> = matched.iter().map(|j| self.model.joints[*j].child).collect();
                while let Some(link) = open.pop() {
                    all.extend(&self.skeleton.below[link]);
                    open.extend(self.skeleton.below[link].iter().map(|j| self.model.joints[*j].child));
                }
            }
            for index in all {
                let joint = &self.model.joints[index];
                let angle = lock.angle.filter(|_| matched.contains(&index));
                if let (Some(angle), false) = (angle, joint.has_angle() || joint.kind == JointKind::Fixed) {
                    let what = format!("--lock {}={}: one number does not say where it is", joint.name, digits(angle));
                    let remedy = format!("write --lock {}", joint.name);
                    faults.add(Kind::Option, Some(&joint.place), what, remedy);
                }
                if joint.kind == JointKind::Fixed {
                    continue;
                }
                if let (Some(angle), Some([low, high])) = (angle, joint.range)
                    && (joint.slides || joint.kind == JointKind::Revolute)
                    && !(low..=high).contains(&angle)
                {
                    let [at, first, last] = [angle, low, high].map(digits);
                    let unit = joint.unit();
                    let what = format!("--lock {}={at}: its stops are at {first} and {last} {unit}", joint.name);
                    let remedy =
                        format!("write --lock {}={}", joint.name, digits(angle.clamp(low.min(high), high.max(low))));
                    faults.add(Kind::Option, Some(&joint.place), what, remedy);
                }
                let angle = angle.unwrap_or(joint.at_rest());
                self.held.insert(index, angle);
                let (name, angle, unit) = (&joint.name, digits(angle), joint.unit());
                let of = if joint.slides { "place" } else { "angle" };
                self.notes.push(match joint.has_angle() {
                    true => format!("`{name}` is held at {angle} {unit} (the file's {of}), as you say"),
                    false => format!("`{name}` is held as it is in the file, as you say"),
                });
            }
        }
    }

    fn hold(&mut self, proposal: Proposal) {
        let names: Vec<String> = proposal.joints.iter().map(|j| format!("`{}`", self.model.joints[*j].name)).collect();
        let angles: Vec<f64> = proposal.joints.iter().map(|j| self.model.joints[*j].at_rest()).collect();
        let unit = proposal.joints.first().map_or("rad", |j| self.model.joints[*j].unit());
        let at = match angles.iter().all(|a| *a == 0.0) {
            true => format!("0 {unit}"),
            false => format!("{angles:.4?} {unit}"),
        };
        let are = if names.len() == 1 { "is" } else { "are" };
        self.notes.push(format!("{} {are} held at {at}: {}", short_list(&names), proposal.why));
        for (joint, angle) in proposal.joints.iter().zip(angles) {
            self.held.insert(*joint, angle);
        }
    }

    /// What to hold next; nothing where all that moves are legs.
    fn propose(&self, tree: &Tree, parts: &Parts) -> Vec<Proposal> {
        let limbs = self.other_limbs(tree, parts);
        if !limbs.is_empty() {
            return limbs;
        }
        let legs = &parts.legs[..];
        self.joint_to_the_world(tree)
            .or_else(|| self.one_foot(tree, legs))
            .or_else(|| self.waist(tree, legs))
            .or_else(|| self.wheel(tree, legs))
            .or_else(|| self.no_lever(tree, legs))
            .or_else(|| self.massless(tree, legs))
            .or_else(|| self.oblique(tree, legs))
            .or_else(|| self.off_zero(tree, legs))
            .into_iter()
            .collect()
    }

    fn one(&self, joint: usize, why: impl Into<String>) -> Option<Proposal> {
        Some(Proposal { joints: BTreeSet::from([joint]), why: why.into() })
    }

    /// A single joint on a root without mass puts the robot into its world.
    fn joint_to_the_world(&self, tree: &Tree) -> Option<Proposal> {
        let below: Vec<usize> = tree.below(0).collect();
        let ([only], true) = (&below[..], tree.bodies[0].rigid.mass <= 0.0) else { return None };
        let joint = tree.bodies[*only].joint.as_ref()?.joint;
        self.one(joint, "it puts the robot into a world")
    }

    /// The ends of all chains, with how deep they reach.
    fn tips(&self, tree: &Tree) -> Vec<Tip> {
        let mut carries = vec![false; tree.bodies.len()];
        for parent in tree.bodies.iter().filter_map(|b| b.parent) {
            carries[parent] = true;
        }
        let ends = (1..tree.bodies.len()).filter(|b| !carries[*b]);
        ends.map(|body| {
            let path = tree.path(body);
            let point = self.contact(tree, body);
            let depth = self.depth(tree, &path, &point, 1.0);
            Tip { body, mount: tree.bodies[path[0]].origin, path, point, depth }
        })
        .collect()
    }

    /// The foot of a body, or what comes nearest to one.
    fn contact(&self, tree: &Tree, body: usize) -> Vector3<f64> {
        let Body { rigid, origin, .. } = &tree.bodies[body];
        let fallback = if rigid.mass > 0.0 { rigid.com } else { *origin };
        self.foot(tree, body).map_or(fallback, |f| f.point)
    }

    fn foot(&self, tree: &Tree, body: usize) -> Option<Foot> {
        foot::find(self.model, tree, body, self.options)
    }

    /// The lowest height that the end of a chain reaches within the joints' stops, m; turned over (`up` −1) minus the highest one.
    fn depth(&self, tree: &Tree, path: &[usize], point: &Vector3<f64>, up: f64) -> f64 {
        if path.len() > LONGEST {
            return up * point.y;
        }
        let stops: Vec<[f64; 2]> = path.iter().map(|b| self.stops(&tree.bodies[*b])).collect();
        let height = |angles: &[f64]| {
            let mut at = *point;
            for (b, angle) in path.iter().zip(angles).rev() {
                let body = &tree.bodies[*b];
                if let Some(joint) = &body.joint {
                    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(joint.axis), *angle);
                    at = body.origin + turn * (at - body.origin);
                }
            }
            up * at.y
        };
        let mut best = f64::INFINITY;
        for share in [None, Some(0.5), Some(0.2), Some(0.8)] {
            let mut angles: Vec<f64> = stops
                .iter()
                .map(|[low, high]| match share {
                    None => 0.0f64.clamp(*low, *high),
                    Some(share) => low + share * (high - low),
                })
                .collect();
            for _ in 0..3 {
                for k in 0..angles.len() {
                    let [low, high] = stops[k];
                    let tries = (0..=8).map(|n| low + (high - low) * f64::from(n) / 8.0);
                    let here = angles[k];
                    let mut of = |angle: f64| {
                        angles[k] = angle;
                        (angle, height(&angles))
                    };
                    let now = of(here);
                    let found = tries.map(&mut of).fold(now, |a, b| if b.1 < a.1 { b } else { a });
                    angles[k] = found.0;
                    best = best.min(found.1);
                }
            }
        }
        best.min(up * point.y)
    }

    fn stops(&self, body: &Body) -> [f64; 2] {
        let half = std::f64::consts::PI;
        let Some(joint) = &body.joint else { return [0.0; 2] };
        let joint = &self.model.joints[joint.joint];
        match joint.range {
            Some([low, high]) if joint.kind == JointKind::Revolute && low < high => [low.max(-half), high.min(half)],
            _ => [-half, half],
        }
        .map(|x| x.clamp(-half, half))
    }

    /// Names of the links and joints of a chain below what it shares with others.
    fn names(&self, tree: &Tree, tip: &Tip) -> Vec<&str> {
        let mut names = Vec::new();
        for b in &tip.path {
            let body = &tree.bodies[*b];
            names.extend(body.carried.iter().map(|c| self.model.links[c.link].name.as_str()));
            names.extend(body.joint.iter().map(|j| self.model.joints[j.joint].name.as_str()));
        }
        names
    }

    fn is_given(&self, tree: &Tree, tip: &Tip) -> bool {
        let body = &tree.bodies[tip.body];
        let named = |link: usize| self.options.feet.iter().any(|f| fits(&f.link, &self.model.links[link].name));
        body.carried.iter().any(|c| named(c.link))
    }

    /// The ends of legs, and those of other limbs with why they are none.
    fn split(&self, tree: &Tree) -> Parts {
        let tips = self.tips(tree);
        let top = tips.iter().map(|t| t.mount.y).fold(f64::NEG_INFINITY, f64::max);
        let ground = tips.iter().map(|t| t.depth).fold(f64::INFINITY, f64::min);
        let reaches = |tip: &Tip| top - tip.depth >= DEPTH * (top - ground);
        // Arms that stand on the ground beside legs are legs, whatever their bones are called.
        let called = |tip: &Tip| self.names(tree, tip).iter().any(|name| is_leg(name));
        let sole = tips.iter().filter(|tip| called(tip)).map(|tip| tip.point.y).fold(f64::INFINITY, f64::min);
        let stands = |tip: &Tip| tip.point.y - sole <= STANDS * (tip.mount.y - sole);
        let (mut legs, mut others) = (Vec::new(), Vec::new());
        for tip in tips {
            let names = self.names(tree, &tip);
            let foreleg = names.iter().any(|name| is_of_foreleg(name)) && sole.is_finite() && stands(&tip);
            let called = foreleg || called(&tip);
            if self.is_given(tree, &tip) {
                legs.push((tip, true));
            } else if !reaches(&tip) {
                others.push((tip, "does not reach the ground"));
            } else if !called && names.iter().any(|name| is_other_limb(name)) {
                others.push((tip, "is called otherwise"));
            } else {
                legs.push((tip, called));
            }
        }
        if legs.iter().filter(|(_, called)| *called).count() >= 2 {
            let (yes, no): (Vec<_>, Vec<_>) = legs.into_iter().partition(|(_, called)| *called);
            legs = yes;
            others.extend(no.into_iter().map(|(tip, _)| (tip, "is not called one, as others are")));
        }
        let mut legs: Vec<Tip> = legs.into_iter().map(|(tip, _)| tip).collect();
        // Legs come in pairs: a limb in the middle is none.
        let width = legs.iter().map(|t| t.point.z.abs()).fold(0.0, f64::max);
        let middle: Vec<usize> = (0..legs.len()).filter(|k| legs[*k].point.z.abs() < MIDDLE * width).collect();
        if let ([only], true) = (&middle[..], legs.len() > 2)
            && !self.is_given(tree, &legs[*only])
        {
            others.push((legs.remove(*only), "has no counterpart on the other side"));
        }
        Parts { legs, others }
    }

    /// What leads to no leg, limb by limb.
    fn other_limbs(&self, tree: &Tree, parts: &Parts) -> Vec<Proposal> {
        let needed: BTreeSet<usize> = parts.legs.iter().flat_map(|t| &t.path).copied().collect();
        let mut limbs: BTreeMap<usize, Proposal> = BTreeMap::new();
        for (tip, why) in &parts.others {
            let Some(root) = tip.path.iter().find(|b| !needed.contains(b)) else { continue };
            let why = format!(
                "this limb is no leg, for it {why} (--foot LINK makes one of it, --lock JOINT=ANGLE holds it elsewhere)"
            );
            let limb = limbs.entry(*root).or_insert_with(|| Proposal { joints: BTreeSet::new(), why });
            let spare = tip.path.iter().filter(|b| !needed.contains(b));
            limb.joints.extend(spare.filter_map(|b| tree.bodies[*b].joint.as_ref()).map(|j| j.joint));
        }
        limbs.into_values().collect()
    }

    /// Two ends of one leg: what leads to the higher one is held.
    fn one_foot(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        let scale = depth_of(legs);
        for (k, a) in legs.iter().enumerate() {
            for b in &legs[..k] {
                // Legs that part below a waist have their feet on either side.
                let sides = a.point.z * b.point.z < 0.0 && (a.point.z - b.point.z).abs() > ASTRIDE * scale;
                if a.path[0] != b.path[0] || sides || (a.point - b.point).norm() > ONE_LEG * scale {
                    continue;
                }
                let (kept, other) = if (a.point.y, a.path.len()) < (b.point.y, b.path.len()) { (a, b) } else { (b, a) };
                let spare = other.path.iter().filter(|body| !kept.path.contains(body));
                let joints = spare.filter_map(|b| tree.bodies[*b].joint.as_ref()).map(|j| j.joint).collect();
                return Some(Proposal { joints, why: "the leg has another end that is lower".into() });
            }
        }
        None
    }

    /// Joints above the place where two legs part.
    fn waist(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        for (k, a) in legs.iter().enumerate() {
            for b in &legs[..k] {
                let shared: BTreeSet<usize> = a.path.iter().filter(|body| b.path.contains(body)).copied().collect();
                if !shared.is_empty() {
                    let joints = shared.iter().filter_map(|b| tree.bodies[*b].joint.as_ref()).map(|j| j.joint);
                    let why = "legs part below it, and the platform is one body (a waist)".into();
                    return Some(Proposal { joints: joints.collect(), why });
                }
            }
        }
        None
    }

    fn wheel(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        legs.iter().filter(|tip| tip.path.len() > 2).find_map(|tip| {
            let body = &tree.bodies[tip.body];
            let joint = body.joint.as_ref()?;
            if !foot::is_wheel(self.model, body, &joint.axis) {
                return None;
            }
            self.one(joint.joint, "it turns a wheel, which stands with its brake on")
        })
    }

    /// A last joint that does not move the foot.
    fn no_lever(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        let scale = depth_of(legs);
        legs.iter().filter(|tip| tip.path.len() > 1).find_map(|tip| {
            let body = &tree.bodies[tip.body];
            let lever = tip.point - body.origin;
            self.foot(tree, tip.body)?;
            let short = lever.x.hypot(lever.y) < 1e-3 * scale;
            short.then(|| self.one(body.joint.as_ref()?.joint, "the foot is where it turns")).flatten()
        })
    }

    /// A link without mass between two joints: one of them is held if it leaves the plane.
    fn massless(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        for tip in legs {
            for (k, b) in tip.path.iter().enumerate() {
                let body = &tree.bodies[*b];
                if body.rigid.mass > 0.0 {
                    continue;
                }
                let below = tip.path.get(k + 1).and_then(|b| tree.bodies[*b].joint.as_ref());
                let aside = |joint: &super::tree::Moving| nearest_axis(&joint.axis).0 != 2;
                let candidates = [body.joint.as_ref(), below];
                let chosen = candidates.into_iter().flatten().find(|joint| aside(joint));
                let last = if below.is_none() && tip.path.len() > 2 { body.joint.as_ref() } else { None };
                if let Some(joint) = chosen.or(last) {
                    let name = &self.model.links[body.link].name;
                    return self
                        .one(joint.joint, format!("`{name}` has no mass, and what has none cannot move by itself"));
                }
            }
        }
        None
    }

    /// A joint about an oblique axis, where the leg swings without it.
    fn oblique(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        for tip in legs {
            let joints: Vec<_> = tip.path.iter().filter_map(|b| tree.bodies[*b].joint.as_ref()).collect();
            let straight = |axis: &Vector3<f64>| nearest_axis(axis).2 <= super::ROUNDED;
            let pitch = joints.iter().filter(|j| nearest_axis(&j.axis).0 == 2 && straight(&j.axis)).count();
            if let Some(joint) = joints.iter().find(|j| !straight(&j.axis))
                && pitch >= 2
            {
                return self.one(joint.joint, "its axis is oblique to the trunk's");
            }
        }
        None
    }

    /// A joint that slides, and is at zero at none of its places, where no leg hangs on it.
    fn off_zero(&self, tree: &Tree, legs: &[Tip]) -> Option<Proposal> {
        let slides = |index: &usize| {
            let joint = &self.model.joints[*index];
            let free = joint.slides && joint.at_rest() != 0.0 && !self.held.contains_key(index);
            free && self.carried(tree, legs, joint.child) == 0
        };
        let joint = (0..self.model.joints.len()).find(slides)?;
        self.one(
            joint,
            "no leg hangs on it, and its stops leave it no place nearer to 0 (--lock JOINT=PLACE holds it elsewhere)",
        )
    }

    /// How many legs hang on a link.
    fn carried(&self, tree: &Tree, tips: &[Tip], link: usize) -> usize {
        let mut below = BTreeSet::new();
        let mut open = vec![link];
        while let Some(link) = open.pop() {
            below.insert(link);
            open.extend(self.skeleton.below[link].iter().map(|j| self.model.joints[*j].child));
        }
        let hangs = |tip: &&Tip| {
            let foot = || self.foot(tree, tip.body).is_some_and(|foot| below.contains(&foot.link));
            below.contains(&tree.bodies[tip.body].link) || foot()
        };
        tips.iter().filter(hangs).count()
    }

    /// The legs, and what is in their way.
    fn settle(mut self, tree: Tree, tips: Vec<Tip>, faults: &mut Faults) -> Limbs {
        self.no_loops(&tree, &tips, faults);
        self.other_kinds(&tree, &tips, faults);
        let mut legs = Vec::new();
        let chains = tips.iter().map(|tip| tip.path.clone()).collect();
        let reach = |tip: &Tip| {
            let top = -self.depth(&tree, &tip.path, &tip.point, -1.0);
            [tip.mount.y - tip.depth, top - tip.mount.y]
        };
        let reach = tips.iter().map(reach).collect();
        for tip in tips {
            let link = &self.model.links[tree.bodies[tip.body].link];
            if let Some(foot) = self.foot(&tree, tip.body) {
                legs.push(Limb { chain: tip.path, foot });
                continue;
            }
            let first = tip.path.first().and_then(|b| tree.bodies[*b].joint.as_ref());
            let joint = first.map_or("JOINT", |j| &self.model.joints[j.joint].name);
            let remedy = format!(
                "give the point in its frame, m: --foot {}=x,y,z; or hold this limb if it is no leg: --lock {joint}/",
                link.name
            );
            let what = "no foot is on this link: nothing tells where it touches the ground";
            faults.add(Kind::NoFoot, Some(&link.place), what, remedy);
        }
        Limbs { tree, legs, chains, reach, notes: self.notes }
    }

    /// Chains that meet at their ends are linkages, whose last joint the file leaves out.
    fn no_loops(&self, tree: &Tree, tips: &[Tip], faults: &mut Faults) {
        let scale = depth_of(tips);
        for (k, a) in tips.iter().enumerate() {
            // Legs of a planar robot hang at one place too.
            let near = |p: Vector3<f64>, q: Vector3<f64>| (p - q).norm() < ONE_PLACE * scale;
            let meets = |b: &&Tip| near(a.point, b.point) && !near(a.mount, b.mount);
            for b in tips[..k].iter().filter(meets) {
                let [a, b] = [a, b].map(|t| &self.model.links[tree.bodies[t.body].link]);
                let what =
                    format!("its chain and that of `{}` end at one place: a loop that the file leaves open", b.name);
                let remedy = "take a file in which each leg is one chain: a linkage cannot be described";
                faults.add(Kind::Loop, Some(&a.place), what, remedy);
            }
        }
    }

    /// Joints that do not turn: above all legs or below none they are taken as fixed, on a leg they are faults.
    fn other_kinds(&mut self, tree: &Tree, tips: &[Tip], faults: &mut Faults) {
        let mut fixed: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (index, joint) in self.model.joints.iter().enumerate() {
            let mut remedy = format!("hold it still: --lock {}", joint.name);
            let mut what = match &joint.kind {
                JointKind::Fixed | JointKind::Revolute | JointKind::Continuous => continue,
                JointKind::Free => "it moves freely".to_string(),
                JointKind::Mimic => {
                    remedy += "; or take out what makes it follow, so that it has a motor of its own";
                    "it follows another joint (mimic)".to_string()
                }
                JointKind::Other(kind) => format!("it is {kind}"),
            };
            let carried = self.carried(tree, tips, joint.child);
            if self.held.contains_key(&index) {
                continue;
            }
            if carried == 0 || carried == tips.len() {
                if joint.kind == JointKind::Mimic {
                    what += ", and stays at 0 while that one moves (--lock JOINT=ANGLE holds it elsewhere)";
                }
                fixed.entry(what).or_default().push(format!("`{}`", joint.name));
            } else {
                let what = format!("{what}, and a leg hangs on it: legs have revolute joints");
                faults.add(Kind::Joint, Some(&joint.place), what, remedy);
            }
        }
        for (what, joints) in fixed {
            self.notes.push(format!("taken as fixed, for {what}: {}", short_list(&joints)));
        }
    }
}

/// What moves, sorted.
struct Parts {
    legs: Vec<Tip>,
    /// With why they are no legs.
    others: Vec<(Tip, &'static str)>,
}

/// The end of a chain.
struct Tip {
    body: usize,
    /// Bodies from the root's child down.
    path: Vec<usize>,
    mount: Vector3<f64>,
    point: Vector3<f64>,
    /// The lowest height that it reaches, m.
    depth: f64,
}

fn depth_of(legs: &[Tip]) -> f64 {
    let top = legs.iter().map(|t| t.mount.y).fold(f64::NEG_INFINITY, f64::max);
    let ground = legs.iter().map(|t| t.depth).fold(f64::INFINITY, f64::min);
    (top - ground).max(0.0)
}
