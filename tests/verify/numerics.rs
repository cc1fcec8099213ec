//! The tools of verification: polynomials, integration, quadrature.

use piaffe::motion::Course;
use piaffe::verify::integrate::{Stop, integrate};
use piaffe::verify::polynomial::Polynomials;
use piaffe::verify::quadrature::{integral, integral_of_magnitude};

#[test]
fn polynomials_meet_their_conditions() {
    for interior in [0, 1, 2, 3, 5] {
        let h = Course {
            duration: 0.23,
            q_initial: vec![0.3, -0.7],
            qd_initial: vec![2.0, -5.0],
            q_interior: (0..interior).map(|k| vec![0.2 * k as f64, -0.5 - 0.1 * k as f64]).collect(),
            q_final: vec![-0.2, -1.1],
            qd_final: vec![-3.0, 4.0],
            beta_initial: 0.0,
            betad_initial: 0.0,
            beta_final: 0.0,
            betad_final: 0.0,
        };
        let polynomials = Polynomials::new(&h);
        let near =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
        for k in 0..2 {
            let ([begin, first_rate, _], [end, last_rate, _]) = (polynomials.at(k, 0.0), polynomials.at(k, h.duration));
            near(begin, h.q_initial[k]);
            near(first_rate, h.qd_initial[k]);
            near(end, h.q_final[k]);
            near(last_rate, h.qd_final[k]);
            for (i, q) in h.q_interior.iter().enumerate() {
                near(polynomials.at(k, h.duration * (i + 1) as f64 / (interior + 1) as f64)[0], q[k]);
            }
            // Rates and accelerations are derivatives: central differences.
            let (t, e) = (0.07, 1e-5);
            let [before, now, after] = [t - e, t, t + e].map(|t| polynomials.at(k, t));
            assert!(((after[0] - before[0]) / (2.0 * e) - now[1]).abs() < 1e-5);
            assert!(((after[1] - before[1]) / (2.0 * e) - now[2]).abs() < 1e-3);
        }
    }
}

/// ÿ = −y from (0, 1): y = sin t.
fn oscillator(tolerance: f64) -> (f64, usize) {
    let solution = integrate(|_, y: &[f64; 2]| Some([y[1], -y[0]]), 0.0, 20.0, [0.0, 1.0], tolerance).unwrap();
    let mut cursor = 0;
    let worst = (0..=1000).map(|i| {
        let t = 0.02 * i as f64;
        let [y, rate] = solution.at(t, &mut cursor);
        (y - t.sin()).abs().max((rate - t.cos()).abs())
    });
    (worst.fold(0.0, f64::max), solution.steps())
}

#[test]
fn integration_keeps_the_tolerance_at_high_order() {
    let (loose, few) = oscillator(1e-7);
    let (tight, many) = oscillator(1e-12);
    // Everywhere, not only at the ends of steps.
    assert!(loose < 1e-5 && tight < 1e-10, "errors {loose:e}, {tight:e}");
    // At order 8, five more digits take 10^(5/8) = 4.2 times as many steps; at order 5, ten times.
    assert!(many < 6 * few, "{few} and {many} steps");
}

#[test]
fn a_blowup_is_found_where_it_is() {
    let found = integrate(|_, y: &[f64; 1]| Some([y[0] * y[0]]), 0.0, 2.0, [1.0], 1e-10);
    let Err(Stop::Blowup { time } | Stop::Steps { time }) = found else { panic!("{found:?}") };
    assert!((time - 1.0).abs() < 1e-3, "1/(1 − t) given up at {time}");
}

#[test]
fn the_end_of_the_domain_is_found_where_it_is() {
    let found = integrate(|t, _: &[f64; 1]| (t < 0.7).then_some([1.0]), 0.0, 1.0, [0.0], 1e-10);
    let Err(Stop::Blowup { time }) = found else { panic!("{found:?}") };
    assert!((time - 0.7).abs() < 1e-6, "given up at {time}");
    assert!(integrate(|_, _: &[f64; 1]| None, 0.0, 1.0, [0.0], 1e-10).is_err());
    assert!(integrate(|_, _: &[f64; 1]| Some([f64::NAN]), 0.0, 1.0, [0.0], 1e-10).is_err());
}

#[test]
fn noise_does_not_go_on_forever() {
    let mut calls = 0_u32;
    let noise = |_: f64, _: &[f64; 1]| {
        calls = calls.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some([f64::from(calls) / 4e9])
    };
    assert!(integrate(noise, 0.0, 1.0, [0.0], 1e-12).is_err());
}

#[test]
fn quadrature_is_exact_for_cubics_and_of_fourth_order() {
    let grid = |n: usize, f: fn(f64) -> f64| (0..=n).map(|i| f(i as f64 / n as f64)).collect::<Vec<_>>();
    assert!((integral(&grid(7, |t| 1.0 - 2.0 * t + 4.0 * t * t * t), 1.0 / 7.0) - 1.0).abs() < 1e-15);
    let error = |n: usize| (integral(&grid(n, f64::exp), 1.0 / n as f64) - (1.0_f64.exp() - 1.0)).abs();
    let ratio = error(50) / error(100);
    assert!((14.0..18.0).contains(&ratio), "halving the spacing divides the error by {ratio}");
}

#[test]
fn kinks_of_a_magnitude_cost_no_accuracy() {
    // ∫₀¹ |sin 9t| dt: two kinks, neither of them on the grid.
    let exact = (5.0 - 9.0_f64.cos()) / 9.0;
    let values: Vec<f64> = (0..=200).map(|i| (9.0 * i as f64 / 200.0).sin()).collect();
    let found = integral_of_magnitude(&values, 1.0 / 200.0);
    assert!((found - exact).abs() < 1e-7 * exact, "{found} instead of {exact}");
}
