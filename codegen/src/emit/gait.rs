//! One generated module per gait.

use super::description::{description, each};
use super::function::{Function, functions};
use super::modules::key;
use super::tokens::{Written, doc, float, ident, path, print, whole};
use crate::dynamics::{Input, Kernel, LUMPS, PARAMETERS, Shape, kernels, lowest};
use crate::mechanism::{Lever, Mechanism, Mode};
use crate::spec::name::type_name;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};
use syn::Path;

/// Source of one gait's module, of a robot with or without a module of its own; `whole` is the module of the whole
/// robot. `beside` gives the gait's levers and its closed forms as LaTeX, `specification` are the texts of the robot's file
/// and the gait's, `runtime` is the path of the module with the `Gait` trait; without it there are functions only.
///
/// # Errors
/// If a name or a number of it cannot be one in Rust.
pub fn gait_source(
    mechanism: &Mechanism,
    beside: impl FnOnce() -> (Vec<Lever>, String) + Send,
    robot: &str,
    whole: &str,
    specification: [&str; 2],
    runtime: Option<&str>,
    origin: &str,
) -> Written<String> {
    let (mut model, kernels) = kernels(mechanism);
    let lowest = lowest(&mut model);
    let (functions, (levers, latex)) = rayon::join(|| functions(&model.ring, &kernels), beside);
    let functions = functions?;
    let mut source = header(origin)? + &items(&functions)?;
    if let Some(runtime) = runtime {
        let (key, runtime) = (key(robot, &mechanism.gait), path(runtime)?);
        let description = description(mechanism, &key, &lowest, &functions, &runtime)?;
        source += &print(implementation(
            mechanism,
            description,
            (&levers, &latex),
            specification,
            whole,
            &functions,
            &runtime,
        )?)?;
    }
    Ok(source)
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

/// The gait's type with its description, which is given, and its `impl Gait`.
fn implementation(
    m: &Mechanism,
    description: TokenStream,
    (levers, latex): (&[Lever], &str),
    [robot_file, gait_file]: [&str; 2],
    whole: &str,
    functions: &[Function],
    runtime: &Path,
) -> Written<TokenStream> {
    let (name, whole) = (ident(&type_name(&m.gait))?, ident(whole)?);
    let text = doc(&format!("The {} of `{}`.", m.gait, m.robot));
    let levers = each(levers, |l| lever(l, runtime))?;
    let methods = methods(functions, runtime)?;
    Ok(quote! {
        #text
        #[derive(Clone, Copy, Debug, Default)]
        pub struct #name;

        /// What the gait is made of, in numbers.
        pub static DESCRIPTION: #runtime::Description = #description;

        /// What it was derived from.
        pub static SPECIFICATION: #runtime::Specification = #runtime::Specification {
            robot: std::borrow::Cow::Borrowed(#robot_file),
            gait: std::borrow::Cow::Borrowed(#gait_file),
        };

        impl #runtime::Gait for #name {
            fn description(&self) -> &#runtime::Description {
                &DESCRIPTION
            }

            fn specification(&self) -> Option<&#runtime::Specification> {
                Some(&SPECIFICATION)
            }

            fn latex(&self) -> &'static str {
                #latex
            }

            fn levers(&self) -> &'static [#runtime::Lever] {
                &[#(#levers),*]
            }

            fn whole(&self) -> Option<&'static dyn #runtime::whole::Whole> {
                Some(&super::#whole::Whole)
            }

            #methods
        }
    })
}

/// Numbers of the specification that change together, as a value of the runtime's type.
fn lever(lever: &Lever, runtime: &Path) -> Written<TokenStream> {
    let Lever { name, numbers, unit, value, slopes } = lever;
    let value = float(*value)?;
    let slopes = each(slopes, |(number, slope)| {
        let (number, slope) = (whole(*number), float(*slope)?);
        Ok(quote!((#number, #slope)))
    })?;
    Ok(quote! {
        #runtime::Lever {
            name: #name,
            numbers: &[#(#numbers),*],
            unit: #unit,
            value: #value,
            slopes: &[#(#slopes),*],
        }
    })
}

/// Trait methods: per kernel one that takes slices and writes all outputs one after another.
pub(super) fn methods<'f>(
    functions: impl IntoIterator<Item = &'f Function<'f>>,
    runtime: &Path,
) -> Written<TokenStream> {
    let mut by_base: BTreeMap<&str, Vec<&Kernel>> = BTreeMap::new();
    let mut order = Vec::new();
    for function in functions {
        let base = function.kernel.base();
        let list = by_base.entry(base).or_default();
        if list.is_empty() {
            order.push(base);
        }
        list.push(function.kernel);
    }
    order.into_iter().map(|base| method(base, &by_base[base], runtime)).collect()
}

/// The method of a kernel or, where there are some for both legs or for several modes, of these twins.
fn method(base: &str, twins: &[&Kernel], runtime: &Path) -> Written<TokenStream> {
    let name = ident(base)?;
    let of = match (twins[0].mode, twins[0].is_of_leg()) {
        (Some(_), _) => quote!(mode: #runtime::Mode,),
        (None, true) => quote!(leg: usize,),
        (None, false) => TokenStream::new(),
    };
    // The first twin is one of stance, whose kernels take all that those of flight do.
    let inputs = twins[0].inputs.iter().filter(|i| !is_of_robot(i)).map(|i| {
        let (name, ty) = (ident(i.name)?, if i.scalar { quote!(f64) } else { quote!(&[f64]) });
        Ok(quote!(#name: #ty,))
    });
    let inputs = inputs.collect::<Written<TokenStream>>()?;
    let body = match twins {
        [one] if of.is_empty() => call(one)?,
        _ => {
            let arms = each(twins, |kernel| {
                let (when, call) = (arm(kernel, runtime), call(kernel)?);
                Ok(quote!(#when => { #call }))
            })?;
            let which = if twins[0].mode.is_some() { quote!(mode) } else { quote!(leg) };
            quote!(match #which { #(#arms)* _ => out.fill(f64::NAN) })
        }
    };
    Ok(quote! {
        #[inline]
        fn #name(&self, #of #inputs out: &mut [f64]) {
            #body
        }
    })
}

/// Of what leg or mode a kernel is, as a pattern.
fn arm(kernel: &Kernel, runtime: &Path) -> TokenStream {
    match kernel.mode {
        Some(Mode::Flight) => quote!(#runtime::Mode::Flight),
        Some(Mode::Stance(leg)) => {
            let leg = whole(leg);
            quote!(#runtime::Mode::Stance(#leg))
        }
        None => {
            let leg = whole(usize::from(!kernel.name.ends_with('1')));
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
    let slice = |value: TokenStream, shape: Shape| match shape {
        Shape::Scalar => quote!(core::slice::from_ref(&#value)),
        Shape::Vector(_) => quote!(#value.as_slice()),
        Shape::Matrix(..) => quote!(#value.as_flattened()),
    };
    let pieces = match kernel.outputs.as_slice() {
        [one] => vec![slice(quote!(r), one.shape)],
        several => each(several, |output| {
            let name = ident(output.name)?;
            Ok(slice(quote!(r.#name), output.shape))
        })?,
    };
    Ok(quote! {
        #(let Some(#arrays) = #arrays.first_chunk() else { return out.fill(f64::NAN) };)*
        let r = #function(#(#arguments),*);
        let mut rest = out;
        for piece in [#(#pieces),*] {
            let Some((head, tail)) = rest.split_at_mut_checked(piece.len()) else { return };
            head.copy_from_slice(piece);
            rest = tail;
        }
    })
}
