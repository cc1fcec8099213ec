//! Gaits that are evaluated as they were derived have the bits of those that were compiled.

use piaffe::Robot;
use piaffe::gaits::GAITS;
use piaffe::interpreter::Interpreted;
use piaffe::model::{Gait, Mode};
use piaffe_codegen::dynamics::{Kernel, kernels};
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::{RobotFiles, specified};
use std::path::Path;

/// The robots of `model-spec`, with the gaits that are also compiled.
fn robots() -> Vec<RobotFiles> {
    RobotFiles::of_folder(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec"))).unwrap()
}

/// Each gait twice: compiled and interpreted; with its kernels.
fn twice() -> Vec<(&'static dyn Gait, Interpreted, Vec<Kernel>)> {
    let mut gaits = Vec::new();
    for files in robots() {
        let robot = Robot::new(files.clone()).unwrap();
        let specification = &specified(&[files]).unwrap()[0];
        for (key, gait) in robot.gaits().iter().zip(&specification.gaits) {
            let compiled = GAITS.iter().copied().find(|g| g.description().key == key).unwrap();
            let locked = specification.robot.locked(&gait.locked).unwrap();
            gaits.push((compiled, robot.gait(key).unwrap(), kernels(&Mechanism::new(&locked, gait)).1));
        }
    }
    assert_eq!(gaits.len(), GAITS.len());
    gaits
}

/// Calls the trait's method for a kernel by its name, which may end in the leg's number or begin with a mode.
fn call(gait: &dyn Gait, name: &str, i: &[Vec<f64>], out: &mut [f64]) {
    let leg = usize::from(name.ends_with('2'));
    let (base, mode) = match name.strip_prefix("flight_") {
        Some(base) => (base, Mode::Flight),
        None => (name.trim_end_matches(['1', '2']), Mode::Stance(leg)),
    };
    macro_rules! by_name {
        ($($kernel:ident($($argument:expr),*);)*) => {
            match base {
                $(stringify!($kernel) => gait.$kernel($($argument,)* out),)*
                _ => panic!("no method for the kernel {name}"),
            }
        };
    }
    by_name! {
        inertia(&i[0]);
        bias(&i[0], &i[1]);
        inertia_and_bias(&i[0], &i[1]);
        energy(&i[0], &i[1]);
        centre_of_mass(&i[0], &i[1]);
        foot(leg, &i[0]);
        foot_jacobian(leg, &i[0]);
        foot_bias(leg, &i[0], &i[1]);
        angular_momentum(leg, &i[0], &i[1]);
        platform_velocity(mode, &i[0], &i[1]);
        momentum_terms(mode, &i[0], &i[1]);
        reduced(mode, &i[0], &i[1]);
        forward(mode, &i[0], &i[1], &i[2]);
        inverse(mode, &i[0], &i[1], &i[2]);
        momentum(mode, &i[0], &i[1]);
        inverse_jacobian(mode, &i[0], &i[1], &i[2]);
        placement(mode, &i[0]);
        heights(mode, &i[0]);
        swing_velocity(mode, &i[0], &i[1]);
        early(mode, &i[0], &i[1]);
        late(mode, &i[0], i[1][0]);
        late_gradient(mode, &i[0], i[1][0]);
        impact(leg, &i[0], &i[1]);
        touchdown(leg, &i[0], &i[1]);
        curvature(mode, &i[0], &i[1], &i[2], &i[3], &i[4], &i[5]);
        heights_curvature(mode, &i[0], &i[1]);
        touchdown_curvature(leg, &i[0], &i[1], &i[2], &i[3]);
        landing(leg, &i[0], &i[1], &i[2]);
        landing_curvature(leg, &i[0], &i[1], &i[2], &i[3], &i[4]);
        takeoff(leg, &i[0], &i[1], &i[2]);
        takeoff_curvature(leg, &i[0], &i[1], &i[2], &i[3]);
        sharing(mode, &i[0], &i[1], &i[2]);
        sharing_curvature(mode, &i[0], &i[1], &i[2], &i[3]);
        impact_both(&i[0], &i[1]);
    }
}

fn random(lengths: impl IntoIterator<Item = usize>, rng: &mut fastrand::Rng) -> Vec<Vec<f64>> {
    lengths.into_iter().map(|n| (0..n).map(|_| 6.0 * rng.f64() - 3.0).collect()).collect()
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn every_kernel_has_the_bits_of_the_compiled_one() {
    let mut rng = fastrand::Rng::with_seed(7);
    for (compiled, interpreted, kernels) in twice() {
        for kernel in &kernels {
            let length = kernel.outputs.iter().map(|o| o.values.len()).sum();
            for _ in 0..50 {
                let inputs = random(kernel.inputs.iter().map(|i| i.symbols.len()), &mut rng);
                let [mut expected, mut found] = [vec![f64::NAN; length], vec![0.0; length]];
                call(compiled, &kernel.name, &inputs, &mut expected);
                call(&interpreted, &kernel.name, &inputs, &mut found);
                assert!(expected.iter().all(|x| x.is_finite()), "{}: {expected:?}", kernel.name);
                let name = compiled.description().key;
                assert_eq!(bits(&found), bits(&expected), "{name} {}: {found:?} {expected:?}", kernel.name);
            }
        }
    }
}

#[test]
fn the_whole_robot_has_the_bits_of_the_compiled_one() {
    let mut rng = fastrand::Rng::with_seed(8);
    for (compiled, interpreted, _) in twice() {
        let [a, b] = [compiled.whole().unwrap(), interpreted.whole().unwrap()];
        assert_eq!(format!("{:?}", a.description()), format!("{:?}", b.description()));
        let (n, reactions) = (a.description().joints.len(), a.description().reactions());
        let speeds = a.description().speeds();
        for _ in 0..50 {
            let i = random([3, 3, n, n], &mut rng);
            let both = |length: usize, call: &dyn Fn(&dyn piaffe::model::whole::Whole, &mut [f64])| {
                let [mut expected, mut found] = [vec![f64::NAN; length], vec![0.0; length]];
                call(a, &mut expected);
                call(b, &mut found);
                assert_eq!(bits(&found), bits(&expected));
            };
            both(speeds * (speeds + 1), &|w, out| w.inertia_and_bias(&i[0], &i[1], &i[2], &i[3], out));
            both(reactions * (speeds + 1), &|w, out| w.feet(&i[2], out));
            both(reactions, &|w, out| w.feet_bias(&i[1], &i[2], &i[3], out));
        }
    }
}

/// All that is known of the gait beside its kernels, but for the length of its source.
#[test]
fn descriptions_are_those_of_the_compiled_gaits() {
    for (compiled, interpreted, _) in twice() {
        let (a, b) = (compiled.description(), interpreted.description());
        assert_eq!(a.fingerprint(), b.fingerprint());
        assert_eq!(format!("{:?}", a.shapes), format!("{:?}", b.shapes), "{}", a.key);
        for (a, b) in a.operations.iter().zip(b.operations) {
            let counts = |o: &piaffe::model::Operations| (o.kernel, o.flops, o.divisions, o.sincos, o.derived);
            assert_eq!(counts(a), counts(b));
        }
        assert_eq!(a.operations.len(), b.operations.len());
        assert_eq!(format!("{:?}", compiled.levers()), format!("{:?}", interpreted.levers()));
        assert_eq!(compiled.latex(), interpreted.latex());
    }
}

/// What does not fit gives numbers that are none, as the compiled kernels do.
#[test]
fn inputs_that_are_too_short_give_no_numbers() {
    let (compiled, interpreted, _) = twice().remove(0);
    for gait in [compiled, &interpreted as &dyn Gait] {
        let mut out = [0.0; 4];
        gait.bias(&[0.0; 4], &[0.0; 3], &mut out);
        assert!(out.iter().all(|x| x.is_nan()));
    }
}
