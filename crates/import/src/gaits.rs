//! Gaits to begin with. What is written is tried against the specification's own checks, and only what passes is kept.

use super::robot::{Leg, PITCH, Robot};
use super::symmetry::Arrangement;
use super::write::number;
use piaffe_codegen::spec::{RobotFile, parse_gait};

/// Files of gaits that build.
pub struct Gaits {
    /// Name and text.
    pub files: Vec<(String, String)>,
    /// Why others are not there, a sentence each.
    pub notes: Vec<String>,
}

/// A gait to be tried.
struct Plan {
    name: &'static str,
    words: &'static str,
    /// Indices of the legs of the two virtual legs.
    virtual_legs: [Vec<usize>; 2],
    pitches: bool,
}

pub fn write(robot: &Robot, arrangement: &Arrangement, file: &RobotFile) -> Gaits {
    let mut gaits = Gaits { files: Vec::new(), notes: Vec::new() };
    for plan in plans(robot, arrangement) {
        let name = format!("{}.toml", plan.name);
        let mut refused = String::new();
        let mut halves = ["mirrored", "distinct"].into_iter().map(|halves| text(robot, &plan, halves));
        let built = halves.find(|text| match parse_gait(&name, text, file) {
            Ok(_) => true,
            Err(mistakes) => {
                refused = mistakes.first().map(|m| m.title.clone()).unwrap_or_default();
                false
            }
        });
        match built {
            Some(text) => gaits.files.push((name, text)),
            None => gaits.notes.push(format!("no {}: {refused}", plan.name)),
        }
    }
    gaits
}

/// In the order in which a person asks for them.
fn plans(robot: &Robot, arrangement: &Arrangement) -> Vec<Plan> {
    let pairs = &arrangement.pairs;
    // Every leg moves with those diagonal to it: left and right alternate, and so do pairs.
    let diagonal = |group: usize| pairs.iter().enumerate().map(|(k, pair)| pair[(k + group) % 2]).collect::<Vec<_>>();
    let level = |name, words| Plan { name, words, virtual_legs: [diagonal(0), diagonal(1)], pitches: false };
    match pairs.len() {
        1 => vec![Plan {
            name: "walk",
            words: "Walking: one leg after the other; the platform pitches.",
            virtual_legs: [diagonal(0), diagonal(1)],
            pitches: true,
        }],
        2 => {
            let bound = Plan {
                name: "bound",
                words: "Bound without flight: the hind legs move together, and so do the fore legs; the platform pitches.",
                virtual_legs: [pairs[1].to_vec(), pairs[0].to_vec()],
                pitches: true,
            };
            let trot = level("trot", "Trot: the legs of a diagonal move together; the platform stays level.");
            if arrangement.alike { vec![trot, bound] } else { vec![bound] }
        }
        _ if !robot.legs.is_empty() && arrangement.alike => {
            vec![level("tripod", "Legs alternate from pair to pair and from left to right; the platform stays level.")]
        }
        _ => Vec::new(),
    }
}

fn text(robot: &Robot, plan: &Plan, half_steps: &str) -> String {
    let names = |legs: &[usize]| {
        let quoted: Vec<String> = legs.iter().map(|k| format!("\"{}\"", robot.legs[*k].name)).collect();
        quoted.join(", ")
    };
    let [first, second] = &plan.virtual_legs;
    let haunch = robot.legs[first[0]].swings().next().map(|j| j.name.as_str()).unwrap_or_default();
    let (rotates, unactuated) = match plan.pitches {
        true => ("pitch", "platform".to_string()),
        false => ("none", format!("leg1.{haunch}")),
    };
    // What a robot of this size and weight can do without being put to the test: limits in its natural units.
    let beat = (robot.reach() / 9.81).sqrt();
    let [shortest, longest] = [round(0.25 * beat), round(10.0 * beat)];
    format!(
        "#:schema ../../schema/gait.schema.json\n# {}\n\nvirtual_legs = [[{}], [{}]]\n{}platform = {{ moves = [\"x\", \"y\"], rotates = \"{rotates}\" }}\n\
         unactuated = \"{unactuated}\"\nhalf_steps = \"{half_steps}\"\n\n\
         [limits]                                  # all assumed: shares of weight and length of the legs\n\
         friction = 0.6                            # tangential / vertical force\n\
         min_vertical_force = {}  # N, 5 % of the weight\n\
         swing_clearance = {}  # m, 2 % of a leg\n\
         half_step_duration = [{shortest}, {longest}]  # s, √(leg / gravity) is {}\n",
        plan.words,
        names(first),
        names(second),
        locked(robot),
        round(0.05 * robot.weight()),
        round(0.02 * robot.reach()),
        round(beat),
    )
}

/// Three digits: nobody means more by an assumed limit.
fn round(x: f64) -> String {
    number(format!("{x:.2e}").parse().unwrap_or(x))
}

/// Joints that leave the plane, and those below the second one that swings, at the angle nearest to zero.
fn locked(robot: &Robot) -> String {
    let mut held = Vec::new();
    for leg in &robot.legs {
        held.extend(still(leg).map(|j| format!("{} = {}", j.name, number(0.0f64.clamp(j.range[0], j.range[1])))));
    }
    if held.is_empty() { String::new() } else { format!("locked = {{ {} }}\n", held.join(", ")) }
}

/// Joints of a leg that a gait in the plane holds still.
pub fn still(leg: &Leg) -> impl Iterator<Item = &super::robot::Joint> {
    let mut swings = 0;
    leg.segments.iter().map(|s| &s.joint).filter(move |joint| {
        swings += usize::from(joint.axis == PITCH);
        joint.axis != PITCH || swings > 2
    })
}
