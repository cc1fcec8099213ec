//! A Python with MuJoCo and numpy.

use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// One that is named (`PIAFFE_PYTHON`) must have them; without any, the test says that it is skipped.
pub fn python() -> Option<String> {
    let named = std::env::var("PIAFFE_PYTHON").ok();
    let candidate = named.clone().unwrap_or("python3".into());
    let has = Command::new(&candidate).args(["-c", "import mujoco, numpy"]).stderr(Stdio::null()).status();
    if has.is_ok_and(|s| s.success()) {
        return Some(candidate);
    }
    assert!(named.is_none(), "{candidate} has no mujoco or no numpy");
    eprintln!("skipped: no Python with mujoco and numpy (PIAFFE_PYTHON names one)");
    None
}

/// What a script under `tests/` answers to a request.
pub fn ask(python: &str, script: &str, request: &Value) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(script);
    let mut child = Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(request.to_string().as_bytes()).unwrap();
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success());
    serde_json::from_slice(&out.stdout).unwrap()
}
