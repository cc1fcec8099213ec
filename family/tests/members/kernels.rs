//! Kernels by the names under which they are derived.

use piaffe::model::Mode;
use piaffe::model::family::Parametric;

/// How the names of kernels of flight begin.
const FLIGHT: &str = "flight_";

/// The mode of the kernel `name`, if it is of one.
pub fn mode(name: &str) -> Mode {
    if name.starts_with(FLIGHT) { Mode::Flight } else { Mode::Stance(leg(name)) }
}

fn leg(name: &str) -> usize {
    usize::from(name.ends_with('2'))
}

/// Calls the trait's method for the kernel `name`, which may begin with the mode or end in the leg's number.
pub fn call(member: &dyn Parametric, name: &str, i: &[Vec<f64>], out: &mut [f64]) {
    let (mode, leg) = (mode(name), leg(name));
    // Where there is no reaction, nothing weighs it.
    let weights = |from: usize| match &i[from..] {
        [n, phi, others] => [&n[..], phi, others],
        [n, others] => [&n[..], &[], others],
        _ => panic!("weights of the kernel {name}"),
    };
    match name.trim_start_matches(FLIGHT).trim_end_matches(['1', '2']) {
        "inertia" => member.inertia(&i[0], out),
        "bias" => member.bias(&i[0], &i[1], out),
        "inertia_and_bias" => member.inertia_and_bias(&i[0], &i[1], out),
        "energy" => member.energy(&i[0], &i[1], out),
        "centre_of_mass" => member.centre_of_mass(&i[0], &i[1], out),
        "foot" => member.foot(leg, &i[0], out),
        "foot_jacobian" => member.foot_jacobian(leg, &i[0], out),
        "foot_bias" => member.foot_bias(leg, &i[0], &i[1], out),
        "angular_momentum" => member.angular_momentum(leg, &i[0], &i[1], out),
        "platform_velocity" => member.platform_velocity(mode, &i[0], &i[1], out),
        "momentum_terms" => member.momentum_terms(mode, &i[0], &i[1], out),
        "reduced" => member.reduced(mode, &i[0], &i[1], out),
        "forward" => member.forward(mode, &i[0], &i[1], &i[2], out),
        "inverse" => member.inverse(mode, &i[0], &i[1], &i[2], out),
        "momentum" => member.momentum(mode, &i[0], &i[1], out),
        "inverse_jacobian" => member.inverse_jacobian(mode, &i[0], &i[1], &i[2], out),
        "placement" => member.placement(mode, &i[0], out),
        "heights" => member.heights(mode, &i[0], out),
        "heights_curvature" => member.heights_curvature(mode, &i[0], &i[1], out),
        "swing_velocity" => member.swing_velocity(mode, &i[0], &i[1], out),
        "early" => member.early(mode, &i[0], &i[1], out),
        "late" => member.late(mode, &i[0], i[1][0], out),
        "late_gradient" => member.late_gradient(mode, &i[0], i[1][0], out),
        "impact" => member.impact(leg, &i[0], &i[1], out),
        "touchdown" => member.touchdown(leg, &i[0], &i[1], out),
        "curvature" => {
            let [n, phi, others] = weights(3);
            member.curvature(mode, &i[0], &i[1], &i[2], n, phi, others, out);
        }
        "touchdown_curvature" => member.touchdown_curvature(leg, &i[0], &i[1], &i[2], &i[3], out),
        "landing" => member.landing(leg, &i[0], &i[1], &i[2], out),
        "landing_curvature" => member.landing_curvature(leg, &i[0], &i[1], &i[2], &i[3], &i[4], out),
        "takeoff" => member.takeoff(leg, &i[0], &i[1], &i[2], out),
        "takeoff_curvature" => member.takeoff_curvature(leg, &i[0], &i[1], &i[2], &i[3], out),
        "sharing" => member.sharing(mode, &i[0], &i[1], &i[2], out),
        "sharing_curvature" => member.sharing_curvature(mode, &i[0], &i[1], &i[2], &i[3], out),
        "impact_both" => member.impact_both(&i[0], &i[1], out),
        "sensitivity" => {
            let [n, phi, others] = weights(3);
            member.sensitivity(mode, &i[0], &i[1], &i[2], n, phi, others, out);
        }
        "terms_sensitivity" => member.terms_sensitivity(mode, &i[0], &i[1], &i[2], out),
        "touchdown_sensitivity" => member.touchdown_sensitivity(leg, &i[0], &i[1], &i[2], &i[3], out),
        "landing_sensitivity" => member.landing_sensitivity(leg, &i[0], &i[1], &i[2], &i[3], &i[4], out),
        "takeoff_sensitivity" => member.takeoff_sensitivity(leg, &i[0], &i[1], &i[2], &i[3], out),
        _ => panic!("no method for the kernel {name}"),
    }
}

pub fn filled(length: usize, fill: impl FnOnce(&mut [f64])) -> Vec<f64> {
    let mut out = vec![f64::NAN; length];
    fill(&mut out);
    out
}

/// Numbers in −size … size.
pub fn vector(length: usize, size: f64, rng: &mut fastrand::Rng) -> Vec<f64> {
    (0..length).map(|_| size * (2.0 * rng.f64() - 1.0)).collect()
}

/// Equal within `tolerance` of the largest number.
pub fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}: length");
    let scale = expected.iter().fold(1.0f64, |m, x| m.max(x.abs()));
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * scale, "{what}: {found:?} instead of {expected:?}");
    }
}
