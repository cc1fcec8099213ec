//! The pinned sine and cosine against a double-double Taylor series, in units in the last place.

#[path = "../support/math.rs"]
mod math;

/// An unevaluated sum of two numbers, about 106 bits.
#[derive(Clone, Copy)]
struct Double(f64, f64);

/// `a + b` exactly.
fn two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let t = s - a;
    Double(s, (a - (s - t)) + (b - t))
}

/// `a · b` exactly.
fn two_product(a: f64, b: f64) -> Double {
    let p = a * b;
    Double(p, a.mul_add(b, -p))
}

impl Double {
    fn plus(self, b: Double) -> Double {
        let (high, low) = (two_sum(self.0, b.0), two_sum(self.1, b.1));
        let sum = two_sum(high.0, high.1 + low.0);
        two_sum(sum.0, sum.1 + low.1)
    }

    fn times(self, b: Double) -> Double {
        let p = two_product(self.0, b.0);
        two_sum(p.0, p.1 + (self.0 * b.1 + self.1 * b.0))
    }

    fn over(self, n: f64) -> Double {
        let q = self.0 / n;
        let p = two_product(q, n);
        two_sum(q, ((self.0 - p.0) - p.1 + self.1) / n)
    }

    fn negative(self) -> Double {
        Double(-self.0, -self.1)
    }
}

/// `Σ (−1)ⁿ r²ⁿ⁺ˢ/(2n+s)!` from its first term.
fn series(first: Double, start: f64, square: Double) -> Double {
    let (mut term, mut sum, mut n) = (first, first, start);
    for _ in 0..14 {
        term = term.times(square).over((n + 1.0) * (n + 2.0)).negative();
        sum = sum.plus(term);
        n += 2.0;
    }
    sum
}

/// Reference values for |x| ≤ 1e5.
fn reference(x: f64) -> (Double, Double) {
    // π/2 to 160 bits; products with the quadrant are exact pairs, so nothing is lost where they cancel.
    const PARTS: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
    let quadrant = (x * std::f64::consts::FRAC_2_PI).round();
    let mut r = Double(x, 0.0);
    for part in PARTS {
        r = r.plus(two_product(quadrant, part).negative());
    }
    let square = r.times(r);
    let (sin, cos) = (series(r, 1.0, square), series(Double(1.0, 0.0), 0.0, square));
    match quadrant.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, sin.negative()),
        2 => (sin.negative(), cos.negative()),
        _ => (cos.negative(), sin),
    }
}

fn ulps(found: f64, exact: Double) -> f64 {
    let size = exact.0.abs();
    let ulp = f64::from_bits(size.to_bits() + 1) - size;
    (((found - exact.0) - exact.1) / ulp).abs()
}

fn error(x: f64) -> f64 {
    let ((sin, cos), (s, c)) = (math::sin_cos(x), reference(x));
    ulps(sin, s).max(ulps(cos, c))
}

/// Largest error over points spread evenly on [−range, range].
fn largest(range: f64, points: u32) -> f64 {
    let golden = 0.618_033_988_749_894_9;
    (0..points).map(|k| error(range * (2.0 * (f64::from(k) * golden).fract() - 1.0))).fold(0.0, f64::max)
}

/// Largest error within a few numbers of the multiples of π/2 up to `range`.
fn largest_near_multiples(range: f64) -> f64 {
    let count = (range * std::f64::consts::FRAC_2_PI) as i64;
    let mut worst = 0.0f64;
    for k in (-count..=count).filter(|k| *k != 0) {
        let bits = (k as f64 * std::f64::consts::FRAC_PI_2).to_bits();
        worst = (bits - 20..=bits + 20).map(|b| error(f64::from_bits(b))).fold(worst, f64::max);
    }
    worst
}

#[test]
fn the_reference_is_right_where_it_is_known() {
    let (s, c) = reference(1.0);
    assert!((s.0 - 0.841_470_984_807_896_5).abs() < 2e-16 && (c.0 - 0.540_302_305_868_139_7).abs() < 2e-16);
    let one = s.times(s).plus(c.times(c));
    assert!(((one.0 - 1.0) + one.1).abs() < 1e-30);
    // sin(x + π) = −sin x to all digits, across the reduction: the nearest number to π has sin 1.22…e-16.
    assert!((reference(std::f64::consts::PI).0.0 - 1.224_646_799_147_353_2e-16).abs() < 1e-31);
}

#[test]
fn below_one_ulp_up_to_100() {
    let (spread, near, small) = (largest(100.0, 300_000), largest_near_multiples(100.0), largest(1.6, 200_000));
    println!(
        "largest error on [-100, 100]: {spread:.4} ulp; near multiples of π/2: {near:.4}; on [-1.6, 1.6]: {small:.4}"
    );
    assert!(spread < 0.82 && near < 0.82 && small < 0.82);
}

#[test]
fn below_one_ulp_up_to_100_000() {
    let (spread, near) = (largest(1e5, 200_000), largest_near_multiples(1e4));
    println!("largest error on [-1e5, 1e5]: {spread:.4} ulp; near multiples of π/2 up to 1e4: {near:.4}");
    assert!(spread < 1.0 && near < 1.0);
}

#[test]
fn symmetries_and_ends_are_exact() {
    for k in 0..1000 {
        let x = f64::from(k) * 0.173;
        let ((s, c), (t, d)) = (math::sin_cos(x), math::sin_cos(-x));
        assert_eq!((s, c), (-t, d));
    }
    assert_eq!(math::sin_cos(0.0), (0.0, 1.0));
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (s, c) = math::sin_cos(x);
        assert!(s.is_nan() && c.is_nan());
    }
}

/// The same bits on every machine: a few results, pinned.
#[test]
fn pinned_bits() {
    let digest = (0..10_000).fold(0u64, |sum, k| {
        let (s, c) = math::sin_cos(f64::from(k) * 0.010_3 - 51.0);
        sum.rotate_left(5) ^ s.to_bits() ^ c.to_bits().rotate_left(32)
    });
    assert_eq!(format!("{digest:016x}"), PINNED);
}

const PINNED: &str = "228ac002a50541ff";

/// Several angles at once, side by side or in step, have the bits of each on its own.
#[test]
fn angles_at_once_are_single_angles() {
    fn agree<const N: usize>(x: [f64; N]) {
        let bits = |pairs: [(f64, f64); N]| pairs.map(|(s, c)| (s.to_bits(), c.to_bits()));
        let single = bits(x.map(math::sin_cos));
        assert_eq!(bits(math::sin_cos_together(x)), single);
        assert_eq!(bits(math::sin_cos_in_step(x)), single);
    }
    for k in 0..200 {
        let [a, b, c, d] = std::array::from_fn(|i| f64::from(4 * k + i as i32 - 400).powi(3) * 1e-3);
        agree([a]);
        agree([a, b]);
        agree([a, b, c]);
        agree([a, b, c, d]);
    }
}
