//! The module of a whole robot, which its gaits share.

use super::description::{body, each};
use super::embedding::{header, items};
use super::function::{Function, functions};
use super::methods::methods;
use super::modules::numbered;
use super::shapes::shapes;
use super::tokens::{Written, doc, float, floats, path, print, whole as number};
use crate::dynamics::whole_kernels;
use crate::mechanism::{Whole, WholeJoint, WholeLeg};
use crate::spec::name::WHOLE;
use proc_macro2::TokenStream;
use quote::quote;
use syn::Path;

/// Source of the module of a robot. `runtime` is the path of the module with the `Whole` trait; without it there
/// are functions only.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn whole_source(whole: &Whole, runtime: Option<&str>, origin: &str) -> Written<String> {
    let (ring, kernels) = whole_kernels(whole);
    let functions = functions(&ring, &kernels)?;
    let mut source = header(origin)? + &items(&functions)?;
    if let Some(runtime) = runtime {
        source += &print(implementation(whole, &functions, &path(runtime)?)?)?;
    }
    Ok(source)
}

/// Name of the module with the `number`-th way in which the gaits of a robot lock its joints.
pub fn whole_module(number: usize) -> String {
    numbered(WHOLE, number)
}

fn implementation(whole: &Whole, functions: &[Function], runtime: &Path) -> Written<TokenStream> {
    let (text, robot, gravity) =
        (doc(&format!("The whole robot `{}`.", whole.robot)), &whole.robot, float(whole.gravity)?);
    let bodies = each(&whole.bodies, |b| body(b, runtime))?;
    let joints = each(&whole.joints, |j| joint(j, runtime))?;
    let legs = each(&whole.legs, |l| leg(l, runtime))?;
    let shapes = shapes(&functions.iter().collect::<Vec<_>>(), &quote!(#runtime::whole::Shapes), runtime)?;
    let methods = methods(functions, &quote!(#[inline]), runtime)?;
    Ok(quote! {
        #text
        #[derive(Clone, Copy, Debug, Default)]
        pub struct Whole;

        /// What the robot is made of, in numbers.
        pub static DESCRIPTION: #runtime::whole::Description = #runtime::whole::Description {
            robot: #robot,
            gravity: #gravity,
            bodies: std::borrow::Cow::Borrowed(&[#(#bodies),*]),
            joints: std::borrow::Cow::Borrowed(&[#(#joints),*]),
            legs: std::borrow::Cow::Borrowed(&[#(#legs),*]),
            shapes: #shapes,
        };

        impl #runtime::whole::Whole for Whole {
            fn description(&self) -> &#runtime::whole::Description {
                &DESCRIPTION
            }

            #methods
        }
    })
}

fn joint(j: &WholeJoint, runtime: &Path) -> Written<TokenStream> {
    let (name, rotor_inertia) = (&j.name, float(j.rotor_inertia)?);
    Ok(quote!(#runtime::whole::Joint { name: #name, rotor_inertia: #rotor_inertia }))
}

fn leg(l: &WholeLeg, runtime: &Path) -> Written<TokenStream> {
    let [first, end, foot_body] = [l.joints.start, l.joints.end, l.foot_body].map(number);
    let (name, foot) = (&l.name, floats(l.foot)?);
    Ok(quote!(#runtime::whole::Leg { name: #name, joints: #first..#end, foot_body: #foot_body, foot: #foot }))
}
