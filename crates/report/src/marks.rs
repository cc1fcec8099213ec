//! What stands behind a gait, in three marks: its receipt, what is proven between the instants, and whether the real legs can.

use super::number::significant;
use maud::{Markup, html};
use piaffe_optimizer::four_legs::Verdict;
use piaffe_optimizer::result::GaitResult;

/// One of the three, in a word or two, and in more of them.
pub struct Mark {
    /// What was looked at.
    pub what: &'static str,
    pub finding: Finding,
    pub word: String,
    pub more: String,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    Holds,
    Fails,
    /// Known in part, or not looked at.
    Open,
}

/// The marks of a confirmed optimum.
pub fn marks(r: &GaitResult) -> [Mark; 3] {
    [receipt(r), between(r), real_legs(r)]
}

fn receipt(r: &GaitResult) -> Mark {
    let more = r.receipt.as_ref().map_or(String::new(), |receipt| {
        let [violation, cycle] = [receipt.max_violation, receipt.cycle_error].map(|v| significant(v, 2));
        format!("largest violation {violation}, distance from a closed cycle {cycle}, at {} instants", receipt.grid)
    });
    Mark { what: "Receipt", finding: Finding::Holds, word: "holds".into(), more }
}

fn between(r: &GaitResult) -> Mark {
    let what = "Between the instants";
    match &r.certificate {
        Some(c) if c.is_certified() => {
            let more = format!("no limit is broken by more than {} at any time", significant(c.tolerance, 1));
            Mark { what, finding: Finding::Holds, word: "certified".into(), more }
        }
        Some(c) => {
            let mut names: Vec<&str> = c.gaps.iter().map(|gap| gap.constraint.as_str()).collect();
            names.dedup();
            let more = match names.as_slice() {
                [] => "the cycle is not proven to close".into(),
                names => format!("not proven at all times: {}", names.join(", ")),
            };
            Mark { what, finding: Finding::Open, word: "sampled".into(), more }
        }
        None => open(r, what, "certificate"),
    }
}

fn real_legs(r: &GaitResult) -> Mark {
    let what = "Real legs";
    let Some(legs) = &r.real_legs else { return open(r, what, "real_legs") };
    let finding = match legs.verdict() {
        Verdict::EqualShares | Verdict::UnequalShares => Finding::Holds,
        Verdict::BeyondLimits | Verdict::NoEquilibrium => Finding::Fails,
    };
    Mark { what, finding, word: legs.verdict().name().into(), more: legs.sentence() }
}

/// What was not looked at, and why.
fn open(r: &GaitResult, what: &'static str, entry: &str) -> Mark {
    let reason = r.not_examined.iter().find(|open| open.entry == entry).map(|open| open.reason.clone());
    Mark { what, finding: Finding::Open, word: "not examined".into(), more: reason.unwrap_or_default() }
}

impl Mark {
    fn class(&self) -> &'static str {
        match self.finding {
            Finding::Holds => "holds",
            Finding::Fails => "fails",
            Finding::Open => "open",
        }
    }

    /// The word alone, for a table; the rest where one points.
    pub fn brief(&self) -> Markup {
        html! { span class=(self.class()) title=[(!self.more.is_empty()).then_some(&self.more)] { (self.word) } }
    }
}

/// All three at the head of a gait.
pub fn head(r: &GaitResult) -> Markup {
    html! {
        ul.marks { @for mark in marks(r) {
            li { span.what { (mark.what) } " " b class=(mark.class()) { (mark.word) }
                @if !mark.more.is_empty() { span.more { (mark.more) } } }
        } }
    }
}
