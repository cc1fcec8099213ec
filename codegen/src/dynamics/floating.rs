//! The floating model in X = [p, q]: A, H (eq. 5), feet (eq. 2–4), energies, angular momentum.

use super::kernel::Kernel;
use super::model::{Model, Origin, scaled};
use crate::expr::{Poly, add, cross, dot, subtract};
use crate::spec::Rotation;

/// World axis along which σ is taken: Zf, or Xf for a rolling gait.
pub fn momentum_axis(rotation: Rotation) -> usize {
    if rotation == Rotation::Roll { 0 } else { 2 }
}

pub fn kernels(model: &mut Model) -> Vec<Kernel> {
    let all = model.coordinates.all();
    let (x, xd, xdd) = (model.x(0), model.x(1), model.x(2));
    let q = model.q(0);

    let forces = model.generalized_forces(Origin::World, &all);
    let inertia = model.jacobian(&forces, &xdd);
    let bias: Vec<Poly> = forces.iter().map(|f| model.without(f, &xdd)).collect();

    let mut kernels = vec![
        Kernel::new("inertia", "Inertia matrix A(q) of eq. 5, symmetric positive definite, in kg, kg·m and kg·m².")
            .input("q", q.clone())
            .matrix("a", inertia.clone(), "A"),
        Kernel::new("bias", "Velocity and gravity terms H(q, q̇) of eq. 5, in N and N·m.")
            .input("q", q.clone())
            .input("qd", model.q(1))
            .vector("h", bias.clone(), "H"),
        Kernel::new("inertia_and_bias", "A(q) and H(q, q̇) of eq. 5 together: they share most of their work.")
            .input("q", q.clone())
            .input("qd", model.q(1))
            .matrix("a", inertia, "A")
            .vector("h", bias, "H")
            .batched(),
        energy(model).input("x", x.clone()).input("xd", xd.clone()),
    ];
    let com = model.centre_of_mass(Origin::World);
    let com_rate = model.rate(&com);
    kernels.push(
        Kernel::new("centre_of_mass", "Mass centre of the whole robot and its velocity, world axes, m and m/s.")
            .input("x", x.clone())
            .input("xd", xd.clone())
            .vector("position", model.components(&com), "position")
            .vector("velocity", model.components(&com_rate), "velocity"),
    );

    for leg in 0..2 {
        let foot = add(&model.platform(), &model.foot(leg));
        let position = model.components(&foot);
        // D = (∂d/∂X)ᵀ, one column per component.
        let by_component = model.jacobian(&position, &x);
        let jacobian = (0..x.len()).map(|i| by_component.iter().map(|row| row[i].clone()).collect()).collect();
        let velocity = model.rate(&foot);
        let acceleration = model.rate(&velocity);
        let foot_bias = model.components(&acceleration).iter().map(|a| model.without(a, &xdd)).collect();
        kernels.push(
            Kernel::of_leg(leg, "foot", "Position d of the foot (eq. 2), world axes, m.")
                .input("x", x.clone())
                .vector("d", position, "d"),
        );
        kernels.push(
            Kernel::of_leg(leg, "foot_jacobian", "D = (∂d/∂X)ᵀ of eq. 3, one row per coordinate: ḋ = DᵀẊ.")
                .input("q", q.clone())
                .matrix("d", jacobian, "D"),
        );
        kernels.push(
            Kernel::of_leg(leg, "foot_bias", "Velocity terms of the foot's acceleration (eq. 4): d̈ = DᵀẌ + Hᵢ, m/s².")
                .input("q", q.clone())
                .input("qd", model.q(1))
                .vector("h", foot_bias, "Hᵢ"),
        );
        let momentum = angular_momentum(model, leg);
        kernels.push(
            Kernel::of_leg(
                leg,
                "angular_momentum",
                "Angular momentum σ of the whole robot about the foot's position, absolute velocities, kg·m²/s.",
            )
            .input("x", x.clone())
            .input("xd", xd.clone())
            .scalar("sigma", momentum, "σ"),
        );
    }
    kernels
}

fn energy(model: &mut Model) -> Kernel {
    let (mut kinetic, mut potential) = (Poly::zero(), Poly::zero());
    for (b, centre) in model.centres(Origin::World).iter().enumerate() {
        let body = model.kinematics.bodies[b].clone();
        let velocity = model.rate(centre);
        let spin = model.kinematics.bodies[b].place.spin.clone();
        kinetic += &(&dot(&velocity, &velocity).scaled(0.5) * &body.mass);
        kinetic += &dot(&spin, &scaled(&spin, &body.inertia)).scaled(0.5);
        potential += &(&(&centre[1] * &body.mass) * &model.quantities.gravity);
    }
    for (inertia, symbols) in model.quantities.rotor_inertia.iter().zip(&model.coordinates.q) {
        let rate = Poly::from(symbols[1]);
        kinetic += &(&(&rate * &rate).scaled(0.5) * inertia);
    }
    Kernel::new("energy", "Kinetic energy and potential energy (zero at y = 0), J.")
        .scalar("kinetic", kinetic, "T")
        .scalar("potential", potential, "V")
}

/// σ about the foot of `leg`, from positions and absolute velocities.
fn angular_momentum(model: &mut Model, leg: usize) -> Poly {
    let axis = momentum_axis(model.mechanism.rotation);
    let foot = add(&model.platform(), &model.foot(leg));
    let mut sigma = Poly::zero();
    for (b, centre) in model.centres(Origin::World).iter().enumerate() {
        let body = model.kinematics.bodies[b].clone();
        let arm = subtract(centre, &foot);
        let velocity = model.rate(centre);
        sigma += &(&cross(&arm, &velocity)[axis] * &body.mass);
        // Spin about the axis in world terms: the partial spin of a turn of the whole robot about it.
        sigma += &spin_momentum(model, b, axis);
    }
    sigma
}

/// Component along the world `axis` of the spin momentum of body `b`.
fn spin_momentum(model: &Model, b: usize, axis: usize) -> Poly {
    let spin = &model.kinematics.bodies[b].place.spin;
    let angular = scaled(spin, &model.kinematics.bodies[b].inertia);
    // The axis in the body's axes is the partial spin of the platform's rotation about it. In a
    // level gait all bodies turn about it.
    match model.coordinates.q.get(model.mechanism.joints.len()) {
        Some(theta) => dot(&[0, 1, 2].map(|i| model.ring.derivative(&spin[i], theta[1])), &angular),
        None => angular[axis].clone(),
    }
}
