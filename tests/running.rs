//! Gaits that fly: from a seed alone to optima that an independent solver knows, with receipts and proofs.

use piaffe::certificate::certify;
use piaffe::cycle::theta;
use piaffe::gaits::GAITS;
use piaffe::model::{FORWARD, Gait, Mode, UP};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::local::Task;
use piaffe::search::multi_start::{Settings, search};
use piaffe::search::relative::related;
use piaffe::sqp::Control;
use piaffe::verify::verify;
use piaffe::walk::Walk;

fn named(key: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == key).unwrap()
}

fn optimum(gait: &dyn Gait, criterion: Criterion, speed: f64, starts: usize) -> (f64, Motion) {
    let settings = Settings { starts: Some(starts), ..Settings::default() };
    let local = &search(gait, criterion, speed, &settings, &|_| {}).optima[0].local;
    (local.costs.of(criterion), local.motion.clone())
}

/// An optimum of an independent solver (collocation in another program); its values err high by up to a thousandth.
#[derive(serde::Deserialize)]
struct Known {
    gait: String,
    criterion: Criterion,
    speed: f64,
    value: f64,
}

fn known() -> Vec<Known> {
    serde_json::from_str(include_str!("fixtures/best_known_running.json")).unwrap()
}

/// Some of those that are soon found.
const SOME: [(&str, Criterion, f64); 6] = [
    ("running_trot", Criterion::Torque, 1.0),
    ("running_trot", Criterion::Energy, 1.0),
    // Faster than the walking trot can be: 1.09 m/s.
    ("running_trot", Criterion::Torque, 1.9),
    ("bound", Criterion::Torque, 0.6),
    ("bound_two_flights", Criterion::Torque, 0.6),
    ("rabbit/run", Criterion::Torque, 1.0),
];

/// The value that is known of one.
fn value(name: &str, criterion: Criterion, speed: f64) -> f64 {
    let is = |k: &Known| (k.gait.as_str(), k.criterion, k.speed) == (name, criterion, speed);
    known().into_iter().find(is).unwrap_or_else(|| panic!("nothing is known of {name} at {speed} m/s")).value
}

#[test]
fn runs_are_found_from_a_seed_alone_and_proven() {
    for (name, criterion, speed) in SOME {
        let (gait, known) = (named(name), value(name, criterion, speed));
        let d = gait.description();
        let (cost, motion) = optimum(gait, criterion, speed, 6);
        assert!(cost <= 1.002 * known, "{name} {criterion:?} at {speed} m/s: {cost}, known is {known}");
        let receipt = verify(d, &motion, speed, 2001).unwrap();
        assert!(receipt.max_violation < 1e-6 && receipt.cycle_error < 1e-6, "{name}: {receipt:?}");
        assert!((receipt.costs.of(criterion) / cost - 1.0).abs() < 1e-5, "{name}: {cost} {:?}", receipt.costs);
        let certificate = certify(d, &motion, speed).unwrap();
        assert!(certificate.is_certified(), "{name}: {:?}", certificate.gaps);
        in_flight_no_foot_touches(gait, &motion);
    }
}

/// At every speed at which an independent solver knows an optimum, with as many starts as the search asks for.
#[test]
#[ignore = "minutes"]
fn all_known_runs_are_found() {
    let mut missed = Vec::new();
    for Known { gait, criterion, speed, value } in known() {
        let result = Task { gait: named(&gait), criterion, speed }.search(&Settings::default(), &[], &|_| {});
        let cost = result.cost.unwrap_or(f64::INFINITY);
        let told = format!("{gait} {criterion:?} at {speed} m/s: {cost:.4}, known {value:.4}; {}", result.message);
        println!("{told}");
        if cost > 1.002 * value {
            missed.push(told);
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// All real feet are in the air but where a phase begins or ends.
fn in_flight_no_foot_touches(gait: &dyn Gait, motion: &Motion) {
    let walk = Walk::even(gait, motion, 40).unwrap();
    let d = walk.description;
    let inside = walk.moments.iter().filter(|m| m.mode == Mode::Flight && m.share > 0.0 && m.share < 1.0);
    let mut seen = 0;
    for m in inside {
        for (leg, member) in d.legs.iter().enumerate().flat_map(|(leg, l)| (0..l.members.len()).map(move |k| (leg, k)))
        {
            let height = m.chain(d, leg, member).last().unwrap()[UP];
            assert!(height > 0.0, "{}: a foot at {height} m, {} of the flight", d.key, m.share);
            seen += 1;
        }
    }
    assert!(seen > 0, "{} does not fly", d.key);
    // Nor does anything carry the mass centre.
    for (k, flight) in walk.phases.iter().enumerate().filter(|(_, phase)| phase.mode == Mode::Flight) {
        let moments: Vec<_> = walk.moments.iter().filter(|m| m.phase == k).collect();
        let [place, velocity] = moments[0].centre;
        for m in moments {
            let t = m.share * flight.duration;
            let falls = place[UP] + velocity[UP] * t - 0.5 * d.gravity * t * t;
            assert!((m.centre[0][UP] - falls).abs() < 1e-8 * d.leg_length(), "{}: {} {falls}", d.key, m.centre[0][UP]);
            assert!(
                (m.centre[1][FORWARD] - velocity[FORWARD]).abs() < 1e-6,
                "{}: {:?} {velocity:?}",
                d.key,
                m.centre[1]
            );
        }
    }
}

/// A walk and what runs in its steps lead to each other: from an optimum of one to that of the other, with no other start.
#[test]
fn an_optimum_of_a_walk_is_a_start_for_its_run_and_back() {
    let [walk, run, amble] = ["trot", "running_trot", "amble"].map(named);
    let [of_walk, of_run, of_amble] = [walk, run, amble].map(|gait| gait.description());
    let (cost, motion) = optimum(walk, Criterion::Torque, 1.0, 4);
    let follow = |gait, motion: &Motion| {
        let task = Task { gait, criterion: Criterion::Torque, speed: 1.0 };
        task.follow(&theta(motion), &mut |_| Control::Continue)
    };
    let running = follow(run, &related(of_walk, &motion, of_run).unwrap());
    assert!(
        running.status.is_optimal() && running.costs.torque <= 1.002 * value("running_trot", Criterion::Torque, 1.0),
        "{:?}",
        running.costs
    );
    let walking = follow(walk, &related(of_run, &running.motion, of_walk).unwrap());
    assert!(
        walking.status.is_optimal() && (walking.costs.torque / cost - 1.0).abs() < 1e-6,
        "{:?} {cost}",
        walking.costs
    );
    // Both ways and nothing is lost; other legs are no relatives.
    let there = related(of_walk, &motion, of_run).unwrap();
    assert_eq!(related(of_run, &there, of_walk), Some(motion.clone()));
    assert_eq!(related(of_walk, &motion, of_amble), None);
}
