//! One generated module per gait: its type, its numbers, and whom it asks for its dynamics.

use super::description::{description, each};
use super::embedding::{Embedding, KERNELS, comment};
use super::function::Function;
use super::methods::asking;
use super::modules::key;
use super::tokens::{Written, doc, float, ident, path, print, whole};
use crate::mechanism::{Lever, Mechanism};
use crate::spec::name::type_name;
use proc_macro2::TokenStream;
use quote::quote;
use syn::Path;

/// What a gait is made of beside its mechanism.
pub struct Beside<'t> {
    pub levers: &'t [Lever],
    /// Its closed forms.
    pub latex: &'t str,
    /// The texts of the robot's file and the gait's.
    pub specification: [&'t str; 2],
}

/// The modules, beside that of the gait, that have what it shares with others.
pub struct Modules<'t> {
    /// Of its robot; empty for one whose gaits need none.
    pub robot: &'t str,
    pub embedding: &'t str,
    pub whole: &'t str,
}

/// Source of one gait's module: the gait moves the robot as `embedding` does, `functions` are that one's kernels. `runtime` is the path
/// of the module with the `Gait` trait; without it there are functions only.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn gait_source(
    mechanism: &Mechanism,
    embedding: &Embedding,
    functions: &[Function],
    beside: &Beside,
    modules: &Modules,
    runtime: Option<&str>,
    origin: &str,
) -> Written<String> {
    let module = ident(modules.embedding)?;
    let mut source = comment(origin) + &print(quote!(pub use super::#module::*;))?;
    if let Some(runtime) = runtime {
        let (key, runtime) = (key(modules.robot, &mechanism.gait), path(runtime)?);
        let own: Vec<&Function> = functions.iter().filter(|f| f.kernel.serves(mechanism)).collect();
        let description = description(mechanism, &key, &embedding.lowest, &own, &runtime)?;
        source += &print(implementation(mechanism, description, beside, modules, &own, &runtime)?)?;
    }
    Ok(source)
}

/// The gait's type with its description, which is given, and its `impl Gait`.
fn implementation(
    m: &Mechanism,
    description: TokenStream,
    beside: &Beside,
    modules: &Modules,
    functions: &[&Function],
    runtime: &Path,
) -> Written<TokenStream> {
    let (name, whole, embedding) = (ident(&type_name(&m.gait))?, ident(modules.whole)?, ident(modules.embedding)?);
    let text = doc(&format!("The {} of `{}`.", m.gait, m.robot));
    let (latex, [robot_file, gait_file]) = (beside.latex, beside.specification);
    let levers = each(beside.levers, |l| lever(l, runtime))?;
    let kernels = ident(KERNELS)?;
    let methods = asking(&quote!(super::#embedding::#kernels), functions.iter().copied(), runtime)?;
    Ok(quote! {
        #text
        #[derive(Clone, Copy, Debug, Default)]
        pub struct #name;

        /// What the gait is made of, in numbers.
        pub static DESCRIPTION: #runtime::Description = #description;

        /// Numbers of the specification, and what depends on them.
        static LEVERS: &[#runtime::Lever] = &[#(#levers),*];

        /// What it was derived from.
        pub static SPECIFICATION: #runtime::Specification = #runtime::Specification {
            robot: std::borrow::Cow::Borrowed(#robot_file),
            gait: std::borrow::Cow::Borrowed(#gait_file),
        };

        impl #runtime::Gait for #name {
            fn description(&self) -> &#runtime::Description {
                &DESCRIPTION
            }

            fn specification(&self) -> Option<&#runtime::Specification> {
                Some(&SPECIFICATION)
            }

            fn latex(&self) -> &str {
                #latex
            }

            fn levers(&self) -> &[#runtime::Lever] {
                LEVERS
            }

            fn whole(&self) -> Option<&dyn #runtime::whole::Whole> {
                Some(&super::#whole::Whole)
            }

            #methods
        }
    })
}

/// Numbers of the specification that change together, as a value of the runtime's type.
fn lever(lever: &Lever, runtime: &Path) -> Written<TokenStream> {
    let Lever { name, numbers, unit, value, slopes } = lever;
    let value = float(*value)?;
    let slopes = each(slopes, |(number, slope)| {
        let (number, slope) = (whole(*number), float(*slope)?);
        Ok(quote!((#number, #slope)))
    })?;
    Ok(quote! {
        #runtime::Lever {
            name: #name,
            numbers: std::borrow::Cow::Borrowed(&[#(#numbers),*]),
            unit: #unit,
            value: #value,
            slopes: std::borrow::Cow::Borrowed(&[#(#slopes),*]),
        }
    })
}
