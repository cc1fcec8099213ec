//! Where everything stands among a kernel's numbers, as values of the runtime's types. Fields are called as the kernel calls its
//! blocks: a name that the runtime does not know does not compile.

use super::function::Function;
use super::tokens::{Written, ident, whole};
use crate::dynamics::{Block, Kernel};
use crate::mechanism::Mode;
use crate::spec::name::type_name;
use proc_macro2::{Ident, TokenStream};
use quote::quote;
use std::collections::BTreeMap;
use syn::Path;

/// The shapes of all kernels but those that give one thing: of each mode, then the others. Twins for both legs have the same,
/// but for the length of what is known early, which is that of the longer.
pub fn shapes(functions: &[&Function], all: &TokenStream, runtime: &Path) -> Written<TokenStream> {
    type Belongs = fn(Option<Mode>) -> bool;
    let kernels = |belongs: Belongs| functions.iter().map(|f| f.kernel).filter(move |k| belongs(k.mode()));
    let modes: [(&str, Belongs); 2] =
        [("stance", |m| matches!(m, Some(Mode::Stance(_)))), ("flight", |m| m == Some(Mode::Flight))];
    let of_mode = modes.into_iter().filter(|(_, belongs)| kernels(*belongs).next().is_some()).map(|(name, belongs)| {
        let (name, ty) = (ident(name)?, quote!(#runtime::shape::ModeShapes));
        let fields = fields(kernels(belongs), runtime)?;
        Ok(quote!(#name: #ty { #fields ..#ty::NONE },))
    });
    let of_mode = of_mode.collect::<Written<TokenStream>>()?;
    let others = fields(kernels(|mode| mode.is_none()), runtime)?;
    Ok(quote!(#all { #of_mode #others ..#all::NONE }))
}

fn fields<'k>(kernels: impl Iterator<Item = &'k Kernel>, runtime: &Path) -> Written<TokenStream> {
    let mut by_base: BTreeMap<&str, &Kernel> = BTreeMap::new();
    let mut order = Vec::new();
    let length = |k: &Kernel| k.outputs.iter().map(|output| output.values.len()).sum::<usize>();
    for kernel in kernels.filter(|k| k.has_shape()) {
        let known = by_base.entry(&kernel.what).or_insert_with(|| {
            order.push(kernel.what.as_str());
            kernel
        });
        if length(kernel) > length(known) {
            *known = kernel;
        }
    }
    let field = |base: &&str| {
        let (field, shape) = (ident(base)?, kernel(base, by_base[base], runtime)?);
        Ok(quote!(#field: #shape,))
    };
    order.iter().map(field).collect()
}

fn kernel(base: &str, kernel: &Kernel, runtime: &Path) -> Written<TokenStream> {
    let outputs: Vec<Block> = kernel.outputs.iter().map(|o| Block { name: o.name, shape: o.shape }).collect();
    let inputs = kernel.inputs.iter().filter(|input| !input.blocks.is_empty()).map(|input| {
        let (field, ty) = (ident(input.name)?, ident(&type_name(&format!("{base}_{}", input.name)))?);
        let shape = record(&ty, &input.blocks, &TokenStream::new(), runtime)?;
        Ok(quote!(#field: #shape,))
    });
    let inputs = inputs.collect::<Written<TokenStream>>()?;
    record(&ident(&type_name(base))?, &outputs, &inputs, runtime)
}

/// Blocks one after another, with what else is known of the kernel.
fn record(ty: &Ident, blocks: &[Block], more: &TokenStream, runtime: &Path) -> Written<TokenStream> {
    let mut at = 0;
    let mut fields = Vec::new();
    for block in blocks {
        let (rows, columns) = block.shape.size();
        let (name, numbers) = (ident(block.name)?, [at, rows, columns].map(whole));
        fields.push(quote!(#name: #runtime::shape::Block::new(#(#numbers),*)));
        at += block.count();
    }
    let len = whole(at);
    Ok(quote!(#runtime::shape::#ty { #(#fields,)* #more len: #len, ..#runtime::shape::#ty::NONE }))
}
