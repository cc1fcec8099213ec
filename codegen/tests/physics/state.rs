//! A random state of a mechanism.

use super::robots::Draws;
use piaffe_codegen::mechanism::Mechanism;

/// X = [p, q] with rates and accelerations; `q`, `qd`, `qdd` are the tails.
pub struct State {
    pub x: Vec<f64>,
    pub xd: Vec<f64>,
    pub xdd: Vec<f64>,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
}

impl State {
    pub fn random(m: &Mechanism, draws: &mut Draws) -> State {
        let n = m.positions() + m.orientations();
        let (x, xd, xdd) = (draws.vector(n, 1.0), draws.vector(n, 2.0), draws.vector(n, 5.0));
        let tail = |v: &[f64]| v[m.positions()..].to_vec();
        State { q: tail(&x), qd: tail(&xd), qdd: tail(&xdd), x, xd, xdd }
    }
}
