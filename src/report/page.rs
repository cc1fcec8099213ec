//! The page: everything in one file, to be opened, read and printed without a network.

use super::figure::Figure;
use super::font::Weight;
use super::subject::{Subject, spaced};
use super::words::meaning;
use super::{Report, certificate, ink, levers, player, price, real_legs, recovery, svg};
use crate::motion::Criterion;
use crate::result::{GaitResult, Status};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::{Value, json};

pub fn page(report: &Report) -> String {
    let title = title(report);
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(style())) }
            }
            body {
                header {
                    h1 { (title) }
                    p.lead { (lead(report)) }
                    (navigation(report))
                }
                main {
                    (overview(report))
                    @for (subject, figures) in &report.subjects { (section(subject, figures)) }
                }
                footer {
                    "Every number is that of the result files. Equations and figures are numbered as in Muraro, Chevallereau and Aoustin, "
                    i { "Multibody System Dynamics" } " 9(1), 2003. Made by piaffe " (env!("CARGO_PKG_VERSION")) "."
                }
                div #tip hidden {}
                script { (PreEscaped(include_str!("page.js"))) }
            }
        }
    };
    markup.into_string()
}

fn style() -> String {
    let fonts: String = Weight::ALL
        .iter()
        .map(|w| {
            let bytes = STANDARD.encode(w.bytes());
            format!("@font-face{{font-family:Inter;font-weight:{};src:url(data:font/otf;base64,{bytes})}}", w.number())
        })
        .collect();
    format!(
        "{fonts}:root{{{}}}@media (prefers-color-scheme:dark){{:root{{{}}}}}@media print{{:root{{{}}}}}{}{}",
        ink::variables(false),
        ink::variables(true),
        ink::variables(false),
        ink::page_rules(),
        include_str!("page.css")
    )
}

fn title(report: &Report) -> String {
    let robot = report.results.first().map_or("", |r| r.robot.as_str());
    match (&report.atlas, report.subjects.as_slice()) {
        (Some(_), _) => format!("Gaits of {robot} over speed"),
        (None, [(one, _)]) => format!("{} of {robot}, {}", capital(&one.result.gait), task(&one.result)),
        (None, [(one, _), ..]) => format!("Optimal gaits of {robot} at {} m/s", one.result.speed),
        (None, []) => format!("Gaits of {robot}"),
    }
}

fn capital(name: &str) -> String {
    let name = spaced(name);
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}

fn task(r: &GaitResult) -> String {
    format!("least {} at {} m/s", r.criterion.name(), r.speed)
}

fn lead(report: &Report) -> String {
    let optimal = report.results.iter().filter(|r| r.is_optimal()).count();
    let receipts = match (optimal, report.results.len()) {
        (1, 1) => "A local optimum whose receipt holds.".to_string(),
        (a, b) if a == b => format!("{a} local optima; the receipt of each holds."),
        (a, b) => format!("{b} searches, {a} local optima; the receipt of each of these holds."),
    };
    format!("{receipts} Point at a curve to read its values; click to move the walk there.")
}

fn navigation(report: &Report) -> Markup {
    html! {
        nav {
            @if report.results.len() > 1 { a href="#overview" { "Overview" } }
            @for (s, _) in &report.subjects {
                a href=(format!("#{}", s.result.name())) { (capital(&s.result.gait)) " · " (s.result.criterion.name()) }
            }
        }
    }
}

fn overview(report: &Report) -> Markup {
    if report.results.len() < 2 {
        return html! {};
    }
    html! {
        section #overview {
            h2 { "Overview" }
            @if let Some((atlas, figures)) = &report.atlas {
                (gallery("overview", figures))
                (script("overview", json!({ "figures": interactive(figures) })))
                ul {
                    @for criterion in Criterion::ALL {
                        @for x in atlas.crossings(criterion) {
                            li { "Least " (x.criterion.name()) ": the " (spaced(&x.faster)) " overtakes the " (spaced(&x.slower)) " at " (format!("{:.2}", x.speed)) " m/s." }
                        }
                    }
                    @for m in atlas.maximum_speeds() {
                        li { "The " (spaced(&m.gait)) " goes up to " (format!("{:.3}", m.speed)) " m/s"
                            @if let Some(why) = m.ended_by.first() { "; beyond that it fails on " (why) } "." }
                    }
                }
            }
            (table(report))
        }
    }
}

fn table(report: &Report) -> Markup {
    // Of a sweep the figures say it; the table is for looking up.
    html! {
        details open[report.atlas.is_none()] { summary { "All results" } div.scroll { table {
            thead { tr {
                th { "gait" } th { "least" } th.n { "speed, m/s" } th.n { "cost" } th.n { "half steps, s" } th.n { "step length, m" }
                th.n { "violation" } th.n { "cycle error" } th.n { "KKT residual" } th { "receipt" }
            } }
            tbody { @for r in &report.results { (row(report, r)) } }
        } } }
    }
}

fn row(report: &Report, r: &GaitResult) -> Markup {
    let shown = report.subjects.iter().any(|(s, _)| s.result.name() == r.name());
    let name = capital(&r.gait);
    let durations: Vec<String> = r.durations.iter().map(|t| format!("{t:.3}")).collect();
    html! {
        tr {
            td { @if shown { a href=(format!("#{}", r.name())) { (name) } } @else { (name) } }
            td { (r.criterion.name()) }
            td.n { (format!("{}", (r.speed * 1e4).round() / 1e4)) }
            @if let (Some(cost), Some(receipt)) = (r.cost, &r.receipt) {
                td.n { b { (format!("{cost:.4}")) } " " (r.criterion.unit()) }
                td.n { (durations.join(" / ")) }
                td.n { (r.step_length.map_or(String::new(), |l| format!("{l:.4}"))) }
                td.n { (scientific(receipt.max_violation)) }
                td.n { (scientific(receipt.cycle_error)) }
                td.n { (receipt.kkt_residual.map_or(html! { "–" }, scientific)) }
                td { span.holds { "holds" } }
            } @else {
                td colspan="6" { (r.message) }
                td { (if r.status == Status::Infeasible { "infeasible" } else { "none" }) }
            }
        }
    }
}

/// Powers of ten as a reader writes them.
pub(super) fn scientific(value: f64) -> Markup {
    if value == 0.0 {
        return html! { "0" };
    }
    let text = format!("{value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    html! { (mantissa.replace('-', "−")) "·10" sup { (exponent.replace('-', "−")) } }
}

fn section(s: &Subject, figures: &[Figure]) -> Markup {
    let r = &s.result;
    let name = r.name();
    html! {
        section.walk id=(name) {
            h2 { (capital(&r.gait)) " " small { (task(r)) } }
            div.top {
                div.stage {
                    svg viewBox="0 0 800 400" role="img" aria-label=(format!("Animation of the {}", spaced(&r.gait))) tabindex="0" {}
                    div.controls {
                        button.play type="button" aria-label="Play" { "▶" }
                        input.time type="range" min="0" max="1000" value="0" aria-label="Time in the step";
                        output {}
                        label { "speed "
                            select.speed { @for (value, text) in [("1", "1×"), ("0.5", "½×"), ("0.25", "¼×"), ("0.1", "⅒×"), ("0.03", "1/30×")] {
                                option value=(value) selected[value == "0.1"] { (text) }
                            } }
                        }
                        span.views role="group" aria-label="View" { @for view in ["side", "behind", "space"] {
                            button type="button" data-view=(view) { (view) }
                        } }
                    }
                    @for f in &figures[..1] { (drawing(&name, f)) }
                    p.note { "All real legs, to scale. Arrows are the reactions on each foot, dots the paths of the swinging feet. Drag to turn." }
                }
                (facts(s))
            }
            (gallery(&name, &figures[1..]))
            (receipt(r))
            (price::section(r))
            (levers::section(r))
            (recovery::section(r))
            (script(&name, json!({ "walk": player::data(s), "figures": interactive(figures) })))
        }
    }
}

fn facts(s: &Subject) -> Markup {
    let r = &s.result;
    let costs = r.costs;
    let other = Criterion::ALL.into_iter().find(|c| *c != r.criterion).unwrap_or(r.criterion);
    let durations: Vec<String> = r.durations.iter().map(|t| format!("{t:.4}")).collect();
    html! {
        div.facts {
            p.cost { (format!("{:.4}", s.cost)) " " span { (r.criterion.unit()) } }
            p.note { "least " (r.criterion.name()) " per metre of travel (eq. " (if r.criterion == Criterion::Energy { "14" } else { "13" }) ")" }
            dl {
                @if let Some(costs) = costs { dt { (other.name()) } dd { (format!("{:.4} {}", costs.of(other), other.unit())) } }
                dt { "half steps" } dd { (durations.join(" + ")) " s" }
                dt { "travel in them" } dd { (format!("{:.4}", r.step_length.unwrap_or(0.0))) " m" }
                @for leg in 0..2 { dt { "virtual leg " (leg + 1) } dd { (s.leg_name(leg)) } }
                dt { "local optima" } dd { (r.local_optima.len()) " from " (r.search.effort.starts) " starts" }
            }
            p.note { "Joints, peak against limit" }
            table.peaks { tbody { @for p in &r.peaks {
                tr { td { (p.name) } td { (bar(p.torque / p.max_torque)) } td.n { (format!("{:.1}", p.torque)) " N·m" }
                    td { (bar(p.speed / p.unloaded_speed)) } td.n { (format!("{:.2}", p.speed)) " rad/s" } }
            } } }
        }
    }
}

/// How much of a limit is used.
fn bar(share: f64) -> Markup {
    html! { span.bar title=(format!("{:.1} % of the limit", 100.0 * share)) { span style=(format!("width:{:.1}%", (100.0 * share).min(100.0))) {} } }
}

fn gallery(of: &str, figures: &[Figure]) -> Markup {
    html! {
        div.gallery { @for f in figures { (drawing(of, f)) } }
    }
}

fn drawing(of: &str, f: &Figure) -> Markup {
    html! {
        figure.wide[f.wide] data-figure=(format!("{of}/{}", f.name)) {
            div.scroll { (svg::inline(&f.scene, &f.title)) }
            figcaption { (f.caption) }
        }
    }
}

fn receipt(r: &GaitResult) -> Markup {
    let Some(receipt) = &r.receipt else { return html! {} };
    html! {
        div.receipt {
            h3 { "Receipt" }
            p { "Derived anew from the motion's numbers by an integration that shares nothing with the optimizer, at " (receipt.grid) " instants of each half step." }
            dl {
                dt { "largest violation of any limit" } dd { (scientific(receipt.max_violation)) " in natural units" }
                dt { "distance from a closed cycle" } dd { (scientific(receipt.cycle_error)) " rad, rad/s" }
                dt { "first-order optimality (KKT)" } dd { (receipt.kkt_residual.map_or(html! { "–" }, scientific)) }
            }
            @if let Some(c) = &r.certificate { (certificate::section(c)) }
            @if let Some(legs) = &r.real_legs { (real_legs::section(legs, r.criterion)) }
            h3 { "Limits without room to spare" }
            @if receipt.findings.is_empty() { p { "None: all limits have room." } }
            ul { @for f in &receipt.findings {
                li { b { (f.constraint) } ", half step " (f.half_step) " at " (format!("{:.3}", f.time)) " s. " (meaning(&f.constraint)) }
            } }
        }
    }
}

fn interactive(figures: &[Figure]) -> Value {
    figures.iter().filter_map(|f| Some((f.name.clone(), f.data.clone()?))).collect::<serde_json::Map<_, _>>().into()
}

/// Data for the page's script. Nothing in it can end the element.
fn script(of: &str, data: Value) -> Markup {
    html! { script type="application/json" data-of=(of) { (PreEscaped(data.to_string().replace('<', "\\u003c"))) } }
}
