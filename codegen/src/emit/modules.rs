//! The registry of all gaits: a module for each, in those of their robots.

use super::embedding::{comment, embedding_module};
use super::tokens::{Written, doc, ident, path, print};
use super::whole::whole_module;
use crate::spec::name::{module_name, type_name};
use proc_macro2::{Ident, TokenStream};
use quote::quote;

/// Name of the generated file with the elementary functions.
pub const MATH_FILE: &str = "math.rs";

/// What the program calls a gait: `trot`, or `rabbit/walk` for one whose robot has a module.
pub fn key(robot: &str, gait: &str) -> String {
    if robot.is_empty() { gait.into() } else { format!("{robot}/{gait}") }
}

/// Name of the generated file of a gait.
pub fn file_name(robot: &str, gait: &str) -> String {
    key(robot, &format!("{}.rs", module_name(gait)))
}

/// Name of the `number`-th of some modules of a robot: the first needs no number.
pub(super) fn numbered(name: &str, number: usize) -> String {
    if number == 0 { name.into() } else { format!("{name}{}", number + 1) }
}

/// What the gaits of a robot have together: in how many ways they move it, and how many whole robots it is to them.
#[derive(Clone, Copy, Debug)]
pub struct Together {
    pub embeddings: usize,
    pub wholes: usize,
}

/// Source of the module that holds all gaits of a build; `together` is for each robot.
///
/// # Errors
/// If a name of it cannot be one in Rust.
pub fn registry_source(
    robots: &[(&str, Vec<String>)],
    together: &[Together],
    runtime: Option<&str>,
    origin: &str,
) -> Written<String> {
    let shared = |robot: usize| {
        let Together { embeddings, wholes } = together[robot];
        let numbered = |name: String, what: &str| module(&name, what, &file_name(robots[robot].0, &name));
        let embeddings = (0..embeddings).map(|n| numbered(embedding_module(n), "Kernels that gaits have together."));
        let wholes = (0..wholes).map(|n| numbered(whole_module(n), "The whole robot."));
        embeddings.chain(wholes).collect::<Written<TokenStream>>()
    };
    let mut items = tree(robots, file_name, shared)?;
    if let Some(runtime) = runtime {
        let runtime = path(runtime)?;
        let gaits = places(robots)?.into_iter().map(|Place { module, ty }| quote!(&#module::#ty));
        items.extend(quote! {
            /// All gaits of this build.
            pub static GAITS: &[&dyn #runtime::Gait] = &[#(#gaits),*];
        });
    }
    Ok(comment(origin) + &print(items)?)
}

/// Where a gait is in the code: the path of its module, and its type in there.
pub(super) struct Place {
    pub module: TokenStream,
    pub ty: Ident,
}

/// The places of all gaits.
pub(super) fn places(robots: &[(&str, Vec<String>)]) -> Written<Vec<Place>> {
    let place = |robot: &str, gait: &str| {
        let (module, ty) = (ident(&module_name(gait))?, ident(&type_name(gait))?);
        let robot = if robot.is_empty() { None } else { Some(ident(robot)?) };
        Ok(Place { module: robot.map_or(quote!(#module), |robot| quote!(#robot::#module)), ty })
    };
    robots.iter().flat_map(|(robot, gaits)| gaits.iter().map(move |gait| place(robot, gait))).collect()
}

/// A module for each gait, in that of its robot with what `shared` has for the robot, and the one with the
/// elementary functions. `file` names the files to include.
pub(super) fn tree(
    robots: &[(&str, Vec<String>)],
    file: fn(&str, &str) -> String,
    shared: impl Fn(usize) -> Written<TokenStream>,
) -> Written<TokenStream> {
    let mut tree = module("math", "Elementary functions with pinned results.", MATH_FILE)?;
    for (k, (robot, gaits)) in robots.iter().enumerate() {
        let gait_module = |gait: &String| {
            module(&module_name(gait), &format!("Generated dynamics of the {gait}."), &file(robot, gait))
        };
        let mut items = shared(k)?;
        items.extend(gaits.iter().map(gait_module).collect::<Written<TokenStream>>()?);
        if robot.is_empty() {
            tree.extend(items);
            continue;
        }
        let (text, robot) = (doc(&format!("Gaits of the robot `{robot}`.")), ident(robot)?);
        tree.extend(quote! {
            #text
            pub mod #robot {
                use super::math;
                #items
            }
        });
    }
    Ok(tree)
}

/// A module that is a generated file.
fn module(name: &str, what: &str, file: &str) -> Written<TokenStream> {
    let (name, what, file) = (ident(name)?, doc(what), format!("/{file}"));
    Ok(quote! {
        #what
        #[rustfmt::skip]
        #[allow(clippy::all, clippy::pedantic)]
        pub mod #name {
            include!(concat!(env!("OUT_DIR"), #file));
        }
    })
}
