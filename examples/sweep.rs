//! What a trot costs at several speeds, each optimum starting from the one before: `cargo run --release --example sweep`.

use piaffe::Task;
use piaffe::cycle::theta;
use piaffe::gaits::trot::Trot;
use piaffe::motion::Criterion;
use piaffe::search::multi_start::{Expected, Settings, search_from};

fn main() {
    let mut before: Vec<Vec<f64>> = Vec::new();
    let settings = Settings { starts: Some(2), ..Settings::default() };
    for speed in [0.3, 0.45, 0.6, 0.75, 0.9] {
        let task = Task { gait: &Trot, criterion: Criterion::Energy, speed };
        let found = search_from(&task, &settings, &before, Expected::Nothing, &|_| {});
        let Some(best) = found.optima.first() else {
            println!("{speed} m/s: no trot");
            continue;
        };
        println!("{speed} m/s: {:.3} N, phase {:.3} s", best.local.costs.energy, best.local.motion.phases[0].duration);
        before = vec![theta(&best.local.motion)];
    }
}
