//! The links of a file as bodies that move against each other: links on fixed and held joints are part of the body that
//! carries them. In the specification's axes: x forward, y up, z to the right.

use super::Rigid;
use super::fault::{Faults, Kind};
use super::model::{Kind as Joint, Mass, Model, Shape};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// The bodies, parents before children; the first one is the root.
#[derive(Debug)]
pub struct Tree {
    pub bodies: Vec<Body>,
}

/// What moves as one.
#[derive(Debug)]
pub struct Body {
    /// The link on which the joint acts.
    pub link: usize,
    pub parent: Option<usize>,
    /// `None` for the root.
    pub joint: Option<Moving>,
    /// Its joint, all joints at zero, from the root's origin, m.
    pub origin: Vector3<f64>,
    pub rigid: Rigid,
    /// Links that it carries, its own first, with what of them can touch the ground.
    pub carried: Vec<Carried>,
}

/// A link on a body: its frame and shapes in the specification's axes from the root's origin.
#[derive(Debug)]
pub struct Carried {
    pub link: usize,
    pub frame: Isometry3<f64>,
    pub shapes: Vec<Shape>,
}

/// A joint that moves.
#[derive(Debug)]
pub struct Moving {
    pub joint: usize,
    /// Of unit length.
    pub axis: Vector3<f64>,
}

/// An axis no longer than this, in the file's numbers, points nowhere.
const NO_AXIS: f64 = 1e-9;

/// Joints that are held, by their index, at angles of the file, rad or m.
pub type Held = BTreeMap<usize, f64>;

/// Which links hang on which: the root, and the joints below every link.
pub struct Skeleton {
    pub root: usize,
    pub below: Vec<Vec<usize>>,
}

impl Skeleton {
    /// Checks that the links form one tree.
    pub fn new(model: &Model, faults: &mut Faults) -> Option<Skeleton> {
        let mut above: Vec<Option<usize>> = vec![None; model.links.len()];
        let mut below = vec![Vec::new(); model.links.len()];
        for (k, joint) in model.joints.iter().enumerate() {
            if let Some(first) = above[joint.child].replace(k) {
                let what = format!(
                    "link `{}` hangs on this joint and on `{}`",
                    model.links[joint.child].name, model.joints[first].name
                );
                let remedy = "let each link be the child of one joint: a loop of links cannot be described";
                faults.add(Kind::Loop, Some(&joint.place), what, remedy);
                continue;
            }
            below[joint.parent].push(k);
            if (joint.turns() || joint.slides) && joint.axis.norm() < NO_AXIS {
                let what = "its axis has no direction: it is 0 0 0";
                faults.add(Kind::Joint, Some(&joint.place), what, "write its axis, or make it fixed");
            }
        }
        let roots: Vec<usize> = (0..model.links.len()).filter(|l| above[*l].is_none()).collect();
        // Links that nothing hangs on and that hang on nothing are left over from editing.
        let used: Vec<usize> = roots.iter().copied().filter(|l| !below[*l].is_empty()).collect();
        let root = match used[..] {
            [root] => root,
            [] if model.links.is_empty() => {
                faults.add(Kind::NotATree, None, "the file has no <link>", "give the URDF of a whole robot");
                return None;
            }
            [] => {
                let place = &model.links[0].place;
                let remedy = "let one link, the trunk, be no joint's child";
                faults.add(Kind::NotATree, Some(place), "no link is the root: there is no joint, or a circle", remedy);
                return None;
            }
            ref several => {
                let names: Vec<String> = several.iter().map(|l| format!("`{}`", model.links[*l].name)).collect();
                let what = format!("{} links carry others and hang on no joint: {}", names.len(), names.join(", "));
                let place = &model.links[several[1]].place;
                faults.add(Kind::NotATree, Some(place), what, "put them on one trunk with joints of type fixed");
                return None;
            }
        };
        let mut seen = vec![false; model.links.len()];
        let mut open = vec![root];
        while let Some(link) = open.pop() {
            seen[link] = true;
            open.extend(below[link].iter().map(|j| model.joints[*j].child));
        }
        let alone = |l: usize| above[l].is_none() && below[l].is_empty();
        if let Some(link) = (0..seen.len()).find(|l| !seen[*l] && !alone(*l)) {
            let place = &model.links[link].place;
            let what = "this link hangs on itself, over others";
            faults.add(Kind::NotATree, Some(place), what, "let the chain begin at the trunk");
            return None;
        }
        faults.is_empty().then(|| Skeleton { root: trunk(model, &below, root), below })
    }
}

/// The robot's own root: a world on which it moves freely is no part of it.
fn trunk(model: &Model, below: &[Vec<usize>], root: usize) -> usize {
    match below[root][..] {
        [only] if model.joints[only].kind == Joint::Free => trunk(model, below, model.joints[only].child),
        _ => root,
    }
}

impl Tree {
    /// `axes` turns from the file's axes to the specification's. Joints of a kind that cannot move are taken as fixed.
    pub fn new(model: &Model, skeleton: &Skeleton, held: &Held, axes: &UnitQuaternion<f64>) -> Tree {
        let mut tree = Tree { bodies: vec![Body::new(skeleton.root, None, None, Vector3::zeros())] };
        let start = Isometry3::from_parts(Translation3::identity(), *axes);
        let mut open = vec![(skeleton.root, 0, start)];
        while let Some((link, body, frame)) = open.pop() {
            tree.bodies[body].take(model, link, &frame);
            let mut next = Vec::new();
            for index in &skeleton.below[link] {
                let joint = &model.joints[*index];
                let at = frame * joint.frame;
                let axis = Unit::try_new(joint.axis, NO_AXIS);
                let moved = |by: f64| match axis {
                    None => Isometry3::identity(),
                    Some(axis) if joint.slides => Translation3::from(axis.into_inner() * by).into(),
                    Some(axis) => {
                        Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, by))
                    }
                };
                let offset = Translation3::from(joint.offset);
                next.push(match (held.get(index), axis) {
                    (None, Some(axis)) if joint.turns() => {
                        let moving = Moving { joint: *index, axis: at.rotation * axis.into_inner() };
                        tree.bodies.push(Body::new(joint.child, Some(body), Some(moving), at.translation.vector));
                        (joint.child, tree.bodies.len() - 1, at * offset)
                    }
                    (by, _) => (joint.child, body, at * moved(by.copied().unwrap_or(0.0)) * offset),
                });
            }
            next.reverse();
            open.extend(next);
        }
        tree
    }

    /// The bodies that hang on a body.
    pub fn below(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.bodies.len()).filter(move |b| self.bodies[*b].parent == Some(body))
    }

    /// The bodies from the root's child down to this one.
    pub fn path(&self, body: usize) -> Vec<usize> {
        let mut path = Vec::new();
        let mut here = body;
        while let Some(parent) = self.bodies[here].parent {
            path.push(here);
            here = parent;
        }
        path.reverse();
        path
    }
}

impl Body {
    fn new(link: usize, parent: Option<usize>, joint: Option<Moving>, origin: Vector3<f64>) -> Body {
        Body { link, parent, joint, origin, rigid: Rigid::NOTHING, carried: Vec::new() }
    }

    fn take(&mut self, model: &Model, link: usize, frame: &Isometry3<f64>) {
        let source = &model.links[link];
        for mass in &source.masses {
            let at = Mass { frame: frame * mass.frame, ..*mass };
            self.rigid = self.rigid.with(&at.rigid());
        }
        let shapes = source.shapes.iter().map(|s| Shape { frame: frame * s.frame, solid: s.solid });
        self.carried.push(Carried { link, frame: *frame, shapes: shapes.collect() });
    }
}
