//! A part of a study, for one of several machines.

use crate::study::Study;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// One of so many parts; every so-many-th design is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// From 1.
    pub index: usize,
    pub count: usize,
}

impl Shard {
    /// All of a study.
    pub const WHOLE: Shard = Shard { index: 1, count: 1 };

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
        let shard = text.split_once('/').and_then(|(index, count)| {
            Some(Shard { index: index.trim().parse().ok()?, count: count.trim().parse().ok()? })
        });
        match shard {
            Some(shard) if 1 <= shard.index && shard.index <= shard.count => Ok(shard),
            _ => Err("write I/N with I from 1 to N, for example 2/8".into()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}
