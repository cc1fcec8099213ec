//! One generated module per gait of a family of robots, and the registry of all.

use super::description::description;
use super::function::{Function, functions};
use super::gait::{constant, getter, header, items, methods};
use super::layout::Layout;
use super::modules::{file_name, key, paths, tree};
use crate::dynamics::{family_kernels, lowest};
use crate::mechanism::{Family, Parameter, Sign};
use crate::program::Search;
use crate::spec::name::{FAMILIES_FOLDER, type_name};

/// Source of the module of one gait of a family. `runtime` is the path of the module with the `Gait` trait.
pub fn family_source(family: &Family, robot: &str, latex: &str, runtime: &str, origin: &str) -> String {
    let (mut model, kernels) = family_kernels(family);
    let lowest = lowest(&mut model);
    let (gait, sensitivity) = (functions(&model.ring, &kernels.gait), functions(&model.ring, &kernels.sensitivity));
    let mut search = Search::default();
    let [numbers, lumps, jacobian] =
        kernels.parameters.each_ref().map(|kernel| Function::new(&model.ring, kernel, &mut search));
    let m = &family.mechanism;
    let name = type_name(&m.gait);
    let (lump_count, parameter_count) = (lumps.kernel.outputs[0].values.len(), family.parameters.len());
    let mut out = header(origin);
    out += &items(&gait);
    out += &items(&sensitivity);
    [&numbers, &lumps, &jacobian].into_iter().for_each(|f| out += &f.source);
    out += &format!(
        "/// The {} of a member of the family of `{}`.\n#[derive(Clone, Debug)]\npub struct {name} {{\n\
         \x20   description: {runtime}::Description,\n\
         \x20   parameters: [f64; {parameter_count}],\n\
         \x20   lumps: [f64; {lump_count}],\n}}\n",
        m.gait, m.robot
    );
    let (ty, numbers) =
        (format!("{runtime}::Description"), description(m, &key(robot, &m.gait), &lowest, &gait, runtime));
    constant(
        "What the gait of the specification's robot is made of, in numbers.",
        "DESCRIPTION",
        &ty,
        numbers,
        &mut out,
    );
    let ty = format!("&[{runtime}::family::Parameter; {parameter_count}]");
    let shared = Layout::Word("&super::PARAMETERS".into());
    constant("What distinguishes the robots of the family.", "PARAMETERS", &ty, shared, &mut out);
    out += &format!("impl {runtime}::Gait for {name} {{");
    let field = |name: &str| Layout::Word(format!("&self.{name}"));
    getter("description", &format!("&{runtime}::Description"), field("description"), &mut out);
    getter("latex", "&'static str", Layout::value(latex), &mut out);
    methods(&gait, &mut out);
    out += &format!(
        "\n}}\nimpl {runtime}::family::Parametric for {name} {{\n\
         \x20   fn with(parameters: &[f64]) -> Result<Self, {runtime}::family::Unfit> {{\n\
         \x20       let (description, parameters) =\n\
         \x20           {runtime}::family::fit(&DESCRIPTION, PARAMETERS, parameters, numbers)?;\n\
         \x20       Ok({name} {{ description, lumps: lumps(&parameters), parameters }})\n\
         \x20   }}"
    );
    getter("parameters", "&[f64]", field("parameters"), &mut out);
    getter("lumps", "&[f64]", field("lumps"), &mut out);
    methods(&[sensitivity, vec![jacobian]].concat(), &mut out);
    out + "\n}\n"
}

/// Name of the generated file of a gait.
pub fn family_file_name(robot: &str, gait: &str) -> String {
    format!("{FAMILIES_FOLDER}/{}", file_name(robot, gait))
}

/// Source of the module that holds the gaits of all families, and each robot's parameters.
pub fn families_source(
    robots: &[(&str, Vec<String>)],
    parameters: &[Vec<Parameter>],
    runtime: &str,
    origin: &str,
) -> String {
    let shared = |k: usize| parameters_source(&parameters[k], runtime);
    let mut source = tree(robots, family_file_name, shared, origin);
    source += &format!("/// All gaits of the families.\npub static FAMILIES: &[{runtime}::family::Family] = &[");
    for (module, name) in paths(robots) {
        source += &format!(
            "{runtime}::family::Family {{ description: &{module}::DESCRIPTION, parameters: {module}::PARAMETERS, \
             member: {runtime}::family::member::<{module}::{name}> }}, "
        );
    }
    source + "];\n"
}

fn parameters_source(parameters: &[Parameter], runtime: &str) -> String {
    let count = parameters.len();
    let mut source = format!(
        "/// What distinguishes the robots of the family, with the specification's values.\n\
         pub static PARAMETERS: [{runtime}::family::Parameter; {count}] = ["
    );
    for p in parameters {
        let sign = match p.sign {
            Sign::Any => "Any",
            Sign::NonNegative => "NonNegative",
            Sign::Positive => "Positive",
        };
        let (name, unit, value) = (&p.name, p.unit, p.value + 0.0);
        source += &format!(
            "{runtime}::family::Parameter {{ name: {name:?}, unit: {unit:?}, value: {value:?}, \
             sign: {runtime}::family::Sign::{sign} }}, "
        );
    }
    source + "];\n"
}
