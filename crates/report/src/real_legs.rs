//! The real legs: what each foot carries, how much room is left, and the verdict in words.

use super::figure::Figure;
use super::ink::Ink;
use super::number::{digits, given};
use super::plot::{Curve, Limit, Plot};
use super::scale::domain;
use super::scene::{Dash, Xy};
use super::subject::{Subject, capital, spaced};
use maud::{Markup, html};
use piaffe_model::{Description, Mode};
use piaffe_optimizer::four_legs::{Instant, Lift, RealLegs, Verdict, Worst};
use piaffe_optimizer::result::GaitResult;

/// Intervals per phase with which curves are drawn.
const INTERVALS: usize = 120;

/// Vertical load and use of friction of every real foot, and the least margin over time; none where nothing is known.
pub fn figures(s: &Subject) -> Vec<Figure> {
    let lift = Lift::even(s.gait, &s.motion, INTERVALS).ok().filter(|_| s.result.real_legs.is_some());
    lift.map_or(Vec::new(), |lift| vec![loads(s, &lift), friction(s, &lift), margin(s, &lift)])
}

fn over_time(lift: &Lift, phase: usize, value: impl Fn(&Instant) -> f64) -> Vec<Xy> {
    lift.instants.iter().filter(|i| i.phase == phase).map(|i| [i.time, value(i)]).collect()
}

/// A curve for every foot in each phase in which it stands.
fn of_feet(lift: &Lift, value: impl Fn(&Instant, usize) -> f64) -> Vec<Curve> {
    let names = &lift.legs.whole.description().legs;
    let mut curves = Vec::new();
    for phase in 0..lift.durations.len() {
        let Some(first) = lift.instants.iter().find(|i| i.phase == phase) else { continue };
        for (k, leg) in first.stance.iter().enumerate() {
            let segment = over_time(lift, phase, |i| value(i, *leg));
            let curve = Curve::new(spaced(names[*leg].name), Ink::Leg(lift.legs.legs[*leg]), vec![segment]);
            curves.push(curve.dash(Dash::of(k)));
        }
    }
    curves
}

fn loads(s: &Subject, lift: &Lift) -> Figure {
    let mut plot = s.time_plot("Vertical load of every real foot", "N");
    plot.curves = of_feet(lift, |i, leg| i.reactions[leg][1]);
    let d = s.description();
    let mut feet: Vec<usize> = d.legs.iter().map(|leg| leg.members.len()).collect();
    feet.sort_unstable();
    feet.dedup();
    for feet in feet {
        let least = d.limits.min_vertical_force / feet as f64;
        limit(&mut plot, least, format!("least {} N", given(least)));
    }
    let caption = "With the shares that leave most room within the limits of every foot and joint.";
    Figure::plot("real-loads", &plot, caption)
}

fn friction(s: &Subject, lift: &Lift) -> Figure {
    let mu = s.description().limits.friction;
    let mut plot = s.time_plot("Friction of every real foot", "tangential − μ·vertical, N");
    plot.curves = of_feet(lift, |i, leg| i.reactions[leg][0].hypot(i.reactions[leg][2]) - mu * i.reactions[leg][1]);
    limit(&mut plot, 0.0, "friction cone".into());
    Figure::plot("real-friction", &plot, "A foot whose curve is above the dashed line would slip or lift off.")
}

fn margin(s: &Subject, lift: &Lift) -> Figure {
    let mut plot = s.time_plot("Room that the best shares leave", "least margin");
    let segments = (0..lift.durations.len()).map(|phase| over_time(lift, phase, |i| i.margin)).collect();
    let whose =
        if s.description().has(Mode::Flight) { "the standing legs, in flight of all" } else { "the standing legs" };
    plot.curves.push(Curve::new(format!("least margin of all limits of {whose}"), Ink::Text, segments));
    limit(&mut plot, 0.0, "limit".into());
    Figure::plot(
        "real-margin",
        &plot,
        "Below the dashed line no shares keep to all limits: the real robot cannot do it.",
    )
}

fn limit(plot: &mut Plot, at: f64, name: String) {
    let [from, to] = plot.x.domain.unwrap_or_default();
    let values = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]);
    plot.y.domain = Some(domain(values.chain([at])));
    plot.limits.push(Limit { name, points: vec![[from, at], [to, at]] });
}

pub fn section(legs: &RealLegs, r: &GaitResult, d: &Description) -> Markup {
    html! {
        h3 { "Real legs" }
        p { b { (verdict(legs)) } " In the equations of motion of the whole robot, equal shares leave lacking at most "
            (legs.equal_shares.support.words()) " between impacts and " (legs.equal_shares.impact.words_of_impact())
            " at an impact, the best shares " (legs.best_shares.support.words()) " and "
            (legs.best_shares.impact.words_of_impact()) "." }
        p { "With the cheapest shares: " (legs.cost(r, d)) "; " (digits(legs.cost_by_load(r, d), 6))
            " if each foot pushes in proportion to its load." }
        @if legs.verdict() != Verdict::NoEquilibrium {
            ul { (worst("Least room between impacts", &legs.support)) (worst("Least room at an impact", &legs.impact)) }
        }
    }
}

fn verdict(legs: &RealLegs) -> String {
    capital(&legs.sentence()) + "."
}

fn worst(what: &str, w: &Worst) -> Markup {
    html! {
        li { (what) ": a margin of " (digits(w.margin, 4)) ", phase " (w.phase) " at " (digits(w.time, 3))
            " s. In the way of more: " (w.binding.iter().map(|b| spaced(&b.limit)).collect::<Vec<_>>().join(", ")) "." }
    }
}
