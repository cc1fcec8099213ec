//! Infeasible is said of motions, never of a criterion; and what is said of speeds holds when they are asked for.

use piaffe::altered::Altered;
use piaffe::audit::{Audit, Verdict};
use piaffe::cycle::AT_REST;
use piaffe::examine::Examination;
use piaffe::gaits::GAITS;
use piaffe::model::{Description, Gait};
use piaffe::motion::Criterion;
use piaffe::optimality::{KKT_RESIDUAL, optimality};
use piaffe::result::{GaitResult, Status};
use piaffe::search::atlas::sweep;
use piaffe::search::fastest::{maximum_speed, nearest_speed};
use piaffe::search::journal::Journal;
use piaffe::search::multi_start::{Settings, search};
use piaffe::verify::sample;
use piaffe_interpreter::Robot;
use serde_json::Value;
use std::path::Path;

fn named(name: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == name).unwrap()
}

fn altered(name: &str, change: impl FnOnce(&mut Description)) -> Altered<'static> {
    Altered::new(named(name), change).unwrap()
}

/// RABBIT with its knees the other way.
fn bird() -> Altered<'static> {
    altered("rabbit/walk", |d| {
        for j in 0..d.joints() {
            let [lo, hi] = d.joints[j].range;
            d.joints.to_mut()[j].range = [-hi, -lo];
        }
    })
}

fn optimize(gait: &dyn Gait, criterion: Criterion, speed: f64, settings: &Settings) -> GaitResult {
    let found = search(gait, criterion, speed, settings, &|_| {});
    GaitResult::new(gait, criterion, speed, &found, settings, || 0.0)
}

const FEW: Settings = Settings { starts: Some(8), seed: 1, examination: Examination::Full };

#[test]
fn whatever_is_minimized_a_bird_walks() {
    let bird = bird();
    let mut before = 0.0;
    // N; what smooth descents had found were 16.952, nothing, 19.073, nothing, nothing, 22.109.
    for (speed, energy) in
        [(0.39, 16.38396), (0.40, 16.83274), (0.42, 17.7522), (0.45, 19.1850), (0.48, 20.65417), (0.51, 22.1090)]
    {
        let least = Criterion::ALL.map(|criterion| {
            let result = optimize(&bird, criterion, speed, &FEW);
            assert_eq!(result.status, Status::Optimal, "{criterion:?} at {speed}: {}", result.message);
            let again = optimality(&bird, criterion, speed, &result.motion().unwrap()).unwrap();
            assert!(again.residual() < KKT_RESIDUAL, "{criterion:?} at {speed}: {again:?}");
            println!("{speed} {criterion:?} {:?}", result.cost);
            result.cost.unwrap()
        });
        assert!(least[0] > before, "{speed}: {} {before}", least[0]);
        assert!((least[0] / energy - 1.0).abs() < 1e-5, "{speed}: {}", least[0]);
        before = least[0];
        if speed == 0.40 {
            assert!((least[1] - 99.3840).abs() < 1e-3, "{}", least[1]);
        }
    }
}

#[test]
fn least_energy_holds_a_knee_still() {
    let (bird, speed) = (bird(), 0.40);
    let result = optimize(&bird, Criterion::Energy, speed, &FEW);
    let motion = result.motion().unwrap();
    let d = bird.description();
    let knee = (0..d.joints()).find(|j| !d.hangs_on_platform(*j)).unwrap();
    let fastest = |motion| {
        let samples = sample(d, motion, 201).unwrap();
        samples.iter().map(|s| s.qd[knee].abs()).fold(0.0, f64::max)
    };
    assert!(fastest(&motion) < AT_REST);
    // Near by are no better motions, and none that pass for an optimum.
    let mut moved = motion.clone();
    moved.phases[0].q_interior[0][knee] += 1e-3;
    assert!(fastest(&moved) > 1e-3);
    assert!(optimality(&bird, Criterion::Energy, speed, &moved).unwrap().residual() > 1e-3);
}

/// The slower a walk, the less its joints move, and the more of them rest for a whole phase: which ones, power tells.
#[test]
fn however_slow_a_walk_is_its_least_energy_is_found() {
    let few = Settings { starts: Some(2), seed: 1, ..Settings::default() };
    // N; the best that is known. Per metre it grows like 1/speed.
    for (name, speed, energy) in [
        ("curvet", 0.003, 3097.31),
        ("curvet", 0.01, 930.872),
        ("curvet", 0.05, 196.626),
        ("amble", 0.003, 2674.28),
        ("rabbit/walk", 0.003, 300.214),
        ("rabbit/walk", 0.05, 18.7592),
    ] {
        let result = optimize(named(name), Criterion::Energy, speed, &few);
        assert!(result.is_optimal(), "{name} at {speed}: {}", result.message);
        let cost = result.cost.unwrap();
        assert!(cost < energy * 1.00002, "{name} at {speed}: {cost}");
    }
    assert!(optimize(named("trot"), Criterion::Energy, 0.001, &few).is_optimal());
}

#[test]
fn where_there_are_no_motions_conflicts_are_named() {
    // Knees that lift no foot by 2 cm.
    let stiff = altered("rabbit/walk", |d| {
        for j in 0..d.joints() {
            if !d.hangs_on_platform(j) {
                d.joints.to_mut()[j].range = [-0.05, -0.03];
            }
        }
    });
    for criterion in Criterion::ALL {
        let result = optimize(&stiff, criterion, 0.6, &FEW);
        assert_eq!(result.status, Status::Infeasible, "{criterion:?}: {}", result.message);
        assert!(result.conflicts.iter().any(|c| c.violation > 1e-6), "{:?}", result.conflicts);
    }
}

#[test]
fn the_nearest_speed_works_when_it_is_asked_for() {
    for (name, criterion, speed) in [("trot", Criterion::Energy, 4.0), ("rabbit/walk", Criterion::Torque, 3.0)] {
        let gait = named(name);
        assert_eq!(optimize(gait, criterion, speed, &FEW).status, Status::Infeasible);
        let nearest = nearest_speed(gait, criterion, speed, &FEW).unwrap();
        assert!(nearest < speed && nearest > 0.2 * speed, "{name}: {nearest}");
        // As it is printed.
        let asked: f64 = nearest.to_string().parse().unwrap();
        assert!(optimize(gait, criterion, asked, &FEW).is_optimal(), "{name} at {asked}");
    }
}

/// Below the greatest speed of a gait whose nearest motions have several branches, of which the fastest is rarely met.
#[test]
fn the_nearest_speed_does_not_hang_on_how_far_off_the_question_is() {
    let cat = Robot::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/feasible/cat")).unwrap();
    let trot = cat.gait("trot").unwrap();
    for speed in [1.33, 1.36, 1.5, 3.0] {
        let nearest = nearest_speed(&trot, Criterion::Torque, speed, &Settings::default()).unwrap();
        assert!((1.31..1.33).contains(&nearest), "from {speed}: {nearest}");
    }
}

/// Nothing is known, nothing is kept.
struct Forgetful;

impl Journal for Forgetful {
    fn known(&self, _: &str) -> Option<Value> {
        None
    }
    fn record(&self, _: &str, _: Value) {}
    fn point(&self, _: &GaitResult) {}
    fn visited(&self, _: &dyn Gait, _: bool) {}
}

/// Where the fastest optimum that is known is as fast as any motion, what ends the gait is what stands against more.
#[test]
fn a_gait_that_is_known_up_to_its_end_ends_by_its_limits() {
    let gait = named("trot");
    let at = |speed: f64| optimize(gait, Criterion::Torque, speed, &FEW);
    let mut end = maximum_speed(gait, &[at(1.05)], &FEW, &Forgetful).unwrap();
    let (before, last) = (end.clone(), at(end.speed));
    assert!(last.is_optimal() && before.ended_by.iter().any(|limit| limit.contains("swing clearance")));
    assert!(end.optima(gait, &[Criterion::Torque], &[vec![last]], &FEW, &Forgetful).is_empty());
    assert_eq!((end.speed, end.ended_by), (before.speed, before.ended_by));
}

#[test]
fn a_sweep_has_no_holes_between_its_optima() {
    let (bird, speeds) = (bird(), [0.3, 0.35, 0.4, 0.45, 0.5]);
    let lines = sweep(
        &bird,
        &Criterion::ALL,
        &speeds,
        &Settings { starts: Some(1), seed: 1, ..Settings::default() },
        &Forgetful,
    );
    for result in lines.iter().flatten() {
        assert!(result.is_optimal(), "{:?} at {}: {}", result.criterion, result.speed, result.message);
    }
}

/// What no motion can do is said at once, with the numbers; what some motion does is never said to be impossible.
#[test]
fn limits_that_contradict_the_robot_need_no_search() {
    let least = |name: &str, share: f64| altered(name, |d| d.limits.min_vertical_force = share * d.weight());
    assert!(GAITS.iter().all(|gait| gait.description().contradictions().is_empty()));
    assert!(least("trot", 0.999).description().contradictions().is_empty());
    let heavy = least("trot", 1.001);
    let [contradiction] = &heavy.description().contradictions()[..] else { panic!("one") };
    assert_eq!((contradiction.limit, contradiction.most), ("limits.min_vertical_force", heavy.description().weight()));
    let result = optimize(&heavy, Criterion::Torque, 0.6, &FEW);
    assert_eq!((result.status, result.search.effort.starts), (Status::Infeasible, 0));
    assert!(result.message.contains("= 136.0") && result.message.contains("135.9 N"), "{}", result.message);
    assert_eq!(nearest_speed(&heavy, Criterion::Torque, 0.6, &FEW), None);
    // So it is no statement about a search, and who says otherwise is refuted.
    let audit = Audit::of(&result, &[&heavy]);
    let verdict = |entry: &str| audit.statements.iter().find(|s| s.entry == entry).map(|s| s.verdict);
    assert_eq!((verdict("status"), verdict("message")), (Some(Verdict::Confirmed), Some(Verdict::Confirmed)));
    let unsure = GaitResult { status: Status::NotConverged, ..result.clone() };
    assert!(audit.is_confirmed() && !Audit::of(&unsure, &[&heavy]).is_confirmed());
    // Who flies pushes harder while it stands: as much as flights may last and stances must.
    let run = least("running_trot", 1.3);
    assert_eq!(optimize(&run, Criterion::Torque, 1.0, &FEW).status, Status::Optimal);
    let longest = |d: &mut Description| d.phases.to_mut().iter_mut().for_each(|phase| phase.duration = [0.1, 0.2]);
    let most =
        |share: f64| altered("running_trot", |d| (longest(d), d.limits.min_vertical_force = share * d.weight()).1);
    assert!(most(2.999).description().contradictions().is_empty());
    assert_eq!(most(3.001).description().contradictions().len(), 1);
    // Nothing is higher above a foot than stretched legs are long.
    let reach = named("trot").description().leg_length();
    for share in [1.01, 3.01] {
        let limits = |d: &mut Description| {
            d.limits.min_platform_height = share * reach;
            d.limits.body_clearance = share * reach;
            d.limits.swing_clearance = share * reach;
        };
        let known = altered("trot", limits).description().contradictions();
        assert_eq!(known.len(), if share > 2.0 { 3 } else { 2 }, "{known:?}");
    }
}
