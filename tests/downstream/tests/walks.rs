//! A crate of one's own has everything: optima with receipts, and functions for a controller.

use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::search::multi_start::{Settings, search};
use piaffe_downstream::{GAITS, stroll};

#[test]
fn a_robot_of_ones_own_walks_with_a_receipt() {
    let [gait] = GAITS else { panic!("one gait was described") };
    assert_eq!((gait.description().key, gait.description().robot), ("stroll", "toy"));
    let found = search(*gait, Criterion::Energy, 0.3, &Settings::default(), &|_| {});
    let result = GaitResult::new(*gait, Criterion::Energy, 0.3, &found, &Settings::default(), || 0.0);
    assert!(result.is_optimal(), "{}", result.message);
    assert!(result.receipt.is_some_and(|r| r.max_violation < 1e-6));
}

#[test]
fn a_controller_computes_the_same_bits() {
    let (q, qd, qdd) = ([0.3, -0.4, -0.2, -0.6, 0.1], [1.0, -0.5, 0.3, 2.0, -0.7], [3.0, 1.0, -2.0, 5.0]);
    let (ours, theirs) = (stroll::inverse1(&q, &qd, &qdd), piaffe_controller::stroll::inverse1(&q, &qd, &qdd));
    assert_eq!((ours.xdd, ours.gamma, ours.f), (theirs.xdd, theirs.gamma, theirs.f));
    assert_eq!(stroll::inertia(&q), piaffe_controller::stroll::inertia(&q));
}
