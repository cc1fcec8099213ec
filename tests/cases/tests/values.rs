//! What is issued is confirmed, and is what is right.

use piaffe::audit::Audit;
use piaffe::examine::Examination;
use piaffe::model::Gait;
use piaffe::motion::Criterion::{self, Energy, Torque};
use piaffe::result::GaitResult;
use piaffe::search::multi_start::{Settings, search};
use piaffe_cases::GAITS;

fn gait(key: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == key).unwrap()
}

fn optimum(key: &str, criterion: Criterion, speed: f64) -> GaitResult {
    let settings = Settings::default();
    let found = search(gait(key), criterion, speed, &settings, &|_| {});
    let mut result = GaitResult::new(gait(key), criterion, speed, &found, &settings, || 0.0);
    result.examine(gait(key), Examination::Full);
    result
}

fn confirmed(result: &GaitResult) {
    let audit = Audit::of(result, GAITS);
    assert!(audit.is_confirmed(), "{}: {:?}", result.name(), audit.objection());
}

fn costs(key: &str, criterion: Criterion, speed: f64, expected: f64) {
    let result = optimum(key, criterion, speed);
    let cost = result.cost.unwrap_or(f64::NAN);
    // The best that was known; less is welcome.
    assert!(cost <= expected * (1.0 + 1e-5), "{}: {cost}, not {expected}: {}", result.name(), result.message);
    confirmed(&result);
}

/// Its legs are straight and alike, so the swing foot passes the stance foot at a height of zero and with no slope in the motion's
/// variables: where the program says optimum all the same, it must hold from the motion alone.
#[test]
fn what_is_said_of_a_compass_walker_is_confirmed() {
    let mut optima = 0;
    for speed in [0.3, 0.5, 0.8] {
        for criterion in Criterion::ALL {
            let result = optimum("walk", criterion, speed);
            confirmed(&result);
            optima += usize::from(result.is_optimal());
        }
    }
    assert!(optima >= 4, "{optima} of 6");
}

#[test]
fn a_biped_with_its_knees_the_other_way_walks_at_every_speed() {
    // Least energy was known from smooth descents; with a knee held still it is less, 16.38 N at 0.39 m/s.
    costs("bird/walk", Energy, 0.39, 16.952);
    costs("bird/walk", Energy, 0.42, 19.073);
    costs("bird/walk", Energy, 0.51, 22.109);
    costs("bird/walk", Torque, 0.40, 99.3840);
    for speed in [0.40, 0.45, 0.48] {
        let cost = optimum("bird/walk", Energy, speed).cost.unwrap_or(f64::NAN);
        assert!((16.38..22.109).contains(&cost), "{speed}: {cost}");
    }
}

#[test]
fn a_robot_of_two_centimetres_is_a_robot() {
    let speed = 0.10392304845413264;
    costs("small/walk", Energy, speed, 6.7598158e-4);
}
