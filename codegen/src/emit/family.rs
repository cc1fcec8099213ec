//! One generated module per gait of a family of robots, and the registry of all.

use super::description::{description, each};
use super::embedding::{comment, header, items};
use super::function::{Function, functions};
use super::methods::methods;
use super::modules::{Place, file_name, key, places, tree};
use super::tokens::{Written, doc, float, ident, path, print, whole};
use crate::dynamics::{family_kernels_with_gradients, lowest};
use crate::mechanism::{Family, Parameter, Sign};
use crate::program::Search;
use crate::spec::name::{FAMILIES_FOLDER, type_name};
use proc_macro2::TokenStream;
use quote::quote;
use syn::Path;

/// Source of the module of one gait of a family. `runtime` is the path of the module with the `Gait` trait.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn family_source(family: &Family, robot: &str, latex: &str, runtime: &str, origin: &str) -> Written<String> {
    let (mut model, kernels, gradients) = family_kernels_with_gradients(family);
    let lowest = lowest(&mut model);
    let gait = functions(&model.ring, &kernels.gait)?;
    let sensitivity = functions(&model.ring, &gradients.sensitivity)?;
    let mut search = Search::default();
    let [numbers, lumps, jacobian] = [&gradients.numbers, &kernels.lumps, &gradients.jacobian]
        .map(|kernel| Function::new(&model.ring, kernel, &mut search));
    let (numbers, lumps, jacobian) = (numbers?, lumps?, jacobian?);
    let mut source = header(origin)? + &items(&gait)? + &items(&sensitivity)?;
    [&numbers, &lumps, &jacobian].into_iter().for_each(|f| source += &f.source);
    let count = lumps.kernel.outputs[0].values.len();
    let (key, runtime) = (key(robot, &family.mechanism.gait), path(runtime)?);
    let description = description(&family.mechanism, &key, &lowest, &gait.iter().collect::<Vec<_>>(), &runtime)?;
    let of_lumps = sensitivity.iter().chain([&jacobian]);
    source += &print(implementation(family, description, count, &gait, of_lumps, latex, &runtime)?)?;
    Ok(source)
}

/// The type of the gait's members with its `impl Gait` and `impl Parametric`; they have `lumps` lumped parameters.
fn implementation<'f>(
    family: &Family,
    description: TokenStream,
    lumps: usize,
    gait: &[Function],
    of_lumps: impl Iterator<Item = &'f Function<'f>>,
    latex: &str,
    runtime: &Path,
) -> Written<TokenStream> {
    let m = &family.mechanism;
    let name = ident(&type_name(&m.gait))?;
    let text = doc(&format!("The {} of a member of the family of `{}`.", m.gait, m.robot));
    let (lumps, parameters) = (whole(lumps), whole(family.parameters.len()));
    let inline = quote!(#[inline]);
    let (of_state, of_lumps) = (methods(gait, &inline, runtime)?, methods(of_lumps, &inline, runtime)?);
    Ok(quote! {
        #text
        #[derive(Clone, Debug)]
        pub struct #name {
            description: #runtime::Description,
            parameters: [f64; #parameters],
            lumps: [f64; #lumps],
        }

        /// What the gait of the specification's robot is made of, in numbers.
        pub static DESCRIPTION: #runtime::Description = #description;

        /// What distinguishes the robots of the family.
        pub static PARAMETERS: &[#runtime::family::Parameter; #parameters] = &super::PARAMETERS;

        impl #runtime::Gait for #name {
            fn description(&self) -> &#runtime::Description {
                &self.description
            }

            fn latex(&self) -> &str {
                #latex
            }

            #of_state
        }

        impl #runtime::family::Parametric for #name {
            fn with(parameters: &[f64]) -> Result<Self, #runtime::family::Unfit> {
                let (description, parameters) =
                    #runtime::family::fit(&DESCRIPTION, PARAMETERS, parameters, numbers)?;
                Ok(#name { description, lumps: lumps(&parameters), parameters })
            }

            fn parameters(&self) -> &[f64] {
                &self.parameters
            }

            fn lumps(&self) -> &[f64] {
                &self.lumps
            }

            #of_lumps
        }
    })
}

/// Name of the generated file of a gait.
pub fn family_file_name(robot: &str, gait: &str) -> String {
    format!("{FAMILIES_FOLDER}/{}", file_name(robot, gait))
}

/// Source of the module that holds the gaits of all families, and each robot's parameters.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn families_source(
    robots: &[(&str, Vec<String>)],
    parameters: &[Vec<Parameter>],
    runtime: &str,
    origin: &str,
) -> Written<String> {
    let runtime = path(runtime)?;
    let tree = tree(robots, family_file_name, |k| parameters_item(&parameters[k], &runtime))?;
    let families = each(&places(robots)?, |Place { module, ty }| {
        Ok(quote! {
            #runtime::family::Family {
                description: &#module::DESCRIPTION,
                parameters: #module::PARAMETERS,
                member: #runtime::family::member::<#module::#ty>,
            }
        })
    })?;
    let items = print(quote! {
        #tree
        /// All gaits of the families.
        pub static FAMILIES: &[#runtime::family::Family] = &[#(#families),*];
    });
    Ok(comment(origin) + &items?)
}

fn parameters_item(parameters: &[Parameter], runtime: &Path) -> Written<TokenStream> {
    let count = whole(parameters.len());
    let parameters = each(parameters, |p| {
        let sign = match p.sign {
            Sign::Any => quote!(Any),
            Sign::NonNegative => quote!(NonNegative),
            Sign::Positive => quote!(Positive),
        };
        let (name, unit, value) = (&p.name, p.unit, float(p.value)?);
        Ok(quote! {
            #runtime::family::Parameter {
                name: #name,
                unit: #unit,
                value: #value,
                sign: #runtime::family::Sign::#sign,
            }
        })
    })?;
    Ok(quote! {
        /// What distinguishes the robots of the family, with the specification's values.
        pub static PARAMETERS: [#runtime::family::Parameter; #count] = [#(#parameters),*];
    })
}
