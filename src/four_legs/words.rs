//! The verdict on the real legs in words.

use super::receipt::{BALANCED, RealLegs, Remainder, Verdict, Worst};

impl Verdict {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::EqualShares => "equal shares",
            Verdict::UnequalShares => "unequal shares",
            Verdict::BeyondLimits => "beyond limits",
            Verdict::NoEquilibrium => "no equilibrium",
        }
    }
}

impl RealLegs {
    /// One sentence: whether the real legs can, and how they share.
    pub fn sentence(&self) -> String {
        match self.verdict() {
            Verdict::EqualShares => "each leg of a pair does its equal share, within all limits".into(),
            Verdict::UnequalShares => {
                format!(
                    "unequal shares keep to all limits; one foot carries up to {:.0} % of the load",
                    100.0 * self.largest_load
                )
            }
            Verdict::BeyondLimits if self.support.margin < self.impact.margin => {
                format!("no shares keep to all limits in {:.1} % of the step", 100.0 * self.impossible)
            }
            Verdict::BeyondLimits => "no shares of the impact keep to all limits".into(),
            Verdict::NoEquilibrium => {
                let Remainder { support, impact } = self.best_shares;
                let lack = if support > BALANCED {
                    format!("the platform's balance lacks {support:.1e} of the robot's weight")
                } else {
                    format!("the balance of the impact lacks {impact:.1e} of the robot's momentum at 1 m/s")
                };
                format!("the real legs cannot move so: {lack}")
            }
        }
    }
}

impl Worst {
    /// Margin, time and what is in the way.
    pub fn words(&self) -> String {
        let limits: Vec<&str> = self.binding.iter().map(|b| b.limit.as_str()).collect();
        format!("{:.4} (half step {}, t = {:.3} s: {})", self.margin, self.half_step, self.time, limits.join(", "))
    }
}
