//! The module of a whole robot, which its gaits share.

use super::description::body;
use super::function::{Function, functions};
use super::gait::{constant, getter, header, items, methods};
use super::layout::Layout;
use super::modules::key;
use crate::dynamics::whole_kernels;
use crate::mechanism::{Whole, WholeJoint, WholeLeg};
use crate::spec::name::WHOLE;

/// Source of the module of a robot. `runtime` is the path of the module with the `Whole` trait; without it there
/// are functions only.
pub fn whole_source(whole: &Whole, runtime: Option<&str>, origin: &str) -> String {
    let (ring, kernels) = whole_kernels(whole);
    let functions = functions(&ring, &kernels);
    let mut source = header(origin);
    source += &items(&functions);
    if let Some(runtime) = runtime {
        implementation(whole, &functions, runtime, &mut source);
    }
    source
}

/// Name of the module with the `number`-th way in which the gaits of a robot lock its joints.
pub fn whole_module(number: usize) -> String {
    if number == 0 { WHOLE.into() } else { format!("{WHOLE}{}", number + 1) }
}

/// Name of its generated file.
pub fn whole_file_name(robot: &str, number: usize) -> String {
    key(robot, &format!("{}.rs", whole_module(number)))
}

fn implementation(whole: &Whole, functions: &[Function], runtime: &str, out: &mut String) {
    *out +=
        &format!("/// The whole robot `{}`.\n#[derive(Clone, Copy, Debug, Default)]\npub struct Whole;\n", whole.robot);
    let ty = format!("{runtime}::whole::Description");
    let numbers = Layout::record(
        ty.clone(),
        [
            ("robot", Layout::value(&whole.robot)),
            ("gravity", Layout::float(whole.gravity)),
            ("bodies", Layout::list("&[", whole.bodies.iter().map(|b| body(b, runtime)), "]")),
            ("joints", Layout::list("&[", whole.joints.iter().map(|j| joint(j, runtime)), "]")),
            ("legs", Layout::list("&[", whole.legs.iter().map(|l| leg(l, runtime)), "]")),
        ],
    );
    constant("What the robot is made of, in numbers.", "DESCRIPTION", &ty, numbers, out);
    *out += &format!("impl {runtime}::whole::Whole for Whole {{");
    getter("description", &format!("&'static {ty}"), Layout::Word("&DESCRIPTION".into()), out);
    methods(functions, out);
    *out += "\n}\n";
}

fn joint(j: &WholeJoint, runtime: &str) -> Layout {
    let fields = [("name", Layout::value(&j.name)), ("rotor_inertia", Layout::float(j.rotor_inertia))];
    Layout::record(format!("{runtime}::whole::Joint"), fields)
}

fn leg(l: &WholeLeg, runtime: &str) -> Layout {
    Layout::record(
        format!("{runtime}::whole::Leg"),
        [
            ("name", Layout::value(&l.name)),
            ("joints", Layout::value(&l.joints)),
            ("foot_body", Layout::value(l.foot_body)),
            ("foot", Layout::floats(l.foot)),
        ],
    )
}
