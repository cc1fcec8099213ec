//! Every derivative that the optimizer uses, against central differences of the same path.

#[path = "friction/gaits.rs"]
mod rubbing;
#[path = "gaits/walking.rs"]
mod walking;

use piaffe::Robot;
use piaffe::altered::Altered;
use piaffe::cycle::{Cycle, Still, elements, theta};
use piaffe::gaits::GAITS;
use piaffe::interpreter::Interpreted;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::search::guess::{Plan, walk};
use piaffe::sqp::{Problem, Values};
use walking::walking;

/// Holds the last joint in every phase, which it need not do in the motion at hand.
fn hold(cycle: &mut Cycle) {
    let joint = cycle.description().joints() - 1;
    let joints: Vec<Still> = (0..cycle.phases()).map(|phase| Still { phase, joint }).collect();
    cycle.hold(&joints);
}

/// Drawn walks have joints that turn around just where a phase ends. There their power has a root, and what dry friction costs a kink,
/// on one side alone: a little off it.
fn off_turns(mut theta: Vec<f64>, scale: &[f64], rng: &mut fastrand::Rng) -> Vec<f64> {
    theta.iter_mut().zip(scale).for_each(|(x, size)| *x += 0.02 * size * (rng.f64() - 0.5));
    theta
}

/// Imposes every path constraint at its lowest point in every element too.
fn impose_everywhere(cycle: &mut Cycle, theta: &[f64], values: &mut Values) {
    let elements = elements(cycle.description());
    for phase in 0..cycle.phases() {
        for constraint in 0..cycle.path(phase).len() {
            for element in 0..elements {
                cycle.impose(phase, constraint, (element as f64 + 0.5) / elements as f64, 0.01);
            }
        }
    }
    *values = Values::zeros(cycle.equalities(), cycle.inequalities());
    cycle.evaluate(theta, values).unwrap();
}

fn check(gait: &dyn Gait, criterion: Criterion, seed: u64) {
    let name = gait.description().gait;
    let speed = 0.6;
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut cycle = Cycle::new(gait, criterion, speed);
    let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
    // Not every drawn walk exists: the first that does is used.
    let theta = loop {
        let plan = Plan::random(gait, &mut rng);
        let theta = off_turns(theta(&walk(gait, &plan, speed)), &cycle.scale(), &mut rng);
        if cycle.evaluate(&theta, &mut values).is_ok() && all_joints_move(gait, &theta) {
            break theta;
        }
    };
    if seed % 2 == 1 {
        hold(&mut cycle);
    }
    impose_everywhere(&mut cycle, &theta, &mut values);
    let n = theta.len();
    cycle.linearize(&theta).unwrap();
    let mut gradient = vec![0.0; n];
    cycle.gradient(&mut gradient);
    let rows = |count: usize, get: &dyn Fn(usize, &mut [f64])| -> Vec<Vec<f64>> {
        (0..count)
            .map(|i| {
                let mut row = vec![0.0; n];
                get(i, &mut row);
                row
            })
            .collect()
    };
    let equalities = rows(cycle.equalities(), &|i, r| cycle.equality_row(i, r));
    let inequalities = rows(cycle.inequalities(), &|i, r| cycle.inequality_row(i, r));

    // The cheap product with a direction agrees with the rows.
    let direction: Vec<f64> = (0..n).map(|_| rng.f64() - 0.5).collect();
    let (mut product, mut beyond) = (vec![0.0; inequalities.len()], vec![0.0; cycle.folds()]);
    cycle.directions(&direction, &mut product, &mut beyond);
    let folds = rows(cycle.folds(), &|i, r| cycle.fold_row(i, r));
    for (row, p) in inequalities.iter().chain(&folds).zip(product.iter().chain(&beyond)) {
        let expected: f64 = row.iter().zip(&direction).map(|(a, b)| a * b).sum();
        assert!((expected - p).abs() <= 1e-9 * (1.0 + expected.abs()), "{name}: directions");
    }

    // A lowest point can be flat: there differences need a small step; in a short flight rounding counts: a large one, of fourth
    // order. One of the two must agree.
    const STEPS: [f64; 2] = [1e-6, 2e-7];
    let mut around = STEPS.map(|_| [(); 4].map(|()| values.clone()));
    for k in 0..n {
        for (h, around) in STEPS.iter().zip(&mut around) {
            for (values, steps) in around.iter_mut().zip([1.0, -1.0, 2.0, -2.0]) {
                let mut moved = theta.clone();
                moved[k] = theta[k] + steps * h;
                cycle.evaluate(&moved, values).unwrap();
            }
        }
        let compare = |what: String, exact: f64, of: &dyn Fn(&Values) -> f64, size: f64| {
            let differences = STEPS.iter().zip(&around).map(|(h, around)| {
                let [plus, minus, far_plus, far_minus] = around.each_ref().map(of);
                let difference = (8.0 * (plus - minus) - (far_plus - far_minus)) / (12.0 * h);
                let tolerance = 1e-6 * (size + exact.abs()) + 1e-8 * (plus.abs() + minus.abs()) / h * 1e-6;
                (difference, (difference - exact).abs() <= tolerance.max(2e-6))
            });
            let differences: Vec<(f64, bool)> = differences.collect();
            assert!(
                differences.iter().any(|(_, agrees)| *agrees),
                "{name} {what} by {k}: exact {exact}, differences {differences:?}"
            );
        };
        let largest = gradient.iter().fold(1.0f64, |a, b| a.max(b.abs()));
        compare(format!("{criterion:?}"), gradient[k], &|v| v.objective, largest);
        for i in 0..equalities.len() {
            compare(
                format!("equality {i} {:?}", cycle.equality_label(i)),
                equalities[i][k],
                &|v| v.equalities[i],
                10.0,
            );
        }
        for i in 0..inequalities.len() {
            let size = inequalities[i].iter().fold(1.0f64, |a, b| a.max(b.abs()));
            compare(format!("inequality {i} {:?}", cycle.label(i)), inequalities[i][k], &|v| v.inequalities[i], size);
        }
    }
}

#[test]
fn gradients_agree_with_differences_for_every_gait_criterion_and_order() {
    for gait in GAITS {
        for criterion in Criterion::ALL {
            check(&rubbing::smooth(*gait), criterion, 4);
            (4..6).for_each(|seed| check(&rubbing::dry(*gait), criterion, seed));
            check(&rubbing::sprung(*gait), criterion, 5);
            if gait.description().flies() {
                check(*gait, criterion, 4);
                continue;
            }
            for seed in 0..3 {
                check(*gait, criterion, seed);
            }
            check(&Altered::of_order(*gait, 6), criterion, 0);
            check(&Altered::at_real_legs(*gait).unwrap(), criterion, 0);
            check(&Altered::at_real_legs(&rubbing::dry(*gait)).unwrap(), criterion, 2);
            check(&Altered::at_real_legs(&rubbing::sprung(*gait)).unwrap(), criterion, 2);
        }
    }
    let geared = geared();
    Criterion::ALL.into_iter().for_each(|criterion| check(&Altered::at_real_legs(&geared).unwrap(), criterion, 0));
}

/// An amble whose impacts pitch the robot.
fn geared() -> Interpreted {
    let robot = Robot::read("model-spec").unwrap().with("actuators.haunch_motor.rotor_inertia", 2e-5).unwrap();
    robot.gait("amble").unwrap()
}

/// What the power of a joint adds to the criterion in an element, where it keeps its sign there: all such elements of a motion add up to
/// less than the criterion, and each has the gradient that differences have.
#[test]
fn folds_are_parts_of_the_criterion() {
    let rub: Vec<_> = GAITS.iter().flat_map(|gait| [rubbing::dry(*gait), rubbing::sprung(*gait)]).collect();
    for gait in GAITS.iter().copied().chain(rub.iter().map(|gait| gait as &dyn Gait)) {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut cycle = Cycle::new(gait, Criterion::Energy, 0.6);
        let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
        let theta = loop {
            let theta = theta(&walk(gait, &Plan::random(gait, &mut rng), 0.6));
            let theta = off_turns(theta, &cycle.scale(), &mut rng);
            if cycle.evaluate(&theta, &mut values).is_ok() {
                break theta;
            }
        };
        let n = theta.len();
        cycle.evaluate(&theta, &mut values).unwrap();
        cycle.linearize(&theta).unwrap();
        let folds: Vec<Option<f64>> = (0..cycle.folds()).map(|i| cycle.fold(i)).collect();
        let objective = values.objective;
        let sum: f64 = folds.iter().flatten().sum();
        let name = gait.description().key;
        assert!(folds.iter().flatten().all(|c| *c > 0.0), "{name}");
        assert!(sum > 0.2 * objective && sum <= (1.0 + 1e-12) * objective, "{name}: {sum} of {objective}");
        // Differences see a fold that is nearer than their step.
        let far = folds.iter().enumerate().filter(|(i, fold)| i % 23 == 0 && fold.is_some_and(|c| c > 1e-5));
        for (i, fold) in far {
            let mut gradient = vec![0.0; n];
            cycle.evaluate(&theta, &mut values).unwrap();
            cycle.linearize(&theta).unwrap();
            cycle.fold_row(i, &mut gradient);
            for k in 0..n {
                let h = 1e-6;
                let [plus, minus] = [h, -h].map(|h| {
                    let mut moved = theta.clone();
                    moved[k] += h;
                    cycle.evaluate(&moved, &mut values).unwrap();
                    cycle.linearize(&moved).unwrap();
                    cycle.fold(i)
                });
                let (Some(plus), Some(minus)) = (plus, minus) else { continue };
                let difference = (plus - minus) / (2.0 * h);
                let size = gradient.iter().fold(1.0, |a: f64, b| a.max(b.abs()));
                assert!(
                    (difference - gradient[k]).abs() < 2e-6 * size,
                    "{name}, fold {i} of {fold:?} by {k}: {difference}, {}",
                    gradient[k]
                );
            }
        }
    }
}

/// Gradient of the Lagrangian at `theta` with the given multipliers.
fn lagrangian_gradient(cycle: &mut Cycle, theta: &[f64], lambda: &[f64], mu: &[f64], values: &mut Values) -> Vec<f64> {
    cycle.evaluate(theta, values).unwrap();
    cycle.linearize(theta).unwrap();
    let n = theta.len();
    let (mut gradient, mut row) = (vec![0.0; n], vec![0.0; n]);
    cycle.gradient(&mut gradient);
    for (i, l) in lambda.iter().enumerate() {
        cycle.equality_row(i, &mut row);
        gradient.iter_mut().zip(&row).for_each(|(g, r)| *g -= l * r);
    }
    for (i, m) in mu.iter().enumerate().filter(|(_, m)| **m != 0.0) {
        cycle.inequality_row(i, &mut row);
        gradient.iter_mut().zip(&row).for_each(|(g, r)| *g -= m * r);
    }
    gradient
}

/// Where a joint rests, its power has a kink, and what limits it has no lowest point.
fn all_joints_move(gait: &dyn Gait, theta: &[f64]) -> bool {
    let mut cycle = Cycle::new(gait, Criterion::Energy, 0.6);
    cycle.simulate(theta).is_ok() && cycle.still(1e-9).is_empty()
}

#[test]
fn the_hessian_of_the_lagrangian_agrees_with_differences_of_its_gradient() {
    let at_real_legs: Vec<_> = walking().map(|gait| Altered::at_real_legs(*gait).unwrap()).collect();
    let rub: Vec<_> =
        GAITS.iter().flat_map(|gait| [rubbing::smooth(*gait), rubbing::dry(*gait), rubbing::sprung(*gait)]).collect();
    let all_rub: Vec<_> = rub.iter().filter(|gait| !gait.description().flies()).collect();
    let rub_at_real_legs: Vec<_> = all_rub.into_iter().map(|gait| Altered::at_real_legs(gait).unwrap()).collect();
    let geared = geared();
    let geared_at_real_legs = Altered::at_real_legs(&geared).unwrap();
    let altered = at_real_legs.iter().chain(&rub).chain(&rub_at_real_legs).chain([&geared_at_real_legs]);
    let gaits = GAITS.iter().copied().chain(altered.map(|g| g as &dyn Gait));
    for (gait, held) in gaits.flat_map(|gait| [(gait, false), (gait, true)]) {
        for criterion in Criterion::ALL {
            let d = gait.description();
            let mut rng = fastrand::Rng::with_seed(7);
            let mut cycle = Cycle::new(gait, criterion, 0.6);
            let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
            let theta = loop {
                let plan = Plan::random(gait, &mut rng);
                let theta = off_turns(theta(&walk(gait, &plan, 0.6)), &cycle.scale(), &mut rng);
                if cycle.evaluate(&theta, &mut values).is_ok() && all_joints_move(gait, &theta) {
                    break theta;
                }
            };
            if held {
                hold(&mut cycle);
            }
            impose_everywhere(&mut cycle, &theta, &mut values);
            let n = theta.len();
            let size = values.objective;
            let lambda: Vec<f64> = (0..cycle.equalities()).map(|_| size * (rng.f64() - 0.5)).collect();
            let mu: Vec<f64> =
                (0..cycle.inequalities()).map(|_| if rng.f64() < 0.1 { size * rng.f64() } else { 0.0 }).collect();
            cycle.linearize(&theta).unwrap();
            let mut hessian = vec![0.0; n * n];
            assert!(cycle.hessian(&lambda, &mu, &mut hessian));
            let largest = hessian.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            for k in 0..n {
                // Differences of fourth order: in a short flight everything bends sharply, and a limit that moves with a turn more so.
                let h = 2.5e-6;
                let mut at = |steps: f64| {
                    let mut moved = theta.clone();
                    moved[k] += steps * h;
                    lagrangian_gradient(&mut cycle, &moved, &lambda, &mu, &mut values)
                };
                let [plus, minus, far_plus, far_minus] = [1.0, -1.0, 2.0, -2.0].map(&mut at);
                for j in 0..n {
                    let difference = (8.0 * (plus[j] - minus[j]) - (far_plus[j] - far_minus[j])) / (12.0 * h);
                    let exact = hessian[j * n + k];
                    let error = (difference - exact).abs();
                    assert!(
                        error <= 1e-5 * largest.min((1e3 * exact.abs()).max(1e-3 * largest)),
                        "{} {criterion:?} ({j}, {k}): exact {exact}, difference {difference}, largest {largest:e}",
                        d.gait
                    );
                }
            }
        }
    }
}
