//! Rows against what the same questions give when they are asked alone.

use piaffe_interpreter::Robot;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::examine::Examination;
use piaffe_optimizer::result::Status;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_sqp::Control;
use piaffe_study::difference::{Difference, Side};
use piaffe_study::{Answers, Beyond, Column, Designs, Outcome, Row, Search, Study, Vary};
use std::collections::BTreeSet;

fn quadruped() -> Robot {
    Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../model-spec")).unwrap()
}

fn varied(texts: &[&str]) -> Vec<Vary> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn study(robot: Robot, designs: Designs, gait: &str) -> Study {
    Study {
        robot,
        designs,
        gaits: vec![gait.into()],
        criteria: Criterion::ALL.to_vec(),
        speeds: vec![0.6],
        real_legs: false,
        search: Search::default(),
        beyond: BTreeSet::new(),
    }
}

fn rows(study: &Study) -> Vec<Row> {
    assert_eq!(study.faults(), [""; 0]);
    Answers::new(study).rows(&(0..study.points()).collect::<Vec<_>>())
}

/// Of a robot that was derived with others, and of one with kernels of its own.
#[test]
fn a_row_is_what_the_robot_gives_alone() {
    let designs =
        Designs::grid(&varied(&["links.thigh.mass=1.2,2.0", "limits.friction=0.6", "links.shin.length=0.14"]));
    let study = Study { beyond: Beyond::ALL.into(), ..study(quadruped(), designs.unwrap(), "trot") };
    for row in rows(&study) {
        let optimum = row.optimum.as_ref().unwrap();
        let gait = study.designs.robot(&study.robot, row.design).unwrap().gait("trot").unwrap();
        let task = Task { gait: &gait, criterion: row.criterion, speed: row.speed };
        let mut alone = task.optimize().unwrap();
        alone.examine(&gait, Examination::Full);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-7 * a.abs().max(b.abs());
        assert!(near(row.cost().unwrap(), alone.cost.unwrap()), "{row:?} {:?}", alone.cost);
        assert!(optimum.durations.iter().zip(&alone.durations).all(|(a, b)| (a - b).abs() < 1e-5));
        assert_eq!(optimum.active, alone.receipt.as_ref().unwrap().active);
        assert_eq!(optimum.certificate, alone.certificate.as_ref().map(|c| c.standing));
        let slopes = alone.sensitivities.unwrap().slopes;
        let slope = |name: &str| slopes.iter().find(|slope| slope.numbers.iter().any(|n| n == name)).unwrap().slope;
        let told = optimum.slopes.as_ref().unwrap();
        for (k, name) in study.designs.names().iter().enumerate() {
            // A limit that is not active has no price, on either side but for rounding.
            let (own, of_lever) = (told.numbers[k].unwrap(), slope(name));
            assert!((own - of_lever).abs() <= 1e-4 * (own.abs() + row.cost().unwrap()), "{name}: {own} {of_lever}");
        }
        assert!((told.speed - slope("speed")).abs() <= 1e-4 * told.speed.abs());
    }
}

#[test]
fn an_answer_depends_on_its_point_alone() {
    let designs =
        Designs::sample(&varied(&["links.{thigh,shin}.mass=1.0..2.0", "limits.swing_clearance=0.0..0.02"]), 6);
    let study = study(quadruped(), designs.unwrap(), "trot");
    let all = rows(&study);
    let answers = Answers::new(&study);
    assert_eq!([answers.row(7), answers.row(2)], [all[7].clone(), all[2].clone()]);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| rows(&study)), all);
}

#[test]
fn what_is_no_robot_or_has_no_motion_says_why() {
    let designs = Designs::grid(&varied(&["links.thigh.mass=-1,1.6", "actuators.knee_motor.max_torque=0.001,0.4"]));
    let search = Search { starts: Some(2), seed: 1 };
    let study = Study { search, ..study(quadruped(), designs.unwrap(), "trot") };
    let rows = rows(&study);
    let status: Vec<Outcome> = rows.iter().step_by(2).map(|row| row.status).collect();
    let searched = [Status::Infeasible, Status::Optimal].map(Outcome::Searched);
    assert_eq!(status, [Outcome::NoRobot, Outcome::NoRobot, searched[0], searched[1]]);
    assert!(rows[0].reason.as_ref().unwrap().contains("links.thigh.mass"));
    assert!(rows[4].conflict.iter().any(|limit| limit.contains("torque of knee")), "{:?}", rows[4].conflict);
    assert!(rows.iter().all(|row| row.optimum.is_some() == (row.status == Outcome::Searched(Status::Optimal))));
}

#[test]
fn every_wrong_name_is_told_at_once() {
    let designs =
        Designs::grid(&varied(&["links.thigh.mas=1", "links.{thigh,shn}.mass=1", "gravity=9.81", "gravity=3"]));
    let study = Study { speeds: vec![-0.1], ..study(quadruped(), designs.unwrap(), "tort") };
    let faults = study.faults().join("\n");
    for told in [
        "did you mean `links.thigh.mass`",
        "did you mean `links.shin.mass`",
        "gravity is varied twice",
        "`tort`",
        "-0.1",
    ] {
        assert!(faults.contains(told), "{told}: {faults}");
    }
}

/// Of a gait whose real legs bear unequal shares, and of one in which equal shares keep to all limits.
#[test]
fn limits_at_each_real_leg_are_those_of_a_robot_that_is_asked_for_alone() {
    for (gait, speed) in [("amble", 0.4), ("trot", 0.6)] {
        let designs = Designs::grid(&varied(&["links.thigh.mass=1.5"])).unwrap();
        let study = Study { real_legs: true, speeds: vec![speed], ..study(quadruped(), designs, gait) };
        for row in rows(&study) {
            let derived = study.designs.robot(&study.robot, row.design).unwrap().gait(gait).unwrap();
            let task = Task { gait: &derived, criterion: row.criterion, speed };
            let alone = task.answer(true, &Settings::default(), &|_| Control::Continue).unwrap();
            let near = |a: f64, b: Option<f64>| (a - b.unwrap()).abs() <= 1e-6 * a;
            let (cost, without) = (row.cost().unwrap(), row.optimum.as_ref().unwrap().virtual_cost.unwrap());
            assert!(
                near(cost, alone.cost) && near(without, alone.virtual_cost),
                "{row:?} {:?} {:?}",
                alone.cost,
                alone.virtual_cost
            );
            assert_eq!(cost > 1.01 * without, gait == "amble", "what they cost: {cost}, {without}");
        }
    }
    let base = Study { real_legs: true, ..study(quadruped(), Designs::base(), "trot") };
    assert!(Column::all(&base).contains(&Column::VirtualCost));
    let mut files = base.robot.files().clone();
    for file in &mut files.gaits {
        file.text = file.text.replace("half_steps = \"mirrored\"", "half_steps = \"distinct\"");
    }
    let uneven = Study { robot: Robot::new(files).unwrap(), gaits: vec!["amble".into()], ..base };
    let faults = uneven.faults();
    assert!(faults.len() == 1 && faults[0].contains("halves mirror each other"), "{faults:?}");
}

/// A robot with a foot of some mass and zeros in its file: what differs is explained where it has a slope, and told where not.
#[test]
fn differences_follow_from_slopes_in_the_numbers_of_the_file() {
    let heron = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/sensitivity/heron")).unwrap();
    let result = |numbers: &[(&str, f64)]| {
        let gait = heron.with_all(numbers.iter().copied()).unwrap().gait("walk").unwrap();
        let mut result = Task { gait: &gait, criterion: Criterion::Torque, speed: 0.12 }.optimize().unwrap();
        result.examine(&gait, Examination::Quick);
        (result, gait)
    };
    let base = result(&[]);
    let explained = |numbers: &[(&str, f64)]| {
        let ((a, of_a), (b, of_b)) = (&base, &result(numbers));
        Difference::new(Side { result: a, gait: of_a }, Side { result: b, gait: of_b }).prediction.unwrap()
    };
    for (name, value) in [
        ("links.meta.foot_mass", 0.000306),
        ("links.meta.length.y", -0.0152),
        ("joints.hip.damping", 5e-8),
        ("legs.{left,right}.mount.x", 1e-4),
    ] {
        let difference = explained(&[(name, value)]);
        assert!(difference.without_slope.is_empty(), "{name}: {:?}", difference.without_slope);
        let parts: Vec<&str> = difference.parts.iter().map(|part| part.parameter.as_str()).collect();
        assert_eq!(parts, [name]);
        let off = (difference.mean - difference.difference).abs();
        assert!(off < 5e-3 * difference.difference.abs(), "{name}: {} {}", difference.mean, difference.difference);
    }
    let damped = explained(&[("joints.knee.damping", 1e-7)]);
    assert_eq!(damped.without_slope, ["joints.knee.damping"], "the file has none");
}
