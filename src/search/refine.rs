//! Constraints between the nodes: where a path constraint dips below its values at the nodes.
//!
//! The optimizer imposes path constraints at the nodes. After each solution the motion is looked at on a
//! fine grid; where a constraint dips near zero inside an element, its lowest point there becomes a row
//! of its own (`cycle::dip`), with the value that the grid shows, and the problem is solved again from
//! there. The row follows its dip, so two or three rounds suffice and no margin is needed.

use crate::cycle::Cycle;
use crate::stance::Undefined;

/// Points of the grid per half step.
const GRID: usize = 240;
/// Constraints above this (scaled) are left alone.
const NEAR: f64 = 2e-3;

/// What the grid shows.
#[derive(Clone, Debug, Default)]
pub struct Dips {
    /// Largest violation found (scaled).
    pub violation: f64,
    found: Vec<Dip>,
}

/// A path constraint is lowest here, with this value (scaled).
#[derive(Clone, Debug)]
struct Dip {
    phase: usize,
    constraint: usize,
    s: f64,
    value: f64,
}

/// A copy of the problem that looks at a fine grid.
pub fn probe<'a>(cycle: &Cycle<'a>) -> Cycle<'a> {
    let mut probe = cycle.again();
    let grid: Vec<f64> = (1..GRID).map(|k| k as f64 / GRID as f64).collect();
    probe.set_instants(&vec![grid; cycle.phases()]);
    probe
}

impl Dips {
    /// Imposes the constraints where they dip. `cycle` must have simulated the same motion.
    pub fn impose(&self, cycle: &mut Cycle) {
        for dip in &self.found {
            cycle.impose(dip.phase, dip.constraint, dip.s, dip.value);
        }
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
                        result.found.push(Dip { phase, constraint, s: at, value });
                    }
                }
            }
        }
    }
    // Of two dips that turn out to be one, the lower has the last word.
    result.found.sort_by(|a, b| b.value.total_cmp(&a.value));
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
