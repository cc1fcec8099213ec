//! Gaits that never leave the ground.

use piaffe::gaits::GAITS;
use piaffe::model::Gait;

pub fn walking() -> impl Iterator<Item = &'static &'static dyn Gait> {
    GAITS.iter().filter(|gait| !gait.description().flies())
}
