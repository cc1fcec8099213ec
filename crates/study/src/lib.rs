//! Studies: the optimal gaits of many robots that differ in some numbers, a row each.
//!
//! `vary` is what is to vary, `designs` the robots that come of it, `study` the question, whose points are designs with a gait, a
//! criterion and a speed; `question` is one that is written down, `shard` a part of it. `answers` makes of each point a `row`, and
//! `column` says what rows are as a table, which `table` writes as CSV and `columnar` as Parquet. `difference` sets two results side by side.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod answers;
mod column;
#[cfg(feature = "parquet")]
mod columnar;
mod designs;
pub mod difference;
mod question;
mod row;
mod shard;
mod study;
pub mod table;
mod vary;

pub use answers::Answers;
pub use column::{Cell, Column, Kind};
#[cfg(feature = "parquet")]
pub use columnar::parquet;
pub use designs::Designs;
pub use question::{File, Files, Question, Unreadable};
pub use row::{Beyond, Optimum, Outcome, Pushed, Row, Slopes};
pub use shard::Shard;
pub use study::{FEW, Point, Search, Study};
pub use vary::{Over, Vary, multiples, steps};
