//! The equations that a person wants to read: eq. 2–5, 8 and 9, as they are derived.

use super::floating;
use super::kernel::Kernel;
use super::model::Model;
use super::turn::Turn;
use crate::expr::Poly;
use crate::mechanism::Mode;

/// An equation: its left-hand side as LaTeX, its right-hand side, and what it is.
pub struct Equation {
    pub left: String,
    pub right: Poly,
}

/// Equations that belong together.
pub struct Section {
    pub title: String,
    pub equations: Vec<Equation>,
}

/// The closed forms of a gait, section by section.
pub fn closed_forms(model: &mut Model) -> Vec<Section> {
    let kernels = floating::kernels(model);
    let values = |kernel: &str| -> Vec<Poly> {
        let found = kernels.iter().find(|k: &&Kernel| k.name == kernel);
        let output = found.and_then(|k| k.outputs.first()).unwrap_or_else(|| panic!("no kernel `{kernel}` is derived"));
        output.values.clone()
    };
    let n = model.x(0).len();
    let upper = values("inertia").into_iter().enumerate().filter(|(i, _)| i / n <= i % n);
    let mut sections = vec![
        section(
            "Inertia matrix $A$ (eq. 5), symmetric",
            upper.map(|(i, p)| (format!("A_{{{},{}}}", i / n + 1, i % n + 1), p)),
        ),
        section("Velocity and gravity terms $H$ (eq. 5)", numbered("H", values("bias"))),
    ];
    for leg in 0..2 {
        let i = leg + 1;
        let name = |what: &str| format!("{what}{i}");
        let c = values(&name("foot")).len();
        let jacobian = values(&name("foot_jacobian")).into_iter().enumerate();
        let mut foot: Vec<(String, Poly)> = numbered(&format!("d^{{{i}}}"), values(&name("foot"))).collect();
        foot.extend(jacobian.map(|(k, p)| (format!("D^{{{i}}}_{{{},{}}}", k / c + 1, k % c + 1), p)));
        foot.extend(numbered(&format!("H^{{{i}}}"), values(&name("foot_bias"))));
        sections.push(section(&format!("Foot of leg {i} (eq. 2--4)"), foot.into_iter()));
    }
    for leg in 0..2 {
        let turn = Turn::new(model, Mode::Stance(leg));
        let terms = [(r"f_1", turn.f1), (r"f_2", turn.f2), (r"c", turn.c), (r"\dot\sigma", turn.gravity_moment)];
        let title = format!(r"Support on leg {}: $\sigma = f_1\dot\beta + f_2$ (eq. 8, 9)", leg + 1);
        sections.push(section(&title, terms.into_iter().map(|(left, p)| (left.to_string(), p))));
    }
    sections
}

fn section(title: &str, equations: impl Iterator<Item = (String, Poly)>) -> Section {
    let equations = equations.filter(|(_, p)| !p.is_zero());
    Section { title: title.into(), equations: equations.map(|(left, right)| Equation { left, right }).collect() }
}

fn numbered(name: &str, values: Vec<Poly>) -> impl Iterator<Item = (String, Poly)> {
    values.into_iter().enumerate().map(move |(k, p)| (format!("{name}_{{{}}}", k + 1), p))
}
