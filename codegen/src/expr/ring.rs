//! The ring of expressions of one model: its atoms, what they mean, and calculus on them.
//!
//! Atoms are symbols (coordinates, rates, inputs), `sin`/`cos` of an *angle* (a sum of coordinates:
//! the absolute angles of the mechanism), and *bound* atoms, which stand for a defined value.

use super::laws::OF_SUMS_OF_ANGLES;
use super::poly::{Monomial, Poly, Terms, Var, times};
use crate::math::sin_cos;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

/// What an atom stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// An input.
    Symbol(String),
    /// Cosine of the sum of these coordinates.
    Cos(Vec<Var>),
    /// Sine of the sum of these coordinates.
    Sin(Vec<Var>),
    /// The value of an expression.
    Bound(Poly),
    /// One over the value of an expression.
    Reciprocal(Poly),
}

/// The atoms of one model.
#[derive(Debug, Default)]
pub struct Ring {
    plain: Vec<Kind>,
    angles: Vec<Vec<Var>>,
    /// Parameters and what is defined by them alone: known before anything moves.
    fixed: BTreeSet<Var>,
    /// Coordinate or rate → its time derivative.
    rates: BTreeMap<Var, Var>,
    /// Memo of sums of symbols (rates of angles), so that each is bound once.
    sums: BTreeMap<Vec<Var>, Var>,
    /// Memo of derivatives of bound atoms, by the atoms' indices.
    derivatives: Mutex<Vec<Vec<(Var, Poly)>>>,
}

impl Ring {
    pub fn new() -> Ring {
        Ring::default()
    }

    pub fn symbol(&mut self, name: impl Into<String>) -> Var {
        self.push(Kind::Symbol(name.into()))
    }

    /// A symbol that is known before anything moves.
    pub fn parameter(&mut self, name: impl Into<String>) -> Var {
        let parameter = self.symbol(name);
        self.fixed.insert(parameter);
        parameter
    }

    /// Whether the value of an expression follows from parameters alone.
    pub fn is_fixed(&self, p: &Poly) -> bool {
        p.terms().all(|(m, _)| m.iter().all(|v| self.fixed.contains(v)))
    }

    /// A coordinate with its rate and acceleration: symbols `name`, `name_d`, `name_dd`.
    pub fn coordinate(&mut self, name: &str) -> [Var; 3] {
        let q = self.symbol(name);
        let qd = self.symbol(format!("{name}_d"));
        let qdd = self.symbol(format!("{name}_dd"));
        self.rates.insert(q, qd);
        self.rates.insert(qd, qdd);
        [q, qd, qdd]
    }

    /// A speed that is no coordinate's rate, with its derivative: symbols `name`, `name_d`.
    pub fn speed(&mut self, name: &str) -> [Var; 2] {
        let u = self.symbol(name);
        let ud = self.symbol(format!("{name}_d"));
        self.rates.insert(u, ud);
        [u, ud]
    }

    fn push(&mut self, kind: Kind) -> Var {
        let atom = Var::plain(self.plain.len());
        if let Kind::Bound(definition) | Kind::Reciprocal(definition) = &kind
            && self.is_fixed(definition)
        {
            self.fixed.insert(atom);
        }
        self.plain.push(kind);
        atom
    }

    /// An atom for the value of `definition` (the atom or constant itself where it already is one).
    pub fn bind(&mut self, definition: Poly) -> Poly {
        if definition.len() <= 1 && definition.terms().all(|(m, _)| m.len() <= 1) {
            return definition;
        }
        self.push(Kind::Bound(definition)).into()
    }

    /// An atom for `1 / definition`.
    pub fn reciprocal(&mut self, definition: Poly) -> Poly {
        match definition.as_constant() {
            Some(c) if c != 0.0 => Poly::constant(1.0 / c),
            _ => self.push(Kind::Reciprocal(definition)).into(),
        }
    }

    /// `(sin, cos)` of the sum of `coordinates`.
    pub fn sin_cos(&mut self, coordinates: &[Var]) -> (Poly, Poly) {
        if coordinates.is_empty() {
            return (Poly::zero(), Poly::constant(1.0));
        }
        let angle = self.angle(coordinates);
        (Var::sin(angle).into(), Var::cos(angle).into())
    }

    fn angle(&mut self, coordinates: &[Var]) -> usize {
        let mut sorted = coordinates.to_vec();
        sorted.sort();
        self.angles.iter().position(|a| *a == sorted).unwrap_or_else(|| {
            self.angles.push(sorted);
            self.angles.len() - 1
        })
    }

    /// The sum of `symbols` as one atom (the rate of an angle, say).
    pub fn sum(&mut self, symbols: &[Var]) -> Poly {
        match symbols {
            [] => Poly::zero(),
            [one] => (*one).into(),
            _ => {
                let mut sorted = symbols.to_vec();
                sorted.sort();
                if let Some(var) = self.sums.get(&sorted) {
                    return (*var).into();
                }
                let mut definition = Poly::zero();
                for s in &sorted {
                    definition += &(*s).into();
                }
                let var = self.push(Kind::Bound(definition));
                self.sums.insert(sorted, var);
                var.into()
            }
        }
    }

    pub fn kind(&self, var: Var) -> Kind {
        if var.is_sin() {
            Kind::Sin(self.angles[var.index()].clone())
        } else if var.is_cos() {
            Kind::Cos(self.angles[var.index()].clone())
        } else {
            self.plain[var.index()].clone()
        }
    }

    /// The time derivative of a coordinate or rate.
    pub fn rate_of(&self, var: Var) -> Option<Var> {
        self.rates.get(&var).copied()
    }

    /// Exact partial derivative with respect to a symbol; bound atoms are differentiated through.
    pub fn derivative(&self, p: &Poly, by: Var) -> Poly {
        product_rule(p, |atom, found| {
            if atom == by {
                found(&[], 1.0);
            } else if let Some((conjugate, sign)) = self.slope(atom) {
                if self.angles[atom.index()].contains(&by) {
                    found(&[conjugate], sign);
                }
            } else if !matches!(self.plain[atom.index()], Kind::Symbol(_)) {
                self.with_inner_derivative(atom, by, |inner| inner.terms().for_each(|(m, c)| found(m, c)));
            }
        })
    }

    /// The derivative of a sine or cosine by its angle: an atom and its sign.
    fn slope(&self, atom: Var) -> Option<(Var, f64)> {
        self.conjugate(atom).map(|conjugate| (conjugate, if atom.is_sin() { 1.0 } else { -1.0 }))
    }

    /// The derivative of a bound atom.
    fn with_inner_derivative(&self, atom: Var, by: Var, then: impl FnOnce(&Poly)) {
        if let Ok(known) = self.derivatives.lock()
            && let Some(of_atom) = known.get(atom.index())
            && let Some((_, known)) = of_atom.iter().find(|(symbol, _)| *symbol == by)
        {
            return then(known);
        }
        let result = match &self.plain[atom.index()] {
            Kind::Bound(definition) => self.derivative(definition, by),
            Kind::Reciprocal(definition) => {
                let r = Poly::from(atom);
                &(&r * &r).scaled(-1.0) * &self.derivative(definition, by)
            }
            _ => Poly::zero(),
        };
        then(&result);
        if let Ok(mut known) = self.derivatives.lock() {
            let atoms = known.len().max(atom.index() + 1);
            known.resize_with(atoms, Vec::new);
            known[atom.index()].push((by, result));
        }
    }

    /// d/dt of an expression in coordinates and rates (each coordinate's rate replaces its derivative).
    pub fn time_derivative(&mut self, p: &Poly) -> Poly {
        product_rule(p, |atom, found| self.atom_rate(atom).terms().for_each(|(m, c)| found(m, c)))
    }

    fn atom_rate(&mut self, atom: Var) -> Poly {
        if let Some((conjugate, sign)) = self.slope(atom) {
            let rates: Vec<Var> = self.angles[atom.index()].iter().filter_map(|q| self.rate_of(*q)).collect();
            return &Poly::from(conjugate).scaled(sign) * &self.sum(&rates);
        }
        if let Some(rate) = self.rate_of(atom) {
            return rate.into();
        }
        match self.plain[atom.index()].clone() {
            // Sums of coordinates or rates stay sums: α̇ = Σ q̇ becomes the atom α̈ = Σ q̈.
            Kind::Bound(definition) if definition.terms().all(|(m, c)| m.len() == 1 && c == 1.0) => {
                let rates: Vec<Var> = definition.terms().filter_map(|(m, _)| self.rate_of(m[0])).collect();
                self.sum(&rates)
            }
            Kind::Bound(definition) => self.time_derivative(&definition),
            _ => Poly::zero(),
        }
    }

    /// Replaces atoms by expressions. Sums of symbols (rates) are rebuilt from their replaced parts.
    pub fn substitute(&mut self, p: &Poly, map: &BTreeMap<Var, Poly>) -> Poly {
        let mut result = Terms::with_capacity(p.len());
        for (m, mut c) in p.terms() {
            let (mut kept, mut terms, mut sums) = (Monomial::new(), Monomial::new(), Vec::new());
            for &factor in m {
                match self.substitute_atom(factor, map) {
                    None => kept.push(factor),
                    Some(replacement) => match replacement.as_term() {
                        Some((monomial, coefficient)) => {
                            terms = times(&terms, monomial);
                            c *= coefficient;
                        }
                        None => sums.push(replacement),
                    },
                }
            }
            let kept = if terms.is_empty() { kept } else { times(&kept, &terms) };
            if sums.is_empty() {
                result.add(kept, c);
                continue;
            }
            let product = sums.iter().fold(Poly::term(kept, c), |product, sum| &product * sum);
            product.terms().for_each(|(m, c)| result.add(Monomial::from_slice(m), c));
        }
        result.collected()
    }

    /// What takes the place of an atom, if anything does.
    fn substitute_atom<'m>(&mut self, atom: Var, map: &'m BTreeMap<Var, Poly>) -> Option<Cow<'m, Poly>> {
        if let Some(replacement) = map.get(&atom) {
            return Some(Cow::Borrowed(replacement));
        }
        if atom.is_sin() || atom.is_cos() {
            return None;
        }
        let Kind::Bound(definition) = &self.plain[atom.index()] else { return None };
        if !definition.terms().any(|(m, _)| m.iter().any(|v| map.contains_key(v))) {
            return None;
        }
        let definition = definition.clone();
        let replaced = self.substitute(&definition, map);
        // A sum of symbols with some of them dropped is again a sum of symbols.
        if replaced.terms().all(|(m, c)| m.len() == 1 && c == 1.0) {
            let symbols: Vec<Var> = replaced.terms().map(|(m, _)| m[0]).collect();
            return Some(Cow::Owned(self.sum(&symbols)));
        }
        Some(Cow::Owned(self.bind(replaced)))
    }

    /// Splits every angle that contains `late`: `sin(late + rest)` becomes a sum of products.
    ///
    /// After it, expressions that do not depend on `late` no longer contain it: the ring's law
    /// `sin² + cos² = 1` cancels it.
    pub fn split_angles(&mut self, p: &Poly, late: Var) -> Poly {
        let mut map = BTreeMap::new();
        for angle in 0..self.angles.len() {
            if !self.angles[angle].contains(&late) || self.angles[angle].len() == 1 {
                continue;
            }
            let rest: Vec<Var> = self.angles[angle].iter().copied().filter(|v| *v != late).collect();
            let (first, second) = (self.sin_cos(&[late]), self.sin_cos(&rest));
            for (law, atom) in OF_SUMS_OF_ANGLES.iter().zip([Var::sin(angle), Var::cos(angle)]) {
                map.insert(atom, (law.holds)([&first.0, &first.1], [&second.0, &second.1]));
            }
        }
        self.substitute(p, &map)
    }

    /// What a bound atom stands for, or one over.
    pub fn definition(&self, atom: Var) -> Option<Poly> {
        match self.kind(atom) {
            Kind::Bound(definition) | Kind::Reciprocal(definition) => Some(definition),
            _ => None,
        }
    }

    /// Replaces the definition of a bound atom by an equal expression.
    pub fn redefine(&mut self, atom: Var, equal: Poly) {
        if !atom.is_sin()
            && !atom.is_cos()
            && let Kind::Bound(definition) | Kind::Reciprocal(definition) = &mut self.plain[atom.index()]
        {
            *definition = equal;
            self.derivatives = Mutex::default();
        }
    }

    /// Groups an expression by its factors among the atoms for which `late` holds: `Σ late · early`.
    pub fn staged(&self, p: &Poly, late: impl Fn(Var) -> bool) -> BTreeMap<Monomial, Poly> {
        let mut groups: BTreeMap<Monomial, Terms> = BTreeMap::new();
        for (m, c) in p.terms() {
            let (l, e): (Monomial, Monomial) = m.iter().copied().partition(|v| late(*v));
            groups.entry(l).or_default().add(e, c);
        }
        groups.into_iter().map(|(late, early)| (late, early.collected())).collect()
    }

    /// Groups an expression by what moves: `Σ moving · fixed`.
    pub fn by_motion(&self, p: &Poly) -> BTreeMap<Monomial, Poly> {
        self.staged(p, |v| !self.fixed.contains(&v))
    }

    /// The sine for a cosine and the cosine for a sine, of the same angle.
    pub fn conjugate(&self, atom: Var) -> Option<Var> {
        match (atom.is_sin(), atom.is_cos()) {
            (true, _) => Some(Var::cos(atom.index())),
            (_, true) => Some(Var::sin(atom.index())),
            _ => None,
        }
    }

    /// Numeric value, for tests: `values` gives the symbols.
    pub fn evaluate(&self, p: &Poly, values: &BTreeMap<Var, f64>) -> f64 {
        self.value(p, &mut values.clone())
    }

    /// Numeric values of many expressions that share bound atoms.
    pub fn evaluate_all<'p>(&self, list: impl IntoIterator<Item = &'p Poly>, values: &BTreeMap<Var, f64>) -> Vec<f64> {
        let mut known = values.clone();
        list.into_iter().map(|p| self.value(p, &mut known)).collect()
    }

    fn value(&self, p: &Poly, known: &mut BTreeMap<Var, f64>) -> f64 {
        p.terms().map(|(m, c)| m.iter().fold(c, |product, v| product * self.atom_value(*v, known))).sum()
    }

    fn atom_value(&self, atom: Var, known: &mut BTreeMap<Var, f64>) -> f64 {
        if let Some(value) = known.get(&atom) {
            return *value;
        }
        let angle = |a: usize, known: &mut BTreeMap<Var, f64>| -> f64 {
            self.angles[a].iter().map(|v| self.atom_value(*v, known)).sum()
        };
        let value = if atom.is_sin() {
            sin_cos(angle(atom.index(), known)).0
        } else if atom.is_cos() {
            sin_cos(angle(atom.index(), known)).1
        } else {
            match &self.plain[atom.index()] {
                Kind::Bound(definition) => self.value(definition, known),
                Kind::Reciprocal(definition) => 1.0 / self.value(definition, known),
                _ => f64::NAN,
            }
        };
        known.insert(atom, value);
        value
    }
}

/// (x y)' = x' y + x y': `slope` hands out the terms of an atom's derivative.
fn product_rule(p: &Poly, mut slope: impl FnMut(Var, &mut dyn FnMut(&[Var], f64))) -> Poly {
    let mut result = Terms::with_capacity(p.len());
    for (m, c) in p.terms() {
        for (position, &factor) in m.iter().enumerate() {
            slope(factor, &mut |inner, d| {
                let mut rest = Monomial::from_slice(m);
                rest.remove(position);
                result.add(if inner.is_empty() { rest } else { times(&rest, inner) }, c * d);
            });
        }
    }
    result.collected()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_passes_through_angles_sums_and_reciprocals() {
        let mut ring = Ring::new();
        let [a, ad, _] = ring.coordinate("a");
        let [b, bd, _] = ring.coordinate("b");
        let (s, c) = ring.sin_cos(&[a, b]);
        let rate = ring.sum(&[ad, bd]);
        let r = ring.reciprocal(&Poly::constant(2.0) + &c);
        let p = &(&s * &(&rate * &rate)) * &r;
        let at = |x: f64, v: f64| {
            let values = BTreeMap::from([(a, x), (b, 0.3), (ad, v), (bd, 0.7)]);
            (
                ring.evaluate(&p, &values),
                ring.evaluate(&ring.derivative(&p, a), &values),
                ring.evaluate(&ring.derivative(&p, ad), &values),
            )
        };
        let h = 1e-6;
        let (_, by_angle, by_rate) = at(0.4, 1.1);
        assert!(((at(0.4 + h, 1.1).0 - at(0.4 - h, 1.1).0) / (2.0 * h) - by_angle).abs() < 1e-8);
        assert!(((at(0.4, 1.1 + h).0 - at(0.4, 1.1 - h).0) / (2.0 * h) - by_rate).abs() < 1e-8);
    }

    #[test]
    fn a_common_rotation_cancels_when_angles_are_split() {
        let mut ring = Ring::new();
        let [t, ..] = ring.coordinate("t");
        let [a, ..] = ring.coordinate("a");
        let [b, ..] = ring.coordinate("b");
        let (s1, c1) = ring.sin_cos(&[t, a]);
        let (s2, c2) = ring.sin_cos(&[t, a, b]);
        let cosine_of_difference = &(&c1 * &c2) + &(&s1 * &s2);
        let split = ring.split_angles(&cosine_of_difference, t);
        let (st, ct) = ring.sin_cos(&[t]);
        let (st, ct) = (st.terms().next().unwrap().0[0], ct.terms().next().unwrap().0[0]);
        assert!(!split.contains(st) && !split.contains(ct));
    }

    #[test]
    fn time_derivative_is_the_chain_rule() {
        let mut ring = Ring::new();
        let [a, ad, add] = ring.coordinate("a");
        let [b, bd, bdd] = ring.coordinate("b");
        let (s, _) = ring.sin_cos(&[a, b]);
        let v = ring.time_derivative(&s);
        let acc = ring.time_derivative(&v);
        let values = BTreeMap::from([(a, 0.2), (b, 0.5), (ad, 1.5), (bd, -0.4), (add, 2.0), (bdd, 3.0)]);
        let (angle, rate, acceleration) = (0.7f64, 1.1, 5.0);
        assert!((ring.evaluate(&v, &values) - angle.cos() * rate).abs() < 1e-14);
        assert!(
            (ring.evaluate(&acc, &values) - (angle.cos() * acceleration - angle.sin() * rate * rate)).abs() < 1e-14
        );
    }
}
