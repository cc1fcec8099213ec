//! Height of the swing foot against the parabola below which it must not be (§6.1).

use super::figure::Figure;
use super::ink::Ink;
use super::number::given;
use super::plot::{Axis, Curve};
use super::subject::Subject;

const MILLI: f64 = 1000.0;

pub fn clearance(s: &Subject) -> Figure {
    let h = s.description().limits.swing_clearance;
    let mut plot = s.time_plot("Height of the swing foot", "mm");
    plot.y = Axis::new("", "mm");
    for (k, segment) in s.over_time(|m| MILLI * m.swing[1]).into_iter().enumerate() {
        let leg = 1 - s.walk.half_steps[k].leg;
        plot.curves.push(Curve::new(s.short_leg_name(leg), Ink::Leg(leg), vec![segment]));
    }
    plot.forbidden = s.over_time(|m| 4.0 * MILLI * h * m.share * (1.0 - m.share));
    plot.note = Some(format!("the parabola is {} mm high", given(MILLI * h)));
    Figure::plot(
        "clearance",
        &plot,
        "The foot must stay above the shaded parabola and leave and land no flatter than it.",
    )
}
