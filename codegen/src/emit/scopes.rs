//! Statements in scopes: long bodies are cut into nested blocks, because rustc's debug information does not survive
//! thousands of bindings in one.

use crate::program::{Id, Program};
use proc_macro2::{Ident, TokenStream};
use quote::quote;

/// Statements per scope.
const BLOCK: usize = 200;

/// Lines that belong together, the nodes that they give a value, and the sums that they evaluate.
pub struct Statement {
    pub nodes: Vec<Id>,
    pub sums: Vec<usize>,
    pub lines: TokenStream,
}

/// What the statements are about.
pub struct Scopes<'a> {
    pub program: &'a Program,
    pub names: &'a [Ident],
    /// Whether the outputs are evaluated behind all statements.
    pub outputs_follow: bool,
}

impl Scopes<'_> {
    /// The statements, in scopes of limited size that hand on what is needed later.
    pub fn tokens(&self, statements: Vec<Statement>) -> TokenStream {
        if statements.len() <= BLOCK {
            return statements.into_iter().map(|s| s.lines).collect();
        }
        let last_use = self.last_uses(&statements);
        let scope = |(number, block): (usize, &[Statement])| {
            let end = (number + 1) * BLOCK;
            let kept = block.iter().flat_map(|s| &s.nodes).filter(|id| last_use[**id as usize] >= end);
            let kept: Vec<&Ident> = kept.map(|id| &self.names[*id as usize]).collect();
            let lines = block.iter().map(|s| &s.lines);
            // What has only outputs to store hands nothing on.
            if kept.is_empty() {
                quote!({ #(#lines)* })
            } else {
                quote!(let [#(#kept),*] = { #(#lines)* [#(#kept),*] };)
            }
        };
        statements.chunks(BLOCK).enumerate().map(scope).collect()
    }

    /// For each node the last statement that uses it; the largest number where an output does that follows.
    fn last_uses(&self, statements: &[Statement]) -> Vec<usize> {
        let mut last = vec![0; self.program.nodes.len()];
        let factors = |s: usize| self.program.sums[s].iter().flat_map(|t| &t.factors).map(|id| *id as usize);
        for (number, statement) in statements.iter().enumerate() {
            statement.sums.iter().for_each(|s| factors(*s).for_each(|id| last[id] = number));
        }
        if self.outputs_follow {
            self.program.outputs.iter().flatten().for_each(|s| factors(*s).for_each(|id| last[id] = usize::MAX));
        }
        last
    }
}
