//! Kernels over many states at once: a loop over lanes that LLVM turns into vector instructions.
//!
//! The loop calls the kernel itself but for its sines and cosines, which it evaluates in line, with the same bits: so
//! LLVM sees one body. All numbers of a lane are written one by one: an inner loop over them would keep the outer one from vectorizing.

use super::body::Sines;
use super::function::{Function, shape_type};
use super::layout::{Layout, indent, line};
use crate::dynamics::Shape;
use std::fmt::Write;

/// `kernel_batch` of a kernel with several outputs, with an array of lanes for every number.
pub fn source(function: &Function) -> String {
    let kernel = &function.kernel;
    let single = &kernel.name;
    let mut source = format!("/// [`{single}`] of one of many states.\n#[inline(always)]\n");
    function.write(&format!("fn {single}_lane("), Sines::InStep, &mut source);
    let _ = writeln!(
        source,
        "/// [`{single}`] of `N` states, with the same bits. Vectors and matrices are of lanes.\n#[inline]"
    );
    let lanes = "[f64; N]";
    let parameters = kernel.inputs.iter().map(|i| {
        let shape = if i.scalar { Shape::Scalar } else { Shape::Vector(i.symbols.len()) };
        format!("{}: &{}", i.name, shape_type(shape, lanes))
    });
    let result = format!("out: &mut {}<{lanes}>", function.struct_name());
    let parameters = parameters.chain([result]).map(Layout::Sum);
    Layout::list(format!("pub fn {single}_batch<const N: usize>("), parameters, ") {").write(&mut source, 0);
    line(&mut source, "for lane in 0..N {", 1);
    let arguments = kernel.inputs.iter().map(|i| {
        let elements = (0..i.symbols.len()).map(|k| Layout::Sum(format!("{}[{k}][lane]", i.name)));
        if i.scalar { Layout::Sum(format!("{}[lane]", i.name)) } else { Layout::list("&[", elements, "]") }
    });
    indent(&mut source, 2);
    Layout::list(format!("let state = {single}_lane("), arguments, ");").write(&mut source, 2);
    for o in &kernel.outputs {
        for place in places(o.shape) {
            line(&mut source, &format!("out.{0}{place}[lane] = state.{0}{place};", o.name), 2);
        }
    }
    line(&mut source, "}", 1);
    line(&mut source, "}", 0);
    indent(&mut source, 0);
    source
}

/// The indices of all numbers of a shape.
fn places(shape: Shape) -> Vec<String> {
    match shape {
        Shape::Scalar => vec![String::new()],
        Shape::Vector(n) => (0..n).map(|k| format!("[{k}]")).collect(),
        Shape::Matrix(rows, columns) => {
            (0..rows * columns).map(|k| format!("[{}][{}]", k / columns, k % columns)).collect()
        }
    }
}
