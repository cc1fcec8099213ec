//! Exported files in the hands of others: MuJoCo and numpy where a Python has them (`PIAFFE_PYTHON` names it).

#[path = "export/program.rs"]
mod program;
#[path = "export/python.rs"]
mod python;
#[path = "friction/robot.rs"]
mod rubbing;
#[path = "gaits/walking.rs"]
mod walking;

use piaffe::import::{Options, import};
use piaffe::model::{Description, Gait, Rotation};
use piaffe::motion::Criterion;
use piaffe::result::GaitResult;
use piaffe::walk::{Moment, Walk};
use piaffe_codegen::spec::parse_robot;
use program::{optimum, piaffe};
use python::{ask, python};
use serde_json::{Value, json};
use walking::walking;

fn export(result: &GaitResult, arguments: &[&str]) -> Vec<u8> {
    piaffe(result, &[&["export", "-"], arguments].concat())
}

#[test]
fn a_table_has_the_numbers_of_the_walk() {
    for gait in walking() {
        let (result, motion) = optimum(*gait, Criterion::Torque);
        let text = String::from_utf8(export(&result, &["--format", "csv", "--rate", "200"])).unwrap();
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let column = |name: &str| names.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no column {name}"));
        let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
        let walk = Walk::at_rate(*gait, &motion, 200.0).unwrap();
        assert_eq!(rows.len(), walk.moments.len());
        let d = gait.description();
        let knee = d.joints[1].name;
        for (row, m) in rows.iter().zip(&walk.moments) {
            assert_eq!(row.len(), names.len());
            assert_eq!(row[column("t")], m.time);
            assert_eq!(row[column(&format!("qd_{knee}"))], m.qd[1]);
            assert_eq!(row[column(&format!("torque_{knee}"))], m.torque[1]);
            assert_eq!(row[column("force_y")], m.force[1]);
            let foot = *m.chain(d, 1, 0).last().unwrap();
            assert_eq!(row[column(&format!("foot_{}_x", d.legs[1].members[0].name))], foot[0]);
        }
    }
}

#[test]
fn a_controller_that_follows_the_polynomials_does_the_walk() {
    for gait in walking() {
        let (result, motion) = optimum(*gait, Criterion::Torque);
        let program: Value = serde_json::from_slice(&export(&result, &["--format", "json"])).unwrap();
        let walk = Walk::even(*gait, &motion, 20).unwrap();
        let d = gait.description();
        for m in &walk.moments {
            let phase = &program["phases"][m.phase];
            let t = m.share * phase["duration"].as_f64().unwrap();
            let stance = m.mode.stance().unwrap();
            let members: Vec<&str> = d.legs[stance].members.iter().map(|m| m.name).collect();
            assert_eq!(phase["stance"], json!(members));
            assert_eq!(phase["coordinates"].as_array().unwrap().len(), d.prescribed());
            for (j, polynomial) in phase["coordinates"].as_array().unwrap().iter().enumerate() {
                let c: Vec<f64> =
                    polynomial["coefficients"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect();
                let value = |c: &[f64]| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
                let rate: Vec<f64> = c.iter().enumerate().skip(1).map(|(i, c)| i as f64 * c).collect();
                // β is another coordinate where the legs have exchanged their roles.
                let k = d.joints.iter().position(|joint| polynomial["name"] == joint.name).unwrap_or(d.joints());
                assert!((value(&c) - m.q[k]).abs() < 1e-9, "{}: {j}", d.gait);
                assert!((value(&rate) - m.qd[k]).abs() < 1e-8, "{}: {j}", d.gait);
            }
        }
    }
}

/// With z up.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -z, y]
}

/// How MuJoCo's velocities (free platform, then each real leg's joints) follow from Ẋ = [ṗ, q̇]: nv × n.
fn selection(d: &Description) -> Vec<Vec<f64>> {
    let (nc, nj) = (d.positions(), d.joints());
    let n = nc + d.orientations();
    let unit = |k: usize| [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
    let mut rows = vec![vec![0.0; n]; 6];
    for k in 0..nc {
        for (row, v) in rows.iter_mut().zip(turned(unit(k))) {
            row[k] = v;
        }
    }
    let axis = match d.rotation {
        Rotation::None => None,
        Rotation::Pitch => Some(2),
        Rotation::Roll => Some(0),
    };
    if let Some(axis) = axis {
        for (row, v) in rows[3..].iter_mut().zip(turned(unit(axis))) {
            row[nc + nj] = v;
        }
    }
    for leg in &d.legs {
        for _ in leg.members.iter() {
            rows.extend(
                (leg.first_joint..leg.end_joint).map(|j| (0..n).map(|k| f64::from(u8::from(k == nc + j))).collect()),
            );
        }
    }
    rows
}

/// Positions, velocities and accelerations in MuJoCo's order.
fn state(d: &Description, m: &Moment) -> Value {
    let nj = d.joints();
    let theta = if d.rotation == Rotation::None { 0.0 } else { m.q[nj] };
    let axis = if d.rotation == Rotation::Roll { [1.0, 0.0, 0.0] } else { turned([0.0, 0.0, 1.0]) };
    let mut position = turned(m.platform[0]).to_vec();
    position.push((0.5 * theta).cos());
    position.extend(axis.map(|a| a * (0.5 * theta).sin()));
    for leg in &d.legs {
        for _ in leg.members.iter() {
            position.extend(&m.q[leg.first_joint..leg.end_joint]);
        }
    }
    let spread = |platform: [f64; 3], q: &[f64]| -> Vec<f64> {
        let x = [&platform[..d.positions()], q].concat();
        selection(d).iter().map(|row| row.iter().zip(&x).map(|(s, x)| s * x).sum()).collect()
    };
    json!({ "qpos": position, "qvel": spread(m.platform[1], &m.qd), "qacc": spread(m.platform[2], &m.qdd) })
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// The mass matrix of the real robot, its legs coupled as the gait couples them, is A of eq. 5; and the walk's
/// torques and reactions are what MuJoCo says that its accelerations take.
/// Where the legs end: their feet are points here, and round there.
#[test]
fn what_is_exported_for_mujoco_is_imported_with_the_same_legs() {
    let gait = walking().find(|gait| gait.description().key == "trot").copied().unwrap() as &dyn Gait;
    let (result, _) = optimum(gait, Criterion::Torque);
    let text = String::from_utf8(export(&result, &["--format", "mjcf"])).unwrap();
    let options = Options { velocities: vec!["20".parse().unwrap()], ..Options::default() };
    let made = import(&text, &options).unwrap();
    let robot = parse_robot("robot.toml", &made.robot).unwrap().robot;
    let d = gait.description();
    for leg in &robot.legs {
        let member = d.legs.iter().flat_map(|l| l.members.iter()).find(|m| m.name == leg.name).unwrap();
        let ends = leg.chain.iter().map(|s| s.link.end);
        let ours = member.bodies[1..].iter().map(|b| b.offset).chain([member.foot]);
        for (end, own) in ends.zip(ours) {
            assert!(end.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-6), "{}: {end:?} and {own:?}", leg.name);
        }
    }
}

/// Motors too; what URDF cannot say stands in it as a comment.
#[test]
fn what_is_exported_as_urdf_is_imported_with_the_same_motors() {
    let springs = [("joints.knee.stiffness", 3.0), ("joints.knee.rest_angle", -0.6)];
    let rotors = ["haunch", "knee"].map(|joint| (format!("actuators.{joint}_motor.rotor_inertia"), 1e-7));
    let numbers = springs.iter().map(|(name, x)| (*name, *x)).chain(rotors.iter().map(|(name, x)| (name.as_str(), *x)));
    let gait = rubbing::with(rubbing::GEARED).with_all(numbers).unwrap().gait("trot").unwrap();
    let (mut result, _) = optimum(&gait, Criterion::Torque);
    result.specification = gait.specification().cloned();
    let text = String::from_utf8(export(&result, &["--format", "urdf"])).unwrap();
    let d = gait.description();
    assert!(text.contains("URDF knows no springs") && text.contains("rests at -0.6 rad"), "{text}");
    let made = import(&text, &Options::default()).unwrap();
    let robot = parse_robot("robot.toml", &made.robot).unwrap().robot;
    let mut compared = 0;
    for (leg, member) in d.legs.iter().flat_map(|leg| leg.members.iter().map(move |member| (leg, member))) {
        for (name, limits) in member.joints.iter().zip(&d.joints[leg.first_joint..]) {
            let share = leg.members.len() as f64;
            let joint =
                robot.legs.iter().flat_map(|leg| &leg.chain).map(|s| &s.joint).find(|j| j.name == *name).unwrap();
            let motor = &joint.actuator;
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
            assert!(
                motor.gear == limits.gear
                    && near(motor.rotor_inertia * motor.gear.powi(2), limits.rotor_inertia / share)
            );
            assert!(near(motor.max_torque * motor.gear, limits.max_torque / share), "{name}");
            assert!(limits.rotor_inertia > 0.0 && limits.gear > 1.0, "{name}: nothing to compare");
            compared += 1;
        }
    }
    assert_eq!(compared, 8);
}

#[test]
fn mujoco_agrees_about_masses_feet_and_inverse_dynamics_of_the_real_robot() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let rubs = rubbing::with(rubbing::GEARED);
    let springs = [("joints.knee.stiffness", 3.0), ("joints.knee.rest_angle", -0.6)];
    let sprung = rubs.with_all(springs).unwrap();
    let rub = [(&rubs, "trot"), (&rubs, "curvet"), (&sprung, "amble")].map(|(robot, name)| robot.gait(name).unwrap());
    let rub = rub.iter().map(|gait| gait as &dyn Gait);
    for gait in walking().map(|gait| *gait as &dyn Gait).chain(rub) {
        let d = gait.description();
        let (mut result, motion) = optimum(gait, Criterion::Torque);
        // A robot that no build knows brings its files.
        result.specification = gait.specification().cloned();
        let files = ["mjcf", "npz", "urdf"].map(|format| {
            let path = folder.path().join(format!("{}.{}", d.gait, if format == "mjcf" { "xml" } else { format }));
            std::fs::write(&path, export(&result, &["--format", format, "--rate", "500"])).unwrap();
            path
        });
        let walk = Walk::even(gait, &motion, 6).unwrap();
        let moments: Vec<Value> = walk.moments.iter().map(|m| state(d, m)).collect();
        let answer = ask(
            &python,
            "export/oracle.py",
            &json!({ "model": files[0], "arrays": files[1], "urdf": files[2], "moments": moments }),
        );

        let mass = d.total_mass();
        assert!((answer["mass"].as_f64().unwrap() - mass).abs() < 1e-9);
        // Without a floating base, MuJoCo's reader of URDF makes the platform part of the world.
        let legs = answer["mass_urdf"].as_f64().unwrap();
        assert!((legs - mass).abs() < 1e-9 || (legs - (mass - d.bodies[0].mass)).abs() < 1e-9, "{legs} of {mass}");
        // Both feet of an exchange touch the ground, and nothing is in it.
        let depth = answer["depth"].as_f64().unwrap() / d.leg_length();
        assert!(0.0 < depth && depth < 1e-3, "{}: {depth} legs", d.gait);
        let start = numbers(&answer["start"]);
        let wanted = numbers(&moments[0]["qpos"]);
        assert!(start.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12));

        let s = selection(d);
        let (nc, nq) = (d.positions(), d.orientations());
        let n = nc + nq;
        for (m, found) in walk.moments.iter().zip(answer["moments"].as_array().unwrap()) {
            for leg in 0..2 {
                for (k, member) in d.legs[leg].members.iter().enumerate() {
                    let foot = numbers(&found["feet"][format!("{}_foot", member.name)]);
                    let ours = turned(*m.chain(d, leg, k).last().unwrap());
                    assert!(foot.iter().zip(ours).all(|(a, b)| (a - b).abs() < 1e-9), "{}", member.name);
                }
            }
            let mut a = vec![0.0; n * n];
            gait.inertia(&m.q, &mut a);
            let full: Vec<Vec<f64>> = found["mass"].as_array().unwrap().iter().map(numbers).collect();
            for i in 0..n {
                for k in 0..n {
                    let projected: f64 = (0..s.len())
                        .flat_map(|r| (0..s.len()).map(move |c| (r, c)))
                        .map(|(r, c)| s[r][i] * full[r][c] * s[c][k])
                        .sum();
                    assert!((projected - a[i * n + k]).abs() < 1e-7, "{}: A[{i}, {k}]", d.gait);
                }
            }
            // Sᵀ(M q̈ + bias) = D_Γ Γ + D_i F_i.
            // What their joints rub, dry friction by their own numbers, is part of the motors' torque.
            let mut forces = numbers(&found["forces"]);
            for ((force, loss), row) in forces.iter_mut().zip(numbers(&answer["frictionloss"])).zip(&s) {
                let rate: f64 = row[nc..].iter().zip(&m.qd).map(|(s, rate)| s * rate).sum();
                *force += if loss == 0.0 { 0.0 } else { loss * rate.signum() };
            }
            let mut jacobian = vec![0.0; n * nc];
            gait.foot_jacobian(m.mode.stance().unwrap(), &m.q, &mut jacobian);
            for i in 0..n {
                let theirs: f64 = s.iter().zip(&forces).map(|(row, f)| row[i] * f).sum();
                let torque = if (nc..nc + d.joints()).contains(&i) { m.torque[i - nc] } else { 0.0 };
                let ours: f64 = torque + (0..nc).map(|c| jacobian[i * nc + c] * m.force[c]).sum::<f64>();
                assert!((theirs - ours).abs() < 1e-5, "{} at {} s: row {i}: {theirs} and {ours}", d.gait, m.time);
            }
        }

        let arrays = &answer["arrays"];
        let walk = Walk::at_rate(gait, &motion, 500.0).unwrap();
        assert!(["phase", "stance", "real_joint_of"].iter().all(|name| arrays[*name][0].is_i64()), "whole numbers");
        assert_eq!(numbers(&arrays["t"]), walk.moments.iter().map(|m| m.time).collect::<Vec<_>>());
        assert_eq!(numbers(&arrays["torque"][3]), walk.moments[3].torque);
        assert_eq!(numbers(&arrays["feet"][3][0]), walk.moments[3].chain(d, 0, 0).pop().unwrap());
        assert_eq!(arrays["joints"], json!(d.joints.iter().map(|j| j.name).collect::<Vec<_>>()));
    }
}
