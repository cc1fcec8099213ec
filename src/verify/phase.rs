//! One half step as a function of time: Q by eq. 15, β by integration, everything else from them.

use super::error::{VerifyError, check_half_step};
use super::integrate::{Solution, integrate};
use super::multibody::Vec3;
use super::polynomial::Polynomials;
use super::support::Support;
use crate::model::Description;
use crate::motion::HalfStep;

/// Error allowed in a step of the integration of (β, β̇), rad and rad/s.
pub const TOLERANCE: f64 = 1e-12;

/// A single support phase on `leg`.
pub struct Phase<'a> {
    pub leg: usize,
    pub duration: f64,
    /// 1-based, for messages.
    number: usize,
    support: Support<'a>,
    polynomials: Polynomials,
    /// (β, β̇) over time.
    beta: Solution<2>,
    cursor: usize,
}

/// All that happens at one instant. Positions and velocities are taken from the stance foot, in world axes.
#[derive(Clone, Debug)]
pub struct State {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Of every joint, N·m.
    pub torques: Vec<f64>,
    /// Reaction on the stance foot, N.
    pub force: Vec3,
    /// The platform's mass centre, m.
    pub platform: Vec3,
    /// The swing foot, m.
    pub swing: Vec3,
    pub swing_velocity: Vec3,
}

impl State {
    pub fn new(description: &Description) -> State {
        let (n, joints) = (description.orientations(), description.joints());
        let (q, zero) = (vec![0.0; n], Vec3::zeros());
        State {
            qd: q.clone(),
            qdd: q.clone(),
            q,
            torques: vec![0.0; joints],
            force: zero,
            platform: zero,
            swing: zero,
            swing_velocity: zero,
        }
    }

    fn prescribe(&mut self, description: &Description, polynomials: &Polynomials, t: f64) {
        for k in 0..description.prescribed() {
            let at = description.prescribed_index(k);
            [self.q[at], self.qd[at], self.qdd[at]] = polynomials.at(k, t);
        }
    }
}

impl<'a> Phase<'a> {
    /// Integrates β over half step `number`, 1-based.
    pub fn new(
        description: &'a Description,
        half_step: &HalfStep,
        leg: usize,
        number: usize,
    ) -> Result<Self, VerifyError> {
        check_half_step(half_step, description.prescribed(), number)?;
        let polynomials = Polynomials::new(half_step);
        let mut support = Support::new(description, leg);
        let mut state = State::new(description);
        let unactuated = description.unactuated;
        let rate = |t: f64, y: &[f64; 2]| {
            state.prescribe(description, &polynomials, t);
            state.q[unactuated] = y[0];
            state.qd[unactuated] = y[1];
            Some([y[1], support.accelerate(&state.q, &state.qd, &mut state.qdd)?])
        };
        let initial = [half_step.beta_initial, half_step.betad_initial];
        let beta = integrate(rate, 0.0, half_step.duration, initial, TOLERANCE)
            .map_err(|stop| VerifyError::stopped(stop, number))?;
        Ok(Phase { leg, duration: half_step.duration, number, support, polynomials, beta, cursor: 0 })
    }

    /// β and β̇ at the end.
    pub fn beta_end(&self) -> [f64; 2] {
        self.beta.end()
    }

    /// The state at time `t`; the times of successive calls must not decrease.
    pub fn at(&mut self, t: f64, state: &mut State) -> Result<(), VerifyError> {
        let description = self.support.multibody.description();
        state.prescribe(description, &self.polynomials, t);
        [state.q[description.unactuated], state.qd[description.unactuated]] = self.beta.at(t, &mut self.cursor);
        self.support
            .accelerate(&state.q, &state.qd, &mut state.qdd)
            .filter(|x| x.is_finite())
            .ok_or(VerifyError::Singular { half_step: self.number, time: t })?;
        state.force = self.support.torques(&state.qdd, &mut state.torques);
        let stance = self.support.multibody.foot(self.leg);
        let swing = self.support.multibody.foot(1 - self.leg);
        state.platform = -stance.position;
        state.swing = swing.position - stance.position;
        state.swing_velocity = swing.velocity - stance.velocity;
        if !description.lateral {
            // How deep the hips are does not matter in the plane.
            state.platform.z = 0.0;
            state.swing.z = 0.0;
        }
        Ok(())
    }
}
