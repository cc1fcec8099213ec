//! `piaffe diff`: two results side by side.

use super::digits::decimal;
use super::{document, input, output};
use piaffe_model::digits::digits;
use piaffe_optimizer::result::{GaitResult, SearchEntry};
use piaffe_study::difference::{Carried, Changed, Difference, Kinship, Measures, Pair, Prediction, Side};
use std::io::{self, Write};
use std::path::Path;

/// Slopes that are named, the steepest in percent per percent first.
const SLOPES: usize = 5;

pub fn run(a: &Path, b: &Path, json: Option<&str>) -> anyhow::Result<bool> {
    let ((of_a, gait_a), (of_b, gait_b)) = (document::confirmed(a)?, document::confirmed(b)?);
    let difference = Difference::new(Side { result: &of_a, gait: gait_a }, Side { result: &of_b, gait: gait_b });
    let results = Pair { a: of_a, b: of_b };
    if let Some(target) = json {
        output::json_to(target, &difference)?;
    }
    if json != Some("-") {
        let names = Pair { a: input::name(a), b: input::name(b) };
        output::quiet_when_closed(tell(&names, &results, &difference))?;
    }
    Ok(true)
}

fn tell(names: &Pair<String>, results: &Pair<GaitResult>, d: &Difference) -> io::Result<()> {
    let mut out = output::person();
    for (letter, name, r) in [("A", &names.a, &results.a), ("B", &names.b, &results.b)] {
        write!(
            out,
            "{letter}  {name}: {} of {}, least {} at {} m/s: ",
            r.gait,
            r.robot,
            r.criterion.name(),
            digits(r.speed)
        )?;
        match r.cost {
            Some(cost) => writeln!(out, "{} {}", decimal(cost, 4), r.criterion.unit())?,
            None => writeln!(out, "no optimum ({})", r.message)?,
        }
    }
    if let Some(ratio) = d.ratio() {
        let percent = 100.0 * (ratio - 1.0);
        match percent {
            0.0 => writeln!(out, "   B costs as much as A")?,
            _ if percent > 0.0 => writeln!(out, "   B costs {} % more than A", decimal(percent, 2))?,
            _ => writeln!(out, "   B costs {} % less than A", decimal(-percent, 2))?,
        }
    }
    asked(&mut out, d)?;
    if let Some(prediction) = &d.prediction {
        predicted(&mut out, prediction, &d.numbers, results.a.criterion.unit())?;
    }
    if let (Some(carried), Pair { a: Some(a), b: Some(b) }) = (&d.carried, d.cost) {
        arrived(&mut out, carried, Pair { a, b }, results.a.criterion.unit())?;
    }
    let durations = |list: &[f64]| match list {
        [] => "none".into(),
        list => list.iter().map(|t| decimal(*t, 4)).collect::<Vec<_>>().join("/") + " s",
    };
    writeln!(out, "phases          {} → {}", durations(&d.durations.a), durations(&d.durations.b))?;
    active(&mut out, d)?;
    for (k, slope) in d.slopes.iter().take(SLOPES).enumerate() {
        let head = if k == 0 { "slopes" } else { "" };
        let per = if slope.unit.is_empty() { String::new() } else { format!(" per {}", slope.unit) };
        let (name, Pair { a, b }) = (&slope.parameter, slope.slopes);
        writeln!(out, "{head:15} {name}: {} → {} {}{per}", decimal(a, 4), decimal(b, 4), results.a.criterion.unit())?;
    }
    let number = |number: Option<f64>| number.map_or("–".into(), |number| format!("{number:.1e}"));
    for (letter, v) in [("A", &d.verdicts.a), ("B", &d.verdicts.b)] {
        let head = if letter == "A" { "verdicts" } else { "" };
        let (violation, cycle, kkt) = (number(v.max_violation), number(v.cycle_error), number(v.kkt_residual));
        let between = v.certificate.unwrap_or("–");
        writeln!(
            out,
            "{head:15} {letter}: violation {violation}, cycle {cycle}, KKT {kkt}, between the instants {between}"
        )?;
    }
    Ok(())
}

/// What differs between the questions.
fn asked(out: &mut impl Write, d: &Difference) -> io::Result<()> {
    match d.kinship {
        Kinship::OtherRobot => return other_robots(out, d),
        Kinship::OtherGait => {
            writeln!(out, "gaits           put together differently: no slope leads from one to the other")?;
        }
        Kinship::Unknown => writeln!(out, "numbers         not known: not both say what robot they are of")?,
        Kinship::Alike if d.specified && d.numbers.is_empty() => {
            writeln!(out, "numbers         the same in both specifications")?;
        }
        Kinship::Alike => {}
    }
    entries(out, "numbers", &d.numbers, |value| digits(*value))?;
    entries(out, "words", &d.words, Clone::clone)?;
    let at_real_legs = d.limits_at_real_legs.a != d.limits_at_real_legs.b;
    let same = d.numbers.is_empty() && d.words.is_empty();
    match d.same_gait {
        true if !same => {
            writeln!(out, "{:15} none of that is of matter to the gait: both are derived as the same", "")?
        }
        false if d.specified && same && !at_real_legs => {
            writeln!(out, "{:15} their fingerprints differ, and nothing here says why", "")?;
        }
        _ => {}
    }
    otherwise_asked(out, d)
}

/// Of robots of other parts hardly a number is common: what they are like says more.
fn other_robots(out: &mut impl Write, d: &Difference) -> io::Result<()> {
    writeln!(out, "robots          made of different parts: no slope leads from one to the other")?;
    let of = |name: &str, unit: &str, of: fn(&Measures) -> f64| {
        format!("{name} {} → {} {unit}", decimal(of(&d.measures.a), 3), decimal(of(&d.measures.b), 3))
    };
    let measures = [of("mass", "kg", |m| m.mass), of("weight", "N", |m| m.weight), of("legs", "m", |m| m.leg_length)];
    writeln!(out, "{:15} {}", "", measures.join(", "))?;
    let (numbers, words) = (d.numbers.len(), d.words.len());
    writeln!(out, "{:15} {numbers} numbers and {words} words are not the same in both: --json has them", "")?;
    otherwise_asked(out, d)
}

/// What differs beside the specifications.
fn otherwise_asked(out: &mut impl Write, d: &Difference) -> io::Result<()> {
    if d.limits_at_real_legs.a != d.limits_at_real_legs.b {
        let hold = |real_legs| if real_legs { "at each real leg" } else { "at the virtual legs only" };
        let Pair { a, b } = d.limits_at_real_legs;
        writeln!(out, "limits hold     {} → {}", hold(a), hold(b))?;
    }
    let Pair { a, b } = &d.search;
    if (a.effort.starts, a.seed) != (b.effort.starts, b.seed) {
        let (a, b) = (searched(a), searched(b));
        writeln!(out, "search          {a} → {b}")?;
    }
    let Pair { a, b } = &d.version;
    if a != b {
        writeln!(out, "version         {a} → {b}")?;
    }
    Ok(())
}

/// Entries of the specifications that differ.
fn entries<T>(out: &mut impl Write, head: &str, list: &[Changed<T>], shown: impl Fn(&T) -> String) -> io::Result<()> {
    for (k, entry) in list.iter().enumerate() {
        let value = |value: &Option<T>, given: bool| match value {
            None => "not given".into(),
            Some(value) if given => shown(value),
            Some(value) => format!("{} (not given)", shown(value)),
        };
        let head = if k == 0 { head } else { "" };
        let Changed { name, values, given } = entry;
        writeln!(out, "{head:15} {name}: {} → {}", value(&values.a, given.a), value(&values.b, given.b))?;
    }
    Ok(())
}

fn searched(search: &SearchEntry) -> String {
    format!("{} starts of seed {}", search.effort.starts, search.seed)
}

/// Which is better, and why.
fn predicted(out: &mut impl Write, p: &Prediction, numbers: &[Changed<f64>], unit: &str) -> io::Result<()> {
    for (k, part) in p.parts.iter().enumerate() {
        let head = if k == 0 { "explained by" } else { "" };
        let (name, change) = (&part.parameter, decimal(part.change, 4));
        let of = if part.unit.is_empty() { String::new() } else { format!(" {}", part.unit) };
        writeln!(out, "{head:15} {name} by {change}{of}: {} {unit}", signed(part.at_a))?;
    }
    if !p.parts.is_empty() {
        // What is not counted may be all of it.
        let share = match p.difference {
            0.0 => String::new(),
            _ if !p.without_slope.is_empty() => String::new(),
            difference => format!(" ({:.0} %)", 100.0 * p.at_a / difference),
        };
        let (sum, mean, all) = (signed(p.at_a), signed(p.mean), signed(p.difference));
        writeln!(out, "{:15} {sum} of {all} {unit}{share} to first order; {mean} with the slopes of both", "in all")?;
    }
    if !p.without_slope.is_empty() {
        let names = without_slope(p, numbers).join(", ");
        let head = if p.parts.is_empty() { "not explained" } else { "" };
        writeln!(out, "{head:15} incomplete: no slope is known in {names}")?;
    }
    Ok(())
}

/// Numbers that differ and have no slope. Slopes are in the numbers that stand in a file, and friction that is none has none.
fn without_slope(p: &Prediction, numbers: &[Changed<f64>]) -> Vec<String> {
    let with_reason = |name: &String| {
        let number = numbers.iter().find(|number| number.name == *name);
        let sides = number.into_iter().flat_map(|n| [("A", n.values.a, n.given.a), ("B", n.values.b, n.given.b)]);
        match sides.into_iter().find(|(_, value, _)| *value == Some(0.0)) {
            Some((letter, _, false)) => format!("{name} (it does not stand in {letter}, where it is 0)"),
            Some((letter, _, true)) => format!("{name} (it is 0 in {letter})"),
            None => name.clone(),
        }
    };
    p.without_slope.iter().map(with_reason).collect()
}

/// Whether the two are one optimum that moves with the numbers; if not, what these are worth.
fn arrived(out: &mut impl Write, carried: &Pair<Carried>, cost: Pair<f64>, unit: &str) -> io::Result<()> {
    if carried.a.is_found && carried.b.is_found {
        return Ok(());
    }
    let sides = [("A", "B", carried.a, cost.a, cost.b), ("B", "A", carried.b, cost.b, cost.a)];
    let mut head = "other optimum";
    for (from, to, arrival, own, there) in sides.into_iter().filter(|side| !side.2.is_found) {
        write!(out, "{head:15} the motion of {from}, carried over to {to}, ")?;
        match arrival.cost {
            None => writeln!(out, "ends in no optimum there: slopes do not lead from {from} to {to}")?,
            Some(found) => {
                let percent = 100.0 * (found / own - 1.0);
                let (found_text, there_text) = (decimal(found, 4), decimal(there, 4));
                write!(out, "costs {found_text} {unit} there, where {to}'s own costs {there_text}: ")?;
                if found < there {
                    writeln!(out, "{to} is not the best of its kind")?;
                } else {
                    let worth = format!("{}{} %", if percent < 0.0 { "-" } else { "+" }, decimal(percent.abs(), 2));
                    writeln!(out, "what differs makes {worth}, the rest is that the two are different local optima")?;
                }
            }
        }
        head = "";
    }
    Ok(())
}

fn signed(number: f64) -> String {
    let sign = if number < 0.0 { "-" } else { "+" };
    format!("{sign}{}", decimal(number.abs(), 4))
}

/// Limits without room to spare: in both, and in one of them.
fn active(out: &mut impl Write, d: &Difference) -> io::Result<()> {
    let of = |a: bool, b: bool| {
        let with = d.limits.iter().filter(move |room| (room.margins.a.is_some(), room.margins.b.is_some()) == (a, b));
        with.map(|room| format!("{} (phase {})", room.constraint, room.phase)).collect::<Vec<_>>().join(", ")
    };
    let groups = [("in both", of(true, true)), ("in A only", of(true, false)), ("in B only", of(false, true))];
    let mut head = "active";
    for (which, limits) in groups.iter().filter(|(_, limits)| !limits.is_empty()) {
        writeln!(out, "{head:15} {which}: {limits}")?;
        head = "";
    }
    Ok(())
}
