//! One generated module per gait.

use super::description::{description, float};
use super::function::{Function, base_name, ident};
use super::modules::key;
use super::type_name;
use crate::dynamics::{Input, Kernel, LUMPS, PARAMETERS, Shape, kernels};
use crate::mechanism::{Lever, Mechanism};
use proc_macro2::{Literal, TokenStream};
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};

/// Source of one gait's module, of a robot with or without a module of its own; `whole` is the module of the whole
/// robot. `latex` are the gait's closed forms, `runtime` is the path of the module with the `Gait` trait; without it there are functions only.
///
/// # Errors
/// If what was generated is not Rust: a defect of the generator.
pub fn gait_source(
    mechanism: &Mechanism,
    levers: &[Lever],
    robot: &str,
    whole: &str,
    latex: &str,
    runtime: Option<&str>,
    origin: &str,
) -> Result<String, String> {
    let (model, kernels) = kernels(mechanism);
    let functions: Vec<Function> = kernels.iter().map(|k| Function::new(&model.ring, k)).collect();
    let items = items(&functions);
    let gait = match runtime {
        Some(runtime) => {
            implementation(mechanism, levers, &key(robot, &mechanism.gait), whole, &functions, latex, runtime)?
        }
        None => TokenStream::new(),
    };
    written(&items, gait, origin)
}

/// The functions of a module, with the structs that they return.
pub(super) fn items(functions: &[Function]) -> String {
    let mut structs = BTreeSet::new();
    let mut items = String::new();
    for function in functions {
        if let Some((name, source)) = function.output_struct()
            && structs.insert(name)
        {
            items += &source;
        }
        items += &function.source;
    }
    items
}

pub(super) fn path(runtime: &str) -> Result<TokenStream, String> {
    runtime.parse().map_err(|e| format!("`{runtime}` is not a path: {e}"))
}

/// A module: its functions and what else it has.
pub(super) fn written(items: &str, rest: TokenStream, origin: &str) -> Result<String, String> {
    let rest = syn::parse2::<syn::File>(rest).map_err(|e| format!("generated code does not parse: {e}"))?;
    Ok(format!("// {origin}\nuse super::math;\n{items}{}", prettyplease::unparse(&rest)))
}

/// The gait's type with its description and its `impl Gait`.
fn implementation(
    m: &Mechanism,
    levers: &[Lever],
    key: &str,
    whole: &str,
    functions: &[Function],
    latex: &str,
    runtime: &str,
) -> Result<TokenStream, String> {
    let runtime = path(runtime)?;
    let levers = levers.iter().map(|l| lever(l, &runtime));
    let name = ident(&type_name(&m.gait));
    let doc = format!(" The {} of `{}`.", m.gait, m.robot);
    let description = description(m, key, functions, &runtime);
    let whole = ident(whole);
    let methods = methods(functions);
    Ok(quote! {
        #[doc = #doc]
        #[derive(Clone, Copy, Debug, Default)]
        pub struct #name;
        #[doc = " What the gait is made of, in numbers."]
        pub static DESCRIPTION: #runtime::Description = #description;
        impl #runtime::Gait for #name {
            fn description(&self) -> &#runtime::Description { &DESCRIPTION }
            fn latex(&self) -> &'static str { #latex }
            fn levers(&self) -> &'static [#runtime::Lever] { &[#(#levers),*] }
            fn whole(&self) -> Option<&'static dyn #runtime::whole::Whole> { Some(&super::#whole::Whole) }
            #methods
        }
    })
}

/// A number of the specification as a value of the runtime's type.
fn lever(lever: &Lever, runtime: &TokenStream) -> TokenStream {
    let Lever { name, unit, value, slopes } = lever;
    let value = float(*value);
    let slopes = slopes.iter().map(|(number, slope)| {
        let (number, slope) = (Literal::usize_unsuffixed(*number), float(*slope));
        quote!((#number, #slope))
    });
    quote!(#runtime::Lever { name: #name, unit: #unit, value: #value, slopes: &[#(#slopes),*] })
}

/// Trait methods: per kernel one that takes slices and writes all outputs one after another.
pub(super) fn methods(functions: &[Function]) -> TokenStream {
    let mut by_base: BTreeMap<&str, Vec<&Kernel>> = BTreeMap::new();
    let mut order = Vec::new();
    for function in functions {
        let (base, _) = base_name(&function.kernel.name);
        let list = by_base.entry(base).or_default();
        if list.is_empty() {
            order.push(base);
        }
        list.push(function.kernel);
    }
    let mut methods = TokenStream::new();
    for base in order {
        let (name, twins) = (ident(base), &by_base[base]);
        let per_leg = base_name(&twins[0].name).1;
        let leg = per_leg.then(|| quote!(leg: usize,));
        let parameters = twins[0].inputs.iter().filter(|i| !is_of_robot(i)).map(|i| {
            let name = ident(i.name);
            if i.scalar { quote!(#name: f64) } else { quote!(#name: &[f64]) }
        });
        let calls: Vec<TokenStream> = twins.iter().map(|k| call(k)).collect();
        let body = match calls.as_slice() {
            [one] => one.clone(),
            [first, second, ..] => quote!(if leg == 0 { #first } else { #second }),
            [] => TokenStream::new(),
        };
        methods.extend(quote! {
            #[inline]
            fn #name(&self, #leg #(#parameters,)* out: &mut [f64]) { #body }
        });
    }
    methods
}

/// Whether an input is a property of the robot rather than of its state.
fn is_of_robot(input: &Input) -> bool {
    input.name == LUMPS || input.name == PARAMETERS
}

/// A call with checked lengths; outputs that do not fit the inputs become NaN rather than a panic.
fn call(kernel: &Kernel) -> TokenStream {
    let function = ident(&kernel.name);
    let arrays: Vec<_> = kernel.inputs.iter().filter(|i| !i.scalar && !is_of_robot(i)).map(|i| ident(i.name)).collect();
    let arguments = kernel.inputs.iter().map(|i| {
        let name = ident(i.name);
        if is_of_robot(i) { quote!(&self.#name) } else { quote!(#name) }
    });
    let checks = (!arrays.is_empty()).then(|| {
        quote! {
            let (#(Some(#arrays),)*) = (#(#arrays.first_chunk(),)*) else {
                out.fill(f64::NAN);
                return;
            };
        }
    });
    let write = |value: TokenStream, shape: Shape| match shape {
        Shape::Scalar => quote!(core::slice::from_ref(&#value)),
        Shape::Vector(_) => quote!(#value.as_slice()),
        Shape::Matrix(..) => quote!(#value.as_flattened()),
    };
    let pieces: Vec<TokenStream> = match kernel.outputs.as_slice() {
        [one] => vec![write(quote!(r), one.shape)],
        several => several
            .iter()
            .map(|o| {
                let field = ident(o.name);
                write(quote!(r.#field), o.shape)
            })
            .collect(),
    };
    quote! {
        #checks
        let r = #function(#(#arguments),*);
        let mut rest = out;
        for piece in [#(#pieces),*] {
            let Some((head, tail)) = rest.split_at_mut_checked(piece.len()) else { return };
            head.copy_from_slice(piece);
            rest = tail;
        }
    }
}
