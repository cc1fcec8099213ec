//! Where a search starts: a walk or run drawn from geometry alone.
//!
//! A plan says how high the robot stands, how long each phase takes and how its feet and platform
//! move over it; configurations follow by inverse kinematics on the generated placement kernel, for
//! any leg, kept near a nominal posture inside the joint ranges.

use nalgebra::{DMatrix, DVector};
use piaffe_model::motion::{Course, Motion};
use piaffe_model::units::Units;
use piaffe_model::{Description, FORWARD, Gait, Mode, Rotation, UP, other_leg};
use std::f64::consts::{PI, TAU};

/// What distinguishes one start from another.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Height of the hips over the foot, as a share of the straight leg.
    pub height: f64,
    /// Duration of each phase, s.
    pub durations: Vec<f64>,
    /// Height of the swing foot at mid-step, as a share of the straight leg.
    pub clearance: f64,
    /// How far the platform leads the feet's middle, as a share of the straight leg.
    pub lead: f64,
    /// Posture that inverse kinematics stays near: share of each joint's range, per joint of a leg; the joint that swings the leg
    /// puts the foot under the hip instead.
    pub posture: Vec<f64>,
    /// Pitch of a platform that pitches, rad.
    pub pitch: f64,
}

impl Plan {
    /// An upright walk with moderate steps.
    pub fn default_for(d: &Description) -> Plan {
        Plan {
            height: 0.85,
            durations: (0..d.phases.len()).map(|k| duration(d, k, typical(d, k).moderate)).collect(),
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
        let mut drawn = |Typical { short, long, .. }: Typical| within(short, long);
        let durations = (0..d.phases.len()).map(|k| duration(d, k, drawn(typical(d, k)))).collect();
        let (clearance, lead) = (within(2.0 / 75.0, 2.0 / 15.0), within(-0.3, 0.3));
        let posture = (0..joints_per_leg(d)).map(|_| within(0.1, 0.9)).collect();
        let pitch = within(-0.5, 0.5);
        let mut plan = Plan { height: 1.0, durations, clearance, lead, posture, pitch };
        plan.height = within(0.85, 1.0) * reach(gait, &plan) / d.leg_length();
        plan
    }
}

/// Durations in the robot's unit of time.
struct Typical {
    short: f64,
    moderate: f64,
    long: f64,
}

/// Of phase `k`.
fn typical(d: &Description, k: usize) -> Typical {
    match d.phases[k].mode {
        Mode::Stance(_) => Typical { short: 0.457, moderate: 1.26, long: 2.29 },
        // A mass that is thrown up a third of the leg is back after 1.6.
        Mode::Flight => Typical { short: 0.15, moderate: 0.61, long: 1.2 },
    }
}

fn joints_per_leg(d: &Description) -> usize {
    d.legs.iter().map(|l| l.end_joint - l.first_joint).max().unwrap_or(0)
}

/// A duration of phase `k` in the robot's unit of time, within the limits; s.
fn duration(d: &Description, k: usize, t: f64) -> f64 {
    let [lo, hi] = d.phases[k].duration;
    // Off both limits, or in the middle where these are close.
    let (least, most) = (1.2 * lo, 0.8 * hi);
    if least < most { (t * Units::new(d).time).min(most).max(least) } else { 0.5 * (lo + hi) }
}

/// Where the feet and the platform are over the gait's phases, in the world.
struct Paths<'a> {
    d: &'a Description,
    plan: &'a Plan,
    durations: Vec<f64>,
    speed: f64,
}

/// Where platform and the other foot are, from a foot, m.
struct Target {
    platform: [f64; 2],
    other: [f64; 2],
}

/// The walk or run of a plan at a mean speed (m/s).
pub fn walk(gait: &dyn Gait, plan: &Plan, speed: f64) -> Motion {
    let d = gait.description();
    let nominal = nominal_posture(gait, plan);
    let stances = |k: &usize| d.phases[*k].mode != Mode::Flight;
    let on_foot = || (0..d.phases.len()).filter(stances);
    let mut durations = plan.durations.clone();
    let total: f64 = on_foot().map(|k| durations[k]).sum();
    // Steps longer than the leg allows become quicker.
    let longest = 0.9 * d.leg_length() * if on_foot().count() == 1 { 1.0 } else { 1.5 };
    if speed.abs() * total > longest {
        for k in on_foot() {
            let [shortest, _] = d.phases[k].duration;
            durations[k] = (durations[k] * longest / (speed.abs() * total)).max(shortest * 1.05);
        }
    }
    let paths = Paths { d, plan, durations, speed };
    let phases = (0..d.phases.len()).map(|k| course(gait, &paths, k, &nominal)).collect();
    Motion { phases }
}

/// The posture of a plan with both feet under their hips, as far as the stops admit it: whatever a joint's zero means.
fn nominal_posture(gait: &dyn Gait, plan: &Plan) -> Vec<f64> {
    let d = gait.description();
    let mut q = vec![0.0; d.orientations()];
    for leg in &d.legs {
        for (depth, j) in (leg.first_joint..leg.end_joint).enumerate() {
            let [lo, hi] = d.joints[j].range;
            let share = plan.posture.get(depth).copied().unwrap_or(0.5);
            q[j] = lo + share * (hi - lo);
        }
    }
    for leg in 0..2 {
        let Some(hip) = swings(d, leg) else { continue };
        q[hip] = 0.0;
        let [x, y] = foot_from_hip(gait, &q, leg);
        q[hip] = turned(-libm::atan2(x, -y) - plan.pitch, d.joints[hip].range);
    }
    if d.rotation == Rotation::Pitch {
        q[d.joints()] = plan.pitch;
    }
    q
}

/// The joint that swings a leg to and fro: the first that turns in the sagittal plane.
fn swings(d: &Description, leg: usize) -> Option<usize> {
    const PITCH: usize = 2;
    let joints = d.legs[leg].first_joint..d.legs[leg].end_joint;
    joints.into_iter().find(|j| d.bodies.iter().any(|b| b.coordinate == Some(*j) && b.axis == PITCH))
}

/// The same direction within the stops, rad: of several turns the one nearest to their middle, of none the nearer stop.
fn turned(angle: f64, [lo, hi]: [f64; 2]) -> f64 {
    let middle = 0.5 * (lo + hi);
    let nearest = middle + (angle - middle + PI).rem_euclid(TAU) - PI;
    nearest.clamp(lo, hi)
}

fn course(gait: &dyn Gait, paths: &Paths, k: usize, nominal: &[f64]) -> Course {
    let d = gait.description();
    let t = paths.durations[k];
    // Where feet are from each other, either tells.
    let foot = d.phases[k].mode.stance().unwrap_or_default();
    let solve = |s: f64, near: &[f64]| inverse_kinematics(gait, Mode::Stance(foot), &paths.target(k, s, foot), near);
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
    Course {
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

impl Paths<'_> {
    /// Platform and the other foot from the foot of leg `foot`, at share `s` of phase `k`.
    fn target(&self, k: usize, s: f64, foot: usize) -> Target {
        let (platform, feet) = (self.platform(k, s), [0, 1].map(|leg| self.foot(k as isize, s, leg)));
        let from = |at: [f64; 2]| [0, 1].map(|c| at[c] - feet[foot][c]);
        Target { platform: from(platform), other: from(feet[other_leg(foot)]) }
    }

    fn duration(&self, i: isize) -> f64 {
        self.durations[i.rem_euclid(self.durations.len() as isize) as usize]
    }

    /// When the `i`-th phase begins, s.
    fn start(&self, i: isize) -> f64 {
        let count = self.durations.len() as isize;
        let own: f64 = self.durations[..i.rem_euclid(count) as usize].iter().sum();
        i.div_euclid(count) as f64 * self.durations.iter().sum::<f64>() + own
    }

    /// The platform moves evenly forward. It is thrown up and caught as a flight of its duration demands, like a mass on a spring.
    fn platform(&self, k: usize, s: f64) -> [f64; 2] {
        let (leg, t) = (self.d.leg_length(), self.durations[k]);
        let height = self.plan.height * leg - self.d.hip(0)[UP];
        let x = self.speed * (self.start(k as isize) + s * t) + self.plan.lead * leg;
        let thrown =
            |i: isize| if self.d.mode(i) == Mode::Flight { 0.5 * self.d.gravity * self.duration(i) } else { 0.0 };
        let k = k as isize;
        let [v0, v1] = match self.d.mode(k) {
            Mode::Flight => [thrown(k), -thrown(k)],
            Mode::Stance(_) => [-thrown(k - 1), thrown(k + 1)],
        };
        // The cubic between two equal heights with these speeds.
        [x, height + t * (v0 * s * (1.0 - s) * (1.0 - s) - v1 * s * s * (1.0 - s))]
    }

    /// A foot stands below where its hip is midway, and glides from print to print.
    fn foot(&self, k: isize, s: f64, leg: usize) -> [f64; 2] {
        let stands = |i: &isize| self.d.mode(*i) == Mode::Stance(leg);
        if stands(&k) {
            return [self.print(k, leg), 0.0];
        }
        let around = 2 * self.durations.len() as isize;
        let before = (1..=around).map(|n| k - n).find(stands).unwrap_or(k - 1);
        let after = (1..=around).map(|n| k + n).find(stands).unwrap_or(k + 1);
        let [left, lands, now] = [self.start(before + 1), self.start(after), self.start(k) + s * self.duration(k)];
        let w = (now - left) / (lands - left);
        let glide = w * w * (3.0 - 2.0 * w);
        let [from, to] = [before, after].map(|i| self.print(i, leg));
        [from + (to - from) * glide, 4.0 * self.plan.clearance * self.d.leg_length() * w * (1.0 - w)]
    }

    /// Where the foot of a leg stands in the `i`-th phase.
    fn print(&self, i: isize, leg: usize) -> f64 {
        self.speed * (self.start(i) + 0.5 * self.duration(i)) + self.d.hip(leg)[FORWARD]
    }
}

/// Distance of leg 1's foot from its hip in the posture of a plan, m.
fn reach(gait: &dyn Gait, plan: &Plan) -> f64 {
    let [x, y] = foot_from_hip(gait, &nominal_posture(gait, &Plan { pitch: 0.0, ..plan.clone() }), 0);
    libm::hypot(x, y)
}

/// Where a leg's foot is from its hip under a level platform, forward and up, m.
fn foot_from_hip(gait: &dyn Gait, q: &[f64], leg: usize) -> [f64; 2] {
    let d = gait.description();
    let (shape, mut out) = (&d.shapes.stance.placement, d.shapes.stance.placement.zeros());
    gait.placement(Mode::Stance(leg), q, &mut out);
    let (platform, hip) = (shape.p.of(&out), d.hip(leg));
    [FORWARD, UP].map(|c| -platform[c] - hip[c])
}

/// Configuration that places platform and the other foot, near a posture: damped least squares.
fn inverse_kinematics(gait: &dyn Gait, mode: Mode, target: &Target, near: &[f64]) -> Vec<f64> {
    /// How much a distance from the posture counts beside one from the target, in legs.
    const POSTURE: f64 = 3e-3;
    let d = gait.description();
    let leg_length = d.leg_length();
    let nq = d.orientations();
    let (shape, mut out) = (&d.shapes.stance.placement, d.shapes.stance.placement.zeros());
    let wanted = [(shape.p, shape.p_q, target.platform), (shape.swing, shape.swing_q, target.other)];
    let mut q = DVector::from_column_slice(near);
    for _ in 0..60 {
        gait.placement(mode, q.as_slice(), &mut out);
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
