//! The few dense kernels that everything else is made of. Fixed summation order: the same bits on every run.

/// aᵀb. Four independent partial sums, so that the compiler may use vector registers without reordering anything.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += a[k] * b[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + tail
}

/// The products of four rows that follow each other with `x`: what is read of x serves all four.
#[inline]
pub(super) fn four(rows: &[f64], x: &[f64]) -> [f64; 4] {
    let n = x.len();
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| &rows[k * n..(k + 1) * n]);
    let mut sums = [[0.0; 2]; 4];
    let pairs = x.chunks_exact(2).zip(a.chunks_exact(2)).zip(b.chunks_exact(2));
    for ((((x, a), b), c), d) in pairs.zip(c.chunks_exact(2)).zip(d.chunks_exact(2)) {
        for (sums, row) in sums.iter_mut().zip([a, b, c, d]) {
            sums[0] += row[0] * x[0];
            sums[1] += row[1] * x[1];
        }
    }
    let mut sums = sums.map(|[even, odd]| even + odd);
    if let [last] = x.chunks_exact(2).remainder() {
        for (sum, row) in sums.iter_mut().zip([a, b, c, d]) {
            *sum += row[n - 1] * last;
        }
    }
    sums
}

/// out ← A·x, A by rows.
#[inline]
pub fn multiply(a: &[f64], x: &[f64], out: &mut [f64]) {
    let n = x.len();
    let (blocks, mut slots) = (a.chunks_exact(4 * n), out.chunks_exact_mut(4));
    let rest = blocks.remainder().chunks_exact(n);
    for (rows, slots) in blocks.zip(&mut slots) {
        slots.copy_from_slice(&four(rows, x));
    }
    for (row, slot) in rest.zip(slots.into_remainder()) {
        *slot = dot(row, x);
    }
}

/// y ← y + Aᵀ·c, A by rows: what is read and written of y serves four of them.
#[inline]
pub fn combine(c: &[f64], a: &[f64], y: &mut [f64]) {
    let n = y.len();
    let (blocks, factors) = (a.chunks_exact(4 * n), c.chunks_exact(4));
    let rest = blocks.remainder().chunks_exact(n).zip(factors.remainder());
    for (rows, c) in blocks.zip(factors) {
        let [first, second, third, fourth] = [0, 1, 2, 3].map(|k| &rows[k * n..(k + 1) * n]);
        for ((((y, first), second), third), fourth) in y.iter_mut().zip(first).zip(second).zip(third).zip(fourth) {
            *y += (c[0] * first + c[1] * second) + (c[2] * third + c[3] * fourth);
        }
    }
    for (row, c) in rest {
        axpy(*c, row, y);
    }
}

/// y ← y + α·x.
#[inline]
pub fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += alpha * x;
    }
}

/// (a, b) ← (c·a + s·b, c·b − s·a).
#[inline]
pub(super) fn rotate(c: f64, s: f64, a: &mut [f64], b: &mut [f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = (c * *a + s * *b, c * *b - s * *a);
    }
}

/// ‖a‖∞; NaN counts as infinite.
pub(super) fn max_abs(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |worst: f64, a| if a.is_nan() { f64::INFINITY } else { worst.max(a.abs()) })
}

/// ‖a‖₂.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// A ← A + α·v·vᵀ.
pub(super) fn rank_one(alpha: f64, v: &[f64], a: &mut [f64]) {
    for (row, vi) in a.chunks_exact_mut(v.len()).zip(v) {
        axpy(alpha * vi, v, row);
    }
}

/// The Cholesky factor of A = Uᵀ·U by rows, from A's upper triangle; below the diagonal nothing is written. `false` if A is not
/// safely positive definite: a pivot lost all but `1e-14` of its diagonal entry to cancellation.
pub(super) fn cholesky(a: &[f64], n: usize, u: &mut [f64]) -> bool {
    u.copy_from_slice(a);
    for k in 0..n {
        let (done, rest) = u.split_at_mut((k + 1) * n);
        let row = &mut done[k * n + k..];
        let pivot = row[0];
        // The comparison is false for NaN as well.
        if !(pivot > 1e-14 * a[k * n + k] && pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let root = pivot.sqrt();
        row[0] = root;
        row[1..].iter_mut().for_each(|u| *u /= root);
        for (i, below) in rest.chunks_exact_mut(n).enumerate() {
            axpy(-row[i + 1], &row[i + 1..], &mut below[k + 1 + i..]);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_multiplies_back() {
        let a = [4.0, 2.0, 0.4, 2.0, 5.0, 1.0, 0.4, 1.0, 3.0];
        let mut u = [0.0; 9];
        assert!(cholesky(&a, 3, &mut u));
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..=i.min(j)).map(|k| u[3 * k + i] * u[3 * k + j]).sum();
                assert!((product - a[3 * i + j]).abs() < 1e-14);
            }
        }
        assert!(!cholesky(&[1.0, 2.0, 2.0, 1.0], 2, &mut [0.0; 4]));
        assert!(!cholesky(&[f64::NAN], 1, &mut [0.0]));
    }

    #[test]
    fn products_with_many_rows_are_those_with_each() {
        for (rows, n) in [(1, 3), (4, 4), (7, 5), (9, 1)] {
            let a: Vec<f64> = (0..rows * n).map(|k| f64::from((k * k % 11) as u8) - 4.0).collect();
            let x: Vec<f64> = (0..n).map(|k| 1.5 - k as f64).collect();
            let c: Vec<f64> = (0..rows).map(|k| k as f64 - 2.5).collect();
            let (mut product, mut sum) = (vec![0.0; rows], vec![1.0; n]);
            multiply(&a, &x, &mut product);
            combine(&c, &a, &mut sum);
            let mut each = vec![1.0; n];
            for ((row, product), c) in a.chunks(n).zip(&product).zip(&c) {
                assert!((dot(row, &x) - product).abs() < 1e-12);
                axpy(*c, row, &mut each);
            }
            assert!(each.iter().zip(&sum).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn a_dot_product_sums_every_entry() {
        let a: Vec<f64> = (0..11).map(f64::from).collect();
        assert_eq!(dot(&a, &a), 385.0);
    }
}
