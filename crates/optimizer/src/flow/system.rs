//! The linear equations behind the collocation in an element: for Newton's steps, for sensitivities, and transposed for the adjoint.

use crate::lgl::NODES;

/// The linearized collocation equations of one element, σ eliminated, factored.
pub struct System {
    h: f64,
    a: [[f64; NODES]; NODES],
    partials: [(f64, f64, f64); NODES],
    lu: [[f64; NODES - 1]; NODES - 1],
    pivots: [usize; NODES - 1],
}

impl System {
    pub(super) fn new(a: &[[f64; NODES]; NODES], h: f64, partials: impl Fn(usize) -> (f64, f64, f64)) -> System {
        const M: usize = NODES - 1;
        let mut p = [(0.0, 0.0, 0.0); NODES];
        for (j, slot) in p.iter_mut().enumerate() {
            *slot = partials(j);
        }
        let mut m = [[0.0; M]; M];
        for i in 1..NODES {
            for j in 1..NODES {
                let mut through = 0.0;
                for l in 1..NODES {
                    through += a[i][l] * p[l].1 * a[l][j];
                }
                m[i - 1][j - 1] = -h * a[i][j] * p[j].0 - h * h * through * p[j].2;
            }
            m[i - 1][i - 1] += 1.0;
        }
        let pivots = factor(&mut m);
        System { h, a: *a, partials: p, lu: m, pivots }
    }

    /// δβ, δσ with `δβ − h A(β̇_β δβ + β̇_σ δσ) = right β`, `δσ − h A σ̇_β δβ = right σ`.
    pub(super) fn solve(&self, right: &[[f64; 2]; NODES - 1]) -> ([f64; NODES - 1], [f64; NODES - 1]) {
        const M: usize = NODES - 1;
        let mut beta = [0.0; M];
        for i in 0..M {
            let mut value = right[i][0];
            for j in 0..M {
                value += self.h * self.a[i + 1][j + 1] * self.partials[j + 1].1 * right[j][1];
            }
            beta[i] = value;
        }
        substitute(&self.lu, &self.pivots, &mut beta);
        let mut sigma = [0.0; M];
        for i in 0..M {
            let mut value = right[i][1];
            for j in 0..M {
                value += self.h * self.a[i + 1][j + 1] * self.partials[j + 1].2 * beta[j];
            }
            sigma[i] = value;
        }
        (beta, sigma)
    }

    /// η with `systemᵀ η = right`: the adjoint of `solve`.
    pub fn solve_transposed(&self, right: &[[f64; 2]; NODES - 1]) -> [[f64; 2]; NODES - 1] {
        const M: usize = NODES - 1;
        let (h, a) = (self.h, &self.a);
        // Rows of the transpose: ηβ − h β̇_β Aᵀηβ − h σ̇_β Aᵀησ = rβ and ησ − h β̇_σ Aᵀηβ = rσ.
        let mut beta = [0.0; M];
        for j in 0..M {
            let mut value = right[j][0];
            for i in 0..M {
                value += h * a[i + 1][j + 1] * self.partials[j + 1].2 * right[i][1];
            }
            beta[j] = value;
        }
        substitute_transposed(&self.lu, &self.pivots, &mut beta);
        let mut eta = [[0.0; 2]; M];
        for j in 0..M {
            let mut value = right[j][1];
            for i in 0..M {
                value += h * a[i + 1][j + 1] * self.partials[j + 1].1 * beta[i];
            }
            eta[j] = [beta[j], value];
        }
        eta
    }
}

fn substitute_transposed<const M: usize>(lu: &[[f64; M]; M], pivots: &[usize; M], x: &mut [f64; M]) {
    for i in 0..M {
        for k in 0..i {
            x[i] -= lu[k][i] * x[k];
        }
        x[i] /= lu[i][i];
    }
    for i in (0..M).rev() {
        for k in i + 1..M {
            x[i] -= lu[k][i] * x[k];
        }
    }
    for k in (0..M).rev() {
        x.swap(k, pivots[k]);
    }
}

/// LU factors with partial pivoting, in place.
fn factor<const M: usize>(m: &mut [[f64; M]; M]) -> [usize; M] {
    let mut pivots = [0; M];
    for k in 0..M {
        let mut best = k;
        for i in k + 1..M {
            if m[i][k].abs() > m[best][k].abs() {
                best = i;
            }
        }
        pivots[k] = best;
        m.swap(k, best);
        let inverse = 1.0 / m[k][k];
        for i in k + 1..M {
            m[i][k] *= inverse;
            for j in k + 1..M {
                m[i][j] -= m[i][k] * m[k][j];
            }
        }
    }
    pivots
}

fn substitute<const M: usize>(lu: &[[f64; M]; M], pivots: &[usize; M], x: &mut [f64; M]) {
    for k in 0..M {
        x.swap(k, pivots[k]);
    }
    for i in 1..M {
        for k in 0..i {
            x[i] -= lu[i][k] * x[k];
        }
    }
    for i in (0..M).rev() {
        for k in i + 1..M {
            x[i] -= lu[i][k] * x[k];
        }
        x[i] /= lu[i][i];
    }
}
