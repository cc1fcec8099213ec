//! The module of a whole robot, which its gaits share.

use super::description::{body, float, floats};
use super::function::Function;
use super::gait::{items, methods, path, written};
use super::modules::{WHOLE, key};
use crate::dynamics::whole_kernels;
use crate::mechanism::Whole;
use proc_macro2::TokenStream;
use quote::quote;

/// Source of the module of a robot. `runtime` is the path of the module with the `Whole` trait; without it there
/// are functions only.
///
/// # Errors
/// If what was generated is not Rust: a defect of the generator.
pub fn whole_source(whole: &Whole, runtime: Option<&str>, origin: &str) -> Result<String, String> {
    let (ring, kernels) = whole_kernels(whole);
    let functions: Vec<Function> = kernels.iter().map(|k| Function::new(&ring, k)).collect();
    let items = items(&functions);
    let robot = match runtime {
        Some(runtime) => implementation(whole, &functions, runtime)?,
        None => TokenStream::new(),
    };
    written(&items, robot, origin)
}

/// Name of the module with the `number`-th way in which the gaits of a robot lock its joints.
pub fn whole_module(number: usize) -> String {
    if number == 0 { WHOLE.into() } else { format!("{WHOLE}{}", number + 1) }
}

/// Name of its generated file.
pub fn whole_file_name(robot: &str, number: usize) -> String {
    key(robot, &format!("{}.rs", whole_module(number)))
}

fn implementation(whole: &Whole, functions: &[Function], runtime: &str) -> Result<TokenStream, String> {
    let runtime = path(runtime)?;
    let doc = format!(" The whole robot `{}`.", whole.robot);
    let (robot, gravity) = (&whole.robot, float(whole.gravity));
    let bodies = whole.bodies.iter().map(|b| body(b, &runtime));
    let joints = whole.joints.iter().map(|j| {
        let (name, rotor) = (&j.name, float(j.rotor_inertia));
        quote!(#runtime::whole::Joint { name: #name, rotor_inertia: #rotor })
    });
    let legs = whole.legs.iter().map(|l| {
        let (name, start, end, foot_body, foot) = (&l.name, l.joints.start, l.joints.end, l.foot_body, floats(&l.foot));
        quote! {
            #runtime::whole::Leg { name: #name, joints: #start..#end, foot_body: #foot_body, foot: #foot }
        }
    });
    let methods = methods(functions);
    Ok(quote! {
        #[doc = #doc]
        #[derive(Clone, Copy, Debug, Default)]
        pub struct Whole;
        #[doc = " What the robot is made of, in numbers."]
        pub static DESCRIPTION: #runtime::whole::Description = #runtime::whole::Description {
            robot: #robot, gravity: #gravity, bodies: &[#(#bodies),*], joints: &[#(#joints),*], legs: &[#(#legs),*],
        };
        impl #runtime::whole::Whole for Whole {
            fn description(&self) -> &'static #runtime::whole::Description { &DESCRIPTION }
            #methods
        }
    })
}
