//! The certificate in words: what is proven for all times, and where the proof ends.

use super::number::{digits, scientific};
use maud::{Markup, html};
use piaffe_verify::certificate::{Certificate, Gap};

pub fn section(c: &Certificate) -> Markup {
    let pieces: usize = c.phases.iter().map(|h| h.evaluations).sum();
    let width = c.phases.iter().map(|h| h.width[0]).fold(0.0, f64::max);
    html! {
        h3 { "Between the instants" }
        @if c.is_certified() {
            p { b { "Certified." } " At no time of the step, however short, is any limit broken by more than " (scientific(c.tolerance))
                ". That is not sampled but proven, with bounds for everything that arithmetic loses: on " (pieces)
                " pieces of the step, all limits as functions of time; β is known to within " (scientific(width)) " rad at the end." }
        } @else {
            p { b { "Sampled." } " The limits hold where the receipt looked, but could not be proven to hold by "
                (scientific(c.tolerance)) " at all times:" }
            ul { @for gap in &c.gaps { (unproven(gap)) }
                @match c.cycle_error {
                    Some(error) if error > c.tolerance => { li { "the cycle closes only to within " (scientific(error)) "." } }
                    _ => {}
                } }
        }
        details { summary { "Proven bounds" } div.scroll { table {
            thead { tr { th { "limit" } th.n { "phase" } th.n { "the margin is never below" } } }
            tbody { @for bound in &c.bounds { tr {
                td { (bound.constraint) } td.n { (bound.phase) }
                td.n { @if let Some(margin) = bound.margin { (scientific(margin)) } @else { "–" } }
            } } }
        } } }
    }
}

fn unproven(gap: &Gap) -> Markup {
    let verdict = match (gap.violated, gap.bound) {
        (true, _) => "it is certainly broken there".to_string(),
        (false, Some(bound)) => format!("all that is proven is a margin of {bound:.1e}"),
        (false, None) => "nothing could be proven".to_string(),
    };
    html! {
        li { b { (gap.constraint) } ", phase " (gap.phase) ", from " (digits(gap.from, 6)) " to " (digits(gap.to, 6))
            " s: " (verdict) "." }
    }
}
