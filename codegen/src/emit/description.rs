//! The mechanism's numbers as a static value of the runtime's types.

use super::function::Function;
use super::shapes::shapes;
use super::tokens::{Written, float, floats, option, whole};
use crate::mechanism::{Actuated, Body, Mechanism, Member, Mode, Phase, Point, Spot, VirtualLeg, points};
use crate::spec::{Limits, Rotation, Then};
use proc_macro2::TokenStream;
use quote::quote;
use syn::Path;

/// A `Description`; `lowest` tells which of the mechanism's points can be the lowest.
pub fn description(
    m: &Mechanism,
    key: &str,
    lowest: &[usize],
    functions: &[&Function],
    runtime: &Path,
) -> Written<TokenStream> {
    let rotation = match m.rotation {
        Rotation::None => quote!(None),
        Rotation::Pitch => quote!(Pitch),
        Rotation::Roll => quote!(Roll),
    };
    let phases = each(&m.phases, |p| phase(p, runtime))?;
    let then = match m.then {
        Then::Mirrored => quote!(Mirrored),
        Then::Repeat => quote!(Repeat),
    };
    let (gait, robot, gravity) = (&m.gait, &m.robot, float(m.gravity)?);
    let (bodies, joints) = (each(&m.bodies, |b| body(b, runtime))?, each(&m.joints, |j| joint(j, runtime))?);
    let (legs, limits) = (each(&m.legs, |l| leg(l, runtime))?, limits(&m.limits, runtime)?);
    let (unactuated, order) = (whole(m.unactuated), whole(m.polynomial_order));
    let shapes = shapes(functions, &quote!(#runtime::shape::Shapes), runtime)?;
    let operations = functions.iter().map(|f| operations(f, runtime));
    let corners = each(&m.corners, |s| spot(s, runtime))?;
    let points = points(m).into_iter().map(|p| point(&p, runtime));
    let lowest = lowest.iter().copied().map(whole);
    Ok(quote! {
        #runtime::Description {
            key: #key,
            gait: #gait,
            robot: #robot,
            gravity: #gravity,
            rotation: #runtime::Rotation::#rotation,
            phases: std::borrow::Cow::Borrowed(&[#(#phases),*]),
            then: #runtime::Then::#then,
            bodies: std::borrow::Cow::Borrowed(&[#(#bodies),*]),
            corners: std::borrow::Cow::Borrowed(&[#(#corners),*]),
            joints: std::borrow::Cow::Borrowed(&[#(#joints),*]),
            legs: [#(#legs),*],
            unactuated: #unactuated,
            polynomial_order: #order,
            points: &[#(#points),*],
            lowest: &[#(#lowest),*],
            limits: #limits,
            shapes: &#shapes,
            operations: &[#(#operations),*],
        }
    })
}

fn phase(p: &Phase, runtime: &Path) -> Written<TokenStream> {
    let mode = match p.mode {
        Mode::Stance(leg) => {
            let leg = whole(leg);
            quote!(Stance(#leg))
        }
        Mode::Flight => quote!(Flight),
    };
    let duration = floats(p.duration)?;
    Ok(quote!(#runtime::Phase { mode: #runtime::Mode::#mode, duration: #duration }))
}

/// What each of some things is in the code.
pub fn each<T>(things: &[T], tokens: impl Fn(&T) -> Written<TokenStream>) -> Written<Vec<TokenStream>> {
    things.iter().map(tokens).collect()
}

pub fn body(b: &Body, runtime: &Path) -> Written<TokenStream> {
    let (name, parent, coordinate, axis) = (&b.name, option(b.parent), option(b.coordinate), whole(b.axis.index()));
    let (offset, mass, com) = (floats(b.offset)?, float(b.mass)?, floats(b.com)?);
    let inertia = b.inertia.into_iter().map(floats).collect::<Written<Vec<_>>>()?;
    Ok(quote! {
        #runtime::Body {
            name: #name,
            parent: #parent,
            coordinate: #coordinate,
            axis: #axis,
            offset: #offset,
            mass: #mass,
            com: #com,
            inertia: [#(#inertia),*],
        }
    })
}

fn joint(j: &Actuated, runtime: &Path) -> Written<TokenStream> {
    let (name, range, gear, max_torque) = (&j.name, floats(j.range)?, float(j.gear)?, float(j.max_torque)?);
    let (unloaded, loaded, rotor) = (float(j.unloaded_speed)?, float(j.loaded_speed)?, float(j.rotor_inertia)?);
    let (stiffness, rest) = (float(j.stiffness)?, float(j.rest)?);
    let (damping, coulomb) = (float(j.damping)?, float(j.coulomb)?);
    Ok(quote! {
        #runtime::Joint {
            name: #name,
            range: #range,
            gear: #gear,
            max_torque: #max_torque,
            unloaded_speed: #unloaded,
            loaded_speed: #loaded,
            rotor_inertia: #rotor,
            stiffness: #stiffness,
            rest: #rest,
            damping: #damping,
            coulomb: #coulomb,
        }
    })
}

fn leg(l: &VirtualLeg, runtime: &Path) -> Written<TokenStream> {
    let (members, foot) = (each(&l.members, |m| member(m, runtime))?, floats(l.foot)?);
    let [first, end, foot_body] = [l.joints.start, l.joints.end, l.foot_body].map(whole);
    Ok(quote! {
        #runtime::Leg {
            members: std::borrow::Cow::Borrowed(&[#(#members),*]),
            first_joint: #first,
            end_joint: #end,
            foot_body: #foot_body,
            foot: #foot,
        }
    })
}

fn member(m: &Member, runtime: &Path) -> Written<TokenStream> {
    let (name, joints, foot) = (&m.name, &m.joints, floats(m.foot)?);
    let bodies = each(&m.bodies, |b| body(b, runtime))?;
    let spots = each(&m.spots, |s| spot(s, runtime))?;
    Ok(quote! {
        #runtime::Member {
            name: #name,
            bodies: std::borrow::Cow::Borrowed(&[#(#bodies),*]),
            joints: std::borrow::Cow::Borrowed(&[#(#joints),*]),
            foot: #foot,
            spots: std::borrow::Cow::Borrowed(&[#(#spots),*]),
        }
    })
}

fn spot(s: &Spot, runtime: &Path) -> Written<TokenStream> {
    let (body, at) = (whole(s.body), floats(s.at)?);
    Ok(quote!(#runtime::Spot { body: #body, at: #at }))
}

fn point(p: &Point, runtime: &Path) -> TokenStream {
    let of = p.of.map(|(leg, member)| [leg, member].map(whole));
    let of = of.map_or(quote!(None), |[leg, member]| quote!(Some((#leg, #member))));
    let (name, spot, leg, mirrored) = (&p.name, whole(p.spot), whole(p.leg), p.mirrored);
    quote!(#runtime::Point { name: #name, of: #of, spot: #spot, leg: #leg, mirrored: #mirrored })
}

fn limits(l: &Limits, runtime: &Path) -> Written<TokenStream> {
    let (friction, force, clearance) = (float(l.friction)?, float(l.min_vertical_force)?, float(l.swing_clearance)?);
    let (height, body_clearance) = (float(l.min_platform_height)?, float(l.body_clearance)?);
    Ok(quote! {
        #runtime::Limits {
            friction: #friction,
            min_vertical_force: #force,
            swing_clearance: #clearance,
            min_platform_height: #height,
            body_clearance: #body_clearance,
            real_legs: false,
        }
    })
}

fn operations(f: &Function, runtime: &Path) -> TokenStream {
    let (kernel, o) = (&f.kernel.name, f.operations);
    let counts = [o.flops, o.divisions, o.sincos, f.derived.flops, f.source.len()];
    let [flops, divisions, sincos, derived, bytes] = counts.map(whole);
    quote! {
        #runtime::Operations {
            kernel: #kernel,
            flops: #flops,
            divisions: #divisions,
            sincos: #sincos,
            derived: #derived,
            bytes: #bytes,
        }
    }
}
