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

/// y ← y + α·x.
#[inline]
pub(super) fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
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

/// out ← A·x for a symmetric n×n matrix that is stored in full.
pub(super) fn multiply(a: &[f64], x: &[f64], out: &mut [f64]) {
    for (out, row) in out.iter_mut().zip(a.chunks_exact(x.len())) {
        *out = dot(row, x);
    }
}

/// A ← A + α·v·vᵀ.
pub(super) fn rank_one(alpha: f64, v: &[f64], a: &mut [f64]) {
    for (row, vi) in a.chunks_exact_mut(v.len()).zip(v) {
        axpy(alpha * vi, v, row);
    }
}

/// The Cholesky factor of A = L·Lᵀ by rows, from A's lower triangle. `false` if A is not safely positive definite: a pivot
/// lost all but `1e-14` of its diagonal entry to cancellation.
pub(super) fn cholesky(a: &[f64], n: usize, l: &mut [f64]) -> bool {
    for i in 0..n {
        let (done, row) = l.split_at_mut(i * n);
        let row = &mut row[..n];
        for j in 0..i {
            let lj = &done[j * n..j * n + n];
            row[j] = (a[i * n + j] - dot(&row[..j], &lj[..j])) / lj[j];
        }
        let diagonal = a[i * n + i];
        let pivot = diagonal - dot(&row[..i], &row[..i]);
        // The comparison is false for NaN as well.
        if !(pivot > 1e-14 * diagonal && pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        row[i] = pivot.sqrt();
        row[i + 1..].fill(0.0);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_multiplies_back() {
        let a = [4.0, 2.0, 0.4, 2.0, 5.0, 1.0, 0.4, 1.0, 3.0];
        let mut l = [0.0; 9];
        assert!(cholesky(&a, 3, &mut l));
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| l[3 * i + k] * l[3 * j + k]).sum();
                assert!((product - a[3 * i + j]).abs() < 1e-14);
            }
        }
        assert!(!cholesky(&[1.0, 2.0, 2.0, 1.0], 2, &mut [0.0; 4]));
        assert!(!cholesky(&[f64::NAN], 1, &mut [0.0]));
    }

    #[test]
    fn a_dot_product_sums_every_entry() {
        let a: Vec<f64> = (0..11).map(f64::from).collect();
        assert_eq!(dot(&a, &a), 385.0);
    }
}
