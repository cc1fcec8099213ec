//! The market of divisors: what each would save over all sums, and which saves most.
//!
//! There are hundreds of thousands of divisors and each is touched a few times, so a divisor is one
//! small slot of a flat table. Keys are hashes already, and there is no random seed: same input, same
//! program.

use super::Id;
use super::divisor::Offer;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Where a divisor was seen first, by indices of terms. It can be read off there for ever.
#[derive(Clone, Copy)]
pub enum Origin {
    Pair(u32, u32),
    Product(Id, Id),
    Scaled(Id, u32),
}

#[derive(Clone, Copy, Default)]
struct Slot {
    /// 0: vacant.
    key: u64,
    /// What its occurrences save in all, for either choice of the coefficient that is 1.
    saved: [i32; 2],
    /// What occurrences that overlap, so that not all can be replaced, were found to count too much.
    overcount: i32,
    /// The gain of its highest entry in the queue.
    queued: i32,
    /// Number in order of first sight.
    age: u32,
    cost: [i16; 2],
}

impl Slot {
    /// Operations saved if all occurrences are replaced, less what the divisor costs.
    fn gain(&self) -> i32 {
        let with = |unit: usize| self.saved[unit] - i32::from(self.cost[unit]);
        with(0).max(with(1)) - self.overcount
    }
}

/// The divisor to extract next.
pub struct Best {
    pub key: u64,
    pub origin: Origin,
    pub gain: i32,
}

/// All divisors that the sums offer.
pub struct Market {
    /// Open addressing; the length is a power of two.
    slots: Vec<Slot>,
    origins: Vec<Origin>,
    /// By gain, then the oldest first. Entries may be out of date: too high, never too low.
    queue: BinaryHeap<(i32, Reverse<u32>, u64)>,
    /// Whether the queue is kept up to date.
    open: bool,
}

impl Market {
    pub fn new() -> Market {
        Market { slots: vec![Slot::default(); 1 << 10], origins: Vec::new(), queue: BinaryHeap::new(), open: false }
    }

    /// The place of `key` or where it belongs.
    fn place(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = key as usize & mask;
        while self.slots[at].key != key && self.slots[at].key != 0 {
            at = (at + 1) & mask;
        }
        at
    }

    fn grow(&mut self) {
        let larger = vec![Slot::default(); 4 * self.slots.len()];
        for slot in std::mem::replace(&mut self.slots, larger) {
            if slot.key != 0 {
                let at = self.place(slot.key);
                self.slots[at] = slot;
            }
        }
    }

    /// Adds an occurrence.
    pub fn add(&mut self, offer: &Offer, origin: Origin) {
        let mut at = self.place(offer.key);
        if self.slots[at].key == 0 {
            if 2 * self.origins.len() >= self.slots.len() {
                self.grow();
                at = self.place(offer.key);
            }
            let age = self.origins.len() as u32;
            self.origins.push(origin);
            self.slots[at] = Slot { key: offer.key, cost: offer.cost.map(|c| c as i16), age, ..Slot::default() };
        }
        let slot = &mut self.slots[at];
        slot.saved[0] += offer.saved[0];
        slot.saved[1] += offer.saved[1];
        if self.open {
            self.queue(at);
        }
    }

    /// Takes an occurrence back.
    pub fn take(&mut self, offer: &Offer) {
        let at = self.place(offer.key);
        let slot = &mut self.slots[at];
        slot.saved[0] -= offer.saved[0];
        slot.saved[1] -= offer.saved[1];
    }

    pub fn open(&mut self) {
        self.open = true;
        (0..self.slots.len()).for_each(|at| self.queue(at));
    }

    fn queue(&mut self, at: usize) {
        let slot = &mut self.slots[at];
        let gain = slot.gain();
        if gain > slot.queued {
            slot.queued = gain;
            self.queue.push((gain, Reverse(slot.age), slot.key));
        }
    }

    /// The divisor that saves most.
    pub fn best(&mut self) -> Option<Best> {
        while let Some((gain, _, key)) = self.queue.pop() {
            let at = self.place(key);
            let slot = &mut self.slots[at];
            if gain == slot.queued {
                slot.queued = 0;
                if slot.gain() == gain {
                    return Some(Best { key, origin: self.origins[slot.age as usize], gain });
                }
                self.queue(at);
            }
        }
        None
    }

    /// What the occurrences of a divisor save in all.
    pub fn saved(&self, key: u64) -> i32 {
        self.slots[self.place(key)].saved[0]
    }

    /// `best` turned out to gain less, since some occurrences overlap.
    pub fn correct(&mut self, best: &Best, gain: i32) {
        let at = self.place(best.key);
        self.slots[at].overcount += best.gain - gain;
        self.queue(at);
    }
}
