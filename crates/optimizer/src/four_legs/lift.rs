//! The motion of virtual legs, lifted to the real robot: every joint, the platform in space, torques and reactions.

use super::cheapest::Cheapest;
use super::cost::{Effort, Motor, Ways, costs};
use super::equations::{Equations, PLATFORM};
use super::lack::Lack;
use super::limits::{Affine, Limit, Limits};
use super::margin::{Choice, best, lowest};
use super::posture::{Legs, Posture};
use super::rows::{Rows, dot};
use super::shares::{Reactions, Shares};
use crate::flow::Undefined;
use crate::walk::{Moment, Point, Walk};
use piaffe_model::Gait;
use piaffe_model::motion::{Costs, Criterion, Motion};
use rayon::prelude::*;

/// Squeezes whose levers at a joint are shorter than this part of a leg do nothing there.
const ROUNDING: f64 = 1e-12;

/// Intervals of each phase between the instants that are looked at.
const INTERVALS: usize = 400;

/// Why there is no lifted motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotLifted {
    #[error(
        "{gait} has no generated model of its real legs: families of robots do not; build the robot from its specification"
    )]
    NoWhole { gait: String },
    #[error(transparent)]
    Undefined(#[from] Undefined),
    #[error("the cone programs for the shares of the feet at {time:.4} s were not solved")]
    Unsolved { time: f64 },
}

/// Which of the shares that there are a lifted motion has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// Those that leave most room within the limits.
    MostRoom,
    /// Of those that keep to the limits the cheapest; at instants at which none do, those with the most room.
    LeastCost(Criterion),
}

/// The whole robot at one instant, in support or in flight.
#[derive(Clone, Debug)]
pub struct Instant {
    /// From the beginning of the step, s.
    pub time: f64,
    /// Which phase of the step.
    pub phase: usize,
    pub posture: Posture,
    /// Real legs on the ground; none in flight.
    pub stance: Vec<usize>,
    /// Of every joint of the whole robot, N·m.
    pub torque: Vec<f64>,
    /// On every foot, world axes, N.
    pub reactions: Vec<Point>,
    /// Least margin of the limits on the legs in support, in flight of all legs, with these shares.
    pub room: f64,
    /// What the joints do with them.
    pub effort: Effort,
    /// The same margin with the most room that there is, and which limits are in the way of more.
    pub margin: f64,
    pub binding: Vec<(Limit, f64)>,
    /// What the equations of motion lack with the best shares, and with equal ones.
    pub lack: Lack,
    pub equal_lack: Lack,
    /// What the joints do, by ways to share.
    pub efforts: Ways<Effort>,
}

/// The whole robot when feet land.
#[derive(Clone, Debug)]
pub struct Impact {
    pub time: f64,
    /// The phase of the step that it ends.
    pub phase: usize,
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
    /// As for an instant.
    pub lack: Lack,
    pub equal_lack: Lack,
}

/// One whole step of the real robot.
pub struct Lift<'a> {
    pub legs: Legs<'a>,
    /// In order of time.
    pub instants: Vec<Instant>,
    /// Where feet land.
    pub impacts: Vec<Impact>,
    /// s.
    pub durations: Vec<f64>,
    /// Forward travel in the step, m.
    pub travel: f64,
}

impl<'a> Lift<'a> {
    /// At equally spaced times, both ends of each phase among them, with the most room.
    ///
    /// # Errors
    /// If there is no model of the whole robot or no such motion.
    pub fn even(gait: &'a dyn Gait, motion: &Motion, intervals: usize) -> Result<Lift<'a>, NotLifted> {
        let walk = Walk::even(gait, motion, intervals)?;
        Lift::new(gait, &walk.moments, &walk, Sharing::MostRoom)
    }

    /// At such times and on both sides of where dry friction changes its sign: those that a verdict and costs are made of.
    ///
    /// # Errors
    /// As for [`Lift::even`].
    pub fn close(gait: &'a dyn Gait, motion: &Motion, sharing: Sharing) -> Result<Lift<'a>, NotLifted> {
        let walk = Walk::even_between_turns(gait, motion, INTERVALS)?;
        Lift::new(gait, &walk.moments, &walk, sharing)
    }

    /// At multiples of 1/`rate` (Hz), and at the end of each phase.
    ///
    /// # Errors
    /// As for [`Lift::even`].
    pub fn at_rate(gait: &'a dyn Gait, motion: &Motion, rate: f64, sharing: Sharing) -> Result<Lift<'a>, NotLifted> {
        let (ends, mut walk) = (Walk::even(gait, motion, 1)?, Walk::at_rate(gait, motion, rate)?);
        walk.moments.extend(ends.moments.into_iter().filter(|m| m.share == 1.0));
        walk.moments
            .sort_by(|a, b| (a.phase, a.time).partial_cmp(&(b.phase, b.time)).unwrap_or(std::cmp::Ordering::Equal));
        Lift::new(gait, &walk.moments, &walk, sharing)
    }

    fn new(gait: &'a dyn Gait, moments: &[Moment], walk: &Walk, sharing: Sharing) -> Result<Lift<'a>, NotLifted> {
        let no_whole = || NotLifted::NoWhole { gait: gait.description().key.into() };
        let legs = Legs::new(gait).ok_or_else(no_whole)?;
        // Of several failures the first one is told.
        let instants: Vec<_> = moments.par_iter().map(|m| legs.instant(m, sharing)).collect();
        let instants = instants.into_iter().collect::<Result<_, _>>()?;
        // The last moment of each phase.
        let ends = |k: usize| moments.get(k + 1).is_none_or(|next| next.phase != moments[k].phase);
        let landings =
            (0..moments.len()).filter(|k| ends(*k)).filter_map(|k| Some((&moments[k], moments[k].transition.lands()?)));
        let impacts = landings.map(|(m, leg)| legs.impact(gait, m, leg)).collect::<Result<_, _>>()?;
        Ok(Lift {
            legs,
            instants,
            impacts,
            durations: walk.phases.iter().map(|phase| phase.duration).collect(),
            travel: walk.travel,
        })
    }

    /// What the joints cost with the shares that it has.
    pub fn costs(&self) -> Costs {
        costs(self, |instant| &instant.effort)
    }
}

impl Legs<'_> {
    /// What the real legs do at a moment of the gait.
    ///
    /// # Errors
    /// If a cone program is not solved.
    pub fn instant(&self, m: &Moment, sharing: Sharing) -> Result<Instant, NotLifted> {
        let posture = self.posture(m);
        let equations = Equations::new(self.whole, &posture, self.description.leg_length());
        let stance: Vec<usize> = m.mode.stance().into_iter().flat_map(|leg| self.members(leg)).collect();
        let (mut demand, columns) = (equations.demand(&posture.ud), equations.columns(&stance));
        // What overcomes springs and friction is demanded of the motors, too.
        let moves = posture.q.iter().zip(posture.rates());
        for ((demand, passive), (angle, rate)) in demand[PLATFORM..].iter_mut().zip(&self.passive).zip(moves) {
            passive.iter().for_each(|passive| *demand += passive.torque(*angle, *rate));
        }
        let equal = self.equal(&posture, &stance, m.force);
        // The platform has no motors: its six equations are the reactions' alone. In flight nothing is left to meet them: they hold,
        // or are lacking.
        let shares = Shares::new(&equations.ranks(&columns, &demand, PLATFORM, self.axis()), &equal);
        let motors = self.motors(&posture, &shares, &demand, &columns);
        let rooms = Limits { legs: self }.instant(&stance, &posture, &shares, &motors);
        let unsolved = || NotLifted::Unsolved { time: m.time };
        let choice = Choice::new(&rooms, shares.squeezes.len()).ok_or_else(unsolved)?;
        let proportional = shares.nearest_to(&self.proportional(&posture, &shares.nearest));
        let cheapest = Cheapest { motors: &motors, rooms: &rooms, choice: &choice };
        let cheapest = |criterion| cheapest.shares(criterion).ok_or_else(unsolved);
        let [[energy, energy_within], [torque, torque_within]] =
            [cheapest(Criterion::Energy)?, cheapest(Criterion::Torque)?];
        // Of two feet the share that costs least keeps near to equal; of more feet it may jump where it is not the equal one.
        let jumps = |s: &[f64]| s.len() > 1 && s.iter().any(|s| *s != 0.0);
        let efforts = Ways {
            virtual_legs: Effort {
                powers: m.torque.iter().zip(&m.qd).map(|(torque, rate)| torque * rate).collect(),
                torque: m.torque.iter().map(|torque| torque * torque).sum(),
                jumps: false,
            },
            least: Effort { jumps: jumps(&energy), ..Effort::new(&motors, &energy, &torque) },
            within_limits: Effort {
                jumps: jumps(&energy_within),
                ..Effort::new(&motors, &energy_within, &torque_within)
            },
            proportional: Effort::new(&motors, &proportional, &proportional),
        };
        let best = choice.best;
        let (s, jumps) = match sharing {
            Sharing::MostRoom => (&best.s, false),
            Sharing::LeastCost(Criterion::Energy) => (&energy_within, jumps(&energy_within)),
            Sharing::LeastCost(Criterion::Torque) => (&torque_within, false),
        };

        let mut equal_lack = less(&demand, &columns, &equal);
        (0..self.joints.len()).for_each(|j| equal_lack[PLATFORM + j] -= m.torque[self.joints[j]] / self.sharing(j));
        let reactions = shares.reactions(s);
        let mut left = less(&demand, &columns, &reactions);
        let torque = left.split_off(PLATFORM);
        let lack = |left: &[f64]| Lack::new(left, &posture, self.weight(), self.description.leg_length());
        let (lack, equal_lack) = (lack(&left), lack(&equal_lack));
        Ok(Instant {
            time: m.time,
            phase: m.phase,
            reactions: self.spread(&posture, &stance, &reactions),
            posture,
            stance,
            torque,
            room: lowest(&rooms, s),
            effort: Effort { jumps, ..Effort::new(&motors, s, s) },
            margin: best.margin,
            binding: best.binding,
            lack,
            equal_lack,
            efforts,
        })
    }

    /// What the real legs do where the foot of `virtual_leg` lands; `m` is the last moment before.
    ///
    /// # Errors
    /// If a cone program is not solved.
    pub fn impact(&self, gait: &dyn Gait, m: &Moment, virtual_leg: usize) -> Result<Impact, NotLifted> {
        let d = self.description;
        let (nc, shape) = (d.positions(), &gait.description().shapes.impact);
        let posture = self.posture(m);
        let equations = Equations::new(self.whole, &posture, d.leg_length());
        let landing: Vec<usize> = self.members(virtual_leg).collect();
        let before = [&m.platform[1][..nc], &m.qd].concat();
        let mut out = shape.zeros();
        gait.impact(virtual_leg, &m.q, &before, &mut out);
        let change: Vec<f64> =
            shape.xd_plus.of(&out).iter().zip(&before).map(|(after, before)| after - before).collect();
        let (mut platform, mut impulse) = ([0.0; 3], [0.0; 3]);
        platform[..nc].copy_from_slice(&change[..nc]);
        impulse[..nc].copy_from_slice(shape.impulse.of(&out));
        let change = self.speeds(&posture.axes, platform, &change[nc..]);

        // No joint takes an impulse: all equations are the feet's alone.
        let (demand, columns) = (equations.impulse_demand(&change), equations.columns(&landing));
        let equal = self.equal(&posture, &landing, impulse);
        let shares = Shares::new(&equations.ranks(&columns, &demand, demand.len(), self.axis()), &equal);
        let rooms = Limits { legs: self }.impact(&landing, &posture, &shares);
        let best = best(&rooms, shares.squeezes.len()).ok_or(NotLifted::Unsolved { time: m.time })?;
        let impulses = shares.reactions(&best.s);
        let lack =
            |impulses: &[f64]| Lack::new(&less(&demand, &columns, impulses), &posture, self.momentum(), d.leg_length());
        let (lack, equal_lack) = (lack(&impulses), lack(&equal));
        Ok(Impact {
            time: m.time,
            phase: m.phase,
            impulses: self.spread(&posture, &landing, &impulses),
            posture,
            change,
            landing,
            margin: best.margin,
            binding: best.binding,
            lack,
            equal_lack,
        })
    }

    /// Equal shares of a virtual leg's reaction (world axes) in the platform's axes.
    fn equal(&self, posture: &Posture, feet: &[usize], force: Point) -> Reactions {
        let share = posture.inside(force.map(|f| f / feet.len() as f64));
        feet.iter().flat_map(|_| share).collect()
    }

    /// These reactions with their tangential parts in proportion to the vertical ones.
    fn proportional(&self, posture: &Posture, reactions: &[f64]) -> Reactions {
        let feet = reactions.chunks_exact(3).map(|r| posture.outside([r[0], r[1], r[2]]));
        let all = feet.clone().fold([0.0; 3], |sum, foot| [0, 1, 2].map(|k| sum[k] + foot[k]));
        feet.flat_map(|foot| posture.inside([all[0] * foot[1] / all[1], foot[1], all[2] * foot[1] / all[1]])).collect()
    }

    /// All joints with their torques over the choice of shares, Γ = demand − D F.
    pub fn motors(&self, posture: &Posture, shares: &Shares, demand: &[f64], columns: &Rows) -> Vec<Motor> {
        // A lever that is shorter is none but for rounding.
        let shortest = ROUNDING * self.description.leg_length();
        let motor = |joint: usize| {
            let mut torque =
                Affine::of(columns.row(PLATFORM + joint), 0, shares).mapped(demand[PLATFORM + joint], -1.0);
            torque.slope.iter_mut().filter(|lever| lever.abs() < shortest).for_each(|lever| *lever = 0.0);
            Motor { torque, rate: posture.rates()[joint], sharing: self.sharing(joint) }
        };
        (0..self.joints.len()).map(motor).collect()
    }

    /// Of all feet, in world axes.
    fn spread(&self, posture: &Posture, feet: &[usize], reactions: &[f64]) -> Vec<Point> {
        let mut all = vec![[0.0; 3]; self.legs.len()];
        for (leg, r) in feet.iter().zip(reactions.chunks_exact(3)) {
            all[*leg] = posture.outside([r[0], r[1], r[2]]);
        }
        all
    }
}

/// What reactions leave of the demand: demand − columns F.
fn less(demand: &[f64], columns: &Rows, reactions: &[f64]) -> Vec<f64> {
    columns.iter().zip(demand).map(|(row, demand)| demand - dot(row, reactions)).collect()
}
