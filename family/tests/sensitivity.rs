//! Slopes of the optimum in masses, lengths and inertias against optima of robots that have others.

use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sensitivity::{Sensitivity, sensitivities};
use piaffe::sqp::Control;
use piaffe_family::FAMILIES;

const SPEED: f64 = 0.6;

/// Compares the slopes of every gait and criterion in the parameters that are `wanted`; returns how many were.
fn compare(wanted: impl Fn(&str) -> bool) -> usize {
    let mut compared = 0;
    for (gait, criterion) in GAITS.iter().flat_map(|g| Criterion::ALL.map(|c| (*g, c))) {
        let key = gait.description().key;
        let family = FAMILIES.iter().find(|f| f.description.key == key).unwrap();
        let found = search(gait, criterion, SPEED, &Settings { starts: 2, seed: 1 }, &|_| {});
        let near: &Local = &found.optima[0].local;
        let best = near.costs.of(criterion);
        let cost = |name: &str, value: f64| {
            let member = family.with(&[(name, value)]).ok()?;
            let task = Task { gait: &*member as &dyn Gait, criterion, speed: SPEED };
            let local = task.follow(&near.theta, &mut |_| Control::Continue);
            assert!(local.status.is_optimal(), "{key} {criterion:?} {name}: {:?}", local.status);
            Some(local.costs.of(criterion))
        };
        // To one side where no rigid body is on the other: a flat plate, a slender rod, no rotor.
        let differences = |name: &str, value: f64, h: f64| match (cost(name, value + h), cost(name, value - h)) {
            (Some(more), Some(less)) => (more - less) / (2.0 * h),
            (Some(more), None) => (4.0 * more - cost(name, value + 2.0 * h).unwrap() - 3.0 * best) / (2.0 * h),
            (None, Some(less)) => (3.0 * best - 4.0 * less + cost(name, value - 2.0 * h).unwrap()) / (2.0 * h),
            (None, None) => panic!("{key}: no robot with another {name}"),
        };
        for s in sensitivities(gait, criterion, SPEED, &near.motion).unwrap().slopes {
            let Sensitivity { parameter, value, slope, .. } = &s;
            let Some(p) = family.parameters.iter().find(|p| p.name == parameter && wanted(p.name)) else { continue };
            // Small and large numbers move the optimum alike: in what they do to the criterion.
            let h = if *value == 0.0 { 1e-6 } else { 1e-4 * value.abs() };
            let differences = differences(p.name, *value, h);
            let size = if *value == 0.0 { 1.0 } else { value.abs() };
            let (exact, differences) = (slope * size / best, differences * size / best);
            println!("{key} {criterion:?} {parameter}: {exact} {differences}");
            assert!(
                (exact - differences).abs() < 1e-4 * (1.0 + exact.abs()),
                "{key} {criterion:?} {parameter}: {exact} {differences}"
            );
            compared += 1;
        }
    }
    compared
}

#[test]
fn slopes_are_those_of_optima_of_other_robots() {
    let some = ["gravity", "links.platform.mass", "links.thigh.mass", "links.shin.length", "links.shin.com"];
    assert!(compare(|name| some.contains(&name)) >= 30);
}

#[test]
#[ignore = "all of them: minutes"]
fn all_slopes_are_those_of_optima_of_other_robots() {
    assert!(compare(|_| true) > 100);
}
