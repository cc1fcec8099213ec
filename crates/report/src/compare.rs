//! Gaits beside each other: which is better for the same question, by how much, and what makes the difference.

use super::marks::marks;
use super::number::{digits, given, significant};
use super::page::durations;
use super::subject::{Subject, capital, spaced};
use maud::{Markup, html};
use piaffe_model::motion::Criterion;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::walk::Moment;

/// Limits that are named.
const NAMED: usize = 3;

/// A table for every question that more than one of these answer, the best first.
pub fn section(subjects: &[&Subject]) -> Markup {
    let mut questions: Vec<Question> = Vec::new();
    for s in subjects {
        let (criterion, speed) = (s.result.criterion, s.result.speed);
        match questions.iter_mut().find(|q| (q.criterion, q.speed) == (criterion, speed)) {
            Some(question) => question.answers.push(s),
            None => questions.push(Question { criterion, speed, answers: vec![s] }),
        }
    }
    questions.retain(|q| q.answers.len() > 1);
    html! {
        @for question in &questions { (question.table()) }
    }
}

/// What several walks answer.
struct Question<'q> {
    criterion: Criterion,
    speed: f64,
    answers: Vec<&'q Subject<'q>>,
}

impl Question<'_> {
    /// Whether they are of several robots.
    fn is_of_several(&self) -> bool {
        self.answers.windows(2).any(|pair| pair[0].result.robot != pair[1].result.robot)
    }

    /// By what the best is told: robots of any size and weight compare by their cost of transport.
    fn measure(&self, s: &Subject) -> f64 {
        if self.is_of_several() { s.transport } else { s.cost }
    }

    fn table(&self) -> Markup {
        let mut list = self.answers.clone();
        list.sort_by(|a, b| self.measure(a).total_cmp(&self.measure(b)));
        let of = |s: &Subject| self.measure(s) / self.measure(list[0]);
        let most = list.iter().map(|s| of(s)).fold(0.0, f64::max);
        html! {
            h3 { "Least " (self.criterion.name()) " at " (given(self.speed)) " m/s" }
            @if self.is_of_several() { p.note { "Of several robots: the best is that of least cost of transport." } }
            div.scroll { table.compare {
                thead { tr {
                    th { "gait" } th.n { "cost, " (self.criterion.unit()) } th { "against the best" } th.n { "cost of transport" }
                    th { "phases, s" } th.n { "travel, m" } th { "spent by" } th { "held by" } th { "between the instants" } th { "real legs" }
                } }
                tbody { @for s in &list { (row(s, of(s), most)) } }
            } }
        }
    }
}

/// `ratio` is how much it takes of the best, `most` the largest of these.
fn row(s: &Subject, ratio: f64, most: f64) -> Markup {
    let [_, between, real] = marks(&s.result);
    html! {
        tr {
            td { a href=(format!("#{}", s.id)) { (capital(&s.variant)) } }
            td.n { b { (digits(s.cost, 6)) } }
            td { span.bar.long { span style=(format!("width:{:.1}%", 100.0 * ratio / most)) {} } " "
                @if ratio == 1.0 { "the best" } @else { (against(ratio)) } }
            td.n { (digits(s.transport, 3)) }
            td { (durations(&s.result)) }
            td.n { @if let Some(length) = s.result.step_length { (digits(length, 4)) } }
            td.lines { @for share in spent(s) { span { (share) } } }
            td.lines { (holders(&s.result)) }
            td { (between.brief()) }
            td { (real.brief()) }
        }
    }
}

/// A ratio above 1 in words.
fn against(ratio: f64) -> String {
    if ratio < 2.0 {
        format!("+{} %", significant(100.0 * (ratio - 1.0), 3))
    } else {
        format!("×{}", significant(ratio, 3))
    }
}

/// Which joints the criterion's integral comes from, and how much of it from the legs that stand.
fn spent(s: &Subject) -> Vec<String> {
    let rate = |m: &Moment, j: usize| match s.result.criterion {
        Criterion::Energy => (m.torque[j] * m.qd[j]).abs(),
        Criterion::Torque => m.torque[j] * m.torque[j],
    };
    let mut joints = vec![0.0; s.description().joints()];
    let mut standing = 0.0;
    for pair in s.walk.moments.windows(2).filter(|pair| pair[0].phase == pair[1].phase) {
        for (j, spent) in joints.iter_mut().enumerate() {
            let part = 0.5 * (pair[1].time - pair[0].time) * (rate(&pair[0], j) + rate(&pair[1], j));
            *spent += part;
            standing += if pair[0].mode.stance() == Some(s.leg_of(j)) { part } else { 0.0 };
        }
    }
    let all: f64 = joints.iter().sum();
    let share = |name: &str, part: f64| format!("{name} {:.0} %", 100.0 * part / all);
    let of_kinds = s.kinds(|_| ()).into_iter().map(|kind| {
        let part = kind.joints.iter().map(|j| joints[*j]).sum();
        share(&spaced(&kind.name), part)
    });
    of_kinds.chain([share("standing legs", standing)]).collect()
}

/// The limits with a price, the dearest first, each with the sum of its prices.
fn holders(r: &GaitResult) -> Markup {
    let Some(optimality) = &r.optimality else { return html! { span.open { "not examined" } } };
    let mut prices: Vec<(&str, f64)> = Vec::new();
    for price in &optimality.limits {
        match prices.iter_mut().find(|(name, _)| *name == price.constraint) {
            Some((_, sum)) => *sum += price.value.abs(),
            None => prices.push((&price.constraint, price.value.abs())),
        }
    }
    prices.sort_by(|a, b| b.1.total_cmp(&a.1));
    let more = prices.len().saturating_sub(NAMED);
    html! {
        @if prices.is_empty() { span { "nothing but the cycle" } }
        @for (name, price) in prices.iter().take(NAMED) { span { (name) ": " (digits(*price, 3)) } }
        @if more > 0 { span.note { (more) " more" } }
    }
}

/// What the columns mean that do not explain themselves.
pub fn legend() -> Markup {
    html! {
        p.note { "Cost of transport: E/(m g d), the motion's energy (C2) per weight and distance, whatever it minimizes: a number without a unit, "
            "by which robots of any size compare. Spent by: shares of the criterion's integral. Held by: limits and their prices, what the criterion gains "
            "per natural unit by which each is loosened." }
    }
}
