//! The links of a URDF as bodies that move against each other: links on fixed and locked joints are part of
//! the body that carries them.

use super::{ImportError, Options, Rigid, axes};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use urdf_rs::{JointType, Pose, Robot};

/// The bodies, parents before children; the first one is the root.
pub struct Tree {
    pub bodies: Vec<Body>,
    /// What was made of the file, a sentence each.
    pub notes: Vec<String>,
    /// Joints with damping or friction.
    damped: usize,
}

/// What moves as one.
pub struct Body {
    /// Name of the link on which the joint acts.
    pub name: String,
    pub parent: Option<usize>,
    /// `None` for the root.
    pub joint: Option<Joint>,
    /// Its joint, all joints at zero, in the specification's axes from the root's origin, m.
    pub origin: Vector3<f64>,
    pub rigid: Rigid,
    /// Links that it carries on fixed joints: name and place, m.
    pub carried: Vec<(String, Vector3<f64>)>,
}

/// A joint that moves, in the specification's sense of rotation.
pub struct Joint {
    pub name: String,
    /// 0, 1, 2: roll, yaw, pitch.
    pub axis: usize,
    /// −1 where the specification's angle is the negative of URDF's.
    pub sign: f64,
    pub range: [f64; 2],
    /// N·m and rad/s at the joint.
    pub effort: f64,
    pub velocity: f64,
}

impl Tree {
    pub fn new(robot: &Robot, options: &Options) -> Result<Tree, ImportError> {
        let names: BTreeMap<&str, usize> = robot.links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
        if names.len() < robot.links.len() {
            return Err(ImportError::NotATree("two links have the same name".into()));
        }
        if let Some(lock) = options.locked.iter().find(|l| robot.joints.iter().all(|j| j.name != **l)) {
            return Err(ImportError::NoSuchJoint(lock.clone()));
        }
        let mut above: Vec<Option<usize>> = vec![None; robot.links.len()];
        for (k, joint) in robot.joints.iter().enumerate() {
            for link in [&joint.parent.link, &joint.child.link] {
                if !names.contains_key(link.as_str()) {
                    return Err(ImportError::NoSuchLink { joint: joint.name.clone(), link: link.clone() });
                }
            }
            if above[names[joint.child.link.as_str()]].replace(k).is_some() {
                return Err(ImportError::NotATree(format!("link `{}` hangs on two joints", joint.child.link)));
            }
        }
        let roots: Vec<&str> =
            robot.links.iter().zip(&above).filter(|(_, a)| a.is_none()).map(|(l, _)| l.name.as_str()).collect();
        let [root] = roots[..] else {
            return Err(ImportError::NotATree(format!("{} links hang on no joint: {}", roots.len(), roots.join(", "))));
        };
        let mut tree = Tree { bodies: Vec::new(), notes: Vec::new(), damped: 0 };
        tree.bodies.push(Body::new(root, None, None, Vector3::zeros()));
        let placed = tree.add(robot, options, &names, names[root], 0, &Isometry3::identity())?;
        if placed < robot.links.len() {
            return Err(ImportError::NotATree("some links hang on each other in a circle".into()));
        }
        if tree.damped > 0 {
            tree.notes.push(format!("damping and friction are dropped, of {} joints", tree.damped));
        }
        Ok(tree)
    }

    /// Adds a link, and all that hangs on it, to `body`; returns how many links these are.
    fn add(
        &mut self,
        robot: &Robot,
        options: &Options,
        names: &BTreeMap<&str, usize>,
        link: usize,
        body: usize,
        at: &Isometry3<f64>,
    ) -> Result<usize, ImportError> {
        let link = &robot.links[link];
        self.bodies[body].rigid = self.bodies[body].rigid.with(&rigid(link, at)?);
        let mut placed = 1;
        for joint in robot.joints.iter().filter(|j| j.parent.link == link.name) {
            let child = names[joint.child.link.as_str()];
            let frame = at * isometry(&joint.origin);
            let locked = options.locked.contains(&joint.name);
            let rides = is_free(&joint.joint_type) && body == 0 && self.bodies[0].rigid.mass == 0.0;
            if locked && moves(&joint.joint_type) {
                let angle = 0.0f64.max(joint.limit.lower).min(joint.limit.upper.max(joint.limit.lower));
                let angle = if joint.joint_type == JointType::Continuous { 0.0 } else { angle };
                self.notes.push(format!("`{}` is locked at {angle} rad (URDF's angle)", joint.name));
                let axis = nalgebra::Unit::try_new(Vector3::from(*joint.axis.xyz), 1e-9).unwrap_or(Vector3::x_axis());
                let frame = frame * UnitQuaternion::from_axis_angle(&axis, angle);
                placed += self.add(robot, options, names, child, body, &frame)?;
            } else if locked || rides || joint.joint_type == JointType::Fixed {
                if joint.joint_type != JointType::Fixed {
                    self.notes.push(format!("`{}` ({:?}) is taken as fixed", joint.name, joint.joint_type));
                }
                let place = axes() * frame.translation.vector;
                self.bodies[body].carried.push((joint.child.link.clone(), place));
                placed += self.add(robot, options, names, child, body, &frame)?;
            } else {
                let moving = self.joint(joint, &frame)?;
                self.bodies.push(Body::new(
                    &joint.child.link,
                    Some(body),
                    Some(moving),
                    axes() * frame.translation.vector,
                ));
                let next = self.bodies.len() - 1;
                placed += self.add(robot, options, names, child, next, &frame)?;
            }
        }
        Ok(placed)
    }

    fn joint(&mut self, joint: &urdf_rs::Joint, frame: &Isometry3<f64>) -> Result<Joint, ImportError> {
        let name = joint.name.clone();
        if !moves(&joint.joint_type) {
            return Err(ImportError::NotRevolute {
                joint: name,
                kind: format!("{:?}", joint.joint_type).to_lowercase(),
            });
        }
        if joint.mimic.is_some() {
            return Err(ImportError::Mimic(name));
        }
        let direction = (axes() * (frame.rotation * Vector3::from(*joint.axis.xyz))).normalize();
        let Some(axis) = (0..3).find(|k| direction[*k].abs() > 1.0 - 1e-6) else {
            return Err(ImportError::ObliqueAxis { joint: name, axis: direction.into() });
        };
        let sign = direction[axis].signum();
        let limit = &joint.limit;
        for (what, value) in [("effort", limit.effort), ("velocity", limit.velocity)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ImportError::NoLimit { joint: name, what });
            }
        }
        let turn = std::f64::consts::TAU;
        let range = if joint.joint_type == JointType::Continuous {
            self.notes.push(format!("`{name}` is continuous: it may turn once to either side"));
            [-turn, turn]
        } else {
            if limit.lower >= limit.upper {
                return Err(ImportError::NoLimit { joint: name, what: "range (lower < upper)" });
            }
            if limit.lower < -turn || limit.upper > turn {
                self.notes.push(format!("the range of `{name}` is cut to one turn to either side"));
            }
            [limit.lower.max(-turn), limit.upper.min(turn)]
        };
        let range = if sign < 0.0 { [0.0 - range[1], 0.0 - range[0]] } else { range };
        if joint.dynamics.as_ref().is_some_and(|d| d.damping != 0.0 || d.friction != 0.0) {
            self.damped += 1;
        }
        Ok(Joint { name, axis, sign, range, effort: limit.effort, velocity: limit.velocity })
    }
}

impl Body {
    fn new(name: &str, parent: Option<usize>, joint: Option<Joint>, origin: Vector3<f64>) -> Body {
        Body { name: name.into(), parent, joint, origin, rigid: Rigid::NOTHING, carried: Vec::new() }
    }
}

fn moves(kind: &JointType) -> bool {
    matches!(kind, JointType::Revolute | JointType::Continuous)
}

/// Joints by which a model is put into a world.
fn is_free(kind: &JointType) -> bool {
    matches!(kind, JointType::Floating | JointType::Planar)
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z] = *pose.xyz;
    let [roll, pitch, yaw] = *pose.rpy;
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

/// The link's own mass, in the specification's axes from the root's origin.
fn rigid(link: &urdf_rs::Link, at: &Isometry3<f64>) -> Result<Rigid, ImportError> {
    let inertial = &link.inertial;
    let i = &inertial.inertia;
    let numbers = [inertial.mass.value, i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz];
    let named = ["mass", "ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    if let Some((_, what)) = numbers.iter().zip(named).find(|(x, _)| !x.is_finite()) {
        return Err(ImportError::NotFinite(what, link.name.clone()));
    }
    let frame = at * isometry(&inertial.origin);
    let rotation = axes() * frame.rotation.to_rotation_matrix().matrix();
    let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    Ok(Rigid {
        mass: inertial.mass.value,
        com: axes() * frame.translation.vector,
        inertia: rotation * tensor * rotation.transpose(),
    })
}
