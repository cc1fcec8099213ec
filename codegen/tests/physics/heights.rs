//! What stays above the ground, point by point on the real robot: joints of all legs and corners of the platform.

use super::common::{Derived, specification};
use super::numbers::assert_close;
use super::robots::Draws;
use super::state::State;
use piaffe_codegen::dynamics::lowest;
use piaffe_codegen::mechanism::{Mechanism, levers, other_leg, points};
use piaffe_codegen::spec::{Axis, Extent, Gait, Robot, Rotation, Then};

type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn height(a: &Matrix, v: &[f64; 3]) -> f64 {
    (0..3).map(|k| a[1][k] * v[k]).sum()
}

fn turn(axis: usize, angle: f64) -> Matrix {
    let (sin, cos) = angle.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = [[0.0; 3]; 3];
    (m[axis][axis], m[j][j], m[k][k], m[k][j], m[j][k]) = (1.0, cos, cos, sin, -sin);
    m
}

/// Heights of everything but feet of the robot as it is, locked joints and all, over the virtual foot of `leg`.
fn real(robot: &Robot, gait: &Gait, q: &[f64], leg: usize) -> Vec<f64> {
    let joints = q.len() - usize::from(gait.rotation != Rotation::None);
    let platform = match gait.rotation {
        Rotation::None => turn(2, 0.0),
        Rotation::Pitch => turn(2, q[joints]),
        Rotation::Roll => turn(0, q[joints]),
    };
    let corners = robot.platform.extent.iter().flat_map(Extent::corners);
    let mut heights: Vec<f64> = corners.map(|corner| height(&platform, &corner)).collect();
    let mut feet = Vec::new();
    let mut first = 0;
    for (k, members) in gait.virtual_legs.iter().enumerate() {
        let mut next = first;
        for member in members {
            let real = &robot.legs[*member];
            let (mut axes, mut at) = (platform, height(&platform, &real.mount));
            next = first;
            for segment in &real.chain {
                heights.push(at);
                let locked = gait.locked.iter().find(|(name, _)| *name == segment.joint.name);
                let angle = locked.map_or_else(|| q[next], |(_, angle)| *angle);
                next += usize::from(locked.is_none());
                axes = times(&axes, &turn(segment.joint.axis.index(), angle));
                at += height(&axes, &segment.link.end);
            }
            if k == leg {
                feet.push(at);
            }
        }
        first = next;
    }
    let foot = feet.iter().sum::<f64>() / feet.len() as f64;
    heights.iter().map(|height| height - foot).collect()
}

/// The state after the legs have exchanged roles.
fn exchanged(m: &Mechanism, q: &[f64]) -> Vec<f64> {
    let [a, b] = m.legs.each_ref().map(|leg| leg.joints.clone());
    let rolls = m.rotation == Rotation::Roll;
    let sign = |j: usize| {
        let turned = |axis: Axis| axis != Axis::Pitch;
        if rolls && m.bodies.iter().any(|x| x.coordinate == Some(j) && turned(x.axis)) { -1.0 } else { 1.0 }
    };
    let mut all: Vec<f64> = b.chain(a).map(|j| sign(j) * q[j]).collect();
    all.extend(q[m.joints.len()..].iter().map(|theta| if rolls { -theta } else { *theta }));
    all
}

fn compare(robot: &Robot, gait: &Gait, draws: &mut Draws) {
    let mut d = Derived::new(&Mechanism::new(&robot.locked(&gait.locked).unwrap(), gait));
    let rows = lowest(&mut d.model);
    let m = d.mechanism();
    for leg in 0..2 {
        for _ in 0..8 {
            let s = State::random(m, draws);
            let found = d.run(&format!("heights{}", leg + 1), &[&s.q]);
            let mut expected = real(robot, gait, &s.q, leg);
            if gait.phases.then == Then::Mirrored {
                expected.extend(real(robot, gait, &exchanged(m, &s.q), other_leg(leg)));
            }
            let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
            assert_close("lowest", &[least(found.get("heights"))], &[least(&expected)], 1e-12);
            for height in found.get("heights") {
                assert!(expected.iter().any(|e| (e - height).abs() < 1e-12), "{height} is of no point");
            }
        }
    }
    assert!(rows.len() <= points(m).len() && rows.windows(2).all(|pair| pair[0] < pair[1]));
}

/// A box that is like no other on any side.
fn boxed(robot: &mut Robot, draws: &mut Draws) {
    let [size, centre] = [[0.02, 0.4], [-0.1, 0.1]].map(|[low, high]| [(); 3].map(|()| draws.between(low, high)));
    robot.platform.extent = Some(Extent { size, centre });
}

pub fn of_random(robot: &Robot, gait: &Gait, draws: &mut Draws) {
    compare(robot, gait, draws);
    let mut robot = robot.clone();
    boxed(&mut robot, draws);
    compare(&robot, gait, draws);
}

#[test]
fn of_the_shipped_robots_with_boxes_and_locked_joints() {
    let mut draws = Draws::new((0..400).map(|k| (k as f64 * 0.618_033_988_749_895).fract()).collect());
    for key in super::common::GAITS {
        let (robot, gait) = specification(key);
        of_random(&robot, &gait, &mut draws);
    }
    // Ankles held still: the foot is what they carry, and they are above it.
    let (mut robot, mut gait) = specification("rabbit/walk");
    for leg in &mut robot.legs {
        let mut foot = leg.chain[1].clone();
        foot.joint.name = "ankle".into();
        foot.link.end = [0.1, -0.03, 0.0];
        leg.chain.push(foot);
    }
    gait.locked = vec![("ankle".into(), 0.2)];
    of_random(&robot, &gait, &mut draws);
}

#[test]
fn rows_are_few() {
    let count = |key: &str, size: Option<[f64; 3]>| {
        let (mut robot, gait) = specification(key);
        robot.platform.extent = size.map(|size| Extent { size, centre: [0.0; 3] });
        let mut d = Derived::new(&Mechanism::new(&robot.locked(&gait.locked).unwrap(), &gait));
        lowest(&mut d.model).len()
    };
    // Two knees; of a level platform one height is the lowest, of a turning one as many as its silhouette has corners.
    assert_eq!(["trot", "amble", "curvet"].map(|key| count(key, None)), [3, 4, 4]);
    assert_eq!(["rabbit/walk", "a1/bound"].map(|key| count(key, None)), [3, 4]);
    // A box that hides the mounts, seen from the side, and one beyond which they stand out.
    assert_eq!(["trot", "amble", "curvet"].map(|key| count(key, Some([0.5, 0.1, 0.4]))), [3, 6, 6]);
    assert_eq!(count("curvet", Some([0.3, 0.1, 0.4])), 8);
}

#[test]
fn a_box_is_a_lever() {
    let (mut robot, gait) = specification("curvet");
    robot.platform.extent = Some(Extent { size: [0.4, 0.1, 0.3], centre: [0.0, 0.02, 0.0] });
    let all = levers(&robot, &gait);
    let slopes = |name: &str| -> Vec<f64> {
        let lever = all.iter().find(|lever| lever.name == name).unwrap_or_else(|| panic!("no lever {name}"));
        lever.slopes.iter().map(|(_, slope)| *slope).collect()
    };
    let halves = slopes("links.platform.extent.size.y");
    assert!(halves.len() == 8 && halves.iter().all(|slope| slope.abs() == 0.5), "{halves:?}");
    assert_eq!(slopes("links.platform.extent.centre.y"), [1.0; 8]);
    assert_eq!(slopes("limits.body_clearance"), [1.0]);
}
