//! Laws of the generated code: no allocation, no panic, no branch on data; the same bytes every time; what
//! is emitted computes what was derived; and its operation counts cannot creep up unseen.

mod common;

use common::{Derived, FAMILIES, GAITS, files, in_all_modes, shipped, specification, with_phases};
use piaffe_codegen::dynamics::{Block, Input, Kernel, whole_kernels};
use piaffe_codegen::emit::{Beside, Embedding, Function, MATH_FILE, Modules, embedding_source, gait_source};
use piaffe_codegen::mechanism::{Lever, Mechanism, Mode, Whole};
use piaffe_codegen::program::Program;
use piaffe_codegen::spec::Then;
use piaffe_codegen::spec::name::{ITEMS, OF_FLIGHT, type_name};
use piaffe_codegen::{Generated, RobotFiles, SpecFile, generate, generate_families};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use syn::visit::{self, Visit};
use syn::visit_mut::{self, VisitMut};

/// Robots with these of their gaits, as if the specification were found under `prefix`.
fn robots(prefix: &str, gaits: &[&'static str]) -> Vec<RobotFiles> {
    let under = |file: SpecFile| SpecFile { path: format!("{prefix}{}", file.path), ..file };
    let mut robots: Vec<RobotFiles> = Vec::new();
    for gait in gaits {
        let (module, robot, gait) = files(gait);
        match robots.iter_mut().find(|r| r.module == module) {
            Some(known) => known.gaits.push(under(gait)),
            None => {
                robots.push(RobotFiles { module: module.into(), robot: under(robot), gaits: vec![under(gait)] });
            }
        }
    }
    robots
}

/// Shipped gaits, of their robots and of their families.
fn generated(prefix: &str) -> Vec<Generated> {
    let all = ["gravity", "links", "legs", "actuators"].map(String::from);
    let mut files = generate(&robots(prefix, &GAITS), Some("crate::model")).unwrap();
    files.extend(generate_families(&robots(prefix, &FAMILIES), &all, "crate::model").unwrap());
    files
}

/// Shipped gaits with a flight after each stance, of their robots and of their families.
fn flying() -> Vec<Generated> {
    let all = ["gravity", "links", "legs", "actuators"].map(String::from);
    let mut robot = robots("", &["trot", "curvet"]);
    robot[0].gaits = vec![
        with_phases("trot", &[Some(1), None], "mirrored"),
        with_phases("curvet", &[Some(1), None, Some(2), None], "repeat"),
    ];
    let mut files = generate(&robot, Some("crate::model")).unwrap();
    files.extend(generate_families(&robot, &all, "crate::model").unwrap());
    files
}

#[test]
fn same_bytes_every_time_and_everywhere() {
    let here = generated("model-spec/");
    assert_eq!(here, generated("/some/other/place/"), "paths leak into the code");
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(here, pool.install(|| generated("model-spec/")), "{threads} threads");
    }
}

/// Gaits that lock the same joints share a whole robot; one that locks others has one of its own.
#[test]
fn there_is_a_whole_robot_for_every_way_to_lock_joints() {
    let (_, robot, trot) = files("trot");
    let stiff = SpecFile {
        path: "stiff.toml".into(),
        text: trot.text.replace("[limits]", "locked = { knee = -0.5 }\n\n[limits]"),
    };
    let (_, _, curvet) = files("curvet");
    let gaits = vec![curvet, stiff, trot];
    let made = generate(&[RobotFiles { module: String::new(), robot, gaits }], Some("crate::model")).unwrap();
    let source = |name: &str| &made.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no {name}")).1;
    for (gait, whole, joints) in [("curvet", "whole", 8), ("stiff", "whole2", 4), ("trot", "whole", 8)] {
        assert!(source(&format!("{gait}.rs")).contains(&format!("super::{whole}::Whole")), "{gait}");
        assert!(source(&format!("{whole}.rs")).contains(&format!("q: &[f64; {joints}]")), "{gait}");
        assert!(source("gaits.rs").contains(&format!("pub mod {whole} ")));
    }
    assert!(made.iter().all(|(name, _)| name != "whole3.rs"));
}

/// Gaits that move the robot alike share their kernels, and each of these is what it would be alone.
#[test]
fn gaits_that_move_alike_share_their_kernels() {
    let functions = |mechanism: &Mechanism| {
        let embedding = Embedding::new(mechanism);
        let functions = embedding.functions().unwrap();
        let named = |f: &Function| (f.kernel.name.clone(), f.source.clone());
        functions.iter().map(named).collect::<BTreeMap<_, _>>()
    };
    for alike in [&["trot", "running_trot"][..], &["bound", "bound_two_flights", "curvet"]] {
        let mechanisms: Vec<Mechanism> = alike.iter().map(|gait| shipped(gait)).collect();
        assert!(mechanisms.iter().all(|m| m.moves_like(&mechanisms[0])), "{alike:?}");
        let all = mechanisms.iter().skip(1).fold(mechanisms[0].clone(), |all, m| all.with_those_of(m));
        let together = functions(&all);
        for (gait, mechanism) in alike.iter().zip(&mechanisms) {
            for (kernel, source) in functions(mechanism) {
                assert_eq!(together.get(&kernel), Some(&source), "{gait}: {kernel}");
            }
        }
    }
    let [trot, amble, curvet] = ["trot", "amble", "curvet"].map(shipped);
    assert!(!trot.moves_like(&curvet) && !trot.moves_like(&amble), "other legs move as one");
    let mut distinct = trot.clone();
    distinct.then = Then::Repeat;
    assert!(!trot.moves_like(&distinct), "its legs do not take each other's parts");
}

/// Walks a file; `kernel` inside of a free function, where only straight lines are allowed.
#[derive(Default)]
struct Law {
    kernel: bool,
    functions: usize,
    longest: usize,
    broken: Vec<String>,
}

impl Law {
    /// A batch is one loop over the lanes, which are indexed by its own counter.
    fn batch(&mut self, f: &syn::ItemFn) {
        let [syn::Stmt::Expr(syn::Expr::ForLoop(lanes), None)] = f.block.stmts.as_slice() else {
            return self.broken.push(format!("{} is no loop", f.sig.ident));
        };
        let header: syn::ExprForLoop = syn::parse_quote!(for lane in 0..N {});
        if (&lanes.pat, &lanes.expr) != (&header.pat, &header.expr) {
            self.broken.push(format!("{} does not loop over its lanes", f.sig.ident));
        }
        let mut indices = Indices(Vec::new());
        indices.visit_block(&lanes.body);
        let lane: syn::Expr = syn::parse_quote!(lane);
        let literal = |e: &syn::Expr| matches!(e, syn::Expr::Lit(_));
        if indices.0.is_empty() || indices.0.iter().any(|index| *index != lane && !literal(index)) {
            self.broken.push(format!("{} computes an index", f.sig.ident));
        }
        // What is left without the lanes' places is a kernel: a straight line.
        let mut body = lanes.body.clone();
        WithoutLanes.visit_block_mut(&mut body);
        self.kernel = true;
        self.visit_block(&body);
        self.kernel = false;
    }
}

/// Takes places in arrays of lanes for names, and what is stored there for values with names.
struct WithoutLanes;

impl VisitMut for WithoutLanes {
    fn visit_stmt_mut(&mut self, statement: &mut syn::Stmt) {
        if let syn::Stmt::Expr(syn::Expr::Assign(store), Some(_)) = statement
            && matches!(*store.left, syn::Expr::Index(_))
        {
            let value = &store.right;
            *statement = syn::parse_quote!(let stored = #value;);
        }
        visit_mut::visit_stmt_mut(self, statement);
    }

    fn visit_expr_mut(&mut self, e: &mut syn::Expr) {
        if matches!(e, syn::Expr::Index(_)) {
            *e = syn::parse_quote!(lane);
        }
        visit_mut::visit_expr_mut(self, e);
    }
}

/// All indices in an expression.
struct Indices(Vec<syn::Expr>);

impl<'ast> Visit<'ast> for Indices {
    fn visit_expr_index(&mut self, e: &'ast syn::ExprIndex) {
        self.0.push((*e.index).clone());
        visit::visit_expr_index(self, e);
    }
}

/// Names that allocate, panic or leave the safe language.
const FORBIDDEN: [&str; 12] =
    ["Vec", "Box", "String", "Rc", "Arc", "alloc", "to_vec", "to_owned", "collect", "unwrap", "expect", "clone"];

impl<'ast> Visit<'ast> for Law {
    fn visit_item_fn(&mut self, f: &'ast syn::ItemFn) {
        if f.sig.ident.to_string().ends_with("_batch") {
            return self.batch(f);
        }
        self.functions += 1;
        self.kernel = true;
        visit::visit_item_fn(self, f);
        self.kernel = false;
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        let lets = block.stmts.iter().filter(|s| matches!(s, syn::Stmt::Local(_))).count();
        self.longest = self.longest.max(lets);
        for (i, statement) in block.stmts.iter().enumerate() {
            let last = i + 1 == block.stmts.len();
            let straight = match statement {
                syn::Stmt::Local(local) => local.init.as_ref().is_some_and(|init| init.diverge.is_none()),
                syn::Stmt::Expr(_, None) => last,
                _ => false,
            };
            if self.kernel && !straight {
                self.broken.push(format!("statement {i} of a kernel"));
            }
        }
        visit::visit_block(self, block);
    }

    fn visit_expr(&mut self, e: &'ast syn::Expr) {
        use syn::Expr;
        let straight = match e {
            Expr::Binary(b) => {
                matches!(b.op, syn::BinOp::Add(_) | syn::BinOp::Sub(_) | syn::BinOp::Mul(_) | syn::BinOp::Div(_))
            }
            Expr::Unary(u) => matches!(u.op, syn::UnOp::Neg(_) | syn::UnOp::Deref(_)),
            Expr::Call(call) => {
                let Expr::Path(function) = &*call.func else { return self.broken.push("a call of no name".into()) };
                let path: Vec<String> = function.path.segments.iter().map(|s| s.ident.to_string()).collect();
                matches!(&path[..], [math, function] if math == "math" && function.starts_with("sin_cos"))
            }
            Expr::Array(_) | Expr::Block(_) | Expr::Lit(_) | Expr::Paren(_) | Expr::Path(_) | Expr::Struct(_) => true,
            _ => false,
        };
        if self.kernel && !straight {
            self.broken.push("an expression that is no arithmetic, in a kernel".into());
        }
        if matches!(e, Expr::Index(_) | Expr::Unsafe(_)) {
            self.broken.push("indexing or unsafe".into());
        }
        visit::visit_expr(self, e);
    }

    fn visit_ident(&mut self, name: &'ast syn::Ident) {
        if FORBIDDEN.iter().any(|f| name == f) {
            self.broken.push(name.to_string());
        }
    }

    fn visit_macro(&mut self, m: &'ast syn::Macro) {
        self.broken.push(format!("macro {}", m.path.segments[0].ident));
    }
}

#[test]
fn kernels_are_straight_lines() {
    for (name, source) in generated("model-spec/") {
        if ["gaits.rs", "families.rs", MATH_FILE].contains(&name.as_str()) {
            continue;
        }
        let mut law = Law::default();
        law.visit_file(&syn::parse_file(&source).unwrap());
        assert!(law.broken.is_empty(), "{name}: {:?}", law.broken);
        let expected = match () {
            () if name.ends_with("whole.rs") => 3,
            () if name.starts_with("family/") || name.contains("embedding") => 30,
            () => 0,
        };
        assert!(law.functions >= expected && (law.functions > 0) == (expected > 0), "{name}: {}", law.functions);
        assert!(law.longest <= 500, "{name}: {} bindings in one scope", law.longest);
        assert!(!source.contains("unsafe"), "{name}");
    }
}

/// Those of modes that no shipped gait has are of the same kind.
#[test]
fn kernels_of_flight_are_straight_lines() {
    for gait in GAITS {
        let mechanism = in_all_modes(gait);
        let source = embedding_source(&Embedding::new(&mechanism).functions().unwrap(), None, "flight").unwrap();
        let mut law = Law::default();
        law.visit_file(&syn::parse_file(&source).unwrap());
        assert!(law.broken.is_empty(), "{gait}: {:?}", law.broken);
        assert_eq!(
            source.contains("pub fn flight_inverse_jacobian("),
            mechanism.modes.contains(&Mode::Flight),
            "{gait}"
        );
    }
}

/// Types and values that a module has or needs by a name of its own, beside what is called like the gait.
#[derive(Default)]
struct Items(BTreeSet<String>);

impl Items {
    fn add(&mut self, name: &syn::Ident) {
        let name = name.to_string();
        if name.starts_with(|c: char| c.is_ascii_uppercase()) {
            self.0.insert(name);
        }
    }
}

impl<'ast> Visit<'ast> for Items {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.add(&path.segments[0].ident);
        }
        visit::visit_path(self, path);
    }

    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.add(&item.ident);
        visit::visit_item_struct(self, item);
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.add(&item.ident);
        visit::visit_item_static(self, item);
    }

    fn visit_const_param(&mut self, parameter: &'ast syn::ConstParam) {
        self.add(&parameter.ident);
    }

    fn visit_type_param(&mut self, parameter: &'ast syn::TypeParam) {
        self.add(&parameter.ident);
    }
}

/// A gait whose type would be one of these is refused by the specification, and no other.
#[test]
fn what_a_gaits_module_needs_cannot_be_a_gaits_name() {
    let mut needed = Items::default();
    for (name, source) in generated("model-spec/").into_iter().chain(flying()) {
        let gait = name.trim_end_matches(".rs").rsplit('/').next().unwrap();
        if !["gaits", "families", "embedding", "whole", "math"]
            .contains(&gait.trim_end_matches(|c: char| c.is_ascii_digit()))
        {
            let mut items = Items::default();
            items.visit_file(&syn::parse_file(&source).unwrap());
            assert!(items.0.remove(&type_name(gait)), "{name} has a type of its own");
            needed.0.append(&mut items.0);
        }
    }
    let needed: BTreeSet<&str> = needed.0.iter().map(|name| name.strip_prefix(OF_FLIGHT).unwrap_or(name)).collect();
    assert_eq!(needed, ITEMS.iter().copied().collect(), "write these into spec/name.rs");
}

/// Whoever reads a kernel's numbers asks where they stand without asking for which leg.
#[test]
fn twins_have_the_same_blocks() {
    for gait in GAITS {
        let d = Derived::new(&in_all_modes(gait));
        for kernel in d.kernels.iter().filter(|k| k.outputs.len() > 1) {
            let twin = kernel.name.strip_suffix('1').map(|base| format!("{base}2"));
            let Some(twin) = twin.and_then(|twin| d.kernels.iter().find(|k| k.name == twin)) else { continue };
            let blocks = |k: &Kernel| {
                let outputs: Vec<Block> = k.outputs.iter().map(|o| Block { name: o.name, shape: o.shape }).collect();
                let inputs: Vec<Vec<Block>> = k.inputs.iter().map(|i| i.blocks.clone()).collect();
                (outputs, inputs)
            };
            assert_eq!(blocks(kernel), blocks(twin), "{gait}: {}", twin.name);
        }
    }
}

/// Blocks of an input are all of it.
#[test]
fn every_weight_has_a_name() {
    for gait in GAITS {
        for input in Derived::new(&shipped(gait)).kernels.iter().flat_map(|k| &k.inputs) {
            let named = Block::total(&input.blocks);
            assert!(input.blocks.is_empty() || named == input.symbols.len(), "{gait}: {}", input.name);
        }
    }
}

/// What no specification gives, a name that is none and numbers that are none, ends as words and not as code.
#[test]
fn what_cannot_be_code_is_said() {
    type Change = fn(&mut Mechanism);
    let said = |change: Change, value: f64| {
        let mut mechanism = shipped("trot");
        change(&mut mechanism);
        let lever = Lever { name: "a".into(), numbers: Vec::new(), unit: "", value, slopes: Vec::new() };
        let embedding = Embedding::new(&mechanism);
        let modules = Modules { robot: "", embedding: "embedding", whole: "whole" };
        let beside = Beside { levers: &[lever], latex: "", specification: [""; 2] };
        let written = |functions: Vec<_>| {
            gait_source(&mechanism, &embedding, &functions, &beside, &modules, Some("crate::model"), "here")
        };
        embedding.functions().and_then(written).unwrap_err().to_string()
    };
    let names: [Change; 3] = [|m| m.gait = "self".into(), |m| m.gait = "1".into(), |m| m.gait.clear()];
    for change in names {
        assert!(said(change, 1.0).ends_with("cannot be a name in Rust"));
    }
    let numbers: [Change; 2] = [|m| m.gravity = f64::NAN, |m| m.joints[0].gear = f64::INFINITY];
    for change in numbers {
        assert!(said(change, 1.0).ends_with("cannot be a number in Rust"));
    }
    assert_eq!(said(|_| (), f64::NAN), "NaN cannot be a number in Rust");
}

/// The pinned sine and cosine: arithmetic and bits, no branch, no panic.
#[test]
fn sine_and_cosine_do_not_branch() {
    struct Branches(usize);
    impl<'ast> Visit<'ast> for Branches {
        fn visit_expr(&mut self, e: &'ast syn::Expr) {
            use syn::Expr;
            let branch = matches!(
                e,
                Expr::If(_)
                    | Expr::Match(_)
                    | Expr::While(_)
                    | Expr::ForLoop(_)
                    | Expr::Loop(_)
                    | Expr::Index(_)
                    | Expr::Macro(_)
                    | Expr::Unsafe(_)
                    | Expr::Try(_)
            );
            self.0 += usize::from(branch);
            visit::visit_expr(self, e);
        }
    }
    let mut branches = Branches(0);
    let file = syn::parse_file(piaffe_codegen::emit::MATH).unwrap();
    let single = file.items.iter().find(|i| matches!(i, syn::Item::Fn(f) if f.sig.ident == "sin_cos")).unwrap();
    branches.visit_item(single);
    assert_eq!(branches.0, 0);
}

/// Factoring does not change values: the program as it is emitted against the expressions as derived.
#[test]
fn programs_compute_what_was_derived() {
    let robot = GAITS.map(|gait| (gait, Derived::new(&in_all_modes(gait))));
    let family = FAMILIES.map(|gait| (gait, Derived::of_family(gait)));
    for (gait, d) in robot.into_iter().chain(family) {
        let mut number = 0u32;
        let mut next = || {
            number += 1;
            2.0 * (f64::from(number) * 0.618_033_988_749_894_9).fract() - 1.0
        };
        let mut worst = 0.0f64;
        for kernel in &d.kernels {
            let program = Program::new(&d.model.ring, kernel);
            let mut draw = |i: &Input| i.symbols.iter().map(|_| next()).collect();
            let inputs: Vec<Vec<f64>> =
                kernel.inputs.iter().map(|i| d.of_robot(i.name).unwrap_or_else(|| draw(i))).collect();
            let arrays: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
            let direct = d.run(&kernel.name, &arrays);
            for (output, found) in kernel.outputs.iter().zip(program.evaluate(&inputs)) {
                let expected = direct.get(output.name);
                let scale = expected.iter().fold(1.0f64, |s, x| s.max(x.abs()));
                for (f, e) in found.iter().zip(expected) {
                    let error = (f - e).abs() / scale;
                    worst = worst.max(error);
                    assert!(error <= 1e-12, "{gait} {} {}: {f}, expected {e}, scale {scale}", kernel.name, output.name);
                }
            }
        }
        println!("{gait}: {worst:.1e}");
    }
}

/// Those of the first robot. `BLESS=1 cargo test -p piaffe-codegen --test laws` accepts new counts.
#[test]
fn operation_counts_are_pinned() {
    let mut table = String::from("# gait kernel: additions and multiplications, divisions, pairs of sine and cosine\n");
    for gait in GAITS.into_iter().filter(|gait| !gait.contains('/')) {
        let d = Derived::new(&in_all_modes(gait));
        for kernel in &d.kernels {
            let o = Program::new(&d.model.ring, kernel).operations();
            writeln!(table, "{gait} {}: {} {} {}", kernel.name, o.flops, o.divisions, o.sincos).unwrap();
            // Where the platform turns with β, the loop over β is a pendulum.
            if kernel.name.starts_with("late") && !kernel.name.contains("gradient") && gait != "trot" {
                assert!(o.flops <= 8 && o.sincos == 1 && o.divisions == 0, "{gait} {}: {o:?}", kernel.name);
            }
        }
    }
    let (ring, kernels) = whole_kernels(&Whole::new(&specification("trot").0));
    for kernel in &kernels {
        let o = Program::new(&ring, kernel).operations();
        writeln!(table, "whole {}: {} {} {}", kernel.name, o.flops, o.divisions, o.sincos).unwrap();
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/operations.txt");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path, &table).unwrap();
    }
    let expected = std::fs::read_to_string(path).unwrap_or_default();
    let changed: Vec<String> = table
        .lines()
        .zip(expected.lines().chain(std::iter::repeat("")))
        .filter(|(new, old)| new != old)
        .map(|(new, old)| format!("{new}   (was {old})"))
        .collect();
    assert!(table == expected, "operation counts changed; BLESS=1 accepts them:\n{}", changed.join("\n"));
}
