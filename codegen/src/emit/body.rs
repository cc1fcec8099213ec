//! The body of a kernel: a straight line of `let`s over named values, and what becomes of its outputs.

use super::function::Function;
use super::scopes::{Scopes, Statement};
use super::tokens::{Written, ident, size, whole};
use crate::dynamics::{Input, Shape};
use crate::expr::Kind;
use crate::program::{Id, Node, Sine, Step, Sum, Term, terms};
use proc_macro2::{Ident, Punct, Spacing, TokenStream, TokenTree};
use quote::{format_ident, quote};

/// Angles whose sines and cosines are evaluated at once, at most.
const AT_ONCE: usize = 4;

/// For whom a body is written; the bits are the same.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// One state. Sines and cosines are evaluated side by side in a vector register, and outputs are returned.
    Single,
    /// A lane in a loop, which takes many states side by side. Sines and cosines are evaluated in step, each on its own,
    /// and outputs are put into their lanes as soon as they are known: stores one after another would wait for memory.
    Lane,
}

/// A program as it is written: what its nodes are called, and which of them anything needs.
struct Body<'a> {
    function: &'a Function<'a>,
    used: Vec<bool>,
    names: Vec<Ident>,
    form: Form,
}

/// The body of a function for one state.
pub fn of_state(function: &Function) -> Written<TokenStream> {
    let body = Body::new(function, Form::Single)?;
    let (inputs, result) = (body.inputs()?, body.result()?);
    let lines = body.scopes(true).tokens(body.bindings()?);
    Ok(quote!(#inputs #lines #result))
}

/// The body of a loop over lanes, from inputs and to outputs that are arrays of lanes.
pub fn of_lane(function: &Function) -> Written<TokenStream> {
    let body = Body::new(function, Form::Lane)?;
    let inputs = body.inputs()?;
    let lines = body.scopes(false).tokens(body.with_stores(body.bindings()?)?);
    Ok(quote!(#inputs #lines))
}

fn name(function: &Function, id: usize, node: Node) -> Written<Ident> {
    Ok(match node {
        Node::Input(i, k) => input_name(function, i, k)?,
        Node::Sin(s) => format_ident!("sin{s}"),
        Node::Cos(s) => format_ident!("cos{s}"),
        Node::Value(_) | Node::Reciprocal(_) => format_ident!("v{id}"),
    })
}

fn input_name(function: &Function, input: usize, element: usize) -> Written<Ident> {
    match function.ring.kind(function.kernel.inputs[input].symbols[element]) {
        Kind::Symbol(name) => ident(&name),
        _ => Ok(format_ident!("in{input}_{element}")),
    }
}

fn sign(sign: char) -> TokenTree {
    Punct::new(sign, Spacing::Alone).into()
}

impl<'a> Body<'a> {
    fn new(function: &'a Function, form: Form) -> Written<Body<'a>> {
        let mut used = vec![false; function.program.nodes.len()];
        function.program.schedule().into_iter().for_each(|id| used[id as usize] = true);
        let names = function.program.nodes.iter().enumerate().map(|(id, node)| name(function, id, *node));
        Ok(Body { function, used, names: names.collect::<Written<_>>()?, form })
    }

    /// The scopes of its statements; whether the outputs are evaluated behind them.
    fn scopes(&self, outputs_follow: bool) -> Scopes<'_> {
        Scopes { program: &self.function.program, names: &self.names, outputs_follow }
    }

    /// Inputs by the names of their elements.
    fn inputs(&self) -> Written<TokenStream> {
        let program = &self.function.program;
        let mut used: Vec<Vec<bool>> =
            self.function.kernel.inputs.iter().map(|i| vec![false; i.symbols.len()]).collect();
        for (id, node) in program.nodes.iter().enumerate() {
            if let Node::Input(i, k) = node {
                used[*i][*k] |= self.used[id];
            }
        }
        let inputs = self.function.kernel.inputs.iter().enumerate();
        inputs.map(|(i, input)| self.input(i, input, &used[i])).collect()
    }

    /// Input `i`, of which these elements are used.
    fn input(&self, i: usize, input: &Input, used: &[bool]) -> Written<TokenStream> {
        let array = ident(input.name)?;
        if input.scalar {
            // What nothing depends on is read all the same, so that its parameter is not called unused.
            let name = if used[0] { input_name(self.function, i, 0)? } else { format_ident!("_") };
            return Ok(match self.form {
                Form::Lane => quote!(let #name = #array[lane];),
                Form::Single if name != array => quote!(let #name = #array;),
                Form::Single => TokenStream::new(),
            });
        }
        let name = |k: usize| Ok(if used[k] { input_name(self.function, i, k)? } else { format_ident!("_") });
        let names = (0..used.len()).map(name).collect::<Written<Vec<_>>>()?;
        Ok(match self.form {
            Form::Single => quote!(let [#(#names),*] = *#array;),
            Form::Lane => {
                let places = (0..used.len()).map(whole);
                quote!(let [#(#names),*] = [#(#array[#places][lane]),*];)
            }
        })
    }

    /// A `let` for every node, but for sines and cosines, which are bound some at once.
    fn bindings(&self) -> Written<Vec<Statement>> {
        let mut bindings = Vec::new();
        for step in self.function.program.steps() {
            let (id, sum, value) = match step {
                Step::Sines(sines) => {
                    for some in sines.chunks(AT_ONCE) {
                        bindings.push(self.sines_of(some)?);
                    }
                    continue;
                }
                Step::Value(id, sum) => (id, sum, self.value(sum)?),
                Step::Reciprocal(id, sum) => {
                    let value = self.value(sum)?;
                    (id, sum, quote!(1.0 / (#value)))
                }
            };
            let name = &self.names[id as usize];
            bindings.push(Statement { nodes: vec![id], sums: vec![sum], lines: quote!(let #name = #value;) });
        }
        Ok(bindings)
    }

    fn sines_of(&self, sines: &[Sine]) -> Written<Statement> {
        let arguments = sines.iter().map(|sine| self.value(sine.argument)).collect::<Written<Vec<_>>>()?;
        let name = |id: Option<Id>| id.map_or(quote!(_), |id| TokenTree::from(self.names[id as usize].clone()).into());
        let values = sines.iter().map(|sine| {
            let [sin, cos] = [sine.sin, sine.cos].map(name);
            quote!((#sin, #cos))
        });
        let lines = match (sines.len(), self.form) {
            (1, _) => quote!(let #(#values)* = math::sin_cos(#(#arguments)*);),
            (_, Form::Single) => quote!(let [#(#values),*] = math::sin_cos_together([#(#arguments),*]);),
            (_, Form::Lane) => quote!(let [#(#values),*] = math::sin_cos_in_step([#(#arguments),*]);),
        };
        let nodes = sines.iter().flat_map(|sine| [sine.sin, sine.cos]).flatten().collect();
        Ok(Statement { nodes, sums: sines.iter().map(|sine| sine.argument).collect(), lines })
    }

    /// The bindings, and after each the outputs that it makes known. Sums that are several outputs follow in the end: they
    /// are not at hand yet, and evaluated early they take registers away.
    fn with_stores(&self, bindings: Vec<Statement>) -> Written<Vec<Statement>> {
        let (kernel, program) = (self.function.kernel, &self.function.program);
        // After how many bindings each node is known.
        let mut known = vec![0; program.nodes.len()];
        for (number, binding) in bindings.iter().enumerate() {
            binding.nodes.iter().for_each(|id| known[*id as usize] = number + 1);
        }
        let mut places: Vec<Vec<TokenStream>> = vec![Vec::new(); program.sums.len()];
        for (output, sums) in kernel.outputs.iter().zip(&program.outputs) {
            let name = ident(output.name)?;
            for (place, s) in output.shape.places().zip(sums) {
                let place = place.into_iter().map(whole);
                places[*s].push(quote!(out.#name #([#place])* [lane]));
            }
        }
        let shared = self.shared();
        let mut stores: Vec<Vec<Statement>> = (0..=bindings.len()).map(|_| Vec::new()).collect();
        for s in program.outputs.iter().flatten() {
            let places = std::mem::take(&mut places[*s]);
            if places.is_empty() {
                continue;
            }
            let value = self.output(*s, &shared)?;
            let bound = if shared[*s] { self.bound(*s)? } else { TokenStream::new() };
            let ready = program.sums[*s].iter().flat_map(|t| &t.factors).map(|id| known[*id as usize]).max();
            let after = if shared[*s] { bindings.len() } else { ready.unwrap_or(0) };
            let lines = quote!(#bound #(#places = #value;)*);
            stores[after].push(Statement { nodes: Vec::new(), sums: vec![*s], lines });
        }
        let mut stores = stores.into_iter();
        let mut all: Vec<Statement> = stores.next().unwrap_or_default();
        for (binding, stores) in bindings.into_iter().zip(stores) {
            all.push(binding);
            all.extend(stores);
        }
        Ok(all)
    }

    /// The value of a sum.
    fn value(&self, sum: usize) -> Written<TokenStream> {
        let sum: &Sum = &self.function.program.sums[sum];
        if sum.is_empty() {
            return Ok(quote!(0.0));
        }
        let mut tokens = Vec::with_capacity(sum.iter().map(|t| 2 * t.factors.len() + 2).sum());
        for term in terms(sum) {
            if term.coefficient < 0.0 {
                tokens.push(sign('-'));
            } else if !tokens.is_empty() {
                tokens.push(sign('+'));
            }
            self.product(term, &mut tokens)?;
        }
        Ok(TokenStream::from_iter(tokens))
    }

    /// A term without its sign.
    fn product(&self, term: &Term, tokens: &mut Vec<TokenTree>) -> Written<()> {
        let number = term.number();
        let mut begun = number.is_some();
        if let Some(number) = number {
            tokens.push(size(number)?.into());
        }
        for id in &term.factors {
            if begun {
                tokens.push(sign('*'));
            }
            tokens.push(self.names[*id as usize].clone().into());
            begun = true;
        }
        Ok(())
    }

    /// Sums that are outputs in several places (A is symmetric): they are computed once.
    fn shared(&self) -> Vec<bool> {
        let program = &self.function.program;
        let mut count = vec![0; program.sums.len()];
        program.outputs.iter().flatten().for_each(|s| count[*s] += 1);
        let simple = |s: usize| program.sums[s].len() <= 1 && program.sums[s].iter().all(|t| t.cost() == 0);
        (0..count.len()).map(|s| count[s] > 1 && !simple(s)).collect()
    }

    /// A sum that is several outputs, with a name.
    fn bound(&self, sum: usize) -> Written<TokenStream> {
        let (name, value) = (format_ident!("out{sum}"), self.value(sum)?);
        Ok(quote!(let #name = #value;))
    }

    /// The value of a sum that is an output.
    fn output(&self, sum: usize, shared: &[bool]) -> Written<TokenStream> {
        if shared[sum] { Ok(TokenTree::from(format_ident!("out{sum}")).into()) } else { self.value(sum) }
    }

    /// What a function for one state returns.
    fn result(&self) -> Written<TokenStream> {
        let (kernel, program) = (self.function.kernel, &self.function.program);
        let shared = self.shared();
        let bound =
            (0..shared.len()).filter(|s| shared[*s]).map(|s| self.bound(s)).collect::<Written<TokenStream>>()?;
        let list = |sums: &[usize]| {
            let values = sums.iter().map(|s| self.output(*s, &shared)).collect::<Written<Vec<_>>>()?;
            Ok(quote!([#(#values),*]))
        };
        let expression = |shape: Shape, sums: &[usize]| match shape {
            Shape::Scalar => self.output(sums[0], &shared),
            Shape::Vector(_) => list(sums),
            Shape::Matrix(_, columns) => {
                let rows = sums.chunks(columns.max(1)).map(list).collect::<Written<Vec<_>>>()?;
                Ok(quote!([#(#rows),*]))
            }
        };
        if let [one] = kernel.outputs.as_slice() {
            let value = expression(one.shape, &program.outputs[0])?;
            return Ok(quote!(#bound #value));
        }
        let fields = kernel.outputs.iter().zip(&program.outputs).map(|(output, sums)| {
            let (name, value) = (ident(output.name)?, expression(output.shape, sums)?);
            Ok(quote!(#name: #value))
        });
        let (fields, name) = (fields.collect::<Written<Vec<_>>>()?, self.function.struct_name()?);
        Ok(quote!(#bound #name { #(#fields),* }))
    }
}
