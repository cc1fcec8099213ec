//! Random robots that could be built: positive masses, inertias that a rigid body can have.

use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::spec::{
    Actuator, Axis, Gait, HalfSteps, Joint, Leg, Limits, Link, Platform, Robot, Rotation, Segment, Unactuated,
};

/// Numbers in [0, 1), handed out one after another.
pub struct Draws {
    numbers: Vec<f64>,
    next: usize,
}

/// Enough for any robot here with its states.
pub const DRAWS: usize = 400;

impl Draws {
    pub fn new(numbers: Vec<f64>) -> Draws {
        Draws { numbers, next: 0 }
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = self.numbers[self.next % self.numbers.len()];
        self.next += 1;
        low + (high - low) * unit
    }

    pub fn vector(&mut self, length: usize, size: f64) -> Vec<f64> {
        (0..length).map(|_| self.between(-size, size)).collect()
    }
}

/// How the legs of a random robot are built and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    pub rotation: Rotation,
    /// Joint axes of the legs of virtual leg 1 and 2.
    pub axes: [&'static [Axis]; 2],
    /// Rotor inertia at the joints, kg·m² (largest).
    pub rotor: f64,
    /// Whether the hips of a level gait lie at the platform's mass centre.
    pub centred: bool,
}

const LINK: Axis = Axis::Pitch;

pub const BUILDS: [(&str, Build); 9] = [
    ("trot", Build { rotation: Rotation::None, axes: [&[LINK; 2]; 2], rotor: 0.0, centred: true }),
    ("trot with rotors", Build { rotation: Rotation::None, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: true }),
    (
        "level, hips apart",
        Build { rotation: Rotation::None, axes: [&[LINK; 2], &[LINK; 3]], rotor: 0.05, centred: false },
    ),
    ("curvet", Build { rotation: Rotation::Pitch, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: false }),
    (
        "curvet on uneven legs",
        Build { rotation: Rotation::Pitch, axes: [&[LINK; 3], &[LINK; 2]], rotor: 0.0, centred: false },
    ),
    ("amble", Build { rotation: Rotation::Roll, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: false }),
    ("amble on three links", Build { rotation: Rotation::Roll, axes: [&[LINK; 3]; 2], rotor: 0.0, centred: false }),
    (
        "amble with hips that abduct",
        Build { rotation: Rotation::Roll, axes: [&[Axis::Roll, LINK, LINK]; 2], rotor: 0.05, centred: false },
    ),
    (
        "amble with hips that turn",
        Build { rotation: Rotation::Roll, axes: [&[Axis::Yaw, LINK]; 2], rotor: 0.0, centred: false },
    ),
];

/// Moments of inertia of some distribution of mass.
fn inertia(draws: &mut Draws, size: f64) -> [f64; 3] {
    let [x, y, z] = [0; 3].map(|_| draws.between(0.05, 1.0) * size);
    [y + z, z + x, x + y]
}

fn leg(name: &str, mount: [f64; 3], axes: &[Axis], draws: &mut Draws, rotor: f64) -> Leg {
    let chain = axes.iter().enumerate().map(|(k, axis)| {
        let (mass, length) = (draws.between(0.1, 3.0), draws.between(0.05, 0.3));
        let com = [draws.between(-0.03, 0.03), -draws.between(0.0, 1.0) * length, draws.between(-0.03, 0.03)];
        let actuator = Actuator {
            name: "motor".into(),
            gear: 10.0,
            max_torque: 1.0,
            unloaded_speed: 5000.0,
            loaded_speed: 3000.0,
            rotor_inertia: draws.between(0.0, rotor) / 100.0,
        };
        Segment {
            joint: Joint { name: format!("joint{k}"), axis: *axis, range: [-1.0, 1.0], actuator },
            link: Link { name: format!("link{k}"), mass, length, com, inertia: inertia(draws, 0.01 * mass) },
        }
    });
    Leg { name: name.into(), mount, chain: chain.collect() }
}

/// Each virtual leg is a pair of real ones.
pub fn random(build: &Build, draws: &mut Draws) -> Mechanism {
    let platform = Platform {
        name: "platform".into(),
        mass: draws.between(1.0, 10.0),
        com: [draws.between(-0.05, 0.05), draws.between(-0.05, 0.05), 0.0],
        inertia: inertia(draws, 0.3),
    };
    let mut legs = Vec::new();
    for (k, axes) in build.axes.iter().enumerate() {
        let mut mount = [draws.between(-0.3, 0.3), draws.between(-0.1, 0.1), draws.between(-0.2, 0.2)];
        if build.centred {
            mount = platform.com;
        }
        let spread = draws.between(0.05, 0.2);
        let first = leg(&format!("leg{k}a"), mount.map(|x| x + spread), axes, draws, build.rotor);
        let mut second = first.clone();
        second.name = format!("leg{k}b");
        second.mount = mount.map(|x| x - spread);
        legs.extend([first, second]);
    }
    let robot = Robot { name: "random".into(), gravity: draws.between(1.0, 10.0), platform, legs };
    let unactuated = match build.rotation {
        Rotation::None => Unactuated::Joint { leg: 0, joint: 0 },
        _ => Unactuated::Platform,
    };
    let gait = Gait {
        name: "random".into(),
        virtual_legs: [vec![0, 1], vec![2, 3]],
        lateral: build.rotation == Rotation::Roll,
        rotation: build.rotation,
        unactuated,
        half_steps: HalfSteps::Distinct,
        polynomial_order: 4,
        limits: Limits {
            friction: 1.0,
            min_vertical_force: 1.0,
            swing_clearance: 0.0,
            half_step_duration: [0.1, 1.0],
            min_platform_height: 0.0,
        },
    };
    Mechanism::new(&robot, &gait)
}
