//! Constraints between the nodes: where a path constraint dips below its values at the nodes.
//!
//! The optimizer imposes path constraints at the nodes. After each solution the motion is looked at on a
//! fine grid, in those elements where a constraint comes near zero; where one dips inside an element, its
//! lowest point there becomes a row of its own (`cycle::dip`), with the value that the grid shows, and the
//! problem is solved again from there. The row follows its dip, so two or three rounds suffice and no
//! margin is needed.

use crate::cycle::Cycle;
use crate::flow::Undefined;
use crate::instant::Glance;
use crate::lgl::NODES;
use crate::polynomial::evaluate;

/// Points of the grid per phase.
const GRID: usize = 240;
/// Constraints above this (scaled) are left alone.
const NEAR: f64 = 2e-3;

/// Where a parabola comes below this (scaled) it is asked what the constraint itself does.
const CLOSE: f64 = 1e-4;

/// So often, at most.
const PARABOLAS: usize = 3;

/// Rows above this (scaled) do not hold a solution.
const ACTIVE: f64 = 1e-6;

/// A constraint is taken to stay so near to the quartic through its values at the nodes of an element, in parts of their range.
const DOUBT: f64 = 0.1;
/// Places where the quartic is looked at.
const LOOKS: usize = 12;

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
    /// Imposes the constraints where they dip in the same motion, the last one that `cycle` has simulated. Tells by how much that
    /// changes each row between nodes that there was, per phase (scaled; 0 for rows that hold nothing before or after).
    ///
    /// # Errors
    /// If the equations admit no state at some instant.
    pub fn impose(&self, cycle: &mut Cycle) -> Result<Vec<Vec<f64>>, Undefined> {
        let before = cycle.dip_values();
        // Rows whose dip has moved on or risen must not keep the offset that they had.
        for phase in 0..cycle.phases() {
            cycle.measure_dips(phase)?;
        }
        for dip in &self.found {
            cycle.impose(dip.phase, dip.constraint, dip.s, dip.value);
        }
        let change = |(before, after): (&f64, &f64)| {
            if before.min(*after) < ACTIVE { (before - after).abs() } else { 0.0 }
        };
        let changes = |(before, after): (&Vec<f64>, &Vec<f64>)| before.iter().zip(after).map(change).collect();
        Ok(before.iter().zip(&cycle.dip_values()).map(changes).collect())
    }
}

/// Finds where constraints dip in the last simulated motion of `cycle`.
///
/// # Errors
/// If the equations admit no state at some instant.
pub fn dips(cycle: &Cycle) -> Result<Dips, Undefined> {
    let mut result = Dips::default();
    for phase in 0..cycle.phases() {
        let mut glance = Glance::new(cycle.description(), phase);
        let Suspects { instants, constraints } = suspects(cycle, phase);
        beside_turns(cycle, phase, &mut glance, &mut result)?;
        // At three successive instants.
        let mut values = [0, 1, 2].map(|_| vec![0.0; constraints.len()]);
        for (k, (s, node)) in instants.iter().enumerate() {
            let y = match node {
                Some(node) => cycle.quantities(phase, *node),
                None => {
                    cycle.glance(phase, *s, &mut glance)?;
                    &glance.values
                }
            };
            values.rotate_left(1);
            for (value, constraint) in values[2].iter_mut().zip(&constraints) {
                *value = cycle.path(phase)[*constraint].value(y);
            }
            if k < 2 {
                continue;
            }
            for (i, &constraint) in constraints.iter().enumerate() {
                let v = [0, 1, 2].map(|instant| values[instant][i]);
                result.violation = result.violation.max(-v[1]);
                // A dip inside the first or last interval shows in the parabola only.
                let dips = v[1] <= v[0] && v[1] < v[2] || k == 2 || k + 1 == instants.len();
                if v[1] < NEAR && dips && !cycle.is_torn(phase, constraint, instants[k - 1].0) {
                    let s = [k - 2, k - 1, k].map(|i| instants[i].0);
                    let (mut at, mut value) = vertex(&s, &v);
                    if at > s[0] && at < s[2] {
                        if value < CLOSE {
                            (at, value) = lowest(&s, &v, |s| {
                                cycle.glance(phase, s, &mut glance)?;
                                Ok(cycle.path(phase)[constraint].value(&glance.values))
                            })?;
                        }
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

/// Where joints with dry friction turn around, on either side.
fn beside_turns(cycle: &Cycle, phase: usize, glance: &mut Glance, result: &mut Dips) -> Result<(), Undefined> {
    for (constraint, path) in cycle.path(phase).iter().enumerate() {
        if !matches!(path.dry(), Some((_, Some(_)))) {
            continue;
        }
        for s in cycle.lows_beside_turns(phase, constraint) {
            cycle.glance(phase, s, glance)?;
            let value = path.value(&glance.values);
            result.violation = result.violation.max(-value);
            if value < NEAR {
                result.found.push(Dip { phase, constraint, s, value });
            }
        }
    }
    Ok(())
}

/// What of a phase is worth a look.
struct Suspects {
    /// In order, as shares of the phase, and the nodes that they are: all nodes, and the grid in the elements where
    /// some constraint comes near zero.
    instants: Vec<(f64, Option<usize>)>,
    /// Which come near zero anywhere.
    constraints: Vec<usize>,
}

fn suspects(cycle: &Cycle, phase: usize) -> Suspects {
    let last = cycle.nodes(phase) - 1;
    let mut near = vec![false; cycle.path(phase).len()];
    let mut instants = Vec::with_capacity(GRID + last);
    let mut grid = (1..GRID).map(|k| k as f64 / GRID as f64).peekable();
    for (element, first) in (0..last).step_by(NODES - 1).enumerate() {
        let mut look = false;
        for (constraint, near) in near.iter_mut().enumerate().filter(|(k, _)| !cycle.path(phase)[*k].on_demand) {
            if comes_near(cycle.quartic(phase, constraint, element)) {
                (look, *near) = (true, true);
            }
        }
        for node in first..first + NODES - 1 {
            let [here, next] = [0, 1].map(|i| cycle.instant(phase, node + i));
            instants.push((here, Some(node)));
            while let Some(s) = grid.next_if(|s| *s < next) {
                // Where a grid point is a node, the node stays.
                if look && s > here {
                    instants.push((s, None));
                }
            }
        }
    }
    instants.push((cycle.instant(phase, last), Some(last)));
    Suspects { instants, constraints: (0..near.len()).filter(|k| near[*k]).collect() }
}

/// Whether a constraint with these values at the nodes of an element, and this quartic, comes near zero in it.
fn comes_near([values, quartic]: [[f64; NODES]; 2]) -> bool {
    let looks = (1..LOOKS).map(|k| evaluate(&quartic, k as f64 / LOOKS as f64));
    let low = values.into_iter().chain(looks).fold(f64::INFINITY, f64::min);
    let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    low - DOUBT * (high - low) < NEAR
}

/// Lowest point of a constraint with these values at three successive instants: of a few parabolas, each with the constraint's own
/// value at the lowest point of the one before.
fn lowest(
    s: &[f64; 3],
    v: &[f64; 3],
    mut value: impl FnMut(f64) -> Result<f64, Undefined>,
) -> Result<(f64, f64), Undefined> {
    let (mut s, mut v) = (*s, *v);
    for _ in 0..PARABOLAS {
        let (at, _) = vertex(&s, &v);
        if s.contains(&at) {
            break;
        }
        let here = value(at)?;
        // The lowest of the four is in the middle of the three that are kept.
        let place = s.partition_point(|known| *known < at);
        let middle = match here < v[1] {
            true => place,
            false if place < 2 => 2,
            false => 1,
        };
        let with = |three: &[f64; 3], new: f64| {
            let [a, b, c] = *three;
            if place < 2 { [a, new, b, c] } else { [a, b, new, c] }
        };
        let (all_s, all_v) = (with(&s, at), with(&v, here));
        for k in 0..3 {
            (s[k], v[k]) = (all_s[middle - 1 + k], all_v[middle - 1 + k]);
        }
    }
    Ok((s[1], v[1]))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What bends more and more is lowest elsewhere than a parabola through three of its points, and lower.
    #[test]
    fn the_lowest_point_is_that_of_the_constraint_itself() {
        for (third, fourth) in [(0.0, 0.0), (30.0, 0.0), (-30.0, 400.0), (40.0, 800.0)] {
            let curve =
                |s: f64| 40.0 * (s - 0.0063).powi(2) * (1.0 + third * (s - 0.0063) + fourth * (s - 0.0063).powi(2));
            let s = [0.0, 0.004, 0.01];
            let v = s.map(curve);
            let (_, by_parabola) = vertex(&s, &v);
            let (at, value) = lowest(&s, &v, |s| Ok(curve(s))).unwrap();
            assert_eq!(value, curve(at), "a value that it has");
            assert!((0.0..1e-7).contains(&value), "what is left is no violation: {value:e}");
            assert!(third == 0.0 || by_parabola.abs() > 1e-6, "a parabola alone would do: {by_parabola:e}");
        }
    }
}
