//! Straight lines as text, from their tokens. syn and prettyplease would take longer over the bodies of all kernels than
//! deriving and factoring them does, and bodies have little grammar: `let`, sums, lists, blocks. The tests hold what is
//! written here to syn.

use super::tokens::{Written, print};
use proc_macro2::{Delimiter, Group, Punct, Spacing, TokenStream, TokenTree};
use quote::quote;
use std::fmt::Write;

/// Where a line has to end if it can.
const WIDTH: usize = 100;
const INDENT: &str = "    ";

/// A function as text: what stands before its body by prettyplease, the body line by line.
pub fn print_function(signature: &TokenStream, body: TokenStream) -> Written<String> {
    let mut text = print(quote!(#signature {}))?;
    let head = text.trim_end().trim_end_matches("{}").len();
    text.truncate(head);
    let mut lines = Lines { text, begin: head, depth: 0 };
    lines.block('{', body, '}');
    lines.text.push('\n');
    Ok(lines.text)
}

/// What stands before a token in its line.
#[derive(Clone, Copy, PartialEq)]
enum Before {
    /// Nothing, or what clings to the next: an opening bracket, a sign of one number, the dot of a field.
    Nothing,
    /// A word or a number that is no value by itself, such as `let`; a comma; an operator between two values.
    Word,
    /// A value: a name, a number, a call, a list.
    Value,
}

struct Lines {
    text: String,
    /// Where the last line begins.
    begin: usize,
    depth: usize,
}

impl Lines {
    fn column(&self) -> usize {
        self.text.len() - self.begin
    }

    fn new_line(&mut self) {
        self.text.push('\n');
        self.begin = self.text.len();
        (0..self.depth).for_each(|_| self.text.push_str(INDENT));
    }

    /// Statements or items between brackets, each on a line of its own.
    fn block(&mut self, open: char, tokens: TokenStream, close: char) {
        self.text.push(open);
        self.depth += 1;
        let (mut before, mut ended) = (Before::Nothing, true);
        for token in tokens {
            let ends = is(&token, ";,");
            // What follows a block is a statement of its own, unless it ends the one that the block is in.
            if ended && !ends {
                self.new_line();
                before = Before::Nothing;
            }
            ended = ends || matches!(&token, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace);
            before = self.token(token, before, true);
        }
        self.depth -= 1;
        self.new_line();
        self.text.push(close);
    }

    /// Tokens one after another; whether they fit into the line. Where they must, they are not written to their end.
    fn inline(&mut self, tokens: TokenStream, breakable: bool) -> bool {
        let mut before = Before::Nothing;
        for token in tokens {
            before = self.token(token, before, breakable);
            if !breakable && self.column() > WIDTH {
                return false;
            }
        }
        true
    }

    /// One token behind what stands before it, which it then is for the next.
    fn token(&mut self, token: TokenTree, before: Before, breakable: bool) -> Before {
        let is_operator = before == Before::Value && is(&token, "+-*/");
        if is_operator && breakable && self.column() > WIDTH {
            self.depth += 1;
            self.new_line();
            self.depth -= 1;
        } else if is_apart(&token, before) {
            self.text.push(' ');
        }
        match token {
            TokenTree::Group(group) => self.group(&group, breakable),
            TokenTree::Punct(punct) => {
                self.text.push(punct.as_char());
                return behind(&punct, before);
            }
            TokenTree::Ident(name) => {
                let start = self.text.len();
                self.write(name);
                let is_value = !["let", "for", "in"].contains(&&self.text[start..]);
                return if is_value { Before::Value } else { Before::Word };
            }
            TokenTree::Literal(number) => self.write(number),
        }
        Before::Value
    }

    fn write(&mut self, token: impl std::fmt::Display) {
        write!(self.text, "{token}").expect("a text takes everything");
    }

    /// Lists that fit into the line stay there.
    fn group(&mut self, group: &Group, breakable: bool) {
        let (open, close) = match group.delimiter() {
            Delimiter::Brace => return self.block('{', group.stream(), '}'),
            Delimiter::Bracket => ('[', ']'),
            Delimiter::Parenthesis | Delimiter::None => ('(', ')'),
        };
        let start = self.text.len();
        self.text.push(open);
        let is_list = group.delimiter() == Delimiter::Bracket;
        if self.inline(group.stream(), breakable && !is_list) || !breakable {
            self.text.push(close);
        } else {
            self.text.truncate(start);
            self.block(open, group.stream(), close);
        }
    }
}

fn is(token: &TokenTree, marks: &str) -> bool {
    matches!(token, TokenTree::Punct(punct) if marks.contains(punct.as_char()))
}

/// Whether there is a space between a token and what stands before it.
fn is_apart(token: &TokenTree, before: Before) -> bool {
    match (token, before) {
        (_, Before::Nothing) => false,
        (TokenTree::Punct(punct), _) => !",;.:".contains(punct.as_char()),
        // A call, an index.
        (TokenTree::Group(group), Before::Value) => group.delimiter() == Delimiter::Brace,
        _ => true,
    }
}

/// What a mark is for the token behind it.
fn behind(mark: &Punct, before: Before) -> Before {
    let is_path = mark.as_char() == ':' && (mark.spacing() == Spacing::Joint || before == Before::Nothing);
    let is_of_one = "-*".contains(mark.as_char()) && before != Before::Value;
    if is_path || is_of_one || mark.as_char() == '.' { Before::Nothing } else { Before::Word }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tokens as they are, whatever stands between them.
    fn flat(tokens: TokenStream) -> String {
        tokens.to_string().split_whitespace().collect()
    }

    #[test]
    fn what_is_written_is_what_was_given() {
        let long: Vec<_> = (0..40).map(|k| quote::format_ident!("name{k}")).collect();
        let bodies = [
            quote!(let [q1, _] = *q; let v = -q1 * -2.0 - q1 / (q1 - 1.0); { out.a[0][1][lane] = -v; } Result { a: [-v, v], b: v }),
            quote!(let [sin0, cos0] = { let (sin0, cos0) = math::sin_cos(-q[0][lane] + 1e-9); [sin0, cos0] }; [[-sin0]]),
            quote!(for lane in 0..N { let v = #(#long * -2.5)+*; out.v[lane] = v; }),
            quote!([[#(#long),*], [#(#long + #long),*], [1.0, -2.0]]),
            quote!(let v = f([#(#long),*]); v),
        ];
        for body in bodies {
            let text = print_function(&quote!(fn f(q: &[f64; 2]) -> f64), body.clone()).unwrap();
            let written: TokenStream = text.parse().unwrap();
            assert_eq!(flat(written), flat(quote!(fn f(q: &[f64; 2]) -> f64 { #body })), "{text}");
            assert!(syn::parse_str::<syn::ItemFn>(&text).is_ok(), "{text}");
            assert!(text.lines().all(|line| line.len() < WIDTH + 20 && line == line.trim_end()), "{text}");
        }
    }
}
