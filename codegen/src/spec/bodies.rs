//! Single tables of `robot.toml` → plain values: the platform, links, inertias, actuators.

use super::Code;
use super::diagnostic::Sink;
use super::locked::tensor;
use super::rigid::Rigid;
use super::types::{Actuator, Extent, Inertia, Link, Platform};
use super::view::View;

pub(super) fn platform(name: &str, view: &View<'_>, sink: &mut Sink) -> Option<Platform> {
    let mass = view.number("mass", sink);
    let com = if view.has("com") { view.vector("com", sink).map(|at| at.value) } else { Some([0.0; 3]) };
    let inertia = inertia(view, ["roll", "yaw", "pitch"], sink);
    let extent = if view.has("extent") { extent(view, sink).map(Some) } else { Some(None) };
    Some(Platform { name: name.to_string(), mass: mass?.value, com: com?, inertia: inertia?, extent: extent? })
}

fn extent(view: &View<'_>, sink: &mut Sink) -> Option<Extent> {
    let extent = view.table("extent", sink)?;
    let size = extent.vector("size", sink);
    let centre = if extent.has("centre") { extent.vector("centre", sink).map(|at| at.value) } else { Some([0.0; 3]) };
    Some(Extent { size: size?.value, centre: centre? })
}

pub(super) fn link(name: &str, view: &View<'_>, sink: &mut Sink) -> Option<Link> {
    let mass = view.number("mass", sink);
    let end = view.along("length", sink);
    let com = view.along("com", sink);
    let inertia = inertia(view, ["lateral", "axial", "swing"], sink);
    let foot_mass = if view.has("foot_mass") { view.number("foot_mass", sink)?.value } else { 0.0 };
    Some(Link {
        name: name.to_string(),
        mass: mass?.value,
        end: end?,
        com: com?,
        inertia: inertia?,
        foot_mass,
        locked: Vec::new(),
    })
}

/// Moments about x, y, z under their names in this table, and products. No moment of a rigid body exceeds the
/// sum of the other two: Ix + Iy - Iz = 2 ∫ z² dm ≥ 0.
fn inertia(view: &View<'_>, keys: [&str; 3], sink: &mut Sink) -> Option<Inertia> {
    let moments = view.table("inertia", sink)?;
    let read = keys.map(|key| moments.number(key, sink));
    let [Some(x), Some(y), Some(z)] = read else {
        return None;
    };
    let values = [x.value, y.value, z.value];
    for (i, at) in [x, y, z].iter().enumerate() {
        let others = values[(i + 1) % 3] + values[(i + 2) % 3];
        // Some slack for data in decimal digits: a flat plate has exactly the sum.
        if at.value > others * (1.0 + 1e-9) {
            let [a, b] = [keys[(i + 1) % 3], keys[(i + 2) % 3]];
            let title = format!("`{}`: an inertia that no rigid body can have", view.join("inertia"));
            let label = format!("more than {a} + {b} = {}", short(others));
            let help = format!(
                "no moment exceeds the sum of the other two: write {} = {} or less, or raise the others",
                keys[i],
                short(others)
            );
            sink.report(Code::ImpossibleInertia, title, &at.span, label, help);
            return None;
        }
    }
    if !moments.has("products") {
        return Some(tensor(values, [0.0; 3]));
    }
    let products = moments.vector("products", sink)?;
    let inertia = tensor(values, products.value);
    if !(Rigid { mass: 0.0, com: [0.0; 3], inertia }).is_possible() {
        let title = format!("`{}`: an inertia that no rigid body can have", view.join("inertia"));
        let help =
            "the order is [∫yz dm, ∫zx dm, ∫xy dm]; the signs are those of the integrals, opposite to Iyz, Izx, Ixy";
        sink.report(Code::ImpossibleInertia, title, &products.span, "too large for these moments", help);
        return None;
    }
    Some(inertia)
}

/// A sum of decimal numbers without the noise of its last digits.
fn short(x: f64) -> f64 {
    format!("{x:.9e}").parse().unwrap_or(x)
}

pub(super) fn actuator(name: &str, view: &View<'_>, sink: &mut Sink) -> Option<Actuator> {
    let gear = view.number("gear", sink);
    let max_torque = view.number("max_torque", sink);
    let speeds = view.table("max_speed", sink).and_then(|speeds| {
        let unloaded = speeds.number("unloaded", sink);
        let loaded = speeds.number("at_max_torque", sink);
        let (unloaded, loaded) = (unloaded?, loaded?);
        if loaded.value <= unloaded.value {
            return Some((unloaded.value, loaded.value));
        }
        let title = format!("`{}` rises with the torque", view.join("max_speed"));
        let help = format!(
            "a loaded motor turns slower: write unloaded = {}, at_max_torque = {}",
            loaded.value, unloaded.value
        );
        sink.report(Code::SpeedRisesWithTorque, title, &loaded.span, "faster than unloaded", help);
        sink.beside(sink.label(&unloaded.span, "unloaded"));
        None
    });
    let rotor_inertia = view.number("rotor_inertia", sink);
    let (unloaded_speed, loaded_speed) = speeds?;
    Some(Actuator {
        name: name.to_string(),
        gear: gear?.value,
        max_torque: max_torque?.value,
        unloaded_speed,
        loaded_speed,
        rotor_inertia: rotor_inertia?.value,
    })
}
