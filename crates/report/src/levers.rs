//! What to change to lower the criterion: the slopes of the optimum, ranked.

use super::number::{digits, given};
use maud::{Markup, html};
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::sensitivity::Sensitivity;

/// Rows that are shown at once.
const SHOWN: usize = 12;

pub fn section(r: &GaitResult) -> Markup {
    let Some(sensitivities) = &r.sensitivities else { return html! {} };
    let (effective, idle): (Vec<_>, Vec<_>) = sensitivities.slopes.iter().partition(|s| s.slope != 0.0);
    let (steep, effective): (Vec<_>, Vec<_>) = effective.into_iter().partition(|s| s.is_steep());
    let unit = r.criterion.unit();
    html! {
        div.receipt {
            h3 { "What to change" }
            p { "How the least " (r.criterion.name()) " moves with every number of the specification, as the motion adapts. Numbers that must stay alike for the gait (in braces) change together, by the same share. The elasticity is in percent of the criterion per percent of the number; where it is negative, a larger number, farther from zero, is better. A number that is zero has a slope alone." }
            div.scroll { table {
                thead { tr { th { "number" } th.n { "value" } th.n { "elasticity" } th.n { "slope" } } }
                tbody { @for s in effective.iter().take(SHOWN) { (row(s, unit)) } }
            } }
            @if effective.len() > SHOWN {
                details { summary { "Smaller ones" } div.scroll { table { tbody { @for s in &effective[SHOWN..] { (row(s, unit)) } } } } }
            }
            @if !steep.is_empty() {
                p.note { "Too steep for advice: " (names(&steep)) ". There the optimum stands at a corner, a leg stretched or folded to the last, say; the slope is that of the point alone." }
            }
            @if !idle.is_empty() { p.note { (idle.len()) " more numbers, limits with room to spare most of all, have no influence here." } }
            @if !sensitivities.one_sided.is_empty() {
                p.note { "Active without a price, so that slopes may hold to one side only: " (sensitivities.one_sided.join(", ")) "." }
            }
        }
    }
}

fn names(slopes: &[&Sensitivity]) -> String {
    slopes.iter().map(|s| s.parameter.as_str()).collect::<Vec<_>>().join(", ")
}

fn row(s: &Sensitivity, unit: &str) -> Markup {
    let per = if s.unit.is_empty() { String::new() } else { format!(" per {}", s.unit) };
    html! {
        tr { td { (s.parameter) } td.n { (given(s.value)) " " (s.unit) }
            td.n { b { @if s.value == 0.0 { "–" } @else { (digits(s.elasticity, 4)) } } } td.n { (digits(s.slope, 4)) " " (unit) (per) } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_zero_has_a_slope_and_no_elasticity() {
        let of = |value: f64| Sensitivity {
            parameter: "joints.knee.damping".into(),
            numbers: vec!["joints.knee.damping".into()],
            unit: "N·m·s".into(),
            value,
            slope: 2.0,
            elasticity: 0.5 * value,
        };
        let shown = |value| row(&of(value), "N").into_string();
        assert!(shown(0.0).contains("<b>–</b>") && shown(0.0).contains("2.000 N per"), "{}", shown(0.0));
        assert!(shown(1.0).contains("<b>0.5000</b>"), "{}", shown(1.0));
    }
}
