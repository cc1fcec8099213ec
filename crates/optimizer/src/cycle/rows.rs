//! Which equation and which limit is which row of the nonlinear program.

use super::phase::Phase;
use std::ops::Range;

/// What an equality is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equation {
    /// β at the end of a phase is the wanted one (eq. 24).
    ClosureOfBeta(usize),
    /// The same of σ (eq. 23).
    ClosureOfSigma(usize),
    /// The foot that lands at the end of a phase is on the ground.
    Touchdown(usize),
    MeanSpeed,
    /// A joint that a phase holds still does not move at a node.
    Still {
        phase: usize,
        joint: usize,
        node: usize,
    },
}

/// What an inequality is.
#[derive(Clone, Copy, Debug)]
pub enum Row {
    /// A path constraint at a node of a phase.
    Path { phase: usize, node: usize, constraint: usize },
    /// Between the nodes of a phase.
    Dip { phase: usize, index: usize },
    /// Of the impact at the end of a phase.
    Impact { phase: usize, constraint: usize },
}

/// All rows in their order.
#[derive(Clone, Debug)]
pub struct Rows {
    pub equations: Vec<Equation>,
    pub inequalities: Vec<Row>,
    pub speed: usize,
    of_phase: Vec<OfPhase>,
}

/// Where the rows of a phase are.
#[derive(Clone, Debug, Default)]
pub struct OfPhase {
    pub beta: usize,
    pub sigma: usize,
    pub touchdown: Option<usize>,
    pub path: Range<usize>,
    pub dips: Range<usize>,
    pub impacts: Range<usize>,
}

impl Rows {
    /// Of these phases, with the equations that hold joints.
    pub fn new(phases: &[Phase], holding: &[Equation]) -> Rows {
        let mut equations = Vec::new();
        let mut of_phase = vec![OfPhase::default(); phases.len()];
        let mut add = |equation: Equation| {
            equations.push(equation);
            equations.len() - 1
        };
        for (k, (rows, phase)) in of_phase.iter_mut().zip(phases).enumerate() {
            rows.beta = add(Equation::ClosureOfBeta(k));
            rows.sigma = add(Equation::ClosureOfSigma(k));
            rows.touchdown = phase.landing_foot.map(|_| add(Equation::Touchdown(k)));
        }
        let speed = add(Equation::MeanSpeed);
        for equation in holding {
            add(*equation);
        }

        let most = phases.iter().map(|p| p.mesh.nodes.len() * p.path.len() + p.dips.len());
        let mut inequalities = Vec::with_capacity(most.sum());
        for (k, (rows, p)) in of_phase.iter_mut().zip(phases).enumerate() {
            let first = inequalities.len();
            let row = |node: usize, constraint: usize| Row::Path { phase: k, node, constraint };
            for node in 0..p.mesh.nodes.len() {
                let imposed = (0..p.path.len()).filter(|constraint| p.path[*constraint].is_imposed(node));
                inequalities.extend(imposed.map(|constraint| row(node, constraint)));
            }
            rows.path = first..inequalities.len();
        }
        for (k, (rows, p)) in of_phase.iter_mut().zip(phases).enumerate() {
            let first = inequalities.len();
            inequalities.extend((0..p.dips.len()).map(|index| Row::Dip { phase: k, index }));
            rows.dips = first..inequalities.len();
        }
        for (k, (rows, p)) in of_phase.iter_mut().zip(phases).enumerate() {
            let first = inequalities.len();
            let count = p.impact.as_ref().map_or(0, |impact| impact.count());
            inequalities.extend((0..count).map(|constraint| Row::Impact { phase: k, constraint }));
            rows.impacts = first..inequalities.len();
        }
        Rows { equations, inequalities, speed, of_phase }
    }

    /// Where the rows of phase `k` are.
    pub fn of(&self, k: usize) -> &OfPhase {
        &self.of_phase[k]
    }

    /// How many rows are of impacts: the last ones.
    pub fn impacts(&self) -> usize {
        self.of_phase.iter().map(|rows| rows.impacts.len()).sum()
    }

    /// The equations that hold joints, with their rows.
    pub fn holding(&self) -> impl Iterator<Item = (usize, (usize, usize, usize))> + '_ {
        self.equations.iter().enumerate().filter_map(|(row, equation)| match *equation {
            Equation::Still { phase, joint, node } => Some((row, (phase, joint, node))),
            _ => None,
        })
    }
}
