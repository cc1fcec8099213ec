//! Random robots that could be built: positive masses, inertias that a rigid body can have.

use piaffe_codegen::spec::{
    Actuator, Axis, Friction, Gait, Inertia, Joint, Leg, Limits, Link, Phases, Platform, Robot, Rotation, Segment,
    Spring, Then, Unactuated,
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
    /// Whether links are crooked, their axes no principal ones, and the legs of a pair unequally heavy.
    pub crooked: bool,
    /// Real legs of a virtual one.
    pub members: usize,
}

const LINK: Axis = Axis::Pitch;

const PLAIN: Build =
    Build { rotation: Rotation::Pitch, axes: [&[LINK; 2]; 2], rotor: 0.0, centred: false, crooked: false, members: 2 };

pub const BUILDS: [(&str, Build); 14] = [
    ("trot", Build { rotation: Rotation::None, axes: [&[LINK; 2]; 2], rotor: 0.0, centred: true, ..PLAIN }),
    (
        "trot with rotors",
        Build { rotation: Rotation::None, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: true, ..PLAIN },
    ),
    (
        "level, hips apart",
        Build { rotation: Rotation::None, axes: [&[LINK; 2], &[LINK; 3]], rotor: 0.05, centred: false, ..PLAIN },
    ),
    ("curvet", Build { rotation: Rotation::Pitch, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: false, ..PLAIN }),
    (
        "curvet on uneven legs",
        Build { rotation: Rotation::Pitch, axes: [&[LINK; 3], &[LINK; 2]], rotor: 0.0, centred: false, ..PLAIN },
    ),
    ("amble", Build { rotation: Rotation::Roll, axes: [&[LINK; 2]; 2], rotor: 0.05, centred: false, ..PLAIN }),
    (
        "amble on three links",
        Build { rotation: Rotation::Roll, axes: [&[LINK; 3]; 2], rotor: 0.0, centred: false, ..PLAIN },
    ),
    (
        "amble with hips that abduct",
        Build { rotation: Rotation::Roll, axes: [&[Axis::Roll, LINK, LINK]; 2], rotor: 0.05, centred: false, ..PLAIN },
    ),
    (
        "amble with hips that turn",
        Build { rotation: Rotation::Roll, axes: [&[Axis::Yaw, LINK]; 2], rotor: 0.0, centred: false, ..PLAIN },
    ),
    ("biped", Build { rotor: 0.05, members: 1, ..PLAIN }),
    ("crooked trot", Build { rotation: Rotation::None, rotor: 0.05, crooked: true, ..PLAIN }),
    ("crooked curvet", Build { axes: [&[LINK; 4], &[LINK; 1]], rotor: 0.05, crooked: true, ..PLAIN }),
    ("crooked on three links", Build { axes: [&[LINK; 3]; 2], rotor: 0.05, crooked: true, ..PLAIN }),
    ("crooked amble", Build { rotation: Rotation::Roll, rotor: 0.05, crooked: true, ..PLAIN }),
];

/// The inertia of some distribution of mass: tr(S) 1 − S with its second moments S = L Lᵀ.
fn inertia(draws: &mut Draws, size: f64, crooked: bool) -> Inertia {
    let root = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| match () {
            () if i == j => draws.between(0.05, 1.0).sqrt(),
            () if crooked && j < i => draws.between(-0.5, 0.5),
            () => 0.0,
        })
    });
    let second = root.map(|a| root.map(|b| (0..3).map(|k| a[k] * b[k]).sum::<f64>() * size));
    let trace: f64 = (0..3).map(|k| second[k][k]).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { trace } else { 0.0 } - second[i][j]))
}

fn leg(name: &str, mount: [f64; 3], axes: &[Axis], draws: &mut Draws, build: &Build) -> Leg {
    let chain = axes.iter().enumerate().map(|(k, axis)| {
        let (mass, length) = (draws.between(0.1, 3.0), draws.between(0.05, 0.3));
        let com = [draws.between(-0.03, 0.03), -draws.between(0.0, 1.0) * length, draws.between(-0.03, 0.03)];
        let mut end = [0.0, -length, 0.0];
        if build.crooked {
            (end[0], end[2]) = (draws.between(-0.05, 0.05), draws.between(-0.05, 0.05));
        }
        let actuator = Actuator {
            name: "motor".into(),
            gear: 10.0,
            max_torque: 1.0,
            unloaded_speed: 5000.0,
            loaded_speed: 3000.0,
            rotor_inertia: draws.between(0.0, build.rotor) / 100.0,
        };
        Segment {
            joint: Joint {
                name: format!("joint{k}"),
                axis: *axis,
                range: [-1.0, 1.0],
                spring: Spring::default(),
                friction: Friction::default(),
                actuator,
            },
            link: Link {
                name: format!("link{k}"),
                mass,
                end,
                com,
                inertia: inertia(draws, 0.01 * mass, build.crooked),
                foot_mass: 0.0,
                locked: Vec::new(),
            },
        }
    });
    Leg { name: name.into(), mount, chain: chain.collect(), locked: Vec::new() }
}

pub fn specification(build: &Build, draws: &mut Draws) -> (Robot, Gait) {
    let platform = Platform {
        name: "platform".into(),
        mass: draws.between(1.0, 10.0),
        com: [draws.between(-0.05, 0.05), draws.between(-0.05, 0.05), 0.0],
        inertia: inertia(draws, 0.3, build.crooked),
        extent: None,
    };
    let mut legs = Vec::new();
    for (k, axes) in build.axes.iter().enumerate() {
        let mut mount = [draws.between(-0.3, 0.3), draws.between(-0.1, 0.1), draws.between(-0.2, 0.2)];
        if build.centred {
            mount = platform.com;
        }
        let spread = draws.between(0.05, 0.2);
        for member in 0..build.members {
            let aside = if build.members == 1 { 0.0 } else { spread * (1.0 - 2.0 * member as f64) };
            let mut next = leg(&format!("leg{k}{member}"), mount.map(|x| x + aside), axes, draws, build);
            if member > 0 {
                // It moves like the first one, whatever it weighs.
                let first: &Leg = &legs[legs.len() - 1];
                for (segment, like) in next.chain.iter_mut().zip(&first.chain) {
                    segment.joint = like.joint.clone();
                    segment.link.end = like.link.end;
                    if !build.crooked {
                        segment.link = like.link.clone();
                    }
                }
            }
            legs.push(next);
        }
    }
    let robot =
        Robot { name: "random".into(), gravity: draws.between(1.0, 10.0), platform, legs, written: Default::default() };
    let unactuated = match build.rotation {
        Rotation::None => Unactuated::Joint { leg: 0, joint: 0 },
        _ => Unactuated::Platform,
    };
    let gait = Gait {
        name: "random".into(),
        virtual_legs: [(0..build.members).collect(), (build.members..2 * build.members).collect()],
        locked: Vec::new(),
        rotation: build.rotation,
        unactuated,
        phases: Phases::half_steps(Then::Repeat, [0.1, 1.0]),
        polynomial_order: 4,
        limits: Limits {
            friction: 1.0,
            min_vertical_force: 1.0,
            swing_clearance: 0.0,
            min_platform_height: 0.0,
            body_clearance: 0.0,
        },
    };
    (robot, gait)
}

/// The leg's mirror image across the sagittal plane.
pub fn mirrored(leg: &Leg) -> Leg {
    let flip = |v: [f64; 3]| [v[0], v[1], -v[2]];
    let mut image = Leg { mount: flip(leg.mount), ..leg.clone() };
    for segment in &mut image.chain {
        let link = &mut segment.link;
        (link.com, link.end) = (flip(link.com), flip(link.end));
        for k in 0..2 {
            link.inertia[k][2] *= -1.0;
            link.inertia[2][k] *= -1.0;
        }
    }
    image
}
