//! Generated kernels beside the same quantities by numeric recursion over the bodies; the last lines compare them.

use criterion::{Criterion, Throughput};
use piaffe::gaits::{GAITS, amble, curvet, trot};
use piaffe::model::Mode;
use piaffe::verify::multibody::Multibody;
use std::hint::black_box;
use std::path::Path;

const GENERATED: &str = "A + H, generated";
const NUMERIC: &str = "A + H, numeric Jacobians";
const BATCH: &str = "A + H, generated, batch of 8";
/// States in a batch.
const LANES: usize = 8;

fn main() {
    // Beside what cargo writes for benches, so that the estimates can be read again.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("criterion");
    let mut criterion = Criterion::default().output_directory(&folder).configure_from_args();
    dynamics(&mut criterion);
    batches(&mut criterion);
    criterion.final_summary();
    compare(&folder);
}

/// A table of what was measured, one row per gait: ns per state, and how many times longer the numeric way takes.
fn compare(folder: &Path) {
    println!("\nA + H, ns per state\ngait        generated  batch of {LANES}  numeric Jacobians  ratio");
    for gait in GAITS {
        let key = gait.description().key;
        let time = |bench: &str| median(&folder.join(group(key).replace('/', "_")).join(bench));
        let Some((generated, numeric)) = time(GENERATED).zip(time(NUMERIC)) else { continue };
        let batch = time(BATCH).map_or("–".into(), |batch| format!("{:.1}", batch / LANES as f64));
        println!("{key:10} {generated:10.1} {batch:>11} {numeric:18.1} {:6.1}", numeric / generated);
    }
}

/// Of the last run, ns; none where it was not run.
fn median(bench: &Path) -> Option<f64> {
    let estimates = std::fs::read_to_string(bench.join("new/estimates.json")).ok()?;
    serde_json::from_str::<serde_json::Value>(&estimates).ok()?["median"]["point_estimate"].as_f64()
}

fn group(key: &str) -> String {
    format!("dynamics/{key}")
}

fn dynamics(c: &mut Criterion) {
    for gait in GAITS {
        let d = gait.description();
        let (nq, n) = (d.orientations(), d.positions() + d.orientations());
        let q: Vec<f64> = (0..nq).map(|k| 0.3 - 0.2 * k as f64).collect();
        let qd: Vec<f64> = (0..nq).map(|k| 1.0 - 0.7 * k as f64).collect();
        let mut group = c.benchmark_group(group(d.key));
        let mut out = vec![0.0; n * n + n];
        group.bench_function(GENERATED, |b| {
            b.iter(|| gait.inertia_and_bias(black_box(&q), black_box(&qd), black_box(&mut out)));
        });
        let mut bodies = Multibody::new(d);
        let zero = vec![0.0; nq];
        group.bench_function(NUMERIC, |b| {
            b.iter(|| {
                bodies.set(black_box(&q), black_box(&qd), &zero);
                let (a, h) = out.split_at_mut(n * n);
                bodies.inertia(a);
                bodies.bias(h);
                black_box(&out);
            });
        });
        let qdd = vec![1.0; d.prescribed()];
        let mut out = d.shapes.stance.inverse_jacobian.zeros();
        group.bench_function("torques, reaction and Jacobian, generated", |b| {
            b.iter(|| {
                gait.inverse_jacobian(
                    Mode::Stance(0),
                    black_box(&q),
                    black_box(&qd),
                    black_box(&qdd),
                    black_box(&mut out),
                )
            });
        });
        group.finish();
    }
}

/// A + H of many states at once: the time is that of all of them, the throughput says states per second.
macro_rules! batch {
    ($c:expr, $gait:ident) => {{
        let lanes = |k: usize| std::array::from_fn(|lane| 0.3 - 0.2 * k as f64 + 0.05 * lane as f64);
        let (q, qd): ([[f64; LANES]; _], [[f64; LANES]; _]) = (std::array::from_fn(lanes), std::array::from_fn(lanes));
        let mut out = $gait::InertiaAndBias { a: [[[0.0; LANES]; _]; _], h: [[0.0; LANES]; _] };
        let mut group = $c.benchmark_group(group(stringify!($gait)));
        group.throughput(Throughput::Elements(LANES as u64));
        group.bench_function(BATCH, |b| {
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
