//! From virtual legs back to the real robot: what each of its legs does, and whether it can.
//!
//! The whole robot moves as the gait says (`posture`); its equations of motion (`equations`) then say what torques and
//! reactions that takes in all. Where two feet stand, there is a choice: they can push against each other. `shares` finds
//! all ways to share the reactions, `limits` what every foot and joint must keep to, `margin` the best of the
//! ways, `cheapest` those that cost least. `lift` is the whole motion, `receipt` the verdict on it.
//!
//! For a curvet and a trot equal shares do (§2.2, §2.4). In an amble they do not: the platform neither pitches nor yaws, and
//! only unequal loads on the fore and the hind foot hold it so. The torques of a pair's joints then differ too; their sums are
//! the virtual leg's (§2.3 leaves this open).

mod cheapest;
mod cost;
mod equations;
mod lack;
mod lift;
mod limits;
mod margin;
mod posture;
mod receipt;
mod rows;
mod shares;
mod table;
mod words;

pub use cost::{Effort, Motor, RealCosts, Ways};
pub use equations::{Equations, PLATFORM};
pub use lack::{Component, Lack};
pub use lift::{Impact, Instant, Lift, NotLifted, Sharing};
pub use limits::{Affine, Limit, Limits, Room};
pub use margin::{Best, best, cone};
pub use posture::{Legs, Posture};
pub use receipt::{Binding, Lacks, RealLegs, Verdict, Worst};
pub use rows::Rows;
pub use shares::{Equation, Reactions, Shares, Squeeze};
pub use table::{csv, json};
