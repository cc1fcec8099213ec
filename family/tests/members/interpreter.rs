//! Compiled members against the derivation with their numbers folded in, interpreted.

use super::draws::{GENERAL, member};
use super::kernels::{assert_close, call, filled, mode, vector};
use piaffe::model::Body;
use piaffe_codegen::dynamics::{Kernel, Model, family_kernels_with_gradients, kernels};
use piaffe_codegen::mechanism::{Family, Mechanism, parameters, with};
use piaffe_codegen::spec::{Gait, Robot, parse_gait, parse_robot};
use piaffe_family::FAMILIES;
use std::collections::BTreeMap;

fn specification(gait: &str) -> (Robot, Gait) {
    let read =
        |path: &str| std::fs::read_to_string(format!("{}/../model-spec/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let (folder, gait) = gait.rsplit_once('/').map_or((String::new(), gait), |(r, g)| (format!("{r}/"), g));
    let path = format!("{folder}robot.toml");
    let robot = parse_robot(&path, &read(&path)).unwrap();
    let path = format!("{folder}gaits/{gait}.toml");
    let gait = parse_gait(&path, &read(&path), &robot).unwrap();
    (robot.robot, gait)
}

fn interpret(model: &Model, kernel: &Kernel, inputs: &[Vec<f64>]) -> Vec<f64> {
    let symbols = kernel.inputs.iter().flat_map(|i| &i.symbols).copied();
    let values: BTreeMap<_, _> = symbols.zip(inputs.iter().flatten().copied()).collect();
    model.ring.evaluate_all(kernel.outputs.iter().flat_map(|o| &o.values), &values)
}

fn outputs(kernel: &Kernel) -> usize {
    kernel.outputs.iter().map(|o| o.values.len()).sum()
}

/// What the late kernels take is what the early ones of the same derivation give.
fn early<'k>(kernel: &Kernel, inputs: &'k BTreeMap<String, Vec<f64>>) -> Option<&'k Vec<f64>> {
    let mode = kernel.mode().filter(|_| kernel.what.starts_with("late"))?;
    inputs.get(&mode.kernel("early"))
}

#[test]
fn members_compute_what_is_derived_for_their_numbers() {
    for family in FAMILIES {
        let (robot, gait) = specification(family.description.key);
        let mut rng = fastrand::Rng::with_seed(11);
        for _ in 0..3 {
            let robot_member = member(family, &GENERAL, &mut rng);
            let value = |name: &str| {
                family.parameters.iter().position(|p| p.name == name).map(|k| robot_member.parameters()[k])
            };
            let (model, derived) = kernels(&Mechanism::new(&with(&robot, value), &gait));
            let (mut folded_early, mut own_early) = (BTreeMap::new(), BTreeMap::new());
            for kernel in &derived {
                let draw = |i: &piaffe_codegen::dynamics::Input| vector(i.symbols.len(), 1.0, &mut rng);
                let mut inputs: Vec<Vec<f64>> = kernel.inputs.iter().map(draw).collect();
                let mut own = inputs.clone();
                if let (Some(folded), Some(mine)) = (early(kernel, &folded_early), early(kernel, &own_early)) {
                    (inputs[0], own[0]) = (folded.clone(), mine.clone());
                }
                let expected = interpret(&model, kernel, &inputs);
                if kernel.what == "early" {
                    // The split may differ; what the late kernels make of it may not.
                    let length = robot_member.description().shape(mode(&kernel.name)).early.len;
                    let found = filled(length, |o| call(&*robot_member, &kernel.name, &own, o));
                    own_early.insert(kernel.name.clone(), found);
                    folded_early.insert(kernel.name.clone(), expected);
                    continue;
                }
                let found = filled(outputs(kernel), |o| call(&*robot_member, &kernel.name, &own, o));
                assert_close(&format!("{} {}", gait.name, kernel.name), &found, &expected, 1e-10);
            }
        }
    }
}

#[test]
fn sensitivities_compute_what_was_derived() {
    for family in FAMILIES {
        let (robot, gait) = specification(family.description.key);
        let (model, derived, gradients) =
            family_kernels_with_gradients(&Family::new(&robot, &gait, parameters(&robot)).unwrap());
        let mut rng = fastrand::Rng::with_seed(12);
        let robot_member = member(family, &GENERAL, &mut rng);
        let lumps = interpret(&model, &derived.lumps, &[robot_member.parameters().to_vec()]);
        assert_close("lumps", robot_member.lumps(), &lumps, 1e-13);
        let jacobian = filled(lumps.len() * family.parameters.len(), |o| robot_member.lumps_jacobian(o));
        let expected = interpret(&model, &gradients.jacobian, &[robot_member.parameters().to_vec()]);
        assert_close("∂lumps/∂parameters", &jacobian, &expected, 1e-13);
        for kernel in &gradients.sensitivity {
            let inputs: Vec<Vec<f64>> =
                kernel.inputs[1..].iter().map(|i| vector(i.symbols.len(), 1.0, &mut rng)).collect();
            let found = filled(outputs(kernel), |o| call(&*robot_member, &kernel.name, &inputs, o));
            let expected = interpret(&model, kernel, &[vec![lumps.clone()], inputs].concat());
            assert_close(&format!("{} {}", gait.name, kernel.name), &found, &expected, 1e-11);
        }
    }
}

/// The family's parameters are the specification's, and its member with their values is its robot.
#[test]
fn the_specified_robot_is_a_member() {
    for (family, folded) in FAMILIES.iter().flat_map(|f| {
        piaffe::gaits::GAITS.iter().filter(|g| g.description().key == f.description.key).map(move |g| (f, g))
    }) {
        let (robot, _) = specification(family.description.key);
        let known: Vec<_> = parameters(&robot).into_iter().map(|p| (p.name, p.unit, p.value)).collect();
        let own: Vec<_> = family.parameters.iter().map(|p| (p.name.to_string(), p.unit, p.value)).collect();
        assert_eq!(own, known);
        let specified = family.with(&[]).unwrap();
        let (found, expected) = (specified.description(), folded.description());
        assert_close("masses", &[found.total_mass(), found.gravity], &[expected.total_mass(), expected.gravity], 1e-15);
        for (a, b) in found.bodies.iter().zip(expected.bodies.iter()) {
            let numbers = |b: &Body| [&b.offset[..], &b.com, b.inertia.as_flattened()].concat();
            assert_close(a.name, &numbers(a), &numbers(b), 1e-15);
        }
    }
}
