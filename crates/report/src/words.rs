//! Constraints in words: what it means that one has no room to spare.

/// A sentence about a constraint of that name, as receipts and prices write it.
pub fn meaning(constraint: &str) -> String {
    let (kind, of) = constraint.split_once(" of ").unwrap_or((constraint, ""));
    match (kind, of) {
        ("torque", of) => format!("The motor of {of} gives all the torque it has."),
        ("torque–speed", of) => format!("The motor of {of} turns as fast as it can at that torque."),
        ("range", of) => {
            let (joint, stop) = of.split_once(" (").unwrap_or((of, "stop)"));
            format!("{joint} is at its {}.", stop.trim_end_matches(')'))
        }
        ("vertical force", "") => "The stance foot is as lightly loaded as is allowed.".into(),
        ("vertical force", leg) => format!("The foot of {leg} is as lightly loaded as is allowed."),
        ("friction", "") => "The stance foot is on the edge of the friction cone: it is about to slip.".into(),
        ("friction", "the impulse") => "The impulse of the landing is on the edge of the friction cone.".into(),
        ("friction", "the impulse on a real foot") => {
            "The impulse of the landing is on the edge of a real foot’s friction cone.".into()
        }
        ("friction", leg) => format!("The foot of {leg} is on the edge of its friction cone: it is about to slip."),
        ("swing clearance", _) => "The swing foot touches the parabola that it must stay above.".into(),
        ("shortest half step", _) => "The half step is as short as is allowed.".into(),
        ("longest half step", _) => "The half step is as long as is allowed.".into(),
        ("vertical impulse", _) => {
            "The landing foot is hardly pressed to the ground: one step further it would pull.".into()
        }
        ("leaving foot", _) => "The foot that leaves the ground leaves it without speed.".into(),
        ("platform height", _) => "The platform’s mass centre is as low as is allowed.".into(),
        ("height", point) => format!("{point} is as near to the ground as is allowed."),
        _ => UNKNOWN.into(),
    }
}

/// Of a limit that this page has no words for.
const UNKNOWN: &str = "This limit has no room to spare.";

#[cfg(test)]
mod tests {
    use super::*;
    use piaffe::gaits::GAITS;
    use piaffe_model::Gait;
    use piaffe_model::motion::Criterion;
    use piaffe_optimizer::altered::Altered;
    use piaffe_optimizer::cycle::Cycle;
    use piaffe_sqp::Problem;
    use piaffe_verify::constraint::Constraint;

    #[test]
    fn every_limit_has_words_of_its_own() {
        for gait in GAITS {
            let d = gait.description();
            let inequalities = Constraint::all(d).filter(|c| !c.is_equality());
            let mut names: Vec<String> = inequalities.map(|c| c.name(d)).collect();
            let altered = Altered::at_real_legs(*gait);
            let mut optimized = |gait: &dyn Gait| {
                let cycle = Cycle::new(gait, Criterion::Torque, 1.0);
                names.extend((0..cycle.inequalities()).map(|i| cycle.label(i).name));
            };
            optimized(*gait);
            altered.iter().for_each(|gait| optimized(gait));
            names.sort();
            names.dedup();
            for name in &names {
                assert_ne!(meaning(name), UNKNOWN, "{name}");
                // What lands and what stands are told apart.
                assert_eq!(
                    name.contains("impulse"),
                    ["landing", "lands"].iter().any(|w| meaning(name).contains(w)),
                    "{name}"
                );
            }
        }
    }
}
