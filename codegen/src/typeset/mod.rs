//! The closed forms of a gait for people: a LaTeX document with the names of the robot's parameters.

mod latex;
mod terms;

pub use latex::latex;
