//! Generated dynamics against states computed with Pinocchio (and cross-checked with CasADi and
//! MuJoCo to 1e-12): every number of every state to 1e-10 relative.

use piaffe::{gaits, model::Gait, states};
use serde_json::Value;

/// Relative to the largest number of each quantity.
fn compare(path: &str, expected: &Value, found: &Value, scale: f64, worst: &mut f64) {
    match (expected, found) {
        (Value::Array(e), Value::Array(f)) => {
            assert_eq!(e.len(), f.len(), "{path}: length");
            let scale = scale.max(largest(expected));
            for (i, (e, f)) in e.iter().zip(f).enumerate() {
                compare(&format!("{path}[{i}]"), e, f, scale, worst);
            }
        }
        (Value::Object(e), Value::Object(f)) => {
            for (key, e) in e.iter().filter(|(key, _)| *key != "cond") {
                let f = f.get(key).unwrap_or_else(|| panic!("{path}.{key} is missing"));
                compare(&format!("{path}.{key}"), e, f, 0.0, worst);
            }
        }
        (Value::Number(e), Value::Number(f)) => {
            let (e, f) = (e.as_f64().unwrap(), f.as_f64().unwrap());
            let error = (e - f).abs() / scale.max(e.abs());
            *worst = worst.max(error);
            assert!(error <= 1e-10, "{path}: expected {e}, found {f}, error {error:e}");
        }
        _ => panic!("{path}: expected {expected}, found {found}"),
    }
}

fn largest(value: &Value) -> f64 {
    match value {
        Value::Array(a) => a.iter().map(largest).fold(0.0, f64::max),
        other => other.as_f64().map_or(0.0, f64::abs),
    }
}

fn check(gait: &dyn Gait) {
    let name = gait.description().gait;
    let path = format!("{}/tests/fixtures/dynamics_{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let expected: Value = serde_json::from_str(&text).unwrap();
    let input: states::States = serde_json::from_str(&text).unwrap();
    let found = states::evaluate(gait, &input).unwrap();
    let expected = expected["states"].as_array().unwrap();
    let found = found["states"].as_array().unwrap();
    assert_eq!(expected.len(), 20);
    assert_eq!(expected.len(), found.len());
    let mut worst = 0.0;
    for (i, (e, f)) in expected.iter().zip(found).enumerate() {
        compare(&format!("{name}[{i}]"), e, f, 0.0, &mut worst);
    }
    println!("{name}: worst relative error {worst:e}");
}

#[test]
fn trot_agrees_with_pinocchio() {
    check(&gaits::trot::Trot);
}

#[test]
fn curvet_agrees_with_pinocchio() {
    check(&gaits::curvet::Curvet);
}

#[test]
fn amble_agrees_with_pinocchio() {
    check(&gaits::amble::Amble);
}
