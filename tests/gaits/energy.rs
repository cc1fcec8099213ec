//! The robot's energy, as the generated code has it.

use piaffe::model::Gait;
use piaffe::walk::Moment;

/// Kinetic and potential, J.
pub fn energy(gait: &dyn Gait, m: &Moment) -> f64 {
    let positions = gait.description().positions();
    let [x, xd] = [0, 1].map(|order| [&m.platform[order][..positions], if order == 0 { &m.q } else { &m.qd }].concat());
    let mut out = [0.0; 2];
    gait.energy(&x, &xd, &mut out);
    out[0] + out[1]
}
