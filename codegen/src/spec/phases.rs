//! The phases of a gait: what stands on the ground, one after another. A file lists them, or it says in short what the half
//! steps are, of which each is a phase.
//!
//! A list is a cycle that begins on leg 1. In each phase something else stands than in the one before, and each leg stands in
//! some phase: what never stands is no leg.

use super::Code;
use super::diagnostic::{At, Sink, Span};
use super::gait::RawGait;
use super::types::{Phase, Phases, Rotation, Then};
use super::view::View;

/// Phases as a file has them.
pub(super) enum Written {
    /// In short, with the duration of all.
    HalfSteps(Option<[f64; 2]>),
    List(Option<Vec<Listed>>),
}

/// A phase of a list; parts that could not be read are absent.
pub(super) struct Listed {
    stance: Option<At<Stance>>,
    duration: Option<[f64; 2]>,
}

/// Which of the virtual legs stand.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Stance([bool; 2]);

/// What a file says of its phases, and of what follows them.
pub(super) fn read(root: &View<'_>, limits: Option<&View<'_>>, sink: &mut Sink) -> (Written, Option<At<Then>>) {
    let then = [Then::Mirrored, Then::Repeat];
    if root.is_short() {
        let duration = limits.and_then(|limits| limits.pair("half_step_duration", sink));
        return (Written::HalfSteps(duration.map(|d| d.value)), root.choice("half_steps", then, sink));
    }
    let list =
        root.tables("phases", sink).map(|tables| tables.iter().map(|table| listed(table.as_ref(), sink)).collect());
    let cycle = root.table("cycle", sink);
    (Written::List(list), cycle.and_then(|cycle| cycle.choice("then", then, sink)))
}

fn listed(table: Option<&View<'_>>, sink: &mut Sink) -> Listed {
    let stance = table.and_then(|table| table.choices("stance", sink));
    Listed {
        stance: stance.map(|legs| At { value: Stance([0, 1].map(|leg| legs.value.contains(&leg))), span: legs.span }),
        duration: table.and_then(|table| table.pair("duration", sink)).map(|duration| duration.value),
    }
}

impl Stance {
    fn is_flight(self) -> bool {
        self.0 == [false; 2]
    }

    /// With the roles of the virtual legs exchanged.
    fn exchanged(self) -> Stance {
        let [first, second] = self.0;
        Stance([second, first])
    }

    /// The leg that stands, if one does; `None` where both do.
    fn one(self) -> Option<Option<usize>> {
        match self.0 {
            [true, true] => None,
            legs => Some(legs.iter().position(|stands| *stands)),
        }
    }

    /// What two phases are in which this stands.
    fn in_both(self) -> &'static str {
        match self.0 {
            [false, false] => "both are flight",
            [true, false] => "both are on leg 1",
            [false, true] => "both are on leg 2",
            [true, true] => "both are on both legs",
        }
    }
}

/// The phases, checked as a list; `at` is where the file names it.
pub(super) fn phases(raw: &RawGait, at: &Span, sink: &mut Sink) -> Option<Phases> {
    let list = match &raw.phases {
        Written::HalfSteps(duration) => return Some(Phases::half_steps(raw.then.as_ref()?.value, (*duration)?)),
        Written::List(list) => list.as_ref()?,
    };
    if list.is_empty() {
        let help = "list what stands on the ground: [[phases]] with stance = [\"leg1\"] and its duration first";
        sink.report(Code::WrongCount, "a gait has at least one phase", at, "expected [[phases]]", help);
        return None;
    }
    list.iter().flat_map(|phase| &phase.stance).for_each(|stance| can_be(stance, raw, sink));
    in_a_row(list, raw.then.as_ref(), sink);
    legs_stand(list, raw.then.as_ref(), sink);
    let phase = |phase: &Listed| Some(Phase { stance: phase.stance.as_ref()?.value.one()?, duration: phase.duration? });
    let list = list.iter().map(phase).collect::<Option<_>>()?;
    Some(Phases { list, then: raw.then.as_ref()?.value, half_steps: false })
}

/// Whether the equations of motion of a phase are known.
fn can_be(stance: &At<Stance>, raw: &RawGait, sink: &mut Sink) {
    let rotation = raw.rotation.as_ref();
    let grounded = rotation.and_then(|at| Some((at, at.value.keeps_on_the_ground()?)));
    if let (true, Some((rotation, why))) = (stance.value.is_flight(), grounded) {
        let help = "take the flight out of the list, or let the platform pitch or stay level: moves = [\"x\", \"y\"], rotates = \"pitch\" \
                    or \"none\"";
        sink.report(Code::CannotFly, format!("this gait cannot fly: {why}"), &stance.span, "nothing stands", help);
        sink.beside(sink.label(&rotation.span, "the rotation"));
    }
    if stance.value.one().is_none() {
        let rolls = rotation.is_some_and(|rotation| rotation.value == Rotation::Roll);
        let title = match rolls {
            true => {
                "double support where the platform rolls: two feet that stand beside each other keep it from rolling"
            }
            false => "double support is not there yet: a phase stands on one virtual leg, or on none",
        };
        let help = "leave the phase out: one leg then follows the other in an instant, with an impact; or write a phase on \
                    one leg, stance = [\"leg1\"]";
        sink.report(Code::DoubleSupport, title, &stance.span, "both legs stand", help);
    }
}

/// No phase is like the one before, at the end of the list either.
fn in_a_row(list: &[Listed], then: Option<&At<Then>>, sink: &mut Sink) {
    for (k, pair) in list.windows(2).enumerate() {
        let [Some(before), Some(stance)] = [&pair[0].stance, &pair[1].stance] else {
            continue;
        };
        if before.value == stance.value {
            let title = format!("the phases {} and {} are alike: {}", k + 1, k + 2, stance.value.in_both());
            let other = if stance.value.is_flight() { "a stance" } else { "a flight, or a stance on the other leg," };
            let help = format!("make one phase of the two, or put {other} between them");
            sink.report(Code::PhasesAlike, title, &stance.span, "the same again", help);
            sink.beside(sink.label(&before.span, "the phase before"));
        }
    }
    // Of one phase alone, `legs_stand` says what there is to say.
    let ([first, .., last], Some(then)) = (list, then) else {
        return;
    };
    let (Some(first), Some(last)) = (&first.stance, &last.stance) else {
        return;
    };
    let (next, image, instead) = match then.value {
        Then::Repeat => (first.value, "", "leave out one of the two, or end the list with another phase"),
        Then::Mirrored => {
            let instead = "write then = \"repeat\" if the list is the whole cycle, or end it with another phase";
            (first.value.exchanged(), "the mirror image of ", instead)
        }
    };
    if last.value == next {
        let title = format!("the last phase and {image}the first, which follows it, are alike: {}", next.in_both());
        sink.report(Code::PhasesAlike, title, &last.span, "the last phase", instead);
        sink.beside(sink.label(&first.span, "the first phase"));
    }
}

/// Both legs stand, leg 1 first.
fn legs_stand(list: &[Listed], then: Option<&At<Then>>, sink: &mut Sink) {
    let known: Option<Vec<&At<Stance>>> = list.iter().map(|phase| phase.stance.as_ref()).collect();
    if let Some(known) = &known {
        let stands = [0, 1].map(|leg| known.iter().any(|stance| stance.value.0[leg]));
        match (stands, then) {
            ([false, false], _) => {
                let title = "no leg ever stands: a robot cannot fly for ever";
                let help = "begin the list with a phase on leg 1: stance = [\"leg1\"]";
                return sink.report(Code::NeverStands, title, &known[0].span, "nothing stands here", help);
            }
            ([true, true], _) | (_, None) => {}
            (_, Some(At { value: Then::Mirrored, .. })) => {}
            ([first, _], Some(then)) => {
                let leg = if first { 2 } else { 1 };
                let title = format!("leg {leg} never stands");
                let help = format!(
                    "add a phase with stance = [\"leg{leg}\"], or write then = \"mirrored\": after the list the legs exchange their roles"
                );
                sink.report(Code::NeverStands, title, &then.span, "so the list is the whole cycle", help);
            }
        }
    }
    let Some(Some(first)) = list.first().map(|phase| &phase.stance) else {
        return;
    };
    let (title, label, help) = match first.value.0 {
        [true, _] => return,
        [false, true] => {
            let help = "begin with leg 1: write \"leg1\" for \"leg2\" in all phases and \"leg2\" for \"leg1\", and exchange the two lists of `virtual_legs`";
            ("a gait begins on leg 1", "stands on leg 2", help)
        }
        [false, false] => {
            let help = "begin the list with the phase that follows this flight, and put the flight at its end: a cycle can be cut anywhere";
            ("a list of phases does not begin with a flight", "nothing stands", help)
        }
    };
    sink.report(Code::NotOnLeg1First, title, &first.span, label, help);
}
