//! The real legs that make up a virtual leg (§2.1): legs that move as one, so that a virtual leg has the
//! lengths of its legs and the sums of their masses, inertias and torques.

use super::Code;
use super::as_one::{Motion, Unlike, driven_unlike};
use super::decode::Names;
use super::diagnostic::{Label, Sink, Span};
use super::format::DIRECTIONS;
use super::gait::RawGait;
use super::nearest::nearest;
use super::robot::RobotFile;
use super::types::{Leg, Rotation};

/// Resolves the two virtual legs: indices into the robot's legs. `at` is where the key stands.
pub(super) fn virtual_legs(raw: &RawGait, at: &Span, robot: &RobotFile, sink: &mut Sink) -> Option<[Vec<usize>; 2]> {
    let lists = raw.virtual_legs.as_ref()?;
    let [first, second] = &lists.value[..] else {
        let title = format!("a gait has two virtual legs, this one has {}", lists.value.len());
        let help = "write two lists of legs: virtual_legs = [[\"…\", \"…\"], [\"…\", \"…\"]]";
        sink.report(Code::NotTwoVirtualLegs, title, &lists.span, "expected two lists", help);
        return None;
    };
    let resolved = [first, second].map(|list| resolve(list, robot, sink));
    let [Some(first_legs), Some(second_legs)] = resolved else {
        return None;
    };
    let once = check_each_once([(first, &first_legs), (second, &second_legs)], at, robot, sink);
    let paired =
        [(first, &first_legs), (second, &second_legs)].map(|(list, legs)| check_pair(raw, list, legs, robot, sink));
    (once && paired == [true, true]).then_some([first_legs, second_legs])
}

fn resolve(list: &Names, robot: &RobotFile, sink: &mut Sink) -> Option<Vec<usize>> {
    let legs = &robot.robot.legs;
    if list.value.is_empty() {
        let title = "a virtual leg without legs";
        sink.report(
            Code::NotTwoVirtualLegs,
            title,
            &list.span,
            "expected names of legs",
            format!("write some of {}", names(legs)),
        );
        return None;
    }
    let resolved: Vec<_> = list
        .value
        .iter()
        .map(|name| {
            let found = legs.iter().position(|leg| leg.name == name.value);
            if found.is_none() {
                let help = match nearest(&name.value, legs.iter().map(|leg| leg.name.as_str())) {
                    Some(near) => format!("did you mean \"{near}\"?"),
                    None => format!("the robot has the legs {}", names(legs)),
                };
                sink.report(
                    Code::UnknownName,
                    format!("there is no leg `{}`", name.value),
                    &name.span,
                    "no such leg",
                    help,
                );
            }
            found
        })
        .collect();
    resolved.into_iter().collect()
}

fn names(legs: &[Leg]) -> String {
    legs.iter().map(|leg| format!("\"{}\"", leg.name)).collect::<Vec<_>>().join(", ")
}

/// A list of names as written, with the legs that they mean.
type Listed<'l> = (&'l Names, &'l Vec<usize>);

/// Every leg of the robot moves with exactly one virtual leg.
fn check_each_once(lists: [Listed<'_>; 2], at: &Span, robot: &RobotFile, sink: &mut Sink) -> bool {
    let mentions: Vec<(usize, &Span)> = lists
        .iter()
        .flat_map(|(list, legs)| legs.iter().copied().zip(list.value.iter().map(|name| &name.span)))
        .collect();
    let mut good = true;
    for (i, (leg, span)) in mentions.iter().enumerate() {
        let Some((_, before)) = mentions[..i].iter().find(|(other, _)| other == leg) else {
            continue;
        };
        let title = format!("leg `{}` is part of two virtual legs", robot.robot.legs[*leg].name);
        sink.report(Code::LegTwice, title, span, "named again", "name each leg once");
        sink.beside(sink.label(before, "named here"));
        good = false;
    }
    for (i, leg) in robot.robot.legs.iter().enumerate() {
        if mentions.iter().any(|&(other, _)| other == i) {
            continue;
        }
        let title = format!("leg `{}` is part of no virtual leg", leg.name);
        let help = format!("every leg carries the robot: add \"{}\" to one of the two lists", leg.name);
        sink.report(Code::IdleLeg, title, at, "not named here", help);
        sink.beside(place(robot, i, |p| &p.name, "this leg"));
        good = false;
    }
    good
}

/// Legs that move as one need joints and lengths alike, and feet that touch the ground together: mounts at the same
/// height, and at the same place across the axis about which the platform rotates.
fn check_pair(raw: &RawGait, list: &Names, legs: &[usize], robot: &RobotFile, sink: &mut Sink) -> bool {
    let all = &robot.robot.legs;
    let Some(&lead) = legs.first() else {
        return false;
    };
    let mut good = true;
    for (&leg, name) in legs.iter().zip(&list.value).skip(1) {
        let rotation = raw.rotation.as_ref().map_or(Rotation::None, |r| r.value);
        let unlike = match driven_unlike(&all[lead], &all[leg], false) {
            Some(why) => Some(Unlike::Link(why)),
            None => {
                let [a, b] = [lead, leg].map(|leg| &all[leg]);
                Motion::new(a, rotation).feet(&a.places(a.mount), &b.places(b.mount)).move_apart(a, b)
            }
        };
        if let Some(Unlike::Link(why)) = unlike {
            let title = format!("legs `{}` and `{}` cannot move as one: {why}", all[lead].name, all[leg].name);
            let label = format!("has the joints {}", joints(&all[leg]).join(", "));
            let help = format!(
                "put it together with legs of the same build; `{}` has the joints {}",
                all[lead].name,
                joints(&all[lead]).join(", ")
            );
            sink.report(Code::LegsDoNotPair, title, &name.span, label, help);
            good = false;
            continue;
        }
        if let Some(Unlike::Mount(k)) = unlike {
            let title = format!("legs `{}` and `{}` cannot move as one", all[lead].name, all[leg].name);
            let label = format!("mounted at another {} than `{}`", DIRECTIONS[k], all[lead].name);
            let help = match rotation {
                Rotation::Pitch => "the platform pitches: pair the hind legs, and the fore legs (the same x and y)",
                Rotation::Roll => {
                    "the platform rolls: pair the legs of the right side, and those of the left (the same y and z)"
                }
                Rotation::None => "pair legs that are mounted at the same height (the same y)",
            };
            let together = mounts([lead, leg].iter().map(|leg| &all[*leg]), k);
            let help = format!("{help}; or give both the same {together}");
            sink.report(Code::LegsDoNotPair, title, &name.span, label, help);
            sink.beside(place(robot, leg, |p| &p.mount, &format!("mount of `{}`", all[leg].name)));
            good = false;
        }
    }
    good
}

/// One name for a place of several legs' mounts, as `--set` takes it.
pub(super) fn mounts<'l>(legs: impl Iterator<Item = &'l Leg>, along: usize) -> String {
    let names: Vec<&str> = legs.map(|leg| leg.name.as_str()).collect();
    format!("legs.{{{}}}.mount.{}", names.join(","), DIRECTIONS[along])
}

/// Names of a leg's joints.
pub(super) fn joints(leg: &Leg) -> Vec<&str> {
    leg.chain.iter().map(|segment| segment.joint.name.as_str()).collect()
}

/// A label into the robot's file.
pub(super) fn place(
    robot: &RobotFile,
    leg: usize,
    part: impl Fn(&super::robot::LegPlaces) -> &Span,
    text: &str,
) -> Label {
    let span = robot.places.get(leg).map_or(0..0, |places| part(places).clone());
    Label { source: robot.source.clone(), span, text: text.to_string() }
}
