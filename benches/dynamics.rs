//! Generated kernels beside the same quantities by numeric recursion over the bodies.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use piaffe::gaits::{GAITS, amble, curvet, trot};
use piaffe::verify::multibody::Multibody;
use std::hint::black_box;

fn dynamics(c: &mut Criterion) {
    for gait in GAITS {
        let d = gait.description();
        let (nq, n) = (d.orientations(), d.positions() + d.orientations());
        let q: Vec<f64> = (0..nq).map(|k| 0.3 - 0.2 * k as f64).collect();
        let qd: Vec<f64> = (0..nq).map(|k| 1.0 - 0.7 * k as f64).collect();
        let mut group = c.benchmark_group(format!("dynamics/{}", d.gait));
        let mut out = vec![0.0; n * n + n];
        group.bench_function("A + H, generated", |b| {
            b.iter(|| gait.inertia_and_bias(black_box(&q), black_box(&qd), black_box(&mut out)));
        });
        let mut bodies = Multibody::new(d);
        let zero = vec![0.0; nq];
        group.bench_function("A + H, numeric Jacobians", |b| {
            b.iter(|| {
                bodies.set(black_box(&q), black_box(&qd), &zero);
                let (a, h) = out.split_at_mut(n * n);
                bodies.inertia(a);
                bodies.bias(h);
                black_box(&out);
            });
        });
        let qdd = vec![1.0; d.prescribed()];
        let mut out = vec![0.0; 1 + d.joints() + d.positions() + (d.joints() + d.positions() + 1) * 3 * nq];
        group.bench_function("torques, reaction and Jacobian, generated", |b| {
            b.iter(|| gait.inverse_jacobian(0, black_box(&q), black_box(&qd), black_box(&qdd), black_box(&mut out)));
        });
        group.finish();
    }
}

/// A + H of many states at once: the time is that of all of them, the throughput says states per second.
macro_rules! batch {
    ($c:expr, $gait:ident) => {{
        const LANES: usize = 8;
        let lanes = |k: usize| std::array::from_fn(|lane| 0.3 - 0.2 * k as f64 + 0.05 * lane as f64);
        let (q, qd): ([[f64; LANES]; _], [[f64; LANES]; _]) = (std::array::from_fn(lanes), std::array::from_fn(lanes));
        let mut out = $gait::InertiaAndBias { a: [[[0.0; LANES]; _]; _], h: [[0.0; LANES]; _] };
        let mut group = $c.benchmark_group(concat!("dynamics/", stringify!($gait)));
        group.throughput(Throughput::Elements(LANES as u64));
        group.bench_function("A + H, generated, batch of 8", |b| {
            b.iter(|| $gait::inertia_and_bias_batch(black_box(&q), black_box(&qd), black_box(&mut out)));
        });
        group.finish();
    }};
}

fn batches(c: &mut Criterion) {
    batch!(c, trot);
    batch!(c, amble);
    batch!(c, curvet);
}

criterion_group!(benches, dynamics, batches);
criterion_main!(benches);
