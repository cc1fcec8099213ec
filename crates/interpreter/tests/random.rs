//! Kernels of random robots have the bits of the source that is generated for them, read as Rust reads it.

#[allow(dead_code)]
#[path = "../../../codegen/tests/physics/robots.rs"]
mod robots;

use piaffe_codegen::dynamics::{Kernel, kernels};
use piaffe_codegen::emit::{Embedding, embedding_source};
use piaffe_codegen::expr::Ring;
use piaffe_codegen::math;
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::program::programs;
use piaffe_interpreter::Tape;
use robots::{BUILDS, DRAWS, Draws, specification};
use std::collections::HashMap;
use syn::{BinOp, Block, Expr, ExprCall, Item, ItemFn, Lit, Member, Pat, Stmt, UnOp};

/// What an expression of a generated body can be.
#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Several(Vec<Value>),
}

impl Value {
    fn number(&self) -> f64 {
        match self {
            Value::Number(x) => *x,
            Value::Several(_) => panic!("no number: {self:?}"),
        }
    }

    fn several(&self) -> &[Value] {
        match self {
            Value::Several(list) => list,
            Value::Number(_) => panic!("no list: {self:?}"),
        }
    }

    fn flat(&self, numbers: &mut Vec<f64>) {
        match self {
            Value::Number(x) => numbers.push(*x),
            Value::Several(list) => list.iter().for_each(|value| value.flat(numbers)),
        }
    }
}

/// The names of a body, each of which is bound once or to the same.
type Names = HashMap<String, Value>;

fn bind(pattern: &Pat, value: &Value, names: &mut Names) {
    let each = |patterns: Vec<&Pat>, names: &mut Names| {
        assert_eq!(patterns.len(), value.several().len());
        patterns.into_iter().zip(value.several()).for_each(|(pattern, value)| bind(pattern, value, names));
    };
    match pattern {
        Pat::Ident(name) => drop(names.insert(name.ident.to_string(), value.clone())),
        Pat::Wild(_) => {}
        Pat::Slice(list) => each(list.elems.iter().collect(), names),
        Pat::Tuple(list) => each(list.elems.iter().collect(), names),
        _ => panic!("no pattern of a generated body: {pattern:?}"),
    }
}

fn block(block: &Block, names: &mut Names) -> Value {
    for statement in &block.stmts {
        match statement {
            Stmt::Local(local) => {
                let value = evaluate(&local.init.as_ref().unwrap().expr, names);
                bind(&local.pat, &value, names);
            }
            Stmt::Expr(expression, None) => return evaluate(expression, names),
            _ => panic!("no statement of a generated body: {statement:?}"),
        }
    }
    panic!("a body without a result")
}

fn evaluate(expression: &Expr, names: &mut Names) -> Value {
    let number = |expression: &Expr, names: &mut Names| evaluate(expression, names).number();
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Float(x) => Value::Number(x.base10_parse().unwrap()),
            other => panic!("no number: {other:?}"),
        },
        Expr::Path(path) => names[&path.path.get_ident().unwrap().to_string()].clone(),
        Expr::Paren(inner) => evaluate(&inner.expr, names),
        Expr::Unary(unary) => match unary.op {
            UnOp::Deref(_) => evaluate(&unary.expr, names),
            UnOp::Neg(_) => Value::Number(-number(&unary.expr, names)),
            _ => panic!("no operation of a generated body: {unary:?}"),
        },
        Expr::Binary(binary) => {
            let (a, b) = (number(&binary.left, names), number(&binary.right, names));
            Value::Number(match binary.op {
                BinOp::Add(_) => a + b,
                BinOp::Sub(_) => a - b,
                BinOp::Mul(_) => a * b,
                BinOp::Div(_) => a / b,
                _ => panic!("no operation of a generated body: {binary:?}"),
            })
        }
        Expr::Array(list) => Value::Several(list.elems.iter().map(|e| evaluate(e, names)).collect()),
        Expr::Block(inner) => block(&inner.block, names),
        Expr::Call(call) => sines(call, names),
        Expr::Struct(fields) => {
            let named = fields.fields.iter().inspect(|field| assert!(matches!(field.member, Member::Named(_))));
            Value::Several(named.map(|field| evaluate(&field.expr, names)).collect())
        }
        _ => panic!("no expression of a generated body: {expression:?}"),
    }
}

/// A call of the one or the other function that bodies call.
fn sines(call: &ExprCall, names: &mut Names) -> Value {
    let Expr::Path(function) = &*call.func else { panic!("{call:?}") };
    let pair = |x: &Value| {
        let (sin, cos) = math::sin_cos(x.number());
        Value::Several(vec![Value::Number(sin), Value::Number(cos)])
    };
    let argument = evaluate(&call.args[0], names);
    match function.path.segments.last().unwrap().ident.to_string().as_str() {
        "sin_cos" => pair(&argument),
        "sin_cos_together" => Value::Several(argument.several().iter().map(pair).collect()),
        other => panic!("bodies call no {other}"),
    }
}

/// The outputs of a generated function, one after another.
fn called(function: &ItemFn, inputs: &[Vec<f64>], kernel: &Kernel) -> Vec<f64> {
    let mut names = Names::new();
    for (input, numbers) in kernel.inputs.iter().zip(inputs) {
        let several = || Value::Several(numbers.iter().copied().map(Value::Number).collect());
        names.insert(input.name.into(), if input.scalar { Value::Number(numbers[0]) } else { several() });
    }
    let mut outputs = Vec::new();
    block(&function.block, &mut names).flat(&mut outputs);
    outputs
}

/// The functions of a module by their names.
fn functions(source: &str) -> HashMap<String, ItemFn> {
    let items = syn::parse_file(source).unwrap().items.into_iter();
    items.filter_map(|item| if let Item::Fn(f) = item { Some((f.sig.ident.to_string(), f)) } else { None }).collect()
}

fn compare(ring: &Ring, kernels: &[Kernel], source: &str, what: &str, draws: &mut Draws) {
    let functions = functions(source);
    for (kernel, (program, _)) in kernels.iter().zip(programs(ring, kernels)) {
        let tape = Tape::new(kernel, &program).unwrap();
        let inputs: Vec<Vec<f64>> = kernel.inputs.iter().map(|i| draws.vector(i.symbols.len(), 3.0)).collect();
        let expected = called(&functions[&kernel.name], &inputs, kernel);
        let mut found = vec![f64::NAN; tape.outputs()];
        tape.evaluate(&inputs.iter().map(Vec::as_slice).collect::<Vec<_>>(), &mut found);
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(expected.iter().all(|x| x.is_finite()), "{what}, {}: {expected:?}", kernel.name);
        assert_eq!(bits(&found), bits(&expected), "{what}, {}: {found:?} {expected:?}", kernel.name);
    }
}

/// Of every kind one; three links and a platform that rolls make derivations of many seconds.
const KINDS: [&str; 8] = [
    "trot with rotors",
    "level, hips apart",
    "curvet",
    "amble",
    "amble with hips that turn",
    "biped",
    "crooked trot",
    "crooked curvet",
];

#[test]
fn kernels_have_the_bits_of_the_generated_source() {
    let mut rng = fastrand::Rng::with_seed(3);
    for kind in KINDS {
        let (what, build) = BUILDS.iter().find(|(what, _)| *what == kind).unwrap();
        let mut draws = Draws::new((0..DRAWS).map(|_| rng.f64()).collect());
        let (robot, gait) = specification(build, &mut draws);
        let mechanism = Mechanism::new(&robot, &gait);
        // Flight too, where there can be some.
        let mechanism = mechanism.clone().with_flight().unwrap_or(mechanism);
        let (model, derived) = kernels(&mechanism);
        let source = embedding_source(&Embedding::new(&mechanism).functions().unwrap(), None, "here").unwrap();
        compare(&model.ring, &derived, &source, what, &mut draws);
    }
}
