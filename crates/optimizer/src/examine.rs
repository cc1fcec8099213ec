//! What is told about an optimum beyond its verdict: what takes longer than finding it.

use crate::finite::is_finite;
use crate::four_legs::RealLegs;
use crate::result::{GaitResult, NotExamined};
use crate::sensitivity::sensitivities;
use crate::stability::stability;
use piaffe_model::Gait;

impl GaitResult {
    /// Adds what the gait was derived from, and what is found about the motion if it is an optimum.
    ///
    /// Each entry follows from the description and the motion alone. What cannot be derived, or has a number
    /// that is none, stays absent, and [`GaitResult::not_examined`] says so.
    pub fn examine(&mut self, gait: &dyn Gait) {
        self.specification = gait.specification().cloned();
        let Some(motion) = self.motion() else { return };
        self.stability = stability(gait, &motion).ok().filter(is_finite);
        self.real_legs = RealLegs::new(gait, &motion).ok().filter(is_finite);
        self.sensitivities = sensitivities(gait, self.criterion, self.speed, &motion).filter(is_finite);
        self.not_examined = self.absent("cannot be derived for this motion with these limits");
    }

    /// The entries of an optimum that it has not, for this reason.
    pub(crate) fn absent(&self, reason: &str) -> Vec<NotExamined> {
        let entries = [
            ("certificate", self.certificate.is_none()),
            ("sensitivities", self.sensitivities.is_none()),
            ("stability", self.stability.is_none()),
            ("real_legs", self.real_legs.is_none()),
        ];
        let open = entries.into_iter().filter(|(_, absent)| *absent);
        open.map(|(entry, _)| NotExamined { entry: entry.into(), reason: reason.into() }).collect()
    }
}
