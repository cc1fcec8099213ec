//! One phase as a function of time: Q by eq. 15, β by integration, everything else from them.

use super::contact::Contact;
use super::error::{VerifyError, check_course};
use super::instants::{Instants, State};
use super::integrate::{Solution, integrate};
use super::margins::Units;
use super::numbers::Numbers;
use piaffe_model::Description;
use piaffe_model::motion::Course;
use piaffe_number::Scalar;

/// Error allowed in a step of the integration of β, rad, and of β̇ in the unit of slow rates; relative where they are greater than 1.
pub const TOLERANCE: f64 = 1e-12;

/// A phase on one foot, or in flight.
pub struct Phase<'a, T: Scalar = f64> {
    /// s.
    pub duration: f64,
    /// 1-based, for messages.
    number: usize,
    instants: Instants<'a, T>,
    /// β, and β̇ in the unit of slow rates, over time.
    beta: Solution<2, T>,
    units: Units,
    cursor: usize,
}

impl<'a> Phase<'a> {
    /// Integrates β over phase `number`, 1-based, on such a contact.
    pub fn new(
        description: &'a Description,
        course: &Course,
        contact: impl Into<Contact>,
        number: usize,
    ) -> Result<Self, VerifyError> {
        Phase::with(description, Numbers::new(description), course, contact, number)
    }
}

impl<'a, T: Scalar> Phase<'a, T> {
    /// The same with numbers of one's own. Time is a plain number: derivatives in the duration are not carried along.
    pub fn with(
        description: &'a Description,
        numbers: Numbers<T>,
        course: &Course<T>,
        contact: impl Into<Contact<T>>,
        number: usize,
    ) -> Result<Self, VerifyError> {
        check_course(course, description.prescribed(), number)?;
        let mut instants = Instants::new(description, numbers, course, contact);
        let mut state = State::new(description);
        let units = Units::new(description);
        let rate = |t: f64, y: &[T; 2]| {
            let betad = y[1].scale(units.rate());
            Some([betad, instants.accelerate(t.into(), [y[0], betad], &mut state)?.scale(1.0 / units.rate())])
        };
        let initial = [course.beta_initial, course.betad_initial.scale(1.0 / units.rate())];
        let duration = course.duration.value();
        let beta =
            integrate(rate, 0.0, duration, initial, TOLERANCE).map_err(|stop| VerifyError::stopped(stop, number))?;
        Ok(Phase { duration, number, instants, beta, units, cursor: 0 })
    }

    pub fn description(&self) -> &'a Description {
        self.instants.description()
    }

    pub fn contact(&self) -> Contact<T> {
        self.instants.contact()
    }

    pub fn numbers(&self) -> &Numbers<T> {
        self.instants.numbers()
    }

    /// β and β̇ at the end.
    pub fn beta_end(&self) -> [T; 2] {
        let [beta, scaled] = self.beta.end();
        [beta, scaled.scale(self.units.rate())]
    }

    /// β and β̇ at time `t`; the times of successive calls must not decrease.
    pub fn beta(&mut self, t: f64) -> [T; 2] {
        let [beta, scaled] = self.beta.at(t, &mut self.cursor);
        [beta, scaled.scale(self.units.rate())]
    }

    /// The state at time `t`; the times of successive calls must not decrease.
    pub fn at(&mut self, t: f64, state: &mut State<T>) -> Result<(), VerifyError> {
        let beta = self.beta(t);
        let acceleration = self.instants.at(t.into(), beta, state);
        acceleration.filter(|x| x.value().is_finite()).map(drop).ok_or(self.singular(t))
    }

    /// The error of a state that does not exist at time `t`.
    pub fn singular(&self, t: f64) -> VerifyError {
        VerifyError::Singular { phase: self.number, time: t }
    }
}
