//! What a virtual leg hides: how its real legs share the load (§2.3).
//!
//! The virtual model lets the platform turn about one axis at most. That the real robot does not turn about the others
//! either, the feet have to see to: their forces must have the moment that its motion asks for. In a planar gait
//! of a robot whose pairs are symmetric that moment is zero. Where the platform rolls, the moment about the vertical and
//! about the transverse axis decides how the legs of a side share the reaction.

use super::curvature::second_derivatives;
use super::kernel::{Block, Kernel, Shape};
use super::model::{Model, Origin, scaled};
use crate::expr::{Poly, Var, Vec3, add, cross, dot, rotate, zero};
use crate::mechanism::Mode;
use std::collections::BTreeMap;

/// Kernels for stance on `leg` of a gait whose platform rolls.
pub fn kernels(model: &mut Model, leg: usize) -> Vec<Kernel> {
    let (q, qd, qdd) = (model.q(0), model.q(1), model.q(2));
    let moment = moment(model, leg);
    let levers = levers(model, leg);
    let outputs: Vec<Poly> = moment.iter().chain(levers.iter().flatten()).cloned().collect();
    let by: Vec<Var> = [&q[..], &qd, &qdd].concat();
    let weights: Vec<Var> = (0..outputs.len()).map(|k| model.ring.symbol(format!("w{k}"))).collect();
    let mut sum = Poly::zero();
    for (weight, output) in weights.iter().zip(&outputs) {
        sum += &(&Poly::from(*weight) * output);
    }
    let state = |kernel: Kernel| kernel.input("q", q.clone()).input("qd", qd.clone()).input("qdd", qdd.clone());
    let mut jacobian = model.jacobian(&outputs, &by);
    let lever_rows = jacobian.split_off(moment.len());
    let blocks =
        vec![Block::vector("moment", moment.len()), Block { name: "levers", shape: Shape::Matrix(levers.len(), 3) }];
    let mode = Mode::Stance(leg);
    let values = state(Kernel::of_mode(
        mode,
        "sharing",
        "What decides how the real legs of the stance leg share the load, with its Jacobian in w = (q, q̇, q̈): the moment that \
         their forces must have about the virtual foot, and the foot's place as the leg's joints move it.",
    ))
    .vector("moment", moment.to_vec(), "about the vertical and the transverse axis, N·m")
    .matrix("levers", levers, "∂(foot from the platform)/∂(joint), a row per joint of the leg, m")
    .matrix("moment_w", jacobian, "∂moment/∂w")
    .matrix("levers_w", lever_rows, "∂levers/∂w, a row for each of them");
    let curvature = state(Kernel::of_mode(
        mode,
        "sharing_curvature",
        "Gradient in (q, q̇, q̈) and second derivatives of the sum of what the sharing's kernel gives, each with its weight.",
    ))
    .blocks("weights", weights, blocks);
    vec![values, second_derivatives(model, curvature, &sum)]
}

/// Moment about the foot of `leg` of all that the feet must provide, about y and z:
/// `Σ r × m (a − g) + R (I ω̇ + ω × I ω)`.
fn moment(model: &mut Model, leg: usize) -> [Poly; 2] {
    let mut sum = zero();
    for (b, centre) in model.centres(Origin::Foot(leg)).iter().enumerate() {
        let velocity = model.rate(centre);
        let mut force = model.rate(&velocity);
        force[1] += &model.quantities.gravity;
        let force = force.map(|f| &f * &model.kinematics.bodies[b].mass);
        let spin = model.kinematics.bodies[b].place.spin.clone();
        let angular = scaled(&spin, &model.kinematics.bodies[b].inertia);
        let own = add(&model.rate(&angular), &cross(&spin, &angular));
        let own = rotate(&model.kinematics.bodies[b].place.axes, &own);
        sum = add(&sum, &add(&cross(centre, &force), &own));
    }
    let [_, y, z] = sum;
    [y, z]
}

/// How each joint of the leg moves its foot against the platform.
fn levers(model: &Model, leg: usize) -> Vec<Vec<Poly>> {
    let foot = model.foot(leg);
    let joints = model.mechanism.legs[leg].joints.clone();
    let by: Vec<Var> = joints.map(|j| model.coordinates.q[j][0]).collect();
    by.iter().map(|q| foot.iter().map(|x| model.ring.derivative(x, *q)).collect()).collect()
}

/// How the real feet that land share the impulse. No motor gives an impulse, so legs of a pair, which move alike, take the
/// same in their plane; across it, along the transverse axis ẑ′ of the platform, they take what keeps it from turning. `couple`: from
/// one foot to the other, times the distance between them, components y and z. `pitch` is the change of the angular
/// momentum about ẑ′ through the landing foot of `leg`, for which no impulse is left: zero where the hips are level with the
/// mass centre and rotors weigh nothing. `platform` is its velocity before, `after` gives q̇⁺ for q̇.
pub fn landing(model: &mut Model, leg: usize, platform: &Vec3, after: &BTreeMap<Var, Poly>) -> [Poly; 3] {
    let mut turn = zero();
    for (b, centre) in model.centres(Origin::Foot(leg)).iter().enumerate() {
        let about = model.rate(centre);
        let relative = model.kinematics.bodies[b].place.com.clone();
        let before = add(&model.rate(&relative), platform);
        let spin = model.kinematics.bodies[b].place.spin.clone();
        let angular = scaled(&spin, &model.kinematics.bodies[b].inertia);
        let angular = rotate(&model.kinematics.bodies[b].place.axes, &angular);
        let mut change = |later: &Vec3, before: &Vec3| -> Vec3 {
            [0, 1, 2].map(|i| &model.ring.substitute(&later[i], after) - &before[i])
        };
        let (linear, own) = (change(&about, &before), change(&angular, &angular));
        let mass = &model.kinematics.bodies[b].mass;
        turn = add(&turn, &add(&cross(centre, &linear.map(|v| &v * mass)), &own));
    }
    let axes = &model.kinematics.bodies[0].place.axes;
    let [yaw, pitch] = [1, 2].map(|axis| dot(&[0, 1, 2].map(|i| axes[i][axis].clone()), &turn));
    [-&(&yaw * &axes[1][2]), -&(&yaw * &axes[2][2]), pitch]
}
