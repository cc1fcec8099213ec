//! Gaits to begin with: those that legs like these have. What is written is tried against the specification's own checks, and only
//! what passes is kept.

use super::robot::{Leg, PITCH, Robot};
use super::symmetry::Arrangement;
use super::write::number;
use piaffe_codegen::spec::{RobotFile, parse_gait};

/// A gait that legs like these have; whether these have it, [`Import::tried`](super::Import::tried) tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    pub name: String,
    /// What it is, a sentence or two.
    pub words: String,
    /// The same with less and less clearance.
    pub variants: [Variant; CLEARANCES.len()],
    /// Of a gait that flies: the one that stands alike and never does.
    pub grounded: Option<String>,
}

/// A gait file with assumed limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Of swing feet, m.
    pub clearance: f64,
    text: String,
}

impl Candidate {
    /// The file of a variant, with these lines about it.
    pub fn file(&self, variant: &Variant, lines: &[String]) -> String {
        let comments: String = lines.iter().map(|line| format!("# {line}\n")).collect();
        format!("#:schema ../../schema/gait.schema.json\n# {}\n{comments}{}", self.words, variant.text)
    }
}

pub fn file_name(gait: &str) -> String {
    format!("{gait}.toml")
}

/// Candidates whose files build.
pub struct Gaits {
    pub candidates: Vec<Candidate>,
    /// Why others are not there, a sentence each.
    pub notes: Vec<String>,
}

/// A way to use the legs.
struct Plan {
    name: &'static str,
    words: &'static str,
    /// Indices of the legs of the two virtual legs.
    virtual_legs: [Vec<usize>; 2],
    pitches: bool,
    flights: Option<Flights>,
}

/// Of a gait that flies.
#[derive(Clone, Copy)]
struct Flights {
    /// The gait that stands alike and never flies.
    grounded: &'static str,
    /// Whether a flight follows each stance, or only that of virtual leg 2.
    after_each: bool,
}

/// Heights that swing feet are asked to keep, as shares of a leg.
const CLEARANCES: [f64; 3] = [0.02, 0.01, 0.005];

pub fn find(robot: &Robot, arrangement: &Arrangement, file: &RobotFile) -> Gaits {
    let mut gaits = Gaits { candidates: Vec::new(), notes: Vec::new() };
    for plan in plans(robot, arrangement) {
        let name = file_name(plan.name);
        let mut refused = String::new();
        let built = ["mirrored", "distinct"].into_iter().find_map(|halves| {
            let candidate = candidate(robot, &plan, halves);
            match parse_gait(&name, &candidate.file(&candidate.variants[0], &[]), file) {
                Ok(_) => Some(candidate),
                Err(mistakes) => {
                    refused = mistakes.first().map(|m| m.title.clone()).unwrap_or_default();
                    None
                }
            }
        });
        match built {
            Some(candidate) => gaits.candidates.push(candidate),
            None if plan.flights.is_some() => {}
            None => gaits.notes.push(format!("no {}: {refused}", plan.name)),
        }
    }
    gaits
}

fn candidate(robot: &Robot, plan: &Plan, halves: &str) -> Candidate {
    let variant = |share: f64| {
        let clearance = share * robot.reach();
        Variant { clearance, text: text(robot, plan, halves, clearance) }
    };
    Candidate {
        name: plan.name.into(),
        words: plan.words.into(),
        variants: CLEARANCES.map(variant),
        grounded: plan.flights.map(|flights| flights.grounded.to_string()),
    }
}

/// In the order in which a person asks for them.
fn plans(robot: &Robot, arrangement: &Arrangement) -> Vec<Plan> {
    let pairs = &arrangement.pairs;
    // Every leg moves with those diagonal to it: left and right alternate, and so do pairs.
    let diagonal = |group: usize| pairs.iter().enumerate().map(|(k, pair)| pair[(k + group) % 2]).collect::<Vec<_>>();
    let alternating =
        |name, pitches, words| Plan { name, words, virtual_legs: [diagonal(0), diagonal(1)], pitches, flights: None };
    let after_each = |grounded| Some(Flights { grounded, after_each: true });
    let after_last = |grounded| Some(Flights { grounded, after_each: false });
    match pairs.len() {
        1 => {
            let walk = alternating("walk", true, "Walking: one leg after the other; the platform pitches.");
            let run = alternating(
                "run",
                true,
                "Running: flights between the stances of one leg and the other; the platform pitches.",
            );
            vec![walk, Plan { flights: after_each("walk"), ..run }]
        }
        2 => {
            let bounding = |name, words| Plan {
                name,
                words,
                virtual_legs: [pairs[1].to_vec(), pairs[0].to_vec()],
                pitches: true,
                flights: None,
            };
            let bound = bounding(
                "bound",
                "Bound without flight: the hind legs move together, and so do the fore legs; the platform pitches.",
            );
            let flying = bounding(
                "running_bound",
                "Bound with a flight from the fore legs to the hind legs: each pair moves together; the platform pitches.",
            );
            let flying = Plan { flights: after_last("bound"), ..flying };
            if !arrangement.alike {
                return vec![bound, flying];
            }
            let trot =
                alternating("trot", false, "Trot: the legs of a diagonal move together; the platform stays level.");
            let running = alternating(
                "running_trot",
                false,
                "Running trot: the legs of a diagonal move together, with flights in between; the platform stays level.",
            );
            vec![trot, Plan { flights: after_each("trot"), ..running }, bound, flying]
        }
        _ if !robot.legs.is_empty() && arrangement.alike => vec![alternating(
            alternating_name(pairs.len()),
            false,
            "Legs alternate from pair to pair and from left to right; the platform stays level.",
        )],
        _ => Vec::new(),
    }
}

/// What the gait of alternating legs of this many pairs is called: by how many stand at a time.
pub fn alternating_name(pairs: usize) -> &'static str {
    match pairs {
        3 => "tripod",
        4 => "tetrapod",
        _ => "alternating",
    }
}

fn text(robot: &Robot, plan: &Plan, halves: &str, clearance: f64) -> String {
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
    let beat = (robot.reach() / robot.fall()).sqrt();
    let duration = |shortest: f64, longest: f64| format!("[{}, {}]", round(shortest * beat), round(longest * beat));
    let (phases, half_steps) = match plan.flights {
        None => (
            format!("half_steps = \"{halves}\"\n"),
            format!("half_step_duration = {}  # s, √(leg / gravity) is {}\n", duration(0.25, 10.0), round(beat)),
        ),
        Some(flights) => (phases(halves, flights, &duration(0.25, 10.0), &duration(0.1, 3.0)), String::new()),
    };
    format!(
        "\nvirtual_legs = [[{}], [{}]]\n{}platform = {{ moves = [\"x\", \"y\"], rotates = \"{rotates}\" }}\n\
         unactuated = \"{unactuated}\"\n{phases}\n\
         [limits]                                  # all assumed: shares of weight and length of the legs\n\
         friction = 0.6                            # tangential / vertical force\n\
         min_vertical_force = {}  # N, 5 % of the weight\n\
         swing_clearance = {}  # m, {} % of a leg\n\
         {half_steps}",
        names(first),
        names(second),
        locked(robot),
        round(0.05 * robot.weight()),
        round(clearance),
        round(100.0 * clearance / robot.reach()),
    )
}

/// Half a cycle where its halves mirror each other, else all of it.
fn phases(halves: &str, flights: Flights, stance: &str, flight: &str) -> String {
    let phase =
        |stance: &str, duration: &str| format!("\n[[phases]]\nstance = [{stance}]\nduration = {duration}  # s\n");
    let [first, second] = ["leg1", "leg2"].map(|leg| phase(&format!("\"{leg}\""), stance));
    let flying = phase("", flight);
    let (list, then) = match (halves, flights.after_each) {
        ("mirrored", _) => (first + &flying, "mirrored"),
        (_, true) => (first + &flying + &second + &flying, "repeat"),
        (_, false) => (first + &second + &flying, "repeat"),
    };
    format!("{list}\n[cycle]\nthen = \"{then}\"\n")
}

/// Three digits: nobody means more by an assumed limit.
fn round(x: f64) -> String {
    number(format!("{x:.2e}").parse().unwrap_or(x))
}

fn locked(robot: &Robot) -> String {
    let held = held(robot);
    if held.is_empty() { String::new() } else { format!("locked = {{ {} }}\n", held.join(", ")) }
}

/// Joints that a gait in the plane holds still, each at the angle nearest to zero: those that leave the plane, and those below the
/// second one that swings.
pub fn held(robot: &Robot) -> Vec<String> {
    let held = robot.legs.iter().flat_map(still);
    held.map(|j| format!("{} = {}", j.name, number(0.0f64.clamp(j.range[0], j.range[1])))).collect()
}

/// Joints of a leg that a gait in the plane holds still.
pub fn still(leg: &Leg) -> impl Iterator<Item = &super::robot::Joint> {
    let mut swings = 0;
    leg.segments.iter().map(|s| &s.joint).filter(move |joint| {
        swings += usize::from(joint.axis == PITCH);
        joint.axis != PITCH || swings > 2
    })
}
