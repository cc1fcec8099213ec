//! Heights of the feet in the air against the curves below which they must not be (§6.1).

use super::figure::Figure;
use super::ink::Ink;
use super::number::given;
use super::plot::{Axis, Curve};
use super::scene::Xy;
use super::subject::Subject;
use piaffe_optimizer::walk::Moment;

const MILLI: f64 = 1000.0;

pub fn clearance(s: &Subject) -> Figure {
    let h = s.description().limits.swing_clearance;
    let mut plot = s.time_plot("Height of the swing foot", "mm");
    plot.y = Axis::new("", "mm");
    for leg in [0, 1] {
        let in_air = |m: &&Moment| m.mode.stance() != Some(leg);
        let of_phase = |k: usize, value: &dyn Fn(&Moment) -> f64| -> Vec<Xy> {
            let moments = s.walk.moments.iter().filter(|m| m.phase == k).filter(in_air);
            moments.map(|m| [m.time, MILLI * value(m)]).collect()
        };
        let phases = || (0..s.walk.phases.len()).filter(|k| s.walk.phases[*k].mode.stance() != Some(leg));
        let heights = phases().map(|k| of_phase(k, &|m| m.feet[leg][1])).collect();
        plot.curves.push(Curve::new(s.short_leg_name(leg), Ink::Leg(leg), heights));
        plot.forbidden.extend(phases().map(|k| of_phase(k, &|m| h * s.walk.clearance_curve(leg, m))));
    }
    plot.note = Some(format!("the curve is {} mm high", given(MILLI * h)));
    Figure::plot("clearance", &plot, "The foot must stay above the shaded curve and leave and land no flatter than it.")
}
