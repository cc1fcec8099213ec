//! The inequalities over a phase: each bounded from below on every piece, on smaller ones where that is not enough.

use super::TOLERANCE;
use super::enclosure::{Model, Piece};
use crate::constraint::Constraint;
use crate::instants::{Instants, State};
use crate::margins::{Units, clearance};
use crate::swing::Swing;
use piaffe_number::Scalar;

/// How often a piece is halved at most.
const HALVINGS: usize = 20;
/// Evaluations of a phase, after which what is undecided stays so.
const EVALUATIONS: usize = 4000;

/// What is known about the constraints of a phase.
#[derive(Clone, Debug, Default)]
pub struct Proof {
    /// Least margin that was proven, per constraint.
    pub bounds: Vec<(Constraint, f64)>,
    /// Where that is not enough.
    pub gaps: Vec<Gap>,
    pub evaluations: usize,
}

/// Times between which a constraint has no proof.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    pub constraint: Constraint,
    /// Shares of the phase.
    pub from: f64,
    pub to: f64,
    /// What was proven: the margin is not below.
    pub bound: f64,
    /// Somewhere in it the margin is certainly too small.
    pub violated: bool,
}

impl Proof {
    /// Notes between which numbers a margin stays between two shares of the phase; those of a constraint come in order.
    pub fn note(&mut self, constraint: Constraint, [bound, most]: [f64; 2], [from, to]: [f64; 2]) {
        self.lower(constraint, bound);
        if bound >= -TOLERANCE {
            return;
        }
        let violated = most < -TOLERANCE;
        match self.gaps.iter_mut().rev().find(|gap| gap.constraint == constraint) {
            Some(gap) if gap.to == from => {
                (gap.to, gap.bound) = (to, gap.bound.min(bound));
                gap.violated |= violated;
            }
            _ => self.gaps.push(Gap { constraint, from, to, bound, violated }),
        }
    }

    fn lower(&mut self, constraint: Constraint, bound: f64) {
        match self.bounds.iter_mut().find(|(known, _)| *known == constraint) {
            Some((_, least)) => *least = least.min(bound),
            None => self.bounds.push((constraint, bound)),
        }
    }
}

/// Decides the constraints that must hold at every instant.
pub struct Judge<'a> {
    pub instants: Instants<'a, Model>,
    pub swings: Vec<Swing<Model>>,
    pub units: Units,
    /// s.
    pub duration: f64,
    pub state: State<Model>,
    pub proof: Proof,
}

impl Judge<'_> {
    /// Bounds all margins over a piece.
    pub fn piece(&mut self, piece: &Piece) {
        self.settle(piece, HALVINGS, None);
    }

    /// Bounds those of `open`, or all, and halves the piece for what cannot be decided.
    fn settle(&mut self, piece: &Piece, halvings: usize, open: Option<&[Constraint]>) {
        self.proof.evaluations += 1;
        let exhausted = halvings == 0 || self.proof.evaluations >= EVALUATIONS;
        let mut undecided = Vec::new();
        let ends = [-1.0, 1.0].map(|end| piece.share.at(end).value());
        for (constraint, margin) in self.margins(piece) {
            if open.is_some_and(|open| !open.contains(&constraint)) {
                continue;
            }
            let range = margin.range();
            let decided = range[0] >= -TOLERANCE || range[1] < -TOLERANCE;
            if decided || exhausted {
                self.proof.note(constraint, range, ends);
            } else {
                undecided.push(constraint);
            }
        }
        if !undecided.is_empty() {
            for half in &piece.halves() {
                self.settle(half, halvings - 1, Some(&undecided));
            }
        }
    }

    fn margins(&mut self, piece: &Piece) -> Vec<(Constraint, Model)> {
        let t = piece.share * self.duration.into();
        let defined = self.instants.at(t, piece.beta, &mut self.state).is_some();
        let mut margins = Vec::new();
        let numbers = self.instants.numbers();
        self.units.margins(numbers, &self.instants.contact(), &self.state, |constraint, margin| {
            margins.push((constraint, margin))
        });
        for swing in &self.swings {
            let above = clearance(numbers, &self.state, swing, t) / self.units.leg.into();
            margins.push((swing.constraint, above));
        }
        if !defined {
            margins.iter_mut().for_each(|(_, margin)| *margin = Model::UNKNOWN);
        }
        margins
    }
}
