//! Slopes of the optimum in limits and speed against optima of changed problems, and those in the numbers of a robot's file against
//! optima of changed files; of the shipped robots: see family/tests.

#[path = "gaits/walking.rs"]
mod walking;

use piaffe::Robot;
use piaffe::altered::Altered;
use piaffe::model::{Gait, Lever};
use piaffe::motion::Criterion;
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sensitivity::{Sensitivities, Sensitivity, sensitivities};
use piaffe::sqp::Control;
use piaffe_codegen::RobotFiles;
use walking::walking;

#[path = "flight/gaits.rs"]
mod flying;

const SPEED: f64 = 0.6;

fn optimum(gait: &dyn Gait, criterion: Criterion) -> Local {
    search(gait, criterion, SPEED, &Settings::default(), &|_| {}).optima[0].local.clone()
}

/// The least criterion at the changed problem, near a known optimum.
fn cost(gait: &dyn Gait, criterion: Criterion, speed: f64, near: &Local) -> f64 {
    let local = Task { gait, criterion, speed }.follow(&near.theta, &mut |_| Control::Continue);
    assert!(local.status.is_optimal(), "{:?}", local.status);
    local.costs.of(criterion)
}

fn slope(found: &Sensitivities, name: &str) -> f64 {
    found.slopes.iter().find(|s| s.parameter == name).unwrap_or_else(|| panic!("no {name}")).slope
}

/// kg, m and s in a unit.
fn dimension(unit: &str) -> [f64; 3] {
    match unit {
        "" | "rad" => [0.0, 0.0, 0.0],
        "kg" => [1.0, 0.0, 0.0],
        "m" => [0.0, 1.0, 0.0],
        "s" => [0.0, 0.0, 1.0],
        "m/s" => [0.0, 1.0, -1.0],
        "m/s²" => [0.0, 1.0, -2.0],
        "rev/min" => [0.0, 0.0, -1.0],
        "kg·m²" => [1.0, 2.0, 0.0],
        "N" => [1.0, 1.0, -2.0],
        "N·m" => [1.0, 2.0, -2.0],
        "N²·m·s" => [2.0, 3.0, -3.0],
        _ => panic!("{unit}"),
    }
}

#[test]
fn elasticities_add_up_to_the_dimension_of_the_criterion() {
    // Whoever measures in other units finds the same optimum (Euler's theorem on homogeneous functions): no number that
    // matters is forgotten, and none counts twice.
    for (gait, criterion) in walking().flat_map(|g| Criterion::ALL.map(|c| (*g, c))) {
        let local = optimum(gait, criterion);
        let Ok(found) = sensitivities(gait, criterion, SPEED, &local.motion) else {
            // Prices are told only where the residual holds; on the A1 it need not (docs/robots.md).
            assert!(gait.description().key.starts_with("a1/"));
            continue;
        };
        for (k, expected) in dimension(criterion.unit()).into_iter().enumerate() {
            let sum: f64 = found.slopes.iter().map(|s| s.elasticity * dimension(&s.unit)[k]).sum();
            // Multipliers are those of the optimizer's mesh.
            assert!((sum - expected).abs() < 1e-4, "{} {criterion:?} {k}: {sum}", gait.description().key);
        }
    }
}

/// Through take-off, parabola and landing too, and through swings that last longer than a phase.
#[test]
fn elasticities_of_gaits_that_fly_add_up_too() {
    for (gait, motion) in flying::optima() {
        let found = sensitivities(&gait, Criterion::Torque, 1.0, &motion).unwrap();
        for (k, expected) in dimension(Criterion::Torque.unit()).into_iter().enumerate() {
            let sum: f64 = found.slopes.iter().map(|s| s.elasticity * dimension(&s.unit)[k]).sum();
            assert!((sum - expected).abs() < 1e-4, "{} {k}: {sum}", gait.description().key);
        }
        // How long the mass centre falls decides of a run: gravity has a price of its own.
        assert!(slope(&found, "gravity").abs() > 1.0, "{}", gait.description().key);
    }
}

/// A gait with the numbers that depend on a lever moved by as much as the lever moves by `by`.
fn moved<'a>(gait: &'a dyn Gait, lever: &Lever, by: f64) -> Option<Altered<'a>> {
    let mut change = vec![0.0; gait.description().numbers().len()];
    lever.slopes.iter().for_each(|(number, slope)| change[*number] = slope * by);
    let mut change = change.into_iter();
    Altered::new(gait, |d| d.for_each_number(&mut |number| *number += change.next().unwrap()))
}

#[test]
fn slopes_in_limits_and_speed_are_those_of_optima_of_changed_problems() {
    let mut compared = 0;
    for (gait, criterion) in walking().flat_map(|g| Criterion::ALL.map(|c| (*g, c))) {
        let local = optimum(gait, criterion);
        let Ok(found) = sensitivities(gait, criterion, SPEED, &local.motion) else {
            // Prices are told only where the residual holds; on the A1 it need not (docs/robots.md).
            assert!(gait.description().key.starts_with("a1/"));
            continue;
        };
        let name = format!("{} {criterion:?}", gait.description().key);
        let best = local.costs.of(criterion);
        // Rows between the nodes settle to 1e-8 of the criterion, which the step must exceed.
        let (step, tolerance) = (1e-4, 1e-4);
        let check = |of: &str, slope: f64, differences: f64, value: f64| {
            let (slope, differences) = (slope * value / best, differences * value / best);
            let most = tolerance * (1.0 + slope.abs());
            assert!((slope - differences).abs() < most, "{name} {of}: {slope} {differences}");
        };
        let h = step * SPEED;
        let differences =
            (cost(gait, criterion, SPEED + h, &local) - cost(gait, criterion, SPEED - h, &local)) / (2.0 * h);
        check("speed", slope(&found, "speed"), differences, SPEED);
        for lever in gait.levers() {
            let exact = slope(&found, lever.name);
            // A clearance of nothing can be changed by a share of something.
            let size = if lever.name == "limits.body_clearance" { 0.1 } else { lever.value.abs() };
            let h = step * size;
            let (Some(more), Some(less)) = (moved(gait, lever, h), moved(gait, lever, -h)) else { continue };
            if exact == 0.0 || h == 0.0 {
                continue;
            }
            let [more, less] = [&more, &less].map(|gait| cost(gait, criterion, SPEED, &local));
            if found.one_sided.is_empty() {
                check(lever.name, exact, (more - less) / (2.0 * h), size);
            } else {
                // A limit that is active without a price makes a kink: the slope is that of one side, or between the two.
                let [left, right] = [(best - less) / h, (more - best) / h];
                let between = exact.clamp(left.min(right), left.max(right));
                println!("{name} {}: {exact} {left} {right} {:?}", lever.name, found.one_sided);
                check(lever.name, exact, between, size);
            }
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}

/// A robot of which no number is shipped: what its file says is changed there, and the optimum found anew.
#[test]
fn slopes_are_in_the_numbers_that_stand_in_the_file() {
    let files = RobotFiles::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/sensitivity/heron").as_ref()).unwrap();
    let files = RobotFiles { module: String::new(), ..files };
    let gait = |files: RobotFiles| Robot::new(files).ok()?.gait("walk").ok();
    let (heron, criterion, speed) = (gait(files.clone()).unwrap(), Criterion::Torque, 0.12);
    let found = search(&heron, criterion, speed, &Settings::default(), &|_| {});
    let near = &found.optima[0].local;
    let best = near.costs.of(criterion);
    let slopes = sensitivities(&heron, criterion, speed, &near.motion).unwrap().slopes;
    let least = |name: &str, value: f64| {
        let mut changed = files.clone();
        changed.set(name, value).unwrap();
        Some(cost(&gait(changed)?, criterion, speed, near))
    };
    let mut compared = Vec::new();
    for Sensitivity { parameter: name, value, unit, slope, .. } in &slopes {
        if name == "speed" || *slope == 0.0 {
            continue;
        }
        // Of what is none, something that would be little there.
        let size = match unit.as_str() {
            _ if *value != 0.0 => value.abs(),
            "m" => 1e-2,
            "kg" => 1e-4,
            "N·m·s/rad" => 1e-7,
            "kg·m²" => 1e-11,
            _ => panic!("{name}: {unit}"),
        };
        let h = 1e-3 * size;
        // To one side where there is nothing on the other.
        let differences = match (least(name, value + h), least(name, value - h)) {
            (Some(more), Some(less)) => (more - less) / (2.0 * h),
            (Some(more), None) => (4.0 * more - least(name, value + 2.0 * h).unwrap() - 3.0 * best) / (2.0 * h),
            (None, Some(less)) => (3.0 * best - 4.0 * less + least(name, value - 2.0 * h).unwrap()) / (2.0 * h),
            (None, None) => panic!("no robot with another {name}"),
        };
        let (exact, differences) = (slope * size / best, differences * size / best);
        assert!((exact - differences).abs() < 2e-3 * (0.1 + exact.abs()), "{name}: {exact} {differences}");
        compared.push(name.as_str());
    }
    for name in [
        "links.meta.mass",
        "links.meta.foot_mass",
        "links.meta.length.x",
        "links.meta.length.y",
        "links.meta.com.x",
        "links.tibia.length",
        "links.tibia.foot_mass",
        "joints.hip.damping",
        "actuators.m.rotor_inertia",
        "legs.{left,right}.mount.x",
    ] {
        assert!(compared.contains(&name), "{name}: {compared:?}");
    }
}
