//! Statements in scopes: long bodies are cut into nested blocks, because rustc's debug information does not survive
//! thousands of bindings in one.

use super::layout::{Layout, indent, line};
use crate::program::{Id, Program};

/// Statements per scope.
const BLOCK: usize = 200;

/// Lines that belong together, the nodes that they give a value, and the sums that they evaluate.
pub struct Statement {
    pub nodes: Vec<Id>,
    pub sums: Vec<usize>,
    pub lines: Vec<String>,
}

/// What the statements are about.
pub struct Scopes<'a> {
    pub program: &'a Program,
    pub names: &'a [String],
    /// Whether the outputs are evaluated behind all statements.
    pub outputs_follow: bool,
    /// Indents of their lines.
    pub depth: usize,
}

impl Scopes<'_> {
    /// Writes them, in scopes of limited size that hand on what is needed later.
    pub fn write(&self, statements: &[Statement], out: &mut String) {
        let depth = self.depth;
        if statements.len() <= BLOCK {
            return statements.iter().flat_map(|s| &s.lines).for_each(|text| line(out, text, depth));
        }
        let last_use = self.last_uses(statements);
        for (number, block) in statements.chunks(BLOCK).enumerate() {
            let end = (number + 1) * BLOCK;
            let kept = block.iter().flat_map(|s| &s.nodes).filter(|id| last_use[**id as usize] >= end);
            let kept: Vec<&str> = kept.map(|id| self.names[*id as usize].as_str()).collect();
            let list =
                |open: &str, close: &str| Layout::list(open, kept.iter().map(|k| Layout::Sum((*k).into())), close);
            indent(out, depth);
            // What has only outputs to store hands nothing on.
            if kept.is_empty() {
                out.push('{');
            } else {
                list("let [", "] = {").write(out, depth);
            }
            block.iter().flat_map(|s| &s.lines).for_each(|text| line(out, text, depth + 1));
            if kept.is_empty() {
                line(out, "}", depth);
                continue;
            }
            indent(out, depth + 1);
            list("[", "]").write(out, depth + 1);
            line(out, "};", depth);
        }
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
