//! The format: the tables of `robot.toml` and of a gait file, key by key, with units, bounds and defaults.

use super::keys::Bound::{Angle, Any, NonNegative, Positive};
use super::keys::Kind::{
    Along, Angles, Choice, Choices, Coordinate, Map, Name, NameLists, Number, Order, Pair, Tables, Text, Vector,
};
use super::keys::{Key, Kind, Table, Way};

pub(super) static ROBOT: Table = Table {
    noun: "a robot",
    doc: "A legged robot: a platform and the legs that hang on it.",
    keys: &[
        Key::new("name", Text, "", "What the robot is called."),
        Key::new("gravity", Number(Positive), "m/s²", "Magnitude of gravity, along -y."),
        Key::new(
            "links",
            Map(&[&PLATFORM, &LINK]),
            "",
            "The rigid bodies. The one that no joint has as its child is the platform.",
        ),
        Key::new("joints", Map(&[&JOINT]), "", "The rotating joints; with their links they form the legs' chains."),
        Key::new("legs", Map(&[&LEG]), "", "Where each leg hangs on the platform."),
        Key::new("actuators", Map(&[&ACTUATOR]), "", "The motors, one for each joint of each leg."),
    ],
};

pub(super) static PLATFORM: Table = Table {
    noun: "the platform",
    doc: "The link that carries the legs.",
    keys: &[
        Key::new("mass", Number(Positive), "kg", "Mass."),
        Key::new(
            "com",
            Vector(Any),
            "m",
            "Mass centre in the frame of the legs' mounts: x forward, y up, z to the right.",
        )
        .or("[0, 0, 0]"),
        Key::new("inertia", Kind::Table(&PLATFORM_INERTIA), "kg·m²", "Moments of inertia about the mass centre."),
        Key::new(
            "extent",
            Kind::Table(&EXTENT),
            "m",
            "A box around it, whose corners must stay above the ground as the joints must.",
        )
        .or("no box"),
    ],
};

pub(super) static EXTENT: Table = Table {
    noun: "the extent",
    doc: "A box with edges along the platform's axes: x forward, y up, z to the right.",
    keys: &[
        Key::new("size", Vector(NonNegative), "m", "Length, height and width: the edges along x, y and z."),
        Key::new("centre", Vector(Any), "m", "Its middle in the frame of the legs' mounts.").or("[0, 0, 0]"),
    ],
};

pub(super) static PLATFORM_INERTIA: Table = Table {
    noun: "the platform's inertia",
    doc: "Moments about the mass centre.",
    keys: &[
        Key::new("roll", Number(NonNegative), "kg·m²", "About x, forward."),
        Key::new("yaw", Number(NonNegative), "kg·m²", "About y, up."),
        Key::new("pitch", Number(NonNegative), "kg·m²", "About z, to the right."),
        Key::new("products", Vector(Any), "kg·m²", PRODUCTS).or("[0, 0, 0]"),
    ],
};

const PRODUCTS: &str = "Products of inertia [∫yz dm, ∫zx dm, ∫xy dm], where the axes are not principal ones.";

pub(super) static LINK: Table = Table {
    noun: "a link",
    doc: "A link of a leg. Its axes are the platform's where all joints are at zero: x forward, y up, z to the right.",
    keys: &[
        Key::new("mass", Number(Positive), "kg", "Mass."),
        Key::new(
            "length",
            Along(Positive),
            "m",
            "From its joint to the next one, or to the foot: distance along -y, or [x, y, z] in the link's axes.",
        ),
        Key::new(
            "com",
            Along(Any),
            "m",
            "Mass centre: distance from its joint along the link, or [x, y, z] in the link's axes.",
        ),
        Key::new("inertia", Kind::Table(&LINK_INERTIA), "kg·m²", "Moments of inertia about the mass centre."),
        Key::new(
            "foot_mass",
            Number(NonNegative),
            "kg",
            "Mass of a foot: a point at the link's end, in addition to `mass`.",
        )
        .or("no foot"),
    ],
};

pub(super) static LINK_INERTIA: Table = Table {
    noun: "a link's inertia",
    doc: "Moments about the mass centre, in the link's axes.",
    keys: &[
        Key::new("swing", Number(NonNegative), "kg·m²", "About the transverse axis z."),
        Key::new("lateral", Number(NonNegative), "kg·m²", "About the forward axis x."),
        Key::new("axial", Number(NonNegative), "kg·m²", "About the link's own axis y."),
        Key::new("products", Vector(Any), "kg·m²", PRODUCTS).or("[0, 0, 0]"),
    ],
};

/// Words for a joint's axis, in the order of `Axis`.
pub(super) const AXES: &[&str] = &["roll", "yaw", "pitch"];

pub(super) static JOINT: Table = Table {
    noun: "a joint",
    doc: "A joint with one degree of freedom. Its angle counts from where the axes of its links are the platform's.",
    keys: &[
        Key::new("parent", Name, "", "The link on which the joint hangs."),
        Key::new("child", Name, "", "The link that the joint carries."),
        Key::new(
            "axis",
            Choice(AXES),
            "",
            "Axis of rotation: roll (x, forward), yaw (y, up) or pitch (z, to the right).",
        )
        .or("\"pitch\""),
        Key::new("range", Pair(Angle), "rad", "Lower and upper stop."),
        Key::new(
            "stiffness",
            Number(NonNegative),
            "N·m/rad",
            "Torque per angle of a spring beside the motor, at the joint; with `rest_angle`.",
        )
        .or("0"),
        Key::new(
            "rest_angle",
            Number(Angle),
            "rad",
            "The joint's angle at which its spring does nothing; with `stiffness`.",
        )
        .or("no spring"),
        Key::new(
            "damping",
            Number(NonNegative),
            "N·m·s/rad",
            "Torque per rate that the motor gives to overcome viscous friction, at the joint.",
        )
        .or("0"),
        Key::new(
            "coulomb",
            Number(NonNegative),
            "N·m",
            "Torque that the motor gives to overcome dry friction while the joint moves, at the joint.",
        )
        .or("0"),
        Key::new("actuator", Name, "", "The motor that drives it."),
    ],
};

pub(super) static LEG: Table = Table {
    noun: "a leg",
    doc: "A chain of joints and links that hangs on the platform.",
    keys: &[
        Key::new(
            "mount",
            Vector(Any),
            "m",
            "Its first joint in the platform's frame: x forward, y up, z to the right.",
        ),
        Key::new("first_joint", Name, "", "The joint with which the chain starts.")
            .or("the only joint that hangs on the platform"),
    ],
};

pub(super) static ACTUATOR: Table = Table {
    noun: "an actuator",
    doc: "The motor of a joint. A virtual leg has as many of them as it has legs.",
    keys: &[
        Key::new("gear", Number(Positive), "motor turns per joint turn", "Gear ratio."),
        Key::new("max_torque", Number(Positive), "N·m at the motor", "Greatest torque."),
        Key::new(
            "max_speed",
            Kind::Table(&MAX_SPEED),
            "rev/min at the motor",
            "Greatest speed, falling linearly with the torque.",
        ),
        Key::new(
            "rotor_inertia",
            Number(NonNegative),
            "kg·m² at the motor",
            "Inertia of the rotor; acts on the joint times gear².",
        ),
    ],
};

pub(super) static MAX_SPEED: Table = Table {
    noun: "the speed limits",
    doc: "Greatest speed of a motor.",
    keys: &[
        Key::new("unloaded", Number(Positive), "rev/min", "At no torque."),
        Key::new("at_max_torque", Number(Positive), "rev/min", "At the greatest torque; no more than unloaded."),
    ],
};

/// Words for the platform's rotation, in the order of `Rotation`.
pub(super) const ROTATIONS: &[&str] = &["none", "pitch", "roll"];
/// Words for the half steps, in the order of `Then`.
pub(super) const HALF_STEPS: &[&str] = &["mirrored", "distinct"];
/// Words for what follows the last phase, in the order of `Then`.
pub(super) const THEN: &[&str] = &["mirrored", "repeat"];
/// Words for the virtual legs, in their order.
pub(super) const LEGS: &[&str] = &["leg1", "leg2"];

/// The two ways to write a gait's phases.
pub(super) const TWO_WAYS: &str = "a gait has either `half_steps` with `limits.half_step_duration`, or a list of `[[phases]]`, each with \
                                   its `duration`, with `[cycle]`";

pub(super) static GAIT: Table = Table {
    noun: "a gait",
    doc: "How a gait uses the robot.",
    keys: &[
        Key::new("name", Text, "", "What the gait is called; names the generated module.").or("the file's name"),
        Key::new(
            "virtual_legs",
            NameLists,
            "",
            "The legs that move together as virtual leg 1, and those that form virtual leg 2. A gait starts on leg 1.",
        ),
        Key::new("locked", Angles, "rad", "Joints that the gait holds still, each with its angle.").or("none"),
        Key::new("platform", Kind::Table(&MOTION), "", "How the platform may move."),
        Key::new("unactuated", Coordinate, "", "The one coordinate that no actuator drives."),
        Key::new(
            "half_steps",
            Choice(HALF_STEPS),
            "",
            "Short for `phases` of the same duration without flight: whether the second half step, on leg 2, mirrors the first one.",
        )
        .only(Way::Short),
        Key::new(
            "phases",
            Tables(&PHASE),
            "",
            "What stands on the ground, one phase after another, leg 1 first; in place of `half_steps`.",
        )
        .only(Way::Long),
        Key::new("cycle", Kind::Table(&CYCLE), "", "What follows the last of the `phases`.").only(Way::Long),
        Key::new("polynomial_order", Order(&[4, 6, 8]), "", "Order of the joints' polynomials in time.").or("4"),
        Key::new("limits", Kind::Table(&LIMITS), "", "What a motion must keep to."),
    ],
};

pub(super) static PHASE: Table = Table {
    noun: "a phase",
    doc: "What stands on the ground for a while.",
    keys: &[
        Key::new("stance", Choices(LEGS), "", "The virtual leg that stands, such as [\"leg1\"]; [] in flight."),
        Key::new("duration", Pair(Positive), "s", "Shortest and longest."),
    ],
};

pub(super) static CYCLE: Table = Table {
    noun: "the cycle",
    doc: "How a list of phases becomes a cycle.",
    keys: &[Key::new(
        "then",
        Choice(THEN),
        "",
        "After the last phase: \"mirrored\", the same once more with the virtual legs' roles exchanged; \"repeat\", the first phase.",
    )],
};

/// Words for the directions of motion.
pub(super) const DIRECTIONS: &[&str] = &["x", "y", "z"];

pub(super) static MOTION: Table = Table {
    noun: "the platform's motion",
    doc: "The platform's degrees of freedom.",
    keys: &[
        Key::new(
            "moves",
            Choices(DIRECTIONS),
            "",
            "x and y (forward, up) for a planar gait; z (to the right) too where the platform rolls.",
        ),
        Key::new("rotates", Choice(ROTATIONS), "", "The one rotation: none, pitch (about z) or roll (about x)."),
    ],
};

pub(super) static LIMITS: Table = Table {
    noun: "the limits",
    doc: "Limits of a gait.",
    keys: &[
        Key::new(
            "friction",
            Number(Positive),
            "tangential / vertical force",
            "Friction coefficient between foot and ground.",
        ),
        Key::new("min_vertical_force", Number(NonNegative), "N", "Least vertical force on the stance leg."),
        Key::new(
            "swing_clearance",
            Number(NonNegative),
            "m",
            "Height of the parabola above which the swing foot stays; where it leaves the ground from rest, at a take-off, of 27/4 w²(1 − w).",
        ),
        Key::new("half_step_duration", Pair(Positive), "s", "With `half_steps`: shortest and longest half step.")
            .only(Way::Short),
        Key::new(
            "min_platform_height",
            Number(NonNegative),
            "m",
            "Least height of the platform's mass centre above the ground.",
        )
        .or("0"),
        Key::new(
            "body_clearance",
            Number(NonNegative),
            "m",
            "Least height above the ground of everything but feet: of all joints and of the corners of the platform's extent.",
        )
        .or("0"),
    ],
};

/// Whether a name leads to a number that a file may leave out: `limits.min_platform_height`, `links.shin.foot_mass`.
pub(super) fn may_be_absent(name: &str) -> bool {
    key_of(name).is_some_and(|(key, within)| matches!(key.kind, Number(_)) && within == 0 && key.default.is_some())
}

/// What a file means that says nothing under a name, as it would be written: `limits.body_clearance`, `joints.knee.axis`. `None` where
/// absence is no value.
pub fn default_of(name: &str) -> Option<&'static str> {
    let (key, within) = key_of(name)?;
    let default = key.default?;
    match (&key.kind, within) {
        // Where there is no spring it rests nowhere.
        (Number(Angle), 0) if default.parse::<f64>().is_err() => None,
        // No foot is a foot of no mass.
        (Number(_), 0) => Some(if default.parse::<f64>().is_ok() { default } else { "0" }),
        (Vector(_), 1) => Some("0"),
        (Kind::Order(_) | Choice(_), 0) => Some(default),
        _ => None,
    }
}

/// The key to which a name leads, and how many parts of the name are left, within its value.
fn key_of(name: &str) -> Option<(&'static Key, usize)> {
    let parts: Vec<&str> = name.split('.').collect();
    [&ROBOT, &GAIT].into_iter().find_map(|table| key_in(table, &parts))
}

fn key_in(table: &'static Table, parts: &[&str]) -> Option<(&'static Key, usize)> {
    let [first, rest @ ..] = parts else { return None };
    let key = table.keys.iter().find(|key| key.name == *first)?;
    match (&key.kind, rest) {
        (Kind::Table(table), [_, ..]) => key_in(table, rest),
        (Map(tables), [_, rest @ ..]) if !rest.is_empty() => tables.iter().find_map(|table| key_in(table, rest)),
        _ => Some((key, rest.len())),
    }
}
