//! Joints that follow functions of a phase (virtual constraints).
//!
//! Kept perfectly, they leave the robot its path and one freedom: how fast it moves along it. With the gait's own time τ as
//! coordinate of the path, σ = σ*(τ) τ̇, where σ* is that of the gait, and with the same moment of gravity as there,
//!
//! ```text
//! d(σ²/2)/dτ = d(σ*²/2)/dτ:    σ²/2 − σ*²/2 is kept along a support
//! ```
//!
//! Impacts are linear in the velocities and keep the path, so σ⁺/σ⁻ is that of the gait. Hence (σ² − σ*²)/2 is multiplied,
//! from step to step, by
//!
//! ```text
//! Π (σ*(0)/σ*(T))²  over the supports
//! ```
//!
//! The gait recovers exactly if gravity speeds it up between landings, which take from its momentum what gravity has given.
//! Nothing of this holds where σ* vanishes inside a support: there all velocities along the path have the same σ. Nor in flight,
//! where the robot that is slower falls as fast: it does not stay on its path.

use super::halving;
use super::passage::{Instant, Passage};
use piaffe_model::{FORWARD, Gait, Mode, Rotation, UP};
use serde::{Deserialize, Serialize};

/// The return map of the speed along the path, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PhaseTracking {
    Map {
        /// A quantity of the posture that grows all the time, and so can serve as the phase.
        phase: String,
        /// What a deviation of σ² is multiplied by in a whole step.
        factor: f64,
        /// Whole steps until a deviation is halved; none if it grows.
        steps_to_halve: Option<f64>,
        /// Slowest entry into the first support, as a share of the gait's speed there, from which the robot does not fall
        /// back in this step.
        slowest_entry: f64,
    },
    /// The momentum about the stance foot vanishes here: no tracking of all joints by a phase of the posture gets across with
    /// another speed than the gait's.
    Singular {
        /// 1-based.
        #[serde(alias = "half_step")]
        phase: usize,
        /// s.
        time: f64,
    },
    /// No quantity that is looked at grows all the time.
    NoPhase,
    /// In flight the mass centre falls by the world's clock, not by a phase of the posture.
    Flight,
}

impl PhaseTracking {
    /// From the supports that define the gait, of which a step is `repeats` rounds.
    pub fn new(gait: &dyn Gait, passages: &[Passage], repeats: usize) -> PhaseTracking {
        if gait.description().has(Mode::Flight) {
            return PhaseTracking::Flight;
        }
        if let Some((phase, time)) = passages.iter().enumerate().find_map(|(k, p)| Some((k + 1, vanishing(p)?))) {
            return PhaseTracking::Singular { phase, time };
        }
        let Some(phase) = phase(gait, passages) else { return PhaseTracking::NoPhase };
        // (σ² − σ*²)/2 in terms of that at the entry; the robot falls back where it takes σ² below zero.
        let (mut factor, mut most) = (1.0, f64::INFINITY);
        for passage in (0..repeats).flat_map(|_| passages) {
            let least = passage.instants.iter().map(|i| energy(i.sigma)).fold(f64::INFINITY, f64::min);
            most = most.min(least / factor);
            factor *= energy(passage.beginning().sigma) / energy(passage.last().sigma);
        }
        let entry = passages.first().map_or(0.0, |p| energy(p.beginning().sigma));
        PhaseTracking::Map {
            phase,
            factor,
            steps_to_halve: halving(factor),
            slowest_entry: (1.0 - most / entry).max(0.0).sqrt(),
        }
    }
}

/// σ²/2.
fn energy(sigma: f64) -> f64 {
    0.5 * sigma * sigma
}

/// When σ changes its sign.
fn vanishing(passage: &Passage) -> Option<f64> {
    passage.instants.windows(2).find_map(|w| match w {
        [a, b] if a.sigma * b.sigma <= 0.0 => Some(a.time + (b.time - a.time) * a.sigma / (a.sigma - b.sigma)),
        _ => None,
    })
}

/// How fast a quantity of the posture changes.
type Rate<'a> = dyn Fn(&Passage, &Instant) -> f64 + 'a;

/// The first quantity that grows all the time, by name.
fn phase(gait: &dyn Gait, passages: &[Passage]) -> Option<String> {
    let d = gait.description();
    let free = d.joints.get(d.unactuated).map_or(
        match d.rotation {
            Rotation::Roll => "roll of the platform",
            _ => "pitch of the platform",
        },
        |joint| joint.name,
    );
    let turning = |p: &Passage, i: &Instant| {
        let [at, rate] = platform(gait, p.mode, i);
        at[1] * rate[0] - at[0] * rate[1]
    };
    let rates: [(&str, &Rate); 4] = [
        ("forward position of the platform from the stance foot", &|p, i| platform(gait, p.mode, i)[1][0]),
        ("forward position of the mass centre from the stance foot", &|p, i| mass_centre_speed(gait, p.mode, i)),
        ("angle of the line from the stance foot to the platform", &turning),
        (free, &|_, i| i.state.qd[d.unactuated]),
    ];
    let grows = |rate: &Rate| {
        let mut all = passages.iter().flat_map(|p| p.instants.iter().map(|i| rate(p, i)));
        let forward = all.next().unwrap_or(0.0) > 0.0;
        all.all(|rate| if forward { rate > 0.0 } else { rate < 0.0 })
    };
    rates.iter().find(|(_, rate)| grows(rate)).map(|(name, _)| (*name).into())
}

/// Platform's mass centre from the stance foot and its velocity, forward and up; m, m/s.
fn platform(gait: &dyn Gait, mode: Mode, i: &Instant) -> [[f64; 2]; 2] {
    let d = gait.description();
    let mut placement = d.shape(mode).placement.zeros();
    gait.placement(mode, &i.state.q, &mut placement);
    let mut velocity = vec![0.0; d.positions()];
    gait.platform_velocity(mode, &i.state.q, &i.state.qd, &mut velocity);
    [d.shape(mode).placement.p.of(&placement), &velocity].map(|v| [v[FORWARD], v[UP]])
}

/// Forward speed of the robot's mass centre, m/s.
fn mass_centre_speed(gait: &dyn Gait, mode: Mode, i: &Instant) -> f64 {
    let d = gait.description();
    let nc = d.positions();
    let whole = |[p, q]: [&[f64]; 2]| [p, q].concat();
    let mut velocity = vec![0.0; nc];
    gait.platform_velocity(mode, &i.state.q, &i.state.qd, &mut velocity);
    let mut centre = d.shapes.centre_of_mass.zeros();
    gait.centre_of_mass(&whole([&vec![0.0; nc], &i.state.q]), &whole([&velocity, &i.state.qd]), &mut centre);
    d.shapes.centre_of_mass.velocity.of(&centre)[FORWARD]
}
