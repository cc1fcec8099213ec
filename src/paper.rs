//! What the paper reports of the gaits that it has (§6.2, §6.3), at 0.6 m/s.

use piaffe_cli::Published;
use piaffe_model::motion::Criterion::{self, Energy, Torque};

const TROT: &str = "f1124b492368bd98";
const AMBLE: &str = "cf6da2268fd1eded";
const CURVET: &str = "6cc3f22698183d87";

/// In the paper's order.
pub const PUBLISHED: &[Published] = &[
    of(TROT, Energy, 29.98, "0.31"),
    of(AMBLE, Energy, 55.13, "0.17"),
    of(CURVET, Energy, 78.87, "0.31/0.196"),
    of(TROT, Torque, 112.17, "0.35"),
    of(AMBLE, Torque, 256.8, "0.404"),
    of(CURVET, Torque, 802.26, "0.456/0.298"),
];

const fn of(fingerprint: &'static str, criterion: Criterion, cost: f64, durations: &'static str) -> Published {
    Published { fingerprint, criterion, speed: 0.6, cost, durations }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaits::GAITS;

    #[test]
    fn the_gaits_of_the_paper_are_those_shipped() {
        for (key, fingerprint) in [("trot", TROT), ("amble", AMBLE), ("curvet", CURVET)] {
            let gait = GAITS.iter().find(|gait| gait.description().key == key).unwrap();
            assert_eq!(gait.description().fingerprint(), fingerprint, "{key}");
        }
    }
}
