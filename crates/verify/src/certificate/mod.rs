//! The certificate: a proof that a motion keeps to its limits at *all* times, not only where somebody looked.
//!
//! Joint angles are polynomials, and all else is closed form but β, of which [`enclosure`] proves where it is. The same
//! physics as the receipt's ([`verify`](crate)) is then evaluated with functions of time instead of numbers
//! ([`taylor`]), and every margin bounded from below over all t (`proof.rs`). The motion's numbers and the robot's are
//! taken for exact; all that arithmetic loses on the way is within the bounds.
//!
//! What is claimed: for all t of the step, no margin is below −1e-6, in the natural units of
//! [`constraint`](crate::constraint); nor at the impacts; and the motion closes to a cycle within 1e-6. A margin
//! of a foot in the air is here its plain height over its curve; at both ends of the swing, where that is zero, its steepness counts.

mod bernstein;
pub mod enclosure;
mod functions;
mod proof;
mod range;
pub mod taylor;

use crate::constraint::Constraint;
use crate::contact::Contact;
use crate::cycle::{closure, transition};
use crate::instants::{Instants, State};
use crate::margins::{Units, steepness};
use crate::numbers::Numbers;
use crate::swing::swings;
use crate::{SMALLEST_GRID, VerifyError, check};
use enclosure::{Model, Piece, enclose, instants};
use num_traits::Zero;
use piaffe_model::Description;
use piaffe_model::motion::{Course, Motion};
use piaffe_number::Scalar;
use proof::{Judge, Proof};
use serde::{Deserialize, Serialize};
use taylor::Ball;

/// The claim: margins are not below minus this, and the cycle closes within it.
pub const TOLERANCE: f64 = 1e-6;

/// What stands behind a receipt between its instants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// Proven for all times.
    Certified,
    /// Known where it was looked at, and where the proof reaches.
    Sampled,
}

impl Standing {
    pub fn name(self) -> &'static str {
        match self {
            Standing::Certified => "certified",
            Standing::Sampled => "sampled",
        }
    }
}

/// What was proven about a motion; see the [module](self).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    pub standing: Standing,
    pub tolerance: f64,
    /// Of every constraint and phase, the margin below which it certainly does not fall.
    pub bounds: Vec<Bound>,
    /// Where that is not enough.
    pub gaps: Vec<Gap>,
    /// The distance from a closed cycle is certainly not greater; absent if β could not be followed.
    pub cycle_error: Option<f64>,
    #[serde(alias = "half_steps")]
    pub phases: Vec<Enclosure>,
}

/// A margin that was proven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    #[serde(deserialize_with = "piaffe_model::limit::name")]
    pub constraint: String,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// For all times, the margin is not below this. Absent if nothing could be proven.
    pub margin: Option<f64>,
}

/// Times between which a constraint could not be proven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// A constraint, or `β` from where it could not be followed.
    #[serde(deserialize_with = "piaffe_model::limit::name")]
    pub constraint: String,
    /// 1-based.
    #[serde(alias = "half_step")]
    pub phase: usize,
    /// s, from the beginning of the phase.
    pub from: f64,
    pub to: f64,
    /// What was reached: the margin is not below. Absent if nothing could be proven.
    pub bound: Option<f64>,
    /// That it is violated there is certain, not only possible.
    pub violated: bool,
}

/// How a phase was enclosed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Enclosure {
    /// Pieces on which β has a polynomial with a proof.
    pub subintervals: usize,
    /// Pieces on which the constraints were evaluated.
    pub evaluations: usize,
    /// Width of what encloses β and β̇ at the end, rad and rad/s.
    pub width: [f64; 2],
}

impl Certificate {
    pub fn is_certified(&self) -> bool {
        self.standing == Standing::Certified
    }
}

/// Proves what can be proven about a motion that is to be performed at the mean `speed` (m/s).
///
/// # Errors
/// If the motion does not have the numbers that the gait needs.
pub fn certify(description: &Description, motion: &Motion, speed: f64) -> Result<Certificate, VerifyError> {
    check(description, motion, SMALLEST_GRID)?;
    let mut certificate = Certificate {
        standing: Standing::Sampled,
        tolerance: TOLERANCE,
        bounds: Vec::new(),
        gaps: Vec::new(),
        cycle_error: None,
        phases: Vec::new(),
    };
    let balls: Vec<_> = motion.phases.iter().map(|h| h.cast::<Ball>()).collect();
    let units = Units::new(description);
    let (mut cycle_error, mut travel) = (0.0_f64, Ball::zero());
    for (i, course) in motion.phases.iter().enumerate() {
        let pieces = match enclose(description, &motion.phases, i) {
            Ok(pieces) => pieces,
            Err(lost) => {
                certificate.gaps.push(Gap::of_beta(i + 1, lost.share * course.duration, course.duration));
                return Ok(certificate);
            }
        };
        let start = [course.beta_initial, course.betad_initial].map(Ball::from);
        let end = pieces.last().map_or(start, |piece| piece.beta.map(|b| b.at(1.0)));
        let mut proof = during(description, &motion.phases, i, &pieces);
        travel += at_ends(description, &balls, i, [start, end], &mut proof);
        let at_impact = |constraint, margin: Ball| proof.note(constraint, margin.range(), [1.0, 1.0]);
        let distances = transition(description, Numbers::new(description), &balls, i, at_impact);
        let all =
            distances.map_or(vec![Ball::UNKNOWN], |found| [found, closure(&units, &balls[i], end).to_vec()].concat());
        cycle_error = all.iter().map(Ball::magnitude).fold(cycle_error, f64::max);
        if i + 1 == balls.len() {
            let duration = balls.iter().fold(Ball::zero(), |sum, h| sum + h.duration);
            proof.note(Constraint::MeanSpeed, Units::mean_speed(travel / duration, speed).range(), [1.0, 1.0]);
        }
        let width = end.map(|b| 2.0 * b.rest());
        certificate.phases.push(Enclosure { subintervals: pieces.len(), evaluations: proof.evaluations, width });
        certificate.take(description, i + 1, course.duration, &proof);
    }
    certificate.cycle_error = cycle_error.is_finite().then_some(cycle_error);
    if certificate.gaps.is_empty() && cycle_error <= TOLERANCE {
        certificate.standing = Standing::Certified;
    }
    Ok(certificate)
}

/// What must hold at every instant of phase `index`.
fn during(description: &Description, phases: &[Course], index: usize, pieces: &[Piece]) -> Proof {
    let models: Vec<Course<Model>> = phases.iter().map(Course::cast).collect();
    let mut judge = Judge {
        instants: instants(description, phases, index),
        swings: swings(description, &models, index),
        units: Units::new(description),
        duration: phases[index].duration,
        state: State::new(description),
        proof: Proof::default(),
    };
    for piece in pieces {
        judge.piece(piece);
    }
    judge.proof
}

/// What must hold at the begin and the end of phase `index`, where β is in these balls. Returns the travel, m.
fn at_ends(
    description: &Description,
    phases: &[Course<Ball>],
    index: usize,
    [start, end]: [[Ball; 2]; 2],
    proof: &mut Proof,
) -> Ball {
    let units = Units::new(description);
    let (numbers, course) = (Numbers::new(description), &phases[index]);
    let contact = Contact::of(description, &numbers, phases, index);
    let mut instants = Instants::new(description, numbers, course, contact);
    let swings = swings(description, phases, index);
    let mut at = |share: f64, beta: [Ball; 2]| {
        let mut state = State::new(description);
        if instants.at(course.duration.scale(share), beta, &mut state).is_none() {
            state.platform.x = Ball::UNKNOWN;
            state.feet.iter_mut().chain(&mut state.feet_velocity).for_each(|foot| foot.y = Ball::UNKNOWN);
            state.feet_acceleration = [Ball::UNKNOWN; 2];
        }
        for swing in &swings {
            if let Some(steep) = steepness(instants.numbers(), &state, swing, share == 1.0) {
                proof.note(swing.constraint, (steep / units.leg.into()).range(), [share, share]);
            }
        }
        state
    };
    let [first, last] = [at(0.0, start), at(1.0, end)];
    if let Some(leg) = description.transition(index).lands() {
        proof.note(Constraint::Touchdown, (-last.feet[leg].y.abs() / units.leg.into()).range(), [1.0, 1.0]);
    }
    units.duration(instants.numbers(), index, course.duration, |constraint, margin| {
        proof.note(constraint, margin.range(), [1.0, 1.0]);
    });
    last.platform.x - first.platform.x
}

impl Certificate {
    /// Takes over what is known about a phase.
    fn take(&mut self, description: &Description, phase: usize, duration: f64, proof: &Proof) {
        let known = |bound: f64| bound.is_finite().then_some(bound);
        self.bounds.extend(proof.bounds.iter().map(|&(constraint, bound)| Bound {
            constraint: constraint.name(description),
            phase,
            margin: known(bound),
        }));
        self.gaps.extend(proof.gaps.iter().map(|gap| Gap {
            constraint: gap.constraint.name(description),
            phase,
            from: gap.from * duration,
            to: gap.to * duration,
            bound: known(gap.bound),
            violated: gap.violated,
        }));
    }
}

impl Gap {
    fn of_beta(phase: usize, from: f64, to: f64) -> Gap {
        Gap { constraint: "β".into(), phase, from, to, bound: None, violated: false }
    }
}
