//! Constraints between the nodes: where a path constraint dips below its values at the nodes.
//!
//! The optimizer imposes path constraints at finitely many instants. After each solution the motion is
//! looked at on a fine grid; the lowest points of constraints that come near zero become instants of
//! their own, besides those found before, and the problem is solved again from there. A dip's depth
//! falls with the square of the distance to the nearest instant, so a few rounds suffice and no
//! margin is needed.

use crate::cycle::Cycle;
use crate::stance::Undefined;

/// Points of the grid per half step.
const GRID: usize = 240;
/// Constraints above this (scaled) are left alone.
const NEAR: f64 = 2e-3;
/// Instants closer than this (share of the half step) are one.
const SAME: f64 = 3e-4;

/// What the grid shows.
#[derive(Clone, Debug, Default)]
pub struct Dips {
    /// Largest violation found (scaled).
    pub violation: f64,
    /// Per half step the instants at which constraints dip lowest.
    pub instants: Vec<Vec<f64>>,
}

/// A copy of the problem that looks at a fine grid.
pub fn probe<'a>(cycle: &Cycle<'a>) -> Cycle<'a> {
    let mut probe = cycle.again();
    let grid: Vec<f64> = (1..GRID).map(|k| k as f64 / GRID as f64).collect();
    probe.set_instants(&vec![grid; cycle.phases()]);
    probe
}

impl Dips {
    /// Adds to `known` the instants that are not there yet; tells whether there were any.
    pub fn join(&self, known: &mut [Vec<f64>]) -> bool {
        let mut added = false;
        for (known, new) in known.iter_mut().zip(&self.instants) {
            for at in new {
                if known.iter().all(|k| (k - at).abs() > SAME) {
                    known.push(*at);
                    added = true;
                }
            }
        }
        added
    }
}

/// Finds where constraints dip in the motion of `theta`.
///
/// # Errors
/// If the motion does not exist.
pub fn dips(probe: &mut Cycle, theta: &[f64]) -> Result<Dips, Undefined> {
    probe.simulate(theta)?;
    let mut result = Dips::default();
    for phase in 0..probe.phases() {
        let mut order: Vec<usize> = (0..probe.nodes(phase)).collect();
        order.sort_by(|a, b| probe.instant(phase, *a).total_cmp(&probe.instant(phase, *b)));
        // Collocation nodes and grid points can coincide.
        order.dedup_by(|a, b| probe.instant(phase, *a) == probe.instant(phase, *b));
        let s: Vec<f64> = order.iter().map(|k| probe.instant(phase, *k)).collect();
        let mut found: Vec<(f64, f64)> = Vec::new();
        for constraint in 0..probe.path_count() {
            let values: Vec<f64> = order.iter().map(|k| probe.path_value(phase, *k, constraint)).collect();
            for k in 1..s.len() - 1 {
                result.violation = result.violation.max(-values[k]);
                // A dip inside the first or last interval shows in the parabola only.
                let lowest = values[k] <= values[k - 1] && values[k] < values[k + 1];
                if values[k] < NEAR && (lowest || k == 1 || k == s.len() - 2) {
                    let (at, value) = vertex(&s[k - 1..=k + 1], &values[k - 1..=k + 1]);
                    if at > s[k - 1] && at < s[k + 1] {
                        result.violation = result.violation.max(-value);
                        found.push((value, at));
                    }
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut instants: Vec<f64> = Vec::new();
        for (_, at) in found {
            if instants.iter().all(|i| (i - at).abs() > SAME) {
                instants.push(at);
            }
        }
        instants.sort_by(f64::total_cmp);
        result.instants.push(instants);
    }
    Ok(result)
}

/// Lowest point of the parabola through three points.
fn vertex(s: &[f64], v: &[f64]) -> (f64, f64) {
    let (a, b) = ((v[1] - v[0]) / (s[1] - s[0]), (v[2] - v[1]) / (s[2] - s[1]));
    let curvature = (b - a) / (s[2] - s[0]);
    if curvature <= 0.0 {
        return (s[1], v[1]);
    }
    let slope = a + curvature * (s[1] - s[0]);
    let at = (s[1] - slope / (2.0 * curvature)).clamp(s[0], s[2]);
    let d = at - s[1];
    (at, v[1] + slope * d + curvature * d * d)
}
