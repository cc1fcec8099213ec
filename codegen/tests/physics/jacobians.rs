//! Every Jacobian kernel against differences of values, and the staged kernels against the direct ones.

use super::common::Derived;
use super::numbers::{along, assert_close, difference, differences, dot, product, transposed_product};
use super::robots::Draws;
use super::state::State;
use super::support::{largest, prescribed};

const TOLERANCE: f64 = 1e-6;

/// Splits a vector over (q, q̇).
fn halves(w: &[f64]) -> (&[f64], &[f64]) {
    w.split_at(w.len() / 2)
}

pub fn of_support(d: &Derived, s: &State, leg: usize) {
    let name = |what: &str| format!("{what}{}", leg + 1);
    let w = [s.q.clone(), s.qd.clone()].concat();
    let by_w = |kernel: &str, values: &[&str]| -> Vec<f64> {
        differences(&w, |w| {
            let (q, qd) = halves(w);
            let r = d.run(&name(kernel), &[q, qd]);
            values.iter().flat_map(|v| r.get(v).to_vec()).collect()
        })
    };
    let momentum = d.run(&name("momentum"), &[&s.q, &s.qd]);
    assert_close("∂σ/∂w", momentum.get("sigma_w"), &by_w("momentum", &["sigma"]), TOLERANCE);
    let terms = d.run(&name("momentum_terms"), &[&s.q, &s.qd]);
    assert_eq!(momentum.get("sigma"), terms.get("sigma"));
    let swing = d.run(&name("swing_velocity"), &[&s.q, &s.qd]);
    assert_close("∂v/∂w", swing.get("v_w"), &by_w("swing_velocity", &["v"]), TOLERANCE);
    let touchdown = d.run(&name("touchdown"), &[&s.q, &s.qd]);
    let expected = by_w("touchdown", &["qd_plus", "impulse", "leaving", "landing"]);
    assert_close("touchdown", touchdown.get("jacobian"), &expected, TOLERANCE * largest(&expected));

    let place = |q: &[f64]| d.run(&name("placement"), &[q]);
    let placement = place(&s.q);
    assert_close("∂p/∂q", placement.get("p_q"), &differences(&s.q, |q| place(q).get("p").to_vec()), TOLERANCE);
    let expected = differences(&s.q, |q| place(q).get("swing").to_vec());
    assert_close("∂swing/∂q", placement.get("swing_q"), &expected, TOLERANCE);
    // With the stance foot at the origin the swing foot is where `foot` says.
    let x = [placement.get("p"), &s.q].concat();
    let foot = |leg: usize| d.run(&format!("foot{}", leg + 1), &[&x]).get("d").to_vec();
    assert_close("stance foot", &foot(leg), &vec![0.0; d.mechanism().positions()], 1e-12);
    assert_close("swing foot", &foot(1 - leg), placement.get("swing"), 1e-12);
}

/// ∂(Γ, F)/∂(q, q̇, Q̈) with β̈ eliminated by the balance row, against differences of `inverse`.
pub fn of_inverse_dynamics(d: &Derived, s: &State, leg: usize) {
    let m = d.mechanism();
    let name = |what: &str| format!("{what}{}", leg + 1);
    if d.run(&name("momentum_terms"), &[&s.q, &s.qd]).number("f1").abs() < 0.1 {
        return;
    }
    let n = s.q.len();
    let actuated = prescribed(m, &s.qdd);
    let inverse = |w: &[f64]| d.run(&name("inverse"), &[&w[..n], &w[n..2 * n], &w[2 * n..]]);
    let w = [s.q.clone(), s.qd.clone(), actuated.clone()].concat();
    let direct = inverse(&w);
    let r = d.run(&name("inverse_jacobian"), &[&s.q, &s.qd, &actuated]);
    let size = largest(direct.get("gamma")).max(largest(direct.get("f")));
    assert_close("Γ", r.get("gamma"), direct.get("gamma"), 1e-11 * size);
    assert_close("F", r.get("f"), direct.get("f"), 1e-11 * size);
    let beta = m.positions() + m.unactuated;
    assert_close("β̈", r.get("beta_dd"), &direct.get("xdd")[beta..=beta], 1e-11 * size);

    let rows: Vec<&[f64]> = r.get("jacobian").chunks(3 * n).collect();
    let (balance, outputs) = rows.split_last().unwrap();
    let column = 2 * n + m.unactuated;
    let free = (0..3 * n).filter(|k| *k != column);
    let total: Vec<f64> = outputs
        .iter()
        .flat_map(|row| free.clone().map(|k| row[k] - row[column] * balance[k] / balance[column]))
        .collect();
    let expected = differences(&w, |w| {
        let r = inverse(w);
        [r.get("gamma"), r.get("f")].concat()
    });
    assert_close("d(Γ, F)/d(q, q̇, Q̈)", &total, &expected, TOLERANCE * size);
}

/// Early, then late, is eq. 8 and 9 with all gradients.
pub fn of_stages(d: &Derived, s: &State, leg: usize) {
    let m = d.mechanism();
    let name = |what: &str| format!("{what}{}", leg + 1);
    let terms = |q: &[f64], qd: &[f64]| -> Vec<f64> {
        let r = d.run(&name("momentum_terms"), &[q, qd]);
        ["f1", "f2", "sigmadot"].map(|v| r.number(v)).to_vec()
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
    }
}

/// The weighted second derivatives of an instant and of a touchdown.
pub fn of_curvature(d: &Derived, s: &State, draws: &mut Draws, leg: usize) {
    let (n, positions) = (s.q.len(), d.mechanism().positions());
    let name = |what: &str| format!("{what}{}", leg + 1);
    let weights = |kernel: &str, input: usize, draws: &mut Draws| {
        draws.vector(d.kernel(&name(kernel)).inputs[input].symbols.len(), 1.0)
    };
    let [nu, phi, others] = [3, 4, 5].map(|input| weights("curvature", input, draws));
    let w = [s.q.clone(), s.qd.clone(), s.qdd.clone()].concat();
    let run = |w: &[f64]| d.run(&name("curvature"), &[&w[..n], &w[n..2 * n], &w[2 * n..], &nu, &phi, &others]);
    let now = run(&w);
    let gradient = differences(&w, |w| run(w).get("gradient").to_vec());
    let block = |row: usize, column: usize| -> Vec<f64> {
        (0..n).flat_map(|i| gradient[(row * n + i) * 3 * n + column * n..][..n].to_vec()).collect()
    };
    let size = largest(&gradient);
    for (output, row, column) in [("q_q", 0, 0), ("q_qd", 0, 1), ("q_qdd", 0, 2), ("qd_qd", 1, 1)] {
        assert_close(output, now.get(output), &block(row, column), TOLERANCE * size);
    }
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
        forces.push(difference(sigma)[0] - d.run(&name("momentum_terms"), &[q, qd]).number("sigmadot"));
        let terms = d.run(&name("momentum_terms"), &[q, qd]);
        let placement = d.run(&name("placement"), &[q]);
        let velocity = d.run(&name("swing_velocity"), &[q, qd]);
        let others_now = [
            terms.number("sigma"),
            terms.number("sigmadot"),
            placement.get("swing")[1],
            placement.get("p")[0],
            velocity.get("v")[1],
            placement.get("p")[1],
        ];
        vec![dot(&forces, &nu) + dot(&others_now, &others)]
    };
    let still = vec![0.0; positions];
    let without_reaction = d.run(&name("curvature"), &[&s.q, &s.qd, &s.qdd, &nu, &still, &others]);
    assert_close("gradient", without_reaction.get("gradient"), &differences(&w, value), TOLERANCE);

    let [xi, outputs] = [2, 3].map(|input| weights("touchdown_curvature", input, draws));
    let all = [&xi[..], &outputs].concat();
    let w = &w[..2 * n];
    let jacobian = |w: &[f64]| {
        let touchdown = d.run(&name("touchdown"), &[&w[..n], &w[n..]]);
        let couple = if outputs.len() > positions + 2 { touchdown.get("couple_jacobian") } else { &[] };
        [touchdown.get("jacobian"), couple].concat()
    };
    let expected = differences(w, |w| transposed_product(&jacobian(w), &all));
    let curvature = d.run(&name("touchdown_curvature"), &[&s.q, &s.qd, &xi, &outputs]);
    let plus = jacobian(w);
    let mut found = vec![0.0; 4 * n * n];
    for i in 0..n {
        for j in 0..2 * n {
            // [q_q, q_qd; ·, 0] + [q_plus; 0] J + its transpose.
            let through: f64 = (0..n).map(|k| curvature.get("q_plus")[i * n + k] * plus[k * 2 * n + j]).sum();
            found[i * 2 * n + j] += through;
            found[j * 2 * n + i] += through;
            if j < n {
                found[i * 2 * n + j] += curvature.get("q_q")[i * n + j];
            } else {
                let mixed = curvature.get("q_qd")[i * n + j - n];
                found[i * 2 * n + j] += mixed;
                found[j * 2 * n + i] += mixed;
            }
        }
    }
    assert_close("touchdown's Hessian", &found, &expected, TOLERANCE * largest(&expected));
}

/// Heights and the second derivatives of their weighted sum.
pub fn of_heights(d: &Derived, s: &State, draws: &mut Draws, leg: usize) {
    let name = |what: &str| format!("{what}{}", leg + 1);
    let values = |q: &[f64]| d.run(&name("heights"), &[q]).get("heights").to_vec();
    let now = d.run(&name("heights"), &[&s.q]);
    assert_close("∂heights/∂q", now.get("jacobian"), &differences(&s.q, values), TOLERANCE);
    let weights = draws.vector(now.get("heights").len(), 1.0);
    let run = |q: &[f64]| d.run(&name("heights_curvature"), &[q, &weights]);
    let gradient = |q: &[f64]| run(q).get("gradient").to_vec();
    let sum = differences(&s.q, |q| vec![dot(&values(q), &weights)]);
    assert_close("gradient of the heights", &gradient(&s.q), &sum, TOLERANCE);
    assert_close("second derivatives of the heights", run(&s.q).get("q_q"), &differences(&s.q, gradient), TOLERANCE);
}
