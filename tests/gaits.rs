//! The whole way: from geometry to an optimum with a receipt, for every gait and criterion.

#[path = "gaits/walking.rs"]
mod walking;

use piaffe::altered::Altered;
use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::result::{GaitResult, Status};
use piaffe::search::multi_start::{Settings, search};
use piaffe::verdict::VIOLATION;
use piaffe::verify::{sample, verify};
use walking::walking;

fn optimize(gait: &dyn Gait, criterion: Criterion, speed: f64, starts: usize) -> GaitResult {
    let settings = Settings { starts: Some(starts), seed: 1, ..Settings::default() };
    let found = search(gait, criterion, speed, &settings, &|_| {});
    GaitResult::new(gait, criterion, speed, &found, &settings, || 0.0)
}

fn named(name: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == name).unwrap()
}

#[test]
fn polynomials_of_higher_order_need_less_work_and_torque() {
    for (name, criterion) in [("trot", Criterion::Energy), ("amble", Criterion::Torque)] {
        let costs = [4, 6, 8].map(|order| {
            let result = optimize(&Altered::of_order(named(name), order), criterion, 0.6, 6);
            assert_eq!(result.status, Status::Optimal, "{name} {criterion:?}, order {order}: {}", result.message);
            assert_eq!((result.polynomial_order, result.variables[0].q_interior.len()), (order, order - 3));
            result.cost.unwrap()
        });
        assert!(costs[1] < 0.99 * costs[0] && costs[2] < 0.999 * costs[1], "{name} {criterion:?}: {costs:?}");
    }
}

#[test]
fn the_receipt_agrees_with_the_optimizer_that_shares_no_code_with_it() {
    for gait in walking() {
        let speed = 0.5;
        let found = search(*gait, Criterion::Torque, speed, &Settings::default(), &|_| {});
        let name = gait.description().key;
        let local = &found.optima.first().unwrap_or_else(|| panic!("{name}: no optimum")).local;
        let receipt = verify(gait.description(), &local.motion, speed, 2001).unwrap();
        let apart = |a: f64, b: f64| (a / b - 1.0).abs();
        // The optimizer's mesh is just fine enough for its purpose, and |power| has kinks.
        let (torque, energy) =
            (apart(receipt.costs.torque, local.costs.torque), apart(receipt.costs.energy, local.costs.energy));
        // The best motions of the A1 have more in a phase than the mesh shows.
        let (most, cycle) = if name.starts_with("a1/") { (1e-4, 1e-6) } else { (1e-5, 1e-7) };
        assert!(torque < most && energy < 1e-3, "{name}: {torque:e} {energy:e}");
        assert!(receipt.max_violation < VIOLATION && receipt.cycle_error < cycle, "{name}: {receipt:?}");
        assert!((receipt.speed - speed).abs() < 1e-7);
    }
}

#[test]
fn a_spoilt_motion_gets_no_receipt() {
    let gait = named("trot");
    let found =
        search(gait, Criterion::Energy, 0.6, &Settings { starts: Some(1), seed: 1, ..Settings::default() }, &|_| {});
    let good = found.optima[0].local.motion.clone();
    let spoil = |change: &dyn Fn(&mut Motion)| {
        let mut motion = good.clone();
        change(&mut motion);
        verify(gait.description(), &motion, 0.6, 501).unwrap()
    };
    assert!(spoil(&|m| m.phases[0].betad_final += 1e-3).cycle_error > 1e-4);
    assert!(spoil(&|m| m.phases[0].q_interior[0][0] += 1e-3).cycle_error > 1e-6);
    assert!(spoil(&|m| m.phases[0].q_final[0] += 1e-2).max_violation > 100.0 * VIOLATION);
}

#[test]
fn forces_and_torques_move_the_robot_as_newton_says() {
    // Over a phase, impulse of the reaction and weight = change of momentum; checked by finite
    // differences of the platform's path, which no dynamics enters.
    let gait = named("curvet");
    let found =
        search(gait, Criterion::Torque, 0.6, &Settings { starts: Some(1), seed: 1, ..Settings::default() }, &|_| {});
    let motion = &found.optima[0].local.motion;
    let samples = sample(gait.description(), motion, 401).unwrap();
    let d = gait.description();
    let centre = |s: &piaffe::verify::Sample| {
        let mut x: Vec<f64> = vec![s.platform[0], s.platform[1]];
        x.extend(&s.q);
        let mut out = [0.0; 4];
        gait.centre_of_mass(&x, &vec![0.0; x.len()], &mut out);
        [out[0], out[1]]
    };
    for phase in [1, 2] {
        let part: Vec<_> = samples.iter().filter(|s| s.phase == phase).collect();
        let h = part[1].t - part[0].t;
        for w in part.windows(3).step_by(40) {
            let [a, b, c] = [centre(w[0]), centre(w[1]), centre(w[2])];
            for axis in 0..2 {
                let acceleration = (a[axis] - 2.0 * b[axis] + c[axis]) / (h * h);
                let gravity = if axis == 1 { d.gravity } else { 0.0 };
                let force = d.total_mass() * (acceleration + gravity);
                assert!(
                    (force - w[1].force[axis]).abs() < 1e-2 * d.total_mass() * d.gravity,
                    "{force} {:?}",
                    w[1].force
                );
            }
        }
    }
}

#[test]
fn an_impossible_speed_is_infeasible_with_named_conflicts() {
    for gait in walking() {
        let result = optimize(*gait, Criterion::Energy, 5.0, 3);
        let name = gait.description().gait;
        assert_eq!(result.status, Status::Infeasible, "{name}: {}", result.message);
        assert!(result.conflicts.iter().any(|c| c.constraint == "mean speed"), "{name}: {:?}", result.conflicts);
        assert!(result.cost.is_none() && result.receipt.is_none() && result.variables.is_empty());
    }
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let gait = named("amble");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| optimize(gait, Criterion::Torque, 0.7, 4))
    };
    assert_eq!(serde_json::to_string(&run(1)).unwrap(), serde_json::to_string(&run(3)).unwrap());
}
