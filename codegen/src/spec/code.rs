//! The stable codes of all mistakes that a specification can contain.

use std::fmt;

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)*) => {
        /// What kind of mistake a [`Diagnostic`](super::Diagnostic) reports. A code never changes its meaning.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code { $($(#[$doc])* $name,)* }

        impl Code {
            /// Every code, in order.
            pub const ALL: &'static [Code] = &[$(Code::$name,)*];

            /// The code as messages show it, such as `S006`.
            pub const fn as_str(self) -> &'static str {
                match self { $(Code::$name => $text,)* }
            }
        }
    };
}

codes! {
    /// The file is not TOML.
    Syntax = "S001",
    /// A key that the table does not have.
    UnknownKey = "S002",
    /// Keys that the table must have.
    MissingKey = "S003",
    /// A value of another type than the key takes.
    WrongType = "S004",
    /// A number that is not finite, or beyond the scale of any robot.
    NotFinite = "S005",
    /// A number outside the bounds of its key, such as a negative mass.
    OutOfBounds = "S006",
    /// A word that is none of the key's choices.
    UnknownChoice = "S007",
    /// A name that cannot be used in generated code.
    BadName = "S008",
    /// A list with too many or too few entries, or with one of them twice.
    WrongCount = "S009",
    /// A reference to a link, joint, actuator or leg that does not exist.
    UnknownName = "S010",
    /// A link, joint or actuator that nothing uses.
    Unused = "S011",
    /// An inertia that no rigid body can have.
    ImpossibleInertia = "S012",
    /// A pair of bounds in the wrong order.
    ReversedRange = "S013",
    /// A motor that turns faster at its greatest torque than without load.
    SpeedRisesWithTorque = "S014",
    /// No link, or more than one, is the platform.
    NotOnePlatform = "S015",
    /// A link that is the child of two joints.
    TwoParents = "S016",
    /// Joints whose links hang on each other in a circle.
    Cycle = "S017",
    /// A link of a leg on which two joints hang.
    Branch = "S018",
    /// A robot with fewer than two legs.
    TooFewLegs = "S019",
    /// Two legs at the same place.
    SameMount = "S020",
    /// A leg that starts with a joint that does not hang on the platform.
    NotOnPlatform = "S021",
    /// A leg that could start with several joints and does not say which.
    AmbiguousFirstJoint = "S022",
    /// A number so small that what is computed from it would vanish.
    Vanishing = "S023",
    /// A leg that cannot reach out of the platform's extent.
    ExtentHidesLeg = "S024",
    /// A gait that does not have two virtual legs.
    NotTwoVirtualLegs = "S030",
    /// A leg that belongs to no virtual leg.
    IdleLeg = "S031",
    /// A leg that belongs to two virtual legs, or twice to one.
    LegTwice = "S032",
    /// Legs of one virtual leg that cannot move as one.
    LegsDoNotPair = "S033",
    /// Half steps, or halves of a cycle, that cannot be mirror images of each other.
    NotMirrored = "S034",
    /// Directions of motion that do not go with the platform's rotation.
    WrongMoves = "S035",
    /// More or less than one unactuated coordinate.
    NotOneUnactuated = "S036",
    /// A joint that leaves the plane of a planar gait.
    OutOfPlane = "S037",
    /// A joint that the gait cannot hold still.
    CannotLock = "S040",
    /// Keys of both ways to write a gait's phases.
    TwoWays = "S041",
    /// A flight of a robot that cannot fly.
    CannotFly = "S042",
    /// A phase in which both virtual legs stand.
    DoubleSupport = "S043",
    /// Two phases in a row in which the same stands.
    PhasesAlike = "S044",
    /// A virtual leg that never stands.
    NeverStands = "S045",
    /// A list of phases that does not begin on leg 1.
    NotOnLeg1First = "S046",
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
