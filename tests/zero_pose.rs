//! No pose is special: robots whose joints count from another zero are the same robots, and the search finds the same optima.

use piaffe::Robot;
use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::search::multi_start::{Settings, search};
use std::f64::consts::{FRAC_PI_2, PI};

/// A leg of two links that hang straight down where its joints are at zero.
struct Leg {
    links: [Link; 2],
    /// Stops of its joints as they are written, rad.
    ranges: [&'static str; 2],
}

struct Link {
    name: &'static str,
    length: f64,
    com: f64,
}

const QUADRUPED: Leg = Leg {
    links: [Link { name: "thigh", length: 0.15, com: 0.139 }, Link { name: "shin", length: 0.15, com: 0.083 }],
    ranges: ["[-0.5236, 1.0472]", "[-1.7453, -0.2618]"],
};

const RABBIT: Leg = Leg {
    links: [Link { name: "femur", length: 0.4, com: 0.163 }, Link { name: "tibia", length: 0.4, com: 0.128 }],
    ranges: ["[-1.2, 1.8]", "[-1.8, -0.03]"],
};

/// The robot with its joints' zeros at these angles of before, rad.
fn counted_from(robot: &Robot, leg: &Leg, zeros: [f64; 2]) -> Robot {
    let mut files = robot.files().clone();
    let text = &mut files.robot.text;
    let mut turn = 0.0;
    for ((link, range), zero) in leg.links.iter().zip(leg.ranges).zip(zeros) {
        turn += zero;
        let hanging = |depth: f64| format!("[{:?}, {:?}, 0.0]", depth * turn.sin(), -depth * turn.cos());
        let at = text.find(&format!("[links.{}]", link.name)).unwrap();
        let (before, after) = text.split_at(at);
        let after =
            after.replacen(&format!("length = {}", link.length), &format!("length = {}", hanging(link.length)), 1);
        let after = after.replacen(&format!("com = {}", link.com), &format!("com = {}", hanging(link.com)), 1);
        assert!(after.contains(range));
        *text = format!("{before}{}", after.replace(range, &shifted(range, zero)));
    }
    Robot::new(files).unwrap()
}

/// Stops that count from another zero.
fn shifted(range: &str, zero: f64) -> String {
    let stops = range.trim_matches(['[', ']']).split(", ").map(|stop| stop.parse::<f64>().unwrap() - zero);
    format!("{:?}", stops.collect::<Vec<_>>())
}

fn optimum(robot: &Robot, gait: &str, criterion: Criterion, speed: f64) -> GaitResult {
    let gait = robot.gait(gait).unwrap();
    let settings = Settings { starts: Some(8), seed: 1, ..Settings::default() };
    GaitResult::new(&gait, criterion, speed, &search(&gait, criterion, speed, &settings, &|_| {}), &settings, || 0.0)
}

fn same_optima(folder: &str, leg: &Leg, gait: &str) {
    let robot = Robot::read(format!("{}/{folder}", concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec"))).unwrap();
    for criterion in Criterion::ALL {
        let known = optimum(&robot, gait, criterion, 0.6).cost.unwrap();
        // Straight up, forward, and folded.
        for zeros in [[PI, 0.0], [-FRAC_PI_2, 0.3], [0.4, -1.2], [1.1 * PI, -0.2]] {
            let result = optimum(&counted_from(&robot, leg, zeros), gait, criterion, 0.6);
            let cost = result.cost.unwrap_or(f64::NAN);
            assert!(
                (cost / known - 1.0).abs() < 1e-6,
                "{gait} from {zeros:?}: {cost}, not {known}: {}",
                result.message
            );
        }
    }
}

#[test]
fn a_quadruped_trots_whatever_zero_means() {
    same_optima("", &QUADRUPED, "trot");
}

#[test]
fn a_biped_walks_whatever_zero_means() {
    same_optima("rabbit", &RABBIT, "walk");
}

/// Stops so wide that they say nothing of where down is.
#[test]
fn a_biped_with_wide_stops_and_its_legs_up_at_zero_walks() {
    let robot = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec/rabbit")).unwrap();
    let wide = |zeros| {
        let mut files = counted_from(&robot, &RABBIT, zeros).files().clone();
        let (written, free) = (shifted(RABBIT.ranges[0], zeros[0]), "[-6.28, 6.28]");
        assert!(files.robot.text.contains(&written));
        files.robot.text = files.robot.text.replace(&written, free);
        Robot::new(files).unwrap()
    };
    let [hanging, up] = [[0.0, 0.0], [PI, 0.0]].map(|zeros| optimum(&wide(zeros), "walk", Criterion::Torque, 0.6));
    let [hanging, up] = [hanging, up].map(|result| result.cost.unwrap());
    assert!((up / hanging - 1.0).abs() < 1e-6, "{up}, not {hanging}");
}
