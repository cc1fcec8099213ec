//! The share that leaves most room: maximize over s the least of all margins `height(s) − |tangential(s)|`.
//!
//! Two feet have one number to choose, and [`line`] finds it exactly. More feet have more: a cone program ([`cone`]). Of both, weights
//! tell which limits stand in the way: no share has more room, because their weighted sum has not.

pub mod cone;
pub mod line;

use super::limits::{Limit, Room};
use super::shares::Squeeze;
use line::Line;

/// Room that is given up for a share nearer to the equal one.
pub const SLACK: f64 = 1e-9;
/// Limits that weigh less than this part of the whole are not in the way.
const IN_THE_WAY: f64 = 1e-3;
const BISECTIONS: usize = 60;

/// The share with the most room.
#[derive(Clone, Debug)]
pub struct Best {
    pub s: Squeeze,
    /// The least margin of all limits.
    pub margin: f64,
    /// The limits in the way of more room with their weights, which sum to 1; heaviest first.
    pub binding: Vec<(Limit, f64)>,
}

/// The shares that there are, seen by the room that they leave.
pub struct Choice {
    pub best: Best,
    /// Of two feet.
    pub line: Option<Line>,
}

/// Of all shares with the least margin as large as it can be (to `SLACK`), the one on the way to it from `s = 0` that comes first.
///
/// `None` if there is no greatest margin: of numbers that are none, or of limits that more and more of a share only helps.
pub fn best(rooms: &[Room], squeezes: usize) -> Option<Best> {
    Choice::new(rooms, squeezes).map(|choice| choice.best)
}

impl Choice {
    /// `None` as of [`best`].
    pub fn new(rooms: &[Room], squeezes: usize) -> Option<Choice> {
        let line = if squeezes == 1 { Some(Line::new(rooms)?) } else { None };
        let best = match (&line, squeezes) {
            (Some(line), _) => line.best(),
            (None, 0) => settled(rooms),
            (None, _) => cone::best(rooms, squeezes)?,
        };
        Some(Choice { best, line })
    }
}

/// Where there is no choice.
fn settled(rooms: &[Room]) -> Best {
    let s = Squeeze::new();
    let margins = rooms.iter().map(|room| (room.limit, room.margin(&s)));
    let least = margins.min_by(|a, b| a.1.total_cmp(&b.1));
    let binding = least.map(|(limit, _)| (limit, 1.0)).into_iter().collect();
    Best { s, margin: least.map_or(f64::INFINITY, |(_, margin)| margin), binding }
}

/// The least margin that these shares leave.
pub fn lowest(rooms: &[Room], s: &[f64]) -> f64 {
    rooms.iter().map(|room| room.margin(s)).fold(f64::INFINITY, f64::min)
}

/// From one choice to another that is good enough, the first that is; all beyond it are.
pub fn on_the_way(from: &[f64], to: &[f64], enough: impl Fn(&[f64]) -> bool) -> Squeeze {
    let at = |part: f64| from.iter().zip(to).map(|(from, to)| from + part * (to - from)).collect::<Squeeze>();
    if enough(from) {
        return Squeeze::from_slice(from);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if enough(&at(middle)) { high = middle } else { low = middle }
    }
    at(high)
}

/// Weights of limits as a list: each limit once, the heaviest first, without those that are not in the way.
fn weighed(weights: impl IntoIterator<Item = (Limit, f64)>) -> Vec<(Limit, f64)> {
    let mut binding: Vec<(Limit, f64)> = Vec::new();
    for (limit, weight) in weights {
        match binding.iter_mut().find(|known| known.0 == limit) {
            Some(known) => known.1 += weight,
            None => binding.push((limit, weight)),
        }
    }
    binding.retain(|(_, weight)| *weight > IN_THE_WAY);
    binding.sort_by(|a, b| b.1.total_cmp(&a.1));
    binding
}
