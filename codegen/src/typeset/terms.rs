//! Terms as a person writes them: coefficients together, and sines and cosines of sums and differences.

use crate::expr::{Kind, Monomial, Poly, Ring, Var};

/// `coefficient · monomial · waves`.
pub struct Term {
    pub coefficient: Poly,
    pub monomial: Monomial,
    pub waves: Vec<Wave>,
}

/// Sine or cosine of the sum or difference of two angles, each a sum of coordinates.
pub struct Wave {
    pub sine: bool,
    pub difference: bool,
    pub angles: [Vec<Var>; 2],
    /// The coordinates whose sum the difference is, where one angle contains the other.
    pub between: Option<Vec<Var>>,
}

/// The terms of an expression, by what moves; products of sines and cosines that are those of a sum or a
/// difference become it.
pub fn gathered(ring: &Ring, p: &Poly) -> Vec<Term> {
    let terms = ring.by_motion(p).into_iter();
    let mut terms: Vec<Term> =
        terms.map(|(monomial, coefficient)| Term { coefficient, monomial, waves: Vec::new() }).collect();
    let mut k = 0;
    while k < terms.len() {
        if let Some((partner, term)) = addition(ring, &terms, k) {
            terms[k] = term;
            terms.remove(partner);
        }
        k += 1;
    }
    terms
}

/// Term `k` and a later one as one, by an addition theorem.
fn addition(ring: &Ring, terms: &[Term], k: usize) -> Option<(usize, Term)> {
    let term = &terms[k];
    let waves: Vec<usize> = (0..term.monomial.len()).filter(|i| is_wave(term.monomial[*i])).collect();
    for (n, &i) in waves.iter().enumerate() {
        for &j in &waves[n + 1..] {
            let (a, b) = (term.monomial[i], term.monomial[j]);
            let (Some(other_a), Some(other_b)) = (ring.conjugate(a), ring.conjugate(b)) else { continue };
            let mut wanted = term.monomial.clone();
            (wanted[i], wanted[j]) = (other_a, other_b);
            wanted.sort();
            let negative = term.coefficient.scaled(-1.0);
            let fits = |t: &Term| {
                let equal = t.coefficient.is_close_to(&term.coefficient);
                t.waves.is_empty() && t.monomial == wanted && (equal || t.coefficient.is_close_to(&negative))
            };
            let Some(partner) = (k + 1..terms.len()).find(|p| fits(&terms[*p])) else { continue };
            let equal = terms[partner].coefficient.is_close_to(&term.coefficient);
            // cos a cos b ± sin a sin b = cos(a ∓ b); sin a cos b ± cos a sin b = sin(a ± b).
            let sine = a.is_sin() != b.is_sin();
            let cosines_first = a.is_cos();
            let flip = |p: &Poly, flip: bool| if flip { p.scaled(-1.0) } else { p.clone() };
            let (first, second) = if a.is_sin() || !sine { (a, b) } else { (b, a) };
            let difference = equal != sine;
            let angles = [angle(ring, first), angle(ring, second)];
            let only = |a: &[Var], b: &[Var]| a.iter().copied().filter(|v| !b.contains(v)).collect::<Vec<_>>();
            let (plus, minus) = (only(&angles[0], &angles[1]), only(&angles[1], &angles[0]));
            // The sine of −x is −sin x.
            let backward = difference && plus.is_empty();
            let between = (difference && (plus.is_empty() || minus.is_empty())).then(|| [plus, minus].concat());
            let coefficient = flip(&term.coefficient, !sine && !cosines_first && !equal);
            let coefficient = flip(&coefficient, sine && backward);
            let mut monomial = term.monomial.clone();
            monomial.remove(j);
            monomial.remove(i);
            let wave = Wave { sine, difference, angles, between };
            return Some((partner, Term { coefficient, monomial, waves: vec![wave] }));
        }
    }
    None
}

fn is_wave(v: Var) -> bool {
    v.is_sin() || v.is_cos()
}

fn angle(ring: &Ring, v: Var) -> Vec<Var> {
    match ring.kind(v) {
        Kind::Sin(angle) | Kind::Cos(angle) => angle,
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Sines and cosines of sums and differences, both ways round, have the value of the products that they replace.
    #[test]
    fn gathered_terms_have_the_same_value() {
        let mut ring = Ring::new();
        let [a, ..] = ring.coordinate("a");
        let [b, ..] = ring.coordinate("b");
        let values = BTreeMap::from([(a, 0.4), (b, 1.1)]);
        let (sa, ca) = ring.sin_cos(&[a]);
        let (sab, cab) = ring.sin_cos(&[a, b]);
        let (sb, cb) = ring.sin_cos(&[b]);
        for (first, second) in [((&sa, &ca), (&sab, &cab)), ((&sab, &cab), (&sa, &ca)), ((&sa, &ca), (&sb, &cb))] {
            for sign in [2.0, -2.0] {
                let even = &(first.1 * second.1).scaled(2.0) + &(first.0 * second.0).scaled(sign);
                let odd = &(first.0 * second.1).scaled(-2.0) + &(first.1 * second.0).scaled(sign);
                for p in [even, odd] {
                    let terms = gathered(&ring, &p);
                    assert_eq!((terms.len(), terms[0].waves.len(), terms[0].monomial.len()), (1, 1, 0));
                    let wave = &terms[0].waves[0];
                    let [x, y] = wave.angles.each_ref().map(|angle| angle.iter().map(|v| values[v]).sum::<f64>());
                    let argument = match &wave.between {
                        Some(between) => between.iter().map(|v| values[v]).sum::<f64>(),
                        None => x + if wave.difference { -y } else { y },
                    };
                    let wave = if wave.sine { argument.sin() } else { argument.cos() };
                    let found = terms[0].coefficient.as_constant().unwrap() * wave;
                    assert!((found - ring.evaluate(&p, &values)).abs() < 1e-14);
                }
            }
        }
    }
}
