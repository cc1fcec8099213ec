//! A result for a person.

use super::digits::{at_least, decimal};
use super::peaks;
use piaffe_model::digits::digits;
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Mode, Then};
use piaffe_optimizer::constraints::sharing::applies;
use piaffe_optimizer::four_legs::{RealLegs, Verdict};
use piaffe_optimizer::result::{GaitResult, NotExamined, Status};
use piaffe_optimizer::search::evidence::Effort;
use piaffe_optimizer::sensitivity::Sensitivity;
use piaffe_verify::certificate::Certificate;
use std::io::{self, Write};

/// A certificate in a line.
fn standing(c: &Certificate) -> String {
    if c.is_certified() {
        let pieces: usize = c.phases.iter().map(|h| h.evaluations).sum();
        return format!("certified: at no time is a margin below -{:.0e} (proven on {pieces} pieces)", c.tolerance);
    }
    let gaps = c.gaps.iter().map(|gap| {
        let verdict = if gap.violated { "broken" } else { "unproven" };
        let [from, to] = [gap.from, gap.to].map(|t| decimal(t, 6));
        format!("{} {verdict} in phase {} from {from} to {to} s", gap.constraint, gap.phase)
    });
    let open = match c.cycle_error {
        None => Some("cycle not proven to close".to_string()),
        Some(error) if error > c.tolerance => Some(format!(
            "cycle proven to close within {error:.1e}, which is more than {:.0e}: impacts multiply what rounding leaves open",
            c.tolerance
        )),
        Some(_) => None,
    };
    format!("sampled: {}", gaps.chain(open).collect::<Vec<_>>().join("\n                  "))
}

/// A duration that is longer than the shortest by less than this share is as short as is allowed.
const SHORTEST: f64 = 1e-6;

/// How sure it is that there is nothing better.
fn confidence(r: &GaitResult) -> String {
    let Effort { starts, informed, optima, .. } = r.search.effort;
    let more = if informed > 0 { format!(" (and {informed} from or near known optima)") } else { String::new() };
    let Some(best) = r.local_optima.first() else { return format!("no optimum from {starts} starts{more}") };
    let unseen = match r.search.effort.expected_optima() {
        Some(expected) => format!("{:.1} further optima are to be expected", expected - optima as f64),
        None => "too few to tell how many further optima to expect".into(),
    };
    format!("reached by {} of {starts} starts{more}; {unseen}", best.reached)
}

/// What the limits at each real leg cost, or that none were imposed.
fn at_real_legs(description: &Description, r: &GaitResult, cost: f64, without: f64) -> String {
    if !applies(description) {
        return match r.real_legs.as_ref().map(RealLegs::verdict) {
            Some(Verdict::EqualShares) => "nothing need be imposed: each does its equal share within all limits",
            Some(_) => {
                "nothing is imposed: limits at each real leg are, where the platform rolls; what each can do stands below"
            }
            None => "nothing is imposed: limits at each real leg are, where the platform rolls",
        }
        .into();
    }
    let (more, without) = (100.0 * (cost / without - 1.0), decimal(without, 4));
    format!("{more:+.3} % against {without} with limits at the virtual legs only")
}

/// A saving that a slope may promise, %: what it says of larger ones is not true any more.
const PROMISED: f64 = 10.0;

/// What to change, the three greatest savings, and which numbers have no slope that could tell.
fn advice<'s>(slopes: impl Iterator<Item = &'s Sensitivity>) -> String {
    let (steep, useful): (Vec<_>, Vec<_>) = slopes.partition(|s| s.is_steep());
    let mut advice: Vec<String> = useful.into_iter().take(3).map(saving).collect();
    if !steep.is_empty() {
        let names: Vec<&str> = steep.iter().map(|s| s.parameter.as_str()).collect();
        advice.push(format!("too steep for advice: {}", names.join(", ")));
    }
    advice.join("; ")
}

/// What a small change of a number saves: of 1 %, or where that would promise too much, of a tenth of it, and so on.
fn saving(s: &Sensitivity) -> String {
    let (slope, sign) = (s.elasticity.abs(), if s.elasticity > 0.0 { "−" } else { "+" });
    let digits = (0..3).find(|digits| slope * 0.1_f64.powi(*digits) <= PROMISED).unwrap_or(3);
    let change = 0.1_f64.powi(digits);
    format!("{} {sign}{change:.*} % saves {:.2} %", s.parameter, digits as usize, slope * change)
}

/// Flights that are as short as the gait allows: how long that is, s, each length once.
pub fn shortest_flights(description: &Description, r: &GaitResult) -> Vec<f64> {
    let flights = description.phases.iter().zip(&r.durations).filter(|(phase, _)| phase.mode == Mode::Flight);
    let shortest =
        flights.map(|(phase, t)| (phase.duration[0], *t)).filter(|(least, t)| *t <= least * (1.0 + SHORTEST));
    each_once(shortest.map(|(least, _)| least))
}

/// Different lengths, the shortest first.
fn each_once(lengths: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut lengths: Vec<f64> = lengths.collect();
    lengths.sort_by(f64::total_cmp);
    lengths.dedup();
    lengths
}

/// Prints all there is to know about a result; `grounded` is the optimum of the gait without flights, where that was looked for.
pub fn print(description: &Description, r: &GaitResult, grounded: Option<&GaitResult>) -> io::Result<()> {
    let mut out = super::output::person();
    writeln!(out, "{} of {}, least {} at {} m/s: {}", r.gait, r.robot, r.criterion.name(), digits(r.speed), r.message)?;
    in_the_way(&mut out, description, r)?;
    costs(&mut out, description, r)?;
    steps(&mut out, description, r, grounded)?;
    out.write_all(peaks::table(description, &r.peaks).as_bytes())?;
    receipt(&mut out, r)?;
    examined(&mut out, description, r)?;
    searched(&mut out, description, r)?;
    writeln!(out, "  time            {:.3} s", r.seconds)
}

/// What keeps a motion from being, and where there is one.
fn in_the_way(out: &mut impl Write, description: &Description, r: &GaitResult) -> io::Result<()> {
    for c in &r.conflicts {
        let what = if c.violation > 1e-8 {
            format!("violated by {} (scaled)", at_least(c.violation, 3, 2))
        } else {
            "in the way".into()
        };
        writeln!(out, "  {:<34} phase {}, t = {} s: {what}", c.constraint, c.phase, decimal(c.time, 3))?;
    }
    match r.nearest_speed {
        Some(v) => writeln!(out, "  The nearest speed found to work is {} m/s.", digits(v)),
        None if r.status == Status::Infeasible && description.contradictions().is_empty() => {
            writeln!(out, "  No speed was found that works: loosen one of these limits in the specification.")
        }
        None => Ok(()),
    }
}

fn costs(out: &mut impl Write, description: &Description, r: &GaitResult) -> io::Result<()> {
    if let (Some(cost), Some(costs)) = (r.cost, r.costs) {
        writeln!(out, "  cost            {} {}", decimal(cost, 4), r.criterion.unit())?;
        if let Some(without) = r.virtual_cost {
            writeln!(out, "  at real legs    {}", at_real_legs(description, r, cost, without))?;
        }
        for criterion in Criterion::ALL {
            writeln!(out, "  {:<15} {} {}", criterion.name(), decimal(costs.of(criterion), 4), criterion.unit())?;
        }
    }
    if let Some(costs) = &r.costs {
        let transport = description.cost_of_transport(costs);
        writeln!(out, "  of transport    {transport:.4} (energy per weight and distance)")?;
    }
    Ok(())
}

/// Phases and travel.
fn steps(
    out: &mut impl Write,
    description: &Description,
    r: &GaitResult,
    grounded: Option<&GaitResult>,
) -> io::Result<()> {
    let Some(travel) = r.step_length else { return Ok(()) };
    let durations: Vec<String> = r.durations.iter().map(|t| format!("{} s", decimal(*t, 4))).collect();
    writeln!(out, "  phases          {}", durations.join(" + "))?;
    let shortest: Vec<String> = shortest_flights(description, r).into_iter().map(digits).collect();
    if !shortest.is_empty() {
        let it = if shortest.len() > 1 { "them" } else { "it" };
        let without = match grounded {
            None => format!("the gait without {it} may cost less"),
            Some(GaitResult { gait, cost: Some(cost), .. }) => {
                format!("without {it}, {gait} takes at most {} {}", decimal(*cost, 4), r.criterion.unit())
            }
            Some(GaitResult { gait, .. }) => format!("without {it}, no {gait} was found at this speed"),
        };
        writeln!(out, "  flight          as short as is allowed ({} s): {without}", shortest.join(" and "))?;
    }
    let which = if description.then == Then::Mirrored { "half step" } else { "whole step" };
    writeln!(out, "  {which:<15} {} m", decimal(travel, 4))
}

/// The receipt, its proof between the instants, and the limits without room.
fn receipt(out: &mut impl Write, r: &GaitResult) -> io::Result<()> {
    let Some(receipt) = &r.receipt else { return Ok(()) };
    writeln!(
        out,
        "  receipt         largest violation {:.1e}, cycle error {:.1e}, KKT residual {} ({} points per phase)",
        receipt.max_violation,
        receipt.cycle_error,
        receipt.kkt_residual.map_or("unknown".into(), |kkt| format!("{kkt:.1e}")),
        receipt.grid
    )?;
    if let Some(certificate) = &r.certificate {
        writeln!(out, "  certificate     {}", standing(certificate))?;
    }
    let active: Vec<String> = receipt
        .findings
        .iter()
        .map(|f| format!("{} (phase {}, t = {} s)", f.constraint, f.phase, decimal(f.time, 3)))
        .collect();
    let active = if active.is_empty() { "nothing".into() } else { active.join("\n                  ") };
    writeln!(out, "  active          {active}")?;
    if let Some(worst) = receipt.worst.as_ref().filter(|_| r.status != Status::Optimal) {
        let (name, phase, time) = (&worst.constraint, worst.phase, decimal(worst.time, 3));
        writeln!(out, "  worst           {name} (phase {phase}, t = {time} s): {:.2e}", worst.margin)?;
    }
    Ok(())
}

/// What an optimum is held by and worth, what becomes of a push, whether the real legs can do it.
fn examined(out: &mut impl Write, description: &Description, r: &GaitResult) -> io::Result<()> {
    if let Some(optimality) = &r.optimality {
        let held = match optimality.holders().as_slice() {
            [] => "by nothing but the cycle".into(),
            holders => format!("by {}", holders[..holders.len().min(3)].join(", ")),
        };
        writeln!(out, "  optimality      held {held}")?;
    }
    if let Some(sensitivities) = &r.sensitivities {
        writeln!(out, "  to change       {}", advice(sensitivities.of_robot()))?;
    }
    if let Some(stability) = &r.stability {
        writeln!(out, "  joints by clock {}", stability.clock)?;
        writeln!(out, "  joints by phase {}", stability.phase)?;
    }
    if let Some(legs) = &r.real_legs {
        writeln!(out, "  real legs       {}", legs.sentence())?;
        writeln!(out, "                  least margin {}", legs.support.words())?;
        writeln!(out, "                  at the impact {}", legs.impact.words())?;
        writeln!(out, "                  {}", legs.cost(r, description))?;
    }
    for NotExamined { entry, reason } in &r.not_examined {
        writeln!(out, "  not examined    {} ({reason})", entry.replace('_', " "))?;
    }
    Ok(())
}

/// How widely was looked, and what else was found.
fn searched(out: &mut impl Write, description: &Description, r: &GaitResult) -> io::Result<()> {
    if description.contradictions().is_empty() {
        writeln!(out, "  search          {}", confidence(r))?;
    }
    if let Some(cheaper) = r.cheaper_motion {
        let unit = r.criterion.unit();
        writeln!(
            out,
            "  cheaper         a motion within all limits costs {} {unit}: a better optimum exists, and was not found",
            decimal(cheaper, 4)
        )?;
    }
    if r.local_optima.len() > 1 {
        writeln!(out, "  local optima    (cost, phases, how many starts led there)")?;
        for o in &r.local_optima {
            let durations: Vec<String> = o.durations.iter().map(|t| decimal(*t, 3)).collect();
            writeln!(out, "    {:>12}  {}  {}", decimal(o.cost, 4), durations.join("/"), o.reached)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_length_is_told_once_wherever_it_stands() {
        assert_eq!(each_once([0.03, 0.015, 0.03].into_iter()), [0.015, 0.03]);
    }

    #[test]
    fn a_slope_promises_no_more_than_it_can_keep() {
        let of = |parameter: &str, elasticity: f64| Sensitivity {
            parameter: parameter.into(),
            numbers: vec![parameter.into()],
            unit: "m".into(),
            value: 1.0,
            slope: elasticity,
            elasticity,
        };
        let slopes = [of("a", 84963.59), of("b", -107.7), of("c", 4.567), of("d", 1.0), of("e", 0.5)];
        let expected = "b +0.01 % saves 1.08 %; c −1 % saves 4.57 %; d −1 % saves 1.00 %; too steep for advice: a";
        assert_eq!(advice(slopes.iter()), expected);
    }
}
