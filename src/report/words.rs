//! Constraints in words: what it means that one has no room to spare.

/// A sentence about a constraint of that name, as receipts write it.
pub fn meaning(constraint: &str) -> String {
    let (kind, of) = constraint.split_once(" of ").unwrap_or((constraint, ""));
    match kind {
        "torque" => format!("The motor of {of} gives all the torque it has."),
        "torque–speed" => format!("The motor of {of} turns as fast as it can at that torque."),
        "range" => {
            let (joint, stop) = of.split_once(" (").unwrap_or((of, "stop)"));
            format!("{joint} is at its {}.", stop.trim_end_matches(')'))
        }
        "vertical force" => "The stance foot is as lightly loaded as is allowed.".into(),
        "friction" if of.is_empty() => {
            "The stance foot is on the edge of the friction cone: it is about to slip.".into()
        }
        "friction" => "The impulse of the landing is on the edge of the friction cone.".into(),
        "swing clearance" => "The swing foot touches the parabola that it must stay above.".into(),
        "shortest half step" => "The half step is as short as is allowed.".into(),
        "longest half step" => "The half step is as long as is allowed.".into(),
        "vertical impulse" => {
            "The landing foot is hardly pressed to the ground: one step further it would pull.".into()
        }
        "leaving foot" => "The foot that leaves the ground leaves it without speed.".into(),
        "platform above the ground" => "The platform is on the ground.".into(),
        _ => "This limit has no room to spare.".into(),
    }
}
