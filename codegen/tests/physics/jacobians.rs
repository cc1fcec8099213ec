//! Every Jacobian kernel against differences of values, and the staged kernels against the direct ones.

use super::common::{Derived, Outputs};
use super::numbers::{along, assert_close, assert_within, difference, differences, dot, product, transposed_product};
use super::robots::Draws;
use super::state::State;
use super::support::{largest, prescribed};
use piaffe_codegen::mechanism::{Mode, Transition};

const TOLERANCE: f64 = 1e-6;

/// Splits a vector over (q, q̇).
fn halves(w: &[f64]) -> (&[f64], &[f64]) {
    w.split_at(w.len() / 2)
}

/// σ, places and velocities of a mode.
pub fn of_mode(d: &Derived, s: &State, mode: Mode) {
    let name = |what: &str| mode.kernel(what);
    let w = [s.q.clone(), s.qd.clone()].concat();
    let by_w = |kernel: &str, value: &str| -> Vec<f64> {
        differences(&w, |w| {
            let (q, qd) = halves(w);
            d.run(&name(kernel), &[q, qd]).get(value).to_vec()
        })
    };
    let momentum = d.run(&name("momentum"), &[&s.q, &s.qd]);
    assert_close("∂σ/∂w", momentum.get("sigma_w"), &by_w("momentum", "sigma"), TOLERANCE);
    let terms = d.run(&name("momentum_terms"), &[&s.q, &s.qd]);
    assert_eq!(momentum.get("sigma"), terms.get("sigma"));
    let swing = d.run(&name("swing_velocity"), &[&s.q, &s.qd]);
    assert_close("∂v/∂w", swing.get("v_w"), &by_w("swing_velocity", "v"), TOLERANCE);

    let place = |q: &[f64]| d.run(&name("placement"), &[q]);
    let placement = place(&s.q);
    assert_close("∂p/∂q", placement.get("p_q"), &differences(&s.q, |q| place(q).get("p").to_vec()), TOLERANCE);
    let expected = differences(&s.q, |q| place(q).get("swing").to_vec());
    assert_close("∂swing/∂q", placement.get("swing_q"), &expected, TOLERANCE);
    // With the origin of the mode at the world's, the feet in the air are where `foot` says, and move so.
    let x = [placement.get("p"), &s.q].concat();
    let foot = |leg: usize| d.run(&format!("foot{}", leg + 1), &[&x]).get("d").to_vec();
    let feet: Vec<f64> = mode.swinging().flat_map(foot).collect();
    assert_close("swing feet", placement.get("swing"), &feet, 1e-12);
    let along_motion = product(placement.get("swing_q"), &s.qd);
    assert_close("their velocities", swing.get("v"), &along_motion, 1e-12);
    match mode {
        Mode::Stance(leg) => assert_close("stance foot", &foot(leg), &vec![0.0; d.mechanism().positions()], 1e-12),
        Mode::Flight => {
            let still = vec![0.0; x.len()];
            let centre = d.run("centre_of_mass", &[&x, &still]).get("position").to_vec();
            assert_close("mass centre", &centre, &vec![0.0; d.mechanism().positions()], 1e-12);
        }
    }
}

/// What an impact does, by q and the velocities before.
pub fn of_impact(d: &Derived, s: &State, transition: Transition) {
    let name = transition.kernel("");
    let w = before(d, s, transition);
    let rows: &[&'static str] = match transition.leaves() {
        Some(_) => &["qd_plus", "impulse", "leaving", "landing"],
        None => &["qd_plus", "impulse", "landing"],
    };
    let values = |w: &[f64]| -> Vec<f64> {
        let r = impact(d, &name, w, &[]);
        rows.iter().flat_map(|v| r.get(v).to_vec()).collect()
    };
    let expected = differences(&w, values);
    let now = impact(d, &name, &w, &[]);
    assert_close(&name, &gradients(d, &name, &now), &expected, TOLERANCE);
}

/// The gradients of an impact's results but of what real feet share, row after row.
fn gradients(d: &Derived, kernel: &str, results: &Outputs) -> Vec<f64> {
    let shared = ["couple_w", "pitch_w"];
    let rows = d.kernel(kernel).outputs.iter().map(|o| o.name).filter(|o| o.ends_with("_w") && !shared.contains(o));
    rows.flat_map(|row| results.get(row).to_vec()).collect()
}

/// Jacobians and weighted second derivatives of a take-off.
pub fn of_take_off(d: &Derived, s: &State, draws: &mut Draws, transition: Transition) {
    let (n, w) = (s.q.len(), [&s.q[..], &s.qd, &s.qdd].concat());
    let run = |w: &[f64]| d.run(&transition.kernel(""), &[&w[..n], &w[n..2 * n], &w[2 * n..]]);
    let now = run(&w);
    // Each with the gradient in (q, q̇, q̈), of which only the parts that are not zero are given.
    let all = |r: &Outputs| -> Vec<f64> {
        let [r_q, v_w, lift_w] = ["r_q", "v_w", "lift_w"].map(|output| r.get(output));
        let padded = |rows: &[f64], width: usize| -> Vec<f64> {
            rows.chunks(width).flat_map(|row| [row, &vec![0.0; 3 * n - width]].concat()).collect()
        };
        [padded(r_q, n), padded(v_w, 2 * n), lift_w.to_vec()].concat()
    };
    let values = |w: &[f64]| {
        let r = run(w);
        [r.get("r"), r.get("v"), r.get("lift")].concat()
    };
    let expected = differences(&w, values);
    assert_close("∂(r, v, lift)", &all(&now), &expected, TOLERANCE);
    let kernel = transition.kernel("_curvature");
    let weights = weights(d, &kernel, "weights", draws);
    let curvature = d.run(&kernel, &[&s.q, &s.qd, &s.qdd, &weights]);
    let gradient = |w: &[f64]| transposed_product(&all(&run(w)), &weights);
    assert_within("gradient", curvature.get("gradient"), &gradient(&w), 1e-12, largest(&expected));
    second_derivatives_are(&curvature, &differences(&w, gradient), n);
}

/// The blocks of second derivatives against a matrix of them in (q, q̇, q̈).
fn second_derivatives_are(found: &Outputs, expected: &[f64], n: usize) {
    let block = |row: usize, column: usize| -> Vec<f64> {
        (0..n).flat_map(|i| expected[(row * n + i) * 3 * n + column * n..][..n].to_vec()).collect()
    };
    for (output, row, column) in [("q_q", 0, 0), ("q_qd", 0, 1), ("q_qdd", 0, 2), ("qd_qd", 1, 1)] {
        assert_close(output, found.get(output), &block(row, column), TOLERANCE);
    }
}

/// q and the velocities that are given to an impact, after a flight that of the mass centre first.
fn before(d: &Derived, s: &State, transition: Transition) -> Vec<f64> {
    let components = if transition.leaves().is_some() { 0 } else { d.mechanism().positions() };
    let centre = d.run("centre_of_mass", &[&s.x, &s.xd]);
    [&s.q[..], &centre.get("velocity")[..components], &s.qd].concat()
}

/// A kernel of an impact from what [`before`] gives, and what else it takes.
fn impact(d: &Derived, kernel: &str, before: &[f64], others: &[&[f64]]) -> Outputs {
    let mut rest = before;
    let mut inputs = Vec::new();
    for input in &d.kernel(kernel).inputs[..d.kernel(kernel).inputs.len() - others.len()] {
        let (own, others) = rest.split_at(input.symbols.len());
        inputs.push(own);
        rest = others;
    }
    inputs.extend(others);
    d.run(kernel, &inputs)
}

/// ∂(Γ, F)/∂(q, q̇, Q̈) with β̈ eliminated by the balance row, against differences of `inverse`.
pub fn of_inverse_dynamics(d: &Derived, s: &State, mode: Mode) {
    let m = d.mechanism();
    let name = |what: &str| mode.kernel(what);
    // In flight there is no reaction.
    let outputs: &[&'static str] = if mode == Mode::Flight { &["gamma"] } else { &["gamma", "f"] };
    let of = |r: &Outputs| outputs.iter().flat_map(|output| r.get(output).to_vec()).collect::<Vec<f64>>();
    if d.run(&name("momentum_terms"), &[&s.q, &s.qd]).number("f1").abs() < 0.1 {
        return;
    }
    let n = s.q.len();
    let actuated = prescribed(m, &s.qdd);
    let inverse = |w: &[f64]| d.run(&name("inverse"), &[&w[..n], &w[n..2 * n], &w[2 * n..]]);
    let w = [s.q.clone(), s.qd.clone(), actuated.clone()].concat();
    let direct = inverse(&w);
    let r = d.run(&name("inverse_jacobian"), &[&s.q, &s.qd, &actuated]);
    assert_close("Γ, F", &of(&r), &of(&direct), 1e-11);
    let beta = m.positions() + m.unactuated;
    assert_close("β̈", r.get("beta_dd"), &direct.get("xdd")[beta..=beta], 1e-11);

    let forces: &[&str] = if mode == Mode::Flight { &["gamma_w"] } else { &["gamma_w", "f_w"] };
    let (balance, rows) = (r.get("balance_w"), forces.iter().flat_map(|rows| r.get(rows).chunks(3 * n)));
    let column = 2 * n + m.unactuated;
    let free = (0..3 * n).filter(|k| *k != column);
    let total: Vec<f64> =
        rows.flat_map(|row| free.clone().map(|k| row[k] - row[column] * balance[k] / balance[column])).collect();
    let expected = differences(&w, |w| of(&inverse(w)));
    assert_close("d(Γ, F)/d(q, q̇, Q̈)", &total, &expected, TOLERANCE);
}

/// Early, then late, is eq. 8 and 9 with all gradients.
pub fn of_stages(d: &Derived, s: &State, mode: Mode) {
    let m = d.mechanism();
    let name = |what: &str| mode.kernel(what);
    let terms = |q: &[f64], qd: &[f64]| -> Vec<f64> {
        let r = d.run(&name("momentum_terms"), &[q, qd]);
        // In flight nothing turns the robot.
        let sigmadot = if mode == Mode::Flight { 0.0 } else { r.number("sigmadot") };
        vec![r.number("f1"), r.number("f2"), sigmadot]
    };
    let early = d.run(&name("early"), &[&prescribed(m, &s.q), &prescribed(m, &s.qd)]).get("early").to_vec();
    let beta = [s.q[m.unactuated]];
    let late = d.run(&name("late"), &[&early, &beta]);
    assert_close("f1, f2, σ̇", late.get("value"), &terms(&s.q, &s.qd), 1e-11);
    let n = s.q.len();
    let slopes = differences(&[s.q.clone(), s.qd.clone()].concat(), |w| terms(&w[..n], &w[n..]));
    let row = |value: usize, shift: usize| -> Vec<f64> {
        m.prescribed().iter().map(|k| slopes[value * 2 * n + shift + k]).collect()
    };
    let by_beta: Vec<f64> = (0..3).map(|v| slopes[v * 2 * n + m.unactuated]).collect();
    assert_close("∂/∂β", late.get("by_beta"), &by_beta, TOLERANCE);
    let gradient = d.run(&name("late_gradient"), &[&early, &beta]);
    for (output, expected) in [("f1_q", row(0, 0)), ("f2_q", row(1, 0)), ("f2_qd", row(1, n)), ("moment_q", row(2, 0))]
    {
        assert_close(output, gradient.get(output), &expected, TOLERANCE);
    }
    if m.unactuated == m.joints.len() {
        // The whole robot turns with β: f1 and f2 do not contain it.
        let by_beta = &d.kernel(&name("late")).outputs[1].values;
        assert!(by_beta[0].is_zero() && by_beta[1].is_zero(), "f1 and f2 contain β");
        if mode == Mode::Flight {
            // So β is an integral of what is known before it, without an operation left for later.
            assert!(d.kernel("flight_late").outputs[0].values.iter().all(|p| p.is_zero() || p.as_term().is_some()));
        }
    }
}

/// Weights for an input of a kernel.
fn weights(d: &Derived, kernel: &str, input: &str, draws: &mut Draws) -> Vec<f64> {
    let found = d.kernel(kernel).inputs.iter().find(|i| i.name == input);
    draws.vector(found.map_or(0, |input| input.symbols.len()), 1.0)
}

/// The weighted second derivatives of an instant.
pub fn of_curvature(d: &Derived, s: &State, draws: &mut Draws, mode: Mode) {
    let (n, positions) = (s.q.len(), d.mechanism().positions());
    let name = |what: &str| mode.kernel(what);
    let kernel = name("curvature");
    let [nu, phi, others] = ["n", "phi", "others"].map(|input| weights(d, &kernel, input, draws));
    let w = [s.q.clone(), s.qd.clone(), s.qdd.clone()].concat();
    let of_forces = |w: &[f64], phi: &[f64]| {
        let (q, qd, qdd) = (&w[..n], &w[n..2 * n], &w[2 * n..]);
        d.run(&kernel, &[q, qd, qdd, &nu, phi, &others])
    };
    let run = |w: &[f64]| of_forces(w, &phi);
    let now = run(&w);
    second_derivatives_are(&now, &differences(&w, |w| run(w).get("gradient").to_vec()), n);
    // The sum itself, but for the reaction's part, from the reduced model and the kernels of each term.
    let value = |w: &[f64]| -> Vec<f64> {
        let (q, qd, qdd) = (&w[..n], &w[n..2 * n], &w[2 * n..]);
        let reduced = d.run(&name("reduced"), &[q, qd]);
        let joints = d.mechanism().joints.len();
        let mut forces = along(&product(reduced.get("a"), qdd), 1.0, reduced.get("h"));
        forces.truncate(joints);
        // The balance is dσ/dt less the moment of gravity.
        let sigma = |t: f64| {
            let q = along(&along(q, t, qd), 0.5 * t * t, qdd);
            d.run(&name("momentum"), &[&q, &along(qd, t, qdd)]).get("sigma").to_vec()
        };
        let terms = d.run(&name("momentum_terms"), &[q, qd]);
        let stands = mode != Mode::Flight;
        let sigmadot = stands.then(|| terms.number("sigmadot"));
        forces.push(difference(sigma)[0] - sigmadot.unwrap_or(0.0));
        let placement = d.run(&name("placement"), &[q]);
        let velocity = d.run(&name("swing_velocity"), &[q, qd]);
        let vertical = |of_feet: &[f64]| of_feet.chunks(positions).map(|foot| foot[1]).collect::<Vec<f64>>();
        let mut others_now = vec![terms.number("sigma")];
        others_now.extend(sigmadot);
        others_now.extend(vertical(placement.get("swing")));
        others_now.push(placement.get("p")[0]);
        others_now.extend(vertical(velocity.get("v")));
        others_now.push(placement.get("p")[1]);
        vec![dot(&forces, &nu) + dot(&others_now, &others)]
    };
    let without_reaction = of_forces(&w, &vec![0.0; phi.len()]);
    assert_close("gradient", without_reaction.get("gradient"), &differences(&w, value), TOLERANCE);
}

/// The weighted second derivatives of an impact.
pub fn of_impacts_curvature(d: &Derived, s: &State, draws: &mut Draws, transition: Transition) {
    let (kernel, values) = (transition.kernel("_curvature"), transition.kernel(""));
    let (n, w) = (s.q.len(), before(d, s, transition));
    let columns = w.len();
    let mut found = vec![0.0; columns * columns];
    let [xi, outputs] = ["xi", "outputs"].map(|input| weights(d, &kernel, input, draws));
    let all = [&xi[..], &outputs].concat();
    let jacobian = |w: &[f64]| {
        let r = impact(d, &values, w, &[]);
        let own = gradients(d, &values, &r);
        let shared = own.len() < all.len() * columns;
        if shared { [&own[..], r.get("couple_w"), r.get("pitch_w")].concat() } else { own }
    };
    let expected = differences(&w, |w| transposed_product(&jacobian(w), &all));
    let curvature = impact(d, &kernel, &w, &[&xi, &outputs]);
    let mixed = curvature.get(if columns == 2 * n { "q_qd" } else { "q_v" });
    let plus = jacobian(&w);
    for i in 0..n {
        for j in 0..columns {
            // [q_q, q_qd; ·, 0] + [q_plus; 0] J + its transpose.
            let through: f64 = (0..n).map(|k| curvature.get("q_plus")[i * n + k] * plus[k * columns + j]).sum();
            found[i * columns + j] += through;
            found[j * columns + i] += through;
            if j < n {
                found[i * columns + j] += curvature.get("q_q")[i * n + j];
            } else {
                let mixed = mixed[i * (columns - n) + j - n];
                found[i * columns + j] += mixed;
                found[j * columns + i] += mixed;
            }
        }
    }
    assert_close("an impact's Hessian", &found, &expected, TOLERANCE);
}

/// Heights and the second derivatives of their weighted sum.
pub fn of_heights(d: &Derived, s: &State, draws: &mut Draws, mode: Mode) {
    let name = |what: &str| mode.kernel(what);
    let values = |q: &[f64]| d.run(&name("heights"), &[q]).get("heights").to_vec();
    let now = d.run(&name("heights"), &[&s.q]);
    assert_close("∂heights/∂q", now.get("heights_q"), &differences(&s.q, values), TOLERANCE);
    let weights = draws.vector(now.get("heights").len(), 1.0);
    let run = |q: &[f64]| d.run(&name("heights_curvature"), &[q, &weights]);
    let gradient = |q: &[f64]| run(q).get("gradient").to_vec();
    let sum = differences(&s.q, |q| vec![dot(&values(q), &weights)]);
    assert_close("gradient of the heights", &gradient(&s.q), &sum, TOLERANCE);
    assert_close("second derivatives of the heights", run(&s.q).get("q_q"), &differences(&s.q, gradient), TOLERANCE);
}
