//! Where β certainly is: an enclosure of the solution of eq. 10, piece by piece.
//!
//! On a piece, a polynomial for β̈ comes from Picard's iteration in plain numbers; integrated twice from where the piece
//! begins it gives β and β̇. What matters is the proof. With g the right-hand side of β̈ = g(t, β, β̇), the defect
//! d = p̈ − g(t, p, ṗ) and the error e = β − p,
//!
//! ```text
//! e(t) = e(a) + ∫ ė,    ė(t) = ė(a) + ∫ (A e + B ė − d),    A, B: values of ∂g/∂β, ∂g/∂β̇ in the tube
//! ```
//!
//! so that with bounds A, B, d of magnitudes, u and v of the errors over a piece of length h,
//! u ≤ |e(a)| + h v and v ≤ |ė(a)| + h (A u + B v + d). If the u and v that solve these are within the tube for which A
//! and B were found, Picard's operator maps the tube into itself: the solution exists, is unique and does not leave it.

use super::taylor::{Ball, Taylor, above};
use crate::contact::contact;
use crate::instants::{Instants, State};
use crate::margins::Units;
use crate::numbers::Numbers;
use num_traits::Zero;
use piaffe_model::Description;
use piaffe_model::motion::Course;
use piaffe_number::Dual;
use piaffe_number::Scalar;

/// Half width of the tube in which β, rad, and β̇, in the unit of slow rates, must stay.
const TUBE: f64 = 1e-6;
/// Pieces with a greater defect are halved; in the square of that unit.
const DEFECT: f64 = 1e-9;
/// What halving does not make smaller by this factor is rounding, of which halves have as much.
const ROUNDING: f64 = 0.5;
/// Share of the tube that it may fill over a phase.
const FILLED: f64 = 1e-2;
/// A phase begins with 2 to the power of this many pieces.
const COARSEST: i32 = 3;
/// No piece is smaller than 2 to the power of minus this, as a share of the phase.
const FINEST: i32 = 14;
/// Number of coefficients of functions of time. The polynomial for β̈ has two fewer, so that integrals fit.
pub const ORDER: usize = 11;
const ACCELERATION: usize = ORDER - 2;
/// Picard iterations, after which nothing changes any more.
const ITERATIONS: usize = 30;

/// A function of time over a piece.
pub type Model = Taylor<ORDER>;
/// Of ∂g/∂β and ∂g/∂β̇ only the size matters, for which few coefficients do.
type Gradient = Dual<Taylor<4>, 2>;

/// β and β̇ over a share of the phase, as functions of τ from −1 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Share of the phase, s = t/T.
    pub share: Model,
    pub beta: [Model; 2],
}

impl Piece {
    pub fn halves(&self) -> [Piece; 2] {
        let ([first, second], [b, c], [d, e]) = (self.share.halves(), self.beta[0].halves(), self.beta[1].halves());
        [Piece { share: first, beta: [b, d] }, Piece { share: second, beta: [c, e] }]
    }
}

/// Why there is no enclosure from this share of the phase on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lost {
    pub share: f64,
}

/// Encloses β and β̇ over the whole of phase `index`, which starts from exactly its initial values.
///
/// # Errors
/// If no piece, however small, has a proof.
pub fn enclose(description: &Description, phases: &[Course], index: usize) -> Result<Vec<Piece>, Lost> {
    let course = &phases[index];
    let mut solver = Solver::new(description, phases, index);
    let mut start = [course.beta_initial, course.betad_initial].map(Ball::from);
    let mut pieces = Vec::new();
    // Shares of a power of two are exact: how many of them lie before, the power, and what defect twice as long a piece had.
    let mut ahead: Vec<(u32, i32, f64)> = (0..1 << COARSEST).rev().map(|k| (k, COARSEST, f64::INFINITY)).collect();
    while let Some((k, level, whole)) = ahead.pop() {
        let half = 0.5_f64.powi(level + 1);
        let share = Model::polynomial(&[(2 * k + 1) as f64 * half, half]);
        match solver.piece(share, half, start, whole) {
            Ok(piece) => {
                start = piece.beta.map(|b| b.at(1.0));
                pieces.push(piece);
            }
            Err(Unproven { defect }) if level < FINEST => {
                ahead.extend([(2 * k + 1, level + 1, defect), (2 * k, level + 1, defect)]);
            }
            Err(_) => return Err(Lost { share: 2.0 * k as f64 * half }),
        }
    }
    Ok(pieces)
}

/// A piece has no proof, or none that is worth having; its defect, if it has one.
struct Unproven {
    defect: f64,
}

impl Unproven {
    const ANYTHING: Unproven = Unproven { defect: f64::INFINITY };
}

/// The instants of phase `index` in numbers of any kind.
pub fn instants<'a, T: Scalar>(description: &'a Description, phases: &[Course], index: usize) -> Instants<'a, T> {
    let contact = contact(description, phases, index);
    Instants::new(description, Numbers::new(description), &phases[index].cast(), contact)
}

struct Solver<'a> {
    plain: Instants<'a>,
    model: Instants<'a, Model>,
    gradient: Instants<'a, Gradient>,
    states: (State, State<Model>, State<Gradient>),
    duration: f64,
    /// A slow rate of the robot, rad/s.
    rate: f64,
    nodes: [f64; ACCELERATION],
}

impl<'a> Solver<'a> {
    fn new(description: &'a Description, phases: &[Course], index: usize) -> Self {
        let course = &phases[index];
        let node = |k| -libm::cos(std::f64::consts::PI * (k as f64 + 0.5) / ACCELERATION as f64);
        Solver {
            plain: instants(description, phases, index),
            model: instants(description, phases, index),
            gradient: instants(description, phases, index),
            states: (State::new(description), State::new(description), State::new(description)),
            duration: course.duration,
            rate: Units::new(description).rate(),
            nodes: std::array::from_fn(node),
        }
    }

    /// The piece from `start`, with its proof; `half` is half its length as a share of the phase, a power of two, and `whole` the
    /// defect of the piece that it is a half of.
    fn piece(&mut self, share: Model, half: f64, start: [Ball; 2], whole: f64) -> Result<Piece, Unproven> {
        // Exact, since `half` is a power of two.
        let half_time = half * self.duration;
        let acceleration = self.picard(share, half_time, start.map(Ball::value)).ok_or(Unproven::ANYTHING)?;
        self.proven(acceleration, share, half_time, start, whole)
    }

    /// What a polynomial for β̈ certainly is close to.
    fn proven(
        &mut self,
        acceleration: Model,
        share: Model,
        half_time: f64,
        start: [Ball; 2],
        whole: f64,
    ) -> Result<Piece, Unproven> {
        let rate = Model::from(start[1].value()) + acceleration.integral() * half_time.into();
        let beta = Model::from(start[0].value()) + rate.integral() * half_time.into();

        let t = share * self.duration.into();
        let (_, state, gradient_state) = &mut self.states;
        let exact = self.model.accelerate(t, [beta, rate], state).ok_or(Unproven::ANYTHING)?;
        let defect = (acceleration - exact).magnitude();
        if !defect.is_finite() {
            return Err(Unproven::ANYTHING);
        }
        let is_rounding = defect >= ROUNDING * whole && defect * self.duration <= FILLED * TUBE * self.rate;
        if defect > DEFECT * self.rate * self.rate && !is_rounding {
            return Err(Unproven { defect });
        }
        let widths = [TUBE, TUBE * self.rate];
        let variable = |x: Model, k: usize| Gradient::variable(x.cast().widened(widths[k]), k);
        let tube = [variable(beta, 0), variable(rate, 1)];
        let slopes = self.gradient.accelerate(Dual::constant(t.cast()), tube, gradient_state);
        let slopes = slopes.ok_or(Unproven { defect })?;
        let [a, b] = slopes.d.map(|d| d.magnitude());

        let h = 2.0 * half_time;
        let [e, ed] = start.map(|x| x.rest());
        // A lower bound: what is taken away is rounded up.
        let room = (1.0 - above(h * b + h * h * a)) * (1.0 - 1e-13);
        let v = above((ed + h * (defect + a * e)) / room);
        let u = above(e + h * v);
        let proven = room >= 0.5 && u <= widths[0] && v <= widths[1];
        if proven { Ok(Piece { share, beta: [beta.widened(u), rate.widened(v)] }) } else { Err(Unproven { defect }) }
    }

    /// A polynomial for β̈ that need not be exact.
    fn picard(&mut self, share: Model, half_time: f64, start: [f64; 2]) -> Option<Model> {
        let mut values = [0.0; ACCELERATION];
        let mut acceleration = Model::zero();
        for _ in 0..ITERATIONS {
            let rate = acceleration.integral().times(half_time);
            let beta = rate.integral().times(half_time);
            let mut change = 0.0_f64;
            for (value, tau) in values.iter_mut().zip(self.nodes) {
                let t = self.duration * share.at(tau).value();
                let betad = start[1] + rate.at(tau).value();
                let b = start[0] + start[1] * half_time * (tau + 1.0) + beta.at(tau).value();
                let found = self.plain.accelerate(t, [b, betad], &mut self.states.0)?;
                change = change.max((found - *value).abs() / found.abs().max(self.rate * self.rate));
                *value = found;
            }
            acceleration = interpolated(&self.nodes, values);
            if change < 1e-15 {
                break;
            }
        }
        Some(acceleration)
    }
}

/// The polynomial through these values, up to rounding.
fn interpolated<const N: usize>(nodes: &[f64; N], mut values: [f64; N]) -> Model {
    for order in 1..N {
        for k in (order..N).rev() {
            values[k] = (values[k] - values[k - 1]) / (nodes[k] - nodes[k - order]);
        }
    }
    // From Newton's form to powers.
    let mut powers = [0.0; N];
    for (value, node) in values.iter().zip(nodes).rev() {
        for k in (1..N).rev() {
            powers[k] = powers[k - 1] - node * powers[k];
        }
        powers[0] = value - node * powers[0];
    }
    Model::polynomial(&powers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use piaffe::gaits::GAITS;

    fn course(d: &Description) -> Course {
        let list = |x: f64| (0..d.prescribed()).map(|k| x * if k % 2 == 0 { 0.4 } else { -0.7 }).collect();
        Course {
            duration: 0.2,
            q_initial: list(1.0),
            qd_initial: list(3.0),
            q_interior: vec![list(1.1)],
            q_final: list(0.9),
            qd_final: list(-2.0),
            beta_initial: 0.1,
            betad_initial: 0.5,
            beta_final: 0.0,
            betad_final: 0.0,
        }
    }

    /// Both enclose one solution, so they meet.
    fn meet(outer: &Piece, inner: &Piece) {
        for tau in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            for (outer, inner) in outer.beta.iter().zip(&inner.beta) {
                let [outer, inner] = [outer.at(tau), inner.at(tau)];
                let apart = (outer.value() - inner.value()).abs();
                assert!(apart <= outer.rest() + inner.rest(), "{apart:e} > {:e} + {:e}", outer.rest(), inner.rest());
            }
        }
    }

    #[test]
    fn errors_of_the_polynomial_and_of_the_start_are_within_the_proof() {
        for gait in GAITS {
            let d = gait.description();
            let h = course(d);
            let mut solver = Solver::new(d, std::slice::from_ref(&h), 0);
            let half = 1.0 / 64.0;
            let share = Model::polynomial(&[half, half]);
            let half_time = half * h.duration;
            let exactly = |shift: [f64; 2]| [h.beta_initial + shift[0], h.betad_initial + shift[1]].map(Ball::from);
            let once = f64::INFINITY;
            let exact = solver.piece(share, half, exactly([0.0; 2]), once).ok().unwrap();
            assert!(exact.beta[0].rest() < 1e-13 && exact.beta[1].rest() < 1e-12);

            // A polynomial that is off gives a wider proof, not a wrong one.
            let good = solver.picard(share, half_time, exactly([0.0; 2]).map(Ball::value)).unwrap();
            let unit = solver.rate * solver.rate;
            for spoilt in [[8e-10, 0.0, 0.0], [0.0, -5e-10, 0.0], [3e-10, 0.0, 4e-10]] {
                let spoilt = Model::polynomial(&spoilt.map(|x| x * unit));
                let found = solver.proven(good + spoilt, share, half_time, exactly([0.0; 2]), once).ok().unwrap();
                meet(&found, &exact);
            }
            assert!(solver.proven(good + Model::from(1e-6 * unit), share, half_time, exactly([0.0; 2]), once).is_err());

            // A start that is known up to a ball leads wherever it leads from anywhere in it.
            let reach = [1e-9, 1e-8];
            let around = std::array::from_fn(|k| exactly([0.0; 2])[k].widened(reach[k]));
            let found = solver.piece(share, half, around, once).ok().unwrap();
            for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let shift = std::array::from_fn(|k| 0.999 * signs[k] * reach[k]);
                meet(&found, &solver.piece(share, half, exactly(shift), once).ok().unwrap());
            }
        }
    }
}
