//! A part of a study, for one of several machines.

use crate::study::Study;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// One of so many parts; every so-many-th design is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "Written")]
pub struct Shard {
    /// From 1.
    index: usize,
    count: usize,
}

/// A shard as it stands in a file.
#[derive(Deserialize)]
#[serde(rename = "Shard")]
struct Written {
    index: usize,
    count: usize,
}

impl TryFrom<Written> for Shard {
    type Error = String;

    fn try_from(Written { index, count }: Written) -> Result<Shard, String> {
        Shard::new(index, count)
            .ok_or_else(|| format!("there is no part {index} of {count}: the index is from 1 to the count"))
    }
}

impl Shard {
    /// All of a study.
    pub const WHOLE: Shard = Shard { index: 1, count: 1 };

    /// The part of this index, from 1 to their count.
    pub fn new(index: usize, count: usize) -> Option<Shard> {
        (1..=count).contains(&index).then_some(Shard { index, count })
    }

    /// From 1.
    pub fn index(self) -> usize {
        self.index
    }

    /// Of all parts.
    pub fn count(self) -> usize {
        self.count
    }

    /// All parts of the same study.
    pub fn all(self) -> impl Iterator<Item = Shard> {
        (1..=self.count).map(move |index| Shard { index, ..self })
    }

    /// The numbers of its points, ascending.
    pub fn points(self, study: &Study) -> Vec<usize> {
        let of_design = study.of_design();
        let designs = (self.index - 1..study.designs.count()).step_by(self.count);
        designs.flat_map(|design| design * of_design..(design + 1) * of_design).collect()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let shard = text
            .split_once('/')
            .and_then(|(index, count)| Shard::new(index.trim().parse().ok()?, count.trim().parse().ok()?));
        shard.ok_or_else(|| "write I/N with I from 1 to N, for example 2/8".into())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}
