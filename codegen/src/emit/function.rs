//! One kernel as one function: its signature and what is said of it.

use super::batch;
use super::body;
use super::layout::{Layout, indent, line};
use crate::dynamics::{Kernel, Shape};
use crate::expr::Ring;
use crate::program::{Operations, Program, Search};
use crate::spec::name::type_name;
use crate::turns::in_turn;
use std::cmp::Reverse;
use std::fmt::Write;

/// A kernel with its program, ready to be written.
#[derive(Clone)]
pub struct Function<'a> {
    pub ring: &'a Ring,
    pub kernel: &'a Kernel,
    pub program: Program,
    pub operations: Operations,
    /// What it would cost as derived, without factoring.
    pub derived: Operations,
    /// The function itself, and the one for batches where it is wanted.
    pub source: String,
}

/// A function for each kernel, in order.
pub fn functions<'a>(ring: &'a Ring, kernels: &'a [Kernel]) -> Vec<Function<'a>> {
    let make = |search: &mut Search, kernel| Function::new(ring, kernel, search);
    in_turn(kernels, |kernel| Reverse(kernel.pairs()), Search::default, make)
}

/// `inverse_jacobian2` → (`inverse_jacobian`, true): leg kernels end in the leg's number.
pub fn base_name(name: &str) -> (&str, bool) {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (base, base.len() != name.len())
}

impl Function<'_> {
    pub fn new<'a>(ring: &'a Ring, kernel: &'a Kernel, search: &mut Search) -> Function<'a> {
        let derived = Program::as_derived(ring, kernel);
        let program = derived.factored(search);
        let (operations, derived) = (program.operations(), derived.operations());
        let mut function = Function { ring, kernel, program, operations, derived, source: String::new() };
        function.source = function.written();
        function
    }

    /// The type returned: a struct where there are several outputs.
    fn return_type(&self) -> String {
        match self.kernel.outputs.as_slice() {
            [one] => shape_type(one.shape, "f64"),
            _ => self.struct_name(),
        }
    }

    pub fn struct_name(&self) -> String {
        type_name(base_name(&self.kernel.name).0)
    }

    /// The struct returned, if the kernel has several outputs: its name and source.
    pub fn output_struct(&self) -> Option<(String, String)> {
        if self.kernel.outputs.len() < 2 {
            return None;
        }
        let name = self.struct_name();
        let mut source = format!(
            "/// Result of [`{}`] and, where there is one, its twin for the other leg.\n\
             #[derive(Clone, Copy, Debug, PartialEq)]\npub struct {name}<T = f64> {{\n",
            self.kernel.name
        );
        for o in &self.kernel.outputs {
            let _ = writeln!(source, "    /// {}\n    pub {}: {},", o.doc, o.name, shape_type(o.shape, "T"));
        }
        Some((name, source + "}\n"))
    }

    fn written(&self) -> String {
        let ops = self.operations;
        let mut source = format!(
            "/// {}\n///\n/// Operations: {} additions and multiplications, {} divisions, {} pairs of sine and cosine.\n#[inline]\n",
            self.kernel.doc, ops.flops, ops.divisions, ops.sincos
        );
        let inputs = self.kernel.inputs.iter().map(|i| {
            let ty = if i.scalar { "f64".into() } else { format!("&[f64; {}]", i.symbols.len()) };
            Layout::Sum(format!("{}: {ty}", i.name))
        });
        let open = format!("pub fn {}(", self.kernel.name);
        Layout::list(open, inputs, format!(") -> {} {{", self.return_type())).write(&mut source, 0);
        body::write(self, &mut source);
        line(&mut source, "}", 0);
        indent(&mut source, 0);
        if self.kernel.batched && self.kernel.outputs.len() > 1 {
            source += &batch::source(self);
        }
        source
    }
}

/// An array type for a shape, of numbers or of lanes.
pub fn shape_type(shape: Shape, number: &str) -> String {
    match shape {
        Shape::Scalar => number.into(),
        Shape::Vector(n) => format!("[{number}; {n}]"),
        Shape::Matrix(rows, columns) => format!("[[{number}; {columns}]; {rows}]"),
    }
}
