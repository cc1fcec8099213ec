//! Optimality re-derived from the motion alone.

use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::{Criterion, Motion};
use piaffe::optimality::optimality;
use piaffe::result::KKT_RESIDUAL;
use piaffe::search::local::Local;
use piaffe::search::multi_start::{Settings, search};

fn optimum(gait: &dyn Gait, criterion: Criterion, speed: f64) -> Local {
    search(gait, criterion, speed, &Settings { starts: 2, seed: 1 }, &|_| {}).optima[0].local.clone()
}

#[test]
fn the_residual_is_what_the_optimizer_says_from_the_motion_alone() {
    for gait in GAITS {
        for criterion in Criterion::ALL {
            let local = optimum(*gait, criterion, 0.6);
            let found = optimality(*gait, criterion, 0.6, &local.motion).unwrap();
            let name = gait.description().key;
            println!("{name} {criterion:?}: {:?} {found:#?}", local.kkt);
            assert!(found.residual() < KKT_RESIDUAL, "{name} {criterion:?}: {found:?}, optimizer {:?}", local.kkt);
        }
    }
}
