//! What is proven and told about an optimum beyond its receipt: what takes longer than finding it.

use crate::certificate::certify;
use crate::model::Gait;
use crate::result::GaitResult;

impl GaitResult {
    /// Examines the motion and adds what is found; one that is no optimum is left as it is.
    ///
    /// Each entry follows from the description and the motion alone.
    pub fn examine(&mut self, gait: &dyn Gait) {
        let Some(motion) = self.motion() else { return };
        self.certificate = certify(gait.description(), &motion, self.speed).ok();
    }
}
