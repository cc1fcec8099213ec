//! Where a search starts: a walk drawn from geometry alone.
//!
//! A plan says how high the robot stands, how long a half step takes and how its feet and platform
//! move over it; configurations follow by inverse kinematics on the generated placement kernel, for
//! any leg, kept near a nominal posture inside the joint ranges.

use nalgebra::{DMatrix, DVector};
use piaffe_model::motion::{HalfStep, Motion};
use piaffe_model::units::Units;
use piaffe_model::{Description, FORWARD, Gait, HalfSteps, Rotation, UP};
use std::f64::consts::FRAC_PI_2;

/// What distinguishes one start from another.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Height of the hips over the foot, as a share of the straight leg.
    pub height: f64,
    /// Duration of each half step, s.
    pub durations: Vec<f64>,
    /// Height of the swing foot at mid-step, as a share of the straight leg.
    pub clearance: f64,
    /// How far the platform leads the feet's middle, as a share of the straight leg.
    pub lead: f64,
    /// Posture that inverse kinematics stays near: share of each joint's range, per joint of a leg.
    pub posture: Vec<f64>,
    /// Pitch of a platform that pitches, rad.
    pub pitch: f64,
}

impl Plan {
    /// An upright walk with moderate steps.
    pub fn default_for(d: &Description) -> Plan {
        Plan {
            height: 0.85,
            durations: vec![duration(d, 1.26); d.phases()],
            clearance: 1.0 / 15.0,
            lead: 0.0,
            posture: vec![0.5; joints_per_leg(d)],
            pitch: 0.0,
        }
    }

    /// A walk drawn at random: quick or slow, joints bent either way, and as tall or crouched as legs bent like that stand.
    pub fn random(gait: &dyn Gait, rng: &mut fastrand::Rng) -> Plan {
        let d = gait.description();
        let mut within = |lo: f64, hi: f64| lo + (hi - lo) * rng.f64();
        let durations = (0..d.phases()).map(|_| duration(d, within(0.457, 2.29))).collect();
        let (clearance, lead) = (within(2.0 / 75.0, 2.0 / 15.0), within(-0.3, 0.3));
        let posture = (0..joints_per_leg(d)).map(|_| within(0.1, 0.9)).collect();
        let pitch = within(-0.5, 0.5);
        let mut plan = Plan { height: 1.0, durations, clearance, lead, posture, pitch };
        plan.height = within(0.85, 1.0) * reach(gait, &plan) / d.leg_length();
        plan
    }
}

fn joints_per_leg(d: &Description) -> usize {
    d.legs.iter().map(|l| l.end_joint - l.first_joint).max().unwrap_or(0)
}

/// A duration in the robot's unit of time, within the limits; s.
fn duration(d: &Description, t: f64) -> f64 {
    let [lo, hi] = d.limits.half_step_duration;
    (t * Units::new(d).time).min(0.8 * hi).max(1.2 * lo)
}

/// Where platform and swing foot are, from the stance foot, m.
struct Target {
    platform: [f64; 2],
    swing: [f64; 2],
}

/// The walk of a plan at a mean speed (m/s).
pub fn walk(gait: &dyn Gait, plan: &Plan, speed: f64) -> Motion {
    let d = gait.description();
    let nominal = nominal_posture(d, plan);
    let leg = d.leg_length();
    let total: f64 = plan.durations.iter().sum();
    let mut durations = plan.durations.clone();
    // Steps longer than the leg allows become quicker.
    let longest = 0.9 * leg * if d.half_steps == HalfSteps::Mirrored { 1.0 } else { 1.5 };
    if speed.abs() * total > longest {
        let [shortest, _] = d.limits.half_step_duration;
        for t in &mut durations {
            *t = (*t * longest / (speed.abs() * total)).max(shortest * 1.05);
        }
    }
    let travel = speed * durations.iter().sum::<f64>();
    let half_steps = (0..d.phases()).map(|k| half_step(gait, plan, k, &durations, travel, &nominal)).collect();
    Motion { half_steps }
}

fn nominal_posture(d: &Description, plan: &Plan) -> Vec<f64> {
    let mut q = vec![0.0; d.orientations()];
    if d.rotation == Rotation::Pitch {
        q[d.joints()] = plan.pitch;
    }
    for leg in &d.legs {
        for (depth, j) in (leg.first_joint..leg.end_joint).enumerate() {
            let [lo, hi] = bend(d, j);
            let share = plan.posture.get(depth).copied().unwrap_or(0.5);
            q[j] = lo + share * (hi - lo);
        }
    }
    q
}

/// The part of a joint's range that a walk is drawn from, rad: a leg hangs, so that the platform's joints turn by no more than
/// a quarter of a turn, however far they could.
fn bend(d: &Description, j: usize) -> [f64; 2] {
    let [lo, hi] = d.joints[j].range;
    let hangs = [lo.max(-FRAC_PI_2), hi.min(FRAC_PI_2)];
    if d.hangs_on_platform(j) && hangs[0] < hangs[1] { hangs } else { [lo, hi] }
}

fn half_step(gait: &dyn Gait, plan: &Plan, k: usize, durations: &[f64], travel: f64, nominal: &[f64]) -> HalfStep {
    let d = gait.description();
    let t = durations[k];
    let target = |s: f64| place(gait, plan, k, durations, travel, s);
    let solve = |s: f64, near: &[f64]| inverse_kinematics(gait, k, &target(s), near);
    let start = solve(0.0, nominal);
    let end = solve(1.0, nominal);
    let interior_times = d.polynomial_order - 3;
    let prescribed = |q: &[f64]| -> Vec<f64> { (0..d.prescribed()).map(|j| q[d.prescribed_index(j)]).collect() };
    let interior =
        (1..=interior_times).map(|i| prescribed(&solve(i as f64 / (interior_times + 1) as f64, nominal))).collect();
    let delta = 1e-3;
    let rate =
        |from: &[f64], to: &[f64]| -> Vec<f64> { from.iter().zip(to).map(|(a, b)| (b - a) / (delta * t)).collect() };
    let initial_rate = rate(&start, &solve(delta, &start));
    let final_rate = rate(&solve(1.0 - delta, &end), &end);
    HalfStep {
        duration: t,
        q_initial: prescribed(&start),
        qd_initial: prescribed(&initial_rate),
        q_interior: interior,
        q_final: prescribed(&end),
        qd_final: prescribed(&final_rate),
        beta_initial: start[d.unactuated],
        betad_initial: initial_rate[d.unactuated],
        beta_final: end[d.unactuated],
        betad_final: final_rate[d.unactuated],
    }
}

/// Platform and swing foot at `s` of half step `k`.
fn place(gait: &dyn Gait, plan: &Plan, k: usize, durations: &[f64], travel: f64, s: f64) -> Target {
    let d = gait.description();
    let height = standing_height(gait) - (1.0 - plan.height) * d.leg_length();
    let lead = plan.lead * d.leg_length();
    let lift = 4.0 * plan.clearance * d.leg_length() * s * (1.0 - s);
    let glide = s * s * (3.0 - 2.0 * s);
    if d.half_steps == HalfSteps::Mirrored {
        let x = travel * (s - 0.5) + lead;
        return Target { platform: [x, height], swing: [travel * (2.0 * glide - 1.0), lift] };
    }
    // Distinct half steps: the feet keep their spread on average; each moves by the whole travel.
    let spread = foot_spread(gait);
    let share = durations[0] / (durations[0] + durations[1]);
    let narrow = spread - 0.5 * travel.copysign(spread);
    let wide = spread + 0.5 * travel.copysign(spread);
    let start = 0.5 * narrow + lead;
    if k == 0 {
        let (from, to) = if spread > 0.0 { (narrow, wide) } else { (spread - 0.5 * travel, spread + 0.5 * travel) };
        Target { platform: [start + share * travel * s, height], swing: [from + (to - from) * glide, lift] }
    } else {
        let fore = spread + 0.5 * travel;
        let begin = start + share * travel;
        Target { platform: [begin + (1.0 - share) * travel * s - fore, height], swing: [travel * glide - fore, lift] }
    }
}

/// Distance of leg 1's foot from its hip in the posture of a plan, m.
fn reach(gait: &dyn Gait, plan: &Plan) -> f64 {
    let d = gait.description();
    let level = nominal_posture(d, &Plan { pitch: 0.0, ..plan.clone() });
    let (shape, mut out) = (&d.shapes.placement, d.shapes.placement.zeros());
    gait.placement(0, &level, &mut out);
    let hip = d.bodies.iter().find(|b| b.parent == Some(0) && b.coordinate == Some(d.legs[0].first_joint));
    let [x, y, _] = hip.map_or([0.0; 3], |b| b.offset);
    let platform = shape.p.of(&out);
    (platform[FORWARD] + x).hypot(platform[UP] + y)
}

/// Height of the platform's mass centre with all joints at zero, m.
fn standing_height(gait: &dyn Gait) -> f64 {
    let d = gait.description();
    let (shape, mut out) = (&d.shapes.placement, d.shapes.placement.zeros());
    gait.placement(0, &vec![0.0; d.orientations()], &mut out);
    shape.p.of(&out)[UP]
}

/// Forward distance from foot 1 to foot 2 with all joints at zero, m.
fn foot_spread(gait: &dyn Gait) -> f64 {
    let d = gait.description();
    let (shape, mut out) = (&d.shapes.placement, d.shapes.placement.zeros());
    gait.placement(0, &vec![0.0; d.orientations()], &mut out);
    shape.swing.of(&out)[FORWARD]
}

/// Configuration that places platform and swing foot, near a posture: damped least squares.
fn inverse_kinematics(gait: &dyn Gait, leg: usize, target: &Target, near: &[f64]) -> Vec<f64> {
    /// How much a distance from the posture counts beside one from the target, in legs.
    const POSTURE: f64 = 3e-3;
    let d = gait.description();
    let leg_length = d.leg_length();
    let nq = d.orientations();
    let (shape, mut out) = (&d.shapes.placement, d.shapes.placement.zeros());
    let wanted = [(shape.p, shape.p_q, target.platform), (shape.swing, shape.swing_q, target.swing)];
    let mut q = DVector::from_column_slice(near);
    for _ in 0..60 {
        gait.placement(leg, q.as_slice(), &mut out);
        let mut normal = DMatrix::<f64>::identity(nq, nq) * (POSTURE * POSTURE);
        let mut right = DVector::<f64>::zeros(nq);
        for (i, n) in near.iter().enumerate() {
            right[i] = POSTURE * POSTURE * (n - q[i]);
        }
        let rows = wanted
            .iter()
            .flat_map(|(place, by_q, to)| [FORWARD, UP].map(|k| (place.place(k), by_q.row(&out, k), to[k])));
        for (place, row, wanted) in rows {
            let gradient: Vec<f64> = row.iter().map(|g| g / leg_length).collect();
            let error = (wanted - out[place]) / leg_length;
            for i in 0..nq {
                right[i] += gradient[i] * error;
                for j in 0..nq {
                    normal[(i, j)] += gradient[i] * gradient[j];
                }
            }
        }
        let Some(factors) = normal.cholesky() else { break };
        let mut step = factors.solve(&right);
        let largest = step.amax();
        if largest > 0.3 {
            step *= 0.3 / largest;
        }
        q += &step;
        for (j, joint) in d.joints.iter().enumerate() {
            q[j] = q[j].clamp(joint.range[0], joint.range[1]);
        }
        if largest < 1e-12 {
            break;
        }
    }
    q.as_slice().to_vec()
}
