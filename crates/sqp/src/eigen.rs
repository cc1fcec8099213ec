//! Eigenvalues and eigenvectors of a small symmetric matrix: Householder reduction to tridiagonal form and implicit QL
//! (Bowdler, Martin, Reinsch & Wilkinson 1968; the arrangement is that of EISPACK's tred2 and tql2). Square roots are the only
//! functions it needs, so the bits are the same everywhere.

use super::dense::{axpy, dot, rotate};

/// Decomposes A = V·diag(λ)·Vᵀ in place: `v` comes in as A (n×n) and leaves with the eigenvectors as its rows, so that all loops
/// run along rows. `false` if the iteration does not converge (only for numbers that are not finite).
pub(super) fn symmetric(v: &mut [f64], lambda: &mut [f64], off: &mut [f64]) -> bool {
    let n = lambda.len();
    tridiagonalize(v, lambda, off, n);
    diagonalize(v, lambda, off, n)
}

fn tridiagonalize(v: &mut [f64], d: &mut [f64], e: &mut [f64], n: usize) {
    d.copy_from_slice(&v[(n - 1) * n..]);
    for i in (1..n).rev() {
        let scale: f64 = d[..i].iter().map(|d| d.abs()).sum();
        let mut h = 0.0;
        if scale == 0.0 {
            e[i] = d[i - 1];
            v[i * n..i * n + i].fill(0.0);
        } else {
            for d in &mut d[..i] {
                *d /= scale;
            }
            h += dot(&d[..i], &d[..i]);
            let f = d[i - 1];
            let g = if f > 0.0 { -h.sqrt() } else { h.sqrt() };
            e[i] = scale * g;
            h -= f * g;
            d[i - 1] = f - g;
            let (d, e) = (&d[..i], &mut e[..i]);
            v[i * n..i * n + i].copy_from_slice(d);
            // e = A·d / h, from the upper triangle.
            e.fill(0.0);
            for j in 0..i {
                let row = &v[j * n + j..j * n + i];
                e[j] += dot(row, &d[j..]);
                axpy(d[j], &row[1..], &mut e[j + 1..]);
            }
            e.iter_mut().for_each(|e| *e /= h);
            let hh = dot(e, d) / (h + h);
            axpy(-hh, d, e);
            for j in 0..i {
                let (f, g) = (d[j], e[j]);
                for ((v, e), d) in v[j * n + j..j * n + i].iter_mut().zip(&e[j..]).zip(&d[j..]) {
                    *v -= f * e + g * d;
                }
            }
        }
        for j in 0..i {
            d[j] = v[j * n + i - 1];
            v[j * n + i] = 0.0;
        }
        d[i] = h;
    }
    // Accumulate the reflections.
    for i in 0..n - 1 {
        v[i * n + n - 1] = v[i * n + i];
        v[i * n + i] = 1.0;
        let h = d[i + 1];
        let (done, reflection) = v.split_at_mut((i + 1) * n);
        let reflection = &mut reflection[..=i];
        if h != 0.0 {
            for row in done.chunks_exact_mut(n) {
                let row = &mut row[..=i];
                axpy(-dot(reflection, row) / h, reflection, row);
            }
        }
        reflection.fill(0.0);
    }
    for j in 0..n {
        d[j] = v[j * n + n - 1];
        v[j * n + n - 1] = 0.0;
    }
    v[n * n - 1] = 1.0;
    e[0] = 0.0;
}

fn diagonalize(v: &mut [f64], d: &mut [f64], e: &mut [f64], n: usize) -> bool {
    e.copy_within(1.., 0);
    e[n - 1] = 0.0;
    for l in 0..n {
        for sweep in 0.. {
            let m = (l..n - 1).find(|&m| e[m].abs() <= f64::EPSILON * (d[m].abs() + d[m + 1].abs())).unwrap_or(n - 1);
            if m == l {
                break;
            }
            if sweep == 60 {
                return false;
            }
            let mut g = (d[l + 1] - d[l]) / (2.0 * e[l]);
            let mut r = (g * g + 1.0).sqrt();
            g = d[m] - d[l] + e[l] / (g + if g >= 0.0 { r } else { -r });
            let (mut s, mut c, mut p) = (1.0, 1.0, 0.0);
            let mut interrupted = false;
            for i in (l..m).rev() {
                let f = s * e[i];
                let b = c * e[i];
                r = (f * f + g * g).sqrt();
                e[i + 1] = r;
                if r == 0.0 {
                    d[i + 1] -= p;
                    e[m] = 0.0;
                    interrupted = true;
                    break;
                }
                s = f / r;
                c = g / r;
                g = d[i + 1] - p;
                r = (d[i] - g) * s + 2.0 * c * b;
                p = s * r;
                d[i + 1] = g + p;
                g = c * r - b;
                let (first, second) = v[i * n..(i + 2) * n].split_at_mut(n);
                rotate(c, -s, first, second);
            }
            if interrupted {
                continue;
            }
            d[l] -= p;
            e[l] = g;
            e[m] = 0.0;
        }
    }
    d.iter().all(|d| d.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_make_the_whole() {
        for n in 1..12 {
            let mut seed = n as u64;
            let mut random = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0
            };
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..=i {
                    let value = if (i + j) % 3 == 0 { 0.0 } else { random() };
                    a[i * n + j] = value;
                    a[j * n + i] = value;
                }
            }
            let (mut v, mut lambda, mut off) = (a.clone(), vec![0.0; n], vec![0.0; n]);
            assert!(symmetric(&mut v, &mut lambda, &mut off));
            for i in 0..n {
                for j in 0..n {
                    let product: f64 = (0..n).map(|k| v[k * n + i] * lambda[k] * v[k * n + j]).sum();
                    assert!((product - a[i * n + j]).abs() < 1e-12, "n {n}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_finite_fails() {
        let mut v = [f64::NAN, 1.0, 1.0, 2.0];
        assert!(!symmetric(&mut v, &mut [0.0; 2], &mut [0.0; 2]));
    }
}
