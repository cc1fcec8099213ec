//! Power of the joints, and how the criterion grows to its final value (eq. 13, 14).

use super::figure::Figure;
use super::ink::Ink;
use super::number::significant;
use super::plot::Curve;
use super::scene::Xy;
use super::subject::Subject;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::walk::Moment;

/// Trapezoids per drawn interval: their error (the kinks of |power|) is then below what is shown.
const FINE: usize = 25;

pub fn power(s: &Subject) -> Figure {
    let mut plot = s.time_plot("Power of the joints", "W");
    plot.curves = s.joint_curves(0..s.description().joints(), |m, j| m.torque[j] * m.qd[j]);
    Figure::plot("power", &plot, "Torque times rate: positive where a motor drives, negative where it brakes.")
}

/// The criterion's integral over the step; divided by the travel it is the criterion.
pub fn integral(s: &Subject) -> Figure {
    let criterion = s.result.criterion;
    let (title, unit) = match criterion {
        Criterion::Energy => ("Energy spent", "J"),
        Criterion::Torque => ("Torque squared, integrated", "N²·m²·s"),
    };
    let rate = |m: &Moment| -> f64 {
        let joints = m.torque.iter().zip(&m.qd);
        match criterion {
            Criterion::Energy => joints.map(|(t, v)| (t * v).abs()).sum(),
            Criterion::Torque => joints.map(|(t, _)| t * t).sum(),
        }
    };
    let mut sum = 0.0;
    let mut curve: Vec<Vec<Xy>> = Vec::new();
    for phase in s.finely(FINE, rate) {
        let mut points = vec![[phase[0][0], sum]];
        for (k, w) in phase.windows(2).enumerate() {
            sum += 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1]);
            if (k + 1) % FINE == 0 {
                points.push([w[1][0], sum]);
            }
        }
        curve.push(points);
    }
    let travel = s.walk.travel.abs();
    let mut plot = s.time_plot(title, unit);
    plot.curves.push(Curve::new(title, Ink::Text, curve));
    let unit = criterion.unit();
    let [sum, travel, cost] = [s.cost * travel, travel, s.cost].map(|v| significant(v, 6));
    plot.note = Some(format!("{sum} over {travel} m is {cost} {unit}"));
    let caption = match criterion {
        Criterion::Energy => "∫ Σ |power| dt, the numerator of C2 (eq. 14).",
        Criterion::Torque => "∫ Σ Γ² dt, the numerator of C1 (eq. 13).",
    };
    Figure::plot("criterion", &plot, caption)
}
