//! Torques, angles and speeds of the joints over time, with their limits (figs. 6–11, and what they leave out).

use super::figure::Figure;
use super::ink::Ink;
use super::number::given;
use super::plot::{Curve, Limit, Plot};
use super::scale::domain;
use super::subject::{Kind, Subject, capital, spaced};
use piaffe_model::Rotation;

/// Limits this much beyond the values are said rather than drawn: they would flatten the curves.
const FAR: f64 = 2.0;

pub fn torques(s: &Subject) -> Figure {
    let d = s.description();
    let mut plot = s.time_plot("Joint torques", "N·m");
    plot.curves = s.joint_curves(0..d.joints(), |m, j| m.torque[j]);
    let limits: Vec<f64> = d.joints.iter().map(|j| j.max_torque).collect();
    let peak = s.result.peaks.iter().map(|p| p.torque).fold(0.0, f64::max);
    symmetric(&mut plot, &limits, peak, "N·m");
    Figure::plot("torques", &plot, "Γ of every joint of the virtual legs.")
}

pub fn speeds(s: &Subject) -> Figure {
    let d = s.description();
    let mut plot = s.time_plot("Joint speeds", "rad/s");
    plot.curves = s.joint_curves(0..d.joints(), |m, j| m.qd[j]);
    let limits: Vec<f64> = d.joints.iter().map(|j| j.unloaded_speed).collect();
    let peak = s.result.peaks.iter().map(|p| p.speed).fold(0.0, f64::max);
    symmetric(&mut plot, &limits, peak, "rad/s unloaded");
    Figure::plot("speeds", &plot, "Rates of the joint angles. They jump where a foot lands.")
}

/// Draws ± limits where they are near, else says how far they are.
fn symmetric(plot: &mut Plot, limits: &[f64], peak: f64, unit: &str) {
    let mut distinct = limits.to_vec();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let [near, far]: [Vec<f64>; 2] =
        [true, false].map(|near| distinct.iter().copied().filter(|l| (*l < FAR * peak) == near).collect());
    let [from, to] = [plot.x.domain.unwrap_or_default()[0], plot.x.domain.unwrap_or_default()[1]];
    for limit in near {
        for sign in [1.0, -1.0] {
            let name = format!("limit {}{}", if sign < 0.0 { "−" } else { "" }, given(limit));
            plot.limits.push(Limit { name, points: vec![[from, sign * limit], [to, sign * limit]] });
        }
    }
    let values = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]);
    plot.y.domain = Some(domain(values.chain(plot.limits.iter().map(|l| l.points[0][1]))));
    if !far.is_empty() {
        let list: Vec<String> = far.iter().map(|l| format!("±{}", given(*l))).collect();
        plot.note = Some(format!("limits {} {unit}: beyond this axis", list.join(" and ")));
    }
}

/// Angles, a plot per kind of joint and stops, between these; and the platform's rotation.
pub fn angles(s: &Subject) -> Vec<Figure> {
    let d = s.description();
    let between = |Kind { name, joints }: &Kind| {
        let mut plot = s.time_plot(format!("{} angles", capital(name)), "rad");
        plot.curves = s.joint_curves(joints.iter().copied(), |m, j| m.q[j]);
        let [from, to] = plot.x.domain.unwrap_or_default();
        let stops = d.joints[joints[0]].range;
        for stop in stops {
            plot.limits.push(Limit { name: format!("stop {}", given(stop)), points: vec![[from, stop], [to, stop]] });
        }
        let values = plot.curves.iter().flat_map(|c| c.segments.iter().flatten()).map(|p| p[1]);
        plot.y.domain = Some(roomy(values.chain(stops)));
        let caption = format!("Relative to the parent link; dashed, the stops of the {}.", spaced(name));
        Figure::plot(&format!("angles-{name}"), &plot, caption)
    };
    let mut figures: Vec<Figure> = s.kinds(|j| d.joints[j].range).iter().map(between).collect();
    if d.rotation != Rotation::None {
        let name = if d.rotation == Rotation::Roll { "roll" } else { "pitch" };
        let mut plot = s.time_plot(format!("Platform {name}"), "rad");
        plot.curves.push(Curve::new(name, Ink::Text, s.over_time(|m| m.q[d.joints()])));
        figures.push(Figure::plot("platform", &plot, "θ, which no actuator drives: it follows from eq. 8 and 9."));
    }
    figures
}

/// A domain around the stops.
fn roomy(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    [low - 0.08 * (high - low), high + 0.08 * (high - low)]
}
