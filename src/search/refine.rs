//! Constraints between the nodes: where a path constraint dips below its values at the nodes.
//!
//! The optimizer imposes path constraints at the nodes. After each solution the motion is looked at on a
//! fine grid; where a constraint dips near zero inside an element, its lowest point there becomes a row
//! of its own (`cycle::dip`), with the value that the grid shows, and the problem is solved again from
//! there. The row follows its dip, so two or three rounds suffice and no margin is needed.

use crate::cycle::Cycle;
use crate::instant::Glance;
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
    /// Imposes the constraints where they dip in the same motion.
    pub fn impose(&self, cycle: &mut Cycle) {
        for dip in &self.found {
            cycle.impose(dip.phase, dip.constraint, dip.s, dip.value);
        }
    }
}

/// Finds where constraints dip in the last simulated motion of `cycle`.
///
/// # Errors
/// If the equations admit no state at some instant.
pub fn dips(cycle: &Cycle) -> Result<Dips, Undefined> {
    let mut result = Dips::default();
    // Of all constraints at three successive instants.
    let mut values = [0, 1, 2].map(|_| vec![0.0; cycle.path().len()]);
    for phase in 0..cycle.phases() {
        let mut glance = Glance::new(cycle.description(), cycle.stance_leg(phase));
        let instants = instants(cycle, phase);
        for (k, (s, node)) in instants.iter().enumerate() {
            let y = match node {
                Some(node) => cycle.quantities(phase, *node),
                None => {
                    cycle.glance(phase, *s, &mut glance)?;
                    &glance.values
                }
            };
            values.rotate_left(1);
            for (value, constraint) in values[2].iter_mut().zip(cycle.path()) {
                *value = constraint.value(y);
            }
            if k < 2 {
                continue;
            }
            for constraint in 0..cycle.path().len() {
                let v = [0, 1, 2].map(|i| values[i][constraint]);
                result.violation = result.violation.max(-v[1]);
                // A dip inside the first or last interval shows in the parabola only.
                let lowest = v[1] <= v[0] && v[1] < v[2] || k == 2 || k + 1 == instants.len();
                if v[1] < NEAR && lowest {
                    let s = [k - 2, k - 1, k].map(|i| instants[i].0);
                    let (at, value) = vertex(&s, &v);
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

/// The instants of a half step in order, as shares of it, and the nodes that they are.
fn instants(cycle: &Cycle, phase: usize) -> Vec<(f64, Option<usize>)> {
    let nodes = (0..cycle.nodes(phase)).map(|node| (cycle.instant(phase, node), Some(node)));
    let mut list: Vec<_> = nodes.chain((1..GRID).map(|k| (k as f64 / GRID as f64, None))).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Where a grid point is a node, the node stays.
    list.dedup_by(|a, b| a.0 == b.0);
    list
}

/// Lowest point of the parabola through three points.
fn vertex(s: &[f64; 3], v: &[f64; 3]) -> (f64, f64) {
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
