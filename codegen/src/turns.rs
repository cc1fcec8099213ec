//! Work that threads share.

use rayon::prelude::*;

/// What `make` makes of each item, in the items' order. Threads take them one by one in the order of `key`: with what
/// takes longest first, none is left with it in the end. Each has something of its own to work with.
pub fn in_turn<T: Send, K: Ord, S, R: Send>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
    own: impl Fn() -> S + Sync + Send,
    make: impl Fn(&mut S, T) -> R + Sync + Send,
) -> Vec<R> {
    let mut turns: Vec<(usize, T)> = items.into_iter().enumerate().collect();
    turns.sort_by_key(|(_, item)| key(item));
    let made = turns.into_iter().par_bridge().map_init(own, |own, (place, item)| (place, make(own, item)));
    let mut made: Vec<(usize, R)> = made.collect();
    made.sort_unstable_by_key(|(place, _)| *place);
    made.into_iter().map(|(_, result)| result).collect()
}
