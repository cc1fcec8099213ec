//! Names, numbers and texts as tokens of Rust, and tokens as text. What cannot be a token is an error here, before any of
//! it is code.

use crate::dynamics::Shape;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;
use std::fmt;

/// What was to become code and cannot: a name that is no identifier, a number that is not finite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unwritable(String);

/// What becomes code, if it can.
pub type Written<T> = Result<T, Unwritable>;

impl fmt::Display for Unwritable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unwritable {}

impl Unwritable {
    /// The same, with where it was to stand.
    pub fn of(self, place: &str) -> Unwritable {
        Unwritable(format!("{place}: {self}"))
    }
}

/// A name of something in the code.
pub fn ident(name: &str) -> Written<Ident> {
    let no_name = |_| Unwritable(format!("`{}` cannot be a name in Rust", name.escape_debug()));
    syn::parse_str::<syn::Ident>(name).map(|_| Ident::new(name, Span::call_site())).map_err(no_name)
}

/// A path to something outside the code, such as `::piaffe::model`.
pub fn path(path: &str) -> Written<syn::Path> {
    let no_path = |_| Unwritable(format!("`{}` cannot be a path in Rust", path.escape_debug()));
    syn::parse_str(path).map_err(no_path)
}

/// A number without its sign, in the fewest digits that are it.
pub fn size(value: f64) -> Written<Literal> {
    let no_number = || Unwritable(format!("{value} cannot be a number in Rust"));
    if !value.is_finite() {
        return Err(no_number());
    }
    format!("{:?}", value.abs()).parse().map_err(|_| no_number())
}

/// A number, zero without a sign.
pub fn float(value: f64) -> Written<TokenStream> {
    let size = size(value)?;
    Ok(if value < 0.0 { quote!(-#size) } else { quote!(#size) })
}

pub fn floats<const N: usize>(values: [f64; N]) -> Written<TokenStream> {
    let values = values.into_iter().map(float).collect::<Written<Vec<_>>>()?;
    Ok(quote!([#(#values),*]))
}

/// A whole number, of whatever type is wanted.
pub fn whole(value: usize) -> Literal {
    Literal::usize_unsuffixed(value)
}

pub fn option(value: Option<usize>) -> TokenStream {
    value.map(whole).map_or(quote!(None), |value| quote!(Some(#value)))
}

/// What a person shall read of an item.
pub fn doc(text: &str) -> TokenStream {
    let lines = text.lines().map(|line| if line.is_empty() { String::new() } else { format!(" {line}") });
    quote!(#(#[doc = #lines])*)
}

/// An array type for a shape, of numbers or of lanes.
pub fn shape_type(shape: Shape, number: &TokenStream) -> TokenStream {
    match shape {
        Shape::Scalar => number.clone(),
        Shape::Vector(n) => {
            let n = whole(n);
            quote!([#number; #n])
        }
        Shape::Matrix(rows, columns) => {
            let (rows, columns) = (whole(rows), whole(columns));
            quote!([[#number; #columns]; #rows])
        }
    }
}

/// Items as text.
pub fn print(items: TokenStream) -> Written<String> {
    let no_items = |e| Unwritable(format!("what was generated is no Rust: {e}"));
    Ok(prettyplease::unparse(&syn::parse2(items).map_err(no_items)?))
}
