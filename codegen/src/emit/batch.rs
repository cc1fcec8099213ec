//! Kernels over many states at once: a loop over lanes that LLVM turns into vector instructions.
//!
//! The kernel's own lines stand in it, so that LLVM sees one body. All numbers of a lane are written one by one: an inner
//! loop over them would keep the outer one from vectorizing.

use super::body;
use super::function::Function;
use super::lines::print_function;
use super::tokens::{Written, doc, ident, shape_type};
use quote::{format_ident, quote};

/// `kernel_batch` of a kernel with several outputs, with an array of lanes for every number.
pub fn source(function: &Function) -> Written<String> {
    let single = ident(&function.kernel.name)?;
    let doc = doc(&format!("[`{single}`] of `N` states, with the same bits. Vectors and matrices are of lanes."));
    let (batch, result) = (format_ident!("{single}_batch"), function.struct_name()?);
    let lanes = quote!([f64; N]);
    let inputs = function.kernel.inputs.iter().map(|input| {
        let (name, ty) = (ident(input.name)?, shape_type(input.shape(), &lanes));
        Ok(quote!(#name: &#ty))
    });
    let inputs = inputs.collect::<Written<Vec<_>>>()?;
    let body = body::of_lane(function)?;
    let signature = quote! {
        #doc
        #[inline]
        pub fn #batch<const N: usize>(#(#inputs,)* out: &mut #result<#lanes>)
    };
    print_function(&signature, quote!(for lane in 0..N { #body }))
}
