//! A foot's swing: its whole time off the ground, over as many phases as it lasts, and over the exchange of the legs' roles.
//!
//! The foot stays above a curve of its elapsed share w. It reads `height/curve ≥ clearance`, which stays meaningful at both ends,
//! where height and curve vanish together: there it is a velocity or an acceleration that decides, times a power of the swing's
//! duration. So a clearance is always a factor that depends on durations alone, times something of the foot.

use piaffe_model::{Description, Mode, Then};
use smallvec::SmallVec;

/// The swing of a leg as a phase sees it.
#[derive(Clone, Debug)]
pub struct Swing {
    pub leg: usize,
    /// The phase that sees it.
    phase: usize,
    /// How often each phase's duration is part of the time between its beginning and that of the phase, and of the whole swing.
    before: Vec<f64>,
    whole: Vec<f64>,
    curve: Curve,
}

/// The curve above which a foot stays, in units of the clearance: 1 at its highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Curve {
    /// The foot left at an impact: 4 w (1 − w), the paper's.
    Struck,
    /// It left at rest, so that its height begins like w²: 27/4 w² (1 − w).
    AtRest,
}

/// Of what of a foot a clearance is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Its height over the ground, m.
    Height,
    /// Its vertical velocity, m/s: where an impact begins or ends the swing.
    Velocity,
    /// Its vertical acceleration, m/s²: where it leaves at rest.
    Acceleration,
}

/// What a clearance is per unit of what it is made of, and how that depends on the durations of the gait's phases.
#[derive(Clone, Debug)]
pub struct Factor {
    pub of: Of,
    pub value: f64,
    /// By the duration of each phase; nothing where it depends on none.
    pub by: SmallVec<[f64; 4]>,
    /// By the durations of two phases, row-major.
    pub second: SmallVec<[f64; 16]>,
}

/// The swings of the feet that are in the air in phase `k`, in the order in which kernels give them.
pub fn swings(d: &Description, k: usize) -> Vec<Swing> {
    d.phases[k].mode.swinging().filter_map(|leg| Swing::new(d, k, leg)).collect()
}

impl Swing {
    /// None for a leg that never stands.
    fn new(d: &Description, k: usize, leg: usize) -> Option<Swing> {
        let count = d.phases.len();
        // The whole cycle, with the legs' names of phase `k`.
        let cycle = match d.then {
            Then::Mirrored => 2 * count,
            Then::Repeat => count,
        };
        let mode = |i: usize| match d.phases[i % count].mode {
            mode if i % cycle >= count => mode.exchanged(),
            mode => mode,
        };
        let stands = |i: usize| mode(i) == Mode::Stance(leg);
        let last_stance = (k + 1..k + cycle).rev().find(|i| stands(*i))?;
        let next_stance = (k + 1..k + cycle).find(|i| stands(*i))?;
        let sum = |range: std::ops::Range<usize>| {
            let mut multiples = vec![0.0; count];
            range.for_each(|i| multiples[i % count] += 1.0);
            multiples
        };
        let curve = if mode(last_stance + 1) == Mode::Flight { Curve::AtRest } else { Curve::Struck };
        let before = sum(last_stance + 1..k + cycle);
        let rest = sum(k..next_stance);
        let whole = before.iter().zip(&rest).map(|(a, b)| a + b).collect();
        Some(Swing { leg, phase: k, before, whole, curve })
    }

    /// Whether it begins with the phase.
    pub fn begins(&self) -> bool {
        self.before.iter().all(|multiple| *multiple == 0.0)
    }

    /// Whether it ends with the phase.
    pub fn ends(&self) -> bool {
        let rest =
            |(k, (before, whole)): (usize, (&f64, &f64))| whole - before - if k == self.phase { 1.0 } else { 0.0 };
        self.before.iter().zip(&self.whole).enumerate().map(rest).all(|rest| rest == 0.0)
    }

    /// Whether it begins and ends with the phase.
    pub fn is_within_phase(&self) -> bool {
        self.begins() && self.ends()
    }

    /// Whether its foot is at rest when it begins.
    pub fn begins_at_rest(&self) -> bool {
        self.begins() && self.curve == Curve::AtRest
    }

    /// The curve at share `s` of the phase, with these durations of all of the gait's phases, s: 1 at its highest.
    pub fn height(&self, durations: &[f64], s: f64) -> f64 {
        let whole: f64 = self.whole.iter().zip(durations).map(|(w, t)| w * t).sum();
        let before: f64 = self.before.iter().zip(durations).map(|(w, t)| w * t).sum();
        self.curve.at((before + s * durations[self.phase]) / whole)[0]
    }

    /// At share `s` of the phase, with these durations of the gait's phases (only its own, if it is within the phase), s.
    pub fn factor(&self, durations: &[f64], s: f64) -> Factor {
        if self.is_within_phase() && s > 0.0 && s < 1.0 {
            return Factor {
                of: Of::Height,
                value: 1.0 / self.curve.at(s)[0],
                by: SmallVec::new(),
                second: SmallVec::new(),
            };
        }
        let (whole, phase) = match durations {
            [_] => (&[1.0][..], 0),
            _ => (&self.whole[..], self.phase),
        };
        let duration: f64 = whole.iter().zip(durations).map(|(w, t)| w * t).sum();
        let power = |of: Of, factor: f64, power: i32| {
            let p = f64::from(power);
            let first = factor * p * duration.powi(power - 1);
            let second = factor * p * (p - 1.0) * duration.powi((power - 2).max(0));
            Factor {
                of,
                value: factor * duration.powi(power),
                by: whole.iter().map(|w| first * w).collect(),
                second: whole.iter().flat_map(|a| whole.iter().map(move |b| second * a * b)).collect(),
            }
        };
        if s <= 0.0 && self.begins() {
            let [_, slope, bend] = self.curve.at(0.0);
            return match self.curve {
                Curve::Struck => power(Of::Velocity, 1.0 / slope, 1),
                Curve::AtRest => power(Of::Acceleration, 1.0 / bend, 2),
            };
        }
        if s >= 1.0 && self.ends() {
            return power(Of::Velocity, 1.0 / self.curve.at(1.0)[1], 1);
        }
        let elapsed = |k: usize| self.before[k] + if k == phase { s } else { 0.0 };
        let w = (0..whole.len()).map(|k| elapsed(k) * durations[k]).sum::<f64>() / duration;
        let [curve, slope, bend] = self.curve.at(w);
        // ∂w/∂T.
        let by: SmallVec<[f64; 4]> = (0..whole.len()).map(|k| (elapsed(k) - w * whole[k]) / duration).collect();
        let first = -slope / (curve * curve);
        let second = (2.0 * slope * slope / curve - bend) / (curve * curve);
        let mixed = |i: usize, j: usize| -(by[i] * whole[j] + whole[i] * by[j]) / duration;
        Factor {
            of: Of::Height,
            value: 1.0 / curve,
            second: (0..whole.len())
                .flat_map(|i| (0..whole.len()).map(move |j| (i, j)))
                .map(|(i, j)| second * by[i] * by[j] + first * mixed(i, j))
                .collect(),
            by: by.iter().map(|by| first * by).collect(),
        }
    }
}

impl Curve {
    /// Value, slope and second derivative at the share w.
    fn at(self, w: f64) -> [f64; 3] {
        match self {
            Curve::Struck => [4.0 * w * (1.0 - w), 4.0 - 8.0 * w, -8.0],
            Curve::AtRest => [6.75 * w * w * (1.0 - w), 6.75 * w * (2.0 - 3.0 * w), 6.75 * (2.0 - 6.0 * w)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_derivatives(swing: &Swing, durations: &[f64], s: f64) {
        const H: f64 = 1e-5;
        let with = |k: usize, by: f64| {
            let mut durations = durations.to_vec();
            durations[k] += by;
            swing.factor(&durations, s)
        };
        let now = swing.factor(durations, s);
        let n = durations.len();
        for k in 0..n {
            let (more, less) = (with(k, H), with(k, -H));
            let first = (more.value - less.value) / (2.0 * H);
            assert!((first - now.by[k]).abs() < 1e-6 * now.value.abs().max(1.0), "{s} {k}: {first} {}", now.by[k]);
            for j in 0..n {
                let second = (more.by[j] - less.by[j]) / (2.0 * H);
                let found = now.second[k * n + j];
                assert!((second - found).abs() < 1e-5 * now.value.abs().max(1.0), "{s} {k} {j}: {second} {found}");
            }
        }
    }

    #[test]
    fn factors_and_their_derivatives() {
        // As the running trot's swing foot is seen in stance and in flight, and one that leaves at an impact.
        let at_rest = |before: [f64; 2], phase| Swing {
            leg: 1,
            phase,
            before: before.to_vec(),
            whole: vec![1.0, 2.0],
            curve: Curve::AtRest,
        };
        let struck = Swing { leg: 0, phase: 0, before: vec![0.0; 2], whole: vec![1.0; 2], curve: Curve::Struck };
        let durations = [0.23, 0.11];
        for swing in [at_rest([0.0, 0.0], 1), at_rest([0.0, 1.0], 0), at_rest([1.0, 1.0], 1), struck] {
            for s in [0.0, 0.3, 0.8, 1.0] {
                assert_derivatives(&swing, &durations, s);
            }
        }
    }

    /// The quotient of height and curve has its limit at both ends.
    #[test]
    fn ends_are_limits() {
        let swing = Swing { leg: 1, phase: 0, before: vec![0.0], whole: vec![1.0], curve: Curve::AtRest };
        let t = 0.4;
        let near = |s: f64, height: f64| height * swing.factor(&[t], s).value;
        // h = a t²/2 near the beginning, h = −v (T − t) near the end.
        let (a, v, small) = (3.0, -2.0, 1e-6);
        let begin = near(small, 0.5 * a * (small * t).powi(2));
        assert!((begin - a * swing.factor(&[t], 0.0).value).abs() < 1e-5 * begin);
        let end = near(1.0 - small, -v * small * t);
        assert!((end - v * swing.factor(&[t], 1.0).value).abs() < 1e-5 * end);
    }
}
