//! The mechanism's numbers as a static value of the runtime's types.

use super::function::{Function, ident};
use crate::mechanism::{Body, Mechanism};
use crate::spec::{HalfSteps, Rotation};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

pub(super) fn float(value: f64) -> TokenStream {
    let literal = Literal::f64_unsuffixed(value.abs());
    if value.is_sign_negative() && value != 0.0 { quote!(-#literal) } else { quote!(#literal) }
}

pub(super) fn floats(values: &[f64]) -> TokenStream {
    let values = values.iter().map(|v| float(*v));
    quote!([#(#values),*])
}

pub(super) fn body(b: &Body, runtime: &TokenStream) -> TokenStream {
    let (name, axis) = (&b.name, b.axis.index());
    let (parent, coordinate) = (option(b.parent), option(b.coordinate));
    let (offset, mass, com) = (floats(&b.offset), float(b.mass), floats(&b.com));
    let inertia = b.inertia.iter().map(|row| floats(row));
    quote! {
        #runtime::Body { name: #name, parent: #parent, coordinate: #coordinate, axis: #axis,
            offset: #offset, mass: #mass, com: #com, inertia: [#(#inertia),*] }
    }
}

pub fn description(m: &Mechanism, key: &str, functions: &[Function], runtime: &TokenStream) -> TokenStream {
    let bodies = m.bodies.iter().map(|b| body(b, runtime));
    let joints = m.joints.iter().map(|j| {
        let name = &j.name;
        let (range, gear) = (floats(&j.range), float(j.gear));
        let (torque, unloaded, loaded) = (float(j.max_torque), float(j.unloaded_speed), float(j.loaded_speed));
        let rotor = float(j.rotor_inertia);
        quote! {
            #runtime::Joint { name: #name, range: #range, gear: #gear, max_torque: #torque,
                unloaded_speed: #unloaded, loaded_speed: #loaded, rotor_inertia: #rotor }
        }
    });
    let legs = m.legs.iter().map(|l| {
        let (start, end, foot_body, foot) = (l.joints.start, l.joints.end, l.foot_body, floats(&l.foot));
        let members = l.members.iter().map(|r| {
            let (name, foot) = (&r.name, floats(&r.foot));
            let bodies = r.bodies.iter().map(|b| body(b, runtime));
            quote!(#runtime::Member { name: #name, bodies: std::borrow::Cow::Borrowed(&[#(#bodies),*]), foot: #foot })
        });
        quote!(#runtime::Leg { members: std::borrow::Cow::Borrowed(&[#(#members),*]), first_joint: #start, end_joint: #end, foot_body: #foot_body, foot: #foot })
    });
    let rotation = ident(match m.rotation {
        Rotation::None => "None",
        Rotation::Pitch => "Pitch",
        Rotation::Roll => "Roll",
    });
    let half_steps = ident(match m.half_steps {
        HalfSteps::Mirrored => "Mirrored",
        HalfSteps::Distinct => "Distinct",
    });
    let early = [0, 1].map(|leg| {
        let name = format!("early{}", leg + 1);
        functions.iter().find(|f| f.kernel.name == name).map_or(0, |f| f.kernel.outputs[0].values.len())
    });
    let operations = functions.iter().map(|f| {
        let (name, o) = (&f.kernel.name, f.program.operations());
        let (flops, divisions, sincos) = (o.flops, o.divisions, o.sincos);
        let (derived, bytes) = (f.derived.flops, f.source.len());
        quote!(#runtime::Operations { kernel: #name, flops: #flops, divisions: #divisions, sincos: #sincos,
            derived: #derived, bytes: #bytes })
    });
    let (gait, robot) = (&m.gait, &m.robot);
    let (gravity, lateral, order) = (float(m.gravity), m.lateral, m.polynomial_order);
    let unactuated = m.unactuated;
    let l = &m.limits;
    let (friction, force, clearance) = (float(l.friction), float(l.min_vertical_force), float(l.swing_clearance));
    let (duration, height) = (floats(&l.half_step_duration), float(l.min_platform_height));
    quote! {
        #runtime::Description {
            key: #key, gait: #gait, robot: #robot, gravity: #gravity, lateral: #lateral,
            rotation: #runtime::Rotation::#rotation, half_steps: #runtime::HalfSteps::#half_steps,
            bodies: std::borrow::Cow::Borrowed(&[#(#bodies),*]), joints: std::borrow::Cow::Borrowed(&[#(#joints),*]), legs: [#(#legs),*],
            unactuated: #unactuated, polynomial_order: #order, early: [#(#early),*],
            limits: #runtime::Limits { friction: #friction, min_vertical_force: #force,
                swing_clearance: #clearance, half_step_duration: #duration,
                min_platform_height: #height, real_legs: false },
            operations: &[#(#operations),*],
        }
    }
}

fn option(value: Option<usize>) -> TokenStream {
    match value {
        Some(v) => quote!(Some(#v)),
        None => quote!(None),
    }
}
