//! What a description refers to lives as long as the program: a built gait's is part of it, and a loaded one's stays. That is a few
//! kilobytes for a gait; texts are kept once.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

static TEXTS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// A text that stays.
pub fn text(text: &str) -> &'static str {
    // Whoever panicked left whole texts behind.
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = texts.get(text) {
        return known;
    }
    let text: &'static str = Box::leak(text.into());
    texts.insert(text);
    text
}

/// A list that stays.
pub fn kept<T>(list: Vec<T>) -> &'static [T] {
    Vec::leak(list)
}
