//! The closed forms of a gait as a LaTeX document, with the names of the robot's parameters.

use super::terms::{Term, gathered};
use crate::dynamics::{Model, closed_forms};
use crate::expr::{Kind, Monomial, Poly, Var};
use crate::mechanism::{Actuated, Family, Mechanism, Parameter, parameters};
use crate::spec::{Gait, Link, Robot};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Width of a line of an equation, in characters as set.
const WIDTH: usize = 90;

/// Sums of parameters with more terms than this get a name.
const LONG: usize = 2;

/// Symbols and angles as they are written.
pub struct Notation<'m> {
    model: &'m Model,
    symbols: BTreeMap<Var, String>,
    /// Coordinates whose sum is φ₁, φ₂, …
    angles: Vec<Vec<Var>>,
    /// What k₁, k₂, … stand for: long sums of parameters.
    lumps: RefCell<Vec<Poly>>,
}

/// The document of one gait. Where the numbers of its `mechanism` are no sums of the robot's, as those of a link with its
/// foot, they stand there as numbers.
pub fn latex(robot: &Robot, gait: &Gait, mechanism: &Mechanism) -> String {
    let with_foot = |link: &&Link| link.foot_mass != 0.0;
    let links = robot.legs.iter().flat_map(|leg| &leg.chain).map(|segment| &segment.link).filter(with_foot);
    let with_foot: BTreeSet<String> = links.map(|link| format!("links.{}.", link.name)).collect();
    let mut chosen = parameters(robot);
    chosen.retain(|p| !with_foot.iter().any(|link| p.name.starts_with(link)));
    let family = Family::new(robot, gait, chosen).ok();
    let mut model = match &family {
        Some(family) => Model::of_family(family),
        None => Model::new(mechanism),
    };
    let sections = closed_forms(&mut model);
    let chosen = family.map(|f| f.parameters).unwrap_or_default();
    let all = sections.iter().flat_map(|s| &s.equations).map(|e| &e.right);
    let notation = Notation::new(&model, &chosen, all);
    let mut text = format!(
        "\\documentclass{{article}}\n\\usepackage[a4paper,margin=18mm]{{geometry}}\n\\usepackage{{amsmath}}\n\
         \\allowdisplaybreaks\n\\begin{{document}}\n\\section*{{The {} of the {}}}\n",
        escaped(&gait.name),
        escaped(&robot.name)
    );
    let mut body = String::new();
    for section in &sections {
        let equations: Vec<String> = section.equations.iter().map(|e| notation.equation(&e.left, &e.right)).collect();
        body += &aligned(&section.title, &equations);
    }
    notation.preface(&mut text, &chosen);
    let lumps = notation.lumps.borrow();
    let named: Vec<String> = lumps.iter().enumerate().map(|(k, p)| notation.definition(k, p)).collect();
    if !named.is_empty() {
        text += &aligned("Sums of parameters", &named);
    }
    text += &body;
    text += &motors(mechanism);
    text + "\\end{document}\n"
}

/// What motors give where joints have springs or rub, N·m; nothing where none does.
fn motors(mechanism: &Mechanism) -> String {
    let motor = |(k, joint): (usize, &Actuated)| {
        let (q, sign) = (format!("\\dot q_{{{}}}", k + 1), "\\operatorname{sign}");
        let spring = (joint.stiffness != 0.0).then(|| {
            let from = if joint.rest < 0.0 { "+" } else { "-" };
            format!("{}\\,(q_{{{}}} {from} {})", number(joint.stiffness), k + 1, number(joint.rest.abs()))
        });
        let viscous = (joint.damping != 0.0).then(|| format!("{}\\,{q}", number(joint.damping)));
        let dry = (joint.coulomb != 0.0).then(|| format!("{}\\,{sign} {q}", number(joint.coulomb)));
        let overcomes = spring.is_some() || viscous.is_some() || dry.is_some();
        let terms = [Some(format!("\\Gamma_{{{}}}", k + 1)), spring, viscous, dry].into_iter().flatten();
        overcomes.then(|| lines(&format!("\\Gamma^{{\\mathrm{{motor}}}}_{{{}}}", k + 1), terms))
    };
    let equations: Vec<String> = mechanism.joints.iter().enumerate().filter_map(motor).collect();
    if equations.is_empty() {
        String::new()
    } else {
        aligned("Torques of the motors, with springs and friction", &equations)
    }
}

fn aligned(title: &str, equations: &[String]) -> String {
    format!("\\subsection*{{{title}}}\n\\begin{{align*}}\n{}\n\\end{{align*}}\n", equations.join(" \\\\\n"))
}

impl<'m> Notation<'m> {
    fn new<'p>(model: &'m Model, chosen: &[Parameter], all: impl Iterator<Item = &'p Poly>) -> Notation<'m> {
        let mut symbols: BTreeMap<Var, String> =
            model.parameters.iter().copied().zip(chosen.iter().map(|p| symbol(&p.name))).collect();
        let names = model.mechanism.coordinate_names();
        for (coordinate, name) in model.coordinates.all().iter().zip(&names) {
            let name = match name.strip_prefix('q') {
                Some(number) => format!("q_{{{number}}}"),
                None if name == "theta" => r"\theta".into(),
                None => name.clone(),
            };
            for (atom, accent) in coordinate.iter().zip(["", r"\dot ", r"\ddot "]) {
                symbols.insert(*atom, format!("{accent}{name}"));
            }
        }
        let mut angles = Vec::new();
        for atom in all.flat_map(Poly::terms).flat_map(|(monomial, _)| monomial) {
            if let Kind::Sin(angle) | Kind::Cos(angle) = model.ring.kind(*atom) {
                angles.push(angle);
            }
        }
        angles.sort();
        angles.dedup();
        Notation { model, symbols, angles, lumps: RefCell::default() }
    }

    /// What the symbols mean.
    fn preface(&self, text: &mut String, chosen: &[Parameter]) {
        let m = &self.model.mechanism;
        let list = |atoms: &[Var]| atoms.iter().map(|v| self.atom(*v)).collect::<Vec<_>>().join(", ");
        let beta = self.atom(self.model.unactuated(0));
        let _ = writeln!(text, "Coordinates $X = ({})$, unactuated $\\beta = {beta}$.", list(&self.model.x(0)));
        for (k, leg) in m.legs.iter().enumerate() {
            let members: Vec<String> = leg.members.iter().map(|r| escaped(&r.name)).collect();
            let _ = writeln!(text, "Leg {} stands for {}.", k + 1, members.join(" and "));
        }
        text.push_str(
            "Angles from the vertical, with $S_k = \\sin\\varphi_k$ and $C_k = \\cos\\varphi_k$:\n\\begin{align*}\n",
        );
        let sums = self.angles.iter().enumerate().map(|(k, angle)| {
            let sum: Vec<String> = angle.iter().map(|v| self.atom(*v)).collect();
            format!("\\varphi_{{{}}} &= {}", k + 1, sum.join(" + "))
        });
        let mut lines: Vec<String> = sums.collect();
        let mass = self.model.total_mass();
        lines.push(format!("M &= {}", self.sum(&mass)));
        text.push_str(&lines.join(" \\\\\n"));
        text.push_str("\n\\end{align*}\n");
        if !chosen.is_empty() {
            text.push_str("\\begin{center}\\begin{tabular}{lll}\n");
            for p in chosen {
                let (name, unit) = (escaped(&p.name), p.unit);
                let _ = writeln!(text, "${}$ & \\texttt{{{name}}} & {} {unit} \\\\", symbol(&p.name), p.value);
            }
            text.push_str("\\end{tabular}\\end{center}\n");
        }
    }

    fn equation(&self, left: &str, right: &Poly) -> String {
        let terms = gathered(&self.model.ring, right);
        lines(left, terms.iter().map(|term| self.term(term)))
    }

    fn definition(&self, k: usize, lump: &Poly) -> String {
        let one = |(monomial, c): (&Monomial, f64)| self.sum(&Poly::term(monomial.clone(), c));
        lines(&format!("k_{{{}}}", k + 1), lump.terms().map(one))
    }

    /// `coefficient · what moves`.
    fn term(&self, term: &Term) -> String {
        let moving: Vec<String> = powers(&term.monomial, |v| self.atom(v))
            .into_iter()
            .chain(term.waves.iter().map(|w| self.wave(w)))
            .collect();
        let moving = moving.join(" ");
        match term.coefficient.as_constant() {
            Some(c) if c.abs() == 1.0 && !moving.is_empty() => format!("{}{moving}", if c < 0.0 { "- " } else { "" }),
            _ if moving.is_empty() => self.factored(&term.coefficient),
            _ => format!("{}\\, {moving}", self.factored(&term.coefficient)),
        }
    }

    /// A product of what all terms share and the sum of the rest, which has a sign of its own.
    fn factored(&self, p: &Poly) -> String {
        if p.len() <= 1 {
            return self.sum(p);
        }
        let (shared, rest) = p.common_factors();
        let least = rest.terms().map(|(_, c)| c.abs()).fold(f64::INFINITY, f64::min);
        let even = rest.terms().all(|(_, c)| (c / least).fract() == 0.0);
        // The first term is positive, so that a sum and its negative have one name.
        let sign = rest.terms().next().map_or(1.0, |(_, c)| c.signum());
        let scale = if even { sign * least } else { sign };
        let mut factors = powers(&shared, |v| self.atom(v));
        if scale.abs() != 1.0 {
            factors.insert(0, format!("{}\\,", number(scale.abs())));
        }
        let rest = rest.scaled(1.0 / scale);
        let over_mass = factors.iter().position(|factor| factor == "M^{-1}").filter(|_| self.is_mass(&rest));
        if let Some(k) = over_mass {
            factors.remove(k);
        }
        factors.push(match rest.len() {
            _ if over_mass.is_some() => String::new(),
            _ if self.is_mass(&rest) => "M".into(),
            ..=LONG => format!("\\left({}\\right)", self.sum(&rest)),
            _ => self.lump(rest),
        });
        format!("{}{}", if scale < 0.0 { "- " } else { "" }, factors.join(" "))
    }

    /// The name of a sum of parameters.
    fn lump(&self, p: Poly) -> String {
        let mut lumps = self.lumps.borrow_mut();
        let known = lumps.iter().position(|l| l.is_close_to(&p));
        let number = known.unwrap_or_else(|| {
            lumps.push(p);
            lumps.len() - 1
        });
        format!("k_{{{}}}", number + 1)
    }

    fn is_mass(&self, p: &Poly) -> bool {
        p.len() > 1 && *p == self.model.total_mass()
    }

    fn sum(&self, p: &Poly) -> String {
        let mut text = String::new();
        for (k, (monomial, c)) in p.terms().enumerate() {
            let sign = match (k, c < 0.0) {
                (0, false) => "",
                (0, true) => "- ",
                (_, false) => " + ",
                (_, true) => " - ",
            };
            let factors = powers(monomial, |v| self.atom(v)).join(" ");
            let number = if c.abs() == 1.0 && !factors.is_empty() { String::new() } else { number(c.abs()) };
            let space = if number.is_empty() || factors.is_empty() { "" } else { "\\, " };
            let _ = write!(text, "{sign}{number}{space}{factors}");
        }
        if text.is_empty() { "0".into() } else { text }
    }

    fn wave(&self, wave: &super::terms::Wave) -> String {
        let [a, b] = wave.angles.each_ref().map(|angle| self.angle(angle));
        let argument = match &wave.between {
            Some(sum) if sum.len() == 1 => self.atom(sum[0]),
            Some(sum) => format!("({})", sum.iter().map(|v| self.atom(*v)).collect::<Vec<_>>().join("+")),
            None => format!("({a}{}{b})", if wave.difference { "-" } else { "+" }),
        };
        format!("\\{} {argument}", if wave.sine { "sin" } else { "cos" })
    }

    fn angle(&self, angle: &[Var]) -> String {
        let number = self.angles.iter().position(|a| a == angle).map_or(0, |k| k + 1);
        format!("\\varphi_{{{number}}}")
    }

    fn atom(&self, atom: Var) -> String {
        if let Some(symbol) = self.symbols.get(&atom) {
            return symbol.clone();
        }
        let short = |angle: &[Var], letter: &str| {
            format!("{letter}_{{{}}}", self.angles.iter().position(|a| a == angle).map_or(0, |k| k + 1))
        };
        match self.model.ring.kind(atom) {
            Kind::Symbol(name) => format!("\\mathrm{{{}}}", escaped(&name)),
            Kind::Sin(angle) => short(&angle, "S"),
            Kind::Cos(angle) => short(&angle, "C"),
            Kind::Reciprocal(p) if p == self.model.total_mass() => "M^{-1}".into(),
            Kind::Reciprocal(p) => format!("\\left({}\\right)^{{-1}}", self.sum(&p)),
            Kind::Bound(p) => self.rate(&p).unwrap_or_else(|| format!("\\left({}\\right)", self.sum(&p))),
        }
    }

    /// The rate of one of the angles, if this is one.
    fn rate(&self, p: &Poly) -> Option<String> {
        let of = |angle: &Vec<Var>, order: usize| {
            let mut sum = Poly::zero();
            for coordinate in angle {
                let rate = (0..order).try_fold(*coordinate, |v, _| self.model.ring.rate_of(v))?;
                sum += &rate.into();
            }
            Some(sum)
        };
        [(1, r"\dot"), (2, r"\ddot")].into_iter().find_map(|(order, accent)| {
            let k = self.angles.iter().position(|angle| of(angle, order).as_ref() == Some(p))?;
            Some(format!("{accent}\\varphi_{{{}}}", k + 1))
        })
    }
}

/// An equation from the terms of its right-hand side, with a new line where one is full.
fn lines(left: &str, terms: impl Iterator<Item = String>) -> String {
    let mut text = format!("{left} &=");
    let mut width = 0;
    for (k, mut term) in terms.enumerate() {
        if k > 0 && !term.starts_with('-') {
            term.insert_str(0, "+ ");
        }
        let wide = shown(&term);
        if width > 0 && width + wide > WIDTH {
            text.push_str(" \\\\\n&\\quad {}");
            width = 0;
        }
        width += wide;
        text.push(' ');
        text.push_str(&term);
    }
    text
}

/// Factors with their exponents.
fn powers(monomial: &[Var], write: impl Fn(Var) -> String) -> Vec<String> {
    monomial
        .chunk_by(|a, b| a == b)
        .map(|same| match same.len() {
            1 => write(same[0]),
            n => format!("{{{}}}^{{{n}}}", write(same[0])),
        })
        .collect()
}

/// Characters of a formula as set, more or less: commands are one, braces none.
fn shown(formula: &str) -> usize {
    let mut command = false;
    let mut count = 0;
    for c in formula.replace("\\mathrm", "").replace("\\left", "").replace("\\right", "").chars() {
        count += usize::from(c == '\\' || !(command && c.is_ascii_alphabetic() || "{}_^ ".contains(c)));
        command = c == '\\' || command && c.is_ascii_alphabetic();
    }
    count
}

fn number(value: f64) -> String {
    let rounded = format!("{value:.6e}").parse::<f64>().unwrap_or(value);
    rounded.to_string()
}

fn escaped(name: &str) -> String {
    name.chars().fold(String::new(), |mut text, c| {
        match c {
            '\\' => text.push_str("\\textbackslash{}"),
            '~' => text.push_str("\\textasciitilde{}"),
            '^' => text.push_str("\\textasciicircum{}"),
            '_' | '&' | '%' | '$' | '#' | '{' | '}' => text.extend(['\\', c]),
            _ => text.push(c),
        }
        text
    })
}

/// `links.thigh.mass` → `m_{\mathrm{thigh}}`.
fn symbol(name: &str) -> String {
    let parts: Vec<&str> = name.split('.').collect();
    let of = |letter: &str, owner: &str| format!("{letter}_{{\\mathrm{{{}}}}}", escaped(owner));
    match parts[..] {
        ["links", link, "mass"] => of("m", link),
        ["links", link, "length"] => of("l", link),
        ["links", link, "length", axis] => of(&format!("l^{axis}"), link),
        ["links", link, "com"] => of("a", link),
        ["links", link, "com", axis] => of(&format!("a^{axis}"), link),
        ["links", link, "inertia", "roll" | "lateral"] => of("I^x", link),
        ["links", link, "inertia", "yaw" | "axial"] => of("I^y", link),
        ["links", link, "inertia", "pitch" | "swing"] => of("I^z", link),
        ["links", link, "inertia", "products", axes] => of(&format!("I^{{{axes}}}"), link),
        ["legs", leg, "mount", axis] => of(&format!("h^{axis}"), leg),
        ["actuators", motor, "rotor_inertia"] => of("J", motor),
        ["gravity"] => "g".into(),
        _ => format!("\\mathrm{{{}}}", escaped(name)),
    }
}
