//! The real legs behind the virtual ones: kinematics, equal shares, and the best shares against all others.

#[path = "export/program.rs"]
mod program;
#[path = "export/python.rs"]
mod python;
#[path = "gaits/walking.rs"]
mod walking;

use piaffe::altered::Altered;
use piaffe::constraints::sharing::BALANCED;
use piaffe::cycle::{Cycle, theta};
use piaffe::examine::Examination;
use piaffe::export::{controller::controller, mjcf::mjcf, table::real_joints, urdf::urdf};
use piaffe::four_legs::{
    Component, Equations, Instant, Legs, Lift, Limits, PLATFORM, RealLegs, Shares, Sharing, Verdict, best,
};
use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::{Course, Criterion, Motion};
use piaffe::result::Status;
use piaffe::search::multi_start::Settings;
use piaffe::sqp::{Control, Problem, Values};
use piaffe::units::Units;
use piaffe::walk::{Moment, Walk};
use piaffe::{Robot, Task};
use piaffe_codegen::{Changes, Load, RobotFiles, SpecFile};
use program::{optimum, optimum_at, piaffe};
use python::{ask, python};
use serde_json::{Value, json};
use walking::walking;

fn gait(key: &str) -> &'static dyn Gait {
    *GAITS.iter().find(|g| g.description().key == key).unwrap()
}

/// Every moment of a gait's optimum with what is made of it.
fn lifted(gait: &'static dyn Gait) -> Vec<(Moment, Instant)> {
    let (_, motion) = optimum(gait, Criterion::Torque);
    let walk = Walk::even(gait, &motion, 25).unwrap();
    let lift = Lift::even(gait, &motion, 25).unwrap();
    assert_eq!(walk.moments.len(), lift.instants.len());
    walk.moments.into_iter().zip(lift.instants).collect()
}

fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn feet_are_where_the_walk_has_them_and_those_that_stand_are_at_rest() {
    for gait in walking() {
        let legs = Legs::new(*gait).unwrap();
        let w = legs.whole.description();
        for (m, i) in lifted(*gait) {
            let posture = &i.posture;
            let mut feet = vec![0.0; w.reactions() * (1 + w.speeds())];
            legs.whole.feet(&posture.q, &mut feet);
            let (places, jacobian) = feet.split_at(w.reactions());
            let mut bias = vec![0.0; w.reactions()];
            legs.whole.feet_bias(&posture.omega(), &posture.q, posture.rates(), &mut bias);
            for (real, leg) in w.legs.iter().enumerate() {
                let members = legs.description.legs[legs.legs[real]].members.iter();
                let member = members.clone().position(|member| member.name == leg.name).unwrap();
                let expected = m.chain(legs.description, legs.legs[real], member).pop().unwrap();
                let place = posture.outside([places[3 * real], places[3 * real + 1], places[3 * real + 2]]);
                assert!(close(&[0, 1, 2].map(|k| place[k] + posture.position[k]), &expected, 1e-12));
                if !i.stance.contains(&real) {
                    continue;
                }
                for c in 3 * real..3 * real + 3 {
                    let along = |u: &[f64]| (0..u.len()).map(|k| jacobian[k * w.reactions() + c] * u[k]).sum::<f64>();
                    // Equal joint rates of a pair keep its feet together.
                    assert!(along(&posture.u).abs() < 1e-9, "{} moves", leg.name);
                    assert!((along(&posture.ud) + bias[c]).abs() < 1e-8, "{} accelerates", leg.name);
                }
            }
            let [w, x, y, z] = posture.quaternion();
            let turned = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)];
            assert!(close(&turned, &posture.axes[0], 1e-12));
        }
    }
}

#[test]
fn in_curvet_and_trot_each_leg_does_half_and_no_shares_leave_more_room() {
    for key in ["curvet", "trot"] {
        let gait = gait(key);
        let d = gait.description();
        for criterion in Criterion::ALL {
            let (result, motion) = optimum(gait, criterion);
            let receipt = RealLegs::new(gait, &motion).unwrap();
            assert_eq!(receipt.verdict(), Verdict::EqualShares, "{receipt:?}");
            // So counted, equal shares cost on the real joints what the virtual legs' joints cost.
            let (cost, costs) = (result.cost.unwrap(), receipt.costs);
            let ways = [costs.virtual_legs, costs.least, costs.within_limits, costs.proportional]
                .map(|costs| costs.of(criterion));
            for real in ways {
                assert!((real / cost - 1.0).abs() < 1e-6, "{key} {criterion:?}: {real} {cost}");
            }
            assert!(
                receipt.equal_shares.support.share < 1e-12 && receipt.equal_shares.impact.share < 1e-12,
                "{receipt:?}"
            );
            assert!((receipt.largest_load - 0.5).abs() < 1e-9);
        }
        let legs = Legs::new(gait).unwrap();
        for (m, i) in lifted(gait) {
            let half: Vec<f64> = legs.joints.iter().map(|j| m.torque[*j] / 2.0).collect();
            assert!(close(&i.torque, &half, 1e-9), "{key} at {} s", m.time);
            let mut margin = f64::INFINITY;
            for leg in &i.stance {
                assert!(close(&i.reactions[*leg], &m.force.map(|f| f / 2.0), 1e-9));
            }
            // The virtual leg's own margins, from its own numbers.
            let weight = d.total_mass() * d.gravity;
            margin = margin.min((m.force[1] - d.limits.min_vertical_force) / weight);
            margin = margin.min((d.limits.friction * m.force[1] - m.force[0].hypot(m.force[2])) / weight);
            let leg = &d.legs[m.mode.stance().unwrap()];
            for j in leg.first_joint..leg.end_joint {
                let joint = &d.joints[j];
                let used = m.torque[j].abs() / joint.max_torque;
                margin = margin.min(1.0 - used);
                let fastest = joint.unloaded_speed - (joint.unloaded_speed - joint.loaded_speed) * used;
                margin = margin.min((fastest - m.qd[j].abs()) / joint.unloaded_speed);
            }
            assert!((i.margin - margin).abs() < 1e-7, "{key} at {} s: {} and {margin}", m.time, i.margin);
        }
    }
}

#[test]
fn in_an_amble_the_legs_of_a_side_do_together_what_the_virtual_leg_does() {
    let gait = gait("amble");
    let legs = Legs::new(gait).unwrap();
    let mut unequal = 0.0f64;
    for (m, i) in lifted(gait) {
        assert!(i.lack.share < 1e-12);
        let (mut torque, mut force) = (vec![0.0; gait.description().joints()], [0.0; 3]);
        legs.joints.iter().zip(&i.torque).for_each(|(j, gamma)| torque[*j] += gamma);
        i.reactions.iter().flatten().enumerate().for_each(|(k, f)| force[k % 3] += f);
        assert!(close(&torque, &m.torque, 1e-8) && close(&force, &m.force, 1e-8), "at {} s", m.time);
        unequal = unequal.max(i.equal_lack.share);
    }
    assert!(unequal > 0.1, "equal shares lack {unequal}");
}

/// The shares of two feet are a line: no point of it may leave more room than the one that was found.
#[test]
fn no_other_shares_leave_more_room() {
    for gait in walking().filter(|g| g.description().legs[0].members.len() == 2) {
        let legs = Legs::new(*gait).unwrap();
        for (m, i) in lifted(*gait).into_iter().step_by(5) {
            let equations = Equations::new(legs.whole, &i.posture, legs.description.leg_length());
            let (demand, columns) = (equations.demand(&i.posture.ud), equations.columns(&i.stance));
            let inside = i.posture.inside(m.force);
            let equal: Vec<f64> = (0..6).map(|k| inside[k % 3] / 2.0).collect();
            let shares = Shares::new(&equations.ranks(&columns, &demand, PLATFORM, legs.axis()), &equal);
            assert_eq!(shares.squeezes.len(), 1);
            for column in columns.iter().take(PLATFORM) {
                let pushed: f64 = column.iter().zip(shares.squeezes.row(0)).map(|(a, b)| a * b).sum();
                assert!(pushed.abs() < 1e-9, "the feet push against nothing but each other");
            }
            let motors = legs.motors(&i.posture, &shares, &demand, &columns);
            let rooms = Limits { legs: &legs }.instant(&i.stance, &i.posture, &shares, &motors);
            let found = best(&rooms, 1).unwrap();
            assert!((found.margin - i.margin).abs() < 1e-12);
            let margin = |s: f64| rooms.iter().map(|r| r.margin(&[s])).fold(f64::INFINITY, f64::min);
            let most = (-4000..=4000).map(|k| margin(0.1 * f64::from(k))).fold(f64::NEG_INFINITY, f64::max);
            assert!(
                most <= found.margin + 1e-7,
                "{} at {} s: {most} and {}",
                gait.description().key,
                m.time,
                found.margin
            );
            assert!(
                most >= found.margin - 2e-3,
                "{} at {} s: {most} and {}",
                gait.description().key,
                m.time,
                found.margin
            );
            // The multipliers prove it: the limits that they weigh have no more than this margin.
            let weight: f64 = found.binding.iter().map(|(_, w)| w).sum();
            assert!((weight - 1.0).abs() < 0.02);
            for (limit, _) in &found.binding {
                let room = rooms.iter().filter(|r| r.limit == *limit).map(|r| r.margin(&found.s));
                assert!(room.fold(f64::INFINITY, f64::min) < found.margin + 1e-6);
            }
        }
    }
}

/// The optimizer's formulas know one way to share the load; the cone program, from the whole robot's equations, all of them.
#[test]
fn an_amble_with_limits_at_real_legs_is_one_that_they_can_walk() {
    let amble = gait("amble");
    let altered = Altered::at_real_legs(amble).unwrap();
    for criterion in Criterion::ALL {
        let real = |motion: &Motion| RealLegs::new(amble, motion).unwrap();
        let (without, free) = optimum(amble, criterion);
        assert_eq!(real(&free).verdict(), Verdict::BeyondLimits);
        let (with, motion) = optimum(&altered, criterion);
        assert_eq!(real(&motion).verdict(), Verdict::UnequalShares);
        assert!(with.cost > without.cost.map(|c| 1.05 * c), "{:?} {:?}", with.cost, without.cost);
        // What was minimized, in the optimizer's formulas, is what the whole robot's equations say of its real joints.
        // On a fine mesh: the optimizer's own sees the load of a foot that hardly presses to some 1e-4 of the criterion.
        let mut cycle = Cycle::with_elements(&altered, criterion, 0.6, 40);
        cycle.simulate(&theta(&motion)).unwrap();
        let costs = real(&motion).costs;
        let minimized = cycle.costs().of(criterion);
        let [least, within, proportional, of_virtual] =
            [costs.least, costs.within_limits, costs.proportional, costs.virtual_legs].map(|costs| costs.of(criterion));
        println!("{criterion:?}: {minimized} {costs:?} {:?}", real(&free).costs);
        assert!((proportional / minimized - 1.0).abs() < 1e-5, "{minimized} {proportional}");
        // Powers change their signs between the instants that are looked at, which are not the same for all ways.
        let ordered = [of_virtual, least, within, proportional].is_sorted_by(|a, b| *a <= b * (1.0 + 1e-5));
        assert!(ordered, "{costs:?}");
        assert!((with.cost.unwrap() / proportional - 1.0).abs() < 1e-9, "{:?} {proportional}", with.cost);
    }
}

/// Three half steps of an amble, mirrored, are the amble: the leg that stands in the second phase is the other one, and its real legs' limits and
/// costs are those of its mirror image.
#[test]
fn limits_at_real_legs_are_of_the_leg_that_stands() {
    let mut files = RobotFiles::read(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec").as_ref()).unwrap();
    let amble = files.gaits.iter().find(|file| file.path.ends_with("amble.toml")).unwrap();
    let phases = [1, 2, 1].map(|leg| format!("[[phases]]\nstance = [\"leg{leg}\"]\nduration = [0.05, 2.0]\n")).concat();
    let kept = |line: &&str| !line.starts_with("half_step");
    let [mut text, limits] = [0, 1].map(|k| {
        let parts: Vec<&str> = amble.text.split("[limits]").collect();
        parts[k].lines().filter(kept).collect::<Vec<_>>().join("\n")
    });
    text += &format!("\n{phases}[cycle]\nthen = \"mirrored\"\n[limits]{limits}\n");
    files.gaits.push(SpecFile { path: "gaits/long_amble.toml".into(), text });
    let robot = Robot::new(RobotFiles { module: String::new(), ..files }).unwrap();
    let [amble, long] = ["amble", "long_amble"].map(|name| robot.gait(name).unwrap());
    let [amble, long] = [&amble, &long].map(|gait| Altered::at_real_legs(gait).unwrap());
    let d = amble.description();
    for criterion in Criterion::ALL {
        let (_, motion) = optimum(&amble, criterion);
        let own = &motion.phases[0];
        let mirrored = |values: &[f64], beta: f64| -> (Vec<f64>, f64) {
            let all = d.complete(values, beta);
            let seen = |k: usize| {
                let (from, sign) = d.swapped(k);
                sign * all[from]
            };
            ((0..d.prescribed()).map(|k| seen(d.prescribed_index(k))).collect(), seen(d.unactuated))
        };
        let (q_initial, beta_initial) = mirrored(&own.q_initial, own.beta_initial);
        let (qd_initial, betad_initial) = mirrored(&own.qd_initial, own.betad_initial);
        let (q_final, beta_final) = mirrored(&own.q_final, own.beta_final);
        let (qd_final, betad_final) = mirrored(&own.qd_final, own.betad_final);
        let q_interior = own.q_interior.iter().map(|q| mirrored(q, 0.0).0).collect();
        let other = Course {
            duration: own.duration,
            q_initial,
            qd_initial,
            q_interior,
            q_final,
            qd_final,
            beta_initial,
            betad_initial,
            beta_final,
            betad_final,
        };
        let three = Motion { phases: vec![own.clone(), other, own.clone()] };
        let [short, long] = [(&amble, &motion), (&long, &three)].map(|(gait, motion)| {
            let mut cycle = Cycle::new(gait, criterion, 0.6);
            let mut values = Values::zeros(cycle.equalities(), cycle.inequalities());
            cycle.evaluate(&theta(motion), &mut values).unwrap();
            (values.objective, values.inequalities)
        });
        assert!((long.0 / short.0 - 1.0).abs() < 1e-9, "{criterion:?}: {} {}", long.0, short.0);
        // Each limit is there three times.
        let sorted = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values
        };
        let thrice = sorted(short.1.iter().flat_map(|value| [*value; 3]).collect());
        let far = sorted(long.1).iter().zip(&thrice).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-7, "{criterion:?}: {far}");
    }
}

/// Where the hips are level with the mass centre, legs that take equal impulses in their plane do not pitch the robot.
#[test]
fn an_impact_asks_for_no_moment_that_the_feet_cannot_give() {
    let amble = gait("amble");
    let d = amble.description();
    let (n, shape) = (d.orientations(), &d.shapes.touchdown);
    let mut rng = fastrand::Rng::with_seed(3);
    let leg = d.transition(0).lands().unwrap();
    for _ in 0..100 {
        let q: Vec<f64> = (0..n).map(|_| 2.0 * rng.f64() - 1.0).collect();
        let qd: Vec<f64> = (0..n).map(|_| 6.0 * rng.f64() - 3.0).collect();
        let mut out = vec![f64::NAN; shape.len];
        amble.touchdown(leg, &q, &qd, &mut out);
        let (couple, pitch) = (shape.couple.of(&out), shape.pitch.value(&out));
        let [couple_y, couple_z] = [couple[0], couple[1]];
        assert!(pitch.abs() < 1e-12 * d.total_mass(), "{pitch}");
        // The couple lies across the legs' plane.
        assert!((couple_y * q[n - 1].cos() + couple_z * q[n - 1].sin()).abs() < 1e-12, "{couple_y} {couple_z}");
    }
}

/// Where hips are off the mass centre or rotors turn, impacts pitch the robot. Limits at each real leg let them, as far as the verdict does.
#[test]
fn an_impact_may_pitch_the_robot_as_little_as_the_verdict_lets_pass() {
    let shipped = Robot::read("model-spec").unwrap();
    let load = Changes { loads: vec![Load { mass: 1.0, at: [0.0, 0.06, 0.0] }], ..Changes::default() };
    let loaded = shipped.changed(&load).unwrap();
    let geared = shipped.with("actuators.haunch_motor.rotor_inertia", 2e-5).unwrap();
    let heavily_geared = shipped.with("actuators.haunch_motor.rotor_inertia", 5e-5).unwrap();
    for (robot, pitches_freely) in [(loaded, false), (geared, false), (heavily_geared, true)] {
        let amble = robot.gait("amble").unwrap();
        let (d, unit) = (amble.description(), Units::new(amble.description()).angular_momentum());
        let pitched = |motion: &Motion| {
            let end = |(k, h): (usize, &Course)| {
                let [q, qd] = [d.complete(&h.q_final, h.beta_final), d.complete(&h.qd_final, h.betad_final)];
                let mut out = vec![f64::NAN; d.shapes.touchdown.len];
                amble.touchdown(d.transition(k).lands().unwrap(), &q, &qd, &mut out);
                (d.shapes.touchdown.pitch.value(&out) / unit).abs()
            };
            motion.phases.iter().enumerate().map(end).fold(0.0, f64::max)
        };
        let found = |real_legs: bool| {
            let settings = Settings { starts: Some(4), examination: Examination::None, ..Settings::default() };
            let result = Task::new(&amble).speed(0.5).answer(real_legs, &settings, &|_| Control::Continue).unwrap();
            assert_eq!(result.status, Status::Optimal, "{}", result.message);
            let motion = result.motion().unwrap();
            (pitched(&motion), RealLegs::new(&amble, &motion).unwrap())
        };
        for real_legs in [false, true] {
            let (pitched, legs) = found(real_legs);
            let lacking = legs.best_shares.impact;
            assert_eq!(lacking.of, Component::PitchingMoment);
            assert!((pitched / lacking.share - 1.0).abs() < 1e-3 && pitched > 1e-4, "{pitched} {lacking:?}");
            // Of an impact the moments between know nothing.
            assert_eq!(legs.between_and_at_impacts()[1], pitched <= BALANCED, "{legs:?}");
            if real_legs {
                assert_eq!(legs.verdict(), Verdict::UnequalShares);
                assert!(!pitches_freely || (0.0..2e-6).contains(&(BALANCED - pitched)), "{pitched}");
            } else {
                assert_eq!(pitched > BALANCED, pitches_freely, "{pitched}");
            }
        }
    }
}

/// Nobody can meet the equations beside the plane in which a biped walks; those in it are met, and its motors do what the
/// virtual legs' do.
#[test]
fn where_one_foot_stands_the_real_torques_are_the_virtual_ones() {
    for gait in walking().filter(|g| g.description().legs.iter().all(|leg| leg.members.len() == 1)) {
        let legs = Legs::new(*gait).unwrap();
        let lifted = lifted(*gait);
        let most = lifted.iter().flat_map(|(m, _)| &m.torque).fold(0.0f64, |most, torque| most.max(torque.abs()));
        for (m, i) in lifted {
            let torques: Vec<f64> = legs.joints.iter().map(|j| m.torque[*j]).collect();
            assert!(close(&i.torque, &torques, 1e-10 * most), "{:?} {torques:?}", i.torque);
            assert!(close(&i.reactions[i.stance[0]], &m.force, 1e-10 * legs.weight()), "{:?}", i.reactions);
        }
    }
}

#[test]
fn what_no_reactions_balance_is_said() {
    let gait = gait("rabbit/walk");
    let (_, motion) = optimum(gait, Criterion::Torque);
    let receipt = RealLegs::new(gait, &motion).unwrap();
    assert_eq!(receipt.verdict(), Verdict::NoEquilibrium);
    // In the plane nothing is lacking; beside it lie the feet.
    assert_eq!(receipt.best_shares.support.of, Component::SidewaysMoment);
    assert!(
        receipt.best_shares.support.share > 0.01 && receipt.sentence().contains("a sideways moment of"),
        "{receipt:?}"
    );
}

/// The A1's mass centre lies beside its middle. Standing, the feet of a pair make up for it by unequal shares; at an impact,
/// when no joint takes an impulse either, they cannot.
#[test]
fn a_robot_that_is_heavier_on_one_side_stands_but_does_not_land_evenly() {
    let gait = gait("a1/bound");
    let (_, motion) = optimum(gait, Criterion::Torque);
    let receipt = RealLegs::new(gait, &motion).unwrap();
    assert!(receipt.equal_shares.support.share > 1e-3 && receipt.best_shares.support.share < 1e-12, "{receipt:?}");
    assert!(receipt.largest_load > 0.505, "{receipt:?}");
    // That is little: less than what is known of masses, and it is said.
    assert!(receipt.best_shares.impact.share > 1e-5 && receipt.best_shares.impact.share < 1e-2, "{receipt:?}");
    assert!(receipt.verdict() != Verdict::NoEquilibrium && receipt.sentence().contains("momentum"), "{receipt:?}");
}

#[test]
fn the_command_writes_what_the_library_lifts() {
    let gait = gait("amble");
    let (result, motion) = optimum(gait, Criterion::Torque);
    let run =
        |format: &str| String::from_utf8(piaffe(&result, &["lift", "-", "--rate", "200", "--format", format])).unwrap();
    let lift = Lift::at_rate(gait, &motion, 200.0, Sharing::LeastCost(Criterion::Torque)).unwrap();
    let json: Value = serde_json::from_str(&run("json")).unwrap();
    let text = run("csv");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no column {name}"));
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!((rows.len(), json["moments"].as_array().unwrap().len()), (lift.instants.len(), lift.instants.len()));
    let knee = lift.legs.whole.description().joints[1].name;
    for (k, (row, i)) in rows.iter().zip(&lift.instants).enumerate() {
        assert_eq!(row.len(), names.len());
        assert_eq!(row[column("t")], i.time);
        assert_eq!(row[column(&format!("torque_{knee}"))], i.torque[1]);
        assert_eq!(row[column("force_fore_right_y")], i.reactions[1][1]);
        assert_eq!(json["moments"][k]["force"][1][1], i.reactions[1][1]);
    }
    // The impulses of a phase are in its last row, and by themselves.
    let impulses: Vec<f64> = rows.iter().map(|row| row[column("impulse_fore_left_y")]).collect();
    assert_eq!(impulses.iter().filter(|i| **i != 0.0).count(), 1);
    assert_eq!(json["impacts"].as_array().unwrap().len(), 2);
    assert_eq!(json["impacts"][0]["impulse"][0][1], lift.impacts[0].impulses[0][1]);
}

/// The torques that are written cost what is said of them: by default what the result states of the real joints.
#[test]
fn what_the_written_torques_cost_is_told() {
    let gait = gait("amble");
    let (result, motion) = optimum_at(gait, Criterion::Torque, 0.3);
    let legs = RealLegs::new(gait, &motion).unwrap();
    let mut told = Vec::new();
    for (option, sharing) in [("least-cost", Sharing::LeastCost(Criterion::Torque)), ("most-room", Sharing::MostRoom)] {
        let written = piaffe(&result, &["lift", "-", "--rate", "4000", "--format", "json", "--shares", option]);
        let written: Value = serde_json::from_slice(&written).unwrap();
        let squares =
            |m: &Value| m["torque"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap().powi(2)).sum::<f64>();
        let moments = written["moments"].as_array().unwrap();
        let work = moments.windows(2).map(|pair| {
            let [from, to] = [&pair[0], &pair[1]].map(|m| m["t"].as_f64().unwrap());
            (to - from) * (squares(&pair[0]) + squares(&pair[1]))
        });
        let cost = work.sum::<f64>() / written["travel"].as_f64().unwrap();
        let lift = Lift::close(gait, &motion, sharing).unwrap();
        assert!((cost / lift.costs().torque - 1.0).abs() < 1e-3, "{option}: {cost} {:?}", lift.costs());
        told.push(cost);
        let words = legs.cost_of(&lift, sharing, &result);
        assert!(words.contains(&format!("torque {:.1}", cost)), "{words} {cost}");
        // The column is about the shares that are written.
        let least = moments.iter().map(|m| m["margin"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
        assert!(least <= legs.support.margin + 1e-3, "{least}");
    }
    assert!((told[0] / legs.costs.within_limits.torque - 1.0).abs() < 1e-3, "{told:?} {:?}", legs.costs);
    assert!(told[1] > 1.001 * told[0], "{told:?}");
}

/// A step of a gait's exported robot, simulated by MuJoCo under the lifted torques as `change` has them: largest errors.
fn replayed(python: &str, key: &str, speed: f64, change: impl Fn(&mut [Value])) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (result, _) = optimum_at(gait(key), Criterion::Torque, speed);
    let [model, lift] = ["robot.xml", "lift.json"].map(|file| folder.path().join(file));
    std::fs::write(&model, piaffe(&result, &["export", "-", "--format", "mjcf"])).unwrap();
    let mut lifted: Value =
        serde_json::from_slice(&piaffe(&result, &["--quiet", "lift", "-", "--format", "json", "--rate", "2000"]))
            .unwrap();
    for moment in lifted["moments"].as_array_mut().unwrap() {
        change(moment["torque"].as_array_mut().unwrap());
    }
    std::fs::write(&lift, lifted.to_string()).unwrap();
    // Gains in N·m/rad and N·m·s/rad, of joints that give up to 20 N·m.
    let request = json!({ "model": model, "lift": lift, "timestep": 1e-4, "kp": 100.0, "kd": 3.0 });
    let errors = ask(python, "four_legs/replay.py", &request);
    println!("{key}: {errors}");
    errors
}

/// MuJoCo walks and runs the lifted step through all supports, flights and impacts. What differs is of the order of the time step and
/// vanishes with it.
#[test]
fn mujoco_walks_the_lifted_step() {
    let Some(python) = python() else { return };
    // The fastest one flies for as long as it stands on a pair.
    for (key, speed) in [("trot", 0.6), ("curvet", 0.6), ("amble", 0.6), ("running_trot", 1.5), ("bound", 0.6)] {
        let errors = replayed(&python, key, speed, |_| ());
        let number = |name: &str| errors[name].as_f64().unwrap();
        let within = |name: &str, most: f64| assert!(number(name) <= most, "{key}: {name} is off by {}", number(name));
        within("position", 5e-4);
        within("turn", 2e-3);
        within("joint", 2e-3);
        within("velocity", 5e-3);
        within("rate", 0.15);
        within("reaction", 0.03 * number("weight"));
        within("feedback", 0.5);
        within("impulse", 2e-3 * number("mass"));
        within("after", 0.15);
    }
}

/// With equal torques of an amble's pairs, the sums being the same, it takes feedback to hold the platform, and the feet are
/// loaded otherwise.
#[test]
fn equal_torques_are_not_those_of_an_amble() {
    let Some(python) = python() else { return };
    let legs = Legs::new(gait("amble")).unwrap();
    let errors = replayed(&python, "amble", 0.6, |torque| {
        let own: Vec<f64> = torque.iter().map(|t| t.as_f64().unwrap()).collect();
        for (k, torque) in torque.iter_mut().enumerate() {
            let pair = legs.joints.iter().zip(&own).filter(|(j, _)| **j == legs.joints[k]);
            *torque = json!(pair.map(|(_, gamma)| gamma / 2.0).sum::<f64>());
        }
    });
    assert!(errors["feedback"].as_f64().unwrap() > 0.8, "{errors}");
    assert!(errors["reaction"].as_f64().unwrap() > 0.08 * errors["weight"].as_f64().unwrap(), "{errors}");
}

/// One real joint has one name, in whatever is written of it: the specification's own where that is one.
#[test]
fn a_real_joint_has_one_name_everywhere() {
    for gait in walking() {
        let d = gait.description();
        let legs = Legs::new(*gait).unwrap();
        let whole: Vec<&str> = legs.whole.description().joints.iter().map(|j| j.name).collect();
        let mut members: Vec<&str> = real_joints(d).map(|(_, name)| name).collect();
        assert!(
            members.iter().all(|name| whole.contains(name)) && members.len() == whole.len(),
            "{members:?} {whole:?}"
        );
        members.sort_unstable();
        members.dedup();
        assert_eq!(members.len(), whole.len(), "each is there once");
        // It follows the coordinate that the lift gives it.
        for (coordinate, name) in real_joints(d) {
            assert_eq!(legs.joints[whole.iter().position(|joint| *joint == name).unwrap()], coordinate, "{name}");
        }
        let (_, motion) = optimum(*gait, Criterion::Torque);
        let walk = Walk::even(*gait, &motion, 2).unwrap();
        let (mjcf, urdf) = (mjcf(&walk), urdf(d));
        let program = serde_json::to_value(controller(*gait, &motion)).unwrap();
        let phase = &program["phases"][0];
        let coordinates = phase["coordinates"].as_array().unwrap().iter().chain([&phase["unactuated"]]);
        let followed: Vec<&Value> = coordinates.flat_map(|c| c["joints"].as_array().unwrap()).collect();
        assert_eq!(followed.len(), whole.len());
        for name in &whole {
            assert!(mjcf.contains(&format!("<motor name=\"{name}\" joint=\"{name}\"")), "{name}: {mjcf}");
            assert!(urdf.contains(&format!("<joint name=\"{name}\"")), "{name}: {urdf}");
            assert!(followed.iter().any(|joint| joint == name), "{name}");
        }
    }
    let names = |key: &str| gait(key).description().legs[0].members[0].joints.to_vec();
    assert_eq!(names("trot"), ["fore_left_haunch", "fore_left_knee"]);
    assert_eq!(names("a1/bound"), ["RL_thigh_joint", "RL_calf_joint"]);
}
