//! Where a leg touches the ground: a point that was given, the bottom of what its foot is made of, or a foot's own frame.

use super::model::{Model, Shape, Solid};
use super::robot::PITCH;
use super::tree::{Body, Carried, Tree};
use super::words::{fits, is_foot};
use super::{FootPoint, Options, nearest_axis};
use nalgebra::{Point3, Vector3};

/// A point foot.
#[derive(Clone, Debug)]
pub struct Foot {
    /// From the root's origin, all joints at zero, in the specification's axes, m.
    pub point: Vector3<f64>,
    pub link: usize,
    pub how: How,
}

/// What the point of a foot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum How {
    Given,
    /// The lowest point of something round, of this radius, m.
    Round(f64),
    /// The middle of a sole, or the point of it that is nearest below the ankle.
    Sole,
    Origin,
}

impl How {
    pub fn words(self) -> String {
        match self {
            How::Given => "the point that was given of".into(),
            How::Round(radius) => {
                format!("the bottom of a round foot of {:.0} mm (that it rolls is neglected) on", radius * 1e3)
            }
            How::Sole => "a point of the sole of".into(),
            How::Origin => "the origin of".into(),
        }
    }
}

/// The foot on a body, if anything tells of one.
pub fn find(model: &Model, tree: &Tree, body: usize, options: &Options) -> Option<Foot> {
    let ankle = is_ankle(tree, body);
    let body = &tree.bodies[body];
    let name = |c: &Carried| model.links[c.link].name.as_str();
    let touching = |links: &[&Carried]| touching(links, &body.origin, ankle);
    for carried in &body.carried {
        if let Some(given) = given(options, name(carried)) {
            return match given.point {
                Some(point) => {
                    let point = (carried.frame * Point3::from(point)).coords;
                    Some(Foot { point, link: carried.link, how: How::Given })
                }
                None => touching(&[carried]).or_else(|| lowest_origin(&[carried])),
            };
        }
    }
    let feet: Vec<&Carried> = body.carried.iter().filter(|c| is_foot(name(c))).collect();
    let own = body.carried.first().map(|c| c.link);
    // A foot that turns on the joint itself says nothing by its origin.
    let apart: Vec<&Carried> = feet.iter().copied().filter(|c| Some(c.link) != own).collect();
    let rest: Vec<&Carried> = body.carried.iter().filter(|c| Some(c.link) != own && !is_sensor(name(c))).collect();
    touching(&feet)
        .or_else(|| lowest_origin(&apart))
        .or_else(|| touching(&body.carried.iter().collect::<Vec<_>>()))
        .or_else(|| lowest_origin(&rest))
        .or_else(|| lowest_origin(&feet))
}

/// What is given of the foot on a link; of several the last one.
pub fn given<'o>(options: &'o Options, link: &str) -> Option<&'o FootPoint> {
    options.feet.iter().rev().find(|foot| fits(&foot.link, link))
}

/// Whether a body hangs on the third joint that swings it, or a further one: what is below two of them is laid flat on the ground.
fn is_ankle(tree: &Tree, body: usize) -> bool {
    let joints = tree.path(body).into_iter().filter_map(|b| tree.bodies[b].joint.as_ref());
    joints.filter(|joint| nearest_axis(&joint.axis).0 == PITCH).count() > 2
}

/// Whether the contact is round and turns about the joint itself, as a wheel does.
pub fn is_wheel(model: &Model, body: &Body, axis: &Vector3<f64>) -> bool {
    let shapes = body.carried.iter().flat_map(|c| &c.shapes);
    let named = model.links[body.link].name.to_lowercase().contains("wheel");
    let centred = |shape: &Shape| {
        let radius = match shape.solid {
            Solid::Cylinder { radius, .. } | Solid::Sphere { radius } => radius,
            _ => return false,
        };
        let lever = shape.frame.translation.vector - body.origin;
        let along = axis * lever.dot(axis);
        (lever - along).norm() < 0.2 * radius
    };
    named || (axis.z.abs() > 0.9 && shapes.into_iter().any(centred))
}

fn is_sensor(name: &str) -> bool {
    let name = name.to_lowercase();
    ["imu", "sensor", "camera", "lidar", "marker", "gyro", "accel"].iter().any(|word| name.contains(word))
}

fn lowest_origin(links: &[&Carried]) -> Option<Foot> {
    let lowest = links.iter().min_by(|a, b| a.frame.translation.y.total_cmp(&b.frame.translation.y))?;
    Some(Foot { point: lowest.frame.translation.vector, link: lowest.link, how: How::Origin })
}

/// The lowest point of what these links are made of; the middle where several are equally low.
fn touching(links: &[&Carried], joint: &Vector3<f64>, ankle: bool) -> Option<Foot> {
    let mut points: Vec<Foot> = Vec::new();
    for carried in links {
        points.extend(carried.shapes.iter().map(|shape| {
            let (point, how) = bottom(shape, joint, ankle);
            Foot { point, link: carried.link, how }
        }));
    }
    let lowest = points.iter().min_by(|a, b| a.point.y.total_cmp(&b.point.y))?.clone();
    let level = LEVEL * (lowest.point - joint).norm();
    let equal: Vec<&Foot> = points.iter().filter(|f| f.point.y - lowest.point.y <= level).collect();
    if equal.len() == 1 {
        return Some(lowest);
    }
    let mut point = equal.iter().fold(Vector3::zeros(), |sum, f| sum + f.point) / equal.len() as f64;
    point.y = lowest.point.y;
    Some(Foot { point, how: How::Sole, ..lowest })
}

/// Points are equally low that differ by less than this share of their distance from the joint.
const LEVEL: f64 = 0.02;
/// Cosine or sine of the half right angle that parts what stands from what lies, a little more than that: 0.7.
const STEEP: f64 = 0.7;

/// The point of a shape on which a leg stands that points from its joint to the shape; below an `ankle`, of a shape as it lies.
fn bottom(shape: &Shape, joint: &Vector3<f64>, ankle: bool) -> (Vector3<f64>, How) {
    let centre = shape.frame.translation.vector;
    let down = -Vector3::y();
    // In the sagittal plane, along the leg: with the knee bent, a foot stands on a part of it nearer to the leg's line
    // than to what is lowest where all joints are at zero.
    let along = |point: Vector3<f64>, radius: f64| {
        let lever = Vector3::new(point.x - joint.x, point.y - joint.y, 0.0);
        let flat = ankle && -lever.y < STEEP * lever.norm();
        if lever.norm() > radius && !flat { lever.normalize() } else { down }
    };
    let axis = shape.frame.rotation * Vector3::z();
    match shape.solid {
        Solid::Sphere { radius } => (centre + along(centre, radius) * radius, How::Round(radius)),
        // It rolls across.
        Solid::Capsule { radius, .. } | Solid::Cylinder { radius, .. } if axis.z.abs() > STEEP => {
            (centre + along(centre, radius) * radius, How::Round(radius))
        }
        Solid::Cylinder { half, .. } if axis.y.abs() > STEEP => (centre - axis * (half * axis.y.signum()), How::Sole),
        Solid::Capsule { radius, half } | Solid::Cylinder { radius, half } => {
            let ends = [centre + axis * half, centre - axis * half];
            let [near, far] = match (ends[0] - joint).norm() > (ends[1] - joint).norm() {
                true => [ends[1], ends[0]],
                false => ends,
            };
            // A limb begins at its joint; what lies below one otherwise, or below an ankle, is a sole.
            let begins_there = (near - joint).norm() < radius.max(LEVEL * half);
            if axis.y.abs() < STEEP && (ankle || !begins_there) {
                let below = (joint - centre).dot(&axis).clamp(-half.abs(), half.abs());
                return (centre + axis * below + down * radius, How::Sole);
            }
            match shape.solid {
                Solid::Capsule { .. } => (far + along(far, radius) * radius, How::Round(radius)),
                _ => (far, How::Sole),
            }
        }
        Solid::Ellipsoid { half } => {
            let towards = along(centre, half.iter().copied().fold(0.0, f64::max));
            // The point at which a plane across `towards` touches it.
            let within = shape.frame.rotation.inverse() * towards;
            let scaled = Vector3::from_fn(|k, _| half[k] * within[k]);
            let reach = scaled.norm();
            let point = Vector3::from_fn(|k, _| half[k] * scaled[k]) / reach.max(f64::MIN_POSITIVE);
            (centre + shape.frame.rotation * point, How::Round(reach))
        }
        Solid::Box { half } => {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|e| shape.frame.rotation * e);
            let face = (0..3).max_by(|a, b| axes[*a].y.abs().total_cmp(&axes[*b].y.abs())).unwrap_or(0);
            let mut point = centre;
            for (k, axis) in axes.iter().enumerate() {
                let reach = match k == face {
                    true => -half[k] * axis.y.signum(),
                    false => (joint - centre).dot(axis).clamp(-half[k].abs(), half[k].abs()),
                };
                point += axis * reach;
            }
            (point, How::Sole)
        }
    }
}
