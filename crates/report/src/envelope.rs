//! Torque versus speed at the motor, in the actuator's envelope (figs. 6–11, top right).

use super::figure::Figure;
use super::ink::Ink;
use super::plot::{Axis, Curve, Limit, Plot};
use super::scene::Dash;
use super::subject::{Kind, Subject, spaced};
use std::f64::consts::TAU;

/// A plot per kind of joint and motor.
pub fn figures(s: &Subject) -> Vec<Figure> {
    let d = s.description();
    let motor = |j: usize| {
        let motor = &d.joints[j];
        (members(s, j), motor.gear, motor.max_torque, motor.unloaded_speed, motor.loaded_speed)
    };
    s.kinds(motor).iter().map(|kind| one(s, kind)).collect()
}

/// How many real legs' joints move as this one.
fn members(s: &Subject, joint: usize) -> usize {
    s.description().legs[s.leg_of(joint)].members.len()
}

fn one(s: &Subject, Kind { name, joints }: &Kind) -> Figure {
    let d = s.description();
    let motor = &d.joints[joints[0]];
    let rev_per_min = |speed: f64| speed * motor.gear * 60.0 / TAU;
    // The motors of all legs that move as one share the torque.
    let motors = members(s, joints[0]) as f64 * motor.gear;
    let torque = |joint_torque: f64| joint_torque / motors;
    let (most, unloaded, loaded) =
        (torque(motor.max_torque), rev_per_min(motor.unloaded_speed), rev_per_min(motor.loaded_speed));
    let x = Axis::new("torque at the motor", "N·m").over([0.0, 1.08 * most]);
    let y = Axis::new("speed", "rev/min").over([0.0, 1.1 * unloaded]);
    let mut plot = Plot::new(format!("Torque–speed, {}", spaced(name)), x, y);
    plot.forbidden = vec![vec![
        [0.0, unloaded],
        [most, loaded],
        [most, 0.0],
        [1.08 * most, 0.0],
        [1.08 * most, 1.1 * unloaded],
        [0.0, 1.1 * unloaded],
    ]];
    let edge = vec![[0.0, unloaded], [most, loaded], [most, 0.0]];
    plot.limits = vec![Limit { name: String::new(), points: edge }];
    for &j in joints {
        let phases = (0..s.walk.phases.len()).map(|k| {
            let moments = s.walk.moments.iter().filter(move |m| m.phase == k);
            moments.map(|m| [torque(m.torque[j].abs()), rev_per_min(m.qd[j].abs())]).collect()
        });
        let curve = Curve::new(d.joints[j].name, Ink::Leg(s.leg_of(j)), phases.collect());
        plot.curves.push(curve.dash(if j == joints[0] { Dash::Solid } else { Dash::Dashed }));
    }
    let tightest = joints.iter().filter_map(|j| s.result.peaks.get(*j));
    let tightest = tightest.min_by(|a, b| a.envelope_margin.total_cmp(&b.envelope_margin));
    let margin = tightest.map_or(String::new(), |p| {
        // An active limit has a margin of rounding size, of either sign.
        let percent = 100.0 * p.envelope_margin;
        let percent = if percent.abs() < 0.05 { 0.0 } else { percent };
        format!("margin {percent:.1} % of the unloaded speed ({})", p.name)
    });
    plot.note = Some(margin);
    Figure::plot(
        &format!("envelope-{name}"),
        &plot,
        "Shaded: out of the reach of the motor, of which every real leg's joint has one.",
    )
}
