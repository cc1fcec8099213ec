//! Kernels over slices: what a trait of the runtime asks for, with the legs and modes of a kernel under one name.

use super::function::Function;
use super::tokens::{Written, ident, whole};
use crate::dynamics::{Input, Kernel, LUMPS, Output, PARAMETERS, Shape};
use crate::mechanism::Mode;
use proc_macro2::TokenStream;
use quote::quote;
use syn::Path;

/// Per kernel a method that takes slices and writes all outputs one after another; `how` stands before each.
pub fn methods<'f>(
    functions: impl IntoIterator<Item = &'f Function<'f>>,
    how: &TokenStream,
    runtime: &Path,
) -> Written<TokenStream> {
    let method = |(base, twins): (&str, Vec<&Kernel>)| {
        let (signature, body) = (signature(base, twins[0], runtime)?, body(&twins, runtime)?);
        Ok(quote!(#how #signature { #body }))
    };
    by_base(functions).into_iter().map(method).collect()
}

/// Methods that ask another type's methods of the same name.
pub fn asking<'f>(
    other: &TokenStream,
    functions: impl IntoIterator<Item = &'f Function<'f>>,
    runtime: &Path,
) -> Written<TokenStream> {
    let method = |(base, twins): (&str, Vec<&Kernel>)| {
        let (signature, name) = (signature(base, twins[0], runtime)?, ident(base)?);
        let of = which(twins[0]).map(|which| quote!(#which,));
        let inputs = arguments(twins[0]).map(|i| ident(i.name)).collect::<Written<Vec<_>>>()?;
        Ok(quote!(#[inline] #signature { #other.#name(#of #(#inputs,)* out) }))
    };
    by_base(functions).into_iter().map(method).collect()
}

/// Kernels by what they compute, in the order of the first of each: twins for the legs or the modes stand together.
fn by_base<'f>(functions: impl IntoIterator<Item = &'f Function<'f>>) -> Vec<(&'f str, Vec<&'f Kernel>)> {
    let mut kernels: Vec<(&str, Vec<&Kernel>)> = Vec::new();
    for kernel in functions.into_iter().map(|function| function.kernel) {
        match kernels.iter_mut().find(|(base, _)| *base == kernel.what) {
            Some((_, twins)) => twins.push(kernel),
            None => kernels.push((&kernel.what, vec![kernel])),
        }
    }
    kernels
}

/// The argument that tells twins apart.
fn which(kernel: &Kernel) -> Option<TokenStream> {
    match (kernel.mode(), kernel.leg()) {
        (Some(_), _) => Some(quote!(mode)),
        (None, Some(_)) => Some(quote!(leg)),
        (None, None) => None,
    }
}

/// What is given of a state. The first twin is one of stance, whose kernels take all that those of flight do.
fn arguments(kernel: &Kernel) -> impl Iterator<Item = &Input> {
    kernel.inputs.iter().filter(|input| !is_of_robot(input))
}

fn signature(base: &str, kernel: &Kernel, runtime: &Path) -> Written<TokenStream> {
    let name = ident(base)?;
    let of = which(kernel).map(|which| {
        let ty = if kernel.mode().is_some() { quote!(#runtime::Mode) } else { quote!(usize) };
        quote!(#which: #ty,)
    });
    let inputs = arguments(kernel).map(|i| {
        let (name, ty) = (ident(i.name)?, if i.scalar { quote!(f64) } else { quote!(&[f64]) });
        Ok(quote!(#name: #ty,))
    });
    let inputs = inputs.collect::<Written<TokenStream>>()?;
    Ok(quote!(fn #name(&self, #of #inputs out: &mut [f64])))
}

/// The call of a kernel or, where there are some for both legs or for several modes, of the one that is asked for.
fn body(twins: &[&Kernel], runtime: &Path) -> Written<TokenStream> {
    let Some(which) = which(twins[0]) else { return call(twins[0]) };
    let arms = twins.iter().map(|kernel| {
        let (when, call) = (arm(kernel, runtime), call(kernel)?);
        Ok(quote!(#when => { #call }))
    });
    let arms = arms.collect::<Written<Vec<_>>>()?;
    Ok(quote!(match #which { #(#arms)* _ => out.fill(f64::NAN) }))
}

/// Of what leg or mode a kernel is, as a pattern.
fn arm(kernel: &Kernel, runtime: &Path) -> TokenStream {
    match kernel.mode() {
        Some(Mode::Flight) => quote!(#runtime::Mode::Flight),
        Some(Mode::Stance(leg)) => {
            let leg = whole(leg);
            quote!(#runtime::Mode::Stance(#leg))
        }
        None => {
            let leg = whole(kernel.leg().unwrap_or_default());
            quote!(#leg)
        }
    }
}

/// Whether an input is a property of the robot rather than of its state.
fn is_of_robot(input: &Input) -> bool {
    input.name == LUMPS || input.name == PARAMETERS
}

/// A call with checked lengths; outputs that do not fit the inputs become NaN rather than a panic.
fn call(kernel: &Kernel) -> Written<TokenStream> {
    let function = ident(&kernel.name)?;
    let arrays = kernel.inputs.iter().filter(|i| !i.scalar && !is_of_robot(i)).map(|i| ident(i.name));
    let arrays = arrays.collect::<Written<Vec<_>>>()?;
    let arguments = kernel.inputs.iter().map(|input| {
        let name = ident(input.name)?;
        Ok(if is_of_robot(input) { quote!(&self.#name) } else { quote!(#name) })
    });
    let arguments = arguments.collect::<Written<Vec<_>>>()?;
    let results = match kernel.outputs.as_slice() {
        [one] => vec![(quote!(r), one.shape)],
        several => {
            let field = |output: &Output| ident(output.name).map(|name| (quote!(r.#name), output.shape));
            several.iter().map(field).collect::<Written<_>>()?
        }
    };
    let count = results.len();
    let pieces = results.into_iter().enumerate().map(|(i, (value, shape))| {
        let rest = if i + 1 == count { quote!(_) } else { quote!(rest) };
        put(&value, shape, &rest)
    });
    Ok(quote! {
        #(let Some(#arrays) = #arrays.first_chunk() else { return out.fill(f64::NAN) };)*
        let r = #function(#(#arguments),*);
        let rest = out;
        #(#pieces)*
    })
}

/// Puts a result down at the front of `rest`; what is left of that is called `after`. Arrays are put down as what they are: of
/// slices the compiler would have to find out how long they are.
fn put(value: &TokenStream, shape: Shape, after: &TokenStream) -> TokenStream {
    match shape {
        Shape::Scalar => quote! {
            let Some((head, #after)) = rest.split_first_mut() else { return };
            *head = #value;
        },
        Shape::Vector(_) => quote! {
            let Some((head, #after)) = rest.split_first_chunk_mut() else { return };
            *head = #value;
        },
        Shape::Matrix(..) => quote! {
            let mut rows = rest;
            for row in #value {
                let Some((head, rest)) = rows.split_first_chunk_mut() else { return };
                *head = row;
                rows = rest;
            }
            let #after = rows;
        },
    }
}
