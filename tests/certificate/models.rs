//! Taylor models and balls enclose what they stand for, whatever is done with them.

use crate::double::Double;
use piaffe::certificate::taylor::Taylor;
use piaffe::number::Scalar;
use proptest::prelude::*;

/// Something to compute.
#[derive(Clone, Debug)]
enum Term {
    /// A polynomial and a rest, of which a share between −1 and 1 is taken.
    Leaf(Vec<f64>, f64),
    Sum(Box<Term>, Box<Term>),
    Difference(Box<Term>, Box<Term>),
    Product(Box<Term>, Box<Term>),
    Quotient(Box<Term>, Box<Term>),
    Sine(Box<Term>),
    Cosine(Box<Term>),
    Root(Box<Term>),
    Magnitude(Box<Term>),
    Integral(Vec<f64>),
}

fn term() -> impl Strategy<Value = Term> {
    let coefficient = || prop_oneof![4 => -2.0..2.0, 1 => -1e-3..1e-3, 1 => Just(0.0), 1 => -40.0..40.0];
    let coefficients = || prop::collection::vec(coefficient(), 1..5);
    let rest = prop_oneof![Just(0.0), 0.0..1e-9, 0.0..1e-2];
    let leaf = prop_oneof![
        4 => (coefficients(), rest).prop_map(|(c, rest)| Term::Leaf(c, rest)),
        1 => coefficients().prop_map(Term::Integral),
    ];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let one = || inner.clone().prop_map(Box::new);
        prop_oneof![
            (one(), one()).prop_map(|(a, b)| Term::Sum(a, b)),
            (one(), one()).prop_map(|(a, b)| Term::Difference(a, b)),
            (one(), one()).prop_map(|(a, b)| Term::Product(a, b)),
            (one(), one()).prop_map(|(a, b)| Term::Quotient(a, b)),
            one().prop_map(Term::Sine),
            one().prop_map(Term::Cosine),
            one().prop_map(Term::Root),
            one().prop_map(Term::Magnitude),
        ]
    })
}

fn model<const N: usize>(term: &Term) -> Taylor<N> {
    match term {
        Term::Leaf(c, rest) => Taylor::polynomial(c).widened(*rest),
        Term::Integral(c) => Taylor::polynomial(c).integral(),
        Term::Sum(a, b) => model(a) + model(b),
        Term::Difference(a, b) => model(a) - model(b),
        Term::Product(a, b) => model(a) * model(b),
        Term::Quotient(a, b) => model(a) / model(b),
        Term::Sine(a) => model(a).sin_cos().0,
        Term::Cosine(a) => model(a).sin_cos().1,
        Term::Root(a) => {
            let x = model(a);
            (x * x).sqrt()
        }
        Term::Magnitude(a) => model(a).abs(),
    }
}

fn polynomial(c: &[f64], tau: Double) -> Double {
    c.iter().rev().fold(0.0.into(), |sum, c| sum * tau + Double::from(*c))
}

/// The value at τ of one of the functions that the term stands for, and how precisely that is known.
fn value(term: &Term, tau: f64, share: f64) -> Option<(Double, f64)> {
    let of = |t: &Term| value(t, tau, share);
    let fine = 1e-29;
    let (x, error) = match term {
        Term::Leaf(c, rest) => (polynomial(c, tau.into()) + Double::from(*rest) * share.into(), fine),
        Term::Integral(c) => {
            let power = |k: usize, c: &f64| Double::from(*c) / ((k + 1) as f64).into();
            let of =
                |at: Double| at * c.iter().enumerate().rev().fold(0.0.into(), |s: Double, (k, c)| s * at + power(k, c));
            (of(tau.into()) - of((-1.0).into()), fine)
        }
        Term::Sum(a, b) => of(a).zip(of(b)).map(|(a, b)| (a.0 + b.0, a.1 + b.1))?,
        Term::Difference(a, b) => of(a).zip(of(b)).map(|(a, b)| (a.0 - b.0, a.1 + b.1))?,
        Term::Product(a, b) => {
            let ((a, da), (b, db)) = of(a).zip(of(b))?;
            (a * b, da * b.high.abs() + db * a.high.abs() + da * db)
        }
        Term::Quotient(a, b) => {
            let ((a, da), (b, db)) = of(a).zip(of(b))?;
            let least = b.high.abs();
            if least < 1e-6 {
                return None;
            }
            (a / b, 2.0 * (da + db * (a.high / b.high).abs()) / least)
        }
        Term::Sine(a) => of(a).map(|(a, da)| (a.sin_cos().0, da + fine * (1.0 + a.high.abs())))?,
        Term::Cosine(a) => of(a).map(|(a, da)| (a.sin_cos().1, da + fine * (1.0 + a.high.abs())))?,
        Term::Root(a) => of(a).map(|(a, da)| (a.magnitude(), da))?,
        Term::Magnitude(a) => of(a).map(|(a, da)| (a.magnitude(), da))?,
    };
    let error = error + fine * x.high.abs();
    (x.high.abs() < 1e12 && error < 1e-18 * x.high.abs().max(1.0)).then_some((x, error))
}

/// Whether a model with its polynomial at τ has this value.
fn contains<const N: usize>(model: &Taylor<N>, coefficients: &[f64], tau: f64, (x, error): (Double, f64)) -> bool {
    let apart = (polynomial(coefficients, tau.into()) - x).magnitude().high;
    !model.rest().is_finite() || apart <= model.rest() * (1.0 + 1e-15) + error
}

fn judge<const N: usize>(term: &Term, tau: f64, share: f64) -> Result<(), TestCaseError> {
    let found = model::<N>(term);
    let Some(exact) = value(term, tau, share) else { return Ok(()) };
    prop_assert!(contains(&found, found.coefficients(), tau, exact), "{found:?} at {tau}: {exact:?}");
    if found.rest().is_finite() {
        let [low, high] = found.bounds();
        prop_assert!(low <= exact.0.high && exact.0.high <= high, "{low} ≤ {exact:?} ≤ {high}");
        prop_assert!(found.least() <= exact.0.high && found.least() >= low);
        prop_assert!(found.magnitude() >= exact.0.high.abs());
        let at = found.at(tau);
        prop_assert!(contains(&at, at.coefficients(), 0.0, exact), "{at:?} at {tau}: {exact:?}");
        let fewer = found.cast::<3>();
        prop_assert!(contains(&fewer, fewer.coefficients(), tau, exact), "{fewer:?} at {tau}: {exact:?}");
        // τ in the left half is 2τ + 1 there.
        let [left, right] = found.halves();
        let (half, place) = if tau < 0.0 { (left, 2.0 * tau + 1.0) } else { (right, 2.0 * tau - 1.0) };
        // Doubling τ may round; a multiple of 2⁻⁴⁰ does not.
        prop_assert!(contains(&half, half.coefficients(), place, exact), "{half:?} at {tau}: {exact:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").ok().and_then(|c| c.parse().ok()).unwrap_or(1000), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn models_enclose(term in term(), tau in -(1_i64 << 40)..=(1_i64 << 40), share in prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0]) {
        let tau = tau as f64 / (1_u64 << 40) as f64;
        judge::<11>(&term, tau, share)?;
        judge::<4>(&term, tau, share)?;
        judge::<1>(&term, tau, share)?;
    }
}

/// That nothing false is claimed could be had by claiming nothing.
#[test]
fn models_are_sharp() {
    // e.g. 1 / (2 + sin(τ/4)²) over a short interval.
    let tau = Taylor::<11>::polynomial(&[0.3, 0.05]);
    let (sin, _) = tau.sin_cos();
    let f = Taylor::from(1.0) / (Taylor::from(2.0) + sin * sin);
    assert!(f.rest() < 1e-14, "{}", f.rest());
    let exact = 1.0 / (2.0 + 0.35_f64.sin().powi(2));
    assert!((f.bounds()[0] - exact).abs() < 1e-4 && (f.least() - exact).abs() < 1e-9);
    let root = (sin * sin).sqrt();
    assert!(root.rest() < 1e-13 && (root - sin).magnitude() < 1e-13);
}

/// The least value of a polynomial is found, not merely bounded.
#[test]
fn the_least_value_is_met() {
    let mut rng = fastrand::Rng::with_seed(5);
    for _ in 0..200 {
        let degree = rng.usize(0..=10);
        let c: Vec<f64> = (0..=degree).map(|_| 2.0 * rng.f64() - 1.0).collect();
        let value = |tau: f64| c.iter().rev().fold(0.0, |sum, c| sum * tau + c);
        let seen = (0..=20_000).map(|k| value(k as f64 / 1e4 - 1.0)).fold(f64::INFINITY, f64::min);
        let least = Taylor::<11>::polynomial(&c).least();
        // Between two of these places it is lower by at most an eighth of the second derivative times the square of their distance.
        assert!(least <= seen && seen - least < 1e-6, "{c:?}: {least} of {seen}");
        assert!(seen - least < 1e-9 || degree > 1, "{c:?}: {least} of {seen}");
    }
}

#[test]
fn what_is_undefined_is_unknown() {
    let across = Taylor::<4>::polynomial(&[0.1, 1.0]);
    for unknown in [Taylor::from(1.0) / across, Taylor::from(f64::NAN), Taylor::UNKNOWN * Taylor::from(0.0)] {
        let [low, high] = (unknown + 1.0.into()).bounds();
        assert!(low == f64::NEG_INFINITY && high == f64::INFINITY, "{unknown:?}");
        assert_eq!(unknown.least(), f64::NEG_INFINITY);
        assert_eq!(unknown.least_magnitude(), 0.0);
    }
}

/// Dry friction has the sign of a rate: where that may be either, so may be its sign.
#[test]
fn a_sign_is_every_sign_that_it_may_be() {
    let (rest, one) = (1e-6, |sign: f64| [sign, sign]);
    let bounds = |coefficients: &[f64]| Taylor::<4>::polynomial(coefficients).side(rest).bounds();
    let encloses = |coefficients: &[f64], low: f64, high: f64| {
        let [least, most] = bounds(coefficients);
        assert!(least <= low && most >= high, "{coefficients:?}: {least} {most}");
    };
    let near = |found: [f64; 2], sign: [f64; 2]| (0..2).all(|k| (found[k] - sign[k]).abs() < 1e-12);
    assert!(near(bounds(&[2.0, 1.0]), one(1.0)) && near(bounds(&[-2.0, 1.0]), one(-1.0)));
    assert!(near(bounds(&[1e-7]), one(0.0)));
    encloses(&[0.0, 1.0], -1.0, 1.0);
    encloses(&[0.5, 1.0], -1.0, 1.0);
    encloses(&[1.0 + 0.5e-6, 1.0], 0.0, 1.0);
    let unknown = Taylor::<4>::UNKNOWN.side(rest).bounds();
    assert!(unknown[0] <= -1.0 && unknown[1] >= 1.0);
    let widened = Taylor::<4>::polynomial(&[1e-3]).widened(2e-3).side(rest).bounds();
    assert!(widened[0] <= -1.0 && widened[1] >= 1.0);
}
