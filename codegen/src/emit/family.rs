//! One generated module per gait of a family of robots, and the registry of all.

use super::description::{description, float};
use super::function::{Function, ident};
use super::gait::{items, methods, path, written};
use super::modules::{file_name, key, paths, tree};
use super::type_name;
use crate::dynamics::family_kernels;
use crate::mechanism::{Family, Parameter, Sign};
use proc_macro2::Literal;
use quote::quote;

/// Source of the module of one gait of a family. `runtime` is the path of the module with the `Gait` trait.
///
/// # Errors
/// If what was generated is not Rust: a defect of the generator.
pub fn family_source(family: &Family, robot: &str, latex: &str, runtime: &str, origin: &str) -> Result<String, String> {
    let (model, kernels) = family_kernels(family);
    let gait: Vec<Function> = kernels.gait.iter().map(|k| Function::new(&model.ring, k)).collect();
    let sensitivity: Vec<Function> = kernels.sensitivity.iter().map(|k| Function::new(&model.ring, k)).collect();
    let [numbers, lumps, jacobian] = kernels.parameters.each_ref().map(|k| Function::new(&model.ring, k));
    let count = |f: &Function| Literal::usize_unsuffixed(f.kernel.outputs[0].values.len());
    let (lump_count, parameter_count) = (count(&lumps), Literal::usize_unsuffixed(family.parameters.len()));
    let items =
        [items(&gait), items(&sensitivity), numbers.source, lumps.source.clone(), jacobian.source.clone()].concat();
    let runtime = path(runtime)?;
    let mechanism = &family.mechanism;
    let name = ident(&type_name(&mechanism.gait));
    let doc = format!(" The {} of a member of the family of `{}`.", mechanism.gait, mechanism.robot);
    let description = description(mechanism, &key(robot, &mechanism.gait), &gait, &runtime);
    let of_gait = methods(&gait);
    let of_member = methods(&[sensitivity, vec![jacobian]].concat());
    let member = quote! {
        #[doc = #doc]
        #[derive(Clone, Debug)]
        pub struct #name {
            description: #runtime::Description,
            parameters: [f64; #parameter_count],
            lumps: [f64; #lump_count],
        }
        #[doc = " What the gait of the specification's robot is made of, in numbers."]
        pub static DESCRIPTION: #runtime::Description = #description;
        #[doc = " What distinguishes the robots of the family."]
        pub static PARAMETERS: &[#runtime::family::Parameter; #parameter_count] = &super::PARAMETERS;
        impl #runtime::Gait for #name {
            fn description(&self) -> &#runtime::Description { &self.description }
            fn latex(&self) -> &'static str { #latex }
            #of_gait
        }
        impl #runtime::family::Parametric for #name {
            fn with(parameters: &[f64]) -> Result<Self, #runtime::family::Unfit> {
                let (description, parameters) =
                    #runtime::family::fit(&DESCRIPTION, PARAMETERS, parameters, numbers)?;
                Ok(#name { description, lumps: lumps(&parameters), parameters })
            }
            fn parameters(&self) -> &[f64] { &self.parameters }
            fn lumps(&self) -> &[f64] { &self.lumps }
            #of_member
        }
    };
    written(&items, member, origin)
}

/// Name of the generated file of a gait.
pub fn family_file_name(robot: &str, gait: &str) -> String {
    format!("family/{}", file_name(robot, gait))
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
        let (name, unit, value) = (&p.name, p.unit, float(p.value));
        source += &format!(
            "{runtime}::family::Parameter {{ name: {name:?}, unit: {unit:?}, value: {value}, \
             sign: {runtime}::family::Sign::{sign} }}, "
        );
    }
    source + "];\n"
}
