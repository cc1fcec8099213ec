//! What the parts of real legs are called: by their own names where no other leg has a part of that name, else with the leg's
//! name before it. Every model of the robot, every table and every message has these names.

use crate::spec::{Robot, Segment};

/// Names of all links or joints, leg by leg, from the platform down.
type Names = Vec<Vec<String>>;

/// Of the links: like the platform's, each is there once.
pub fn links(robot: &Robot) -> Names {
    distinct(robot, &[&robot.platform.name], |segment| &segment.link.name)
}

/// Of the joints.
pub fn joints(robot: &Robot) -> Names {
    distinct(robot, &[], |segment| &segment.joint.name)
}

fn distinct(robot: &Robot, known: &[&str], name: impl Fn(&Segment) -> &str) -> Names {
    let all: Vec<&str> = robot.legs.iter().flat_map(|leg| &leg.chain).map(&name).collect();
    let mut taken: Vec<String> = known.iter().map(ToString::to_string).collect();
    let mut one = |leg: &str, own: &str| {
        let unique = all.iter().filter(|other| **other == own).count() == 1;
        let mut name = if unique { own.to_string() } else { format!("{leg}_{own}") };
        while taken.contains(&name) {
            name.push('_');
        }
        taken.push(name.clone());
        name
    };
    robot.legs.iter().map(|leg| leg.chain.iter().map(|segment| one(&leg.name, name(segment))).collect()).collect()
}
