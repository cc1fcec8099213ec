//! The cheapest trot at a speed, and what stands behind it: `cargo run --release --example optimize`.

use piaffe::gaits::trot::Trot;
use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::search::multi_start::{Settings, search};

fn main() {
    let (criterion, speed, settings) = (Criterion::Energy, 0.6, Settings::default());
    let found = search(&Trot, criterion, speed, &settings, &|_| {});
    let result = GaitResult::new(&Trot, criterion, speed, &found, settings.seed, || 0.0);
    match (result.cost, result.receipt) {
        (Some(cost), Some(receipt)) => {
            println!("{cost:.4} {}; active: {}", criterion.unit(), receipt.active.join(", "))
        }
        _ => println!("{}", result.message),
    }
}
