//! A synthetic problem of the real shape: three joints with quartic trajectories (15 variables), 4 nonlinear equations, and limits
//! on angles and torques at 100 samples (1200 inequalities), of which about ten are active.

use piaffe::sqp::{Options, Problem, Solution, Undefined, Values, minimize};
use std::time::{Duration, Instant};

pub const SAMPLES: usize = 100;
const LIMIT_ANGLE: f64 = 0.36;
const LIMIT_TORQUE: f64 = 0.125;

/// Angle, rate, acceleration and torque of a joint with the torque's slopes, at one sample.
#[derive(Clone, Copy, Default)]
struct Sample {
    torque: f64,
    by_angle: f64,
    by_rate: f64,
    by_next_rate: f64,
}

pub struct Trajectory {
    /// Limit on the samples per joint; 100 gives 1200 inequalities.
    samples: usize,
    basis: Vec<[[f64; 5]; 3]>,
    table: Vec<[Sample; 3]>,
    at: [f64; 15],
    /// The default way through the rows, or the cheap one.
    pub cheap_directions: bool,
    pub evaluating: Duration,
}

impl Trajectory {
    pub fn new(samples: usize) -> Self {
        // Quartics through two end points with their rates, and a midpoint.
        let unit = |i: usize| -> [f64; 5] {
            let p: [f64; 5] = std::array::from_fn(|k| f64::from(u8::from(k == i)));
            let (a, b, c) = (p[3] - p[0] - p[1], p[4] - p[1], p[2] - p[0] - 0.5 * p[1]);
            [p[0], p[1], 16.0 * c - 5.0 * a + b, 14.0 * a - 3.0 * b - 32.0 * c, 16.0 * c - 8.0 * a + 2.0 * b]
        };
        let basis = (0..samples)
            .map(|k| {
                let t = k as f64 / (samples - 1) as f64;
                let powers = [
                    [1.0, t, t.powi(2), t.powi(3), t.powi(4)],
                    [0.0, 1.0, 2.0 * t, 3.0 * t * t, 4.0 * t.powi(3)],
                    [0.0, 0.0, 2.0, 6.0 * t, 12.0 * t * t],
                ];
                powers.map(|p| std::array::from_fn(|i| p.iter().zip(unit(i)).map(|(p, u)| p * u).sum()))
            })
            .collect();
        Self {
            samples,
            basis,
            table: vec![[Sample::default(); 3]; samples],
            at: [0.0; 15],
            cheap_directions: true,
            evaluating: Duration::ZERO,
        }
    }

    pub fn solve(&mut self, options: &Options, start: &[f64]) -> Solution {
        minimize(self, start, options, &mut super::model::print)
    }

    fn motion(&self, x: &[f64], k: usize) -> [[f64; 3]; 3] {
        let dot = |a: &[f64; 5], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        std::array::from_fn(|order| std::array::from_fn(|j| dot(&self.basis[k][order], &x[5 * j..5 * j + 5])))
    }

    fn sample(q: &[[f64; 3]; 3], j: usize) -> Sample {
        let next = (j + 1) % 3;
        Sample {
            torque: q[2][j] + 4.0 * q[0][j].sin() + 0.3 * q[1][j] * q[1][next],
            by_angle: 4.0 * q[0][j].cos(),
            by_rate: 0.3 * q[1][next],
            by_next_rate: 0.3 * q[1][j],
        }
    }

    fn torque_row(&self, k: usize, j: usize, weight: f64, row: &mut [f64]) {
        let (s, b) = (&self.table[k][j], &self.basis[k]);
        for i in 0..5 {
            row[5 * j + i] += weight * (b[2][i] + s.by_angle * b[0][i] + s.by_rate * b[1][i]);
            row[5 * ((j + 1) % 3) + i] += weight * s.by_next_rate * b[1][i];
        }
    }
}

impl Problem for Trajectory {
    fn variables(&self) -> usize {
        15
    }
    fn equalities(&self) -> usize {
        4
    }
    fn inequalities(&self) -> usize {
        12 * self.samples
    }
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        lower.fill(-30.0);
        upper.fill(30.0);
    }
    fn evaluate(&mut self, x: &[f64], out: &mut Values) -> Result<(), Undefined> {
        let start = Instant::now();
        let m = self.samples;
        out.objective = 0.0;
        let mut mean = 0.0;
        for k in 0..m {
            let q = self.motion(x, k);
            for j in 0..3 {
                let torque = Self::sample(&q, j).torque;
                out.objective += torque * torque / m as f64;
                for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                    out.inequalities[(2 * j + side) * m + k] = LIMIT_ANGLE - sign * q[0][j];
                    out.inequalities[(6 + 2 * j + side) * m + k] = LIMIT_TORQUE - sign * torque;
                }
            }
            mean += q[0][1] * q[0][1] / m as f64;
        }
        let (first, last) = (self.motion(x, 0), self.motion(x, m - 1));
        out.equalities[0] = first[0][0] + last[0][0];
        out.equalities[1] = last[0][0].sin() + last[0][1].sin() - 0.6;
        out.equalities[2] = first[1][2] + last[1][2] - 1.0;
        out.equalities[3] = mean - 0.08;
        self.evaluating += start.elapsed();
        Ok(())
    }
    fn linearize(&mut self, x: &[f64]) -> Result<(), Undefined> {
        let start = Instant::now();
        self.at.copy_from_slice(x);
        for k in 0..self.samples {
            let q = self.motion(x, k);
            self.table[k] = std::array::from_fn(|j| Self::sample(&q, j));
        }
        self.evaluating += start.elapsed();
        Ok(())
    }
    fn gradient(&self, gradient: &mut [f64]) {
        for k in 0..self.samples {
            for j in 0..3 {
                self.torque_row(k, j, 2.0 * self.table[k][j].torque / self.samples as f64, gradient);
            }
        }
    }
    fn equality_row(&self, i: usize, row: &mut [f64]) {
        let (first, last) = (&self.basis[0], &self.basis[self.samples - 1]);
        let end = self.motion(&self.at, self.samples - 1);
        for c in 0..5 {
            match i {
                0 => row[c] = first[0][c] + last[0][c],
                1 => {
                    row[c] = end[0][0].cos() * last[0][c];
                    row[5 + c] = end[0][1].cos() * last[0][c];
                }
                2 => row[10 + c] = first[1][c] + last[1][c],
                _ => {
                    for k in 0..self.samples {
                        row[5 + c] += 2.0 * self.motion(&self.at, k)[0][1] * self.basis[k][0][c] / self.samples as f64;
                    }
                }
            }
        }
    }
    fn inequality_row(&self, i: usize, row: &mut [f64]) {
        let (kind, k) = (i / self.samples, i % self.samples);
        let sign = if kind % 2 == 0 { -1.0 } else { 1.0 };
        let j = kind % 6 / 2;
        if kind < 6 {
            for c in 0..5 {
                row[5 * j + c] = sign * self.basis[k][0][c];
            }
        } else {
            self.torque_row(k, j, sign, row);
        }
    }
    fn directions(&self, d: &[f64], out: &mut [f64], _: &mut [f64]) {
        let m = self.samples;
        if !self.cheap_directions {
            let mut row = [0.0; 15];
            for (i, out) in out.iter_mut().enumerate() {
                row.fill(0.0);
                self.inequality_row(i, &mut row);
                *out = row.iter().zip(d).map(|(a, d)| a * d).sum();
            }
            return;
        }
        for k in 0..m {
            let q = self.motion(d, k);
            for j in 0..3 {
                let s = &self.table[k][j];
                let torque = q[2][j] + s.by_angle * q[0][j] + s.by_rate * q[1][j] + s.by_next_rate * q[1][(j + 1) % 3];
                for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                    out[(2 * j + side) * m + k] = sign * q[0][j];
                    out[(6 + 2 * j + side) * m + k] = sign * torque;
                }
            }
        }
    }
}

/// A cold start: all angles a small arc.
pub fn cold() -> [f64; 15] {
    std::array::from_fn(|i| 0.2 - 0.03 * i as f64)
}
