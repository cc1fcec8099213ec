//! What to change to lower the criterion: the slopes of the optimum, ranked.

use crate::result::GaitResult;
use crate::sensitivity::Sensitivity;
use maud::{Markup, html};

/// Rows that are shown at once.
const SHOWN: usize = 12;

pub fn section(r: &GaitResult) -> Markup {
    let Some(sensitivities) = &r.sensitivities else { return html! {} };
    let (effective, idle): (Vec<_>, Vec<_>) = sensitivities.slopes.iter().partition(|s| s.slope != 0.0);
    let unit = r.criterion.unit();
    html! {
        div.receipt {
            h3 { "What to change" }
            p { "How the least " (r.criterion.name()) " moves with every number of the specification, as the motion adapts. Numbers that must stay alike for the gait (in braces) change together, by the same share. The elasticity is in percent of the criterion per percent of the number; where it is negative, a larger number, farther from zero, is better." }
            div.scroll { table {
                thead { tr { th { "number" } th.n { "value" } th.n { "elasticity" } th.n { "slope" } } }
                tbody { @for s in effective.iter().take(SHOWN) { (row(s, unit)) } }
            } }
            @if effective.len() > SHOWN {
                details { summary { "Smaller ones" } div.scroll { table { tbody { @for s in &effective[SHOWN..] { (row(s, unit)) } } } } }
            }
            @if !idle.is_empty() { p.note { (idle.len()) " more numbers, limits with room to spare most of all, have no influence here." } }
            @if !sensitivities.one_sided.is_empty() {
                p.note { "Active without a price, so that slopes may hold to one side only: " (sensitivities.one_sided.join(", ")) "." }
            }
        }
    }
}

fn row(s: &Sensitivity, unit: &str) -> Markup {
    let per = if s.unit.is_empty() { String::new() } else { format!(" per {}", s.unit) };
    html! {
        tr { td { (s.parameter) } td.n { (significant(s.value)) " " (s.unit) }
            td.n { b { (significant(s.elasticity)) } } td.n { (significant(s.slope)) " " (unit) (per) } }
    }
}

/// Four significant digits, with the minus sign of a reader.
fn significant(value: f64) -> String {
    let digits = if value == 0.0 { 0.0 } else { 3.0 - value.abs().log10().floor() };
    format!("{value:.*}", digits.clamp(0.0, 9.0) as usize).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_of_anything() {
        let written = [6600.0, 0.139, -0.261_84, 0.0, 12_345.6, 0.000_412_34].map(significant);
        assert_eq!(written, ["6600", "0.1390", "−0.2618", "0", "12346", "0.0004123"]);
    }
}
