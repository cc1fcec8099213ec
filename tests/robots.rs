//! The robots of `robots/`, taken as they stand in their files: they do what their files say.

use piaffe::Robot;
use piaffe::motion::Criterion::Torque;
use piaffe::result::GaitResult;
use piaffe::search::local::Task;
use piaffe::search::multi_start::Settings;
use rayon::prelude::*;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/robots");

fn robot(name: &str) -> Robot {
    Robot::read(format!("{FOLDER}/{name}")).unwrap()
}

fn least_torque(robot: &Robot, gait: &str, speed: f64, starts: usize) -> GaitResult {
    let gait = robot.gait(gait).unwrap();
    let task = Task { gait: &gait, criterion: Torque, speed };
    task.search(&Settings { starts: Some(starts), ..Settings::default() }, &[], &|_| {})
}

/// What the comment of a gait file says: costs, N²·m·s, and speeds, m/s.
fn said(text: &str) -> Vec<(f64, f64)> {
    let line = text.lines().find_map(|line| line.split_once("(local optima): ")).unwrap().1;
    let pair = |part: &str| {
        let (cost, speed) = part.trim_end_matches('.').trim_end_matches(" m/s").split_once(" at ")?;
        Some((cost.parse().ok()?, speed.parse().ok()?))
    };
    line.split(", ").map(|part| pair(part).unwrap()).collect()
}

#[test]
fn gaits_do_what_their_files_say() {
    for name in ["go2", "solo8"] {
        let robot = robot(name);
        let asked: Vec<(String, f64, f64)> = robot
            .files()
            .gaits
            .iter()
            .zip(robot.gaits())
            .flat_map(|(file, gait)| said(&file.text).into_iter().map(move |(cost, speed)| (gait.clone(), cost, speed)))
            .collect();
        assert!(asked.len() >= 8, "{asked:?}");
        // The slowest of each gait, from nothing.
        let first = |k: &usize| *k == 0 || asked[k - 1].0 != asked[*k].0;
        (0..asked.len()).into_par_iter().filter(first).for_each(|k| {
            let (gait, cost, speed) = &asked[k];
            let result = least_torque(&robot, gait, *speed, 8);
            let found = result.cost.unwrap_or(f64::NAN);
            assert!(
                found <= cost * (1.0 + 1e-4),
                "{name} {gait} at {speed} m/s: {found}, not {cost}: {}",
                result.message
            );
        });
    }
}

/// A knee that only just reaches its stop, and a foot its clearance, between nodes: rows that move from round to round. What the
/// solver calls an optimum, its receipt must confirm at every speed.
#[test]
fn rows_between_nodes_that_move_keep_their_receipts() {
    let go2 = robot("go2");
    (57..=66).into_par_iter().chain([80, 90]).for_each(|hundredths| {
        let speed = f64::from(hundredths) / 100.0;
        let result = least_torque(&go2, "trot", speed, 1);
        assert!(result.is_optimal(), "{speed} m/s: {}", result.message);
    });
}
