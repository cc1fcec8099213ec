//! Momentum about the stance foot (eq. 8): what gravity gives along a half step and the impact takes.

use super::figure::Figure;
use super::ink::Ink;
use super::plot::Curve;
use super::subject::Subject;

pub fn momentum(s: &Subject) -> Figure {
    let mut plot = s.time_plot("Momentum about the stance foot", "kg·m²/s");
    let shape = &s.description().shapes.momentum;
    let sigma = |m: &piaffe_optimizer::walk::Moment| {
        let mut momentum = shape.zeros();
        s.gait.momentum(m.stance, &m.q, &m.qd, &mut momentum);
        shape.sigma.value(&momentum)
    };
    for (k, segment) in s.over_time(sigma).into_iter().enumerate() {
        let leg = s.walk.half_steps[k].leg;
        plot.curves.push(Curve::new(format!("on {}", s.short_leg_name(leg)), Ink::Leg(leg), vec![segment]));
    }
    Figure::plot(
        "momentum",
        &plot,
        "The free motion: joints that follow a phase recover from a push where it is farther from zero at the end of a half step \
         than at its beginning, and cannot where it crosses zero (eq. 8).",
    )
}
