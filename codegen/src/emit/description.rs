//! The mechanism's numbers as a static value of the runtime's types.

use super::function::Function;
use super::layout::Layout;
use crate::mechanism::{Actuated, Body, Mechanism, Member, Point, Spot, VirtualLeg, points};
use crate::spec::{HalfSteps, Limits, Rotation};

/// A `Description`; `lowest` tells which of the mechanism's points can be the lowest.
pub fn description(m: &Mechanism, key: &str, lowest: &[usize], functions: &[Function], runtime: &str) -> Layout {
    let rotation = match m.rotation {
        Rotation::None => "None",
        Rotation::Pitch => "Pitch",
        Rotation::Roll => "Roll",
    };
    let half_steps = match m.half_steps {
        HalfSteps::Mirrored => "Mirrored",
        HalfSteps::Distinct => "Distinct",
    };
    let early = [0, 1].map(|leg| {
        let name = format!("early{}", leg + 1);
        functions.iter().find(|f| f.kernel.name == name).map_or(0, |f| f.kernel.outputs[0].values.len())
    });
    Layout::record(
        format!("{runtime}::Description"),
        [
            ("key", Layout::value(key)),
            ("gait", Layout::value(&m.gait)),
            ("robot", Layout::value(&m.robot)),
            ("gravity", Layout::float(m.gravity)),
            ("lateral", Layout::value(m.lateral)),
            ("rotation", Layout::Word(format!("{runtime}::Rotation::{rotation}"))),
            ("half_steps", Layout::Word(format!("{runtime}::HalfSteps::{half_steps}"))),
            ("bodies", borrowed(m.bodies.iter().map(|b| body(b, runtime)))),
            ("corners", borrowed(m.corners.iter().map(|s| spot(s, runtime)))),
            ("joints", borrowed(m.joints.iter().map(|j| joint(j, runtime)))),
            ("legs", Layout::list("[", m.legs.iter().map(|l| leg(l, runtime)), "]")),
            ("unactuated", Layout::value(m.unactuated)),
            ("polynomial_order", Layout::value(m.polynomial_order)),
            ("early", Layout::value(early)),
            ("points", Layout::list("&[", points(m).iter().map(|p| point(p, runtime)), "]")),
            ("lowest", Layout::list("&[", lowest.iter().map(Layout::value), "]")),
            ("limits", limits(&m.limits, runtime)),
            ("operations", Layout::list("&[", functions.iter().map(|f| operations(f, runtime)), "]")),
        ],
    )
}

/// A `Cow` of a slice.
fn borrowed(items: impl Iterator<Item = Layout>) -> Layout {
    Layout::list("std::borrow::Cow::Borrowed(&[", items, "])")
}

pub fn body(b: &Body, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Body"),
        [
            ("name", Layout::value(&b.name)),
            ("parent", Layout::value(b.parent)),
            ("coordinate", Layout::value(b.coordinate)),
            ("axis", Layout::value(b.axis.index())),
            ("offset", Layout::floats(b.offset)),
            ("mass", Layout::float(b.mass)),
            ("com", Layout::floats(b.com)),
            ("inertia", Layout::list("[", b.inertia.map(Layout::floats), "]")),
        ],
    )
}

fn joint(j: &Actuated, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Joint"),
        [
            ("name", Layout::value(&j.name)),
            ("range", Layout::floats(j.range)),
            ("gear", Layout::float(j.gear)),
            ("max_torque", Layout::float(j.max_torque)),
            ("unloaded_speed", Layout::float(j.unloaded_speed)),
            ("loaded_speed", Layout::float(j.loaded_speed)),
            ("rotor_inertia", Layout::float(j.rotor_inertia)),
        ],
    )
}

fn leg(l: &VirtualLeg, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Leg"),
        [
            ("members", borrowed(l.members.iter().map(|m| member(m, runtime)))),
            ("first_joint", Layout::value(l.joints.start)),
            ("end_joint", Layout::value(l.joints.end)),
            ("foot_body", Layout::value(l.foot_body)),
            ("foot", Layout::floats(l.foot)),
        ],
    )
}

fn member(m: &Member, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Member"),
        [
            ("name", Layout::value(&m.name)),
            ("bodies", borrowed(m.bodies.iter().map(|b| body(b, runtime)))),
            ("joints", borrowed(m.joints.iter().map(Layout::value))),
            ("foot", Layout::floats(m.foot)),
            ("spots", borrowed(m.spots.iter().map(|s| spot(s, runtime)))),
        ],
    )
}

fn spot(s: &Spot, runtime: &str) -> Layout {
    Layout::record(format!("{runtime}::Spot"), [("body", Layout::value(s.body)), ("at", Layout::floats(s.at))])
}

fn point(p: &Point, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Point"),
        [
            ("name", Layout::value(&p.name)),
            ("of", Layout::value(p.of)),
            ("spot", Layout::value(p.spot)),
            ("leg", Layout::value(p.leg)),
            ("mirrored", Layout::value(p.mirrored)),
        ],
    )
}

fn limits(l: &Limits, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::Limits"),
        [
            ("friction", Layout::float(l.friction)),
            ("min_vertical_force", Layout::float(l.min_vertical_force)),
            ("swing_clearance", Layout::float(l.swing_clearance)),
            ("half_step_duration", Layout::floats(l.half_step_duration)),
            ("min_platform_height", Layout::float(l.min_platform_height)),
            ("body_clearance", Layout::float(l.body_clearance)),
            ("real_legs", Layout::value(false)),
        ],
    )
}

fn operations(f: &Function, runtime: &str) -> Layout {
    let o = f.operations;
    Layout::record(
        format!("{runtime}::Operations"),
        [
            ("kernel", Layout::value(&f.kernel.name)),
            ("flops", Layout::value(o.flops)),
            ("divisions", Layout::value(o.divisions)),
            ("sincos", Layout::value(o.sincos)),
            ("derived", Layout::value(f.derived.flops)),
            ("bytes", Layout::value(f.source.len())),
        ],
    )
}
