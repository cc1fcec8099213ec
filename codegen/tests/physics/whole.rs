//! Laws of the whole robot: its equations against bodies in plain numbers, and what virtual legs are worth.

use super::common::{Derived, GAITS, Outputs, evaluate, specification};
use super::numbers::{
    Matrix, add, apply, assert_close, difference, dot, is_positive_definite, product, times, transposed_product, turn,
};
use super::robots::{BUILDS, Build, DRAWS, Draws, mirrored, specification as random};
use super::state::State;
use super::support::{largest, prescribed};
use piaffe_codegen::dynamics::{Kernel, whole_kernels};
use piaffe_codegen::expr::Ring;
use piaffe_codegen::mechanism::{Mechanism, Whole};
use piaffe_codegen::spec::{Axis, Gait, Robot, Rotation};

/// A whole robot with its kernels as expressions.
struct Derivation {
    whole: Whole,
    ring: Ring,
    kernels: Vec<Kernel>,
}

impl Derivation {
    fn new(robot: &Robot) -> Derivation {
        let whole = Whole::new(robot);
        let (ring, kernels) = whole_kernels(&whole);
        Derivation { whole, ring, kernels }
    }

    fn run(&self, name: &str, inputs: &[&[f64]]) -> Outputs {
        evaluate(&self.ring, self.kernels.iter().find(|k| k.name == name).unwrap(), inputs)
    }

    /// `A u̇ + H`.
    fn forces(&self, s: &Posture) -> Vec<f64> {
        let motion = self.run("inertia_and_bias", &[&s.up(), &s.u[3..6], &s.q, &s.u[6..]]);
        product(motion.get("a"), &s.ud).iter().zip(motion.get("h")).map(|(a, h)| a + h).collect()
    }
}

/// The whole robot in motion: place and axes of the platform, joints, speeds and their derivatives.
#[derive(Clone)]
struct Posture {
    p: [f64; 3],
    r: Matrix,
    q: Vec<f64>,
    u: Vec<f64>,
    ud: Vec<f64>,
}

impl Posture {
    fn random(joints: usize, draws: &mut Draws) -> Posture {
        let mut vector = |n: usize, size: f64| draws.vector(n, size);
        let [a, b, c] = [0, 1, 2].map(|_| vector(1, 3.0)[0]);
        Posture {
            p: vector(3, 1.0).try_into().unwrap(),
            r: times(&turn(1, a), &times(&turn(0, b), &turn(2, c))),
            q: vector(joints, 1.0),
            u: vector(6 + joints, 2.0),
            ud: vector(6 + joints, 5.0),
        }
    }

    /// The vertical in the platform's axes.
    fn up(&self) -> [f64; 3] {
        self.r[1]
    }

    /// Displaced by `d` in the directions of u.
    fn moved(&self, d: &[f64]) -> Posture {
        let step = apply(&self.r, [d[0], d[1], d[2]]);
        let q = self.q.iter().zip(&d[6..]).map(|(q, d)| q + d).collect();
        Posture { p: add(self.p, step), r: times(&self.r, &rotated([d[3], d[4], d[5]])), q, ..self.clone() }
    }

    /// After a short time. The mass centre's acceleration is given in axes that turn.
    fn after(&self, t: f64) -> Posture {
        let d: Vec<f64> = self.u.iter().zip(&self.ud).map(|(u, ud)| u * t + 0.5 * ud * t * t).collect();
        self.moved(&d)
    }
}

/// The turn by a vector (Rodrigues).
fn rotated(v: [f64; 3]) -> Matrix {
    let angle = dot(&v, &v).sqrt();
    // sin x / x and (1 − cos x)/x² near 0.
    let (s, c) = match angle < 1e-4 {
        true => (1.0 - angle * angle / 6.0, 0.5 - angle * angle / 24.0),
        false => (angle.sin() / angle, (1.0 - angle.cos()) / (angle * angle)),
    };
    let skew = [[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]];
    let square = times(&skew, &skew);
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| f64::from(i == j) + s * skew[i][j] + c * square[i][j]))
}

/// Mass centres and axes of all bodies, and the feet, by composing rotations.
fn poses(w: &Whole, s: &Posture) -> (Vec<([f64; 3], Matrix)>, Vec<f64>) {
    let mut frames: Vec<([f64; 3], Matrix)> = Vec::new();
    for body in &w.bodies {
        frames.push(match (body.parent, body.coordinate) {
            (Some(parent), Some(k)) => {
                let (origin, above) = &frames[parent];
                (add(*origin, apply(above, body.offset)), times(above, &turn(body.axis.index(), s.q[k])))
            }
            _ => (s.p, s.r),
        });
    }
    let feet = w.legs.iter().flat_map(|leg| {
        let (origin, r) = &frames[leg.foot_body];
        add(*origin, apply(r, leg.foot))
    });
    let feet = feet.collect();
    (w.bodies.iter().zip(&frames).map(|(b, (o, r))| (add(*o, apply(r, b.com)), *r)).collect(), feet)
}

/// The spin, in world axes, of axes `r` that change at this rate.
fn spin(r: &Matrix, rate: &[f64]) -> [f64; 3] {
    let entry = |i: usize, j: usize| (0..3).map(|k| rate[3 * i + k] * r[j][k]).sum::<f64>();
    [entry(2, 1), entry(0, 2), entry(1, 0)]
}

fn flat(r: &Matrix) -> Vec<f64> {
    r.as_flattened().to_vec()
}

/// Newton and Euler with all derivatives by differences, projected on displacements along u.
fn newton_euler(w: &Whole, s: &Posture) -> Vec<f64> {
    // Velocity of each mass centre and angular momentum about it.
    let momenta = |t: f64| -> Vec<f64> {
        let rates = difference(|h| {
            let (poses, _) = poses(w, &s.after(t + h));
            poses.iter().flat_map(|(c, r)| [&c[..], &flat(r)].concat()).collect()
        });
        let (poses, _) = poses(w, &s.after(t));
        let each = w.bodies.iter().zip(&poses).zip(rates.chunks(12));
        each.flat_map(|((body, (_, r)), rate)| {
            let spin = spin(r, &rate[3..]);
            let own = [0, 1, 2].map(|i| (0..3).map(|k| r[k][i] * spin[k]).sum::<f64>());
            let momentum = apply(r, body.inertia.map(|row| dot(&row, &own)));
            [&rate[..3], &momentum].concat()
        })
        .collect()
    };
    let rates = difference(momenta);
    let (here, _) = poses(w, s);
    (0..s.u.len())
        .map(|k| {
            let partial = difference(|h| {
                let mut d = vec![0.0; s.u.len()];
                d[k] = h;
                let (poses, _) = poses(w, &s.moved(&d));
                poses.iter().flat_map(|(c, r)| [&c[..], &flat(r)].concat()).collect()
            });
            let rotor = k.checked_sub(6).map_or(0.0, |j| w.joints[j].rotor_inertia * s.ud[k]);
            let each = w.bodies.iter().zip(&here).zip(rates.chunks(6).zip(partial.chunks(12)));
            each.fold(rotor, |sum, ((body, (_, r)), (rate, partial))| {
                let mut acceleration = [rate[0], rate[1], rate[2]];
                acceleration[1] += w.gravity;
                sum + body.mass * dot(&acceleration, &partial[..3]) + dot(&rate[3..], &spin(r, &partial[3..]))
            })
        })
        .collect()
}

fn obeys_newton_and_euler(robot: &Robot, draws: &mut Draws) {
    let d = Derivation::new(robot);
    let mut s = Posture::random(d.whole.joints.len(), draws);
    let n = s.u.len();
    let motion = d.run("inertia_and_bias", &[&s.up(), &s.u[3..6], &s.q, &s.u[6..]]);
    assert!(is_positive_definite(motion.get("a"), n));
    for i in 0..n {
        for j in 0..i {
            assert_eq!(motion.get("a")[i * n + j], motion.get("a")[j * n + i], "A is symmetric");
        }
    }
    // The path of `after` has its velocity's direction turning with the platform unless there is none.
    (0..3).for_each(|k| s.u[k] = 0.0);
    let forces = d.forces(&s);
    assert_close("A u̇ + H", &forces, &newton_euler(&d.whole, &s), 1e-6);

    let places = |s: &Posture| poses(&d.whole, s).1;
    let in_axes = |v: &[f64]| -> Vec<f64> {
        v.chunks(3).flat_map(|v| [0, 1, 2].map(|i| (0..3).map(|k| s.r[k][i] * v[k]).sum::<f64>())).collect()
    };
    let feet = d.run("feet", &[&s.q]);
    let relative: Vec<f64> = places(&s).chunks(3).flat_map(|f| [0, 1, 2].map(|k| f[k] - s.p[k])).collect();
    assert_close("d", feet.get("d"), &in_axes(&relative), 1e-12);
    let velocity = in_axes(&difference(|t| places(&s.after(t))));
    assert_close("Dᵀu", &transposed_product(feet.get("jacobian"), &s.u), &velocity, 1e-8);
    let acceleration = in_axes(&difference(|t| difference(|h| places(&s.after(t + h)))));
    let bias = d.run("feet_bias", &[&s.u[3..6], &s.q, &s.u[6..]]);
    let linear = transposed_product(feet.get("jacobian"), &s.ud);
    let ours: Vec<f64> = linear.iter().zip(bias.get("h")).map(|(a, b)| a + b).collect();
    assert_close("Dᵀu̇ + h", &ours, &acceleration, 1e-6);
}

fn draws(seed: f64) -> Draws {
    Draws::new((1..=DRAWS).map(|k| (k as f64 * seed).fract()).collect())
}

#[test]
fn newton_and_euler_for_shipped_and_random_robots() {
    let mut draws = draws(0.618_033_988_749_895);
    for gait in GAITS {
        obeys_newton_and_euler(&specification(gait).0, &mut draws);
    }
    for (_, build) in &BUILDS {
        obeys_newton_and_euler(&random(build, &mut draws).0, &mut draws);
    }
}

/// What a virtual leg does, done by its members alike: the state, and torques and reactions in equal shares.
struct Lift {
    posture: Posture,
    /// Sᵀ Γ + D F.
    drive: Vec<f64>,
}

/// Axes of the platform of a gait's model.
fn platform(m: &Mechanism, q: &[f64]) -> Matrix {
    match m.rotation {
        Rotation::None => turn(0, 0.0),
        Rotation::Pitch => turn(2, q[m.joints.len()]),
        Rotation::Roll => turn(0, q[m.joints.len()]),
    }
}

/// Of coordinates X: those of the whole robot in the directions of u.
fn spread(m: &Mechanism, gait: &Gait, w: &Whole, r: &Matrix, x: &[f64]) -> Vec<f64> {
    let (p, q) = x.split_at(m.positions());
    let mut u = vec![0.0; 6 + w.joints.len()];
    for (i, u) in u[..3].iter_mut().enumerate() {
        *u = p.iter().enumerate().map(|(k, p)| r[k][i] * p).sum();
    }
    match m.rotation {
        Rotation::None => {}
        Rotation::Pitch => u[5] = q[m.joints.len()],
        Rotation::Roll => u[3] = q[m.joints.len()],
    }
    for_each_joint(m, gait, w, |virtual_joint, real| u[6 + real] = q[virtual_joint]);
    u
}

fn for_each_joint(m: &Mechanism, gait: &Gait, w: &Whole, mut call: impl FnMut(usize, usize)) {
    for (leg, members) in m.legs.iter().zip(&gait.virtual_legs) {
        for member in members {
            leg.joints.clone().zip(w.legs[*member].joints.clone()).for_each(|(j, k)| call(j, k));
        }
    }
}

impl Lift {
    fn new(d: &Derivation, gait: &Gait, m: &Mechanism, s: &State, [xd, xdd]: [&[f64]; 2], loads: Loads) -> Lift {
        let r = platform(m, &s.q);
        let mut posture = Posture { p: [0.0; 3], r, q: Vec::new(), u: Vec::new(), ud: Vec::new() };
        (posture.u, posture.ud) = (spread(m, gait, &d.whole, &r, xd), spread(m, gait, &d.whole, &r, xdd));
        let still: Vec<f64> = [&vec![0.0; m.positions()], &s.q[..]].concat();
        posture.q = spread(m, gait, &d.whole, &r, &still)[6..].to_vec();

        let members = &gait.virtual_legs[loads.leg];
        let share = members.len() as f64;
        let mut force = [0.0; 3];
        force[..loads.force.len()].copy_from_slice(loads.force);
        let in_axes = [0, 1, 2].map(|i| (0..3).map(|k| r[k][i] * force[k] / share).sum::<f64>());
        let mut reactions = vec![0.0; 3 * d.whole.legs.len()];
        members.iter().for_each(|member| reactions[3 * member..3 * member + 3].copy_from_slice(&in_axes));
        let mut drive = product(d.run("feet", &[&posture.q]).get("jacobian"), &reactions);
        for_each_joint(m, gait, &d.whole, |j, k| drive[6 + k] += loads.torque[j] / 2.0);
        Lift { posture, drive }
    }
}

/// What acts on the virtual legs: torques of all joints, force on the foot of one.
struct Loads<'a> {
    leg: usize,
    torque: &'a [f64],
    force: &'a [f64],
}

/// A u̇ + H − Sᵀ Γ − D F at a random instant of support on each virtual leg, and A Δu − D I at a random impact on each;
/// the largest component of each kind, in the largest of A u̇ + H and of A Δu.
fn residuals(robot: &Robot, gait: &Gait, m: &Mechanism, draws: &mut Draws) -> Vec<Vec<f64>> {
    let (whole, virtual_) = (Derivation::new(robot), Derived::new(m));
    let s = State::random(m, draws);
    let mut found = Vec::new();
    for leg in 0..2 {
        let number = leg + 1;
        let inverse = virtual_.run(&format!("inverse{number}"), &[&s.q, &s.qd, &prescribed(m, &s.qdd)]);
        let velocity = virtual_.run(&format!("platform_velocity{number}"), &[&s.q, &s.qd]);
        let xd = [velocity.get("pd"), &s.qd].concat();
        let loads = Loads { leg, torque: inverse.get("gamma"), force: inverse.get("f") };
        let lift = Lift::new(&whole, gait, m, &s, [&xd, inverse.get("xdd")], loads);
        found.push(relative(&whole.forces(&lift.posture), &lift.drive));

        let impact = virtual_.run(&format!("impact{number}"), &[&s.q, &s.xd]);
        let change: Vec<f64> = impact.get("xd_plus").iter().zip(&s.xd).map(|(a, b)| a - b).collect();
        let loads = Loads { leg, torque: &vec![0.0; m.joints.len()], force: impact.get("impulse") };
        let lift = Lift::new(&whole, gait, m, &s, [&s.xd, &change], loads);
        let motion = whole.run("inertia_and_bias", &[&[0.0; 3], &[0.0; 3], &lift.posture.q, &lift.posture.u[6..]]);
        found.push(relative(&product(motion.get("a"), &lift.posture.ud), &lift.drive));
    }
    found
}

fn relative(one: &[f64], other: &[f64]) -> Vec<f64> {
    let scale = largest(one);
    one.iter().zip(other).map(|(a, b)| (a - b).abs() / scale).collect()
}

const PAIRS: Build = Build { crooked: true, rotor: 0.05, ..BUILDS[3].1 };

/// A robot whose pairs are mirror images, as those of a curvet are.
fn bilateral(draws: &mut Draws) -> (Robot, Gait) {
    let build = Build { axes: [&[Axis::Pitch; 3], &[Axis::Pitch; 2]], ..PAIRS };
    let (mut robot, gait) = random(&build, draws);
    for k in [0, 2] {
        robot.legs[k + 1] = mirrored(&robot.legs[k]);
    }
    let [[_, _, xz], [_, _, yz], [zx, zy, _]] = &mut robot.platform.inertia;
    (*xz, *yz, *zx, *zy) = (0.0, 0.0, 0.0, 0.0);
    (robot, gait)
}

/// A robot whose pairs are opposite each other, as those of a trot are. Its motors have no rotors: in an impact these
/// would pass moments on to a platform that nothing else keeps level.
fn diagonal(rotation: Rotation, draws: &mut Draws) -> (Robot, Gait) {
    let build = Build { rotation, centred: true, crooked: false, rotor: 0.0, ..PAIRS };
    let (mut robot, gait) = random(&build, draws);
    for k in 0..2 {
        let aside = [draws.between(0.1, 0.3), 0.0, draws.between(0.1, 0.3) * (1.0 - 2.0 * k as f64)];
        for (member, sign) in [1.0, -1.0].into_iter().enumerate() {
            let leg = &mut robot.legs[2 * k + member];
            leg.mount = [0, 1, 2].map(|i| robot.platform.com[i] + sign * aside[i]);
            leg.chain.iter_mut().for_each(|segment| segment.link.com[2] = 0.0);
        }
    }
    (robot, gait)
}

const RANDOM_ROBOTS: usize = 6;

fn worst(residuals: &[Vec<f64>]) -> f64 {
    residuals.iter().flatten().fold(0.0, |worst, r| worst.max(*r))
}

#[test]
fn two_real_legs_do_half_of_what_a_virtual_leg_does_in_curvet_and_trot() {
    let mut draws = draws(0.754_877_666_246_693);
    let mut all = Vec::new();
    for gait in ["curvet", "trot"] {
        let (robot, gait) = specification(gait);
        all.push((robot, gait));
    }
    for _ in 0..RANDOM_ROBOTS {
        all.push(bilateral(&mut draws));
        all.push(diagonal(Rotation::None, &mut draws));
    }
    for (robot, gait) in all {
        let m = Mechanism::new(&robot, &gait);
        let found = worst(&residuals(&robot, &gait, &m, &mut draws));
        assert!(found < 1e-10, "{} of {}: {found:.1e}", gait.name, robot.name);
    }
}

/// §2.4: the virtual legs of a trot stand for the real ones only where the platform is level.
#[test]
fn they_do_not_where_the_platform_of_a_trot_pitches() {
    let mut draws = draws(0.569_840_290_998_053);
    for _ in 0..RANDOM_ROBOTS {
        let (robot, gait) = diagonal(Rotation::Pitch, &mut draws);
        let m = Mechanism::new(&robot, &gait);
        let found = worst(&residuals(&robot, &gait, &m, &mut draws));
        assert!(found > 1e-3, "{found:.1e}");
    }
}

/// §2.3: the real legs of a side do what the virtual leg does, but not in equal shares: in support these lack moments
/// in pitch and in yaw, at the impact in yaw, and nothing else.
#[test]
fn in_an_amble_equal_shares_lack_moments_in_pitch_and_yaw() {
    const YAW: usize = 4;
    const PITCH: usize = 5;
    let mut draws = draws(0.819_172_513_396_164);
    let (robot, gait) = specification("amble");
    let m = Mechanism::new(&robot, &gait);
    for (k, found) in residuals(&robot, &gait, &m, &mut draws).into_iter().enumerate() {
        let lacking: &[usize] = if k % 2 == 0 { &[YAW, PITCH] } else { &[YAW] };
        for (row, residual) in found.into_iter().enumerate() {
            let lacks = lacking.contains(&row);
            assert!(if lacks { residual > 1e-3 } else { residual < 1e-12 }, "{k}: row {row}: {residual:.1e}");
        }
    }
}
