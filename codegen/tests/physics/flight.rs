//! Laws of flight: the mass centre falls like a stone, and nothing turns the robot about it.

use super::common::{Derived, FAMILIES, GAITS, Outputs, in_all_modes, shipped};
use super::numbers::{
    along, assert_close, assert_within, difference, dot, is_positive_definite, momentum, product, transposed_product,
};
use super::robots::Draws;
use super::state::State;
use super::support::{largest, prescribed, with_foot_at_rest};
use piaffe_codegen::expr::Poly;
use piaffe_codegen::mechanism::{Mechanism, Mode, other_leg};
use piaffe_codegen::spec::Rotation;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Of identities that hold exactly, as a share of the largest number in them.
const EXACT: f64 = 1e-12;

/// Rate of an expression in X and Ẋ along a motion, by its exact derivatives; and the sum of its terms' magnitudes.
fn rate(d: &Derived, p: &Poly, x: &[f64], xd: &[f64], xdd: &[f64]) -> (f64, f64) {
    let symbols = [d.model.x(0), d.model.x(1)];
    let values: BTreeMap<_, _> = symbols.iter().flatten().copied().zip(x.iter().chain(xd).copied()).collect();
    let by = |order: usize, rates: &[f64]| -> Vec<f64> {
        let slope =
            |(symbol, rate): (_, &f64)| d.model.ring.evaluate(&d.model.ring.derivative(p, symbol), &values) * rate;
        symbols[order].iter().copied().zip(rates).map(slope).collect()
    };
    let terms = [by(0, xd), by(1, xdd)].concat();
    (terms.iter().sum(), largest(&terms))
}

/// σ = f1 β̇ + f2 about the mass centre and the kinetic energy of what moves against it, beside the robot as it is in space.
pub fn momenta(d: &Derived, s: &State) {
    let m = d.mechanism();
    let (positions, n) = (m.positions(), s.q.len());
    let terms = |q: &[f64], qd: &[f64]| d.run("flight_momentum_terms", &[q, qd]);
    let now = terms(&s.q, &s.qd);
    let sigma = now.number("f1") * s.qd[m.unactuated] + now.number("f2");
    assert_close("f1 β̇ + f2", &[sigma], now.get("sigma"), EXACT);
    let mut other = s.qd.clone();
    other[m.unactuated] += 1.0;
    let then = terms(&s.q, &other);
    assert_eq!((then.get("f1"), then.get("f2")), (now.get("f1"), now.get("f2")), "f1 and f2 do not depend on β̇");

    let centre = d.run("centre_of_mass", &[&s.x, &s.xd]);
    let (place, velocity) = (centre.get("position"), centre.get("velocity"));
    let mass = m.total_mass();
    for leg in 1..=2 {
        let arm = along(place, -1.0, d.run(&format!("foot{leg}"), &[&s.x]).get("d"));
        let about_foot = d.run(&format!("angular_momentum{leg}"), &[&s.x, &s.xd]).number("sigma");
        let of_centre = mass * (arm[0] * velocity[1] - arm[1] * velocity[0]);
        let scale = about_foot.abs().max(of_centre.abs()).max(1.0);
        assert_within("σ_G + M r × v", &[now.number("sigma") + of_centre], &[about_foot], EXACT, scale);
    }
    let (_, of_bodies) = momentum(m, &s.x, &s.xd, [place[0], place[1], 0.0]);
    assert_close("σ_G of bodies in numbers", now.get("sigma"), &[of_bodies[2]], 1e-8);

    let reduced = d.run("flight_reduced", &[&s.q, &s.qd]);
    assert!(is_positive_definite(reduced.get("a"), n), "Aq is positive definite");
    if m.rotation == Rotation::Pitch {
        assert!(now.number("f1") > 0.0, "f1 is the inertia about the mass centre");
        assert_close("f1", now.get("f1"), &reduced.get("a")[n * n - 1..], EXACT);
    }
    let kinetic = 0.5 * dot(&product(reduced.get("a"), &s.qd), &s.qd) + 0.5 * mass * dot(velocity, velocity);
    assert_close("½q̇ᵀAq q̇ + ½Mv²", &[kinetic], d.run("energy", &[&s.x, &s.xd]).get("kinetic"), EXACT);
    // Aq is that of the platform's coordinates less what the mass centre takes.
    let whole = d.run("inertia", &[&s.q]).get("a").to_vec();
    let gamma_q: Vec<f64> = d.run("flight_placement", &[&s.q]).get("p_q").iter().map(|x| -x).collect();
    let size = positions + n;
    let expected: Vec<f64> = (0..n * n)
        .map(|k| {
            let (i, j) = (k / n, k % n);
            let of_centre: f64 = (0..positions).map(|c| gamma_q[c * n + i] * gamma_q[c * n + j]).sum();
            whole[(positions + i) * size + positions + j] - mass * of_centre
        })
        .collect();
    assert_within("A_qq − M γ_qᵀ γ_q", reduced.get("a"), &expected, EXACT, largest(&whole));
}

/// Inverse dynamics against the floating model; σ, the parabola and the energy; forward dynamics back.
///
/// `turning` is the same robot with a platform that pitches: what keeps it level is the joints' torques alone.
pub fn dynamics(d: &Derived, turning: Option<&Derived>, s: &State) {
    let m = d.mechanism();
    let positions = m.positions();
    if d.run("flight_momentum_terms", &[&s.q, &s.qd]).number("f1").abs() < 0.01 {
        return; // β does not move the robot's angular momentum here: nothing balances.
    }
    let inverse = d.run("flight_inverse", &[&s.q, &s.qd, &prescribed(m, &s.qdd)]);
    let (xdd, gamma) = (inverse.get("xdd"), inverse.get("gamma"));
    let qdd = &xdd[positions..];
    assert_eq!(prescribed(m, qdd), prescribed(m, &s.qdd));

    // Eq. 5 without a reaction: A Ẍ + H = D_G Γ, the platform's rotation without torque.
    let size = largest(gamma).max(m.total_mass() * largest(xdd));
    let residual = |d: &Derived, tail: &[f64]| {
        let extend = |v: &[f64]| [v, tail].concat();
        let q = extend(&s.q);
        let h = d.run("bias", &[&q, &extend(&s.qd)]).get("h").to_vec();
        let mut rest = along(&product(d.run("inertia", &[&q]).get("a"), &extend(xdd)), 1.0, &h);
        rest[positions..].iter_mut().zip(gamma).for_each(|(row, torque)| *row -= torque);
        assert_within("A Ẍ + H − D_G Γ", &rest, &vec![0.0; rest.len()], EXACT, size);
    };
    residual(d, &[]);
    if let Some(turning) = turning {
        residual(turning, &[0.0]);
    }

    let sigma = &d.kernel("flight_momentum").outputs[0].values[0];
    let (change, scale) = rate(d, sigma, &s.x, &s.xd, xdd);
    assert_within("dσ/dt", &[change], &[0.0], EXACT, scale);
    let fall: Vec<f64> = d.kernel("centre_of_mass").outputs[1].values[..positions]
        .iter()
        .map(|velocity| rate(d, velocity, &s.x, &s.xd, xdd).0)
        .collect();
    assert_within("fall of the mass centre", &fall, &[0.0, -m.gravity], EXACT, largest(xdd));
    let energy = &d.kernel("energy").outputs;
    let rates = [0, 1].map(|k| rate(d, &energy[k].values[0], &s.x, &s.xd, xdd));
    let power = dot(gamma, &s.qd[..m.joints.len()]);
    assert_within("dE/dt", &[rates[0].0 + rates[1].0], &[power], EXACT, rates[0].1.max(rates[1].1).max(size));
    balance_of_hips(d, s);

    let independent: Vec<f64> = m.independent_torques().iter().map(|j| gamma[*j]).collect();
    let forward = d.run("flight_forward", &[&s.q, &s.qd, &independent]);
    assert_close("forward ∘ inverse: Ẍ", forward.get("xdd"), xdd, 1e-8);
}

/// Whatever the joints do, σ of a robot whose platform stays level with both hips at its mass centre changes by what the
/// torques there sum to (less what rotors take): Γ1 + Γ3 = 0 is conservation of σ.
fn balance_of_hips(d: &Derived, s: &State) {
    let m = d.mechanism();
    let at_centre = |leg: &piaffe_codegen::mechanism::VirtualLeg| m.bodies[leg.first_body()].offset[..2] == [0.0, 0.0];
    if m.rotation != Rotation::None || !m.legs.iter().all(at_centre) {
        return;
    }
    let reduced = d.run("flight_reduced", &[&s.q, &s.qd]);
    let torques = along(&product(reduced.get("a"), &s.qdd), 1.0, reduced.get("h"));
    let hips = m.legs.iter().map(|leg| leg.joints.start);
    let sum: f64 = hips.map(|j| torques[j] - m.joints[j].rotor_inertia * s.qdd[j]).sum();
    let xdd = [vec![0.0; m.positions()], s.qdd.clone()].concat();
    let sigma = &d.kernel("flight_momentum").outputs[0].values[0];
    let (change, scale) = rate(d, sigma, &s.x, &s.xd, &xdd);
    assert_within("dσ/dt by torques at the hips", &[change], &[sum], EXACT, scale.max(largest(&torques)));
}

/// The mass centre as a foot leaves, which has stood: its velocity, and σ about it.
pub fn take_off(d: &Derived, s: &State, leg: usize) {
    let m = d.mechanism();
    let positions = m.positions();
    let name = |what: &str| format!("{what}{}", leg + 1);
    let found = d.run(&name("takeoff"), &[&s.q, &s.qd, &s.qdd]);
    let (r, v) = (found.get("r"), found.get("v"));
    let xd = with_foot_at_rest(d, leg, s);
    let centre = d.run("centre_of_mass", &[&s.x, &xd]);
    let foot = d.run(&name("foot"), &[&s.x]).get("d").to_vec();
    assert_close("mass centre", r, &along(centre.get("position"), -1.0, &foot), EXACT);
    assert_within("velocity of the mass centre", v, centre.get("velocity"), EXACT, largest(&xd));
    let about_foot = d.run(&name("momentum_terms"), &[&s.q, &s.qd]).number("sigma");
    let about_centre = d.run("flight_momentum_terms", &[&s.q, &s.qd]).number("sigma");
    let of_centre = m.total_mass() * (r[0] * v[1] - r[1] * v[0]);
    let scale = about_foot.abs().max(of_centre.abs()).max(1.0);
    assert_within("σ_S = σ_G + M r × v", &[about_centre + of_centre], &[about_foot], EXACT, scale);
    // The foot's own height in the flight that follows: it starts at rest, and the mass centre falls.
    let height = |t: f64| {
        let q = along(&along(&s.q, t, &s.qd), 0.5 * t * t, &s.qdd);
        let of_foot = d.run("flight_placement", &[&q]).get("swing")[leg * positions + 1];
        of_foot + r[1] + v[1] * t - 0.5 * m.gravity * t * t
    };
    let rate = |t: f64| difference(|h| vec![height(t + h)]);
    assert_close("height, velocity of the foot", &[height(0.0), rate(0.0)[0]], &[0.0, 0.0], 1e-8);
    assert_close("lift", &difference(rate), found.get("lift"), 1e-6);
    // Places seen from the mass centre and from the foot.
    let [seen, heights] = [Mode::Flight, Mode::Stance(leg)].map(|mode| {
        let p = d.run(&mode.kernel("placement"), &[&s.q]).get("p").to_vec();
        (p, d.run(&mode.kernel("heights"), &[&s.q]).get("heights").to_vec())
    });
    assert_close("platform", &along(&seen.0, 1.0, &r[..positions]), &heights.0, EXACT);
    let raised: Vec<f64> = seen.1.iter().map(|height| height + r[1]).collect();
    assert_close("heights", &raised, &heights.1, EXACT);
}

/// A foot lands out of flight with any velocity of the robot; with that of single support on the other foot it is a touchdown.
pub fn landing(d: &Derived, s: &State, leg: usize) {
    let positions = d.mechanism().positions();
    let name = |what: &str| format!("{what}{}", leg + 1);
    for xd in [s.xd.clone(), with_foot_at_rest(d, other_leg(leg), s)] {
        let found = landed(d, s, leg, &xd);
        let expected = d.run(&name("impact"), &[&s.q, &xd]);
        assert_close("q̇⁺", found.get("qd_plus"), &expected.get("xd_plus")[positions..], 1e-9);
        assert_close("impulse", found.get("impulse"), expected.get("impulse"), 1e-9);
        let jacobian = d.run(&name("foot_jacobian"), &[&s.q]);
        let foot = transposed_product(jacobian.get("d"), &xd);
        assert_close("landing foot", found.get("landing"), &foot[1..2], 1e-11);
    }
    let touchdown = d.run(&name("touchdown"), &[&s.q, &s.qd]);
    let found = landed(d, s, leg, &with_foot_at_rest(d, other_leg(leg), s));
    assert_close("touchdown", found.get("qd_plus"), touchdown.get("qd_plus"), 1e-10);
}

/// The kernel `landing` with the robot's velocities.
fn landed(d: &Derived, s: &State, leg: usize, xd: &[f64]) -> Outputs {
    let centre = d.run("centre_of_mass", &[&s.x, xd]);
    let positions = d.mechanism().positions();
    let (v, qd) = (&centre.get("velocity")[..positions], &xd[positions..]);
    d.run(&format!("landing{}", leg + 1), &[&s.q, v, qd])
}

fn flying(gait: &str) -> Option<Derived> {
    let mechanism = shipped(gait).with_flight().ok()?;
    Some(Derived::new(&mechanism))
}

/// With its numbers as parameters a robot flies as it does with numbers.
#[test]
fn a_family_flies_like_its_robots() {
    let mut draws = Draws::new((0..997).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract()).collect());
    for gait in FAMILIES {
        let (one, family) = (Derived::new(&in_all_modes(gait)), Derived::of_family(gait));
        let of_flight = |name: &str| ["flight", "takeoff", "landing"].iter().any(|prefix| name.starts_with(prefix));
        for kernel in one.kernels.iter().filter(|kernel| of_flight(&kernel.name)) {
            let inputs: Vec<Vec<f64>> =
                kernel.inputs.iter().map(|input| draws.vector(input.symbols.len(), 1.0)).collect();
            let mut arrays: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
            // Both have the same early values, but not in the same order.
            if kernel.name.starts_with("flight_late") || kernel.name == "flight_early" {
                continue;
            }
            let found = one.run(&kernel.name, &arrays);
            let lumps = family.of_robot("lumps").unwrap();
            arrays.insert(0, &lumps);
            let with_parameters = family.run(&kernel.name, &arrays);
            for output in &kernel.outputs {
                let expected = found.get(output.name);
                let what = format!("{gait} {} {}", kernel.name, output.name);
                assert_close(&what, with_parameters.get(output.name), expected, 1e-10);
            }
        }
    }
}

/// Pitch that is gained over one loop of the joints without momentum, −∮ f2/f1. `s` tells how far along the loop it is at the time t in
/// [0, 1], and how fast it moves along.
fn holonomy(d: &Derived, loop_of: &[[f64; 3]], s: impl Fn(f64) -> (f64, f64)) -> f64 {
    let count = 512;
    let rate = |k: usize| {
        let (s, speed) = s(k as f64 / f64::from(count));
        let phases = || loop_of.iter().map(|[_, _, phase]| TAU * s + phase);
        let q = loop_of.iter().zip(phases()).map(|([middle, size, _], phase)| middle + size * phase.sin());
        let qd = loop_of.iter().zip(phases()).map(|([_, size, _], phase)| size * TAU * phase.cos() * speed);
        let (q, qd): (Vec<f64>, Vec<f64>) = (q.chain([0.0]).collect(), qd.chain([0.0]).collect());
        let terms = d.run("flight_momentum_terms", &[&q, &qd]);
        -terms.number("f2") / terms.number("f1")
    };
    // Periodic and smooth: the mean of its values converges faster than any power of their number.
    (0..count as usize).map(rate).sum::<f64>() / f64::from(count)
}

#[test]
fn pitch_gained_over_a_loop_does_not_depend_on_its_timing() {
    let mut draws = Draws::new((0..200).map(|k| (f64::from(k) * 0.754_877_666_246_693).fract()).collect());
    for d in GAITS.into_iter().filter_map(flying).filter(|d| d.mechanism().rotation == Rotation::Pitch) {
        let joints = d.mechanism().joints.len();
        let loop_of: Vec<[f64; 3]> =
            (0..joints).map(|_| [draws.between(-0.5, 0.5), draws.between(0.2, 0.6), draws.between(0.0, TAU)]).collect();
        let steady = holonomy(&d, &loop_of, |t| (t, 1.0));
        let hasty = holonomy(&d, &loop_of, |t| (t + 0.1 * (TAU * t).sin(), 1.0 + 0.1 * TAU * (TAU * t).cos()));
        let backward = holonomy(&d, &loop_of, |t| (-t, -1.0));
        assert!(steady.abs() > 1e-3, "a loop that turns: {steady}");
        assert_close("pitch", &[hasty, -backward], &[steady, steady], EXACT);
    }
}

/// The inertia that a level platform's balance has in β, over the postures of the shipped trot.
#[test]
fn level_flight_is_never_singular() {
    let d = flying("trot").unwrap();
    let ranges: Vec<[f64; 2]> = d.mechanism().joints.iter().map(|joint| joint.range).collect();
    let mut draws = Draws::new((0..4001).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract()).collect());
    let (mut least, mut greatest) = (f64::INFINITY, 0.0f64);
    let still = vec![0.0; ranges.len()];
    for k in 0..2000 {
        // Corners, then what is between them.
        let corner =
            |(j, range): (usize, &[f64; 2])| if k < 16 { range[k >> j & 1] } else { draws.between(range[0], range[1]) };
        let q: Vec<f64> = ranges.iter().enumerate().map(corner).collect();
        let f1 = d.run("flight_momentum_terms", &[&q, &still]).number("f1");
        (least, greatest) = (least.min(f1), greatest.max(f1));
    }
    println!("f1 from {least} to {greatest} kg·m²");
    assert!(0.042 <= least && greatest <= 0.072, "f1 from {least} to {greatest}");
}

#[test]
fn a_platform_that_rolls_does_not_fly() {
    let why = shipped("amble").with_flight().unwrap_err();
    assert!(why.contains("the platform rolls"), "{why}");
    let twice = shipped("trot").with_flight().and_then(Mechanism::with_flight).unwrap();
    assert_eq!(twice.modes, [Mode::Stance(0), Mode::Stance(1), Mode::Flight]);
}

/// A level platform in flight: along the motion that the torques make, integrated in small steps, σ and the energy keep their balance.
#[test]
fn a_flight_under_torques_keeps_its_momentum() {
    let d = flying("trot").unwrap();
    let m = d.mechanism();
    let n = m.orientations();
    let torque = |t: f64| -> Vec<f64> { (0..n - 1).map(|j| 2.0 * (7.0 * t + j as f64).sin()).collect() };
    let sigma = |y: &[f64]| d.run("flight_momentum_terms", &[&y[..n], &y[n..2 * n]]).number("sigma");
    let rates = |t: f64, y: &[f64]| -> Vec<f64> {
        let xdd = d.run("flight_forward", &[&y[..n], &y[n..2 * n], &torque(t)]).get("xdd").to_vec();
        [&y[n..2 * n], &xdd[m.positions()..]].concat()
    };
    let mut y = [vec![0.3, -0.9, -0.1, -0.7], vec![1.0, -2.0, 0.5, 1.5]].concat();
    let before = sigma(&y);
    let (steps, h) = (200, 0.1 / 200.0);
    for k in 0..steps {
        let t = f64::from(k) * h;
        let a = rates(t, &y);
        let b = rates(t + h / 2.0, &along(&y, h / 2.0, &a));
        let c = rates(t + h / 2.0, &along(&y, h / 2.0, &b));
        let e = rates(t + h, &along(&y, h, &c));
        let sum = along(&along(&along(&a, 2.0, &b), 2.0, &c), 1.0, &e);
        y = along(&y, h / 6.0, &sum);
    }
    assert_close("σ", &[sigma(&y)], &[before], 1e-10);
}
