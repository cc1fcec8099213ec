//! Who looks on while a search goes on, and can end it.

use piaffe_sqp::Control;

/// What a search tells of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A descent is at its next iterate.
    Iterate,
    /// This start has ended.
    Ended(usize),
    /// It begins anew, with limits at each real leg.
    AtRealLegs,
    /// There is no motion: the nearest speed that works is looked for.
    NearestSpeed,
}

/// Is told all of it and says whether the search is to go on. What comes of a search that was stopped is no answer.
pub type Watch<'w> = &'w (dyn Fn(Event) -> Control + Sync);

/// Tells `done` which starts have ended, and lets the search go on.
pub fn ended(done: &(dyn Fn(usize) + Sync)) -> impl Fn(Event) -> Control + Sync + '_ {
    move |event| {
        if let Event::Ended(start) = event {
            done(start);
        }
        Control::Continue
    }
}
