//! What is told about an optimum beyond its verdict: what takes longer than finding it.

use crate::finite::not_finite;
use crate::four_legs::RealLegs;
use crate::result::{GaitResult, NotExamined};
use crate::sensitivity::sensitivities;
use crate::stability::stability;
use piaffe_model::Gait;
use serde::Serialize;
use std::fmt::Display;

/// How closely an optimum is looked at. Its receipt and the first-order conditions are looked at in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Examination {
    /// No more than that.
    None,
    /// Slopes of the least criterion and stability too: less than what the search takes.
    Quick,
    /// The certificate and the real legs too.
    #[default]
    Full,
}

impl Examination {
    pub const ALL: [Examination; 3] = [Examination::None, Examination::Quick, Examination::Full];

    pub fn name(self) -> &'static str {
        match self {
            Examination::None => "none",
            Examination::Quick => "quick",
            Examination::Full => "full",
        }
    }

    /// As its name says.
    pub fn by_name(name: &str) -> Option<Examination> {
        Examination::ALL.into_iter().find(|examination| examination.name() == name)
    }
}

impl GaitResult {
    /// Adds what the gait was derived from, and what is found about the motion if it is an optimum.
    ///
    /// Each entry follows from the description and the motion alone. What cannot be derived, or has a number
    /// that is none, stays absent, and [`GaitResult::not_examined`] says so.
    pub fn examine(&mut self, gait: &dyn Gait, examination: Examination) {
        self.specification = gait.specification().cloned();
        let Some(motion) = self.motion() else { return };
        let (quick, full) = (examination != Examination::None, examination == Examination::Full);
        let (legs, (slopes, pushed)) = rayon::join(
            || full.then(|| RealLegs::new(gait, &motion)),
            || {
                let slopes = || quick.then(|| sensitivities(gait, self.criterion, self.speed, &motion));
                rayon::join(slopes, || quick.then(|| stability(gait, &motion)))
            },
        );
        let mut open = Vec::new();
        if full && self.certificate.is_none() {
            open.push(NotExamined { entry: "certificate".into(), reason: "nothing could be enclosed".into() });
        }
        self.stability = pushed.and_then(|found| told(found, "stability", &mut open));
        self.real_legs = legs.and_then(|found| told(found, "real_legs", &mut open));
        self.sensitivities = slopes.and_then(|found| told(found, "sensitivities", &mut open));
        let unasked = self.absent(&format!("not asked for (--examine {})", examination.name()));
        for absent in unasked {
            if open.iter().all(|said| said.entry != absent.entry) {
                open.push(absent);
            }
        }
        self.not_examined = open;
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

/// What was found, if all of its numbers are numbers; else it is open why it is absent.
fn told<T: Serialize, E: Display>(found: Result<T, E>, entry: &str, open: &mut Vec<NotExamined>) -> Option<T> {
    let found = found.map_err(|reason| reason.to_string()).and_then(|found| match not_finite(&found) {
        None => Ok(found),
        Some(place) => Err(format!("{place} is not a finite number")),
    });
    let note = |reason| open.push(NotExamined { entry: entry.into(), reason });
    found.map_err(note).ok()
}
