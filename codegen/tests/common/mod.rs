//! What the tests share: the shipped gaits, and kernels evaluated straight from their expressions.
#![allow(dead_code, reason = "each test binary uses its part")]

use piaffe_codegen::SpecFile;
use piaffe_codegen::dynamics::{Kernel, LUMPS, Model, PARAMETERS, family_kernels_with_gradients, kernels};
use piaffe_codegen::expr::Ring;
use piaffe_codegen::mechanism::{Family, Mechanism, parameters};
use piaffe_codegen::spec::{Gait, Robot, parse_gait, parse_robot};
use std::collections::BTreeMap;

pub const GAITS: [&str; 5] = ["trot", "curvet", "amble", "rabbit/walk", "a1/bound"];

/// Gaits of robots whose legs share their links, so that there is a family of each.
pub const FAMILIES: [&str; 4] = ["trot", "curvet", "amble", "rabbit/walk"];

/// Module, robot and gait of a shipped gait.
pub fn files(key: &str) -> (&str, SpecFile, SpecFile) {
    let (module, folder, gait) = match key.split_once('/') {
        Some((module, gait)) => (module, format!("{module}/"), gait),
        None => ("", String::new(), key),
    };
    (module, spec_file(&format!("{folder}robot.toml")), spec_file(&format!("{folder}gaits/{gait}.toml")))
}

/// The text of a file of the shipped specification.
pub fn spec_file(path: &str) -> SpecFile {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../model-spec/");
    SpecFile { path: path.into(), text: std::fs::read_to_string(format!("{folder}{path}")).unwrap() }
}

/// A shipped gait's file with a list of phases: the legs that stand, from 1, in each of them; in flight none.
pub fn with_phases(gait: &str, list: &[Option<usize>], then: &str) -> SpecFile {
    let (_, _, file) = files(gait);
    let short = |line: &&str| !line.starts_with("half_step");
    let mut text: String = file.text.lines().filter(short).map(|line| format!("{line}\n")).collect();
    for leg in list {
        let stance = leg.map_or(String::new(), |leg| format!("\"leg{leg}\""));
        text += &format!("\n[[phases]]\nstance = [{stance}]\nduration = [0.02, 0.5]\n");
    }
    SpecFile { text: format!("{text}\n[cycle]\nthen = \"{then}\"\n"), ..file }
}

/// The mechanism of a shipped gait.
pub fn shipped(gait: &str) -> Mechanism {
    let (robot, gait) = specification(gait);
    Mechanism::new(&robot.locked(&gait.locked).unwrap(), &gait)
}

/// The same with all modes in which it can move, and all transitions.
pub fn in_all_modes(gait: &str) -> Mechanism {
    with_all(shipped(gait))
}

/// A mechanism with all modes in which it can move, and all transitions.
pub fn with_all(mechanism: Mechanism) -> Mechanism {
    mechanism.clone().with_flight().unwrap_or(mechanism.with_all_transitions())
}

/// The robot and the gait of a shipped gait.
pub fn specification(gait: &str) -> (Robot, Gait) {
    let (_, robot, gait) = files(gait);
    let robot = parse_robot(&robot.path, &robot.text).unwrap();
    let gait = parse_gait(&gait.path, &gait.text, &robot).unwrap();
    (robot.robot, gait)
}

/// A mechanism with all its kernels as expressions.
pub struct Derived {
    pub model: Model,
    pub kernels: Vec<Kernel>,
    of_robot: Vec<(&'static str, Vec<f64>)>,
}

/// Output arrays of a kernel by name.
pub struct Outputs(Vec<(&'static str, Vec<f64>)>);

impl Derived {
    pub fn new(mechanism: &Mechanism) -> Derived {
        let (model, kernels) = kernels(mechanism);
        Derived { model, kernels, of_robot: Vec::new() }
    }

    /// A shipped gait in all its modes with all numbers of the robot as parameters.
    pub fn of_family(gait: &str) -> Derived {
        let (robot, gait) = specification(gait);
        let chosen = parameters(&robot);
        let values: Vec<f64> = chosen.iter().map(|p| p.value).collect();
        let mut family = Family::new(&robot, &gait, chosen).unwrap();
        family.mechanism = with_all(family.mechanism);
        let (model, derived, gradients) = family_kernels_with_gradients(&family);
        let of_parameters = [gradients.numbers, derived.lumps, gradients.jacobian];
        let kernels = derived.gait.into_iter().chain(gradients.sensitivity).chain(of_parameters).collect();
        let mut family = Derived { model, kernels, of_robot: vec![(PARAMETERS, values.clone())] };
        let lumps = family.run(LUMPS, &[&values]).get(LUMPS).to_vec();
        family.of_robot.push((LUMPS, lumps));
        family
    }

    /// The shipped robot's values of an input that is no part of its state.
    pub fn of_robot(&self, input: &str) -> Option<Vec<f64>> {
        self.of_robot.iter().find(|(name, _)| *name == input).map(|(_, values)| values.clone())
    }

    pub fn mechanism(&self) -> &Mechanism {
        &self.model.mechanism
    }

    pub fn kernel(&self, name: &str) -> &Kernel {
        self.kernels.iter().find(|k| k.name == name).unwrap_or_else(|| panic!("no kernel {name}"))
    }

    /// The kernel's values from its unfactored expressions.
    pub fn run(&self, name: &str, inputs: &[&[f64]]) -> Outputs {
        evaluate(&self.model.ring, self.kernel(name), inputs)
    }
}

/// A kernel's values from its unfactored expressions.
pub fn evaluate(ring: &Ring, kernel: &Kernel, inputs: &[&[f64]]) -> Outputs {
    let name = &kernel.name;
    assert_eq!(kernel.inputs.len(), inputs.len(), "{name}: inputs");
    let mut values = BTreeMap::new();
    for (input, numbers) in kernel.inputs.iter().zip(inputs) {
        assert_eq!(input.symbols.len(), numbers.len(), "{name}: {}", input.name);
        values.extend(input.symbols.iter().copied().zip(numbers.iter().copied()));
    }
    let mut flat = ring.evaluate_all(kernel.outputs.iter().flat_map(|o| &o.values), &values).into_iter();
    Outputs(kernel.outputs.iter().map(|o| (o.name, flat.by_ref().take(o.values.len()).collect())).collect())
}

impl Outputs {
    pub fn get(&self, name: &str) -> &[f64] {
        let found = self.0.iter().find(|(n, _)| *n == name);
        &found.unwrap_or_else(|| panic!("no output {name}")).1
    }

    pub fn number(&self, name: &str) -> f64 {
        self.get(name)[0]
    }
}
