//! The page: everything in one file, to be opened, read and printed without a network.

use super::atlas::Atlas;
use super::figure::Figure;
use super::font::Weight;
use super::marks::marks;
use super::number::{digits, given, scientific, significant};
use super::space::Space;
use super::subject::{Subject, capital, spaced};
use super::words::meaning;
use super::{Record, Report, Standing};
use super::{certificate, compare, ink, levers, marks, player, price, real_legs, recovery, svg};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Then};
use piaffe_optimizer::result::GaitResult;
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
                div #tip role="status" hidden {}
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
    let mut robots: Vec<&str> = Vec::new();
    for record in report.records.iter().filter(|r| r.is_confirmed()) {
        if !robots.contains(&record.result.robot.as_str()) {
            robots.push(&record.result.robot);
        }
    }
    let robots = robots.join(" and ");
    let speeds: Vec<f64> = report.subjects.iter().map(|(s, _)| s.result.speed).collect();
    if let Some((space, _)) = &report.space {
        return format!("{} robots like {}", space.designs(), space.robot);
    }
    match (&report.atlas, report.subjects.as_slice()) {
        (Some(_), _) => format!("Gaits of {robots} over speed"),
        (None, [(one, _)]) => format!("{} of {robots}, {}", capital(&one.variant), task(&one.result)),
        (None, _) if speeds.windows(2).all(|pair| pair[0] == pair[1]) => {
            format!("Optimal gaits of {robots} at {} m/s", speeds.first().map_or(String::new(), |v| given(*v)))
        }
        (None, _) => format!("Optimal gaits of {robots}"),
    }
}

fn task(r: &GaitResult) -> String {
    format!("least {} at {} m/s", r.criterion.name(), given(r.speed))
}

/// Phases, s.
pub fn durations(r: &GaitResult) -> String {
    r.durations.iter().map(|t| significant(*t, 3)).collect::<Vec<_>>().join(" / ")
}

fn lead(report: &Report) -> String {
    let count = |is: fn(&Standing) -> bool| report.records.iter().filter(|r| is(&r.standing)).count();
    let confirmed = count(|s| matches!(s, Standing::Confirmed(_)));
    let not = count(|s| matches!(s, Standing::NotConfirmed(_)));
    let without = count(|s| matches!(s, Standing::NoOptimum));
    let of_space =
        report.space.iter().map(|(space, _)| space.lead() + " The walks of some are shown. ").collect::<String>();
    let mut text = of_space
        + &match confirmed {
            1 => "A local optimum, derived anew from its motion: its receipt holds.".to_string(),
            n => format!("{n} local optima, each derived anew from its motion: the receipt of each holds."),
        };
    text += &match not {
        0 => String::new(),
        1 => " One result could not be confirmed, and is not shown as an optimum.".into(),
        n => format!(" {n} results could not be confirmed, and are not shown as optima."),
    };
    text += &match without {
        0 => String::new(),
        1 => " One search found no optimum, by its own account.".into(),
        n => format!(" {n} searches found no optimum, by their own account."),
    };
    text + " Point at a curve to read its values; click to move the walk there."
}

fn navigation(report: &Report) -> Markup {
    let speeds: Vec<f64> = report.subjects.iter().map(|(s, _)| s.result.speed).collect();
    let several = speeds.windows(2).any(|pair| pair[0] != pair[1]);
    html! {
        nav {
            @if has_overview(report) { a href="#overview" { "Overview" } }
            @for (s, _) in &report.subjects {
                a href=(format!("#{}", s.id)) {
                    (capital(&s.variant)) " · " (s.result.criterion.name())
                    @if several { " · " (given(s.result.speed)) " m/s" }
                }
            }
        }
    }
}

fn has_overview(report: &Report) -> bool {
    report.records.len() > 1 || report.space.is_some()
}

fn overview(report: &Report) -> Markup {
    if !has_overview(report) {
        return html! {};
    }
    let subjects: Vec<&Subject> = report.subjects.iter().map(|(s, _)| s).collect();
    html! {
        section #overview {
            h2 { "Overview" }
            (refused(report))
            @if let Some((space, figures)) = &report.space { (of_space(space, figures)) }
            @if let Some((atlas, figures)) = &report.atlas {
                (gallery("overview", figures))
                (script("overview", json!({ "figures": interactive(figures) })))
                (findings(atlas))
            }
            (compare::section(&subjects))
            (table(report))
            (compare::legend())
        }
    }
}

/// The robots of a study: lines across axes, then what is better than all else, and which robots' walks follow.
fn of_space(space: &Space, figures: &[Figure]) -> Markup {
    html! {
        @for wide in [true, false] {
            div.gallery { @for f in figures.iter().filter(|f| f.wide == wide) { (drawing("overview", f)) } }
        }
        ul { @for robot in space.shown() { li { (robot) "." } } }
        (script("overview", json!({ "space": space.data(), "figures": interactive(figures) })))
    }
}

/// What could not be confirmed, each with the reason.
fn refused(report: &Report) -> Markup {
    let reason = |r: &'_ Record| match &r.standing {
        Standing::NotConfirmed(reason) => Some(reason.clone()),
        _ => None,
    };
    let refused: Vec<String> = report.records.iter().filter_map(reason).collect();
    html! {
        @if !refused.is_empty() {
            div.refused {
                h3 { "Not confirmed" }
                ul { @for reason in refused { li { (reason) "." } } }
            }
        }
    }
}

/// What the curves over speed say, in words.
fn findings(atlas: &Atlas) -> Markup {
    html! {
        ul {
            @for criterion in Criterion::ALL {
                @for x in atlas.crossings(criterion) {
                    li { "Least " (x.criterion.name()) ": the " (spaced(&x.faster)) " overtakes the " (spaced(&x.slower)) " " (x.place()) "."
                        @if x.at.is_none() { " In between, one of them jumps to another branch, or was not followed." } }
                }
            }
            @for f in atlas.fastest() {
                li { "The fastest optimum of the " (spaced(f.gait)) " is at " (significant(f.speed, 4)) " m/s."
                    @if f.is_greatest { " By its own account, which no motion confirms, the sweep found no faster motion." }
                    @if !f.active.is_empty() { " Without room to spare there: " (f.active.join(", ")) "." } }
            }
            @for m in atlas.unfounded() {
                li { b { "Not confirmed: " } "the sweep’s account says that the " (spaced(&m.gait)) " goes up to " (significant(m.speed, 4))
                    " m/s, but the fastest confirmed optimum here is another." }
            }
        }
    }
}

fn table(report: &Report) -> Markup {
    // Of a sweep the figures say it; the table is for looking up.
    html! {
        details open[report.atlas.is_none()] { summary { "All results" } div.scroll { table {
            thead { tr {
                th { "gait" } th { "least" } th.n { "speed, m/s" } th.n { "cost" } th.n { "cost of transport" } th { "receipt" } th { "between the instants" }
                th { "real legs" } th.n { "phases, s" } th.n { "travel, m" } th.n { "violation" } th.n { "cycle error" } th.n { "KKT residual" }
            } }
            tbody { @for r in &report.records { (row(report, r)) } }
        } } }
    }
}

fn row(report: &Report, record: &Record) -> Markup {
    let r = &record.result;
    let shown = report.subjects.iter().find(|(s, _)| s.result == *r);
    let name = capital(&record.variant());
    html! {
        tr {
            td { @if let Some((s, _)) = shown { a href=(format!("#{}", s.id)) { (name) } } @else { (name) } }
            td { (r.criterion.name()) }
            td.n { (given(r.speed)) }
            @match (&record.standing, r.cost, &r.receipt) {
                (Standing::Confirmed(_), Some(cost), Some(receipt)) => {
                    td.n { b { (digits(cost, 6)) } " " (r.criterion.unit()) }
                    td.n { @if let Some(transport) = record.cost_of_transport() { (digits(transport, 3)) } }
                    @for mark in marks(r) { td { (mark.brief()) } }
                    td.n { (durations(r)) }
                    td.n { @if let Some(length) = r.step_length { (digits(length, 4)) } }
                    td.n { (scientific(receipt.max_violation)) }
                    td.n { (scientific(receipt.cycle_error)) }
                    td.n { (receipt.kkt_residual.map_or(html! { "–" }, scientific)) }
                }
                (Standing::NotConfirmed(reason), ..) => { td colspan="10" { span.fails { "not confirmed" } " " (reason) } }
                _ => { td colspan="10" { span.open { "no optimum" } " " (r.message) } }
            }
        }
    }
}

fn section(s: &Subject, figures: &[Figure]) -> Markup {
    let r = &s.result;
    let name = &s.id;
    html! {
        section.walk id=(name) {
            h2 { (capital(&s.variant)) " " small { (task(r)) } }
            (marks::head(r))
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
                    @for f in &figures[..1] { (drawing(name, f)) }
                    p.note { "All real legs, to scale. Arrows are the reactions on each foot, dots the paths of the swinging feet. Drag to turn." }
                }
                (facts(s))
            }
            (gallery(name, &figures[1..]))
            (receipt(r, s.description()))
            (price::section(r))
            (levers::section(r))
            (recovery::section(r))
            (script(name, json!({ "walk": player::data(s), "figures": interactive(figures) })))
        }
    }
}

fn facts(s: &Subject) -> Markup {
    let r = &s.result;
    let costs = r.costs;
    let other = Criterion::ALL.into_iter().find(|c| *c != r.criterion).unwrap_or(r.criterion);
    let durations: Vec<String> = r.durations.iter().map(|t| significant(*t, 4)).collect();
    html! {
        div.facts {
            p.cost { (digits(s.cost, 6)) " " span { (r.criterion.unit()) } }
            p.note { "least " (r.criterion.name()) " per metre of travel (eq. " (if r.criterion == Criterion::Energy { "14" } else { "13" }) ")" }
            dl {
                dt { "cost of transport" } dd { (digits(s.transport, 4)) span.note { " E/(m g d)" @if r.criterion != Criterion::Energy { ", of this motion’s energy" } } }
                @if let Some(costs) = costs { dt { (other.name()) } dd { (digits(costs.of(other), 6)) " " (other.unit()) } }
                dt { "phases" } dd { (durations.join(" + ")) " s" }
                dt { "travel in them" } dd { (digits(r.step_length.unwrap_or(0.0), 4)) " m" @if s.description().then == Then::Mirrored { span.note { ", a half step" } } }
                @for leg in 0..2 { dt { "virtual leg " (leg + 1) } dd { (s.leg_name(leg)) } }
                dt { "local optima" } dd { (r.local_optima.len()) " from " (r.search.effort.starts) " starts" span.note { ", as the search says" } }
            }
            p.note { "Joints, peak against limit" }
            table.peaks { tbody { @for p in &r.peaks {
                tr { td { (p.name) } td { (bar(p.torque / p.max_torque)) } td.n { (digits(p.torque, 3)) " N·m" }
                    td { (bar(p.speed / p.unloaded_speed)) } td.n { (digits(p.speed, 3)) " rad/s" } }
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

fn receipt(r: &GaitResult, d: &Description) -> Markup {
    let Some(receipt) = &r.receipt else { return html! {} };
    html! {
        div.receipt {
            h3 { "Receipt" }
            p { "Derived anew from the motion's numbers by an integration that shares nothing with the optimizer, at " (receipt.grid) " instants of each phase." }
            dl {
                dt { "largest violation of any limit" } dd { (scientific(receipt.max_violation)) " in natural units" }
                dt { "distance from a closed cycle" } dd { (scientific(receipt.cycle_error)) " rad, rad/s" }
                dt { "first-order optimality (KKT)" } dd { (receipt.kkt_residual.map_or(html! { "–" }, scientific)) }
            }
            @if let Some(c) = &r.certificate { (certificate::section(c)) }
            @if let Some(legs) = &r.real_legs { (real_legs::section(legs, r, d)) }
            @for open in &r.not_examined { p.note { "Not examined: " (spaced(&open.entry)) " (" (open.reason) ")." } }
            h3 { "Limits without room to spare" }
            @if receipt.findings.is_empty() { p { "None: all limits have room." } }
            ul { @for f in &receipt.findings {
                li { b { (f.constraint) } ", phase " (f.phase) " at " (digits(f.time, 3)) " s. " (meaning(&f.constraint)) }
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
