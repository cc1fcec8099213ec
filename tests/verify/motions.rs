//! Motions to verify, from geometry: inverse kinematics of a crouched robot that takes a step.
//!
//! They are neither optimal nor, in general, cycles; [`closed_trot`] is one.

use piaffe::gaits::{amble::Amble, curvet::Curvet, trot::Trot};
use piaffe::model::{Description, Gait, Mode, Phase, Rotation};
use piaffe::motion::{Course, Motion};
use piaffe::verify::{impact::impact, phase};

/// Length of a thigh and of a shin, m.
const LINK: f64 = 0.15;

pub fn gaits() -> [&'static dyn Gait; 3] {
    [&Trot, &Amble, &Curvet]
}

/// Repeatable numbers in −1 … 1.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn list(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.next()).collect()
    }
}

/// Joint angles that put the foot at (x, y) from the hip, knee bent forward.
fn leg(x: f64, y: f64) -> [f64; 2] {
    let knee = -((x * x + y * y) / (2.0 * LINK * LINK) - 1.0).acos();
    let haunch = x.atan2(-y) - (LINK * knee.sin()).atan2(LINK + LINK * knee.cos());
    [haunch, knee]
}

/// Joint angles with the feet at these places from their hips.
fn posture(feet: [[f64; 2]; 2]) -> Vec<f64> {
    feet.iter().flat_map(|f| leg(f[0], f[1])).collect()
}

/// Joint rates with the feet moving at these velocities, from their hips.
fn rates(feet: [[f64; 2]; 2], velocities: [[f64; 2]; 2]) -> Vec<f64> {
    let h = 1e-6;
    let moved = |sign: f64| posture([0, 1].map(|k| [0, 1].map(|c| feet[k][c] + sign * h * velocities[k][c])));
    moved(1.0).iter().zip(moved(-1.0)).map(|(a, b)| (a - b) / (2.0 * h)).collect()
}

/// A course on `stance`: the platform passes over the foot while the other one swings forward.
fn course(d: &Description, stance: usize, duration: f64) -> Course {
    let (height, reach, speed) = (0.26, 0.03, 0.3);
    let order = |s: [f64; 2], w: [f64; 2]| if stance == 0 { [s, w] } else { [w, s] };
    let begin = order([reach, -height], [-reach, -height]);
    let middle = order([0.0, -height], [0.0, -height + 0.02]);
    let end = order([-reach, -height], [reach, -height]);
    let still = order([-speed, 0.0], [speed, 0.3]);
    let falling = order([-speed, 0.0], [speed, -0.3]);
    let choose = |q: Vec<f64>| {
        (0..d.prescribed()).map(|k| q.get(d.prescribed_index(k)).copied().unwrap_or(0.0)).collect::<Vec<_>>()
    };
    let beta = |q: &[f64], theta: f64| q.get(d.unactuated).copied().unwrap_or(theta);
    let (theta, rate) = match d.rotation {
        Rotation::None => (0.0, 0.0),
        Rotation::Pitch => (0.0, if stance == 0 { 0.6 } else { -0.6 }),
        Rotation::Roll => (0.0, -0.5),
    };
    Course {
        duration,
        q_initial: choose(posture(begin)),
        qd_initial: choose(rates(begin, still)),
        q_interior: vec![choose(posture(middle))],
        q_final: choose(posture(end)),
        qd_final: choose(rates(end, falling)),
        beta_initial: beta(&posture(begin), theta),
        betad_initial: beta(&rates(begin, still), rate),
        beta_final: beta(&posture(end), theta),
        betad_final: beta(&rates(end, falling), -rate),
    }
}

/// A motion with all its phases, not a cycle.
pub fn stepping(d: &Description) -> Motion {
    let phase = |phase: &Phase| match phase.mode {
        Mode::Stance(leg) => course(d, leg, 0.15),
        Mode::Flight => course(d, 1, 0.07),
    };
    Motion { phases: d.phases.iter().map(phase).collect() }
}

/// A trot that is a cycle: initial states from the impact, T and β̇ at the end by Newton's method.
pub fn closed_trot() -> Motion {
    let d = Trot.description();
    let build = |duration: f64, betad_final: f64| {
        let mut course = course(d, 0, duration);
        course.betad_final = betad_final;
        let complete = |list: &[f64], beta: f64| [&[beta], list].concat();
        let q = complete(&course.q_final, course.beta_final);
        let after = impact(d, 1, &q, &complete(&course.qd_final, betad_final)).unwrap().after;
        let renamed = |values: &[f64]| (0..4).map(|k| values[d.swapped(k).0]).collect::<Vec<_>>();
        let (q, qd) = (renamed(&q), renamed(&after[2..]));
        (course.beta_initial, course.betad_initial) = (q[0], qd[0]);
        (course.q_initial, course.qd_initial) = (q[1..].to_vec(), qd[1..].to_vec());
        course
    };
    let gap = |duration: f64, betad_final: f64| {
        let course = build(duration, betad_final);
        let end = phase::Phase::new(d, &course, 0, 1).unwrap().beta_end();
        [end[0] - course.beta_final, end[1] - betad_final]
    };
    let mut x = [0.15, course(d, 0, 0.15).betad_final];
    for _ in 0..30 {
        let h = 1e-6;
        let [g, by_t, by_rate] = [gap(x[0], x[1]), gap(x[0] + h, x[1]), gap(x[0], x[1] + h)];
        let [a, b] = [0, 1].map(|k| [(by_t[k] - g[k]) / h, (by_rate[k] - g[k]) / h]);
        let determinant = a[0] * b[1] - a[1] * b[0];
        let step = [(g[0] * b[1] - a[1] * g[1]) / determinant, (a[0] * g[1] - g[0] * b[0]) / determinant];
        // Long steps could leave the domain of the motion.
        let damping = (0.02 / step[0].abs()).min(1.0 / step[1].abs()).min(1.0);
        x = [x[0] - damping * step[0], x[1] - damping * step[1]];
    }
    Motion { phases: vec![build(x[0], x[1])] }
}
