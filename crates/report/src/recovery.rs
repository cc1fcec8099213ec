//! What becomes of a push, under which control.

use maud::{Markup, html};
use piaffe_optimizer::result::GaitResult;
use piaffe_optimizer::stability::{PhaseTracking, TimeTracking};

pub fn section(r: &GaitResult) -> Markup {
    let Some(stability) = &r.stability else { return html! {} };
    let phase = match &stability.phase {
        PhaseTracking::Map { phase, .. } => format!("by a phase: the {phase}"),
        _ => "by a phase of the posture".into(),
    };
    let flying = if stability.phase == PhaseTracking::Flight {
        ", and in flight about its mass centre as it did when it left"
    } else {
        ""
    };
    html! {
        div.receipt {
            h3 { "After a push" }
            p { "Joints that are kept exactly where they are wanted leave the robot one freedom: it turns about its stance foot as gravity likes" (flying) ". What becomes of a small push there depends on what tells the joints where to be." }
            dl {
                dt { "by the clock" } dd { (stability.clock) ". " (eigenvalues(&stability.clock)) }
                dt { "by a clock that starts anew at each landing" } dd { (stability.restarted_clock) ". " (eigenvalues(&stability.restarted_clock)) }
                dt { (phase) } dd { (stability.phase) "." }
            }
        }
    }
}

fn eigenvalues(t: &TimeTracking) -> Markup {
    let text = |[re, im]: [f64; 2]| if im == 0.0 { format!("{re:.3}") } else { format!("{re:.3} {im:+.3} i") };
    html! { span.note { "Eigenvalues of the return map " (t.eigenvalues.map(text).join(", ")) } }
}
