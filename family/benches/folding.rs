//! What it saves to fold a robot's numbers into its code: the same kernels of the same robot, with its numbers
//! as constants and as parameters.

use criterion::{Criterion, criterion_group, criterion_main};
use piaffe::gaits::GAITS;
use piaffe::model::{Gait, Mode};
use piaffe::motion::Criterion::Energy;
use piaffe::search::{local::Task, multi_start::start};
use piaffe::sqp::Control;
use piaffe_family::FAMILIES;
use std::hint::black_box;

fn folding(c: &mut Criterion) {
    for (folded, family) in GAITS.iter().filter_map(|g| {
        let same = FAMILIES.iter().find(|f| f.description.key == g.description().key)?;
        Some((*g, same))
    }) {
        let Ok(member) = family.with(&[]) else { continue };
        let parametric: &dyn Gait = &*member;
        let d = folded.description();
        let (nq, np) = (d.orientations(), d.positions());
        let lands = d.transition(0).lands().unwrap_or_default();
        let vector = |n: usize, first: f64| -> Vec<f64> { (0..n).map(|k| first - 0.2 * k as f64).collect() };
        let (q, qd, qdd) = (vector(nq, 0.3), vector(nq, 1.0), vector(nq, 2.0));
        let weights = &d.shapes.stance.curvature;
        let (n, phi, others) = (vector(weights.n.len, 1.0), vector(np, 0.5), vector(weights.others.len, 0.7));
        let mut out = vec![0.0; 4096];
        let mut group = c.benchmark_group(format!("folding/{}", d.gait));
        for (how, gait) in [("folded", folded), ("parametric", parametric)] {
            group.bench_function(format!("A + H, {how}"), |b| {
                b.iter(|| gait.inertia_and_bias(black_box(&q), black_box(&qd), black_box(&mut out)));
            });
            group.bench_function(format!("torques, reaction and Jacobian, {how}"), |b| {
                b.iter(|| gait.inverse_jacobian(Mode::Stance(0), black_box(&q), &qd, &qdd, black_box(&mut out)));
            });
            group.bench_function(format!("curvature, {how}"), |b| {
                b.iter(|| {
                    gait.curvature(Mode::Stance(0), black_box(&q), &qd, &qdd, &n, &phi, &others, black_box(&mut out))
                });
            });
            group.bench_function(format!("touchdown, {how}"), |b| {
                b.iter(|| gait.touchdown(lands, black_box(&q), &qd, black_box(&mut out)));
            });
            group.sample_size(10).bench_function(format!("one descent, {how}"), |b| {
                let theta = start(gait, Energy, 0.6, 1, 0);
                b.iter(|| {
                    Task { gait, criterion: Energy, speed: 0.6 }.descend(black_box(&theta), &mut |_| Control::Continue)
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, folding);
criterion_main!(benches);
