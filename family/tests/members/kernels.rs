//! Kernels by the names under which they are derived.

use piaffe::model::family::Parametric;

/// Calls the trait's method for the kernel `name`, which may end in the leg's number.
pub fn call(member: &dyn Parametric, name: &str, i: &[Vec<f64>], out: &mut [f64]) {
    let base = name.trim_end_matches(['1', '2']);
    let leg = usize::from(name.ends_with('2'));
    match base {
        "inertia" => member.inertia(&i[0], out),
        "bias" => member.bias(&i[0], &i[1], out),
        "inertia_and_bias" => member.inertia_and_bias(&i[0], &i[1], out),
        "energy" => member.energy(&i[0], &i[1], out),
        "centre_of_mass" => member.centre_of_mass(&i[0], &i[1], out),
        "foot" => member.foot(leg, &i[0], out),
        "foot_jacobian" => member.foot_jacobian(leg, &i[0], out),
        "foot_bias" => member.foot_bias(leg, &i[0], &i[1], out),
        "angular_momentum" => member.angular_momentum(leg, &i[0], &i[1], out),
        "platform_velocity" => member.platform_velocity(leg, &i[0], &i[1], out),
        "momentum_terms" => member.momentum_terms(leg, &i[0], &i[1], out),
        "reduced" => member.reduced(leg, &i[0], &i[1], out),
        "forward" => member.forward(leg, &i[0], &i[1], &i[2], out),
        "inverse" => member.inverse(leg, &i[0], &i[1], &i[2], out),
        "momentum" => member.momentum(leg, &i[0], &i[1], out),
        "inverse_jacobian" => member.inverse_jacobian(leg, &i[0], &i[1], &i[2], out),
        "placement" => member.placement(leg, &i[0], out),
        "heights" => member.heights(leg, &i[0], out),
        "heights_curvature" => member.heights_curvature(leg, &i[0], &i[1], out),
        "swing_velocity" => member.swing_velocity(leg, &i[0], &i[1], out),
        "early" => member.early(leg, &i[0], &i[1], out),
        "late" => member.late(leg, &i[0], i[1][0], out),
        "late_gradient" => member.late_gradient(leg, &i[0], i[1][0], out),
        "impact" => member.impact(leg, &i[0], &i[1], out),
        "touchdown" => member.touchdown(leg, &i[0], &i[1], out),
        "curvature" => member.curvature(leg, &i[0], &i[1], &i[2], &i[3], &i[4], &i[5], out),
        "touchdown_curvature" => member.touchdown_curvature(leg, &i[0], &i[1], &i[2], &i[3], out),
        "sharing" => member.sharing(leg, &i[0], &i[1], &i[2], out),
        "sharing_curvature" => member.sharing_curvature(leg, &i[0], &i[1], &i[2], &i[3], out),
        "impact_both" => member.impact_both(&i[0], &i[1], out),
        "sensitivity" => member.sensitivity(leg, &i[0], &i[1], &i[2], &i[3], &i[4], &i[5], out),
        "terms_sensitivity" => member.terms_sensitivity(leg, &i[0], &i[1], &i[2], out),
        "touchdown_sensitivity" => member.touchdown_sensitivity(leg, &i[0], &i[1], &i[2], &i[3], out),
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
