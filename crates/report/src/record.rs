//! A result beside its verdict. A report says nothing of a motion but what was derived from it.

use piaffe_model::Gait;
use piaffe_optimizer::audit::Audit;
use piaffe_optimizer::readback::Readback;
use piaffe_optimizer::result::GaitResult;

/// A result, and what is known of it. Of a confirmed one all is derived but the question and the search's own account.
pub struct Record<'a> {
    pub result: GaitResult,
    pub standing: Standing<'a>,
    /// What tells its robot from others on the same page, where there are such.
    pub design: Option<String>,
}

/// What became of a result when it was derived anew.
pub enum Standing<'a> {
    /// The motion is an optimum of this gait, and does all that the result states.
    Confirmed(&'a dyn Gait),
    /// It is not, or could not be looked at, for this reason.
    NotConfirmed(String),
    /// It states no optimum. That none was found is a statement about a search, which nothing confirms, unless the limits say so themselves.
    NoOptimum,
}

impl<'a> Record<'a> {
    /// A result that this program has just issued, and examined: by the same verdict.
    pub fn issued(result: GaitResult, gait: &'a dyn Gait) -> Record<'a> {
        let standing = if result.is_optimal() { Standing::Confirmed(gait) } else { Standing::NoOptimum };
        Record { result, standing, design: None }
    }

    /// Names its robot on a page of several.
    pub fn named(self, design: Option<String>) -> Record<'a> {
        Record { design, ..self }
    }

    /// What tells its walk from others: the gait, whether its limits hold at each real leg, and which robot it is.
    pub fn variant(&self) -> String {
        let legs = if self.result.limits_at_real_legs { " at real legs" } else { "" };
        let design = self.design.iter().map(|design| format!(", {design}"));
        self.result.gait.clone() + legs + &design.collect::<String>()
    }

    /// Derives a result that comes from elsewhere anew.
    pub fn read(stated: GaitResult, gaits: &[&'a dyn Gait]) -> Record<'a> {
        if !stated.is_optimal() {
            let standing = match Audit::of(&stated, gaits).objection() {
                Some(why) => Standing::NotConfirmed(format!("{} is not confirmed: {why}", stated.name())),
                None => Standing::NoOptimum,
            };
            return Record { result: stated, standing, design: None };
        }
        let (result, standing) = match Readback::new(stated.clone(), gaits) {
            Ok(Readback { result, gait, .. }) => (result, Standing::Confirmed(gait)),
            Err(unusable) => (stated, Standing::NotConfirmed(unusable.to_string())),
        };
        Record { result, standing, design: None }
    }

    /// A result of a gait that cannot be had, and why.
    pub fn unreadable(stated: GaitResult, why: String) -> Record<'a> {
        Record { result: stated, standing: Standing::NotConfirmed(why), design: None }
    }

    /// The gait of a confirmed optimum.
    pub fn gait(&self) -> Option<&'a dyn Gait> {
        match self.standing {
            Standing::Confirmed(gait) => Some(gait),
            _ => None,
        }
    }

    pub fn is_confirmed(&self) -> bool {
        self.gait().is_some()
    }

    /// Energy per weight and distance of the motion, whatever it minimizes: comparable from robot to robot.
    pub fn cost_of_transport(&self) -> Option<f64> {
        Some(self.gait()?.description().cost_of_transport(&self.result.costs?))
    }

    /// Why nothing is shown of it.
    pub fn reason(&self) -> Option<String> {
        match &self.standing {
            Standing::Confirmed(_) => None,
            Standing::NotConfirmed(reason) => Some(reason.clone()),
            Standing::NoOptimum => {
                Some(format!("{} is no optimum ({}): it has no walk", self.result.name(), self.result.message))
            }
        }
    }
}
