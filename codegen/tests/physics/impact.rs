//! Laws of passive impacts (eq. 11, 12).

use super::common::Derived;
use super::numbers::{along, assert_close, assert_within, product, transposed_product};
use super::state::State;
use super::support::{largest, with_foot_at_rest};
use piaffe_codegen::mechanism::other_leg;

fn kinetic(d: &Derived, s: &State, xd: &[f64]) -> f64 {
    d.run("energy", &[&s.x, xd]).number("kinetic")
}

/// The foot's velocity in world axes.
fn foot_velocity(d: &Derived, s: &State, leg: usize, xd: &[f64]) -> Vec<f64> {
    transposed_product(d.run(&format!("foot_jacobian{}", leg + 1), &[&s.q]).get("d"), xd)
}

/// A(Ẋ⁺ − Ẋ⁻) less the impulses on the feet: zero in every coordinate.
fn momentum_balance(d: &Derived, s: &State, before: &[f64], after: &[f64], impulses: [&[f64]; 2]) {
    let change = product(d.run("inertia", &[&s.q]).get("a"), &along(after, -1.0, before));
    let mut rest = change.clone();
    for (leg, impulse) in impulses.iter().enumerate() {
        let jacobian = d.run(&format!("foot_jacobian{}", leg + 1), &[&s.q]);
        rest = along(&rest, -1.0, &product(jacobian.get("d"), impulse));
    }
    let scale = largest(&change).max(largest(impulses[0])).max(largest(impulses[1]));
    assert_within("A(Ẋ⁺ − Ẋ⁻) − D I", &rest, &vec![0.0; rest.len()], 1e-9, scale);
}

/// One foot comes to rest, the other is free (eq. 12).
pub fn one_foot(d: &Derived, s: &State, leg: usize) {
    let positions = d.mechanism().positions();
    let none = vec![0.0; positions];
    let name = format!("impact{}", leg + 1);
    let impact = d.run(&name, &[&s.q, &s.xd]);
    let (after, impulse) = (impact.get("xd_plus"), impact.get("impulse"));
    assert_close("landed foot at rest", &foot_velocity(d, s, leg, after), &none, 1e-9);
    let mut impulses = [&none[..], &none[..]];
    impulses[leg] = impulse;
    momentum_balance(d, s, &s.xd, after, impulses);
    let lost = kinetic(d, s, &s.xd) - kinetic(d, s, after);
    assert!(lost >= -1e-9 * kinetic(d, s, &s.xd), "energy lost: {lost}");

    // As the end of a single support on the other foot.
    let before = with_foot_at_rest(d, other_leg(leg), s);
    let expected = d.run(&name, &[&s.q, &before]);
    let found = d.run(&format!("touchdown{}", leg + 1), &[&s.q, &s.qd]);
    assert_close("touchdown q̇⁺", found.get("qd_plus"), &expected.get("xd_plus")[positions..], 1e-9);
    assert_close("touchdown impulse", found.get("impulse"), expected.get("impulse"), 1e-9);
    let leaving = foot_velocity(d, s, other_leg(leg), expected.get("xd_plus"))[1];
    assert_close("leaving foot", found.get("leaving"), &[leaving], 1e-9);
    assert_close("landing foot", found.get("landing"), &[foot_velocity(d, s, leg, &before)[1]], 1e-11);
}

/// Both feet come to rest (eq. 11): a state that `one_foot` then leaves alone.
pub fn both_feet(d: &Derived, s: &State) {
    let impact = d.run("impact_both", &[&s.q, &s.xd]);
    let singular = impact.get("pivots").iter().zip(impact.get("scale")).any(|(p, s)| p.abs() < 1e-4 * s.abs());
    if singular {
        return;
    }
    let after = impact.get("xd_plus");
    for leg in 0..2 {
        let at_rest = vec![0.0; d.mechanism().positions()];
        assert_close("both feet at rest", &foot_velocity(d, s, leg, after), &at_rest, 1e-8);
        let again = d.run(&format!("impact{}", leg + 1), &[&s.q, after]);
        assert_close("impact of a foot at rest", again.get("xd_plus"), after, 1e-8);
    }
    momentum_balance(d, s, &s.xd, after, [impact.get("impulse1"), impact.get("impulse2")]);
    let one = d.run("impact2", &[&s.q, &s.xd]);
    let (more, less) = (kinetic(d, s, one.get("xd_plus")), kinetic(d, s, after));
    assert!(less <= more * (1.0 + 1e-9) + 1e-9, "energy left: {less} of {more}");
}
