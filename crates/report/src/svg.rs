//! A scene as SVG.

use super::ink::{self, Ink};
use super::scene::{Anchor, Mark, Scene, Xy};
use maud::{Markup, PreEscaped, html};

/// As part of a page that has the rules of the inks.
pub fn inline(scene: &Scene, title: &str) -> Markup {
    let view = format!("0 0 {} {}", short(scene.width), short(scene.height));
    html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(view) role="img" aria-label=(title) {
            @for (k, mark) in scene.marks.iter().enumerate() { (draw(mark, scene.numbers.get(&k).copied())) }
        }
    }
}

/// As a file of its own.
pub fn file(scene: &Scene, title: &str) -> String {
    let view = format!("0 0 {} {}", short(scene.width), short(scene.height));
    let style = format!("{}text{{font-family:Inter,system-ui,sans-serif}}", ink::fixed_rules());
    let markup = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(view) width=(short(scene.width)) height=(short(scene.height)) {
            title { (title) }
            style { (PreEscaped(style)) }
            rect width="100%" height="100%" class=(fill(Ink::Paper)) {}
            @for mark in &scene.marks { (draw(mark, None)) }
        }
    };
    markup.into_string()
}

/// A mark, with the number of what it stands for.
fn draw(mark: &Mark, number: Option<usize>) -> Markup {
    match mark {
        Mark::Line { points, pen } => html! {
            path d=(path(points)) class=(format!("s-{}", pen.ink.name())) fill="none" stroke-width=(short(pen.width))
                stroke-linejoin="round" stroke-linecap="round" stroke-dasharray=[pen.dash.pattern().map(|[a, b]| format!("{a} {b}"))]
                opacity=[part(pen.opacity)] data-k=[number] {}
        },
        Mark::Area { points, ink, opacity } => html! {
            path d=(path(points) + "Z") class=(fill(*ink)) opacity=[part(*opacity)] {}
        },
        Mark::Dot { at, radius, ink, opacity } => html! {
            circle cx=(short(at[0])) cy=(short(at[1])) r=(short(*radius)) class=(fill(*ink)) opacity=[part(*opacity)]
                data-k=[number] {}
        },
        Mark::Text { at, text, size, weight, anchor, ink } => {
            let anchor = match anchor {
                Anchor::Start => None,
                Anchor::Middle => Some("middle"),
                Anchor::End => Some("end"),
            };
            html! {
                text x=(short(at[0])) y=(short(at[1])) font-size=(short(*size)) font-weight=(weight.number())
                    text-anchor=[anchor] class=(fill(*ink)) { (text) }
            }
        }
    }
}

fn fill(ink: Ink) -> String {
    format!("f-{}", ink.name())
}

/// Opacity, where it is less than full.
fn part(opacity: f64) -> Option<String> {
    (opacity < 1.0).then(|| short(opacity))
}

fn path(points: &[Xy]) -> String {
    let mut text = String::new();
    for (k, [x, y]) in points.iter().enumerate() {
        text.push(if k == 0 { 'M' } else { 'L' });
        text += &short(*x);
        text.push(' ');
        text += &short(*y);
    }
    text
}

/// To hundredths, without trailing zeros.
fn short(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    // Not "-0".
    format!("{}", rounded + 0.0)
}
