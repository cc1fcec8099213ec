//! The generated dynamics at one state: `cargo run --release --example dynamics`.

use piaffe::gaits::trot::{self, Trot};
use piaffe::model::{Gait, Mode};

fn main() {
    // Haunch and knee of both virtual legs: rad, rad/s.
    let (q, qd) = ([0.2, -0.6, -0.1, -0.4], [1.0, 0.0, -1.0, 0.5]);

    // As functions over arrays: A and H of eq. 5.
    let found = trot::inertia_and_bias(&q, &qd);
    println!("A = {:.4?}\nH = {:.4?}", found.a, found.h);

    // As a gait like any other: how the joints move if nothing drives them, standing on leg 1.
    let d = Trot.description();
    let torques = vec![0.0; d.independent_torques().count()];
    let shape = &d.shapes.stance.forward;
    let mut out = shape.zeros();
    Trot.forward(Mode::Stance(0), &q, &qd, &torques, &mut out);
    println!("Ẍ = {:.3?}\nF = {:.3?}", shape.xdd.of(&out), shape.f.of(&out));
    for o in d.operations.iter().filter(|o| o.kernel.starts_with("inertia")) {
        println!("{} takes {} operations and {} pairs of sine and cosine", o.kernel, o.flops, o.sincos);
    }
}
