//! Springs beside motors: what they give the motors need not, what they take they give back, and a robot's file says which.

#[path = "gaits/energy.rs"]
mod energy;

use energy::energy;
use piaffe::Robot;
use piaffe::examine::Examination;
use piaffe::four_legs::Lift;
use piaffe::interpreter::Interpreted;
use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::result::{GaitResult, Status};
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sensitivity::sensitivities;
use piaffe::sqp::Control;
use piaffe::units::Units;
use piaffe::verify::verify;
use piaffe::walk::{Moment, Walk};

const QUADRUPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec");
const CAT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/friction/cat");

/// Of haunches and knees: N·m/rad, rad.
type Springs = [[f64; 2]; 2];
/// Those of the haunches pull the legs back, those of the knees straighten them.
const SOFT: Springs = [[1.5, -0.1], [3.0, -0.6]];
/// They do nothing yet.
const SLACK: Springs = [[0.0, -0.1], [0.0, -0.6]];
const GAITS: [&str; 4] = ["trot", "amble", "curvet", "running_trot"];

fn with(springs: Springs) -> Robot {
    let [[haunch, haunch_rest], [knee, knee_rest]] = springs;
    let numbers = [
        ("joints.haunch.stiffness", haunch),
        ("joints.haunch.rest_angle", haunch_rest),
        ("joints.knee.stiffness", knee),
        ("joints.knee.rest_angle", knee_rest),
    ];
    Robot::read(QUADRUPED).unwrap().with_all(numbers).unwrap()
}

/// A robot that rubs, with stiff knees that are geared by a spring on each side of zero.
fn cat() -> Robot {
    let springs = [
        ("joints.h.stiffness", 0.4),
        ("joints.h.rest_angle", 0.3),
        ("joints.k.stiffness", 1.6),
        ("joints.k.rest_angle", -1.0),
    ];
    Robot::read(CAT).unwrap().with_all(springs).unwrap()
}

fn speed(gait: &dyn Gait) -> f64 {
    if gait.description().flies() { 1.0 } else { 0.6 }
}

fn settings(starts: usize) -> Settings {
    Settings { starts: Some(starts), seed: 1, examination: Examination::Full }
}

/// A motion at which nothing in particular is optimal.
fn motion(gait: &dyn Gait) -> Motion {
    search(gait, Criterion::Torque, speed(gait), &settings(2), &|_| {}).optima[0].local.motion.clone()
}

/// What springs hold, J.
fn stored(gait: &Interpreted, m: &Moment) -> f64 {
    let joints = gait.description().joints.iter().zip(&m.q);
    joints.map(|(joint, q)| 0.5 * joint.stiffness * (q - joint.rest).powi(2)).sum()
}

/// The energy of the robot and of its springs grows by what the motors give: feet at rest and gravity take none. The spring's is
/// written in another way than its torque.
#[test]
fn energy_of_robot_and_springs_grows_by_the_motors_work() {
    let robot = with(SOFT);
    for name in GAITS {
        let gait = robot.gait(name).unwrap();
        let d = gait.description();
        let intervals = 1000;
        let walk = Walk::even(&gait, &motion(&gait), intervals).unwrap();
        let unit = Units::new(d).force() * Units::new(d).length;
        let held =
            walk.moments.iter().map(|m| stored(&gait, m)).fold([f64::INFINITY, 0.0], |[a, b], x| [x.min(a), x.max(b)]);
        assert!(held[1] - held[0] > 1e-2 * unit, "{name}: {held:?} of {unit}");
        for (k, phase) in walk.phases.iter().enumerate() {
            let moments: Vec<&Moment> = walk.moments.iter().filter(|m| m.phase == k).collect();
            let energy = |m: &Moment| energy(&gait, m) + stored(&gait, m);
            let step = phase.duration / intervals as f64;
            let power = |m: &Moment| m.torque.iter().zip(&m.qd).map(|(torque, rate)| torque * rate).sum::<f64>();
            // Simpson's rule.
            let work: f64 = moments
                .windows(3)
                .step_by(2)
                .map(|m| step / 3.0 * (power(m[0]) + 4.0 * power(m[1]) + power(m[2])))
                .sum();
            let gain = energy(moments[moments.len() - 1]) - energy(moments[0]);
            assert!((gain - work).abs() < 1e-8 * unit, "{name} {k}: {gain} {work}");
        }
    }
}

/// What a spring gives, a motor need not: nothing else of a motion changes.
#[test]
fn motions_do_not_know_of_springs() {
    for name in GAITS {
        let [bare, sprung] = [SLACK, SOFT].map(|springs| with(springs).gait(name).unwrap());
        let motion = motion(&bare);
        let walks = [&bare, &sprung].map(|gait| Walk::even(gait, &motion, 40).unwrap().moments);
        for (a, b) in walks[0].iter().zip(&walks[1]) {
            assert_eq!((&a.q, &a.qd, &a.qdd, a.force, a.platform), (&b.q, &b.qd, &b.qdd, b.force, b.platform));
            for (j, joint) in sprung.description().joints.iter().enumerate() {
                // Of both real legs that the virtual one stands for.
                let [stiffness, rest] = SOFT[j % 2];
                assert_eq!((joint.stiffness, joint.rest), (2.0 * stiffness, rest));
                let spring = 2.0 * stiffness * (b.q[j] - rest);
                assert!((b.torque[j] - a.torque[j] - spring).abs() < 1e-12, "{name} {j}");
            }
        }
        // Each real leg has springs of its own.
        let lifts = [&bare, &sprung].map(|gait| Lift::even(gait, &motion, 20).unwrap());
        for (a, b) in lifts[0].instants.iter().zip(&lifts[1].instants) {
            let of_virtual: f64 = b.efforts.virtual_legs.powers.iter().sum();
            let members: f64 = b.torque.iter().zip(b.posture.rates()).map(|(torque, rate)| torque * rate).sum();
            assert!((members - of_virtual).abs() < 1e-6 * (1.0 + of_virtual.abs()), "{name}: {members} {of_virtual}");
            assert_eq!(a.posture.q, b.posture.q);
        }
    }
}

/// Of one motion least torque is a parabola in a spring's stiffness: the verifier's, which reads springs by itself, has the lowest point
/// that a fit of the walk's torques to its angles has.
#[test]
fn the_best_spring_of_a_motion_is_a_fit_of_torques_to_angles() {
    let bare = with(SLACK).gait("trot").unwrap();
    let motion = motion(&bare);
    let cost = |stiffness: f64| {
        let gait = with([[0.0, 0.0], [stiffness, -0.6]]).gait("trot").unwrap();
        verify(gait.description(), &motion, 0.6, 2001).unwrap().costs.torque
    };
    let [at_0, at_1, at_2, at_3] = [0.0, 1.0, 2.0, 3.0].map(cost);
    assert!((at_3 - 3.0 * at_2 + 3.0 * at_1 - at_0).abs() < 1e-9 * at_0);
    let (slope, bend) = (-1.5 * at_0 + 2.0 * at_1 - 0.5 * at_2, at_0 - 2.0 * at_1 + at_2);
    let walk = Walk::even(&bare, &motion, 4000).unwrap();
    let knees: Vec<usize> = (0..bare.description().joints()).filter(|j| j % 2 == 1).collect();
    let (mut across, mut square) = (0.0, 0.0);
    for (k, m) in walk.moments.iter().enumerate() {
        let at_end = |other: Option<&Moment>| other.is_none_or(|other| other.phase != m.phase);
        let half = at_end(walk.moments.get(k + 1)) || at_end(k.checked_sub(1).and_then(|k| walk.moments.get(k)));
        let weight = if half { 0.5 } else { 1.0 };
        for j in &knees {
            let angle = 2.0 * (m.q[*j] + 0.6);
            across += weight * m.torque[*j] * angle;
            square += weight * angle * angle;
        }
    }
    let (parabola, fit) = (-slope / bend, -across / square);
    assert!((parabola - fit).abs() < 1e-5 * (1.0 + fit.abs()), "{parabola} {fit}");
}

/// Optima have a receipt from springs of the verifier's own, and a certificate; also where joints rub.
#[test]
fn optima_verify_and_are_certified() {
    let (quadruped, cat) = (with(SOFT), cat());
    let gaits =
        GAITS.map(|name| (quadruped.gait(name).unwrap(), 1.0)).into_iter().chain([(cat.gait("run").unwrap(), 1.2)]);
    for (gait, of_cat) in gaits {
        let speed = speed(&gait) * of_cat;
        for criterion in Criterion::ALL {
            let settings = settings(4);
            let found = search(&gait, criterion, speed, &settings, &|_| {});
            let mut result = GaitResult::new(&gait, criterion, speed, &found, &settings, || 0.0);
            result.examine(&gait, Examination::Full);
            let what = format!("{} {criterion:?}: {}", gait.description().key, result.message);
            assert_eq!(result.status, Status::Optimal, "{what}");
            assert!(result.certificate.as_ref().is_some_and(|c| c.is_certified()), "{what}");
            assert!(result.optimality.as_ref().is_some_and(|o| o.residual() < 1e-5), "{what}");
        }
    }
}

/// The least criterion of the same gait of another robot, near a known optimum.
fn cost(gait: &dyn Gait, criterion: Criterion, speed: f64, near: &Local) -> f64 {
    let local = Task { gait, criterion, speed }.follow(&near.theta, &mut |_| Control::Continue);
    assert!(local.status.is_optimal(), "{:?}", local.status);
    local.costs.of(criterion)
}

#[test]
fn slopes_in_springs_are_those_of_optima_of_other_robots() {
    let of_quadruped = ["haunch.stiffness", "haunch.rest_angle", "knee.stiffness", "knee.rest_angle"];
    let of_cat = ["h.stiffness", "h.rest_angle", "k.stiffness", "k.rest_angle"];
    let quadruped = with(SOFT);
    let asked = [(&quadruped, "trot", 0.6, of_quadruped), (&quadruped, "curvet", 0.6, of_quadruped)];
    for (robot, name, speed, levers) in asked.into_iter().chain([(&cat(), "run", 1.2, of_cat)]) {
        let gait = robot.gait(name).unwrap();
        for criterion in Criterion::ALL {
            let local = search(&gait, criterion, speed, &settings(4), &|_| {}).optima[0].local.clone();
            let found = sensitivities(&gait, criterion, speed, &local.motion).unwrap();
            let best = local.costs.of(criterion);
            for lever in levers {
                let lever = format!("joints.{lever}");
                let slope = found.slopes.iter().find(|s| s.parameter == lever).unwrap_or_else(|| panic!("no {lever}"));
                let h = 1e-3 * slope.value;
                let [above, below] = [h, -h].map(|by| {
                    let other = robot.with(&lever, slope.value + by).unwrap();
                    cost(&other.gait(name).unwrap(), criterion, speed, &local)
                });
                let differences = (above - below) / (2.0 * h) * slope.value / best;
                let (elasticity, error) = (slope.elasticity, (slope.elasticity - differences).abs());
                let what = format!("{name} {criterion:?} {lever}: {elasticity} {differences}");
                assert!(error < 1e-4 * (1.0 + elasticity.abs()), "{what}");
                assert!(elasticity.abs() > 1e-5, "{what}");
            }
        }
    }
}

/// A spring that does nothing yet tells what a little of it would be worth.
#[test]
fn a_slack_spring_has_the_slope_to_the_side_where_it_pulls() {
    let slack = with(SLACK);
    let gait = slack.gait("trot").unwrap();
    let local = search(&gait, Criterion::Torque, 0.6, &settings(4), &|_| {}).optima[0].local.clone();
    let found = sensitivities(&gait, Criterion::Torque, 0.6, &local.motion).unwrap();
    for joint in ["haunch", "knee"] {
        let lever = format!("joints.{joint}.stiffness");
        let slope = found.slopes.iter().find(|s| s.parameter == lever).unwrap();
        let at = |stiffness: f64| {
            let other = slack.with(&lever, stiffness).unwrap();
            cost(&other.gait("trot").unwrap(), Criterion::Torque, 0.6, &local)
        };
        let h = 2e-2;
        let differences = (-1.5 * at(0.0) + 2.0 * at(h) - 0.5 * at(2.0 * h)) / h;
        assert!((slope.slope - differences).abs() < 1e-4 * differences.abs(), "{lever}: {} {differences}", slope.slope);
        assert!(!found.slopes.iter().any(|s| s.parameter == format!("joints.{joint}.rest_angle")), "{joint}");
    }
}
