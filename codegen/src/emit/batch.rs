//! Kernels over many states at once: a loop over lanes that LLVM turns into vector instructions.
//!
//! The loop calls the kernel itself, so that a lane has the bits that the single state has. All numbers
//! of a lane are written one by one: an inner loop over them would keep the outer one from vectorizing.

use super::function::{Function, ident, shape_type};
use crate::dynamics::Shape;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

/// `kernel_batch` of a kernel with several outputs, with an array of lanes for every number.
pub fn source(function: &Function) -> TokenStream {
    let kernel = &function.kernel;
    let (single, name) = (ident(&kernel.name), ident(&format!("{}_batch", kernel.name)));
    let doc = format!(" [`{}`] of `N` states, with the same bits. Vectors and matrices are of lanes.", kernel.name);
    let lanes = quote!([f64; N]);
    let parameters = kernel.inputs.iter().map(|i| {
        let shape = if i.scalar { Shape::Scalar } else { Shape::Vector(i.symbols.len()) };
        let (name, ty) = (ident(i.name), shape_type(shape, &lanes));
        quote!(#name: &#ty)
    });
    let arguments = kernel.inputs.iter().map(|i| {
        let name = ident(i.name);
        let elements = (0..i.symbols.len()).map(Literal::usize_unsuffixed);
        if i.scalar { quote!(#name[lane]) } else { quote!(&[#(#name[#elements][lane]),*]) }
    });
    let stores = kernel.outputs.iter().flat_map(|o| {
        let field = ident(o.name);
        places(o.shape).into_iter().map(move |place| quote!(out.#field #place [lane] = state.#field #place;))
    });
    let result: Ident = ident(&function.struct_name());
    quote! {
        #[doc = #doc]
        #[inline]
        pub fn #name<const N: usize>(#(#parameters,)* out: &mut #result<[f64; N]>) {
            for lane in 0..N {
                let state = #single(#(#arguments),*);
                #(#stores)*
            }
        }
    }
}

/// The indices of all numbers of a shape.
fn places(shape: Shape) -> Vec<TokenStream> {
    let index = Literal::usize_unsuffixed;
    match shape {
        Shape::Scalar => vec![TokenStream::new()],
        Shape::Vector(n) => (0..n).map(index).map(|k| quote!([#k])).collect(),
        Shape::Matrix(rows, columns) => (0..rows * columns)
            .map(|k| (index(k / columns), index(k % columns)))
            .map(|(row, column)| quote!([#row][#column]))
            .collect(),
    }
}
