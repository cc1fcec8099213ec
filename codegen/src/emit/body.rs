//! The body of a kernel: a straight line of `let`s over named values, and what it returns.
//!
//! Long ones are cut into nested blocks, because rustc's debug information does not survive thousands
//! of bindings in one scope.

use super::function::Function;
use super::layout::{Layout, indent, line};
use crate::dynamics::Shape;
use crate::expr::Kind;
use crate::program::{Id, Node, Sum, Term};
use std::fmt::Write;

/// Bindings per scope.
const BLOCK: usize = 200;

/// Angles whose sines and cosines are evaluated at once, at most.
const AT_ONCE: usize = 4;

/// How sines and cosines are evaluated; the bits are the same.
#[derive(Clone, Copy)]
pub enum Sines {
    /// Side by side in a vector register: fast for one state.
    Together,
    /// In step, but each on its own: a loop around the kernel takes many states side by side.
    InStep,
}

/// A program as it is written: what its nodes are called, and which of them anything needs.
struct Body<'a> {
    function: &'a Function<'a>,
    order: Vec<Id>,
    used: Vec<bool>,
    names: Vec<String>,
    sines: Sines,
}

/// A `let` and the nodes that it gives a value.
struct Binding {
    nodes: Vec<Id>,
    text: String,
}

/// Writes the body of a function.
pub fn write(function: &Function, sines: Sines, out: &mut String) {
    let order = function.program.schedule_sines_first();
    let mut used = vec![false; function.program.nodes.len()];
    order.iter().for_each(|id| used[*id as usize] = true);
    let names = function.program.nodes.iter().enumerate().map(|(id, node)| name(function, id, *node)).collect();
    let body = Body { function, order, used, names, sines };
    body.inputs(out);
    body.lets(out);
    body.outputs(out);
}

fn name(function: &Function, id: usize, node: Node) -> String {
    match node {
        Node::Input(i, k) => input_name(function, i, k),
        Node::Sin(s) => format!("sin{s}"),
        Node::Cos(s) => format!("cos{s}"),
        Node::Value(_) | Node::Reciprocal(_) => format!("v{id}"),
    }
}

fn input_name(function: &Function, input: usize, element: usize) -> String {
    match function.ring.kind(function.kernel.inputs[input].symbols[element]) {
        Kind::Symbol(name) => name,
        _ => format!("in{input}_{element}"),
    }
}

impl Body<'_> {
    /// Inputs by the names of their elements.
    fn inputs(&self, out: &mut String) {
        let program = &self.function.program;
        let mut used: Vec<Vec<bool>> =
            self.function.kernel.inputs.iter().map(|i| vec![false; i.symbols.len()]).collect();
        for (id, node) in program.nodes.iter().enumerate() {
            if let Node::Input(i, k) = node {
                used[*i][*k] |= self.used[id];
            }
        }
        for (i, input) in self.function.kernel.inputs.iter().enumerate() {
            if input.scalar {
                let name = input_name(self.function, i, 0);
                if name != input.name {
                    line(out, &format!("let {name} = {};", input.name), 1);
                }
                continue;
            }
            indent(out, 1);
            let name = |k: usize| if used[i][k] { input_name(self.function, i, k) } else { "_".into() };
            let names = (0..input.symbols.len()).map(|k| Layout::Sum(name(k)));
            Layout::list("let [", names, format!("] = *{};", input.name)).write(out, 1);
        }
    }

    /// The bindings, in scopes of limited size that hand on what is needed later.
    fn lets(&self, out: &mut String) {
        let bindings = self.bindings();
        if bindings.len() <= BLOCK {
            return bindings.iter().for_each(|b| line(out, &b.text, 1));
        }
        let last_use = self.last_uses(&bindings);
        for (number, block) in bindings.chunks(BLOCK).enumerate() {
            let end = (number + 1) * BLOCK;
            let kept = block.iter().flat_map(|b| &b.nodes).filter(|id| last_use[**id as usize] >= end);
            let kept: Vec<&str> = kept.map(|id| self.names[*id as usize].as_str()).collect();
            let list =
                |open: &str, close: &str| Layout::list(open, kept.iter().map(|k| Layout::Sum((*k).into())), close);
            indent(out, 1);
            list("let [", "] = {").write(out, 1);
            block.iter().for_each(|b| line(out, &b.text, 2));
            indent(out, 2);
            list("[", "]").write(out, 2);
            line(out, "};", 1);
        }
    }

    /// Arguments of sines and cosines, with the nodes that are their sine and cosine.
    fn sines(&self) -> Vec<(usize, [Option<Id>; 2])> {
        let mut sines: Vec<(usize, [Option<Id>; 2])> = Vec::new();
        for id in &self.order {
            let (argument, which) = match self.function.program.nodes[*id as usize] {
                Node::Sin(s) => (s, 0),
                Node::Cos(s) => (s, 1),
                _ => continue,
            };
            let known = sines.iter().position(|(s, _)| *s == argument);
            let k = known.unwrap_or_else(|| {
                sines.push((argument, [None; 2]));
                sines.len() - 1
            });
            sines[k].1[which] = Some(*id);
        }
        sines
    }

    fn bindings(&self) -> Vec<Binding> {
        let program = &self.function.program;
        let mut sines = self.sines();
        let mut bindings = Vec::with_capacity(self.order.len());
        for id in &self.order {
            let name = &self.names[*id as usize];
            let text = match program.nodes[*id as usize] {
                Node::Input(..) => continue,
                Node::Sin(_) | Node::Cos(_) => {
                    // They follow one another: with the first, all are bound.
                    let sines = std::mem::take(&mut sines);
                    bindings.extend(sines.chunks(AT_ONCE).map(|pairs| self.sines_of(pairs)));
                    continue;
                }
                Node::Value(s) => self.sum(&["let ", name, " = "], &program.sums[s], ";"),
                Node::Reciprocal(s) => self.sum(&["let ", name, " = 1.0 / ("], &program.sums[s], ");"),
            };
            bindings.push(Binding { nodes: vec![*id], text });
        }
        bindings
    }

    /// Sines and cosines of the arguments that are these sums.
    fn sines_of(&self, pairs: &[(usize, [Option<Id>; 2])]) -> Binding {
        let arguments: Vec<_> = pairs.iter().map(|(s, _)| self.value(*s)).collect();
        let name = |id: Option<Id>| id.map_or("_", |id| &self.names[id as usize]);
        let values: Vec<_> = pairs.iter().map(|(_, [sin, cos])| format!("({}, {})", name(*sin), name(*cos))).collect();
        let (arguments, values) = (arguments.join(", "), values.join(", "));
        let text = match (pairs.len(), self.sines) {
            (1, _) => format!("let {values} = math::sin_cos({arguments});"),
            (_, Sines::Together) => format!("let [{values}] = math::sin_cos_together([{arguments}]);"),
            (_, Sines::InStep) => format!("let [{values}] = math::sin_cos_in_step([{arguments}]);"),
        };
        Binding { nodes: pairs.iter().flat_map(|(_, pair)| pair).flatten().copied().collect(), text }
    }

    /// For each node the last binding that uses it; the largest number where an output does.
    fn last_uses(&self, bindings: &[Binding]) -> Vec<usize> {
        let program = &self.function.program;
        let mut last = vec![0; program.nodes.len()];
        let factors = |s: usize| program.sums[s].iter().flat_map(|t| &t.factors).map(|id| *id as usize);
        for (number, binding) in bindings.iter().enumerate() {
            for s in binding.nodes.iter().filter_map(|id| program.nodes[*id as usize].sum()) {
                factors(s).for_each(|id| last[id] = number);
            }
        }
        program.outputs.iter().flatten().for_each(|s| factors(*s).for_each(|id| last[id] = usize::MAX));
        last
    }

    /// The value of a sum.
    fn value(&self, sum: usize) -> String {
        self.sum(&[], &self.function.program.sums[sum], "")
    }

    /// A sum between what is before and behind it.
    fn sum(&self, before: &[&str], sum: &Sum, behind: &str) -> String {
        /// About the length of a term.
        const TERM: usize = 24;
        let mut text = String::with_capacity((sum.len() + 1) * TERM);
        before.iter().for_each(|part| text.push_str(part));
        if sum.is_empty() {
            text.push_str("0.0");
        }
        // Positive terms first spares a negation.
        let first = sum.iter().position(|t| t.coefficient > 0.0).unwrap_or(0);
        let others = sum.iter().enumerate().filter(|(i, _)| *i != first).map(|(_, t)| t);
        for (k, term) in sum.get(first).into_iter().chain(others).enumerate() {
            text.push_str(match (k, term.coefficient < 0.0) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            });
            self.product(term, &mut text);
        }
        text.push_str(behind);
        text
    }

    /// A term without its sign.
    fn product(&self, term: &Term, text: &mut String) {
        let size = term.coefficient.abs();
        let mut between = "";
        if size != 1.0 || term.factors.is_empty() {
            let _ = write!(text, "{size:?}");
            between = " * ";
        }
        for id in &term.factors {
            text.push_str(between);
            text.push_str(&self.names[*id as usize]);
            between = " * ";
        }
    }

    fn outputs(&self, out: &mut String) {
        let (kernel, program) = (self.function.kernel, &self.function.program);
        // An output that occurs in several places (A is symmetric) is computed once.
        let mut count = vec![0; program.sums.len()];
        program.outputs.iter().flatten().for_each(|s| count[*s] += 1);
        let simple = |s: usize| program.sums[s].len() <= 1 && program.sums[s].iter().all(|t| t.cost() == 0);
        let shared: Vec<bool> = (0..count.len()).map(|s| count[s] > 1 && !simple(s)).collect();
        for s in (0..shared.len()).filter(|s| shared[*s]) {
            line(out, &self.sum(&["let out", &s.to_string(), " = "], &program.sums[s], ";"), 1);
        }
        let value = |s: &usize| if shared[*s] { format!("out{s}") } else { self.value(*s) };
        let list = |open: String, sums: &[usize]| Layout::list(open, sums.iter().map(value).map(Layout::Sum), "]");
        let expression = |shape: Shape, label: String, sums: &[usize]| match shape {
            Shape::Scalar => Layout::Sum(label + &value(&sums[0])),
            Shape::Vector(_) => list(label + "[", sums),
            Shape::Matrix(_, columns) => {
                let rows = sums.chunks(columns.max(1)).map(|row| list("[".into(), row));
                Layout::list(label + "[", rows, "]")
            }
        };
        let values = kernel.outputs.iter().zip(&program.outputs);
        let result = match kernel.outputs.as_slice() {
            [one] => expression(one.shape, String::new(), &program.outputs[0]),
            _ => {
                let fields = values.map(|(o, sums)| expression(o.shape, format!("{}: ", o.name), sums));
                Layout::list(format!("{} {{ ", self.function.struct_name()), fields, " }")
            }
        };
        indent(out, 1);
        result.write(out, 1);
    }
}
