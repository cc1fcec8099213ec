//! Gaits beside each other: which is better for the same question, by how much, and what makes the difference.

use super::marks::marks;
use super::number::{digits, given, significant};
use super::page::{capital, durations};
use super::subject::{Subject, spaced};
use maud::{Markup, html};
use piaffe_model::motion::Criterion;
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::walk::Moment;

/// Limits that are named.
const NAMED: usize = 3;

/// A table for every question that more than one of these answer, the best first.
pub fn section(subjects: &[&Subject]) -> Markup {
    let mut questions: Vec<(Criterion, f64, Vec<&Subject>)> = Vec::new();
    for s in subjects {
        let (criterion, speed) = (s.result.criterion, s.result.speed);
        match questions.iter_mut().find(|q| (q.0, q.1) == (criterion, speed)) {
            Some(question) => question.2.push(s),
            None => questions.push((criterion, speed, vec![s])),
        }
    }
    questions.retain(|q| q.2.len() > 1);
    questions.iter_mut().for_each(|q| q.2.sort_by(|a, b| a.cost.total_cmp(&b.cost)));
    html! {
        @for (criterion, speed, list) in &questions { (question(*criterion, *speed, list)) }
    }
}

fn question(criterion: Criterion, speed: f64, list: &[&Subject]) -> Markup {
    let most = list.iter().map(|s| s.cost).fold(0.0, f64::max);
    html! {
        h3 { "Least " (criterion.name()) " at " (given(speed)) " m/s" }
        div.scroll { table.compare {
            thead { tr {
                th { "gait" } th.n { "cost, " (criterion.unit()) } th { "against the best" } th.n { "cost of transport" }
                th { "phases, s" } th.n { "travel, m" } th { "spent by" } th { "held by" } th { "between the instants" } th { "real legs" }
            } }
            tbody { @for s in list { (row(s, list[0].cost, most)) } }
        } }
    }
}

fn row(s: &Subject, best: f64, most: f64) -> Markup {
    let [_, between, real] = marks(&s.result);
    html! {
        tr {
            td { a href=(format!("#{}", s.id)) { (capital(&s.variant)) } }
            td.n { b { (digits(s.cost, 6)) } }
            td { span.bar.long { span style=(format!("width:{:.1}%", 100.0 * s.cost / most)) {} } " "
                @if s.cost == best { "the best" } @else { (against(s.cost / best)) } }
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
