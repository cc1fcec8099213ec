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
    /// Whether it begins and ends with the phase.
    begins: bool,
    ends: bool,
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

/// What a clearance is per unit of what it is made of.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    pub of: Of,
    pub value: f64,
}

/// How a factor depends on the durations of the gait's phases.
#[derive(Clone, Debug)]
pub struct ByDurations {
    /// By the duration of each phase.
    pub first: SmallVec<[f64; 8]>,
    /// By the durations of two phases, row-major.
    pub second: SmallVec<[f64; 64]>,
}

/// At an end of the swing: what a clearance is made of there, and its factor, per power of the swing's duration.
struct End {
    of: Of,
    scale: f64,
    power: i32,
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
        let mode = |i: usize| d.mode(i as isize);
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
        Some(Swing::of(leg, k, before, whole, curve))
    }

    fn of(leg: usize, phase: usize, before: Vec<f64>, whole: Vec<f64>, curve: Curve) -> Swing {
        let own = |k: usize| if k == phase { 1.0 } else { 0.0 };
        let begins = before.iter().all(|multiple| *multiple == 0.0);
        let ends = before.iter().zip(&whole).enumerate().all(|(k, (before, whole))| whole - before == own(k));
        Swing { leg, phase, before, whole, begins, ends, curve }
    }

    /// Whether it begins with the phase.
    pub fn begins(&self) -> bool {
        self.begins
    }

    /// Whether it begins and ends with the phase.
    pub fn is_within_phase(&self) -> bool {
        self.begins && self.ends
    }

    /// Whether its foot is at rest when it begins.
    pub fn begins_at_rest(&self) -> bool {
        self.begins && self.curve == Curve::AtRest
    }

    /// The curve at share `s` of the phase, with these durations of all of the gait's phases, s: 1 at its highest.
    pub fn height(&self, durations: &[f64], s: f64) -> f64 {
        self.curve.at(self.elapsed(durations, s))[0]
    }

    /// At share `s` of the phase, with these durations of the gait's phases (only its own, if it is within the phase), s.
    #[inline]
    pub fn factor(&self, durations: &[f64], s: f64) -> Factor {
        match self.end(s) {
            Some(End { of, scale, power }) => {
                let (whole, _) = self.multiples(durations);
                Factor { of, value: scale * total(whole, durations).powi(power) }
            }
            None => Factor { of: Of::Height, value: 1.0 / self.curve.at(self.elapsed(durations, s))[0] },
        }
    }

    /// How the factor there depends on these durations; none where it depends on none.
    pub fn by_durations(&self, durations: &[f64], s: f64) -> Option<ByDurations> {
        let end = self.end(s);
        if end.is_none() && self.is_within_phase() {
            return None;
        }
        let (whole, phase) = self.multiples(durations);
        let duration = total(whole, durations);
        let pairs = || whole.iter().enumerate().flat_map(|a| whole.iter().enumerate().map(move |b| (a, b)));
        if let Some(End { scale, power, .. }) = end {
            let p = f64::from(power);
            let first = scale * p * duration.powi(power - 1);
            let second = scale * p * (p - 1.0) * duration.powi((power - 2).max(0));
            return Some(ByDurations {
                first: whole.iter().map(|w| first * w).collect(),
                second: pairs().map(|((_, a), (_, b))| second * a * b).collect(),
            });
        }
        let w = self.elapsed(durations, s);
        let [curve, slope, bend] = self.curve.at(w);
        // ∂w/∂T.
        let elapsed = |k: usize| self.before[k] + if k == phase { s } else { 0.0 };
        let by: SmallVec<[f64; 8]> =
            whole.iter().enumerate().map(|(k, whole)| (elapsed(k) - w * whole) / duration).collect();
        let first = -slope / (curve * curve);
        let second = (2.0 * slope * slope / curve - bend) / (curve * curve);
        let mixed = |i: usize, j: usize| -(by[i] * whole[j] + whole[i] * by[j]) / duration;
        Some(ByDurations {
            first: by.iter().map(|by| first * by).collect(),
            second: pairs().map(|((i, _), (j, _))| second * by[i] * by[j] + first * mixed(i, j)).collect(),
        })
    }

    /// What decides at share `s` of the phase, if the swing begins or ends there.
    fn end(&self, s: f64) -> Option<End> {
        if s <= 0.0 && self.begins {
            let [_, slope, bend] = self.curve.at(0.0);
            return Some(match self.curve {
                Curve::Struck => End { of: Of::Velocity, scale: 1.0 / slope, power: 1 },
                Curve::AtRest => End { of: Of::Acceleration, scale: 1.0 / bend, power: 2 },
            });
        }
        let ends = s >= 1.0 && self.ends;
        ends.then(|| End { of: Of::Velocity, scale: 1.0 / self.curve.at(1.0)[1], power: 1 })
    }

    /// The elapsed share of the swing.
    fn elapsed(&self, durations: &[f64], s: f64) -> f64 {
        if self.is_within_phase() {
            return s;
        }
        (total(&self.before, durations) + s * durations[self.phase]) / total(&self.whole, durations)
    }

    /// How often each of these durations is part of the whole swing, and which is the phase's.
    fn multiples(&self, durations: &[f64]) -> (&[f64], usize) {
        match durations {
            [_] => (&[1.0], 0),
            _ => (&self.whole, self.phase),
        }
    }
}

fn total(multiples: &[f64], durations: &[f64]) -> f64 {
    multiples.iter().zip(durations).map(|(multiple, t)| multiple * t).sum()
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
        let n = durations.len();
        let at = |durations: &[f64]| {
            let by = swing.by_durations(durations, s);
            let (first, second) =
                by.map_or((vec![0.0; n], vec![0.0; n * n]), |by| (by.first.to_vec(), by.second.to_vec()));
            (swing.factor(durations, s).value, first, second)
        };
        let with = |k: usize, by: f64| {
            let mut durations = durations.to_vec();
            durations[k] += by;
            at(&durations)
        };
        let (value, by, by_two) = at(durations);
        for k in 0..n {
            let (more, less) = (with(k, H), with(k, -H));
            let first = (more.0 - less.0) / (2.0 * H);
            assert!((first - by[k]).abs() < 1e-6 * value.abs().max(1.0), "{s} {k}: {first} {}", by[k]);
            for j in 0..n {
                let second = (more.1[j] - less.1[j]) / (2.0 * H);
                let found = by_two[k * n + j];
                assert!((second - found).abs() < 1e-5 * value.abs().max(1.0), "{s} {k} {j}: {second} {found}");
            }
        }
    }

    #[test]
    fn factors_and_their_derivatives() {
        // As the running trot's swing foot is seen in stance and in flight, and one that leaves at an impact.
        let at_rest = |before: [f64; 2], phase| Swing::of(1, phase, before.to_vec(), vec![1.0, 2.0], Curve::AtRest);
        let struck = Swing::of(0, 0, vec![0.0; 2], vec![1.0; 2], Curve::Struck);
        // And one that a phase holds whole.
        let within = Swing::of(0, 0, vec![0.0; 2], vec![1.0, 0.0], Curve::Struck);
        let durations = [0.23, 0.11];
        for swing in [at_rest([0.0, 0.0], 1), at_rest([0.0, 1.0], 0), at_rest([1.0, 1.0], 1), struck, within] {
            for s in [0.0, 0.3, 0.8, 1.0] {
                assert_derivatives(&swing, &durations, s);
            }
        }
    }

    /// The quotient of height and curve has its limit at both ends.
    #[test]
    fn ends_are_limits() {
        let swing = Swing::of(1, 0, vec![0.0], vec![1.0], Curve::AtRest);
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
