//! The one verdict: whether a motion is an optimum of what was asked, from the question and the motion alone.
//!
//! Whoever issues a result, reads one back or audits it asks here, so that what the program gives out is what it
//! confirms. Three things must hold: the receipt (independent integration, limits on a dense grid), the first-order
//! conditions with multipliers fitted anew, and that the certificate proves no limit broken between the instants of the
//! receipt. That a certificate is incomplete (sampled) is no reason against an optimum; it is said beside it.

use crate::constraints::sharing::applies;
use crate::four_legs::RealLegs;
use crate::optimality::{KKT_RESIDUAL, Optimality, optimality};
use piaffe_model::Gait;
use piaffe_model::motion::{Criterion, Motion};
use piaffe_verify::certificate::{Certificate, certify};
use piaffe_verify::{Receipt, VerifyError, verify};

/// Largest violation and cycle error with which a motion counts as an optimum; and see [`KKT_RESIDUAL`].
pub const VIOLATION: f64 = 1e-6;
pub const CYCLE_ERROR: f64 = 1e-6;
/// Points per phase on which the constraints are checked.
pub const GRID: usize = 2001;

/// What was found of a motion; see the [module](self).
#[derive(Clone, Debug)]
pub struct Verdict {
    pub receipt: Receipt,
    /// Absent where the optimizer's equations admit no such motion.
    pub optimality: Option<Optimality>,
    /// Absent where the verdict is clear without it, and where nothing could be enclosed.
    pub certificate: Option<Certificate>,
    /// Why the motion is no optimum; empty if it is one.
    pub reasons: Vec<String>,
}

impl Verdict {
    /// Judges a motion that is said to minimize `criterion` at the mean `speed` (m/s).
    ///
    /// # Errors
    /// If the motion does not have the numbers that the gait needs, or cannot be followed to its end.
    pub fn new(gait: &dyn Gait, criterion: Criterion, speed: f64, motion: &Motion) -> Result<Verdict, VerifyError> {
        let mut verdict = Verdict::by_receipt(gait, criterion, speed, motion)?;
        // The longest look is spared where it can change nothing.
        if verdict.is_optimal() {
            verdict.certificate = certify(gait.description(), motion, speed).ok();
            verdict.reasons.extend(verdict.certificate.iter().flat_map(broken));
        }
        Ok(verdict)
    }

    /// The same without a certificate, which takes many times as long as all else: what is between the receipt's instants stays
    /// open.
    ///
    /// # Errors
    /// As [`Verdict::new`].
    pub fn by_receipt(
        gait: &dyn Gait,
        criterion: Criterion,
        speed: f64,
        motion: &Motion,
    ) -> Result<Verdict, VerifyError> {
        let receipt = receipt(gait, speed, motion)?;
        let optimality = optimality(gait, criterion, speed, motion).ok();
        let mut verdict = Verdict { receipt, optimality, certificate: None, reasons: Vec::new() };
        verdict.must("the largest violation", verdict.receipt.max_violation, VIOLATION);
        verdict.must("the cycle error", verdict.receipt.cycle_error, CYCLE_ERROR);
        verdict.must("the KKT residual", verdict.kkt_residual().unwrap_or(f64::INFINITY), KKT_RESIDUAL);
        Ok(verdict)
    }

    pub fn is_optimal(&self) -> bool {
        self.reasons.is_empty()
    }

    /// Residual of the first-order conditions (KKT), where they can be looked at.
    pub fn kkt_residual(&self) -> Option<f64> {
        self.optimality.as_ref().map(Optimality::residual).filter(|residual| residual.is_finite())
    }

    fn must(&mut self, what: &str, value: f64, limit: f64) {
        if value.is_nan() || value > limit {
            self.reasons.push(format!("{what} is {value:.1e}, not {limit:.0e} or less"));
        }
    }
}

/// The receipt of a motion, with the costs that are minimized.
///
/// # Errors
/// As [`Verdict::new`].
pub fn receipt(gait: &dyn Gait, speed: f64, motion: &Motion) -> Result<Receipt, VerifyError> {
    let mut receipt = verify(gait.description(), motion, speed, GRID)?;
    if applies(gait.description())
        && let Ok(legs) = RealLegs::new(gait, motion)
    {
        // What was minimized is the real joints' cost, which the whole robot's equations tell.
        receipt.costs = legs.costs.proportional;
    }
    Ok(receipt)
}

/// What a certificate proves broken, in words.
fn broken(certificate: &Certificate) -> impl Iterator<Item = String> + '_ {
    certificate.gaps.iter().filter(|gap| gap.violated).map(|gap| {
        format!(
            "{} is certainly broken in phase {} between {:.6} and {:.6} s",
            gap.constraint, gap.phase, gap.from, gap.to
        )
    })
}
