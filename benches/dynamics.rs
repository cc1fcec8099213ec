//! Generated kernels beside the same quantities by numeric recursion over the bodies.

use criterion::{Criterion, criterion_group, criterion_main};
use piaffe::gaits::GAITS;
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

criterion_group!(benches, dynamics);
criterion_main!(benches);
