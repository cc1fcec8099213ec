//! What a gait makes of a robot: joints held still, legs that mirror each other.

use super::common::Derived;
use super::numbers::assert_close;
use super::robots::{BUILDS, Build, DRAWS, Draws, mirrored, specification};
use super::state::State;
use super::support::prescribed;
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::spec::{Axis, Rotation, Tilted};

fn draws() -> Draws {
    Draws::new((0..DRAWS).map(|k| (k as f64 * 0.754_877_666_246_693).fract()).collect())
}

fn build(name: &str) -> &'static Build {
    &BUILDS.iter().find(|(n, _)| *n == name).unwrap().1
}

/// The reduced model of eq. 6 knows no p: with joint `k` of every leg locked it has the entries of the free
/// robot's that belong to the other coordinates, at rest in joint `k`.
fn locked_is_at_rest(of: &str, k: usize) {
    let mut draws = draws();
    // One real leg each: those of a pair are not mounted at one place, which matters once they are part of the platform.
    let (robot, gait) = specification(&Build { members: 1, ..*build(of) }, &mut draws);
    let angle = 0.4;
    let locked = robot.locked(&[(format!("joint{k}"), angle)]).unwrap();
    let (free, locked) = (Mechanism::new(&robot, &gait), Mechanism::new(&locked, &gait));
    let s = State::random(&free, &mut draws);
    let held: Vec<usize> = free.legs.iter().map(|leg| leg.joints.start + k).collect();
    let others: Vec<usize> = (0..s.q.len()).filter(|j| !held.contains(j)).collect();
    let (mut q, mut qd) = (s.q.clone(), s.qd.clone());
    for j in &held {
        (q[*j], qd[*j]) = (angle, 0.0);
    }
    let pick = |v: &[f64]| -> Vec<f64> { others.iter().map(|j| v[*j]).collect() };
    let (free, locked) = (Derived::new(&free), Derived::new(&locked));
    for leg in ["1", "2"] {
        let all = free.run(&format!("reduced{leg}"), &[&q, &qd]);
        let rest = locked.run(&format!("reduced{leg}"), &[&pick(&q), &pick(&qd)]);
        let inertia: Vec<f64> =
            others.iter().flat_map(|i| pick(&all.get("a")[i * q.len()..(i + 1) * q.len()])).collect();
        assert_close("Aq", rest.get("a"), &inertia, 1e-11);
        assert_close("Hq", rest.get("h"), &pick(all.get("h")), 1e-11);
    }
}

#[test]
fn a_locked_joint_is_one_at_rest() {
    for k in 0..3 {
        locked_is_at_rest("crooked on three links", k);
    }
    locked_is_at_rest("amble on three links", 1);
}

#[test]
fn a_locked_joint_must_not_tilt_others() {
    let (robot, _) = specification(build("amble with hips that abduct"), &mut draws());
    let lock = |angle| robot.locked(&[("joint0".to_string(), angle)]);
    assert_eq!(lock(0.1), Err(Tilted { joint: "joint1".into(), reversed: false }));
    assert!(lock(0.0).is_ok_and(|r| r.legs.iter().all(|leg| leg.chain.len() == 2)));
}

/// In the mirror the other leg stands; turns about axes in the mirror's plane change their signs.
#[test]
fn a_rolling_robot_and_its_mirror_image_obey_one_law() {
    let crooked = Build { axes: [&[Axis::Roll, Axis::Pitch]; 2], members: 1, ..*build("crooked amble") };
    let mut draws = draws();
    let (mut robot, gait) = specification(&crooked, &mut draws);
    robot.legs[1] = mirrored(&robot.legs[0]);
    robot.platform.com[2] = 0.0;
    let m = Mechanism::new(&robot, &gait);
    assert_eq!(m.rotation, Rotation::Roll);
    let (s, d) = (State::random(&m, &mut draws), Derived::new(&m));
    let n = m.joints.len();
    let sign =
        |j: usize| if m.bodies.iter().any(|b| b.coordinate == Some(j) && b.axis != Axis::Pitch) { -1.0 } else { 1.0 };
    let swap = |q: &[f64]| -> Vec<f64> {
        (0..q.len()).map(|j| if j < n { sign(j) * q[(j + n / 2) % n] } else { -q[j] }).collect()
    };
    let one = d.run("inverse1", &[&s.q, &s.qd, &prescribed(&m, &s.qdd)]);
    let two = d.run("inverse2", &[&swap(&s.q), &swap(&s.qd), &prescribed(&m, &swap(&s.qdd))]);
    let gamma = one.get("gamma");
    assert_close("Γ", two.get("gamma"), &swap(gamma), 1e-10);
    let f = one.get("f");
    assert_close("F", two.get("f"), &[f[0], f[1], -f[2]], 1e-10);
}
