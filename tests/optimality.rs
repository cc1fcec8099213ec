//! Optimality re-derived from the motion alone.

#[path = "gaits/walking.rs"]
mod walking;

use piaffe::altered::Altered;
use piaffe::cycle::Cycle;
use piaffe::gaits::GAITS;
use piaffe::instant::Quantities;
use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::optimality::{KKT_RESIDUAL, Linearized, Optimality, optimality};
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sqp::Control;
use piaffe::walk::Walk;
use walking::walking;

fn optimum(gait: &dyn Gait, criterion: Criterion, speed: f64) -> Local {
    search(gait, criterion, speed, &Settings::default(), &|_| {}).optima[0].local.clone()
}

#[test]
fn the_residual_of_an_optimum_is_small_from_the_motion_alone_as_the_optimizer_says() {
    for gait in walking() {
        for criterion in Criterion::ALL {
            let local = optimum(*gait, criterion, 0.6);
            let found = optimality(*gait, criterion, 0.6, &local.motion).unwrap();
            let (name, own) = (gait.description().key, local.kkt.stationarity.max(local.kkt.complementarity));
            assert!(own < 1e-6 && found.residual() < 1e-6, "{name} {criterion:?}: {own:e} and {found:?}");
            // A cycle of unactuated motion has four equations, of two phases seven, and all have a price.
            let d = gait.description();
            let of_phase = |k: usize| 2 + usize::from(d.transition(k).lands().is_some());
            assert_eq!(found.equations.len(), (0..d.phases.len()).map(of_phase).sum::<usize>() + 1);
            assert!(found.limits.iter().all(|p| p.value > 0.0 && p.time >= 0.0), "{name} {criterion:?}: {found:?}");
        }
    }
}

#[test]
fn a_motion_that_is_feasible_but_no_optimum_has_a_residual() {
    let trot = GAITS.iter().copied().find(|g| g.description().key == "trot").unwrap();
    let of = |criterion, motion: &Motion| -> Optimality { optimality(trot, criterion, 0.6, motion).unwrap() };
    // The optimum of the other criterion: on the same constraints, and as feasible.
    let local = optimum(trot, Criterion::Torque, 0.6);
    let (own, other) = (of(Criterion::Torque, &local.motion), of(Criterion::Energy, &local.motion));
    assert!(own.residual() < KKT_RESIDUAL && other.residual() > 1e3 * KKT_RESIDUAL, "{own:?} {other:?}");
    assert!((own.violation - other.violation).abs() < 1e-12 && own.violation < 1e-6);
    // One that is not feasible is told by its violation.
    let mut motion = local.motion;
    motion.phases[0].betad_final += 1e-3;
    assert!(of(Criterion::Torque, &motion).violation > 1e-5);
}

#[test]
fn a_limit_that_just_touches_is_named_but_has_no_price() {
    let trot = GAITS.iter().copied().find(|g| g.description().key == "trot").unwrap();
    let motion = optimum(trot, Criterion::Energy, 0.6).motion;
    let walk = Walk::even(trot, &motion, 2000).unwrap();
    let lowest = walk.moments.iter().map(|m| m.platform[0][1]).fold(f64::INFINITY, f64::min);
    let touching = |by: f64| {
        let gait = Altered::new(trot, |d| d.limits.min_platform_height = lowest - by).unwrap();
        Linearized::new(&gait, Criterion::Energy, 0.6, &motion).unwrap().unpriced()
    };
    assert_eq!(touching(0.0), ["platform height (phase 1)"]);
    assert!(touching(1e-4).is_empty());
}

#[test]
fn a_price_is_what_loosening_the_limit_gains() {
    let mut compared = 0;
    for (gait, criterion) in walking().flat_map(|g| Criterion::ALL.map(|c| (*g, c))) {
        let local = optimum(gait, criterion, 0.6);
        let found = optimality(gait, criterion, 0.6, &local.motion).unwrap();
        let price: f64 = found.limits.iter().filter(|p| p.constraint == "swing clearance").map(|p| p.value).sum();
        if price == 0.0 {
            continue;
        }
        let cost = |by: f64| {
            let gait = Altered::new(gait, |d| d.limits.swing_clearance += by).unwrap();
            let near = Task { gait: &gait, criterion, speed: 0.6 }.follow(&local.theta, &mut |_| Control::Continue);
            assert!(near.status.is_optimal());
            near.costs.of(criterion)
        };
        let h = 1e-5;
        let slope = (cost(h) - cost(-h)) / (2.0 * h);
        // The price is that of a leg length.
        let expected = price / gait.description().leg_length();
        let name = gait.description().key;
        assert!((slope / expected - 1.0).abs() < 1e-3, "{name} {criterion:?}: {slope} {expected}");
        compared += 1;
    }
    assert!(compared >= 3, "{compared}");
}

#[test]
fn knees_that_must_be_higher_cost_their_price() {
    let criterion = Criterion::Energy;
    for key in ["trot", "curvet"] {
        let gait = GAITS.iter().copied().find(|g| g.description().key == key).unwrap();
        let free = optimum(gait, criterion, 0.6);
        let mut cycle = Cycle::new(gait, criterion, 0.6);
        cycle.simulate(&free.theta).unwrap();
        let heights = |phase| Quantities::new(gait.description(), cycle.mode(phase)).heights();
        let nodes = (0..cycle.phases()).flat_map(|phase| (0..cycle.nodes(phase)).map(move |node| (phase, node)));
        let lowest = nodes.flat_map(|(phase, node)| &cycle.quantities(phase, node)[heights(phase)]);
        let lowest = lowest.copied().fold(f64::INFINITY, f64::min);
        assert!(lowest > 0.05, "{key}: knees at {lowest} m");
        let raised = |by: f64| Altered::new(gait, |d| d.limits.body_clearance = lowest + 0.002 + by).unwrap();
        let best = |by: f64, near: &Local| {
            let gait = raised(by);
            let local = Task { gait: &gait, criterion, speed: 0.6 }.follow(&near.theta, &mut |_| Control::Continue);
            assert!(local.status.is_optimal(), "{key}: {:?}", local.status);
            local
        };
        let local = best(0.0, &free);
        assert!(local.costs.of(criterion) > free.costs.of(criterion), "{key}: higher knees cost nothing");
        let found = optimality(&raised(0.0), criterion, 0.6, &local.motion).unwrap();
        let price: f64 = found.limits.iter().filter(|p| p.constraint.starts_with("height of ")).map(|p| p.value).sum();
        let h = 1e-5;
        let slope = (best(h, &local).costs.of(criterion) - best(-h, &local).costs.of(criterion)) / (2.0 * h);
        let expected = price / gait.description().leg_length();
        assert!(price > 0.0 && (slope / expected - 1.0).abs() < 1e-3, "{key}: {slope} {expected}");
    }
}
