//! Where everything stands among a kernel's numbers, as values of the runtime's types. Fields are called as the kernel calls its
//! blocks: a name that the runtime does not know does not compile.

use super::function::{Function, base_name};
use super::tokens::{Written, ident, whole};
use crate::dynamics::{Block, Kernel};
use crate::spec::name::type_name;
use proc_macro2::{Ident, TokenStream};
use quote::quote;
use std::collections::BTreeSet;
use syn::Path;

/// The shapes of all kernels that have several outputs or weights of several kinds. Twins for both legs have the same.
pub fn shapes(functions: &[Function], all: &TokenStream, runtime: &Path) -> Written<TokenStream> {
    let mut known = BTreeSet::new();
    let several = |k: &&Kernel| k.outputs.len() > 1 || k.inputs.iter().any(|input| !input.blocks.is_empty());
    let kernels = functions.iter().map(|f| f.kernel).filter(several);
    let fields = kernels.filter(|k| known.insert(base_name(&k.name).0)).map(|k| {
        let base = base_name(&k.name).0;
        let (field, shape) = (ident(base)?, kernel(base, k, runtime)?);
        Ok(quote!(#field: #shape))
    });
    let fields = fields.collect::<Written<Vec<_>>>()?;
    Ok(quote!(#all { #(#fields,)* ..#all::NONE }))
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
