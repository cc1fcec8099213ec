/// Sines and cosines of up to four angles of one state at once, each with the bits of [`sin_cos`].
#[inline(always)]
pub fn sin_cos_together<const N: usize>(angles: [f64; N]) -> [(f64, f64); N] {
    const { assert!(N <= 4) }
    let mut x = [0.0; 8];
    x[..N].copy_from_slice(&angles);
    let (mut sin, mut cos) = ([0.0; 8], [0.0; 8]);
    // LLVM unrolls a shorter loop before it looks for vector instructions. The other four places vanish after it has found them.
    for k in 0..4 {
        (sin[k], cos[k]) = sin_cos(x[k]);
        (sin[k + 4], cos[k + 4]) = sin_cos(x[k + 4]);
    }
    let mut both = [(0.0, 0.0); N];
    for k in 0..N {
        both[k] = (sin[k], cos[k]);
    }
    both
}

/// Sines and cosines of some angles in step, each with the bits of [`sin_cos`]: inside a loop over states, so that the
/// processor has several angles' operations to choose from.
#[inline(always)]
#[allow(clippy::needless_range_loop)]
pub fn sin_cos_in_step<const N: usize>(angles: [f64; N]) -> [(f64, f64); N] {
    let (mut steps, mut results) = ([(0, 0.0, 0.0); N], [(0.0, 0.0); N]);
    // Loops, not `map`: LLVM does not always take apart an array that is passed on, and then finds no vector instructions.
    for k in 0..N {
        steps[k] = reduced(angles[k]);
    }
    for k in 0..N {
        steps[k] = series(steps[k]);
    }
    for k in 0..N {
        results[k] = turned(steps[k]);
    }
    results
}

/// Sine and cosine of `x` (rad): one pinned, branch-free implementation, so that results are the
/// same bits on every machine. Largest error found by `tests/math.rs`: 0.82 ulp for |x| ≤ 1e5, 0.51
/// within a few numbers of a multiple of π/2. NaN for non-finite arguments.
///
/// The argument is reduced by multiples of π/2 given in three parts (Cody and Waite), then polynomials of
/// least largest error are evaluated on [−π/4, π/4].
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    turned(series(reduced(x)))
}

/// The multiple of π/2 nearest to `x`, in the low bits, and the rest in two parts.
#[inline(always)]
fn reduced(x: f64) -> (u64, f64, f64) {
    /// Adding it rounds to the nearest integer, which then stands in the low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const TWO_OVER_PI: f64 = core::f64::consts::FRAC_2_PI;
    /// π/2 in parts of 33 bits, so that their multiples by the quadrant are exact.
    const PART_1: f64 = f64::from_bits(0x3FF9_21FB_5440_0000);
    const PART_2: f64 = f64::from_bits(0x3DD0_B461_1A60_0000);
    const PART_3: f64 = f64::from_bits(0x3BA3_198A_2E03_7073);

    let shifted = x * TWO_OVER_PI + ROUND;
    let quadrant = shifted - ROUND;
    let a = x - quadrant * PART_1;
    let b = quadrant * PART_2;
    let r = a - b;
    // What the rounding of a − b lost, together with the third part: enters to first order.
    (shifted.to_bits(), r, ((a - r) - b) - quadrant * PART_3)
}

/// Sine and cosine of r + tail; the quadrant passes through.
#[inline(always)]
fn series((quadrant, r, tail): (u64, f64, f64)) -> (u64, f64, f64) {
    /// (sin r − r)/r³ and (cos r − 1 + r²/2)/r⁴ in powers of r², least largest error on [−π/4, π/4]: 2⁻⁵⁷ of sin r, 2⁻⁶⁴.
    const SIN: [f64; 6] = [
        -0.1666666666666663,
        0.00833333333332184,
        -0.00019841269829358528,
        2.7557313538514145e-06,
        -2.5050734389213312e-08,
        1.589543328403925e-10,
    ];
    const COS: [f64; 6] = [
        0.0416666666666666,
        -0.0013888888888874472,
        2.4801587289669257e-05,
        -2.755731440017139e-07,
        2.0875729142701148e-09,
        -1.1359926131887998e-11,
    ];

    // By Estrin's scheme, whose products do not wait for each other.
    let ([s0, s1, s2, s3, s4, s5], [c0, c1, c2, c3, c4, c5]) = (SIN, COS);
    let z = r * r;
    let square = z * z;
    let s = (s0 + s1 * z) + square * ((s2 + s3 * z) + square * (s4 + s5 * z));
    let c = (c0 + c1 * z) + square * ((c2 + c3 * z) + square * (c4 + c5 * z));
    let half = 0.5 * z;
    let one = 1.0 - half;
    let sin = r + (r * z * s + tail * one);
    let cos = one + (((1.0 - one) - half) + (square * c - r * tail));
    (quadrant, sin, cos)
}

/// Sine and cosine in the quadrant that the two low bits say: odd ones swap the two, both bits decide on signs.
#[inline(always)]
fn turned((quadrant, sin, cos): (u64, f64, f64)) -> (f64, f64) {
    let odd = 0u64.wrapping_sub(quadrant & 1);
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let swap = (sin ^ cos) & odd;
    let sign_sin = (quadrant & 2) << 62;
    let sign_cos = (quadrant.wrapping_add(1) & 2) << 62;
    (f64::from_bits(sin ^ swap ^ sign_sin), f64::from_bits(cos ^ swap ^ sign_cos))
}
