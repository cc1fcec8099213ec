//! One generated module per gait.

use super::description::description;
use super::function::{Function, base_name, functions};
use super::layout::{Layout, indent, line};
use super::modules::key;
use crate::dynamics::{Input, Kernel, LUMPS, PARAMETERS, Shape, kernels, lowest};
use crate::mechanism::{Lever, Mechanism};
use crate::spec::name::type_name;
use std::collections::{BTreeMap, BTreeSet};

/// Source of one gait's module, of a robot with or without a module of its own; `whole` is the module of the whole
/// robot. `beside` gives the gait's levers and its closed forms as LaTeX, `runtime` is the path of the module with the
/// `Gait` trait; without it there are functions only.
pub fn gait_source(
    mechanism: &Mechanism,
    beside: impl FnOnce() -> (Vec<Lever>, String) + Send,
    robot: &str,
    whole: &str,
    runtime: Option<&str>,
    origin: &str,
) -> String {
    let (mut model, kernels) = kernels(mechanism);
    let lowest = lowest(&mut model);
    let (functions, (levers, latex)) = rayon::join(|| functions(&model.ring, &kernels), beside);
    let mut source = header(origin);
    source += &items(&functions);
    if let Some(runtime) = runtime {
        let description = description(mechanism, &key(robot, &mechanism.gait), &lowest, &functions, runtime);
        source += &implementation(mechanism, description, &levers, whole, &functions, &latex, runtime);
    }
    source
}

/// How a module begins.
pub(super) fn header(origin: &str) -> String {
    format!("// {origin}\nuse super::math;\n")
}

/// The functions of a module, with the structs that they return.
pub(super) fn items(functions: &[Function]) -> String {
    let mut structs = BTreeSet::new();
    let mut items = String::new();
    for function in functions {
        if let Some((name, source)) = function.output_struct()
            && structs.insert(name)
        {
            items += &source;
        }
        items += &function.source;
    }
    items
}

/// The gait's type with its description and its `impl Gait`.
fn implementation(
    m: &Mechanism,
    description: Layout,
    levers: &[Lever],
    whole: &str,
    functions: &[Function],
    latex: &str,
    runtime: &str,
) -> String {
    let name = type_name(&m.gait);
    let mut out =
        format!("/// The {} of `{}`.\n#[derive(Clone, Copy, Debug, Default)]\npub struct {name};\n", m.gait, m.robot);
    let ty = format!("{runtime}::Description");
    constant("What the gait is made of, in numbers.", "DESCRIPTION", &ty, description, &mut out);
    out += &format!("impl {runtime}::Gait for {name} {{");
    let slice = Layout::list("&[", levers.iter().map(|l| lever(l, runtime)), "]");
    let whole_robot = format!("Option<&'static dyn {runtime}::whole::Whole>");
    getter("description", &format!("&{ty}"), Layout::Word("&DESCRIPTION".into()), &mut out);
    getter("latex", "&'static str", Layout::value(latex), &mut out);
    getter("levers", &format!("&'static [{runtime}::Lever]"), slice, &mut out);
    getter("whole", &whole_robot, Layout::Word(format!("Some(&super::{whole}::Whole)")), &mut out);
    methods(functions, &mut out);
    out + "\n}\n"
}

/// A documented static.
pub(super) fn constant(doc: &str, name: &str, ty: &str, value: Layout, out: &mut String) {
    *out += &format!("/// {doc}\npub static {name}: {ty} = ");
    value.write(out, 0);
    *out += ";\n";
}

/// A trait's method that hands out a value.
pub(super) fn getter(name: &str, ty: &str, value: Layout, out: &mut String) {
    line(out, &format!("fn {name}(&self) -> {ty} {{"), 1);
    indent(out, 2);
    value.write(out, 2);
    line(out, "}", 1);
}

/// Numbers of the specification that change together, as a value of the runtime's type.
fn lever(lever: &Lever, runtime: &str) -> Layout {
    let Lever { name, numbers, unit, value, slopes } = lever;
    Layout::record(
        format!("{runtime}::Lever"),
        [
            ("name", Layout::value(name)),
            ("numbers", Layout::list("&[", numbers.iter().map(Layout::value), "]")),
            ("unit", Layout::value(unit)),
            ("value", Layout::float(*value)),
            ("slopes", Layout::list("&[", slopes.iter().map(Layout::value), "]")),
        ],
    )
}

/// Trait methods: per kernel one that takes slices and writes all outputs one after another.
pub(super) fn methods(functions: &[Function], out: &mut String) {
    let mut by_base: BTreeMap<&str, Vec<&Kernel>> = BTreeMap::new();
    let mut order = Vec::new();
    for function in functions {
        let (base, _) = base_name(&function.kernel.name);
        let list = by_base.entry(base).or_default();
        if list.is_empty() {
            order.push(base);
        }
        list.push(function.kernel);
    }
    for base in order {
        let twins = &by_base[base];
        let leg = base_name(&twins[0].name).1.then(|| "leg: usize".to_string());
        let inputs = twins[0].inputs.iter().filter(|i| !is_of_robot(i));
        let inputs = inputs.map(|i| format!("{}: {}", i.name, if i.scalar { "f64" } else { "&[f64]" }));
        let parameters = ["&self".into()].into_iter().chain(leg).chain(inputs).chain(["out: &mut [f64]".into()]);
        line(out, "#[inline]", 1);
        indent(out, 1);
        Layout::list(format!("fn {base}("), parameters.map(Layout::Word), ") {").write(out, 1);
        if let [first, second, ..] = twins[..] {
            line(out, "if leg == 0 {", 2);
            call(first, out, 3);
            line(out, "} else {", 2);
            call(second, out, 3);
            line(out, "}", 2);
        } else {
            call(twins[0], out, 2);
        }
        line(out, "}", 1);
    }
}

/// Whether an input is a property of the robot rather than of its state.
fn is_of_robot(input: &Input) -> bool {
    input.name == LUMPS || input.name == PARAMETERS
}

/// A call with checked lengths; outputs that do not fit the inputs become NaN rather than a panic.
fn call(kernel: &Kernel, out: &mut String, depth: usize) {
    for input in kernel.inputs.iter().filter(|i| !i.scalar && !is_of_robot(i)) {
        line(
            out,
            &format!("let Some({0}) = {0}.first_chunk() else {{ return out.fill(f64::NAN) }};", input.name),
            depth,
        );
    }
    let argument = |i: &Input| if is_of_robot(i) { format!("&self.{}", i.name) } else { i.name.into() };
    indent(out, depth);
    let arguments = kernel.inputs.iter().map(argument).map(Layout::Word);
    Layout::list(format!("let r = {}(", kernel.name), arguments, ");").write(out, depth);
    let slice = |value: &str, shape: Shape| match shape {
        Shape::Scalar => format!("core::slice::from_ref(&{value})"),
        Shape::Vector(_) => format!("{value}.as_slice()"),
        Shape::Matrix(..) => format!("{value}.as_flattened()"),
    };
    let pieces: Vec<String> = match kernel.outputs.as_slice() {
        [one] => vec![slice("r", one.shape)],
        several => several.iter().map(|o| slice(&format!("r.{}", o.name), o.shape)).collect(),
    };
    line(out, "let mut rest = out;", depth);
    indent(out, depth);
    Layout::list("for piece in [", pieces.into_iter().map(Layout::Word), "] {").write(out, depth);
    line(out, "let Some((head, tail)) = rest.split_at_mut_checked(piece.len()) else { return };", depth + 1);
    line(out, "head.copy_from_slice(piece);", depth + 1);
    line(out, "rest = tail;", depth + 1);
    line(out, "}", depth);
}
