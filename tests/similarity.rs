//! Robots of one shape are one problem: copies of any size and weight have the same optima and the same verdicts, in their units.
//! And a speed is one of the robot's units, however small.

#[path = "similarity/copy.rs"]
mod copy;
#[path = "friction/gaits.rs"]
mod rubbing;
#[path = "gaits/walking.rs"]
mod walking;

use copy::{Copy, Factors};
use piaffe::cycle::{Cycle, theta};
use piaffe::examine::Examination;
use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::result::{GaitResult, Status};
use piaffe::search::guess::{Plan, walk};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sqp::{Problem, Values};
use piaffe::units::Units;
use walking::walking;

/// Far below and above all robots.
const SIZES: [(f64, f64); 4] = [(1e-3, 1e-6), (1e2, 1e6), (1e-3, 1e3), (30.0, 1e-4)];

fn optimize(gait: &dyn Gait, criterion: Criterion, speed: f64, starts: usize) -> GaitResult {
    let settings = Settings { starts: Some(starts), seed: 1, ..Settings::default() };
    let found = search(gait, criterion, speed, &settings, &|_| {});
    let mut result = GaitResult::new(gait, criterion, speed, &found, &settings, || 0.0);
    result.examine(gait, Examination::Full);
    result
}

fn named(name: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == name).unwrap()
}

/// A speed at which all shipped gaits go, in m/s.
fn usual(gait: &dyn Gait) -> f64 {
    0.3 * Units::new(gait.description()).speed()
}

/// What a result says of the original's copy by these factors, in the original's units.
#[derive(Debug, PartialEq)]
struct Saying {
    status: Status,
    cost: Option<f64>,
    durations: Vec<f64>,
    active: Vec<String>,
    certified: Option<bool>,
    prices: Vec<(String, f64)>,
    eigenvalues: Vec<f64>,
}

impl Saying {
    fn of(r: &GaitResult, by: &Factors) -> Saying {
        let [energy, torque] = by.costs();
        let unit = if r.criterion == Criterion::Energy { energy } else { torque };
        let prices = r.optimality.iter().flat_map(|o| o.equations.iter().chain(&o.limits));
        Saying {
            status: r.status,
            cost: r.cost.map(|cost| cost / unit),
            durations: r.durations.iter().map(|t| t / by.time).collect(),
            active: r.receipt.iter().flat_map(|receipt| receipt.active.clone()).collect(),
            certified: r.certificate.as_ref().map(|c| c.is_certified()),
            prices: prices.map(|p| (p.constraint.clone(), p.value / unit)).collect(),
            eigenvalues: r.stability.iter().flat_map(|s| s.clock.eigenvalues.concat()).collect(),
        }
    }
}

/// Copies by powers of two are computed with the bits of the original, if nothing has a unit of its own.
fn has_the_same_bits(gait: &dyn Gait, criterion: Criterion, (length, mass): (f64, f64)) {
    let name = gait.description().key;
    let original = optimize(gait, criterion, usual(gait), 1);
    let by = Factors::new(length, mass);
    let found = optimize(&Copy::new(gait, by), criterion, usual(gait) * by.speed(), 1);
    let (said, says) = (Saying::of(&original, &Factors::new(1.0, 1.0)), Saying::of(&found, &by));
    assert_eq!(said.status, Status::Optimal, "{name} {criterion:?}: {}", original.message);
    assert_eq!(says.status, said.status, "{name} {criterion:?} by {by:?}: {}", found.message);
    assert!(says == said, "{name} {criterion:?} by {by:?}: {says:?}, not {said:?}");
    assert_eq!(found.certificate.map(|c| c.bounds), original.certificate.map(|c| c.bounds), "{name} {criterion:?}");
}

/// All that the solver sees of a motion: values, their derivatives and the Hessian of the Lagrangian, in natural sizes of the
/// variables, as the motion is given. `None` if there is no such motion.
fn program(gait: &dyn Gait, criterion: Criterion, speed: f64, natural: &[f64]) -> Option<Vec<f64>> {
    let mut cycle = Cycle::new(gait, criterion, speed);
    let scale = cycle.scale();
    let theta: Vec<f64> = natural.iter().zip(&scale).map(|(x, size)| x * size).collect();
    let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
    cycle.evaluate(&theta, &mut values).ok()?;
    cycle.linearize(&theta).ok()?;
    let n = theta.len();
    let (mut found, mut row) = (Vec::new(), vec![0.0; n]);
    let mut add = |row: &[f64]| found.extend(row.iter().zip(&scale).map(|(slope, size)| slope * size));
    cycle.gradient(&mut row);
    add(&row);
    for i in 0..cycle.equalities() {
        cycle.equality_row(i, &mut row);
        add(&row);
    }
    for i in 0..cycle.inequalities() {
        cycle.inequality_row(i, &mut row);
        add(&row);
    }
    // Any multipliers, so that everything has a part in it.
    let lambda: Vec<f64> = (0..cycle.equalities()).map(|i| 1.0 - 0.3 * i as f64).collect();
    let mu: Vec<f64> = (0..cycle.inequalities()).map(|i| (i % 7) as f64).collect();
    let mut hessian = vec![0.0; n * n];
    assert!(cycle.hessian(&lambda, &mu, &mut hessian));
    for (row, size) in hessian.chunks(n).zip(&scale) {
        add(&row.iter().map(|second| second * size).collect::<Vec<_>>());
    }
    Some([&[values.objective], &values.equalities[..], &values.inequalities, &found].concat())
}

fn is_the_same_program(gait: &dyn Gait, criterion: Criterion, (length, mass): (f64, f64)) {
    let mut rng = fastrand::Rng::with_seed(3);
    let by = Factors::new(length, mass);
    let scale = Cycle::new(gait, criterion, usual(gait)).scale();
    let (natural, expected) = loop {
        let theta = theta(&walk(gait, &Plan::random(gait, &mut rng), usual(gait)));
        let natural: Vec<f64> = theta.iter().zip(&scale).map(|(x, size)| x / size).collect();
        if let Some(expected) = program(gait, criterion, usual(gait), &natural) {
            break (natural, expected);
        }
    };
    let found = program(&Copy::new(gait, by), criterion, usual(gait) * by.speed(), &natural).unwrap();
    assert_eq!(found.len(), expected.len());
    let name = gait.description().key;
    for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(found == expected && found.is_finite(), "{name} {criterion:?} by {by:?}: {k}: {found}, not {expected}");
    }
}

/// Other copies differ by rounding.
fn has_the_same_cost(gait: &dyn Gait, criterion: Criterion, sizes: &[(f64, f64)]) {
    let name = gait.description().key;
    let result = optimize(gait, criterion, usual(gait), 2);
    let original = Saying::of(&result, &Factors::new(1.0, 1.0));
    assert_eq!(original.status, Status::Optimal, "{name} {criterion:?}: {}", result.message);
    let cost = original.cost.unwrap();
    for (length, mass) in sizes {
        let by = Factors::new(*length, *mass);
        let result = optimize(&Copy::new(gait, by), criterion, usual(gait) * by.speed(), 2);
        let found = Saying::of(&result, &by);
        let message = format!("{name} {criterion:?} by {by:?}: {} {found:?}, not {original:?}", result.message);
        assert_eq!((found.status, found.certified), (original.status, original.certified), "{message}");
        assert_eq!(found.active, original.active, "{message}");
        assert!((found.cost.unwrap() / cost - 1.0).abs() < 1e-9, "{message}");
    }
}

#[test]
fn copies_by_powers_of_two_have_the_same_bits() {
    let (small, large) = ((2f64.powi(-10), 2f64.powi(-31)), (2f64.powi(6), 2f64.powi(20)));
    has_the_same_bits(named("trot"), Criterion::Energy, small);
    has_the_same_bits(named("amble"), Criterion::Torque, large);
    has_the_same_bits(named("curvet"), Criterion::Torque, small);
    has_the_same_bits(named("rabbit/walk"), Criterion::Energy, large);
    has_the_same_bits(&rubbing::dry(named("trot")), Criterion::Torque, large);
    has_the_same_bits(&rubbing::dry(named("rabbit/walk")), Criterion::Energy, small);
}

#[test]
fn copies_by_powers_of_two_are_the_same_program() {
    for gait in GAITS {
        for criterion in Criterion::ALL {
            is_the_same_program(*gait, criterion, (2f64.powi(-10), 2f64.powi(20)));
            is_the_same_program(*gait, criterion, (2f64.powi(6), 2f64.powi(-31)));
            is_the_same_program(&rubbing::dry(*gait), criterion, (2f64.powi(6), 2f64.powi(20)));
        }
    }
}

#[test]
fn copies_of_any_size_and_weight_have_the_same_optima() {
    has_the_same_cost(named("trot"), Criterion::Torque, &SIZES[..2]);
    has_the_same_cost(named("rabbit/walk"), Criterion::Energy, &SIZES[2..]);
}

/// All robots that are shipped, up and down.
#[test]
#[ignore = "minutes"]
fn copies_of_all_gaits_have_the_same_optima() {
    for gait in walking() {
        for criterion in Criterion::ALL {
            has_the_same_bits(*gait, criterion, (2f64.powi(-10), 2f64.powi(20)));
            has_the_same_cost(*gait, criterion, &SIZES);
        }
    }
}

/// RABBIT of 2.4 cm and 0.9 g: an independent value.
#[test]
fn a_rabbit_of_two_centimetres_walks() {
    let by = Factors::new(0.03, 2.7e-5);
    let small = Copy::new(named("rabbit/walk"), by);
    let result = optimize(&small, Criterion::Energy, 0.10392304845413264, 8);
    assert!((result.cost.unwrap() / 6.7598158e-4 - 1.0).abs() < 1e-6, "{} {:?}", result.message, result.cost);
}

/// A cost per metre grows like 1/speed where the robot hardly does more than step in place, and must not decide. What cannot be
/// told from standing is refused; nothing is an optimum at another speed than the one asked.
#[test]
fn slow_gaits_are_right_or_refused_in_words() {
    for name in ["trot", "rabbit/walk"] {
        let mut powers = Vec::new();
        for speed in [1e-3, 1e-4, 1e-6, 1e-9, 1e-12] {
            let result = optimize(named(name), Criterion::Torque, speed, 2);
            match result.cost {
                Some(cost) => {
                    let travel = result.step_length.unwrap() / result.durations.iter().sum::<f64>();
                    assert!((travel / speed - 1.0).abs() < 1e-6, "{name} at {speed:e}: walks at {travel:e}");
                    powers.push(cost * speed);
                }
                None => assert!(speed < 1e-5 && !result.message.is_empty(), "{name} at {speed:e}: {}", result.message),
            }
        }
        // That of stepping in place.
        let [first, .., last] = powers[..] else { panic!("{name}: {powers:?}") };
        assert!((last / first - 1.0).abs() < 0.05, "{name}: {powers:?}");
    }
}

/// What is known to be reached; that of RABBIT's torque from elsewhere too.
#[test]
fn gaits_at_low_speeds_are_found() {
    let slow = [
        ("trot", Criterion::Energy, 0.001, 835.870),
        ("rabbit/walk", Criterion::Energy, 0.003, 300.213),
        ("rabbit/walk", Criterion::Torque, 0.003, 2291.964),
    ];
    for (name, criterion, speed, cost) in slow {
        let result = optimize(named(name), criterion, speed, 8);
        let found = result.cost.unwrap_or_else(|| panic!("{name} {criterion:?} at {speed}: {}", result.message));
        assert!(found < cost * (1.0 + 1e-5), "{name} {criterion:?} at {speed}: {found}");
    }
}

/// Backwards, too, a metre costs something.
#[test]
fn gaits_go_backwards() {
    for (name, criterion) in [("trot", Criterion::Energy), ("rabbit/walk", Criterion::Torque)] {
        let result = optimize(named(name), criterion, -0.4, 4);
        assert_eq!(result.status, Status::Optimal, "{name}: {}", result.message);
        assert!(result.cost.unwrap() > 0.0 && result.step_length.unwrap() < 0.0, "{name}: {:?}", result.cost);
    }
}
