//! The joints' peaks beside their limits, as a table for a person.

use super::digits::{at_least, decimal};
use piaffe_model::{Description, Joint};
use piaffe_verify::JointPeak;
use std::f64::consts::TAU;

/// What is less than this share of its limit is rounding.
const ROUNDING: f64 = 1e-9;

const HEADINGS: [&str; 4] =
    ["peaks at the joints", "torque, N·m", "speed, rad/s (motor, rev/min)", "to the torque–speed line"];

/// A line for each joint, as wide as its longest name and numbers ask for; nothing of none.
pub fn table(description: &Description, peaks: &[JointPeak]) -> String {
    if peaks.is_empty() {
        return String::new();
    }
    let of_joints = peaks.iter().zip(description.joints.iter()).map(|(peak, joint)| row(peak, joint));
    let rows: Vec<[String; 4]> = std::iter::once(HEADINGS.map(String::from)).chain(of_joints).collect();
    let [name, torque, speed, margin] =
        [0, 1, 2, 3].map(|k| rows.iter().map(|row| row[k].chars().count()).fold(0, usize::max));
    let line = |[first, second, third, fourth]: &[String; 4]| {
        format!("  {first:<name$}  {second:>torque$}  {third:>speed$}  {fourth:>margin$}\n")
    };
    rows.iter().map(line).collect()
}

fn row(peak: &JointPeak, joint: &Joint) -> [String; 4] {
    let motor = |speed: f64| speed * joint.gear * 60.0 / TAU;
    let [torque, speed] = [(peak.torque, peak.max_torque), (peak.speed, peak.unloaded_speed)]
        .map(|(value, most)| if value.abs() < ROUNDING * most { 0.0 } else { value });
    // An active limit has a margin of rounding size, of either sign.
    let margin: f64 = 100.0 * peak.envelope_margin;
    let margin = if margin.abs() < 0.05 { 0.0 } else { margin };
    [
        format!("  {}", peak.name),
        format!("{} of {}", decimal(torque, 3), at_least(peak.max_torque, 1, 3)),
        format!(
            "{} of {} ({:.0} of {:.0})",
            decimal(speed, 3),
            at_least(peak.unloaded_speed, 2, 3),
            motor(speed),
            motor(peak.unloaded_speed)
        ),
        format!("{margin:.1} %"),
    ]
}
