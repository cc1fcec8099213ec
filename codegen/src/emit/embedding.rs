//! One generated module per embedding: the kernels of all gaits that move the robot alike, in whatever phases.

use super::function::{Function, functions};
use super::methods::methods;
use super::modules::numbered;
use super::tokens::{Written, ident, path, print};
use crate::dynamics::{Kernel, kernels, lowest};
use crate::expr::Ring;
use crate::mechanism::Mechanism;
use crate::spec::name::EMBEDDING;
use quote::quote;
use std::collections::BTreeSet;

/// What is derived of a mechanism.
pub struct Embedding {
    ring: Ring,
    kernels: Vec<Kernel>,
    /// Which of the mechanism's points can be the lowest.
    pub lowest: Vec<usize>,
}

impl Embedding {
    /// With the kernels of all modes and transitions of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Embedding {
        let (mut model, kernels) = kernels(mechanism);
        let lowest = lowest(&mut model);
        Embedding { ring: model.ring, kernels, lowest }
    }

    /// Its kernels, factored and written.
    ///
    /// # Errors
    /// If a number of them cannot be one in Rust.
    pub fn functions(&self) -> Written<Vec<Function<'_>>> {
        functions(&self.ring, &self.kernels)
    }
}

/// The type that has its kernels over slices.
pub(super) const KERNELS: &str = "Kernels";

/// Source of the module with an embedding's functions. `runtime` is the path of the module with the `Gait` trait;
/// without it there are functions only.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn embedding_source(functions: &[Function], runtime: Option<&str>, origin: &str) -> Written<String> {
    let mut source = header(origin)? + &items(functions)?;
    if let Some(runtime) = runtime {
        let (name, methods) = (ident(KERNELS)?, methods(functions, &quote!(pub), &path(runtime)?)?);
        source += &print(quote! {
            /// All of them over slices, for the gaits: compiled once, whoever asks.
            pub(super) struct #name;

            impl #name {
                #methods
            }
        })?;
    }
    Ok(source)
}

/// Name of the module with the `number`-th way in which the gaits of a robot move it.
pub fn embedding_module(number: usize) -> String {
    numbered(EMBEDDING, number)
}

/// How a module begins.
pub(super) fn header(origin: &str) -> Written<String> {
    Ok(comment(origin)
        + &print(quote!(
            use super::math;
        ))?)
}

/// A line that is no code, which tokens cannot be: `text` is one of visible characters.
pub(super) fn comment(text: &str) -> String {
    ["// ", text, "\n"].concat()
}

/// The functions of a module, with the structs that they return.
pub(super) fn items(functions: &[Function]) -> Written<String> {
    let mut structs = BTreeSet::new();
    let mut items = String::new();
    for function in functions {
        if let Some((name, definition)) = function.output_struct()?
            && structs.insert(name)
        {
            items += &print(definition)?;
        }
        items += &function.source;
    }
    Ok(items)
}
