//! Kernels over many states at once: a loop over lanes that LLVM turns into vector instructions.
//!
//! The kernel's own lines stand in it, so that LLVM sees one body. All numbers of a lane are written one by one: an inner
//! loop over them would keep the outer one from vectorizing.

use super::body;
use super::function::{Function, shape_type};
use super::layout::{Layout, indent, line};
use crate::dynamics::Shape;
use std::fmt::Write;

/// `kernel_batch` of a kernel with several outputs, with an array of lanes for every number.
pub fn source(function: &Function) -> String {
    let kernel = &function.kernel;
    let single = &kernel.name;
    let mut source = String::new();
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
    body::write_lane(function, &mut source);
    line(&mut source, "}", 1);
    line(&mut source, "}", 0);
    indent(&mut source, 0);
    source
}
