//! The reaction on the stance foot and its place in the friction cone (figs. 6–11, bottom left).

use super::figure::Figure;
use super::ink::Ink;
use super::number::{given, significant};
use super::plot::{Curve, Limit};
use super::scale::domain;
use super::subject::Subject;
use piaffe_optimizer::walk::Moment;

pub fn forces(s: &Subject) -> Figure {
    let d = s.description();
    let mut plot = s.time_plot("Ground reaction", "N");
    let components = if d.positions() == 3 { &[0, 1, 2][..] } else { &[0, 1][..] };
    for &k in components {
        let name = ["forward", "up", "to the right"][k];
        plot.curves.push(Curve::new(name, Ink::Component(k), s.over_time(|m| m.force[k])));
    }
    let least = d.limits.min_vertical_force;
    let [from, to] = plot.x.domain.unwrap_or_default();
    let values = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]);
    plot.y.domain = Some(domain(values.chain([least])));
    plot.limits
        .push(Limit { name: format!("least vertical {} N", given(least)), points: vec![[from, least], [to, least]] });
    plot.note = Some(format!("the robot weighs {} N", significant(d.weight(), 4)));
    Figure::plot("forces", &plot, "On the virtual leg in support.")
}

pub fn friction(s: &Subject) -> Figure {
    let mu = s.description().limits.friction;
    let share = |m: &Moment| m.force[0].hypot(m.force[2]) / m.force[1];
    let mut plot = s.time_plot("Friction used", "tangential / vertical");
    // In flight there is no force.
    let stands = s.walk.phases.iter().map(|phase| phase.mode.stance().is_some());
    let on_a_foot: Vec<_> = s.over_time(share).into_iter().zip(stands).filter(|(_, stands)| *stands).collect();
    let segments: Vec<_> = on_a_foot.into_iter().map(|(segment, _)| segment).collect();
    let most = segments.iter().flatten().map(|p| p[1]).fold(0.0, f64::max);
    plot.curves.push(Curve::new("tangential / vertical force", Ink::Text, segments));
    let [from, to] = plot.x.domain.unwrap_or_default();
    plot.limits.push(Limit { name: format!("friction cone {}", given(mu)), points: vec![[from, mu], [to, mu]] });
    plot.y.domain = Some([0.0, 1.12 * mu]);
    plot.forbidden = vec![vec![[from, mu], [to, mu], [to, 1.12 * mu], [from, 1.12 * mu]]];
    plot.note = Some(format!(
        "at most {} of {}: {:.0} % in reserve",
        significant(most, 3),
        given(mu),
        100.0 * (1.0 - most / mu).max(0.0)
    ));
    Figure::plot("friction", &plot, "The foot would slip in the shaded region.")
}
