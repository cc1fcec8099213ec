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
            let member = family.with(&[(name, value)]).unwrap();
            let task = Task { gait: &*member as &dyn Gait, criterion, speed: SPEED };
            let local = task.follow(&near.theta, &mut |_| Control::Continue);
            assert!(local.status.is_optimal(), "{key} {criterion:?} {name}: {:?}", local.status);
            local.costs.of(criterion)
        };
        for s in sensitivities(gait, criterion, SPEED, &near.motion).unwrap().slopes {
            let Sensitivity { parameter, value, slope, .. } = &s;
            let Some(p) = family.parameters.iter().find(|p| p.name == parameter && wanted(p.name)) else { continue };
            // Small and large numbers move the optimum alike: in what they do to the criterion.
            let h = if *value == 0.0 { 1e-6 } else { 1e-4 * value.abs() };
            let differences = (cost(p.name, value + h) - cost(p.name, value - h)) / (2.0 * h);
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
    // An axial inertia is zero, and no rigid body has less.
    assert!(compare(|name| !name.ends_with("axial") && !name.ends_with("rotor_inertia")) > 100);
}
