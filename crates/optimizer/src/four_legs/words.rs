//! The verdict on the real legs in words.

use super::lack::{Component, Lack};
use super::lift::{Lift, Sharing};
use super::receipt::{LEAST_MARGIN, Lacks, RealLegs, Verdict, Worst};
use crate::constraints::sharing::{self, BALANCED};
use crate::result::GaitResult;
use piaffe_model::Description;
use piaffe_model::motion::Criterion;

/// What is lacking beyond this is no rounding.
const ROUNDING: f64 = 1e-9;

/// Costs that differ by a smaller part are the same: they are sums over instants.
const SAME_COST: f64 = 1e-6;

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
        let Lacks { support, impact } = self.best_shares;
        let lack = match self.verdict() {
            Verdict::NoEquilibrium => None,
            _ if support.share > ROUNDING => Some(support.words()),
            _ if impact.share > ROUNDING => Some(impact.words_of_impact()),
            _ => None,
        };
        let sentence = self.whether();
        lack.map_or(sentence.clone(), |lack| {
            format!("{sentence}; {lack} that is lacking is within what is known of masses")
        })
    }

    fn whether(&self) -> String {
        match self.verdict() {
            Verdict::EqualShares => "each leg of a pair does its equal share, within all limits".into(),
            Verdict::UnequalShares if self.equal_shares.support.share <= BALANCED => {
                "equal shares between impacts and unequal ones at them keep to all limits".into()
            }
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
                let Lacks { support, impact } = self.best_shares;
                let lack = if support.share > BALANCED { support.words() } else { impact.words_of_impact() };
                format!("the real legs cannot move so: {lack} is lacking")
            }
        }
    }
}

impl RealLegs {
    /// What the real joints cost in the result's criterion, beside what the virtual legs' joints do.
    pub fn cost(&self, result: &GaitResult, d: &Description) -> String {
        let criterion = result.criterion;
        // Where no shares are within the limits all the time, the least of any is a bound.
        let (cost, how) = if self.support.margin >= LEAST_MARGIN {
            (&self.costs.within_limits, "")
        } else {
            (&self.costs.least, "at least ")
        };
        let (real, without) = (cost.of(criterion), self.costs.virtual_legs.of(criterion));
        let more = real / without - 1.0;
        let beside = match more {
            more if more.abs() < SAME_COST => "as".into(),
            more if more < 0.0 => format!("{} % less than", percent(-more)),
            more => format!("{} % more than", percent(more)),
        };
        let (name, unit, real) =
            (criterion.name(), criterion.unit(), number(self.as_stated(real, criterion, result, d)));
        format!("{name} on the real joints {how}{real} {unit}, {beside} at the virtual legs'")
    }

    /// The same if each foot pushes in proportion to its load.
    pub fn cost_by_load(&self, result: &GaitResult, d: &Description) -> f64 {
        self.as_stated(self.costs.proportional.of(result.criterion), result.criterion, result, d)
    }

    /// What the shares of a lifted motion cost.
    pub fn cost_of(&self, lift: &Lift, sharing: Sharing, result: &GaitResult) -> String {
        let (d, costs) = (lift.legs.description, lift.costs());
        let each = Criterion::ALL.map(|criterion| {
            let cost = number(self.as_stated(costs.of(criterion), criterion, result, d));
            format!("{} {cost} {}", criterion.name(), criterion.unit())
        });
        let which = match sharing {
            Sharing::MostRoom => "the shares with the most room".into(),
            Sharing::LeastCost(criterion) => {
                let all_the_time = self.support.margin >= LEAST_MARGIN;
                let elsewhere = if all_the_time { "" } else { ", and where none do, those with the most room," };
                format!("the shares of least {} that keep to all limits{elsewhere}", criterion.name())
            }
        };
        format!("{which} cost on the real joints {}", each.join(", "))
    }

    /// Whether the shares of two lifted motions cost the same.
    pub fn costs_alike(&self, a: &Lift, b: &Lift) -> bool {
        let (a, b) = (a.costs(), b.costs());
        Criterion::ALL.into_iter().all(|c| (a.of(c) / b.of(c) - 1.0).abs() < SAME_COST)
    }

    /// Costs here are sums over instants, which compare with each other; beside the result's own, an integral, they are put in its
    /// proportion.
    fn as_stated(&self, cost: f64, criterion: Criterion, result: &GaitResult, d: &Description) -> f64 {
        let known = if sharing::applies(d) { &self.costs.proportional } else { &self.costs.virtual_legs };
        let scale = result.costs.map_or(1.0, |stated| stated.of(criterion) / known.of(criterion));
        if scale.is_finite() { cost * scale } else { cost }
    }
}

/// Four decimals, or five digits where these would be too many or too few.
fn number(x: f64) -> String {
    if (1e-2..1e7).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.4e}") }
}

impl Component {
    pub fn name(self) -> &'static str {
        match self {
            Component::ForwardForce => "forward force",
            Component::VerticalForce => "vertical force",
            Component::SidewaysForce => "sideways force",
            Component::SidewaysMoment => "sideways moment",
            Component::TurningMoment => "turning moment",
            Component::PitchingMoment => "pitching moment",
            Component::JointMoment => "moment at a joint",
        }
    }
}

impl Lack {
    /// As in "a sideways moment of 0.3 % of weight × leg length".
    pub fn words(&self) -> String {
        self.measured("weight")
    }

    /// The same of an impact.
    pub fn words_of_impact(&self) -> String {
        self.measured("momentum at √(g × leg length)")
    }

    fn measured(&self, unit: &str) -> String {
        let length = if self.of.is_moment() { " × leg length" } else { "" };
        format!("a {} of {} % of {unit}{length}", self.of.name(), percent(self.share))
    }
}

/// Two significant digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        // What rounding leaves of a zero.
        nothing if nothing < 1e-9 => "0".into(),
        small if small < 1e-3 => format!("{percent:.1e}"),
        size => format!("{percent:.*}", (1.0 - libm::log10(size).floor()).clamp(0.0, 4.0) as usize),
    }
}

impl Worst {
    /// Margin, time and what is in the way.
    pub fn words(&self) -> String {
        let limits: Vec<&str> = self.binding.iter().map(|b| b.limit.as_str()).collect();
        // No room at all has no sign.
        let margin = if self.margin.abs() < 5e-5 { 0.0 } else { self.margin };
        format!("{margin:.4} (phase {}, t = {:.3} s: {})", self.phase, self.time, limits.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::super::cost::Ways;
    use super::*;
    use piaffe_model::motion::Costs;

    #[test]
    fn a_share_has_two_digits_and_rounding_none() {
        let shares = [0.123, 0.00456, 1.2e-7, 1e-15, 0.0];
        assert_eq!(shares.map(percent), ["12", "0.46", "1.2e-5", "0", "0"]);
    }

    #[test]
    fn what_is_unequal_is_named() {
        let lack = |share| Lack { of: Component::PitchingMoment, share };
        let worst = || Worst { margin: 0.1, phase: 1, time: 0.0, binding: Vec::new() };
        let costs = Costs { energy: 1.0, torque: 1.0 };
        let of = |support: f64, impact: f64| RealLegs {
            equal_shares: Lacks { support: lack(support), impact: lack(impact) },
            best_shares: Lacks { support: Lack::NONE, impact: Lack::NONE },
            support: worst(),
            impact: worst(),
            costs: Ways { virtual_legs: costs, least: costs, within_limits: costs, proportional: costs },
            impossible: 0.0,
            largest_load: if support > 0.0 { 0.8 } else { 0.5 },
            instants: 1,
        };
        assert_eq!(of(0.0, 0.0).sentence(), "each leg of a pair does its equal share, within all limits");
        assert_eq!(of(0.0, 0.2).sentence(), "equal shares between impacts and unequal ones at them keep to all limits");
        assert!(of(0.2, 0.2).sentence().contains("one foot carries up to 80 % of the load"));
    }
}
