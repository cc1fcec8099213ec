//! piaffe's side of `benches/peers/dynamics/run.py`: its gaits as JSON (`--describe`), or the times of its kernels.

use piaffe::gaits::{GAITS, amble, curvet, trot};
use piaffe::model::Gait;
use serde_json::{Value, json};
use std::array::from_fn;
use std::hint::black_box;
use std::time::Instant;

const POOL: usize = 256;
const RUNS: usize = 60;
const LANES: usize = 8;

/// A mechanism in numbers, and one state with its A and H, so that a peer can show that it computes the same.
fn describe(gait: &dyn Gait) -> Value {
    let d = gait.description();
    let (n, nq) = (d.positions() + d.orientations(), d.orientations());
    let x: Vec<f64> = (0..n).map(|k| 0.1 * (k + 1) as f64).collect();
    let xd: Vec<f64> = (0..n).map(|k| 0.3 * (k + 1) as f64).collect();
    let mut out = vec![0.0; n * n + n];
    gait.inertia_and_bias(&x[n - nq..], &xd[n - nq..], &mut out);
    let body = |b: &piaffe::model::Body| {
        json!({ "parent": b.parent, "coordinate": b.coordinate, "axis": b.axis, "offset": b.offset, "mass": b.mass,
            "com": b.com, "inertia": b.inertia })
    };
    let bodies: Vec<Value> = d.bodies.iter().map(body).collect();
    let legs: Vec<Value> = d.legs.iter().map(|l| json!({ "body": l.foot_body, "foot": l.foot })).collect();
    let hips: Vec<usize> = (0..d.joints()).filter(|j| d.hangs_on_platform(*j)).collect();
    let joints: Vec<&str> = d.joints.iter().map(|j| j.name).collect();
    let operations: Value = d.operations.iter().map(|o| (o.kernel.to_string(), json!(o.flops))).collect();
    json!({ "gait": d.gait, "gravity": d.gravity, "positions": d.positions(), "orientations": nq,
        "rotation": format!("{:?}", d.rotation), "unactuated": d.unactuated, "bodies": bodies, "legs": legs,
        "joints": joints, "hips": hips, "operations": operations,
        "state": { "x": x, "xd": xd, "a_and_h": out } })
}

/// Least time of a call over the pool, ns; `per_call` states each.
fn time(gait: &str, what: &str, per_call: usize, mut call: impl FnMut(usize)) {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        (0..4 * POOL).for_each(|i| call(i % POOL));
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / (4 * POOL * per_call) as f64);
    }
    println!("{}", json!({ "gait": gait, "what": what, "ns": best }));
}

/// Numbers between −size and size.
fn draw<const K: usize>(random: &mut fastrand::Rng, size: f64) -> [f64; K] {
    from_fn(|_| size * (2.0 * random.f64() - 1.0))
}

/// (β̇, σ̇) with their derivatives in (β, σ), from the late kernel.
fn step([f1, f2, moment]: [f64; 3], [f1_b, f2_b, moment_b]: [f64; 3], sigma: f64) -> [f64; 5] {
    let over = 1.0 / f1;
    let rate = (sigma - f2) * over;
    [rate, moment, -(f2_b + rate * f1_b) * over, over, moment_b]
}

macro_rules! times {
    ($gait:ident) => {{
        let random = &mut fastrand::Rng::with_seed(1);
        let name = stringify!($gait);
        let states: Vec<_> = (0..POOL).map(|_| (draw(random, 1.2), draw(random, 5.0), draw(random, 60.0))).collect();
        time(name, "A + H", 1, |i| {
            black_box($gait::inertia_and_bias(&states[i].0, &states[i].1));
        });
        let lanes = |random: &mut fastrand::Rng| -> Vec<_> {
            (0..POOL).map(|_| (from_fn(|_| draw(random, 1.2)), from_fn(|_| draw(random, 5.0)))).collect()
        };
        let blocks = lanes(random);
        let mut out = $gait::InertiaAndBias { a: [[[0.0; LANES]; _]; _], h: [[0.0; LANES]; _] };
        time(name, "A + H, batch", LANES, |i| {
            $gait::inertia_and_bias_batch(&blocks[i].0, &blocks[i].1, black_box(&mut out));
        });
        time(name, "inverse dynamics", 1, |i| {
            black_box($gait::inverse1(&states[i].0, &states[i].1, &states[i].2));
        });
        let accelerations: Vec<_> = (0..POOL).map(|_| from_fn(|_| draw(random, 60.0))).collect();
        let mut out = $gait::Inverse { xdd: [[0.0; LANES]; _], gamma: [[0.0; LANES]; _], f: [[0.0; LANES]; _] };
        time(name, "inverse dynamics, batch", LANES, |i| {
            $gait::inverse1_batch(&blocks[i].0, &blocks[i].1, &accelerations[i], black_box(&mut out));
        });
        time(name, "inverse dynamics with Jacobian", 1, |i| {
            black_box($gait::inverse_jacobian1(&states[i].0, &states[i].1, &states[i].2));
        });
        // What is known before β is evaluated once per instant, the step in every iteration over β.
        let given: Vec<_> = (0..POOL).map(|_| (draw(random, 0.8), draw(random, 5.0))).collect();
        let early: Vec<_> = given.iter().map(|(q, qd)| $gait::early1(q, qd)).collect();
        let iterate: Vec<[f64; 2]> = (0..POOL).map(|_| draw(random, 0.8)).collect();
        time(name, "beta step", 1, |i| {
            let late = $gait::late1(&early[i], iterate[i][0]);
            black_box(step(late.value, late.by_beta, iterate[i][1]));
        });
        time(name, "beta step with all partials", 1, |i| {
            let late = $gait::late1(&early[i], iterate[i][0]);
            let step = step(late.value, late.by_beta, iterate[i][1]);
            let g = $gait::late_gradient1(&early[i], iterate[i][0]);
            let mut by_q = g.f2_q;
            by_q.iter_mut().zip(g.f1_q).for_each(|(by, f1_q)| *by = -(*by + step[0] * f1_q) * step[3]);
            let by_qd = g.f2_qd.map(|x| -x * step[3]);
            black_box((step, by_q, by_qd, g.moment_q));
        });
        time(name, "beta step, early values included", 1, |i| {
            let late = $gait::late1(&$gait::early1(&given[i].0, &given[i].1), iterate[i][0]);
            black_box(step(late.value, late.by_beta, iterate[i][1]));
        });
    }};
}

fn main() {
    if std::env::args().any(|a| a == "--describe") {
        // The robot without a folder of its own, whose gaits are timed below.
        let own = GAITS.iter().filter(|g| !g.description().key.contains('/'));
        println!("{}", Value::from_iter(own.map(|g| describe(*g))));
        return;
    }
    times!(trot);
    times!(amble);
    times!(curvet);
}
