//! A mechanism's numbers as values of the runtime's types: what a build writes as code.

use super::derived::Derived;
use super::kept::{kept, text};
use piaffe_codegen::mechanism::{self, Mechanism, points};
use piaffe_codegen::spec;
use piaffe_model::{Body, Description, Joint, Leg, Limits, Member, Mode, Phase, Point, Rotation, Spot, Then, shape};
use std::borrow::Cow;

/// The description of a gait with the name `key`.
pub fn description(m: &Mechanism, key: &str, derived: &Derived) -> Description {
    Description {
        lowest: kept(derived.lowest.clone()),
        shapes: &kept(vec![shape::Shapes::named("", &|name| derived.shapes.block(name))])[0],
        operations: derived.operations(),
        ..underived(m, key)
    }
}

/// The same without what has to be derived.
pub fn underived(m: &Mechanism, key: &str) -> Description {
    let mut description = Description {
        key: text(key),
        gait: text(&m.gait),
        robot: text(&m.robot),
        gravity: m.gravity,
        rotation: match m.rotation {
            spec::Rotation::None => Rotation::None,
            spec::Rotation::Pitch => Rotation::Pitch,
            spec::Rotation::Roll => Rotation::Roll,
        },
        phases: each(&m.phases, phase),
        then: match m.then {
            spec::Then::Mirrored => Then::Mirrored,
            spec::Then::Repeat => Then::Repeat,
        },
        bodies: each(&m.bodies, body),
        corners: each(&m.corners, spot),
        joints: each(&m.joints, joint),
        legs: m.legs.each_ref().map(leg),
        unactuated: m.unactuated,
        polynomial_order: m.polynomial_order,
        points: kept(points(m).iter().map(point).collect()),
        lowest: &[],
        limits: limits(&m.limits),
        shapes: &shape::Shapes::NONE,
        operations: &[],
    };
    // As code has them: zero without a sign.
    description.for_each_number(&mut |number| *number += 0.0);
    description
}

fn each<T, U: Clone>(things: &[T], make: impl Fn(&T) -> U) -> Cow<'static, [U]> {
    things.iter().map(make).collect()
}

pub fn body(b: &mechanism::Body) -> Body {
    let mechanism::Body { name, parent, coordinate, axis, offset, mass, com, inertia, .. } = b;
    Body {
        name: text(name),
        parent: *parent,
        coordinate: *coordinate,
        axis: axis.index(),
        offset: *offset,
        mass: *mass,
        com: *com,
        inertia: *inertia,
    }
}

fn phase(p: &mechanism::Phase) -> Phase {
    let mode = match p.mode {
        mechanism::Mode::Stance(leg) => Mode::Stance(leg),
        mechanism::Mode::Flight => Mode::Flight,
    };
    Phase { mode, duration: p.duration }
}

fn joint(j: &mechanism::Actuated) -> Joint {
    Joint {
        name: text(&j.name),
        range: j.range,
        gear: j.gear,
        max_torque: j.max_torque,
        unloaded_speed: j.unloaded_speed,
        loaded_speed: j.loaded_speed,
        rotor_inertia: j.rotor_inertia,
        stiffness: j.stiffness,
        rest: j.rest,
        damping: j.damping,
        coulomb: j.coulomb,
    }
}

fn leg(l: &mechanism::VirtualLeg) -> Leg {
    Leg {
        members: each(&l.members, member),
        first_joint: l.joints.start,
        end_joint: l.joints.end,
        foot_body: l.foot_body,
        foot: l.foot,
    }
}

fn member(m: &mechanism::Member) -> Member {
    Member {
        name: text(&m.name),
        bodies: each(&m.bodies, body),
        joints: each(&m.joints, |name| text(name)),
        foot: m.foot,
        spots: each(&m.spots, spot),
    }
}

fn spot(s: &mechanism::Spot) -> Spot {
    Spot { body: s.body, at: s.at }
}

fn point(p: &mechanism::Point) -> Point {
    Point { name: text(&p.name), of: p.of, spot: p.spot, leg: p.leg, mirrored: p.mirrored }
}

fn limits(l: &spec::Limits) -> Limits {
    Limits {
        friction: l.friction,
        min_vertical_force: l.min_vertical_force,
        swing_clearance: l.swing_clearance,
        min_platform_height: l.min_platform_height,
        body_clearance: l.body_clearance,
        real_legs: false,
    }
}
