//! Joints that rub: what motors overcome costs, limits and is told, and moves nothing.

#[path = "gaits/energy.rs"]
mod energy;
#[path = "friction/robot.rs"]
mod robot;

use energy::energy;
use piaffe::Robot;
use piaffe::altered::Altered;
use piaffe::cycle::{Cycle, theta};
use piaffe::examine::Examination;
use piaffe::four_legs::Lift;
use piaffe::interpreter::Interpreted;
use piaffe::model::{Gait, Lever, RESTING_RATE};
use piaffe::motion::{Criterion, Motion};
use piaffe::result::{GaitResult, Status};
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::{Settings, search};
use piaffe::search::refine::dips;
use piaffe::sensitivity::sensitivities;
use piaffe::sqp::{Control, Problem, Values};
use piaffe::units::Units;
use piaffe::verify::{sample, verify};
use piaffe::walk::{Moment, Walk};
use robot::{Friction, GEARED, with};

/// m/s.
const SPEED: f64 = 0.6;
/// A gait in stance alone, one whose platform pitches, one that flies.
const GAITS: [&str; 3] = ["trot", "curvet", "running_trot"];

fn speed(gait: &dyn Gait) -> f64 {
    if gait.description().flies() { 1.0 } else { SPEED }
}

fn optima(gait: &dyn Gait, criterion: Criterion) -> GaitResult {
    let settings = Settings { starts: Some(4), seed: 1, ..Settings::default() };
    let found = search(gait, criterion, speed(gait), &settings, &|_| {});
    let mut result = GaitResult::new(gait, criterion, speed(gait), &found, &settings, || 0.0);
    result.examine(gait, Examination::Full);
    result
}

/// A motion at which nothing in particular is optimal.
fn motion(gait: &dyn Gait) -> Motion {
    let settings = Settings { starts: Some(1), seed: 1, ..Settings::default() };
    search(gait, Criterion::Torque, speed(gait), &settings, &|_| {}).optima[0].local.motion.clone()
}

#[test]
fn a_robot_whose_keys_say_no_friction_is_the_robot_without_them() {
    let none = Friction { damping: [0.0; 2], coulomb: [0.0; 2] };
    let plain = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec")).unwrap();
    for name in GAITS {
        let [bare, zero] = [plain.gait(name).unwrap(), with(none).gait(name).unwrap()];
        assert_eq!(format!("{:?}", bare.description()), format!("{:?}", zero.description()));
        // A zero that stands in a file has a slope.
        let is_damping = |lever: &&Lever| lever.name.ends_with(".damping");
        let (damping, levers): (Vec<&Lever>, Vec<&Lever>) = zero.levers().iter().partition(is_damping);
        assert_eq!(format!("{:?}", bare.levers()), format!("{levers:?}"));
        assert_eq!(damping.iter().map(|lever| lever.value).collect::<Vec<_>>(), [0.0; 2], "{name}");
    }
    let cost = |robot: &Robot| optima(&robot.gait("trot").unwrap(), Criterion::Energy);
    let [bare, zero] = [cost(&plain), cost(&with(none))].map(|r| (r.cost.unwrap().to_bits(), r.variables));
    assert_eq!(bare.0, zero.0);
    assert_eq!(format!("{:?}", bare.1), format!("{:?}", zero.1));
}

/// What friction turns into heat, W.
fn heat(gait: &Interpreted, m: &Moment) -> f64 {
    let joints = gait.description().joints.iter().zip(&m.qd);
    joints.map(|(joint, rate)| joint.damping * rate * rate + joint.coulomb * rate.abs()).sum()
}

/// The robot's energy grows by what the motors give less what friction takes: feet at rest and gravity take none.
#[test]
fn energy_grows_by_the_motors_work_less_heat() {
    let robot = with(GEARED);
    for name in GAITS {
        let gait = robot.gait(name).unwrap();
        let d = gait.description();
        let intervals = 1500;
        let motion = motion(&gait);
        let walk = Walk::even(&gait, &motion, intervals).unwrap();
        for (k, phase) in walk.phases.iter().enumerate() {
            let moments: Vec<&Moment> = walk.moments.iter().filter(|m| m.phase == k).collect();
            let energy = |m: &Moment| energy(&gait, m);
            let step = phase.duration / intervals as f64;
            let power = |m: &Moment| m.torque.iter().zip(&m.qd).map(|(torque, rate)| torque * rate).sum::<f64>();
            // Trapezes: the kinks of c |q̇| leave errors of second order.
            let over = |of: &dyn Fn(&Moment) -> f64| {
                moments.windows(2).map(|m| 0.5 * step * (of(m[0]) + of(m[1]))).sum::<f64>()
            };
            let (work, heat) = (over(&power), over(&|m| heat(&gait, m)));
            let gain = energy(moments[moments.len() - 1]) - energy(moments[0]);
            let unit = Units::new(d).force() * Units::new(d).length;
            assert!(heat > 1e-3 * unit, "{name}: {heat} of {unit}");
            assert!((gain - work + heat).abs() < 1e-5 * unit, "{name} {k}: {gain} {work} {heat}");
        }
    }
}

#[test]
fn motions_do_not_know_of_friction() {
    let none = Friction { damping: [0.0; 2], coulomb: [0.0; 2] };
    for name in GAITS {
        let [bare, rubs] = [with(none).gait(name).unwrap(), with(GEARED).gait(name).unwrap()];
        let motion = motion(&bare);
        let walks = [&bare, &rubs].map(|gait| Walk::even(gait, &motion, 40).unwrap().moments);
        for (a, b) in walks[0].iter().zip(&walks[1]) {
            assert_eq!((&a.q, &a.qd, &a.qdd, a.force, a.platform), (&b.q, &b.qd, &b.qdd, b.force, b.platform));
            for (j, joint) in rubs.description().joints.iter().enumerate() {
                let friction = joint.damping * a.qd[j] + joint.coulomb * a.qd[j].signum();
                assert!((b.torque[j] - a.torque[j] - friction).abs() < 1e-12, "{name} {j}");
            }
        }
        // The real legs share it as equals do.
        let lifts = [&bare, &rubs].map(|gait| Lift::even(gait, &motion, 20).unwrap());
        for (a, b) in lifts[0].instants.iter().zip(&lifts[1].instants) {
            assert_eq!(a.reactions.len(), b.reactions.len());
            let [of_bare, of_rubbing] = [a, b].map(|i| i.efforts.virtual_legs.powers.iter().sum::<f64>());
            let members: f64 = b.torque.iter().zip(b.posture.rates()).map(|(torque, rate)| torque * rate).sum();
            assert!(of_rubbing > of_bare - 1e-12);
            assert!((members - of_rubbing).abs() < 1e-6 * (1.0 + of_rubbing.abs()), "{name}: {members} {of_rubbing}");
        }
    }
}

/// Optima have a receipt from dynamics, friction and quadrature of the verifier's own, and a certificate.
#[test]
fn optima_verify_and_are_certified() {
    let damped = with(Friction { coulomb: [0.0; 2], ..GEARED });
    let dry = with(Friction { damping: [0.0; 2], ..GEARED });
    for (kind, robot) in [("damped", damped), ("dry", dry), ("both", with(GEARED))] {
        for name in GAITS {
            let gait = robot.gait(name).unwrap();
            for criterion in Criterion::ALL {
                let result = optima(&gait, criterion);
                let what = format!("{kind} {name} {criterion:?}: {}", result.message);
                assert_eq!(result.status, Status::Optimal, "{what}");
                let certified = result.certificate.as_ref().is_some_and(|c| c.is_certified());
                assert!(certified, "{what} {:?}", result.certificate.map(|c| c.gaps));
                assert!(result.optimality.as_ref().is_some_and(|o| o.residual() < 1e-5), "{what}");
                let motion = result.motion().unwrap();
                let receipt = verify(gait.description(), &motion, speed(&gait), 2001).unwrap();
                let finer = verify(gait.description(), &motion, speed(&gait), 8001).unwrap();
                let apart = |a: f64, b: f64| (a / b - 1.0).abs();
                assert!(apart(receipt.costs.energy, finer.costs.energy) < 1e-7, "{what}");
                assert!(apart(receipt.costs.torque, finer.costs.torque) < 1e-7, "{what}");
                // What is split inside elements is integrated to the order of interpolation: finer meshes agree ever better.
                let cycle = Cycle::resolving(&gait, criterion, speed(&gait), &theta(&motion)).unwrap();
                let mut twice = cycle.twice_as_fine().unwrap();
                twice.simulate(&theta(&motion)).unwrap();
                let [coarse, fine] = [&cycle, &twice].map(|cycle| apart(cycle.costs().torque, finer.costs.torque));
                assert!(coarse < 1e-4 && fine < 2e-6, "{what}: {coarse:e} {fine:e}");
                assert!(apart(cycle.costs().energy, receipt.costs.energy) < 1e-3, "{what}");
                // What is proven for all times holds where somebody looked: on both sides of a turn.
                let proven = result.certificate.iter().flat_map(|c| &c.bounds);
                for peak in &finer.peaks {
                    let name = format!("torque of {}", peak.name);
                    let bounds = proven.clone().filter(|bound| bound.constraint == name);
                    let bound = bounds.map(|bound| bound.margin.unwrap()).fold(f64::INFINITY, f64::min);
                    assert!(bound <= 1.0 - peak.torque / peak.max_torque + 1e-12, "{what} {name}: {bound}");
                }
                let samples = sample(gait.description(), &motion, 41).unwrap();
                let walk = Walk::even(&gait, &motion, 40).unwrap();
                for (s, m) in samples.iter().zip(&walk.moments) {
                    let same = s.torques.iter().zip(&m.torque).all(|(a, b)| (a - b).abs() < 1e-4 * (1.0 + a.abs()));
                    assert!(same, "{what} at {}: {:?} {:?}", s.t, s.torques, m.torque);
                }
            }
        }
    }
}

/// The least criterion of the same gait of another robot, near a known optimum.
fn cost(gait: &dyn Gait, criterion: Criterion, near: &Local) -> f64 {
    let local = Task { gait, criterion, speed: speed(gait) }.follow(&near.theta, &mut |_| Control::Continue);
    assert!(local.status.is_optimal(), "{:?}", local.status);
    local.costs.of(criterion)
}

#[test]
fn slopes_in_friction_are_those_of_optima_of_other_robots() {
    let robot = with(GEARED);
    for name in GAITS {
        let gait = robot.gait(name).unwrap();
        for criterion in Criterion::ALL {
            let settings = Settings { starts: Some(4), seed: 1, ..Settings::default() };
            let local = search(&gait, criterion, speed(&gait), &settings, &|_| {}).optima[0].local.clone();
            let found = sensitivities(&gait, criterion, speed(&gait), &local.motion).unwrap();
            let best = local.costs.of(criterion);
            for lever in ["haunch.damping", "knee.damping", "haunch.coulomb", "knee.coulomb"] {
                let lever = format!("joints.{lever}");
                let slope = found.slopes.iter().find(|s| s.parameter == lever).unwrap_or_else(|| panic!("no {lever}"));
                let h = 1e-3 * slope.value;
                let [above, below] = [h, -h].map(|by| {
                    let other = robot.with(&lever, slope.value + by).unwrap();
                    cost(&other.gait(name).unwrap(), criterion, &local)
                });
                let differences = (above - below) / (2.0 * h) * slope.value / best;
                let elasticity = slope.elasticity;
                let error = (elasticity - differences).abs();
                assert!(
                    error < 1e-4 * (1.0 + elasticity.abs()),
                    "{name} {criterion:?} {lever}: {elasticity} {differences}"
                );
                assert!(elasticity.abs() > 1e-5, "{name} {criterion:?} {lever}: {elasticity}");
            }
        }
    }
}

/// Where a joint rubs not at all, what a little friction would cost; a torque–speed limit of the optimum feels it too.
#[test]
fn slopes_from_no_friction_are_those_of_optima_of_robots_that_rub() {
    let smooth = with(Friction { damping: [0.0; 2], coulomb: [0.0; 2] });
    let gait = smooth.gait("trot").unwrap();
    let settings = Settings { starts: Some(4), seed: 1, ..Settings::default() };
    let local = search(&gait, Criterion::Torque, SPEED, &settings, &|_| {}).optima[0].local.clone();
    let found = sensitivities(&gait, Criterion::Torque, SPEED, &local.motion).unwrap();
    for lever in ["joints.haunch.damping", "joints.knee.damping"] {
        let slope = found.slopes.iter().find(|s| s.parameter == lever).unwrap_or_else(|| panic!("no {lever}"));
        let at = |damping: f64| {
            let other = smooth.with(lever, damping).unwrap();
            cost(&other.gait("trot").unwrap(), Criterion::Torque, &local)
        };
        let h = 5e-4;
        let differences = (-1.5 * at(0.0) + 2.0 * at(h) - 0.5 * at(2.0 * h)) / h;
        assert!((slope.slope - differences).abs() < 1e-4 * differences.abs(), "{lever}: {} {differences}", slope.slope);
    }
}

/// Least torque has a bend where a joint with dry friction comes to rest just at an end of a phase, and often its optimum there. A motion that
/// is best without dry friction keeps to all limits with it, too: an optimum costs no more.
#[test]
fn joints_come_to_rest_at_ends_of_phases() {
    let mut resting_at_ends = 0;
    for (robot, name, speeds) in
        [("cat", "run", &[0.86, 1.1, 1.12][..]), ("emu", "run", &[1.45, 1.5]), ("emu", "skip", &[1.0553, 1.5])]
    {
        let robot = Robot::read(format!("{}/tests/friction/{robot}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let gait = robot.gait(name).unwrap();
        let d = gait.description();
        let slick =
            Altered::new(&gait, |d| d.joints.to_mut().iter_mut().for_each(|joint| joint.coulomb = 0.0)).unwrap();
        for speed in speeds {
            let settings = Settings { starts: Some(4), seed: 1, examination: Examination::Full };
            let found = search(&gait, Criterion::Torque, *speed, &settings, &|_| {});
            let mut result = GaitResult::new(&gait, Criterion::Torque, *speed, &found, &settings, || 0.0);
            result.examine(&gait, Examination::Full);
            let what = format!("{name} at {speed}: {}", result.message);
            assert_eq!(result.status, Status::Optimal, "{what}");
            assert!(result.search.effort.successes >= 2, "{what}: {} of 4 starts", result.search.effort.successes);
            let bound = &search(&slick, Criterion::Torque, *speed, &settings, &|_| {}).optima[0].local.motion;
            let receipt = verify(d, bound, *speed, 2001).unwrap();
            let (bound, cost) = (receipt.costs.torque, result.cost.unwrap());
            assert!(cost < bound && cost > 0.97 * bound, "{what}: {cost} {bound}");
            let resting = RESTING_RATE * Units::new(d).rate();
            let motion = result.motion().unwrap();
            let ends = motion.phases.iter().flat_map(|course| {
                let (first, last) = (&course.qd_initial, &course.qd_final);
                [d.complete(first, course.betad_initial), d.complete(last, course.betad_final)]
            });
            let rests =
                |rates: Vec<f64>| d.joints.iter().zip(rates).any(|(j, rate)| j.coulomb != 0.0 && rate.abs() < resting);
            resting_at_ends += usize::from(ends.into_iter().any(rests));
        }
    }
    assert!(resting_at_ends >= 5, "{resting_at_ends}");
}

/// A motor that has all its torque to give where its joint turns around: the limit jumps there by what dry friction takes, between two nodes.
/// It holds on both sides of the turn, which moves.
#[test]
fn limits_hold_on_both_sides_of_a_turn() {
    let robot = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/friction/desk")).unwrap();
    let gait = robot.gait("bound").unwrap();
    let (criterion, speed) = (Criterion::Energy, 0.5);
    let settings = Settings { starts: Some(4), seed: 1, examination: Examination::Full };
    let found = search(&gait, criterion, speed, &settings, &|_| {});
    let mut result = GaitResult::new(&gait, criterion, speed, &found, &settings, || 0.0);
    result.examine(&gait, Examination::Full);
    assert_eq!(result.status, Status::Optimal, "{}", result.message);
    assert!(result.certificate.as_ref().is_some_and(|c| c.is_certified()));

    let theta = theta(&result.motion().unwrap());
    let mut cycle = Cycle::resolving(&gait, criterion, speed, &theta).unwrap();
    dips(&cycle).unwrap().impose(&mut cycle).unwrap();
    let (n, m) = (cycle.dimension(), cycle.inequalities());
    let mut values = Values::zeros(cycle.equalities(), m);
    let mut row = |cycle: &mut Cycle, theta: &[f64], i: usize| {
        cycle.evaluate(theta, &mut values).unwrap();
        cycle.linearize(theta).unwrap();
        let mut row = vec![0.0; n];
        cycle.inequality_row(i, &mut row);
        (values.inequalities[i], row)
    };
    row(&mut cycle, &theta, 0);
    let at_turns: Vec<usize> = (0..m).filter(|i| !cycle.row_turn(*i).is_empty()).collect();
    assert!(!at_turns.is_empty());
    let scale = cycle.scale();
    for i in at_turns {
        let (_, gradient) = row(&mut cycle, &theta, i);
        let largest = gradient.iter().zip(&scale).fold(0.0f64, |most, (by, scale)| most.max((by * scale).abs()));
        let (mut mu, mut hessian) = (vec![0.0; m], vec![0.0; n * n]);
        mu[i] = 1.0;
        assert!(cycle.hessian(&vec![0.0; cycle.equalities()], &mu, &mut hessian));
        let mut without = vec![0.0; n * n];
        assert!(cycle.hessian(&vec![0.0; cycle.equalities()], &vec![0.0; m], &mut without));
        let second = |j: usize, k: usize| (without[j * n + k] - hessian[j * n + k]) * scale[j] * scale[k];
        let bend = (0..n * n).fold(0.0f64, |most, at| most.max(second(at / n, at % n).abs()));
        for k in 0..n {
            let h = 1e-6 * scale[k];
            let [above, below] = [h, -h].map(|h| {
                let mut moved = theta.clone();
                moved[k] += h;
                row(&mut cycle, &moved, i)
            });
            let difference = (above.0 - below.0) / (2.0 * h) * scale[k];
            let exact = gradient[k] * scale[k];
            assert!((difference - exact).abs() < 1e-6 * largest, "{i} by {k}: {difference} {exact} of {largest}");
            for j in 0..n {
                let difference = (above.1[j] - below.1[j]) / (2.0 * h) * scale[k] * scale[j];
                let exact = second(j, k);
                assert!((difference - exact).abs() < 1e-5 * bend, "{i} by {j}, {k}: {difference} {exact} of {bend}");
            }
        }
    }
}
