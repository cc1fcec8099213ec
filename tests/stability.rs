//! Orbital stability: the linearized return maps against steps that are really simulated.

#[path = "flight/gaits.rs"]
mod flight;
#[path = "gaits/walking.rs"]
mod walking;

use piaffe::gaits::GAITS;
use piaffe::model::{Description, FORWARD, Gait, Mode, Then, Transition, UP};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::stability::{PhaseTracking, TimeTracking, stability};
use piaffe::verify::integrate::integrate;
use piaffe::verify::polynomial::Polynomials;
use walking::walking;

fn optimum(gait: &dyn Gait, criterion: Criterion) -> Motion {
    search(gait, criterion, 0.6, &Settings::default(), &|_| {}).optima[0].local.motion.clone()
}

/// A robot whose joints are where they are wanted, with nothing linearized.
struct Tracked<'a> {
    gait: &'a dyn Gait,
    d: &'a Description,
    references: Vec<Polynomials>,
    durations: Vec<f64>,
    restarts: bool,
}

/// In a phase at the clock's `time`: β and σ, and in flight the mass centre's height and velocity, forward and up.
#[derive(Clone, Copy, Debug, Default)]
struct At {
    phase: usize,
    time: f64,
    beta: f64,
    sigma: f64,
    height: f64,
    velocity: [f64; 2],
}

impl<'a> Tracked<'a> {
    fn new(gait: &'a dyn Gait, motion: &Motion, restarts: bool) -> Tracked<'a> {
        Tracked {
            gait,
            d: gait.description(),
            references: motion.phases.iter().map(Polynomials::new).collect(),
            durations: motion.durations().collect(),
            restarts,
        }
    }

    /// q with β, and Q̇ with 0 for β̇.
    fn posture(&self, phase: usize, time: f64, beta: f64) -> [Vec<f64>; 2] {
        let (mut q, mut qd) = (vec![0.0; self.d.orientations()], vec![0.0; self.d.orientations()]);
        for j in 0..self.d.prescribed() {
            let k = self.d.prescribed_index(j);
            [q[k], qd[k], _] = self.references[phase].at(j, time);
        }
        q[self.d.unactuated] = beta;
        [q, qd]
    }

    fn mode(&self, phase: usize) -> Mode {
        self.d.phases[phase].mode
    }

    /// q, or its rates, as the phase after `phase` names them.
    fn renamed(&self, phase: usize, values: &[f64]) -> Vec<f64> {
        let name = |k| self.d.renamed(phase, k);
        (0..values.len()).map(name).map(|(from, sign)| sign * values[from]).collect()
    }

    /// f1, f2, σ, c, σ̇ for these velocities.
    fn terms(&self, phase: usize, q: &[f64], qd: &[f64]) -> [f64; 5] {
        let shape = &self.d.shape(self.mode(phase)).momentum_terms;
        let mut terms = shape.zeros();
        self.gait.momentum_terms(self.mode(phase), q, qd, &mut terms);
        // Gravity has no moment about the mass centre.
        [shape.f1, shape.f2, shape.sigma, shape.c, shape.sigmadot].map(|block| block.of(&terms).iter().sum())
    }

    /// Follows (β, σ) until the clock's `time`.
    fn until(&self, at: At, time: f64) -> At {
        let t = time - at.time;
        let rate = |t: f64, y: &[f64; 2]| {
            let [q, qd] = self.posture(at.phase, t, y[0]);
            let [f1, f2, _, _, moment] = self.terms(at.phase, &q, &qd);
            Some([(y[1] - f2) / f1, moment])
        };
        let [beta, sigma] = integrate(rate, at.time, time, [at.beta, at.sigma], 1e-13).unwrap().end();
        let mut at = At { time, beta, sigma, ..at };
        if self.mode(at.phase) == Mode::Flight {
            let [_, up] = &mut at.velocity;
            at.height += t * (*up - 0.5 * self.d.gravity * t);
            *up -= self.d.gravity * t;
        }
        at
    }

    /// Of the foot that lands.
    fn height(&self, at: &At, lands: usize) -> f64 {
        let [q, _] = self.posture(at.phase, at.time, at.beta);
        let mode = self.mode(at.phase);
        let shape = &self.d.shape(mode).placement;
        let mut placement = shape.zeros();
        self.gait.placement(mode, &q, &mut placement);
        let foot = mode.swinging().position(|leg| leg == lands).unwrap();
        at.height + shape.swing.of(&placement)[foot * self.d.positions() + UP]
    }

    /// Follows the motion until the foot is on the ground, near the gait's time, or to the time at which one leaves.
    fn until_end(&self, at: At) -> At {
        let duration = self.durations[at.phase];
        let Some(lands) = self.d.transition(at.phase).lands() else { return self.until(at, duration) };
        let before = self.until(at, 0.9 * duration);
        let below = |k: &f64| self.height(&self.until(before, k * duration), lands) < 0.0;
        let late = (0..40).map(|k| 0.98 + 0.001 * f64::from(k)).find(below).expect("the foot lands");
        let (mut early, mut late) = ((late - 0.001) * duration, late * duration);
        for _ in 0..60 {
            let middle = 0.5 * (early + late);
            if self.height(&self.until(before, middle), lands) > 0.0 { early = middle } else { late = middle }
        }
        self.until(before, 0.5 * (early + late))
    }

    /// Through the transition: the impact if there is one, and the joints taken to where the next references want them, with σ kept.
    fn cross(&self, at: At) -> At {
        let [q, mut qd] = self.posture(at.phase, at.time, at.beta);
        let [f1, f2, ..] = self.terms(at.phase, &q, &qd);
        qd[self.d.unactuated] = (at.sigma - f2) / f1;
        let nc = self.d.positions();
        let mut velocity = vec![0.0; nc];
        self.gait.platform_velocity(self.mode(at.phase), &q, &qd, &mut velocity);
        velocity.iter_mut().zip(at.velocity).for_each(|(v, centre)| *v += centre);
        let moving = [&velocity[..], &qd].concat();
        let mut after = At::default();
        let qd = match self.d.transition(at.phase) {
            Transition::Touchdown(leg) | Transition::Landing(leg) => {
                let mut impact = self.d.shapes.impact.zeros();
                self.gait.impact(leg, &q, &moving, &mut impact);
                self.d.shapes.impact.xd_plus.of(&impact)[nc..].to_vec()
            }
            Transition::TakeOff(_) => {
                let (placed, shape) = (&self.d.shapes.stance.placement, &self.d.shapes.centre_of_mass);
                let (mut placement, mut centre) = (placed.zeros(), shape.zeros());
                self.gait.placement(self.mode(at.phase), &q, &mut placement);
                self.gait.centre_of_mass(&[placed.p.of(&placement), &q].concat(), &moving, &mut centre);
                after.height = shape.position.of(&centre)[UP];
                after.velocity = [FORWARD, UP].map(|component| shape.velocity.of(&centre)[component]);
                qd
            }
        };
        let (q, qd) = (self.renamed(at.phase, &q), self.renamed(at.phase, &qd));
        let phase = (at.phase + 1) % self.durations.len();
        let sigma = self.terms(phase, &q, &qd)[2];
        let time = if self.restarts { 0.0 } else { at.time - self.durations[at.phase] };
        let [wanted, _] = self.posture(phase, time, 0.0);
        let way = |share: f64, beta: f64| {
            let (mut here, mut rate): (Vec<f64>, Vec<f64>) =
                q.iter().zip(&wanted).map(|(q, w)| (q + share * (w - q), w - q)).unzip();
            (here[self.d.unactuated], rate[self.d.unactuated]) = (beta, 0.0);
            let [f1, f2, ..] = self.terms(phase, &here, &rate);
            -f2 / f1
        };
        let turn = |share: f64, y: &[f64; 1]| Some([way(share, y[0])]);
        let [beta] = integrate(turn, 0.0, 1.0, [q[self.d.unactuated]], 1e-13).unwrap().end();
        At { phase, time, beta, sigma, ..after }
    }

    /// From the middle of the first phase, in which a foot stands, to the middle of the next that is like it.
    fn round(&self, beta: f64, sigma: f64) -> [f64; 2] {
        let middle = |phase: usize| 0.5 * self.durations[phase];
        let mut at = At { phase: 0, time: middle(0), beta, sigma, ..At::default() };
        for _ in 0..self.durations.len() {
            at = self.cross(self.until_end(at));
            at = self.until(at, middle(at.phase));
        }
        [at.beta, at.sigma]
    }
}

/// Trace and determinant of the return map of a step by differences.
fn differences(tracked: &Tracked, motion: &Motion) -> [f64; 2] {
    let start = &motion.phases[0];
    let [q, mut qd] = tracked.posture(0, 0.0, start.beta_initial);
    qd[tracked.d.unactuated] = start.betad_initial;
    let sigma = tracked.terms(0, &q, &qd)[2];
    let at = At { phase: 0, time: 0.0, beta: start.beta_initial, sigma, ..At::default() };
    let middle = tracked.until(at, 0.5 * start.duration);
    let returned = tracked.round(middle.beta, middle.sigma);
    assert!(
        (returned[0] - middle.beta).abs() < 1e-3 && (returned[1] - middle.sigma).abs() < 1e-3,
        "no cycle: {returned:?} {middle:?}"
    );
    let h = 1e-6;
    let column = |beta: f64, sigma: f64| {
        let plus = tracked.round(middle.beta + beta, middle.sigma + sigma);
        let minus = tracked.round(middle.beta - beta, middle.sigma - sigma);
        [0, 1].map(|i| (plus[i] - minus[i]) / (2.0 * h))
    };
    let ([a, c], [b, d]) = (column(h, 0.0), column(0.0, h));
    let (trace, determinant) = (a + d, a * d - b * c);
    match tracked.d.then {
        Then::Repeat => [trace, determinant],
        Then::Mirrored => [trace * trace - 2.0 * determinant, determinant * determinant],
    }
}

fn trace_and_determinant(t: &TimeTracking) -> [f64; 2] {
    let [[a, i], [b, j]] = t.eigenvalues;
    [a + b, a * b - i * j]
}

#[test]
fn the_map_of_time_tracking_is_that_of_simulated_steps() {
    let of_walk = |(gait, criterion): (&'static dyn Gait, Criterion)| {
        (gait as &dyn Gait, format!("{} {criterion:?}", gait.description().key), optimum(gait, criterion))
    };
    let walks: Vec<_> = walking().flat_map(|g| Criterion::ALL.map(|c| of_walk((*g, c)))).collect();
    let flights = flight::optima();
    let flights =
        flights.iter().map(|(gait, motion)| (gait as &dyn Gait, gait.description().gait.into(), motion.clone()));
    for (gait, name, motion) in walks.into_iter().chain(flights) {
        let found = stability(gait, &motion).unwrap();
        assert_eq!(found.phase == PhaseTracking::Flight, gait.description().has(Mode::Flight), "{name}");
        for (restarts, map) in [(false, &found.clock), (true, &found.restarted_clock)] {
            let (expected, exact) =
                (differences(&Tracked::new(gait, &motion, restarts), &motion), trace_and_determinant(map));
            let name = format!("{name}, clock restarts: {restarts}");
            for (a, b) in exact.iter().zip(expected) {
                assert!(
                    (a - b).abs() < 1e-4 * (1.0 + exact[0].abs().max(exact[1].abs())),
                    "{name}: {exact:?} {expected:?}"
                );
            }
        }
    }
}

/// The same robot with joints that are driven to their references: q̈ is q̈_ref + 2ω(q̇_ref − q̇) + ω²(q_ref − q).
struct Driven<'a> {
    tracked: Tracked<'a>,
    /// 1/s.
    stiffness: f64,
}

/// q and q̇ of the trot.
type Whole = [f64; 8];

impl Driven<'_> {
    fn until(&self, y: Whole, from: f64, to: f64) -> Whole {
        let (d, w) = (self.tracked.d, self.stiffness);
        let rate = |t: f64, y: &Whole| {
            let (q, qd) = y.split_at(4);
            let wanted = |j: usize| {
                let (k, [at, rate, acceleration]) = (d.prescribed_index(j), self.tracked.references[0].at(j, t));
                acceleration + 2.0 * w * (rate - qd[k]) + w * w * (at - q[k])
            };
            let commanded: Vec<f64> = (0..d.prescribed()).map(wanted).collect();
            let mut inverse = [0.0; 12];
            self.tracked.gait.inverse(Mode::Stance(0), q, qd, &commanded, &mut inverse);
            let mut rate = [0.0; 8];
            rate[..4].copy_from_slice(qd);
            rate[4..].copy_from_slice(&inverse[2..6]);
            Some(rate)
        };
        integrate(rate, from, to, y, 1e-11).unwrap().end()
    }

    fn height(&self, y: &Whole) -> f64 {
        let mut placement = [0.0; 20];
        self.tracked.gait.placement(Mode::Stance(0), &y[..4], &mut placement);
        placement[3]
    }

    /// From the middle of a phase to the middle of the next, in (β, σ): there the joints have no errors any more.
    fn phase(&self, beta: f64, sigma: f64) -> [f64; 2] {
        let duration = self.tracked.durations[0];
        let [q, mut qd] = self.tracked.posture(0, 0.5 * duration, beta);
        let [f1, f2, ..] = self.tracked.terms(0, &q, &qd);
        qd[self.tracked.d.unactuated] = (sigma - f2) / f1;
        let y: Whole = [q, qd].concat().try_into().unwrap();
        let before = self.until(y, 0.5 * duration, 0.9 * duration);
        let (mut early, mut late) = (0.9 * duration, 1.1 * duration);
        for _ in 0..50 {
            let middle = 0.5 * (early + late);
            let y = self.until(before, 0.9 * duration, middle);
            if self.height(&y) > 0.0 { early = middle } else { late = middle }
        }
        let y = self.until(before, 0.9 * duration, early);
        let mut velocity = [0.0; 2];
        self.tracked.gait.platform_velocity(Mode::Stance(0), &y[..4], &y[4..], &mut velocity);
        let mut impact = [0.0; 8];
        self.tracked.gait.impact(1, &y[..4], &[&velocity, &y[4..]].concat(), &mut impact);
        let name = |k: usize| self.tracked.d.swapped(k).0;
        let after: Whole = std::array::from_fn(|k| if k < 4 { y[name(k)] } else { impact[2 + name(k - 4)] });
        let y = self.until(after, early - duration, 0.5 * duration);
        [y[self.tracked.d.unactuated], self.tracked.terms(0, &y[..4], &y[4..])[2]]
    }

    /// Largest eigenvalue of the map of a whole step.
    fn factor(&self, motion: &Motion) -> f64 {
        let start = &motion.phases[0];
        let [q, mut qd] = self.tracked.posture(0, 0.0, start.beta_initial);
        qd[self.tracked.d.unactuated] = start.betad_initial;
        let sigma = self.tracked.terms(0, &q, &qd)[2];
        let at = At { phase: 0, time: 0.0, beta: start.beta_initial, sigma, ..At::default() };
        let At { beta, sigma, .. } = self.tracked.until(at, 0.5 * start.duration);
        let h = 1e-5;
        let column = |b: f64, s: f64| {
            let (plus, minus) = (self.phase(beta + b, sigma + s), self.phase(beta - b, sigma - s));
            [0, 1].map(|i| (plus[i] - minus[i]) / (2.0 * h))
        };
        let ([a, c], [b, d]) = (column(h, 0.0), column(0.0, h));
        let (half, determinant) = (0.5 * (a + d), a * d - b * c);
        (half.abs() + (half * half - determinant).sqrt()).powi(2)
    }
}

#[test]
fn stiff_tracking_comes_near_to_the_limit() {
    let gait = GAITS.iter().copied().find(|g| g.description().key == "trot").unwrap();
    let motion = optimum(gait, Criterion::Energy);
    let limit = stability(gait, &motion).unwrap().clock.factor;
    let error = |stiffness: f64| {
        let driven = Driven { tracked: Tracked::new(gait, &motion, false), stiffness };
        (driven.factor(&motion) / limit - 1.0).abs()
    };
    let (soft, stiff) = (error(500.0), error(2000.0));
    // The error falls like the time that tracking takes.
    assert!(soft < 0.2 && stiff < 0.3 * soft, "{limit}: {soft} {stiff}");
}

/// One freedom: the robot on the path of its gait, at the gait's own time τ and with some σ, through a phase and its
/// impact. `None` if it falls back.
fn along_the_path(tracked: &Tracked, motion: &Motion, phase: usize, entry: f64) -> Option<f64> {
    let h = &motion.phases[phase];
    let (duration, mut sigma) = (h.duration, entry);
    let start = {
        let [q, mut qd] = tracked.posture(phase, 0.0, h.beta_initial);
        qd[tracked.d.unactuated] = h.betad_initial;
        At { phase, time: 0.0, beta: h.beta_initial, sigma: tracked.terms(phase, &q, &qd)[2], ..At::default() }
    };
    // Newton's law in small steps of τ, by the midpoint rule: σ̇ is gravity's, τ̇ the share of the gait's velocity.
    let (steps, mut at) = (2000, start);
    let path = |at: &At| {
        let [q, mut qd] = tracked.posture(phase, at.time, at.beta);
        let [f1, f2, ..] = tracked.terms(phase, &q, &qd);
        qd[tracked.d.unactuated] = (at.sigma - f2) / f1;
        (q, qd)
    };
    for k in 0..steps {
        let dt = duration / steps as f64;
        let middle = tracked.until(at, (k as f64 + 0.5) * dt);
        let (q, qd) = path(&middle);
        let [_, _, inertia, _, moment] = tracked.terms(phase, &q, &qd);
        let change = |sigma: f64| moment * dt * inertia / sigma;
        let half = sigma + 0.5 * change(sigma);
        if half * entry <= 0.0 || sigma * entry <= 0.0 {
            return None;
        }
        sigma += change(half);
        at = tracked.until(middle, (k + 1) as f64 * dt);
    }
    let (q, qd) = path(&at);
    let share = sigma / tracked.terms(phase, &q, &qd)[2];
    let qd: Vec<f64> = qd.iter().map(|rate| share * rate).collect();
    let mut velocity = vec![0.0; tracked.d.positions()];
    tracked.gait.platform_velocity(tracked.mode(phase), &q, &qd, &mut velocity);
    let landed = &tracked.d.shapes.impact;
    let mut impact = landed.zeros();
    tracked.gait.impact(tracked.d.transition(phase).lands().unwrap(), &q, &[&velocity[..], &qd].concat(), &mut impact);
    let (q, qd) = (tracked.renamed(phase, &q), tracked.renamed(phase, &landed.xd_plus.of(&impact)[velocity.len()..]));
    Some(tracked.terms((phase + 1) % tracked.d.phases.len(), &q, &qd)[2])
}

#[test]
fn the_map_of_phase_tracking_is_that_of_simulated_steps() {
    let mut maps = 0;
    for (gait, criterion) in walking().flat_map(|g| Criterion::ALL.map(|c| (*g, c))) {
        let motion = optimum(gait, criterion);
        let (d, found) = (gait.description(), stability(gait, &motion).unwrap().phase);
        let PhaseTracking::Map { factor, slowest_entry, .. } = found else { continue };
        maps += 1;
        let tracked = Tracked::new(gait, &motion, false);
        let h = &motion.phases[0];
        let [q, mut qd] = tracked.posture(0, 0.0, h.beta_initial);
        qd[d.unactuated] = h.betad_initial;
        let sigma = tracked.terms(0, &q, &qd)[2];
        let twice = |share: f64| {
            let once = along_the_path(&tracked, &motion, 0, share * sigma)?;
            Some(along_the_path(&tracked, &motion, 1 % d.phases.len(), once)? / sigma)
        };
        // Affine in σ²: deviations need not be small.
        for share in [0.5 * (1.0 + slowest_entry), 1.3_f64] {
            let expected = 1.0 + factor * (share * share - 1.0);
            let found = twice(share).unwrap();
            assert!((found * found - expected).abs() < 1e-4, "{} {criterion:?}: {found} {expected}", d.key);
        }
        assert!(slowest_entry > 0.0 && twice(0.99 * slowest_entry).is_none() && twice(1.01 * slowest_entry).is_some());
    }
    assert!(maps >= 3, "{maps}");
}
