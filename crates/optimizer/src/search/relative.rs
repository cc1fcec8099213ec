//! Gaits of one robot that differ in their flights alone: a walk, and what runs in its steps. What is known of one is a start for
//! the other.

use piaffe_model::motion::{Course, Motion};
use piaffe_model::{Description, Mode};

/// A motion of `from` as one of `to`, if both move the robot alike and stand in the same order: flights that `to` has not are
/// left out, those that `from` has not go on as the support before them ended, for as long as they must.
pub fn related(from: &Description, motion: &Motion, to: &Description) -> Option<Motion> {
    let (own, wanted) = (supports(from), supports(to));
    let alike = own.len() == wanted.len() && own.iter().zip(&wanted).all(|(a, b)| a.mode == b.mode);
    if !alike || !move_alike(from, to) {
        return None;
    }
    let mut phases = Vec::new();
    for (known, wanted) in own.iter().zip(&wanted) {
        let support = motion.phases.get(known.phase)?;
        phases.push(support.clone());
        if let Some(flight) = wanted.flight {
            let [shortest, _] = to.phases[flight].duration;
            let known = known.flight.and_then(|flight| motion.phases.get(flight));
            phases.push(known.cloned().unwrap_or_else(|| going_on(support, shortest)));
        }
    }
    Some(Motion { phases })
}

/// A phase on a foot, and the flight that follows it if one does.
struct Support {
    mode: Mode,
    phase: usize,
    flight: Option<usize>,
}

/// In order; a gait begins with one.
fn supports(d: &Description) -> Vec<Support> {
    let mut supports: Vec<Support> = Vec::new();
    for (phase, mode) in d.phases.iter().map(|phase| phase.mode).enumerate() {
        match (mode, supports.last_mut()) {
            (Mode::Flight, Some(before)) => before.flight = Some(phase),
            _ => supports.push(Support { mode, phase, flight: None }),
        }
    }
    supports
}

/// Whether all that describes two gaits is the same but for their phases and limits.
fn move_alike(a: &Description, b: &Description) -> bool {
    let embedding = |d: &Description| {
        let bare = Description { key: "", gait: "", phases: (&[]).into(), limits: a.limits.clone(), ..d.clone() };
        bare.fingerprint()
    };
    embedding(a) == embedding(b)
}

/// A flight in which all joints, and what is not driven, go on at the rates at which a support ended.
fn going_on(support: &Course, duration: f64) -> Course {
    let after = |share: f64| -> Vec<f64> {
        support.q_final.iter().zip(&support.qd_final).map(|(q, rate)| q + share * duration * rate).collect()
    };
    let times = support.q_interior.len();
    Course {
        duration,
        q_initial: support.q_final.clone(),
        qd_initial: support.qd_final.clone(),
        q_interior: (1..=times).map(|k| after(k as f64 / (times + 1) as f64)).collect(),
        q_final: after(1.0),
        qd_final: support.qd_final.clone(),
        beta_initial: support.beta_final,
        betad_initial: support.betad_final,
        beta_final: support.beta_final + duration * support.betad_final,
        betad_final: support.betad_final,
    }
}
