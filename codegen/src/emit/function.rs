//! One kernel as one function: its signature and what is said of it.

use super::batch;
use super::body;
use super::lines::print_function;
use super::tokens::{Written, doc, ident, shape_type};
use crate::dynamics::{Input, Kernel};
use crate::expr::Ring;
use crate::program::{Operations, Program, Search};
use crate::spec::name::type_name;
use crate::turns::in_turn;
use proc_macro2::{Ident, TokenStream};
use quote::quote;
use std::cmp::Reverse;

/// A kernel with its program, ready to be written.
#[derive(Clone)]
pub struct Function<'a> {
    pub ring: &'a Ring,
    pub kernel: &'a Kernel,
    pub program: Program,
    pub operations: Operations,
    /// What it would cost as derived, without factoring.
    pub derived: Operations,
    /// The function itself, and the one for batches where it is wanted.
    pub source: String,
}

/// A function for each kernel, in order.
pub fn functions<'a>(ring: &'a Ring, kernels: &'a [Kernel]) -> Written<Vec<Function<'a>>> {
    let make = |search: &mut Search, kernel| Function::new(ring, kernel, search);
    in_turn(kernels, |kernel| Reverse(kernel.pairs()), Search::default, make).into_iter().collect()
}

impl Function<'_> {
    pub fn new<'a>(ring: &'a Ring, kernel: &'a Kernel, search: &mut Search) -> Written<Function<'a>> {
        let derived = Program::as_derived(ring, kernel);
        let program = derived.factored(search);
        let (operations, derived) = (program.operations(), derived.operations());
        let mut function = Function { ring, kernel, program, operations, derived, source: String::new() };
        function.source = function.written().map_err(|e| e.of(&format!("in the kernel `{}`", kernel.name)))?;
        Ok(function)
    }

    /// The type returned: a struct where there are several outputs.
    fn return_type(&self) -> Written<TokenStream> {
        match self.kernel.outputs.as_slice() {
            [one] => Ok(shape_type(one.shape, &quote!(f64))),
            _ => self.struct_name().map(|name| quote!(#name)),
        }
    }

    pub fn struct_name(&self) -> Written<Ident> {
        ident(&type_name(self.kernel.name.trim_end_matches(|c: char| c.is_ascii_digit())))
    }

    /// The struct returned, if the kernel has several outputs: its name and its definition.
    pub fn output_struct(&self) -> Written<Option<(Ident, TokenStream)>> {
        if self.kernel.outputs.len() < 2 {
            return Ok(None);
        }
        let name = self.struct_name()?;
        let text = format!("Result of [`{}`] and, where there is one, its twin for the other leg.", self.kernel.name);
        let text = doc(&text);
        let fields = self.kernel.outputs.iter().map(|output| {
            let (text, name, ty) = (doc(output.doc), ident(output.name)?, shape_type(output.shape, &quote!(T)));
            Ok(quote!(#text pub #name: #ty))
        });
        let fields = fields.collect::<Written<Vec<_>>>()?;
        let definition = quote! {
            #text
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct #name<T = f64> {
                #(#fields,)*
            }
        };
        Ok(Some((name, definition)))
    }

    /// The function itself, and the one for batches where it is wanted.
    fn written(&self) -> Written<String> {
        let Operations { flops, divisions, sincos } = self.operations;
        let text = doc(&format!(
            "{}\n\nOperations: {flops} additions and multiplications, {divisions} divisions, {sincos} pairs of sine and cosine.",
            self.kernel.doc
        ));
        let inputs = self.kernel.inputs.iter().map(|input| {
            let (name, ty) = (ident(input.name)?, parameter_type(input));
            Ok(quote!(#name: #ty))
        });
        let (inputs, name) = (inputs.collect::<Written<Vec<_>>>()?, ident(&self.kernel.name)?);
        let (result, body) = (self.return_type()?, body::of_state(self)?);
        let signature = quote! {
            #text
            #[inline]
            pub fn #name(#(#inputs),*) -> #result
        };
        let single = print_function(&signature, body)?;
        let is_batched = self.kernel.batched && self.kernel.outputs.len() > 1;
        Ok(if is_batched { single + &batch::source(self)? } else { single })
    }
}

fn parameter_type(input: &Input) -> TokenStream {
    let numbers = shape_type(input.shape(), &quote!(f64));
    if input.scalar { numbers } else { quote!(&#numbers) }
}
