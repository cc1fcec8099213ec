//! Sums of products of vectors and matrices, row-major. W stands for the Hessian W + Wᵀ.

/// `weight (a bᵀ + b aᵀ)` into W.
pub(super) fn product(w: &mut [f64], a: &[f64], b: &[f64], weight: f64) {
    for (row, x) in w.chunks_mut(a.len()).zip(a) {
        let x = weight * x;
        if x != 0.0 {
            row.iter_mut().zip(b).for_each(|(slot, b)| *slot += x * b);
        }
    }
}

/// `weight a aᵀ` into W, by its lower triangle.
pub(super) fn square(w: &mut [f64], a: &[f64], weight: f64) {
    for (i, (row, x)) in w.chunks_mut(a.len()).zip(a).enumerate() {
        let x = weight * x;
        if x != 0.0 {
            row[..i].iter_mut().zip(a).for_each(|(slot, a)| *slot += x * a);
            row[i] += 0.5 * x * a[i];
        }
    }
}

/// `weight (e_T aᵀ + a e_Tᵀ)` into W.
pub(super) fn cross_duration(w: &mut [f64], a: &[f64], weight: f64, duration: usize) {
    w[duration * a.len()..].iter_mut().zip(a).for_each(|(slot, a)| *slot += weight * a);
}

/// `w + wᵀ` in the place of w.
pub(super) fn add_transpose(w: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..=i {
            let sum = w[i * n + j] + w[j * n + i];
            w[i * n + j] = sum;
            w[j * n + i] = sum;
        }
    }
}

/// `out += mapᵀ h map`, with `map` of shape rows × n and `half` for `h map`.
pub(super) fn congruence(h: &[f64], map: &[f64], n: usize, half: &mut [f64], out: &mut [f64]) {
    let rows = map.len() / n;
    for (target, row) in half.chunks_mut(n).zip(h.chunks(rows)) {
        target.fill(0.0);
        for (value, source) in row.iter().zip(map.chunks(n)) {
            if *value != 0.0 {
                target.iter_mut().zip(source).for_each(|(t, s)| *t += value * s);
            }
        }
    }
    for (source, target) in map.chunks(n).zip(half.chunks(n)) {
        for (i, s) in source.iter().enumerate() {
            if *s != 0.0 {
                out[i * n..(i + 1) * n].iter_mut().zip(target).for_each(|(o, t)| *o += s * t);
            }
        }
    }
}
