//! Momentum about the stance foot (eq. 8): what gravity gives along a support and the impact takes. In flight it is that about the
//! mass centre, which nothing changes.

use super::figure::Figure;
use super::plot::Curve;
use super::subject::Subject;

pub fn momentum(s: &Subject) -> Figure {
    let flies = s.description().flies();
    let about = if flies { "the stance foot or, in flight, G" } else { "the stance foot" };
    let mut plot = s.time_plot(format!("Momentum about {about}"), "kg·m²/s");
    let sigma = |m: &piaffe_optimizer::walk::Moment| {
        let shape = &s.description().shape(m.mode).momentum;
        let mut momentum = shape.zeros();
        s.gait.momentum(m.mode, &m.q, &m.qd, &mut momentum);
        shape.sigma.value(&momentum)
    };
    for (k, segment) in s.over_time(sigma).into_iter().enumerate() {
        let (name, ink) = s.mode(s.walk.phases[k].mode);
        plot.curves.push(Curve::new(name, ink, vec![segment]));
    }
    let caption = if flies {
        "The free motion. In flight the momentum is that about the mass centre G, which nothing changes; at a take-off and a \
         landing it is told about another point, and jumps. What becomes of a push stands under the receipt."
    } else {
        "The free motion: joints that follow a phase recover from a push where it is farther from zero at the end of a support \
         than at its beginning, and cannot where it crosses zero (eq. 8)."
    };
    Figure::plot("momentum", &plot, caption)
}
