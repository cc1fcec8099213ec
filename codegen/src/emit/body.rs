//! The body of a kernel: a straight line of `let`s over named values, and what becomes of its outputs.

use super::function::Function;
use super::layout::{Layout, indent, line};
use super::scopes::{Scopes, Statement};
use crate::dynamics::Shape;
use crate::expr::Kind;
use crate::program::{Id, Node, Sum, Term};
use std::fmt::Write;

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
    order: Vec<Id>,
    used: Vec<bool>,
    names: Vec<String>,
    form: Form,
}

/// Writes the body of a function for one state.
pub fn write(function: &Function, out: &mut String) {
    let body = Body::new(function, Form::Single);
    body.inputs(out);
    body.scopes(true).write(&body.bindings(), out);
    body.result(out);
}

/// Writes the body of a loop over lanes, from inputs and to outputs that are arrays of lanes.
pub fn write_lane(function: &Function, out: &mut String) {
    let body = Body::new(function, Form::Lane);
    body.inputs(out);
    body.scopes(false).write(&body.with_stores(body.bindings()), out);
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

impl<'a> Body<'a> {
    fn new(function: &'a Function, form: Form) -> Body<'a> {
        let order = function.program.schedule_sines_first();
        let mut used = vec![false; function.program.nodes.len()];
        order.iter().for_each(|id| used[*id as usize] = true);
        let names = function.program.nodes.iter().enumerate().map(|(id, node)| name(function, id, *node)).collect();
        Body { function, order, used, names, form }
    }

    /// The scopes of its statements; whether the outputs are evaluated behind them.
    fn scopes(&self, outputs_follow: bool) -> Scopes<'_> {
        Scopes { program: &self.function.program, names: &self.names, outputs_follow, depth: self.depth() }
    }

    /// Indents of its lines.
    fn depth(&self) -> usize {
        if self.form == Form::Lane { 2 } else { 1 }
    }

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
                match self.form {
                    Form::Lane => line(out, &format!("let {name} = {}[lane];", input.name), self.depth()),
                    Form::Single if name != input.name => {
                        line(out, &format!("let {name} = {};", input.name), self.depth());
                    }
                    Form::Single => {}
                }
                continue;
            }
            indent(out, self.depth());
            let name = |k: usize| if used[i][k] { input_name(self.function, i, k) } else { "_".into() };
            let elements = 0..input.symbols.len();
            let names = elements.clone().map(|k| Layout::Sum(name(k)));
            if self.form == Form::Single {
                Layout::list("let [", names, format!("] = *{};", input.name)).write(out, self.depth());
            } else {
                Layout::list("let [", names, "] = ").write(out, self.depth());
                let of_lane = elements.map(|k| Layout::Word(format!("{}[{k}][lane]", input.name)));
                Layout::list("[", of_lane, "];").write(out, self.depth());
            }
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

    /// A `let` for every node, but for sines and cosines, which are bound some at once.
    fn bindings(&self) -> Vec<Statement> {
        let program = &self.function.program;
        let mut sines = self.sines();
        let mut bindings = Vec::with_capacity(self.order.len());
        for id in &self.order {
            let name = &self.names[*id as usize];
            let (s, text) = match program.nodes[*id as usize] {
                Node::Input(..) => continue,
                Node::Sin(_) | Node::Cos(_) => {
                    // They follow one another: with the first, all are bound.
                    let sines = std::mem::take(&mut sines);
                    bindings.extend(sines.chunks(AT_ONCE).map(|pairs| self.sines_of(pairs)));
                    continue;
                }
                Node::Value(s) => (s, self.sum(&["let ", name, " = "], &program.sums[s], ";")),
                Node::Reciprocal(s) => (s, self.sum(&["let ", name, " = 1.0 / ("], &program.sums[s], ");")),
            };
            bindings.push(Statement { nodes: vec![*id], sums: vec![s], lines: vec![text] });
        }
        bindings
    }

    /// Sines and cosines of the arguments that are these sums.
    fn sines_of(&self, pairs: &[(usize, [Option<Id>; 2])]) -> Statement {
        let arguments: Vec<_> = pairs.iter().map(|(s, _)| self.value(*s)).collect();
        let name = |id: Option<Id>| id.map_or("_", |id| &self.names[id as usize]);
        let values: Vec<_> = pairs.iter().map(|(_, [sin, cos])| format!("({}, {})", name(*sin), name(*cos))).collect();
        let (arguments, values) = (arguments.join(", "), values.join(", "));
        let text = match (pairs.len(), self.form) {
            (1, _) => format!("let {values} = math::sin_cos({arguments});"),
            (_, Form::Single) => format!("let [{values}] = math::sin_cos_together([{arguments}]);"),
            (_, Form::Lane) => format!("let [{values}] = math::sin_cos_in_step([{arguments}]);"),
        };
        let nodes = pairs.iter().flat_map(|(_, pair)| pair).flatten().copied().collect();
        Statement { nodes, sums: pairs.iter().map(|(s, _)| *s).collect(), lines: vec![text] }
    }

    /// The bindings, and after each the outputs that it makes known. Sums that are several outputs follow in the end: they
    /// are not at hand yet, and evaluated early they take registers away.
    fn with_stores(&self, bindings: Vec<Statement>) -> Vec<Statement> {
        let (kernel, program) = (self.function.kernel, &self.function.program);
        // After how many bindings each node is known.
        let mut known = vec![0; program.nodes.len()];
        for (number, binding) in bindings.iter().enumerate() {
            binding.nodes.iter().for_each(|id| known[*id as usize] = number + 1);
        }
        let mut places: Vec<Vec<String>> = vec![Vec::new(); program.sums.len()];
        for (output, sums) in kernel.outputs.iter().zip(&program.outputs) {
            for (place, s) in output.shape.places().zip(sums) {
                places[*s].push(format!("out.{}{place}[lane] = ", output.name));
            }
        }
        let shared = self.shared();
        let mut stores: Vec<Vec<Statement>> = (0..=bindings.len()).map(|_| Vec::new()).collect();
        for s in program.outputs.iter().flatten() {
            let places = std::mem::take(&mut places[*s]);
            if places.is_empty() {
                continue;
            }
            let value = self.output(*s, &shared);
            let bound = shared[*s].then(|| self.sum(&["let ", &value, " = "], &program.sums[*s], ";"));
            let lines = bound.into_iter().chain(places.into_iter().map(|place| place + &value + ";")).collect();
            let ready = program.sums[*s].iter().flat_map(|t| &t.factors).map(|id| known[*id as usize]).max();
            let after = if shared[*s] { bindings.len() } else { ready.unwrap_or(0) };
            stores[after].push(Statement { nodes: Vec::new(), sums: vec![*s], lines });
        }
        let mut stores = stores.into_iter();
        let mut all: Vec<Statement> = stores.next().unwrap_or_default();
        for (binding, stores) in bindings.into_iter().zip(stores) {
            all.push(binding);
            all.extend(stores);
        }
        all
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

    /// Sums that are outputs in several places (A is symmetric): they are computed once.
    fn shared(&self) -> Vec<bool> {
        let program = &self.function.program;
        let mut count = vec![0; program.sums.len()];
        program.outputs.iter().flatten().for_each(|s| count[*s] += 1);
        let simple = |s: usize| program.sums[s].len() <= 1 && program.sums[s].iter().all(|t| t.cost() == 0);
        (0..count.len()).map(|s| count[s] > 1 && !simple(s)).collect()
    }

    /// The value of a sum that is an output.
    fn output(&self, sum: usize, shared: &[bool]) -> String {
        if shared[sum] { format!("out{sum}") } else { self.value(sum) }
    }

    /// What a function for one state returns.
    fn result(&self, out: &mut String) {
        let (kernel, program) = (self.function.kernel, &self.function.program);
        let shared = self.shared();
        for s in (0..shared.len()).filter(|s| shared[*s]) {
            line(out, &self.sum(&["let out", &s.to_string(), " = "], &program.sums[s], ";"), 1);
        }
        let value = |s: &usize| self.output(*s, &shared);
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
