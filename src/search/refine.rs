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

impl Dips {
    /// Imposes the constraints where they dip. `cycle` must have simulated the same motion.
    pub fn impose(&self, cycle: &mut Cycle) {
        for dip in &self.found {
            cycle.impose(dip.phase, dip.constraint, dip.s, dip.value);
        }
    }
}

/// A copy of the problem that looks at a fine grid.
pub struct Probe<'a> {
    cycle: Cycle<'a>,
    /// Per half step its instants in order of time, as shares of it, and the nodes that they are.
    instants: Vec<Vec<(f64, usize)>>,
    /// Of one half step: a list of values at its instants for every constraint.
    values: Vec<f64>,
}

impl<'a> Probe<'a> {
    pub fn new(cycle: &Cycle<'a>) -> Probe<'a> {
        let mut cycle = cycle.again();
        let grid: Vec<f64> = (1..GRID).map(|k| k as f64 / GRID as f64).collect();
        cycle.set_instants(&vec![grid; cycle.phases()]);
        let instants = (0..cycle.phases()).map(|phase| {
            let mut list: Vec<_> = (0..cycle.nodes(phase)).map(|node| (cycle.instant(phase, node), node)).collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            // Collocation nodes and grid points can coincide.
            list.dedup_by(|a, b| a.0 == b.0);
            list
        });
        Probe { instants: instants.collect(), values: Vec::new(), cycle }
    }

    /// Finds where constraints dip in the motion of `theta`.
    ///
    /// # Errors
    /// If the motion does not exist.
    pub fn dips(&mut self, theta: &[f64]) -> Result<Dips, Undefined> {
        let Probe { cycle, instants, values } = self;
        cycle.simulate(theta)?;
        let mut result = Dips::default();
        for (phase, instants) in instants.iter().enumerate() {
            let count = instants.len();
            values.resize(count * cycle.path_count(), 0.0);
            for (k, (_, node)) in instants.iter().enumerate() {
                for (constraint, value) in cycle.path_values(phase, *node).enumerate() {
                    values[constraint * count + k] = value;
                }
            }
            for (constraint, values) in values.chunks(count).enumerate() {
                let lowest = values[1..count - 1].iter().fold(f64::INFINITY, |least, value| least.min(*value));
                result.violation = result.violation.max(-lowest);
                if lowest >= NEAR {
                    continue;
                }
                for k in 1..count - 1 {
                    // A dip inside the first or last interval shows in the parabola only.
                    let lowest = values[k] <= values[k - 1] && values[k] < values[k + 1];
                    if values[k] < NEAR && (lowest || k == 1 || k == count - 2) {
                        let s = [k - 1, k, k + 1].map(|k| instants[k].0);
                        let (at, value) = vertex(&s, &values[k - 1..=k + 1]);
                        if at > s[0] && at < s[2] {
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
}

/// Lowest point of the parabola through three points.
fn vertex(s: &[f64; 3], v: &[f64]) -> (f64, f64) {
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
