//! Eigenvalues and eigenvectors of a small symmetric matrix: Householder reduction to tridiagonal form and implicit QL
//! (Bowdler, Martin, Reinsch & Wilkinson 1968; the arrangement is that of EISPACK's tred2 and tql2). Square roots are the only
//! functions it needs, so the bits are the same everywhere.

/// Decomposes A = V·diag(λ)·Vᵀ in place: `v` comes in as A (n×n, by rows) and leaves with the eigenvectors as its columns.
/// `false` if the iteration does not converge (only for numbers that are not finite).
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
            for j in 0..i {
                d[j] = v[(i - 1) * n + j];
                v[i * n + j] = 0.0;
                v[j * n + i] = 0.0;
            }
        } else {
            for d in &mut d[..i] {
                *d /= scale;
                h += *d * *d;
            }
            let f = d[i - 1];
            let g = if f > 0.0 { -h.sqrt() } else { h.sqrt() };
            e[i] = scale * g;
            h -= f * g;
            d[i - 1] = f - g;
            e[..i].fill(0.0);
            for j in 0..i {
                let f = d[j];
                v[j * n + i] = f;
                let mut g = e[j] + v[j * n + j] * f;
                for k in j + 1..i {
                    g += v[k * n + j] * d[k];
                    e[k] += v[k * n + j] * f;
                }
                e[j] = g;
            }
            let mut f = 0.0;
            for j in 0..i {
                e[j] /= h;
                f += e[j] * d[j];
            }
            let hh = f / (h + h);
            for j in 0..i {
                e[j] -= hh * d[j];
            }
            for j in 0..i {
                let (f, g) = (d[j], e[j]);
                for k in j..i {
                    v[k * n + j] -= f * e[k] + g * d[k];
                }
                d[j] = v[(i - 1) * n + j];
                v[i * n + j] = 0.0;
            }
        }
        d[i] = h;
    }
    // Accumulate the reflections.
    for i in 0..n - 1 {
        v[(n - 1) * n + i] = v[i * n + i];
        v[i * n + i] = 1.0;
        let h = d[i + 1];
        if h != 0.0 {
            for k in 0..=i {
                d[k] = v[k * n + i + 1] / h;
            }
            for j in 0..=i {
                let g: f64 = (0..=i).map(|k| v[k * n + i + 1] * v[k * n + j]).sum();
                for k in 0..=i {
                    v[k * n + j] -= g * d[k];
                }
            }
        }
        for k in 0..=i {
            v[k * n + i + 1] = 0.0;
        }
    }
    for j in 0..n {
        d[j] = v[(n - 1) * n + j];
        v[(n - 1) * n + j] = 0.0;
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
                for row in v.chunks_exact_mut(n) {
                    let f = row[i + 1];
                    row[i + 1] = s * row[i] + c * f;
                    row[i] = c * row[i] - s * f;
                }
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
                    let product: f64 = (0..n).map(|k| v[i * n + k] * lambda[k] * v[j * n + k]).sum();
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
