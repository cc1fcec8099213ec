//! The identity of every limit and equation of the program, from which its name follows.
//!
//! Optimizer, verifier and reports speak of one thing by one name, and a name leads back to its limit.

use serde::{Deserialize, Deserializer};

macro_rules! limits {
    ($($limit:ident = $name:literal,)*) => {
        /// A limit or condition of the program that a motion solves, apart from the joint, leg or point that it is of.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Limit { $(#[doc = $name] $limit,)* }

        impl Limit {
            pub const ALL: &'static [Limit] = &[$(Limit::$limit,)*];

            /// Its name; `…` stands for what it is of.
            pub const fn name(self) -> &'static str {
                match self { $(Limit::$limit => $name,)* }
            }
        }
    };
}

limits! {
    Torque = "torque of …",
    TorqueSpeed = "torque–speed of …",
    LowerStop = "range of … (lower stop)",
    UpperStop = "range of … (upper stop)",
    VerticalForce = "vertical force",
    VerticalForceOfFoot = "vertical force of …",
    Friction = "friction",
    FrictionOfFoot = "friction of …",
    Clearance = "swing clearance",
    ClearanceOfFoot = "swing clearance of …",
    PlatformHeight = "platform height",
    Height = "height of …",
    ShortestPhase = "shortest phase",
    LongestPhase = "longest phase",
    VerticalImpulse = "vertical impulse",
    ImpulseFriction = "friction of the impulse",
    ImpulseFrictionOfFoot = "friction of the impulse on a real foot",
    Leaving = "leaving foot",
    Touchdown = "touchdown height",
    MeanSpeed = "mean speed",
    ClosureOfBeta = "closure of β",
    ClosureOfSigma = "closure of σ",
    Pitching = "pitching at the impact on real feet",
    Still = "… held still",
    Duration = "duration of the phase",
}

/// Words of an older build in those of this one. Before gaits had flights, a phase was called a half step.
pub fn current(words: &str) -> String {
    words.replace("half step", "phase")
}

/// Reads the name of a limit, from an older build's result too.
///
/// # Errors
/// If it is no text.
pub fn name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    Ok(current(&String::deserialize(deserializer)?))
}

/// Reads a list of such names.
///
/// # Errors
/// If it is no list of texts.
pub fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    Ok(Vec::<String>::deserialize(deserializer)?.iter().map(|name| current(name)).collect())
}

/// Where a name says what it is of.
const OF: char = '…';

impl Limit {
    /// Whether it is the question itself: what the speed asked for and the cycle demand.
    pub fn is_asked(self) -> bool {
        matches!(self, Limit::MeanSpeed | Limit::ClosureOfBeta | Limit::ClosureOfSigma | Limit::Touchdown)
    }

    /// Its name with the joint, leg or point that it is of.
    pub fn of(self, what: &str) -> String {
        self.name().replace(OF, what)
    }

    /// The limit of this name, and what it is of.
    pub fn read(name: &str) -> Option<(Limit, &str)> {
        let whole = Limit::ALL.iter().find(|limit| limit.name() == name).map(|limit| (*limit, ""));
        let part = |limit: Limit| {
            let (before, behind) = limit.name().split_once(OF)?;
            let what = name.strip_prefix(before)?.strip_suffix(behind)?;
            (!what.is_empty()).then_some((limit, what))
        };
        // Names without a part that varies come first: "friction of the impulse" is no friction of a leg of that name.
        whole.or_else(|| Limit::ALL.iter().copied().find_map(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_leads_back_to_its_limit() {
        for limit in Limit::ALL.iter().copied() {
            let (of, name) = match limit.name().contains(OF) {
                true => ("knee1 of fore_left", limit.of("knee1 of fore_left")),
                false => ("", limit.of("nothing")),
            };
            assert_eq!(Limit::read(&name), Some((limit, of)), "{name}");
        }
        for name in ["", "platform above the ground", "torque of ", "range of knee1", "friction of"] {
            assert_eq!(Limit::read(name), None, "{name}");
        }
    }

    #[test]
    fn no_two_limits_have_one_name() {
        for (k, a) in Limit::ALL.iter().enumerate() {
            for b in &Limit::ALL[k + 1..] {
                assert_ne!(a.name(), b.name());
            }
        }
    }
}
