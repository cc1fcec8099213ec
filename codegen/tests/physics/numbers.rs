//! Small dense linear algebra, differences, and rigid bodies in plain numbers.

use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::spec::Rotation;

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Row-major matrix times vector.
pub fn product(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks(x.len()).map(|row| dot(row, x)).collect()
}

/// Transposed row-major matrix times vector.
pub fn transposed_product(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let columns = matrix.len() / x.len();
    (0..columns).map(|c| x.iter().enumerate().map(|(r, x)| matrix[r * columns + c] * x).sum()).collect()
}

pub fn is_positive_definite(matrix: &[f64], n: usize) -> bool {
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let rest = matrix[i * n + j] - dot(&l[i * n..i * n + j], &l[j * n..j * n + j]);
            if i == j {
                if rest <= 0.0 {
                    return false;
                }
                l[i * n + i] = rest.sqrt();
            } else {
                l[i * n + j] = rest / l[j * n + j];
            }
        }
    }
    true
}

/// `base + a·by`, elementwise.
pub fn along(base: &[f64], a: f64, by: &[f64]) -> Vec<f64> {
    base.iter().zip(by).map(|(x, d)| x + a * d).collect()
}

/// Derivative at 0 by a fourth-order central difference.
pub fn difference(f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let h = 1e-3;
    let (p, m, pp, mm) = (f(h), f(-h), f(2.0 * h), f(-2.0 * h));
    (0..p.len()).map(|i| (8.0 * (p[i] - m[i]) - (pp[i] - mm[i])) / (12.0 * h)).collect()
}

/// Jacobian by differences in `x`: one row per value.
pub fn differences(x: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = (0..x.len())
        .map(|k| {
            difference(|h| {
                let mut moved = x.to_vec();
                moved[k] += h;
                f(&moved)
            })
        })
        .collect();
    (0..columns[0].len()).flat_map(|i| columns.iter().map(move |c| c[i])).collect()
}

/// Equality relative to the largest number involved (and to 1).
#[track_caller]
pub fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let scale = found.iter().chain(expected).fold(1.0f64, |s, x| s.max(x.abs()));
    assert_within(what, found, expected, tolerance, scale);
}

/// Equality relative to the size of what is added up, where that cancels or ends in zero.
#[track_caller]
pub fn assert_within(what: &str, found: &[f64], expected: &[f64], tolerance: f64, scale: f64) {
    assert_eq!(found.len(), expected.len(), "{what}: length");
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= tolerance * scale, "{what}[{i}]: found {f}, expected {e}, scale {scale}");
    }
}

pub type Matrix = [[f64; 3]; 3];

/// A body in plain numbers: mass centre and orientation in the world.
pub struct Pose {
    pub com: [f64; 3],
    pub rotation: Matrix,
}

pub fn times(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn apply(a: &Matrix, v: [f64; 3]) -> [f64; 3] {
    a.map(|row| dot(&row, &v))
}

pub fn turn(axis: usize, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    match axis {
        0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    }
}

pub fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + b[k])
}

/// Places of all bodies and the two feet, by composing rotations: independent of the expressions.
pub fn poses(m: &Mechanism, x: &[f64]) -> (Vec<Pose>, [[f64; 3]; 2]) {
    let positions = m.positions();
    let q = &x[positions..];
    let mut p = [0.0; 3];
    p[..positions].copy_from_slice(&x[..positions]);
    let platform = match m.rotation {
        Rotation::None => turn(0, 0.0),
        Rotation::Pitch => turn(2, q[m.joints.len()]),
        Rotation::Roll => turn(0, q[m.joints.len()]),
    };
    let mut frames: Vec<([f64; 3], Matrix)> = Vec::new();
    for body in &m.bodies {
        let frame = match (body.parent, body.coordinate) {
            (Some(parent), Some(k)) => {
                let (origin, above) = &frames[parent];
                (add(*origin, apply(above, body.offset)), times(above, &turn(body.axis.index(), q[k])))
            }
            _ => (p, platform),
        };
        frames.push(frame);
    }
    let feet = [0, 1].map(|k| {
        let (origin, rotation) = &frames[m.legs[k].foot_body];
        add(*origin, apply(rotation, m.legs[k].foot))
    });
    let poses = m
        .bodies
        .iter()
        .zip(&frames)
        .map(|(body, (origin, rotation))| Pose { com: add(*origin, apply(rotation, body.com)), rotation: *rotation });
    (poses.collect(), feet)
}

/// Kinetic energy without rotors, and angular momentum about `point`, by differences along Ẋ.
///
/// In a planar gait only what moves in the plane counts, as in the model.
pub fn momentum(m: &Mechanism, x: &[f64], xd: &[f64], point: [f64; 3]) -> (f64, [f64; 3]) {
    let flat = |h: f64| -> Vec<f64> {
        let (poses, _) = poses(m, &along(x, h, xd));
        poses.iter().flat_map(|p| p.com.into_iter().chain(p.rotation.into_iter().flatten())).collect()
    };
    let rates = difference(flat);
    let (poses, _) = poses(m, x);
    let (mut kinetic, mut sigma) = (0.0, [0.0; 3]);
    for ((body, pose), rate) in m.bodies.iter().zip(&poses).zip(rates.chunks(12)) {
        let velocity = &rate[..3];
        let rotation_rate: Matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| rate[3 + 3 * i + j]));
        // RᵀṘ is the cross-product matrix of the spin in the body's axes.
        let skew = |i: usize, j: usize| (0..3).map(|k| pose.rotation[k][i] * rotation_rate[k][j]).sum::<f64>();
        let spin = [skew(2, 1), skew(0, 2), skew(1, 0)];
        let angular = [0, 1, 2].map(|i| dot(&body.inertia[i], &spin));
        kinetic += 0.5 * body.mass * dot(velocity, velocity) + 0.5 * dot(&spin, &angular);
        let arm = [0, 1, 2].map(|i| pose.com[i] - point[i]);
        let own = apply(&pose.rotation, angular);
        for (i, s) in sigma.iter_mut().enumerate() {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            *s += body.mass * (arm[j] * velocity[k] - arm[k] * velocity[j]) + own[i];
        }
    }
    (kinetic, sigma)
}
