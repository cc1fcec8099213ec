//! A half step of the gait and the landing that ends it, with what small deviations need to know of them.

use crate::cycle::elements;
use crate::flow::{self, Flow, Layout, Mesh, Undefined};
use piaffe_model::motion::{HalfStep, Motion};
use piaffe_model::{Description, Gait, Mode, UP};
use piaffe_sqp::dot;

/// Intervals per half step at whose ends the motion is looked at.
const INSTANTS: usize = 500;

/// One half step, from just after a landing to just after the next one.
pub struct Passage {
    /// Which of the gait's.
    pub index: usize,
    pub mode: Mode,
    pub duration: f64,
    /// ∂(β, σ) at the end by (β, σ) at the beginning: rows β, σ.
    pub flow: [[f64; 2]; 2],
    /// Instants in order of time.
    pub instants: Vec<Instant>,
    /// The landing, before the legs swap names.
    pub landing: Landing,
    /// The beginning of the half step that follows.
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

/// The end of a half step: the state before the impact, and the impact's derivatives.
pub struct Landing {
    /// With q̈.
    pub state: State,
    /// ∂β̇/∂β and ∂β̇/∂σ where Q and Q̇ are kept.
    pub betad: [f64; 2],
    /// ∂(height of the landing foot)/∂q, m/rad.
    pub height: Vec<f64>,
    /// ∂q̇⁺/∂(q, q̇⁻), a row for each of q̇⁺.
    impact: Vec<f64>,
}

/// The beginning of a half step, on its own leg and with its own names.
pub struct Start {
    pub qd: Vec<f64>,
    pub sigma: f64,
    /// Moment of gravity, N·m.
    pub sigmad: f64,
    /// ∂σ/∂q and ∂σ/∂q̇; the latter's entry of β is f1.
    pub by_q: Vec<f64>,
    pub by_qd: Vec<f64>,
}

impl Passage {
    /// Half step `k` of a motion.
    ///
    /// # Errors
    /// If the equations admit no such motion.
    pub fn new(gait: &dyn Gait, motion: &Motion, k: usize) -> Result<Passage, Undefined> {
        let d = gait.description();
        let next = (k + 1) % motion.half_steps.len();
        let mode = d.phases[k].mode;
        let half_step = &motion.half_steps[k];
        let mesh = Mesh::new(elements(d), d.polynomial_order);
        let layout = Layout::new(d, k, &mesh.basis);
        let parameters = parameters(gait, half_step, mode, &layout);
        let mut flow = Flow::new(d, &mesh, k);
        flow.integrate(gait, mode, &mesh, &parameters)?;
        flow.differentiate(gait, mode, &mesh, &parameters);
        let last = mesh.nodes.len() - 1;
        let row = |of: &[f64]| [layout.beta(), layout.sigma()].map(|p| of[last * layout.len() + p]);

        let mut at = flow::State::new(d, mode);
        let mut instant = |share: f64| {
            flow.at(gait, mode, &mesh, &parameters, share, &mut at)?;
            let state = State { q: at.q.clone(), qd: at.qd.clone(), qdd: acceleration(gait, mode, &at) };
            Ok(Instant { time: share * half_step.duration, state, sigma: at.sigma })
        };
        let instants: Result<Vec<Instant>, Undefined> =
            (0..=INSTANTS).map(|i| instant(i as f64 / INSTANTS as f64)).collect();
        let instants = instants?;
        let (by_beta, by_sigma, _) = flow.partials(last);
        Ok(Passage {
            index: k,
            mode,
            duration: half_step.duration,
            flow: [row(&flow.beta_p), row(&flow.sigma_p)],
            landing: Landing::new(gait, mode, instant(1.0)?.state, [by_beta, by_sigma]),
            instants,
            next: Start::new(gait, &motion.half_steps[next], d.phases[next].mode),
        })
    }

    /// The state at its beginning.
    pub fn beginning(&self) -> &Instant {
        &self.instants[0]
    }

    /// The state at its end, before the impact.
    pub fn end(&self) -> &Instant {
        &self.instants[self.instants.len() - 1]
    }
}

/// Local parameters of a half step: see `stance`.
fn parameters(gait: &dyn Gait, h: &HalfStep, mode: Mode, layout: &Layout) -> Vec<f64> {
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

impl Landing {
    fn new(gait: &dyn Gait, mode: Mode, state: State, betad: [f64; 2]) -> Landing {
        let d = gait.description();
        let mut placement = d.shape(mode).placement.zeros();
        gait.placement(mode, &state.q, &mut placement);
        let mut touchdown = d.shapes.touchdown.zeros();
        let lands = mode.swinging().next().unwrap_or_default();
        gait.touchdown(lands, &state.q, &state.qd, &mut touchdown);
        Landing {
            height: d.shape(mode).placement.swing_q.row(&placement, UP).to_vec(),
            impact: d.shapes.touchdown.qd_plus_w.of(&touchdown).to_vec(),
            state,
            betad,
        }
    }

    /// What a change of (q, q̇⁻) does to q̇⁺.
    pub fn impact(&self, by_q: &[f64], by_qd: &[f64]) -> Vec<f64> {
        let rows = self.impact.chunks(2 * by_q.len());
        rows.map(|row| dot(&row[..by_q.len()], by_q) + dot(&row[by_q.len()..], by_qd)).collect()
    }

    /// Speed at which the foot comes down, m/s; negative.
    pub fn speed(&self) -> f64 {
        dot(&self.height, &self.state.qd)
    }
}

impl Start {
    fn new(gait: &dyn Gait, h: &HalfStep, mode: Mode) -> Start {
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
            sigmad: d.shape(mode).momentum_terms.sigmadot.value(&terms),
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
    d.shape(mode).inverse.xdd.of(&inverse)[d.positions()..].to_vec()
}
