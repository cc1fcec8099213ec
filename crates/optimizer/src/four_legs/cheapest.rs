//! The shares that cost least: of all, and of those that keep to the limits.
//!
//! Of two feet they are one number, found exactly. Of more feet least torque is a problem of least squares; least energy, and both
//! within the limits, are cone programs.

use super::cost::{Effort, Motor};
use super::limits::Room;
use super::margin::{Choice, SLACK, lowest, on_the_way};
use super::shares::{Equation, Shares, Squeeze};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use piaffe_model::motion::Criterion;
use piaffe_sqp::qp::interior::settings;
use smallvec::smallvec;

/// What keeps a choice near to equal shares where others cost the same, beside a cost of 1.
const NEARER: f64 = 1e-9;
/// Costs, and slopes, that differ by a smaller part are the same.
const SAME: f64 = 1e-9;

/// By which the least of all shares, and the least of those that keep to the limits, are found.
pub struct Cheapest<'a> {
    pub motors: &'a [Motor],
    pub rooms: &'a [Room],
    pub choice: &'a Choice,
}

impl Cheapest<'_> {
    /// Of all shares, and of those that keep to the limits; where none do, those with the most room. `None` if a cone program is not
    /// solved.
    pub fn shares(&self, criterion: Criterion) -> Option<[Squeeze; 2]> {
        match (&self.choice.line, self.choice.best.s.len()) {
            (Some(line), _) => {
                let wanted = match criterion {
                    Criterion::Energy => least_energy(self.motors),
                    Criterion::Torque => least_torque(self.motors),
                };
                Some([f64::NEG_INFINITY, 0.0].map(|room| smallvec![line.nearest_with_room(wanted, room)]))
            }
            (None, 0) => Some([Squeeze::new(), Squeeze::new()]),
            (None, squeezes) => {
                let free = match criterion {
                    Criterion::Energy => self.least_energy(squeezes)?,
                    Criterion::Torque => least_squares(self.motors, squeezes),
                };
                let within = self.within(criterion, &free)?;
                Some([free, within])
            }
        }
    }

    /// Of all shares, those where no foot pushes against another if that costs no more.
    fn least_energy(&self, squeezes: usize) -> Option<Squeeze> {
        let none: Squeeze = smallvec![0.0; squeezes];
        let found = Program::new(self, Criterion::Energy, squeezes).solve()?;
        let energy = |s: &[f64]| Effort::new(self.motors, s, s).energy();
        Some(if energy(&none) <= (1.0 + SAME) * energy(&found) { none } else { found })
    }

    fn within(&self, criterion: Criterion, free: &Squeeze) -> Option<Squeeze> {
        let best = &self.choice.best;
        let keeps = |s: &[f64]| lowest(self.rooms, s) >= 0.0;
        if keeps(free) {
            return Some(free.clone());
        } else if best.margin <= SLACK {
            return Some(best.s.clone());
        }
        let found = Program::new(self, criterion, free.len()).within(self.rooms).solve()?;
        // What a solver's tolerance leaves open is closed on the way to the most room.
        Some(on_the_way(&found, &best.s, keeps))
    }
}

/// The numbers at which Σ n Γ² is least; of several the nearest to equal.
fn least_squares(motors: &[Motor], squeezes: usize) -> Squeeze {
    let none: Squeeze = smallvec![0.0; squeezes];
    // That no motor gives any torque is a demand that is met as nearly as can be.
    let equations = motors.iter().map(|m| Equation {
        columns: &m.torque.slope,
        demand: -m.torque.at,
        unit: 1.0 / m.sharing.sqrt(),
    });
    Squeeze::from_slice(&Shares::new(&[equations.collect()], &none).nearest)
}

/// A cone program over a choice of shares and what else it takes, in units in which numbers are of the order of 1.
struct Program {
    squeezes: usize,
    /// Of a squeeze.
    unit: f64,
    /// Rows of the quadratic cost, and the linear cost.
    quadratic: Vec<Vec<f64>>,
    linear: Vec<f64>,
    /// Clarabel's form is A·x + slack = b with the slack in a cone.
    rows: Vec<Vec<f64>>,
    b: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Program {
    fn new(of: &Cheapest, criterion: Criterion, squeezes: usize) -> Program {
        let parts = of.rooms.iter().flat_map(|room| std::iter::once(&room.height).chain(&room.tangential));
        let steepest = parts.flat_map(|part| &part.slope).fold(0.0f64, |most, x| most.max(x.abs()));
        let unit = if steepest > 0.0 { 1.0 / steepest } else { 1.0 };
        // What a motor adds to the cost is a function of this.
        let each: Vec<(f64, Vec<f64>)> = of
            .motors
            .iter()
            .map(|m| {
                let factor = match criterion {
                    Criterion::Energy => m.rate,
                    Criterion::Torque => m.sharing.sqrt(),
                };
                (factor * m.torque.at, m.torque.slope.iter().map(|slope| factor * slope * unit).collect())
            })
            .collect();
        let largest = each.iter().flat_map(|(at, slope)| slope.iter().chain([at])).fold(0.0f64, |m, x| m.max(x.abs()));
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let count = squeezes + if criterion == Criterion::Energy { each.len() } else { 0 };
        let mut program = Program {
            squeezes,
            unit,
            quadratic: vec![vec![0.0; count]; count],
            linear: vec![0.0; count],
            rows: Vec::new(),
            b: Vec::new(),
            cones: Vec::new(),
        };
        (0..squeezes).for_each(|k| program.quadratic[k][k] = NEARER);
        for (motor, (at, slope)) in each.iter().enumerate() {
            let (at, slope): (f64, Vec<f64>) = (scale * at, slope.iter().map(|x| scale * x).collect());
            match criterion {
                Criterion::Torque => {
                    for (k, a) in slope.iter().enumerate() {
                        program.linear[k] += at * a;
                        slope.iter().enumerate().for_each(|(j, b)| program.quadratic[k][j] += a * b);
                    }
                }
                // A variable that is at least this, and at least its opposite.
                Criterion::Energy => {
                    program.linear[squeezes + motor] = 1.0;
                    for sign in [1.0, -1.0] {
                        let mut row = vec![0.0; count];
                        row.iter_mut().zip(&slope).for_each(|(x, slope)| *x = sign * slope);
                        row[squeezes + motor] = -1.0;
                        program.rows.push(row);
                        program.b.push(-sign * at);
                        program.cones.push(SupportedConeT::NonnegativeConeT(1));
                    }
                }
            }
        }
        program
    }

    /// The same where every limit leaves room.
    fn within(mut self, rooms: &[Room]) -> Program {
        for room in rooms {
            for part in std::iter::once(&room.height).chain(&room.tangential) {
                let mut row = vec![0.0; self.linear.len()];
                row.iter_mut().zip(&part.slope).for_each(|(x, slope)| *x = -slope * self.unit);
                self.rows.push(row);
                self.b.push(part.at);
            }
            self.cones.push(match 1 + room.tangential.len() {
                1 => SupportedConeT::NonnegativeConeT(1),
                parts => SupportedConeT::SecondOrderConeT(parts),
            });
        }
        self
    }

    fn solve(self) -> Option<Squeeze> {
        let p = CscMatrix::from(&self.quadratic).to_triu();
        let a = CscMatrix::from(&self.rows);
        let mut solver = DefaultSolver::new(&p, &self.linear, &a, &self.b, &self.cones, settings()).ok()?;
        solver.solve();
        let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        solved.then(|| solver.solution.x[..self.squeezes].iter().map(|x| x * self.unit).collect())
    }
}

/// The one number of two feet at which Σ n Γ² is least.
fn least_torque(motors: &[Motor]) -> f64 {
    let sum = |of: &dyn Fn(&Motor) -> f64| motors.iter().map(|m| m.sharing * m.torque.slope[0] * of(m)).sum::<f64>();
    let stiffness = sum(&|m| m.torque.slope[0]);
    if stiffness > 0.0 { -sum(&|m| m.torque.at) / stiffness } else { 0.0 }
}

/// That at which Σ |Γ q̇| is least: between the two at which one of the torques vanishes and the slope changes its sign, and of all
/// that cost the same the nearest to equal, so that it does not jump from instant to instant.
fn least_energy(motors: &[Motor]) -> f64 {
    let slope = |m: &Motor| (m.torque.slope[0] * m.rate).abs();
    let mut zeros: Vec<(f64, f64)> =
        motors.iter().filter(|m| slope(m) > 0.0).map(|m| (-m.torque.at / m.torque.slope[0], slope(m))).collect();
    zeros.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = zeros.iter().map(|(_, slope)| slope).sum();
    let mut passed = 0.0;
    for (k, (zero, slope)) in zeros.iter().enumerate() {
        passed += slope;
        if 2.0 * passed >= (1.0 - SAME) * total {
            let flat = zeros.get(k + 1).filter(|_| 2.0 * passed <= (1.0 + SAME) * total);
            return 0.0_f64.clamp(*zero, flat.map_or(*zero, |(next, _)| *next));
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::super::limits::Affine;
    use super::*;

    #[test]
    fn no_share_is_cheaper_than_the_cheapest() {
        let mut rng = fastrand::Rng::with_seed(5);
        let mut any = || 2.0 * rng.f64() - 1.0;
        for _ in 0..100 {
            let motors: Vec<Motor> = (0..6)
                .map(|_| Motor { torque: Affine { at: any(), slope: [any()][..].into() }, rate: any(), sharing: 2.0 })
                .collect();
            let at = |s: f64| {
                let effort = Effort::new(&motors, &[s], &[s]);
                (effort.energy(), effort.torque)
            };
            let (energy, torque) = (at(least_energy(&motors)).0, at(least_torque(&motors)).1);
            for s in (-100..=100).map(|k| 0.1 * f64::from(k)) {
                assert!(at(s).0 >= energy - 1e-12 && at(s).1 >= torque - 1e-12);
            }
        }
    }
}
