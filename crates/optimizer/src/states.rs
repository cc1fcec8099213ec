//! The dynamics of a gait at given states, as JSON: for checking against other implementations.
//!
//! Every quantity comes from the generated kernels, Γ what moves the robot (motors overcome friction besides); the only numerics here are the condition
//! numbers of the linear systems behind them in the robot's units, which tell a singular case from a result.

use nalgebra::DMatrix;
use piaffe_model::shape::MomentumTerms;
use piaffe_model::units::Units;
use piaffe_model::{Description, Gait, Mode, Rotation};
use serde::Deserialize;
use serde_json::{Map, Value, json};

/// Beyond this condition number a linear system has no meaningful solution in double precision.
const SINGULAR: f64 = 1e12;

/// States to evaluate; unknown keys are ignored.
#[derive(Debug, Deserialize)]
pub struct States {
    pub states: Vec<State>,
}

/// One state: X = [p, q], Ẋ and, where inverse or forward dynamics are wanted, Ẍ and Γ.
#[derive(Debug, Deserialize)]
pub struct State {
    #[serde(rename = "X")]
    pub x: Vec<f64>,
    #[serde(rename = "Xdot")]
    pub xd: Vec<f64>,
    #[serde(rename = "Xddot")]
    pub xdd: Option<Vec<f64>>,
    #[serde(rename = "Gamma")]
    pub gamma: Option<Vec<f64>>,
}

/// A state that cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    #[error("state {index}: `{key}` has {found} numbers, the {gait} needs {expected} ({meaning})")]
    Count { index: usize, key: &'static str, found: usize, expected: usize, gait: &'static str, meaning: String },
    #[error("state {index}: `{key}` is beyond all numbers; take smaller ones")]
    Overflow { index: usize, key: String },
}

/// Evaluates all states.
///
/// # Errors
/// If a state has the wrong number of coordinates for the gait, or its numbers lead to infinite ones.
pub fn evaluate(gait: &dyn Gait, states: &States) -> Result<Value, Unfit> {
    let results =
        states.states.iter().enumerate().map(|(i, s)| evaluate_state(gait, i, s)).collect::<Result<Vec<_>, _>>()?;
    Ok(json!({ "gait": gait.description().gait, "states": results }))
}

/// Names of X = [p, q].
fn names(d: &Description) -> Vec<String> {
    let mut names: Vec<String> = ["x", "y", "z"][..d.positions()].iter().map(|s| s.to_string()).collect();
    names.extend((1..=d.joints()).map(|j| format!("q{j}")));
    if d.rotation != Rotation::None {
        names.push("theta".into());
    }
    names
}

fn evaluate_state(gait: &dyn Gait, index: usize, state: &State) -> Result<Value, Unfit> {
    let d = gait.description();
    let (np, nq) = (d.positions(), d.orientations());
    let n = np + nq;
    let torques: Vec<String> = d.independent_torques().map(|j| format!("Γ{}", j + 1)).collect();
    let check = |key, values: &[f64], expected: usize, meaning: String| {
        let found = values.len();
        if found == expected {
            Ok(())
        } else {
            Err(Unfit::Count { index, key, found, expected, gait: d.gait, meaning })
        }
    };
    check("X", &state.x, n, names(d).join(", "))?;
    check("Xdot", &state.xd, n, names(d).join(", "))?;
    if let Some(xdd) = &state.xdd {
        check("Xddot", xdd, n, names(d).join(", "))?;
    }
    if let Some(gamma) = &state.gamma {
        check("Gamma", gamma, torques.len(), torques.join(", "))?;
    }

    let (q, qd) = (&state.x[np..], &state.xd[np..]);
    let mut out = Map::new();
    let mut put = |key: &str, value: Value| out.insert(key.into(), value);
    put("X", json!(state.x));
    put("Xdot", json!(state.xd));
    let a = vector(n * n, |o| gait.inertia(q, o));
    let h = vector(n, |o| gait.bias(q, qd, o));
    put("A", rows(&a, n));
    put("H", json!(h));
    if let Some(xdd) = &state.xdd {
        put("Xddot", json!(xdd));
        let force: Vec<f64> = (0..n).map(|i| h[i] + (0..n).map(|k| a[i * n + k] * xdd[k]).sum::<f64>()).collect();
        put("A_Xddot_plus_H", json!(force));
    }
    if let Some(gamma) = &state.gamma {
        put("Gamma", json!(gamma));
    }
    let s = d.shapes;
    let energy = vector(s.energy.len, |o| gait.energy(&state.x, &state.xd, o));
    let [kinetic, potential] = [s.energy.kinetic, s.energy.potential].map(|block| block.value(&energy));
    put("kinetic_energy", json!(kinetic));
    put("potential_energy", json!(potential));
    put("total_energy", json!(kinetic + potential));
    let com = vector(s.centre_of_mass.len, |o| gait.centre_of_mass(&state.x, &state.xd, o));
    put("com", json!(s.centre_of_mass.position.of(&com)));
    put("com_velocity", json!(s.centre_of_mass.velocity.of(&com)));
    let feet = [0, 1].map(|leg| vector(n * np, |o| gait.foot_jacobian(leg, q, o)));
    let (scaled, scaled_feet) = in_own_units(gait.description(), &a, &feet);
    for leg in 0..2 {
        let i = leg + 1;
        put(&format!("d{i}"), json!(vector(np, |o| gait.foot(leg, &state.x, o))));
        put(&format!("D{i}"), rows(&feet[leg], np));
        put(&format!("H{i}"), json!(vector(np, |o| gait.foot_bias(leg, q, qd, o))));
        put(&format!("sigma_about_d{i}"), json!(vector(1, |o| gait.angular_momentum(leg, &state.x, &state.xd, o))[0]));
        put(&format!("ss{i}"), single_support(gait, leg, state, &scaled, &scaled_feet[leg]));
        let condition = condition(&contact_system(&scaled, &[&scaled_feet[leg]], n, np));
        put(
            &format!("impact12_leg{i}"),
            unless_singular(condition, "the inertia seen by the foot vanishes", || {
                let r = vector(s.impact.len, |o| gait.impact(leg, q, &state.xd, o));
                json!({ "Xdot_plus": s.impact.xd_plus.of(&r), "impulse": s.impact.impulse.of(&r), "cond": condition })
            }),
        );
    }
    let condition = condition(&contact_system(&scaled, &[&scaled_feet[0], &scaled_feet[1]], n, np));
    put(
        "impact11",
        unless_singular(
            condition,
            "the two feet cannot be brought to rest independently (a level touchdown, or a stretched pose)",
            || {
                let (shape, r) = (&s.impact_both, vector(s.impact_both.len, |o| gait.impact_both(q, &state.xd, o)));
                json!({
                    "Xdot_plus": shape.xd_plus.of(&r), "impulse1": shape.impulse1.of(&r), "impulse2": shape.impulse2.of(&r),
                    "cond": condition,
                })
            },
        ),
    );
    match out.iter().find(|(_, value)| has_gap(value)) {
        Some((key, _)) => Err(Unfit::Overflow { index, key: key.clone() }),
        None => Ok(Value::Object(out)),
    }
}

/// Whether a number is missing: that is what becomes of an infinite one.
fn has_gap(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.iter().any(has_gap),
        Value::Object(map) => map.values().any(has_gap),
        _ => false,
    }
}

fn single_support(gait: &dyn Gait, leg: usize, state: &State, a: &[f64], foot: &[f64]) -> Value {
    let d = gait.description();
    let (np, nq) = (d.positions(), d.orientations());
    let n = np + nq;
    let (q, qd) = (&state.x[np..], &state.xd[np..]);
    let mut xd = vector(np, |o| gait.platform_velocity(Mode::Stance(leg), q, qd, o));
    xd.extend_from_slice(qd);
    let s = d.shapes;
    let terms = vector(s.stance.momentum_terms.len, |o| gait.momentum_terms(Mode::Stance(leg), q, qd, o));
    let mut result = Map::new();
    result.insert("Xdot".into(), json!(xd));
    let MomentumTerms { f1, f2, sigma, c, sigmadot, .. } = s.stance.momentum_terms;
    for (key, block) in [("f1", f1), ("f2", f2), ("sigma", sigma), ("c", c), ("sigmadot", sigmadot)] {
        result.insert(key.into(), json!(block.value(&terms)));
    }
    result.insert("H".into(), json!(vector(n, |o| gait.bias(q, qd, o))));
    result.insert("Hi".into(), json!(vector(np, |o| gait.foot_bias(leg, q, qd, o))));
    if let Some(gamma) = &state.gamma {
        let r = vector(s.stance.forward.len, |o| gait.forward(Mode::Stance(leg), q, qd, gamma, o));
        result
            .insert("forward".into(), json!({ "Xddot": s.stance.forward.xdd.of(&r), "F": s.stance.forward.f.of(&r) }));
    }
    if let Some(xdd) = &state.xdd {
        let condition = condition(&inverse_system(gait, leg, q, a, foot));
        let inverse = unless_singular(
            condition,
            "f1 vanishes: no torque-free coordinate follows from the momentum (eq. 10)",
            || {
                let prescribed: Vec<f64> = (0..d.prescribed()).map(|k| xdd[np + d.prescribed_index(k)]).collect();
                let r = vector(s.stance.inverse.len, |o| gait.inverse(Mode::Stance(leg), q, qd, &prescribed, o));
                let [xdd, gamma, f] =
                    [s.stance.inverse.xdd, s.stance.inverse.gamma, s.stance.inverse.f].map(|block| block.of(&r));
                let torques: Vec<f64> = d.independent_torques().map(|j| gamma[j]).collect();
                json!({ "Xddot": xdd, "betaddot": xdd[np + d.unactuated], "Gamma": torques, "F": f, "cond": condition })
            },
        );
        result.insert("inverse".into(), inverse);
    }
    Value::Object(result)
}

fn unless_singular(condition: f64, why: &str, result: impl FnOnce() -> Value) -> Value {
    if condition < SINGULAR { result() } else { json!({ "singular": why }) }
}

fn vector(length: usize, fill: impl FnOnce(&mut [f64])) -> Vec<f64> {
    let mut out = vec![0.0; length];
    fill(&mut out);
    out
}

fn rows(values: &[f64], columns: usize) -> Value {
    json!(values.chunks(columns).collect::<Vec<_>>())
}

/// A and both D in the robot's units: else a condition number tells of metres and radians.
fn in_own_units(d: &Description, a: &[f64], feet: &[Vec<f64>; 2]) -> (Vec<f64>, [Vec<f64>; 2]) {
    let (units, np, n) = (Units::new(d), d.positions(), d.positions() + d.orientations());
    let per = |i: usize| if i < np { 1.0 } else { 1.0 / units.length };
    let inertia = a.iter().enumerate().map(|(k, x)| x * per(k / n) * per(k % n) / units.mass).collect();
    let jacobian = |foot: &Vec<f64>| foot.iter().enumerate().map(|(k, x)| x * per(k / np)).collect();
    (inertia, [jacobian(&feet[0]), jacobian(&feet[1])])
}

/// `[A −D; Dᵀ 0]` of eq. 11 or 12.
fn contact_system(a: &[f64], feet: &[&Vec<f64>], n: usize, nc: usize) -> DMatrix<f64> {
    let size = n + nc * feet.len();
    let mut m = DMatrix::zeros(size, size);
    m.view_mut((0, 0), (n, n)).copy_from(&DMatrix::from_row_slice(n, n, a));
    for (k, foot) in feet.iter().enumerate() {
        let jacobian = DMatrix::from_row_slice(n, nc, foot);
        m.view_mut((0, n + k * nc), (n, nc)).copy_from(&-&jacobian);
        m.view_mut((n + k * nc, 0), (nc, n)).copy_from(&jacobian.transpose());
    }
    m
}

/// The system for (p̈, β̈, Γ, F) when Q̈ is given: eq. 5 with eq. 4, and where no platform turns, with the
/// balance about the stance foot (eq. 10) that its rotation would obey.
fn inverse_system(gait: &dyn Gait, leg: usize, q: &[f64], a: &[f64], foot: &[f64]) -> DMatrix<f64> {
    let d = gait.description();
    let (np, nq, joints) = (d.positions(), d.orientations(), d.joints());
    let n = np + nq;
    let level = usize::from(d.rotation == Rotation::None);
    let mut m = DMatrix::zeros(n + np + level, n + np + level);
    for (column, x) in (0..np).chain([np + d.unactuated]).enumerate() {
        for row in 0..n {
            m[(row, column)] = a[row * n + x];
        }
        for c in 0..np {
            m[(n + c, column)] = foot[x * np + c];
        }
    }
    for joint in 0..joints {
        m[(np + joint, np + 1 + joint)] = -1.0;
    }
    for row in 0..n {
        for c in 0..np {
            m[(row, np + 1 + joints + c)] = -foot[row * np + c];
        }
    }
    if level == 1 {
        let (shape, still) = (&d.shapes.stance.inverse_jacobian, vec![0.0; nq]);
        let inverse =
            vector(shape.len, |o| gait.inverse_jacobian(Mode::Stance(leg), q, &still, &still[..d.prescribed()], o));
        let balance = shape.balance_w.of(&inverse);
        m[(n + np, np)] = balance[2 * nq + d.unactuated] / Units::new(d).inertia();
    }
    m
}

fn condition(m: &DMatrix<f64>) -> f64 {
    if m.iter().any(|x| !x.is_finite()) {
        return f64::INFINITY;
    }
    let s = m.singular_values();
    s.max() / s.min()
}
