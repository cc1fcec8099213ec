//! Whole optimizations: one cold start from the default walk, to a receipt.

use criterion::{Criterion, criterion_group, criterion_main};
use piaffe::gaits::GAITS;
use piaffe::motion;
use piaffe::result::GRID;
use piaffe::search::local::Task;
use piaffe::search::multi_start::start;
use piaffe::sqp::Control;
use piaffe::verify::verify;
use std::hint::black_box;

fn optimize(c: &mut Criterion) {
    let mut group = c.benchmark_group("optimize/cold");
    group.sample_size(10);
    for gait in GAITS {
        for criterion in motion::Criterion::ALL {
            let name = format!("{} {}", gait.description().gait, criterion.name());
            group.bench_function(name, |b| {
                b.iter(|| {
                    let theta = start(*gait, criterion, 0.6, 1, 0);
                    let local = Task { gait: *gait, criterion, speed: 0.6 }
                        .descend(black_box(&theta), &mut |_| Control::Continue);
                    verify(gait.description(), &local.motion, 0.6, GRID)
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, optimize);
criterion_main!(benches);
