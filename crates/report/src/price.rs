//! What holds the optimum where it is: the multipliers, in words.

use super::number::{digits, scientific};
use super::words::meaning;
use maud::{Markup, html};
use piaffe_optimizer::result::GaitResult;

/// Limits that are named.
const NAMED: usize = 6;

pub fn section(r: &GaitResult) -> Markup {
    let Some(optimality) = &r.optimality else { return html! {} };
    let unit = r.criterion.unit();
    html! {
        div.receipt {
            h3 { "What holds the optimum" }
            p { "Multipliers fitted to the gradients at this motion leave " (scientific(optimality.residual())) " of the first-order conditions. A multiplier is a price: what the criterion gains per natural unit by which a limit is loosened." }
            @if optimality.limits.is_empty() { p { "No limit has a price: only the cycle and the speed hold it." } }
            div.scroll { table { tbody { @for p in optimality.limits.iter().take(NAMED) {
                tr { td { b { (p.constraint) } } td { "phase " (p.phase) " at " (digits(p.time, 3)) " s" }
                    td.n { (digits(p.value.abs(), 4)) " " (unit) } td { (meaning(&p.constraint)) } }
            } } } }
            @if optimality.limits.len() > NAMED { p.note { (optimality.limits.len() - NAMED) " more are in the result file." } }
        }
    }
}
