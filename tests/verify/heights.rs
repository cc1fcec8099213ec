//! Heights of everything but feet: what the optimizer's kernel gives against the verifier's geometry.

use crate::motions::Random;
use piaffe::certificate::certify;
use piaffe::gaits::GAITS;
use piaffe::model::{Description, Gait, Mode};
use piaffe::motion::Motion;
use piaffe::verify::heights::{Arms, alike};
use piaffe::verify::{instants::State, numbers::Numbers, support::Support, verify};

/// The rows of a gait, and the heights of all points, in a posture.
fn heights(gait: &dyn Gait, leg: usize, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let d = gait.description();
    let shape = &d.shapes.stance.heights;
    let mut kernel = vec![f64::NAN; shape.len];
    gait.heights(Mode::Stance(leg), q, &mut kernel);
    let kernel = shape.heights.of(&kernel).to_vec();
    let mut support = Support::new(d, leg);
    let mut state = State { q: q.to_vec(), ..State::new(d) };
    support.accelerate(&state.q, &state.qd, &mut state.qdd).expect("f1 does not vanish");
    support.complete(&mut state);
    (kernel, state.heights)
}

#[test]
fn kernel_and_verifier_agree_and_no_point_is_lower_than_all_rows() {
    for gait in GAITS.iter().copied() {
        let d = gait.description();
        let mut random = Random::new(11);
        for leg in (0..50).map(|k| k % 2) {
            let q = random.list(d.orientations(), 1.3);
            let (rows, all) = heights(gait, leg, &q);
            for (row, point) in rows.iter().zip(d.lowest) {
                assert!((row - all[*point]).abs() < 1e-14, "{}: {}", d.key, d.points[*point].name);
            }
            let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
            assert!((least(&rows) - least(&all)).abs() < 1e-14, "{}: {rows:?} {all:?}", d.key);
        }
    }
}

#[test]
fn points_that_are_taken_for_one_are_at_one_height() {
    for gait in GAITS {
        let d = gait.description();
        let (numbers, alike) = (Numbers::new(d), alike(d));
        assert!(alike.iter().enumerate().any(|(k, first)| *first < k), "{}: no point is like another", d.key);
        let mut random = Random::new(12);
        for leg in (0..20).map(|k| k % 2) {
            let q = random.list(d.orientations(), 1.3);
            let still = vec![0.0; q.len()];
            let mut support = Support::new(d, leg);
            support.multibody.set(&q, &still, &still);
            let rise = |k: usize| Arms::new(d, &numbers, &d.points[k]).rise(&support.multibody);
            for (k, first) in alike.iter().enumerate() {
                assert!((rise(k) - rise(*first)).abs() < 1e-14, "{} {}", d.points[k].name, d.points[*first].name);
            }
        }
    }
}

/// What bounded the A1 at its platform's centre alone took for least torque at 0.6 m/s: its knees are 0.2 m deep.
#[test]
fn a_motion_with_knees_under_the_ground_is_refused_by_their_name() {
    let phases = serde_json::from_str(include_str!("../fixtures/knees_under_ground.json")).unwrap();
    let motion = Motion { phases };
    let d = GAITS.iter().map(|gait| gait.description()).find(|d| d.key == "a1/bound").unwrap();
    let worst = verify(d, &motion, 0.6, 1001).unwrap().worst.unwrap();
    assert!(worst.constraint.starts_with("height of ") && worst.constraint.contains("calf"), "{worst:?}");
    assert!((worst.margin * d.leg_length() + 0.2).abs() < 1e-3, "{worst:?}");
    let certificate = certify(d, &motion, 0.6).unwrap();
    let gap = certificate.gaps.iter().find(|gap| gap.constraint == worst.constraint).unwrap();
    assert!(gap.violated && !certificate.is_certified(), "{gap:?}");
    // It is nothing else that is wrong with it.
    let free = Description { points: &[], lowest: &[], ..d.clone() };
    let receipt = verify(&free, &motion, 0.6, 1001).unwrap();
    assert!(receipt.max_violation < 1e-6 && receipt.cycle_error < 1e-6, "{receipt:?}");
}
