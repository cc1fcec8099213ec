//! Whole optimizations, to a receipt: cold from the default walk, and warm from the optimum of a speed nearby. Gaits whose default
//! walk leads to no optimum are left out.

use criterion::{Criterion, criterion_group, criterion_main};
use piaffe::gaits::GAITS;
use piaffe::motion;
use piaffe::search::local::{Local, Task};
use piaffe::search::multi_start::start;
use piaffe::sqp::Control;
use piaffe::verdict::GRID;
use piaffe::verify::{Receipt, VerifyError, verify};
use std::hint::black_box;

/// m/s.
const SPEED: f64 = 0.6;
const NEIGHBOUR: f64 = 0.65;

fn cold(c: &mut Criterion) {
    bench(c, "cold", |task, _| {
        move || receipt(&task, task.descend(black_box(&walk(&task)), &mut |_| Control::Continue))
    });
}

fn warm(c: &mut Criterion) {
    bench(c, "warm", |task, optimum| {
        let task = Task { speed: NEIGHBOUR, ..task };
        move || receipt(&task, task.follow(black_box(&optimum), &mut |_| Control::Continue))
    });
}

fn bench<F: FnMut() -> Result<Receipt, VerifyError>>(
    c: &mut Criterion,
    how: &str,
    prepare: impl Fn(Task<'static>, Vec<f64>) -> F,
) {
    let mut group = c.benchmark_group(format!("optimize/{how}"));
    group.sample_size(10);
    for gait in GAITS {
        for criterion in motion::Criterion::ALL {
            let task = Task { gait: *gait, criterion, speed: SPEED };
            let local = task.descend(&walk(&task), &mut |_| Control::Continue);
            if local.status.is_optimal() {
                let name = format!("{} {}", gait.description().key, criterion.name());
                group.bench_function(name, |b| b.iter(prepare(task, local.theta.clone())));
            }
        }
    }
    group.finish();
}

fn walk(task: &Task) -> Vec<f64> {
    start(task.gait, task.criterion, task.speed, 1, 0)
}

fn receipt(task: &Task, local: Local) -> Result<Receipt, VerifyError> {
    assert!(local.status.is_optimal(), "{} at {} m/s", task.gait.description().key, task.speed);
    verify(task.gait.description(), &local.motion, task.speed, GRID)
}

criterion_group!(benches, cold, warm);
criterion_main!(benches);
