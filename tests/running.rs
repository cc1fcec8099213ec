//! Gaits that fly, of robots that are read from their files: from a seed alone to optima that an independent solver knows, with
//! receipts and proofs.

use piaffe::Robot;
use piaffe::certificate::certify;
use piaffe::model::{Gait, Mode};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::verify::verify;
use std::path::PathBuf;

fn folder(robot: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("runs").join(robot)
}

fn optimum(gait: &dyn Gait, criterion: Criterion, speed: f64, starts: usize) -> (f64, Motion) {
    let settings = Settings { starts: Some(starts), ..Settings::default() };
    let local = &search(gait, criterion, speed, &settings, &|_| {}).optima[0].local;
    (local.costs.of(criterion), local.motion.clone())
}

/// Optima of an independent solver (collocation in another program), which err high by up to a thousandth.
const KNOWN: [(&str, &str, Criterion, f64, f64); 5] = [
    ("quadruped", "running_trot", Criterion::Torque, 1.0, 94.1803),
    ("quadruped", "running_trot", Criterion::Energy, 1.0, 34.4013),
    ("quadruped", "bound", Criterion::Torque, 0.6, 305.8271),
    ("quadruped", "bound_two_flights", Criterion::Torque, 0.6, 281.6664),
    ("rabbit", "run", Criterion::Torque, 1.0, 2267.1419),
];

#[test]
fn runs_are_found_from_a_seed_alone_and_proven() {
    for (robot, name, criterion, speed, known) in KNOWN {
        let gait = Robot::read(folder(robot)).unwrap().gait(name).unwrap();
        let d = gait.description();
        let (cost, motion) = optimum(&gait, criterion, speed, 6);
        assert!(cost <= 1.002 * known, "{name} {criterion:?} at {speed} m/s: {cost}, known is {known}");
        let receipt = verify(d, &motion, speed, 2001).unwrap();
        assert!(receipt.max_violation < 1e-6 && receipt.cycle_error < 1e-6, "{name}: {receipt:?}");
        assert!((receipt.costs.of(criterion) / cost - 1.0).abs() < 1e-5, "{name}: {cost} {:?}", receipt.costs);
        let certificate = certify(d, &motion, speed).unwrap();
        assert!(certificate.is_certified(), "{name}: {:?}", certificate.gaps);
        // No foot is on the ground in flight, and nothing but its shortest duration keeps it from being shorter.
        for (phase, half_step) in d.phases.iter().zip(&motion.half_steps).filter(|(p, _)| p.mode == Mode::Flight) {
            assert!(half_step.duration >= phase.duration[0] * (1.0 - 1e-9));
        }
    }
}

/// Faster than the walking trot can be: 1.09 m/s.
#[test]
fn a_running_trot_is_faster_than_a_walking_one() {
    let gait = Robot::read(folder("quadruped")).unwrap().gait("running_trot").unwrap();
    let (cost, motion) = optimum(&gait, Criterion::Torque, 1.9, 6);
    assert!(cost <= 1.002 * 291.3254, "{cost}");
    assert!(verify(gait.description(), &motion, 1.9, 2001).unwrap().max_violation < 1e-6);
}

#[test]
fn robots_that_run_are_those_that_walk() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    for (walks, runs) in [("model-spec", "quadruped"), ("model-spec/rabbit", "rabbit"), ("model-spec/a1", "a1")] {
        // But for the path of the schema.
        let text = |folder: PathBuf| {
            let text = std::fs::read_to_string(folder.join("robot.toml")).unwrap();
            text.lines()
                .filter(|line| !line.starts_with("#:schema"))
                .map(|line| format!("{line}\n"))
                .collect::<String>()
        };
        assert_eq!(text(root.join(walks)), text(folder(runs)), "{runs}");
        let robot = Robot::read(folder(runs)).unwrap();
        for name in robot.gaits() {
            assert!(robot.gait(&name).unwrap().description().has(Mode::Flight), "{name}");
        }
    }
}
