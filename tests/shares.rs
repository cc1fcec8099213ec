//! Three feet to a virtual leg: what the cheapest of all shares cost, against minimizations that share nothing with them.

use piaffe::Robot;
use piaffe::four_legs::{Equations, Instant, Lift, PLATFORM, RealLegs, Sharing};
use piaffe::interpreter::Interpreted;
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::verify::verify;
use piaffe_codegen::{RobotFiles, SpecFile};

fn hexapod() -> Interpreted {
    let file = |path: &str, text: &str| SpecFile { path: path.into(), text: text.into() };
    let robot = file("robot.toml", include_str!("shares/hexapod.toml"));
    let gaits = vec![file("gaits/tripod.toml", include_str!("shares/tripod.toml"))];
    Robot::new(RobotFiles { module: String::new(), robot, gaits }).unwrap().gait("tripod").unwrap()
}

fn optimum(gait: &Interpreted, criterion: Criterion, speed: f64) -> Motion {
    let settings = Settings { starts: Some(2), ..Settings::default() };
    search(gait, criterion, speed, &settings, &|_| {}).optima[0].local.motion.clone()
}

/// Solves a few linear equations, the right side in the last column.
fn solved(mut m: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = m.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs()))?;
        m.swap(k, pivot);
        if m[k][k].abs() < 1e-12 {
            return None;
        }
        for row in 0..n {
            if row != k {
                let factor = m[row][k] / m[k][k];
                (k..=n).for_each(|j| m[row][j] -= factor * m[k][j]);
            }
        }
    }
    Some((0..n).map(|k| m[k][n] / m[k][k]).collect())
}

/// What the equations of an instant ask of the reactions on three feet, and what is left for the motors of their legs:
/// (columns, demand) of the platform's six, and of the joints with their rates.
struct Asked {
    platform: Vec<(Vec<f64>, f64)>,
    motors: Vec<(Vec<f64>, f64, f64)>,
}

fn asked(lift: &Lift, i: &Instant) -> Asked {
    let legs = &lift.legs;
    let equations = Equations::new(legs.whole, &i.posture, legs.description.leg_length());
    let (demand, columns) = (equations.demand(&i.posture.ud), equations.columns(&i.stance));
    let row = |k: usize| (columns.row(k).to_vec(), demand[k]);
    let motor = |j: usize| {
        let (columns, demand) = row(PLATFORM + j);
        let (angle, rate) = (i.posture.q[j], i.posture.rates()[j]);
        (columns, demand + legs.passive[j].map_or(0.0, |passive| passive.torque(angle, rate)), rate)
    };
    Asked { platform: (0..PLATFORM).map(row).collect(), motors: (0..legs.joints.len()).map(motor).collect() }
}

impl Asked {
    fn torques(&self, reactions: &[f64]) -> Vec<f64> {
        let felt = |columns: &[f64]| columns.iter().zip(reactions).map(|(a, b)| a * b).sum::<f64>();
        self.motors.iter().map(|(columns, demand, _)| demand - felt(columns)).collect()
    }

    fn torque(&self, reactions: &[f64]) -> f64 {
        3.0 * self.torques(reactions).iter().map(|torque| torque * torque).sum::<f64>()
    }

    fn energy(&self, reactions: &[f64]) -> f64 {
        self.torques(reactions).iter().zip(&self.motors).map(|(torque, motor)| (torque * motor.2).abs()).sum()
    }

    /// Least squares under the platform's equations, by Lagrange's conditions. No motor feels how hard the feet push against each other
    /// across: a trifle keeps that from being anything.
    fn least_torque(&self) -> f64 {
        let mut system = vec![vec![0.0; 16]; 15];
        (0..9).for_each(|k| system[k][k] = 1e-10);
        for (columns, demand, _) in &self.motors {
            for a in 0..9 {
                (0..9).for_each(|b| system[a][b] += columns[a] * columns[b]);
                system[a][15] += columns[a] * demand;
            }
        }
        for (k, (columns, demand)) in self.platform.iter().enumerate() {
            for a in 0..9 {
                (system[a][9 + k], system[9 + k][a]) = (columns[a], columns[a]);
            }
            system[9 + k][15] = *demand;
        }
        self.torque(&solved(system).unwrap()[..9])
    }

    /// Σ |power| is least where two of the motors that feel the reactions do nothing: the best of all such corners. Across, one
    /// foot does nothing.
    fn least_energy(&self) -> f64 {
        let feel: Vec<_> = self.motors.iter().filter(|(columns, ..)| columns.iter().any(|x| x.abs() > 1e-9)).collect();
        assert_eq!(feel.len(), 6);
        let across: Vec<f64> = (0..9).map(|k| f64::from(k == 2)).collect();
        let mut least = f64::INFINITY;
        for a in 0..feel.len() {
            for b in 0..a {
                let idle = [a, b].map(|k| (&feel[k].0, feel[k].1));
                let all = self.platform.iter().map(|(columns, demand)| (columns, *demand)).chain(idle);
                let rows = all.chain([(&across, 0.0)]);
                let rows = rows.map(|(columns, demand)| columns.iter().copied().chain([demand]).collect());
                least = solved(rows.collect()).map_or(least, |reactions| least.min(self.energy(&reactions)));
            }
        }
        least
    }
}

fn energy(powers: &[f64]) -> f64 {
    powers.iter().map(|power| power.abs()).sum()
}

#[test]
fn no_shares_of_three_feet_are_cheaper_than_the_cheapest() {
    let gait = hexapod();
    let mut dearer = 0.0f64;
    for (criterion, speed) in [(Criterion::Torque, 0.3), (Criterion::Energy, 0.5)] {
        let motion = optimum(&gait, criterion, speed);
        let lifts = [Sharing::LeastCost(Criterion::Torque), Sharing::LeastCost(Criterion::Energy), Sharing::MostRoom]
            .map(|sharing| Lift::at_rate(&gait, &motion, 60.0, sharing).unwrap());
        for k in 0..lifts[0].instants.len() {
            let [by_torque, by_energy, roomy] = lifts.each_ref().map(|lift| &lift.instants[k]);
            let (asked, ways) = (asked(&lifts[0], roomy), &roomy.efforts);
            assert_eq!(roomy.stance.len(), 3);
            let near = |found: f64, expected: f64, what: &str| {
                assert!((found / expected - 1.0).abs() < 1e-6, "{what} at {} s: {found} {expected}", roomy.time)
            };
            near(ways.least.torque, asked.least_torque(), "torque");
            near(energy(&ways.least.powers), asked.least_energy(), "energy");
            // Within the limits, where there is room, and not below what is least without them.
            for (of, cost) in [(by_torque, ways.within_limits.torque), (by_energy, energy(&ways.within_limits.powers))]
            {
                assert!(of.room >= roomy.margin.min(0.0) - 1e-8, "{} {}", of.room, roomy.margin);
                let reactions: Vec<f64> =
                    of.stance.iter().flat_map(|leg| of.posture.inside(of.reactions[*leg])).collect();
                let again =
                    if std::ptr::eq(of, by_torque) { asked.torque(&reactions) } else { asked.energy(&reactions) };
                near(again, cost, "what is written");
            }
            let torques = [&ways.within_limits, &roomy.effort, &ways.proportional].map(|effort| effort.torque);
            let energies = [&ways.within_limits, &roomy.effort, &ways.proportional].map(|e| energy(&e.powers));
            assert!(torques.iter().all(|torque| *torque >= ways.least.torque * (1.0 - 1e-9)), "{torques:?}");
            let least = energy(&ways.least.powers);
            assert!(energies.iter().all(|energy| *energy >= least * (1.0 - 1e-6)), "{energies:?} {least}");
            // Where others are within the limits too, these cost no more.
            assert!(roomy.margin < 0.0 || torques[0] <= torques[1] * (1.0 + 1e-6), "{torques:?}");
            assert!(roomy.margin < 0.0 || energies[0] <= energies[1] * (1.0 + 1e-6), "{energies:?}");
        }
        let costs = RealLegs::new(&gait, &motion).unwrap().costs;
        let roomy = Lift::close(&gait, &motion, Sharing::MostRoom).unwrap().costs();
        println!("{criterion:?} {speed}: {costs:?} {roomy:?}");
        for of in Criterion::ALL {
            let others = [costs.within_limits, costs.proportional, roomy].map(|costs| costs.of(of));
            assert!(
                others.iter().all(|other| *other >= costs.least.of(of) * (1.0 - 1e-5)),
                "{of:?} {costs:?} {roomy:?}"
            );
            dearer = dearer.max(roomy.of(of) / costs.least.of(of));
        }
        assert_eq!(
            Lift::close(&gait, &motion, Sharing::LeastCost(criterion)).unwrap().costs().of(criterion),
            costs.within_limits.of(criterion)
        );
    }
    assert!(dearer > 1.1, "the shares with most room are dearer: {dearer}");
}

/// Dry friction makes torques jump where joints turn around: what the virtual legs cost is what the receipt's own integration gives.
#[test]
fn costs_are_those_of_the_receipt_where_torques_jump() {
    let gait = hexapod();
    for criterion in Criterion::ALL {
        let motion = optimum(&gait, criterion, 0.4);
        let stated = verify(piaffe::model::Gait::description(&gait), &motion, 0.4, 2001).unwrap().costs;
        let found = RealLegs::new(&gait, &motion).unwrap().costs.virtual_legs;
        println!("{criterion:?}: {stated:?} {found:?}");
        for of in Criterion::ALL {
            assert!((found.of(of) / stated.of(of) - 1.0).abs() < 2e-6, "{of:?}: {found:?} {stated:?}");
        }
    }
}
