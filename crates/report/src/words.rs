//! Limits in words: what it means that one has no room to spare.

use piaffe_model::Limit;

/// A sentence about the limit or equation of that name, as receipts and prices write it; none of a name that is none.
pub fn meaning(name: &str) -> String {
    Limit::read(name).map_or(String::new(), |(limit, of)| sentence(limit, of))
}

fn sentence(limit: Limit, of: &str) -> String {
    match limit {
        Limit::Torque => format!("The motor of {of} gives all the torque it has."),
        Limit::TorqueSpeed => format!("The motor of {of} turns as fast as it can at that torque."),
        Limit::LowerStop => format!("{of} is at its lower stop."),
        Limit::UpperStop => format!("{of} is at its upper stop."),
        Limit::VerticalForce => "The stance foot is as lightly loaded as is allowed.".into(),
        Limit::VerticalForceOfFoot => format!("The foot of {of} is as lightly loaded as is allowed."),
        Limit::Friction => "The stance foot is on the edge of the friction cone: it is about to slip.".into(),
        Limit::FrictionOfFoot => {
            format!("The foot of {of} is on the edge of its friction cone while it stands: it is about to slip.")
        }
        Limit::Clearance => "The swing foot touches the curve that it must stay above.".into(),
        Limit::ClearanceOfFoot => format!("The foot of {of} touches the curve that it must stay above."),
        Limit::PlatformHeight => "The mass centre of the platform is as low as is allowed.".into(),
        Limit::Height => format!("{of} is as near to the ground as is allowed."),
        Limit::ShortestPhase => "The phase is as short as is allowed.".into(),
        Limit::LongestPhase => "The phase is as long as is allowed.".into(),
        Limit::VerticalImpulse => {
            "The landing foot is hardly pressed to the ground: one step further it would pull.".into()
        }
        Limit::ImpulseFriction => "The impulse of the landing is on the edge of the friction cone.".into(),
        Limit::ImpulseFrictionOfFoot => {
            "The impulse of the landing on one of the real feet is on the edge of the friction cone.".into()
        }
        Limit::Leaving => "The foot that leaves the ground leaves it without speed.".into(),
        Limit::Touchdown => "The phase ends where the swing foot meets the ground.".into(),
        Limit::MeanSpeed => "The mean speed is the one that was asked for.".into(),
        Limit::ClosureOfBeta => "The unactuated coordinate must end where the next phase begins.".into(),
        Limit::ClosureOfSigma => "The angular momentum must end where the next phase begins.".into(),
        Limit::Pitching => "The real feet have nothing that would keep the landing from pitching the robot.".into(),
        Limit::Still => format!("{of} is held still, where every motion of it would cost more."),
        Limit::Duration => "The phase is as short or as long as is allowed.".into(),
    }
}

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
        let mut said: Vec<String> = Limit::ALL.iter().map(|limit| sentence(*limit, "it")).collect();
        assert!(said.iter().all(|sentence| sentence.ends_with('.')));
        said.sort();
        said.dedup();
        assert_eq!(said.len(), Limit::ALL.len());
    }

    /// What the program calls a constraint leads back to its limit.
    #[test]
    fn names_lead_to_words() {
        for gait in GAITS {
            let d = gait.description();
            for constraint in Constraint::all(d) {
                let name = constraint.name(d);
                assert_eq!(Limit::read(&name).map(|read| read.0), Some(constraint.limit()), "{name}");
            }
            let optimized = |gait: &dyn Gait| {
                let cycle = Cycle::new(gait, Criterion::Torque, 1.0);
                for i in 0..cycle.inequalities() {
                    let label = cycle.label(i);
                    assert_eq!(Limit::read(&label.name()), Some((label.limit, &label.of[..])), "{}", label.name());
                }
            };
            optimized(*gait);
            Altered::at_real_legs(*gait).iter().for_each(|gait| optimized(gait));
        }
    }
}
