//! One kernel as one function.

use super::{batch, type_name};
use crate::dynamics::{Kernel, Output, Shape};
use crate::expr::{Kind, Ring};
use crate::program::{Id, Node, Operations, Program, Sum, Term};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};

/// Bindings per scope.
const BLOCK: usize = 200;

/// A kernel with its program, ready to be written.
#[derive(Clone)]
pub struct Function<'a> {
    pub ring: &'a Ring,
    pub kernel: &'a Kernel,
    pub program: Program,
    /// What it would cost as derived, without factoring.
    pub derived: Operations,
}

/// `inverse_jacobian2` → (`inverse_jacobian`, true): leg kernels end in the leg's number.
pub fn base_name(name: &str) -> (&str, bool) {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (base, base.len() != name.len())
}

pub fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}

fn float(value: f64) -> TokenStream {
    let literal = Literal::f64_unsuffixed(value.abs());
    if value.is_sign_negative() { quote!(-#literal) } else { quote!(#literal) }
}

impl Function<'_> {
    pub fn new<'a>(ring: &'a Ring, kernel: &'a Kernel) -> Function<'a> {
        Function {
            ring,
            kernel,
            program: Program::new(ring, kernel),
            derived: Program::as_derived(ring, kernel).operations(),
        }
    }

    /// The type returned: a struct where there are several outputs.
    pub fn return_type(&self) -> TokenStream {
        match self.kernel.outputs.as_slice() {
            [one] => shape_type(one.shape, &quote!(f64)),
            _ => {
                let name = ident(&self.struct_name());
                quote!(#name)
            }
        }
    }

    pub fn struct_name(&self) -> String {
        type_name(base_name(&self.kernel.name).0)
    }

    /// The struct returned, if the kernel has several outputs.
    pub fn output_struct(&self) -> Option<(String, TokenStream)> {
        if self.kernel.outputs.len() < 2 {
            return None;
        }
        let name = ident(&self.struct_name());
        let doc = format!(" Result of [`{}`] and, where there is one, its twin for the other leg.", self.kernel.name);
        let fields = self.kernel.outputs.iter().map(|o| {
            let (field, ty, doc) = (ident(o.name), shape_type(o.shape, &quote!(T)), format!(" {}", o.doc));
            quote!(#[doc = #doc] pub #field: #ty,)
        });
        Some((
            self.struct_name(),
            quote! {
                #[doc = #doc]
                #[derive(Clone, Copy, Debug, PartialEq)]
                pub struct #name<T = f64> { #(#fields)* }
            },
        ))
    }

    /// The function itself.
    pub fn source(&self) -> TokenStream {
        let name = ident(&self.kernel.name);
        let ops = self.program.operations();
        let doc = format!(" {}", self.kernel.doc);
        let counts = format!(
            " Operations: {} additions and multiplications, {} divisions, {} pairs of sine and cosine.",
            ops.flops, ops.divisions, ops.sincos
        );
        let inputs = self.kernel.inputs.iter().map(|i| {
            let (name, n) = (ident(i.name), Literal::usize_unsuffixed(i.symbols.len()));
            if i.scalar { quote!(#name: f64) } else { quote!(#name: &[f64; #n]) }
        });
        let returns = self.return_type();
        let body = self.body();
        let batched = self.kernel.batched && self.kernel.outputs.len() > 1;
        // The loop over lanes vectorizes only if the kernel is part of it.
        let inline = if batched { quote!(#[inline(always)]) } else { quote!(#[inline]) };
        let batch = batched.then(|| batch::source(self));
        quote! {
            #[doc = #doc]
            #[doc = ""]
            #[doc = #counts]
            #inline
            pub fn #name(#(#inputs),*) -> #returns { #body }
            #batch
        }
    }

    /// Length of its source.
    pub fn bytes(&self) -> usize {
        syn::parse2(self.source()).map_or(0, |file| prettyplease::unparse(&file).len())
    }

    /// Names of the nodes that are inputs.
    fn input_name(&self, input: usize, element: usize) -> Ident {
        let symbol = self.kernel.inputs[input].symbols[element];
        match self.ring.kind(symbol) {
            Kind::Symbol(name) => ident(&name),
            _ => ident(&format!("in{input}_{element}")),
        }
    }

    fn node_name(&self, id: Id) -> Ident {
        match self.program.nodes[id as usize] {
            Node::Input(i, k) => self.input_name(i, k),
            Node::Sin(s) => ident(&format!("sin{s}")),
            Node::Cos(s) => ident(&format!("cos{s}")),
            Node::Value(_) | Node::Reciprocal(_) => ident(&format!("v{id}")),
        }
    }

    fn body(&self) -> TokenStream {
        let order = self.program.schedule();
        let used: BTreeSet<Id> = order.iter().copied().collect();
        let inputs = self.kernel.inputs.iter().enumerate().filter(|(_, i)| !i.scalar).map(|(i, input)| {
            let source = ident(input.name);
            let names = (0..input.symbols.len()).map(|k| {
                let id = self.program.nodes.iter().position(|n| *n == Node::Input(i, k));
                let name = self.input_name(i, k);
                if id.is_some_and(|id| used.contains(&(id as Id))) { quote!(#name) } else { quote!(_) }
            });
            quote!(let [#(#names),*] = *#source;)
        });
        let scalars = self.kernel.inputs.iter().enumerate().filter(|(_, i)| i.scalar).filter_map(|(i, input)| {
            let (source, name) = (ident(input.name), self.input_name(i, 0));
            (source != name).then(|| quote!(let #name = #source;))
        });
        let lets = self.lets(&order);
        let outputs = self.outputs();
        quote! { #(#inputs)* #(#scalars)* #lets #outputs }
    }

    /// The bindings, in scopes of limited size that hand on what is needed later.
    fn lets(&self, order: &[Id]) -> TokenStream {
        let mut written = BTreeSet::new();
        let mut statements: Vec<(Vec<Id>, TokenStream)> = Vec::new();
        for &id in order {
            match self.program.nodes[id as usize] {
                Node::Input(..) => {}
                Node::Sin(s) | Node::Cos(s) => {
                    if written.insert(s) {
                        let name = |node: Node, text: &str| {
                            let used = order.iter().any(|i| self.program.nodes[*i as usize] == node);
                            if used { ident(&format!("{text}{s}")) } else { ident("_") }
                        };
                        let (sin, cos) = (name(Node::Sin(s), "sin"), name(Node::Cos(s), "cos"));
                        let argument = self.sum(&self.program.sums[s]);
                        let both = self.pair(s);
                        statements.push((both, quote!(let (#sin, #cos) = math::sin_cos(#argument);)));
                    }
                }
                Node::Value(s) => {
                    let (name, value) = (self.node_name(id), self.sum(&self.program.sums[s]));
                    statements.push((vec![id], quote!(let #name = #value;)));
                }
                Node::Reciprocal(s) => {
                    let (name, value) = (self.node_name(id), self.sum(&self.program.sums[s]));
                    statements.push((vec![id], quote!(let #name = 1.0 / (#value);)));
                }
            }
        }
        if statements.len() <= BLOCK {
            return statements.into_iter().map(|(_, s)| s).collect();
        }
        let last_use = self.last_uses(order);
        let mut position: BTreeMap<Id, usize> = BTreeMap::new();
        for (k, (ids, _)) in statements.iter().enumerate() {
            position.extend(ids.iter().map(|id| (*id, k)));
        }
        let mut blocks = TokenStream::new();
        for (number, block) in statements.chunks(BLOCK).enumerate() {
            let end = (number + 1) * BLOCK;
            let kept: Vec<Ident> = block
                .iter()
                .flat_map(|(ids, _)| ids)
                .filter(|id| {
                    last_use.get(id).is_some_and(|user| user.is_none_or(|u| position.get(&u).is_none_or(|p| *p >= end)))
                })
                .map(|id| self.node_name(*id))
                .collect();
            let lines = block.iter().map(|(_, s)| s);
            blocks.extend(quote!(let [#(#kept),*] = { #(#lines)* [#(#kept),*] };));
        }
        blocks
    }

    /// Nodes that are the sine or cosine of sum `s`.
    fn pair(&self, s: usize) -> Vec<Id> {
        let is = |n: &Node| *n == Node::Sin(s) || *n == Node::Cos(s);
        self.program.nodes.iter().enumerate().filter(|(_, n)| is(n)).map(|(i, _)| i as Id).collect()
    }

    /// For each node the last scheduled node that uses it; `None` where an output does.
    fn last_uses(&self, order: &[Id]) -> BTreeMap<Id, Option<Id>> {
        let mut last: BTreeMap<Id, Option<Id>> = BTreeMap::new();
        for &user in order {
            if let Node::Sin(s) | Node::Cos(s) | Node::Value(s) | Node::Reciprocal(s) =
                self.program.nodes[user as usize]
            {
                for id in self.program.sums[s].iter().flat_map(|t| &t.factors) {
                    last.insert(*id, Some(user));
                }
            }
        }
        for sum in self.program.outputs.iter().flatten() {
            for id in self.program.sums[*sum].iter().flat_map(|t| &t.factors) {
                last.insert(*id, None);
            }
        }
        last
    }

    fn sum(&self, sum: &Sum) -> TokenStream {
        // Positive terms first spares a negation.
        let first = sum.iter().position(|t| t.coefficient > 0.0).unwrap_or(0);
        let mut tokens = TokenStream::new();
        let order =
            sum.get(first).into_iter().chain(sum.iter().enumerate().filter(|(i, _)| *i != first).map(|(_, t)| t));
        for (k, term) in order.enumerate() {
            let product = self.product(term);
            let negative = term.coefficient < 0.0;
            tokens.extend(match (k, negative) {
                (0, false) => product,
                (0, true) => quote!(-#product),
                (_, false) => quote!(+ #product),
                (_, true) => quote!(- #product),
            });
        }
        if sum.is_empty() { quote!(0.0) } else { tokens }
    }

    fn product(&self, term: &Term) -> TokenStream {
        let names: Vec<Ident> = term.factors.iter().map(|id| self.node_name(*id)).collect();
        let size = float(term.coefficient.abs());
        if term.factors.is_empty() {
            size
        } else if term.coefficient.abs() == 1.0 {
            let (first, rest) = (&names[..1], &names[1..]);
            quote!(#(#first)* #(* #rest)*)
        } else {
            quote!(#size #(* #names)*)
        }
    }

    fn outputs(&self) -> TokenStream {
        // An output that occurs in several places (A is symmetric) is computed once.
        let mut count: BTreeMap<usize, usize> = BTreeMap::new();
        for s in self.program.outputs.iter().flatten() {
            *count.entry(*s).or_default() += 1;
        }
        let simple = |s: usize| self.program.sums[s].len() <= 1 && self.program.sums[s].iter().all(|t| t.cost() == 0);
        let shared: Vec<usize> = count.iter().filter(|(s, n)| **n > 1 && !simple(**s)).map(|(s, _)| *s).collect();
        let lets = shared.iter().map(|s| {
            let (name, value) = (ident(&format!("out{s}")), self.sum(&self.program.sums[*s]));
            quote!(let #name = #value;)
        });
        let value = |s: usize| {
            if shared.contains(&s) {
                let name = ident(&format!("out{s}"));
                quote!(#name)
            } else {
                self.sum(&self.program.sums[s])
            }
        };
        let expression = |output: &Output, sums: &[usize]| -> TokenStream {
            let values: Vec<TokenStream> = sums.iter().map(|s| value(*s)).collect();
            match output.shape {
                Shape::Scalar => quote!(#(#values)*),
                Shape::Vector(_) => quote!([#(#values),*]),
                Shape::Matrix(_, columns) => {
                    let rows = values.chunks(columns.max(1)).map(|row| quote!([#(#row),*]));
                    quote!([#(#rows),*])
                }
            }
        };
        let expressions: Vec<TokenStream> =
            self.kernel.outputs.iter().zip(&self.program.outputs).map(|(o, sums)| expression(o, sums)).collect();
        let result = match self.kernel.outputs.as_slice() {
            [_] => quote!(#(#expressions)*),
            outputs => {
                let name = ident(&self.struct_name());
                let fields = outputs.iter().zip(&expressions).map(|(o, e)| {
                    let field = ident(o.name);
                    quote!(#field: #e)
                });
                quote!(#name { #(#fields),* })
            }
        };
        quote!(#(#lets)* #result)
    }
}

/// An array type for a shape, of numbers or of lanes.
pub fn shape_type(shape: Shape, number: &TokenStream) -> TokenStream {
    match shape {
        Shape::Scalar => number.clone(),
        Shape::Vector(n) => {
            let n = Literal::usize_unsuffixed(n);
            quote!([#number; #n])
        }
        Shape::Matrix(r, c) => {
            let (r, c) = (Literal::usize_unsuffixed(r), Literal::usize_unsuffixed(c));
            quote!([[#number; #c]; #r])
        }
    }
}
