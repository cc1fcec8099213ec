//! The motion of virtual legs, lifted to the real robot: every joint, the platform in space, torques and reactions.

use super::equations::Equations;
use super::limits::{Limit, Limits};
use super::margin::best;
use super::posture::{Legs, Posture};
use super::shares::Shares;
use crate::model::Gait;
use crate::motion::Motion;
use crate::stance::Undefined;
use crate::walk::{Moment, Point, Walk};
use nalgebra::DVector;

/// Why there is no lifted motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotLifted {
    #[error(
        "{gait} has no generated model of its real legs: families of robots do not; build the robot from its specification"
    )]
    NoWhole { gait: String },
    #[error(transparent)]
    Undefined(#[from] Undefined),
    #[error("the cone program for the shares of the feet at {time:.4} s was not solved")]
    Unsolved { time: f64 },
}

/// The whole robot at one instant of support.
#[derive(Clone, Debug)]
pub struct Instant {
    /// From the beginning of the step, s.
    pub time: f64,
    /// 0 or 1.
    pub half_step: usize,
    pub posture: Posture,
    /// Real legs on the ground.
    pub stance: Vec<usize>,
    /// Of every joint of the whole robot, N·m.
    pub torque: Vec<f64>,
    /// On every foot, world axes, N.
    pub reactions: Vec<Point>,
    /// Least margin of the limits on the legs in support, and which are in the way of more.
    pub margin: f64,
    pub binding: Vec<(Limit, f64)>,
    /// What the equations of motion lack with these shares, and with equal ones: weight, weight × leg length.
    pub remainder: f64,
    pub equal_remainder: f64,
}

/// The whole robot when feet land.
#[derive(Clone, Debug)]
pub struct Impact {
    pub time: f64,
    /// The half step that it ends, 0 or 1.
    pub half_step: usize,
    /// Before.
    pub posture: Posture,
    /// u after less u before.
    pub change: Vec<f64>,
    /// Real legs that land.
    pub landing: Vec<usize>,
    /// On every foot, world axes, N·s.
    pub impulses: Vec<Point>,
    pub margin: f64,
    pub binding: Vec<(Limit, f64)>,
    /// As for an instant; momentum at 1 m/s, and that times the leg length.
    pub remainder: f64,
    pub equal_remainder: f64,
}

/// One whole step of the real robot.
pub struct Lift<'a> {
    pub legs: Legs<'a>,
    /// In order of time.
    pub instants: Vec<Instant>,
    /// At the end of each half step.
    pub impacts: Vec<Impact>,
    /// s.
    pub durations: [f64; 2],
    /// Forward travel in the step, m.
    pub travel: f64,
}

impl<'a> Lift<'a> {
    /// At equally spaced times, both ends of each half step among them.
    ///
    /// # Errors
    /// If there is no model of the whole robot or no such motion.
    pub fn even(gait: &'a dyn Gait, motion: &Motion, intervals: usize) -> Result<Lift<'a>, NotLifted> {
        let walk = Walk::even(gait, motion, intervals)?;
        Lift::new(gait, &walk.moments, &walk)
    }

    /// At multiples of 1/`rate` (Hz), and at the end of each half step.
    ///
    /// # Errors
    /// As for [`Lift::even`].
    pub fn at_rate(gait: &'a dyn Gait, motion: &Motion, rate: f64) -> Result<Lift<'a>, NotLifted> {
        let (ends, mut walk) = (Walk::even(gait, motion, 1)?, Walk::at_rate(gait, motion, rate)?);
        walk.moments.extend(ends.moments.into_iter().filter(|m| m.share == 1.0));
        walk.moments.sort_by(|a, b| {
            (a.half_step, a.time).partial_cmp(&(b.half_step, b.time)).unwrap_or(std::cmp::Ordering::Equal)
        });
        Lift::new(gait, &walk.moments, &walk)
    }

    fn new(gait: &'a dyn Gait, moments: &[Moment], walk: &Walk) -> Result<Lift<'a>, NotLifted> {
        let no_whole = || NotLifted::NoWhole { gait: gait.description().key.into() };
        let legs = Legs::new(gait).ok_or_else(no_whole)?;
        let instants = moments.iter().map(|m| legs.support(m)).collect::<Result<_, _>>()?;
        // The last moment of each half step.
        let ends = |k: usize| moments.get(k + 1).is_none_or(|next| next.half_step != moments[k].half_step);
        let impact = |k: usize| legs.impact(gait, &moments[k]);
        let impacts = (0..moments.len()).filter(|k| ends(*k)).map(impact).collect::<Result<_, _>>()?;
        Ok(Lift { legs, instants, impacts, durations: walk.half_steps.map(|h| h.duration), travel: walk.travel })
    }
}

impl Legs<'_> {
    /// What the real legs do at a moment of the gait.
    ///
    /// # Errors
    /// If the cone program is not solved.
    pub fn support(&self, m: &Moment) -> Result<Instant, NotLifted> {
        let posture = self.posture(m);
        let equations = Equations::new(self.whole, &posture, self.description.leg_length());
        let stance: Vec<usize> = self.members(m.stance).collect();
        let (demand, columns) = (equations.demand(&posture.ud), equations.columns(&stance));
        let equal = self.equal(&posture, &stance, m.force);
        // The platform has no motors: its six equations are the reactions' alone.
        let shares = Shares::new(&columns.rows(0, 6).into_owned(), &demand.rows(0, 6).into_owned(), &equal);
        let rooms = Limits { legs: self }.support(&stance, &posture, &shares, &demand, &columns);
        let best = best(&rooms, shares.squeezes.ncols()).ok_or(NotLifted::Unsolved { time: m.time })?;

        let mut equal_lack = &demand - &columns * &equal;
        (0..self.joints.len()).for_each(|j| equal_lack[6 + j] -= m.torque[self.joints[j]] / self.sharing(j));
        let reactions = shares.reactions(&best.s);
        let torque = (&demand - &columns * &reactions).as_slice()[6..].to_vec();
        Ok(Instant {
            time: m.time,
            half_step: m.half_step,
            reactions: self.spread(&posture, &stance, &reactions),
            posture,
            stance,
            torque,
            margin: best.margin,
            binding: best.binding,
            remainder: equations.scaled(&shares.remainder),
            equal_remainder: equations.scaled(&equal_lack),
        })
    }

    /// What the real legs do at the impact that ends a half step, of which `m` is the last moment.
    ///
    /// # Errors
    /// If the cone program is not solved.
    pub fn impact(&self, gait: &dyn Gait, m: &Moment) -> Result<Impact, NotLifted> {
        let d = self.description;
        let (nc, n) = (d.positions(), d.positions() + d.orientations());
        let posture = self.posture(m);
        let equations = Equations::new(self.whole, &posture, d.leg_length());
        let virtual_leg = 1 - m.stance;
        let landing: Vec<usize> = self.members(virtual_leg).collect();
        let before = [&m.platform[1][..nc], &m.qd].concat();
        let mut out = vec![0.0; n + nc];
        gait.impact(virtual_leg, &m.q, &before, &mut out);
        let change: Vec<f64> = out.iter().zip(&before).map(|(after, before)| after - before).collect();
        let (mut platform, mut impulse) = ([0.0; 3], [0.0; 3]);
        platform[..nc].copy_from_slice(&change[..nc]);
        impulse[..nc].copy_from_slice(&out[n..]);
        let change = self.speeds(&posture.axes, platform, &change[nc..]);

        // No joint takes an impulse: all equations are the feet's alone.
        let (demand, columns) = (equations.impulse_demand(&change), equations.columns(&landing));
        let equal = self.equal(&posture, &landing, impulse);
        let shares = Shares::new(&columns, &demand, &equal);
        let rooms = Limits { legs: self }.impact(&landing, &posture, &shares);
        let best = best(&rooms, shares.squeezes.ncols()).ok_or(NotLifted::Unsolved { time: m.time })?;
        Ok(Impact {
            time: m.time,
            half_step: m.half_step,
            impulses: self.spread(&posture, &landing, &shares.reactions(&best.s)),
            posture,
            change,
            landing,
            margin: best.margin,
            binding: best.binding,
            remainder: equations.scaled_impulse(&shares.remainder),
            equal_remainder: equations.scaled_impulse(&(&demand - &columns * &equal)),
        })
    }

    /// Equal shares of a virtual leg's reaction (world axes) in the platform's axes.
    fn equal(&self, posture: &Posture, feet: &[usize], force: Point) -> DVector<f64> {
        let share = posture.inside(force.map(|f| f / feet.len() as f64));
        DVector::from_iterator(3 * feet.len(), feet.iter().flat_map(|_| share))
    }

    /// Of all feet, in world axes.
    fn spread(&self, posture: &Posture, feet: &[usize], reactions: &DVector<f64>) -> Vec<Point> {
        let mut all = vec![[0.0; 3]; self.legs.len()];
        for (leg, r) in feet.iter().zip(reactions.as_slice().chunks_exact(3)) {
            all[*leg] = posture.outside([r[0], r[1], r[2]]);
        }
        all
    }
}
