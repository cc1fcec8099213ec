//! A phase of the gait and the transition that ends it, with what small deviations need to know of them.

use crate::cycle::elements;
use crate::flow::{self, Flow, Layout, Mesh, Undefined};
use piaffe_model::motion::{Course, Motion};
use piaffe_model::{Description, FORWARD, Gait, Mode, Transition, UP};
use piaffe_sqp::dot;

/// Intervals per phase at whose ends the motion is looked at.
const INSTANTS: usize = 500;

/// One phase, from just after a transition to just after the next one.
pub struct Passage {
    /// Which of the gait's.
    pub index: usize,
    pub mode: Mode,
    pub duration: f64,
    /// ∂(β, σ) at the end by (β, σ) at the beginning: rows β, σ.
    pub flow: [[f64; 2]; 2],
    /// Instants in order of time.
    pub instants: Vec<Instant>,
    /// The state at its end, before the transition.
    pub end: End,
    /// The transition, before the legs swap names.
    pub crossing: Crossing,
    /// The beginning of the phase that follows.
    pub next: Start,
}

/// The state at an instant.
#[derive(Clone, Debug, Default)]
pub struct State {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
}

/// One instant of the motion.
pub struct Instant {
    /// s.
    pub time: f64,
    pub state: State,
    pub sigma: f64,
}

/// The end of a phase.
pub struct End {
    /// With q̈.
    pub state: State,
    /// ∂β̇/∂β and ∂β̇/∂σ where Q and Q̇ are kept.
    pub betad: [f64; 2],
}

/// What a transition makes of a deviation.
pub enum Crossing {
    /// A foot lands, as early or late as it meets the ground.
    Lands {
        /// ∂(height of the landing foot)/∂q, m/rad; in flight from the mass centre.
        height: Vec<f64>,
        /// At which it comes down, m/s; negative.
        speed: f64,
        /// ∂q̇⁺/∂(q, q̇⁻), out of flight ∂q̇⁺/∂(q, v⁻, q̇⁻), a row for each of q̇⁺; v is the mass centre's velocity.
        impact: Vec<f64>,
    },
    /// A foot leaves into flight, when the clock of the references says so: then they lift it.
    Leaves {
        /// ∂(height of the mass centre)/∂q, m/rad.
        height: Vec<f64>,
        /// ∂(its velocity)/∂(q, q̇), forward and up.
        velocity: [Vec<f64>; 2],
    },
}

/// The beginning of a phase, in its own mode and with its own names.
pub struct Start {
    pub qd: Vec<f64>,
    pub sigma: f64,
    /// Moment of gravity, N·m; none in flight.
    pub sigmad: f64,
    /// ∂σ/∂q and ∂σ/∂q̇; the latter's entry of β is f1.
    pub by_q: Vec<f64>,
    pub by_qd: Vec<f64>,
}

impl Passage {
    /// Phase `k` of a motion.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    pub fn new(gait: &dyn Gait, motion: &Motion, k: usize) -> Result<Passage, Undefined> {
        let d = gait.description();
        let next = (k + 1) % motion.phases.len();
        let mode = d.phases[k].mode;
        let course = &motion.phases[k];
        let mesh = Mesh::new(elements(d), d.polynomial_order);
        let layout = Layout::new(d, k, &mesh.basis);
        let parameters = parameters(gait, course, mode, &layout);
        let mut flow = Flow::new(d, &mesh, k);
        flow.integrate(gait, mode, &mesh, &parameters)?;
        flow.differentiate(gait, mode, &mesh, &parameters);
        let last = mesh.nodes.len() - 1;
        let row = |of: &[f64]| [layout.beta(), layout.sigma()].map(|p| of[last * layout.len() + p]);

        let mut at = flow::State::new(d, mode);
        let mut instant = |share: f64| {
            flow.at(gait, mode, &mesh, &parameters, share, &mut at)?;
            let state = State { q: at.q.clone(), qd: at.qd.clone(), qdd: acceleration(gait, mode, &at) };
            Ok(Instant { time: share * course.duration, state, sigma: at.sigma })
        };
        let instants: Result<Vec<Instant>, Undefined> =
            (0..=INSTANTS).map(|i| instant(i as f64 / INSTANTS as f64)).collect();
        let instants = instants?;
        let (by_beta, by_sigma, _) = flow.partials(last);
        let end = End { state: instant(1.0)?.state, betad: [by_beta, by_sigma] };
        Ok(Passage {
            index: k,
            mode,
            duration: course.duration,
            flow: [row(&flow.beta_p), row(&flow.sigma_p)],
            crossing: Crossing::new(gait, motion, k, &end.state),
            end,
            instants,
            next: Start::new(gait, &motion.phases[next], d.phases[next].mode),
        })
    }

    /// The state at its beginning.
    pub fn beginning(&self) -> &Instant {
        &self.instants[0]
    }

    /// The state at its end, before the transition.
    pub fn last(&self) -> &Instant {
        &self.instants[self.instants.len() - 1]
    }
}

/// Local parameters of a phase: see `flow`. Those that (β, σ) do not depend on stay zero.
fn parameters(gait: &dyn Gait, h: &Course, mode: Mode, layout: &Layout) -> Vec<f64> {
    let mut parameters = vec![0.0; layout.len()];
    for j in 0..layout.prescribed {
        let own = &mut parameters[layout.joint(j, 0)..][..layout.per_joint];
        let interior = h.q_interior.iter().map(|values| values[j]);
        let values = [h.q_initial[j], h.qd_initial[j]].into_iter().chain(interior).chain([h.q_final[j], h.qd_final[j]]);
        own.iter_mut().zip(values).for_each(|(own, value)| *own = value);
    }
    parameters[layout.duration()] = h.duration;
    parameters[layout.beta()] = h.beta_initial;
    parameters[layout.sigma()] = Start::new(gait, h, mode).sigma;
    parameters
}

impl Crossing {
    /// After phase `k`, from the state at its end.
    fn new(gait: &dyn Gait, motion: &Motion, k: usize, state: &State) -> Crossing {
        let d = gait.description();
        let (mode, transition, State { q, qd, .. }) = (d.phases[k].mode, d.transition(k), state);
        let of_foot = |leg: usize| {
            let shape = d.shape(mode).placement;
            let mut placement = shape.zeros();
            gait.placement(mode, q, &mut placement);
            let foot = mode.swinging().position(|other| other == leg).unwrap_or_default();
            shape.swing_q.row(&placement, foot * d.positions() + UP).to_vec()
        };
        match transition {
            Transition::Touchdown(leg) => {
                let mut touchdown = d.shapes.touchdown.zeros();
                gait.touchdown(leg, q, qd, &mut touchdown);
                let height = of_foot(leg);
                let impact = d.shapes.touchdown.qd_plus_w.of(&touchdown).to_vec();
                Crossing::Lands { speed: dot(&height, qd), height, impact }
            }
            Transition::Landing(leg) => {
                let velocity = falling(gait, motion, k);
                let mut landing = d.shapes.landing.zeros();
                gait.landing(leg, q, &velocity, qd, &mut landing);
                let height = of_foot(leg);
                let impact = d.shapes.landing.qd_plus_w.of(&landing).to_vec();
                Crossing::Lands { speed: dot(&height, qd) + velocity[UP], height, impact }
            }
            Transition::TakeOff(leg) => {
                let (shape, takeoff) = (&d.shapes.takeoff, takeoff(gait, leg, q, qd));
                Crossing::Leaves {
                    height: shape.r_q.row(&takeoff, UP).to_vec(),
                    velocity: [FORWARD, UP].map(|component| shape.v_w.row(&takeoff, component).to_vec()),
                }
            }
        }
    }
}

/// The mass centre's velocity at the end of a flight `k`, forward and up, m/s.
fn falling(gait: &dyn Gait, motion: &Motion, k: usize) -> [f64; 2] {
    let (d, count) = (gait.description(), motion.phases.len());
    let before = (k + count - 1) % count;
    let Transition::TakeOff(leg) = d.transition(before) else { return [f64::NAN; 2] };
    let h = &motion.phases[before];
    let (q, qd) = (d.complete(&h.q_final, h.beta_final), d.complete(&h.qd_final, h.betad_final));
    let takeoff = takeoff(gait, leg, &q, &qd);
    let velocity = d.shapes.takeoff.v.of(&takeoff);
    [velocity[FORWARD], velocity[UP] - d.gravity * motion.phases[k].duration]
}

/// The take-off of a foot: its kernel, with accelerations that are of no matter here.
fn takeoff(gait: &dyn Gait, leg: usize, q: &[f64], qd: &[f64]) -> Vec<f64> {
    let mut takeoff = gait.description().shapes.takeoff.zeros();
    gait.takeoff(leg, q, qd, &vec![0.0; q.len()], &mut takeoff);
    takeoff
}

impl Start {
    fn new(gait: &dyn Gait, h: &Course, mode: Mode) -> Start {
        let d = gait.description();
        let (q, qd) = (d.complete(&h.q_initial, h.beta_initial), d.complete(&h.qd_initial, h.betad_initial));
        let mut momentum = d.shape(mode).momentum.zeros();
        gait.momentum(mode, &q, &qd, &mut momentum);
        let mut terms = d.shape(mode).momentum_terms.zeros();
        gait.momentum_terms(mode, &q, &qd, &mut terms);
        let (by_q, by_qd) = d.shape(mode).momentum.sigma_w.of(&momentum).split_at(q.len());
        Start {
            qd,
            sigma: d.shape(mode).momentum.sigma.value(&momentum),
            sigmad: d.shape(mode).momentum_terms.sigmadot.of(&terms).iter().sum(),
            by_q: by_q.to_vec(),
            by_qd: by_qd.to_vec(),
        }
    }
}

/// Values of all coordinates with the names that they have in the phase after `phase`.
pub fn with_next_names(d: &Description, phase: usize, values: &[f64]) -> Vec<f64> {
    let name = |k| {
        let (from, sign) = d.renamed(phase, k);
        sign * values[from]
    };
    (0..values.len()).map(name).collect()
}

/// q̈, with β̈ by eq. 10.
fn acceleration(gait: &dyn Gait, mode: Mode, at: &flow::State) -> Vec<f64> {
    let d = gait.description();
    let mut inverse = d.shape(mode).inverse.zeros();
    gait.inverse(mode, &at.q, &at.qd, &at.prescribed[2], &mut inverse);
    let xdd = d.shape(mode).inverse.xdd.of(&inverse);
    xdd[xdd.len() - at.q.len()..].to_vec()
}
