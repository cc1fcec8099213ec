//! What is proven and told about an optimum beyond its receipt: what takes longer than finding it.

use crate::certificate::certify;
use crate::four_legs::RealLegs;
use crate::model::Gait;
use crate::optimality::optimality;
use crate::result::GaitResult;
use crate::sensitivity::sensitivities;
use crate::stability::stability;

impl GaitResult {
    /// Examines the motion and adds what is found; one that is no optimum is left as it is.
    ///
    /// Each entry follows from the description and the motion alone.
    pub fn examine(&mut self, gait: &dyn Gait) {
        let Some(motion) = self.motion() else { return };
        self.certificate = certify(gait.description(), &motion, self.speed).ok();
        self.stability = stability(gait, &motion).ok();
        self.optimality = optimality(gait, self.criterion, self.speed, &motion).ok();
        self.real_legs = RealLegs::new(gait, &motion).ok();
        self.sensitivities = sensitivities(gait, self.criterion, self.speed, &motion);
    }
}
