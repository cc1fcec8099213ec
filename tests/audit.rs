//! `piaffe verify`: what a result states is derived anew, and what was changed is named.

use piaffe::audit::{Audit, Verdict, derived};
use piaffe::gaits::GAITS;
use piaffe::result::GaitResult;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::LazyLock;

fn piaffe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_piaffe")).args(arguments).output().unwrap()
}

static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());

fn path(name: &str) -> PathBuf {
    FOLDER.path().join(name)
}

fn optimum(gait: &str, criterion: &str) -> Value {
    let file = path(&format!("{}-{criterion}.json", gait.replace('/', "-")));
    let name = file.to_str().unwrap();
    let out = piaffe(&["optimize", gait, "--criterion", criterion, "--speed", "0.6", "--json", name]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

static TROT: LazyLock<Value> = LazyLock::new(|| optimum("trot", "energy"));

/// Exit code and statements of a result, as JSON and in words.
fn audited(name: &str, result: &Value) -> (i32, Vec<Value>, String) {
    let file = path(name);
    std::fs::write(&file, result.to_string()).unwrap();
    let verdicts = path(&format!("verdicts-of-{name}"));
    let out = piaffe(&["verify", file.to_str().unwrap(), "--json", verdicts.to_str().unwrap()]);
    let audits: Value = serde_json::from_slice(&std::fs::read(verdicts).unwrap()).unwrap();
    let words = String::from_utf8(out.stdout).unwrap();
    (out.status.code().unwrap(), audits[0]["statements"].as_array().unwrap().clone(), words)
}

fn entries(statements: &[Value], verdict: &str) -> Vec<String> {
    let of = statements.iter().filter(|s| s["verdict"] == verdict);
    of.map(|s| s["entry"].as_str().unwrap().to_string()).collect()
}

#[test]
fn what_the_program_states_is_confirmed() {
    let all = ["trot energy", "amble torque", "curvet energy", "rabbit/walk torque", "a1/bound energy"];
    for (gait, criterion) in all.into_iter().filter_map(|name| name.split_once(' ')) {
        let result = optimum(gait, criterion);
        let (code, statements, words) = audited("honest.json", &result);
        let (confirmed, history) = (entries(&statements, "confirmed"), entries(&statements, "not-derivable"));
        assert!(code == 0 && confirmed.len() + history.len() == statements.len(), "{words}");
        // How it was found is named, and nothing else is left open.
        assert_eq!(history, ["local_optima", "search", "seconds", "version"], "{words}");
        for entry in ["status", "cost", "receipt", "certificate", "peaks", "durations", "optimality", "stability"] {
            assert!(confirmed.iter().any(|c| c == entry), "{entry} is not stated: {confirmed:?}");
        }
        let open = ["NOT CONFIRMED", "not checked"].iter().any(|word| words.contains(word));
        assert!(words.lines().next().unwrap().ends_with(", confirmed") && !open, "{words}");
    }
}

#[test]
fn what_was_changed_is_named() {
    let changed = |pointer: &str, value: Value| {
        let mut result = TROT.clone();
        *result.pointer_mut(pointer).unwrap() = value;
        let (code, statements, words) = audited(&format!("{}.json", pointer.replace('/', "_")), &result);
        assert_eq!(code, 4, "{words}");
        (statements, words)
    };
    let number = |pointer: &str| TROT.pointer(pointer).unwrap().as_f64().unwrap();
    // A claim: it alone is refuted, with what it should be.
    for (pointer, value) in [
        ("/cost", json!(number("/cost") * (1.0 - 1e-6))),
        ("/costs/torque", json!(1.0)),
        ("/step_length", json!(0.5)),
        ("/receipt/max_violation", json!(0.0)),
        ("/receipt/kkt_residual", json!(1e-3)),
        ("/receipt/kkt_residual", json!(1e-5)),
        ("/receipt/kkt_residual", json!(-1000.0)),
        ("/receipt/kkt_residual", Value::Null),
        ("/receipt/findings/0/constraint", json!("friction")),
        ("/receipt/findings", json!([])),
        ("/certificate/standing", json!("sampled")),
        ("/certificate/bounds/0/margin", json!(0.9)),
        ("/certificate/phases/0/width", json!([0.0, 0.0])),
        ("/peaks/1/torque", json!(0.1)),
        ("/polynomial_order", json!(8)),
        ("/status", json!("receipt-failed")),
    ] {
        let (statements, words) = changed(pointer, value.clone());
        let entry = pointer.split('/').nth(1).unwrap();
        assert_eq!(entries(&statements, "not-confirmed"), [entry], "{pointer}: {words}");
        let refuted = statements.iter().find(|s| s["entry"] == entry).unwrap();
        let difference = &refuted["differences"][0];
        let place = difference["place"].as_str().unwrap();
        assert!(place.starts_with(entry) && words.contains(place), "{words}");
        assert_ne!(difference["stated"], difference["found"]);
    }
    // A statement that is left out, whatever is said of why.
    for (entry, excuse) in [
        ("cost", json!([])),
        ("receipt", json!([{ "entry": "receipt", "reason": "not looked at" }])),
        ("certificate", json!([])),
        ("optimality", json!([])),
        ("peaks", json!([])),
        ("stability", json!([])),
    ] {
        let mut result = TROT.clone();
        result.as_object_mut().unwrap().remove(entry);
        result["not_examined"] = excuse;
        let (code, statements, words) = audited(&format!("without-{entry}.json"), &result);
        assert!(code == 4 && entries(&statements, "not-confirmed") == [entry], "{entry}: {words}");
    }
    // What takes longest may be left open, if it is said. The verdict is that of all of it nevertheless.
    for entry in ["certificate", "stability"] {
        let mut result = TROT.clone();
        result.as_object_mut().unwrap().remove(entry);
        result["not_examined"] = json!([{ "entry": entry, "reason": "not looked at" }]);
        assert_eq!(audited("open.json", &result).0, 0, "{entry}");
    }
    // The motion: whatever follows from it is refuted.
    for (pointer, by) in [("/variables/0/q_final/0", 1e-6), ("/variables/0/duration", 1e-7), ("/speed", 1e-4)] {
        let (statements, words) = changed(pointer, json!(number(pointer) + by));
        let refuted = entries(&statements, "not-confirmed");
        assert!(refuted.iter().any(|r| r == "receipt") && refuted.iter().any(|r| r == "certificate"), "{words}");
    }
    let (statements, words) = changed("/variables/0/q_interior", json!([[0.1]]));
    assert!(entries(&statements, "confirmed").is_empty() && words.contains("has 1 numbers"), "{words}");
    for interior in [json!([]), json!([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]])] {
        let (statements, words) = changed("/variables/0/q_interior", interior);
        assert!(entries(&statements, "confirmed").is_empty() && words.contains("`q_interior`"), "{words}");
    }
    // What is said beside the motion must not contradict what is there.
    let open = |entry: &str| json!([{ "entry": entry, "reason": "the proof found a limit broken" }]);
    for (pointer, value, entry) in [
        ("/not_examined", open("certificate"), "not_examined"),
        ("/not_examined", open("receipt"), "not_examined"),
        ("/local_optima/0/cost", json!(1.0), "local_optima"),
        ("/search/successes", json!(1000), "search"),
    ] {
        let mut result = TROT.clone();
        result["not_examined"] = json!([]);
        *result.pointer_mut(pointer).unwrap() = value;
        let (code, statements, words) = audited("beside.json", &result);
        assert!(code == 4 && entries(&statements, "not-confirmed") == [entry], "{pointer}: {words}");
    }
    let mut result = TROT.clone();
    result["variables"][0]["knees"] = json!([0.1]);
    let (code, statements, words) = audited("unknown.json", &result);
    assert!(code == 4 && entries(&statements, "not-confirmed") == ["variables"], "{words}");
    // Another question: the motion is no optimum for it.
    let (statements, words) = changed("/criterion", json!("torque"));
    assert!(entries(&statements, "not-confirmed").iter().any(|r| r == "status"), "{words}");
}

#[test]
fn what_cannot_be_checked_is_said_to_be_so() {
    // With the files of the gait, and without.
    let unknown = "there is no gait `canter`";
    for (pointer, value, carries, why) in [
        ("/fingerprint", json!("0123456789abcdef"), true, "fingerprint"),
        ("/fingerprint", json!("0123456789abcdef"), false, "fingerprint"),
        ("/gait", json!("canter"), true, "fingerprint"),
        ("/gait", json!("canter"), false, unknown),
        ("/specification/gait", json!("moves = 1"), true, "unknown key `moves`"),
    ] {
        let mut result = TROT.clone();
        *result.pointer_mut(pointer).unwrap() = value;
        if !carries {
            result.as_object_mut().unwrap().remove("specification");
        }
        let (code, statements, words) = audited("foreign.json", &result);
        assert!(code == 4 && words.contains(why), "{words}");
        assert_eq!(
            entries(&statements, "not-checked").len() + entries(&statements, "not-derivable").len(),
            statements.len()
        );
    }
    // A statement that this version knows nothing of, beside others that hold.
    let mut result = TROT.clone();
    result["grace"] = json!({ "of the hind legs": 0.9 });
    let (code, statements, _) = audited("grace.json", &result);
    assert!(code == 4 && entries(&statements, "not-checked") == ["grace"]);
    assert!(entries(&statements, "not-confirmed").is_empty());

    let file = path("fast.json");
    let fast = ["optimize", "trot", "--speed", "5", "--starts", "1", "--json", file.to_str().unwrap()];
    assert_eq!(piaffe(&fast).status.code(), Some(3));
    let infeasible: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    let (code, statements, words) = audited("infeasible.json", &infeasible);
    assert!(code == 0 && words.contains("states no motion"), "{words}");
    assert_eq!(entries(&statements, "confirmed"), ["polynomial_order", "robot"]);
    assert_eq!(entries(&statements, "not-derivable").len() + 2, statements.len());
    // Without a motion it is no optimum, and costs nothing.
    for (key, value) in [("status", json!("optimal")), ("cost", json!(12.0)), ("receipt", TROT["receipt"].clone())] {
        let mut claiming = infeasible.clone();
        claiming[key] = value;
        let (code, statements, words) = audited("claiming.json", &claiming);
        assert!(code == 4 && entries(&statements, "not-confirmed") == [key], "{words}");
    }
}

/// A result as builds before gaits with flights wrote it: what a phase is was called a half step, in keys and in words.
fn older(value: &Value) -> Value {
    let entry = |(key, value): (&String, &Value)| match (key.as_str(), value) {
        ("phase", Value::Number(_)) => ("half_step".into(), value.clone()),
        ("phases", Value::Array(_)) => ("half_steps".into(), older(value)),
        ("specification", _) => (key.clone(), value.clone()),
        _ => (key.clone(), older(value)),
    };
    match value {
        Value::Object(map) => map.iter().map(entry).collect(),
        Value::Array(list) => list.iter().map(older).collect(),
        Value::String(words) => words.replace("phase", "half step").into(),
        _ => value.clone(),
    }
}

#[test]
fn results_of_older_builds_are_read_and_confirmed() {
    for result in [TROT.clone(), optimum("curvet", "energy")] {
        let old = older(&result);
        let text = old.to_string();
        for words in ["\"half_step\":", "\"half_steps\":", "\"shortest half step\""] {
            assert!(text.contains(words) && !result.to_string().contains(words), "{words}");
        }
        let read = |value: &Value| serde_json::from_value::<GaitResult>(value.clone()).unwrap();
        assert_eq!(read(&old), read(&result));
        let (code, statements, words) = audited("older.json", &old);
        assert!(code == 0 && entries(&statements, "confirmed").len() > 10, "{words}");
        // Nor is less refuted than in a result of today.
        for (pointer, value) in [
            ("/certificate/bounds/0/half_step", json!(3)),
            ("/certificate/bounds/0/constraint", json!("shortest half steps")),
            ("/certificate/half_steps/0/width", json!([0.0, 0.0])),
        ] {
            let mut changed = old.clone();
            *changed.pointer_mut(pointer).unwrap() = value;
            let (code, statements, words) = audited("older-changed.json", &changed);
            assert!(code == 4 && entries(&statements, "not-confirmed") == ["certificate"], "{pointer}: {words}");
        }
    }
}

/// Pointers to all numbers in a value.
fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at.to_string()),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| numbers(v, &format!("{at}/{i}"), found)),
        Value::Object(map) => map.iter().for_each(|(key, v)| numbers(v, &format!("{at}/{key}"), found)),
        _ => {}
    }
}

#[test]
fn every_edit_of_a_single_number_is_caught_or_named_as_not_derivable() {
    let honest: GaitResult = serde_json::from_value(TROT.clone()).unwrap();
    let found = derived(&honest, GAITS).unwrap();
    let mut pointers = Vec::new();
    numbers(&TROT, "", &mut pointers);
    assert!(pointers.len() > 250, "{}", pointers.len());
    for pointer in pointers {
        let mut result = TROT.clone();
        let slot = result.pointer_mut(&pointer).unwrap();
        *slot = match (slot.as_u64(), slot.as_f64().unwrap()) {
            (Some(count), _) => json!(count + 1),
            (None, x) => json!(if x == 0.0 { 1e-6 } else { x * (1.0 + 1e-7) + 1e-12 }),
        };
        // What cannot be read is refused as such.
        let Ok(read) = serde_json::from_value::<GaitResult>(result.clone()) else { continue };
        let entry = pointer.split('/').nth(1).unwrap();
        let given = ["speed", "variables"].contains(&entry);
        let audit = match given {
            true => Audit::new(&result, &read, GAITS),
            false => Audit::against(&result, &read, Ok(&found)),
        };
        let named = audit.statements.iter().any(|s| s.entry == entry && s.verdict == Verdict::NotDerivable);
        assert!(named || !audit.is_confirmed(), "{pointer}: {} is confirmed", result.pointer(&pointer).unwrap());
    }
}

#[test]
fn nothing_is_shown_that_is_not_confirmed() {
    for (pointer, by) in [("/speed", 0.6), ("/cost", -1.0), ("/certificate/bounds/0/margin", 0.1)] {
        let mut result = TROT.clone();
        let slot = result.pointer_mut(pointer).unwrap();
        *slot = json!(slot.as_f64().unwrap() + by);
        let file = path("tampered.json");
        std::fs::write(&file, result.to_string()).unwrap();
        let (file, out) = (file.to_str().unwrap(), path("page"));
        for command in [
            &["report", file, "--out", out.to_str().unwrap()][..],
            &["export", file, "--format", "csv", "--out", "-"],
            &["lift", file, "--format", "csv", "--out", "-"],
        ] {
            let ran = piaffe(command);
            let words = String::from_utf8_lossy(&ran.stderr);
            assert!(!ran.status.success() && words.contains("is not confirmed"), "{command:?}: {words}");
            assert!(ran.stdout.is_empty() && !out.exists(), "{command:?} writes all the same");
        }
    }
}

/// An optimum that is said to be none, or none that is said to be something.
#[test]
fn what_is_no_optimum_is_looked_at_too() {
    // Of another task: of two results of one a report would not know which to show.
    let good = path("good-torque.json");
    std::fs::write(&good, optimum("trot", "torque").to_string()).unwrap();
    let run = piaffe(&["optimize", "trot", "--speed", "4", "--starts", "2", "--quiet", "--json", "-"]);
    assert_eq!(run.status.code(), Some(3));
    let none: Value = serde_json::from_slice(&run.stdout).unwrap();
    let with = |of: &Value, entries: &[(&str, Value)]| {
        let mut result = of.clone();
        entries.iter().for_each(|(key, value)| result[*key] = value.clone());
        result
    };
    let proven = json!("infeasible: proven for every speed above 0.1 m/s");
    for (name, result, holds) in [
        ("none.json", none.clone(), true),
        ("said-none.json", with(&TROT, &[("status", json!("infeasible")), ("message", proven)]), false),
        ("said-failed.json", with(&TROT, &[("status", json!("receipt-failed")), ("cost", json!(5.0))]), false),
        ("backwards.json", with(&none, &[("speed", json!(-4.0))]), false),
        ("priced.json", with(&none, &[("cost", json!(5.0))]), false),
        ("found.json", with(&none, &[("local_optima", TROT["local_optima"].clone())]), false),
    ] {
        let file = path(name);
        std::fs::write(&file, result.to_string()).unwrap();
        let [good, file] = [&good, &file].map(|file| file.to_str().unwrap());
        assert_eq!(piaffe(&["verify", file]).status.code() == Some(0), holds, "{name}");
        let diff = piaffe(&["diff", good, file]);
        assert_eq!(diff.status.success(), holds, "{name}: {}", String::from_utf8_lossy(&diff.stderr));
        let out = path("beside");
        let report = piaffe(&["report", good, file, "--out", out.to_str().unwrap()]);
        assert!(report.status.success(), "{name}: {}", String::from_utf8_lossy(&report.stderr));
        let page = std::fs::read_to_string(out.join("index.html")).unwrap();
        assert_eq!(page.contains("One result could not be confirmed"), !holds, "{name}");
        assert_eq!(page.contains("One search found no optimum, by its own account"), holds, "{name}");
    }
}

#[test]
fn a_file_that_cannot_be_read_does_not_hide_the_others() {
    let good = path("good.json");
    std::fs::write(&good, TROT.to_string()).unwrap();
    let out = piaffe(&["verify", "nowhere.json", good.to_str().unwrap(), "--json", "-"]);
    assert_eq!(out.status.code(), Some(1));
    let audits: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(audits[0]["file"] == good.to_str().unwrap() && audits[0]["confirmed"] == true, "{audits}");
    let words = String::from_utf8(out.stderr).unwrap();
    assert!(words.contains("nowhere.json") && words.contains("1 of 2 results"), "{words}");
}
