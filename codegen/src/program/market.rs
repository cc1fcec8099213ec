//! The market of divisors: what each would save over all sums, and which saves most.
//!
//! There are hundreds of thousands of divisors and most are seen once. So they stand one after another as they are
//! seen, and what is looked up all over memory is only a table of eight bytes each, for many divisors at once: memory
//! takes as long for one answer as for ten. Keys are hashes already, and there is no random seed: same input, same program.

use super::Id;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Where a divisor was seen first, by indices of terms. It can be read off there for ever.
#[derive(Clone, Copy)]
pub enum Origin {
    Pair(u32, u32),
    Product(Id, Id),
    Scaled(Id, u32),
}

/// A divisor, by the order in which they were first seen.
pub type Number = u32;

/// An occurrence of a divisor.
pub struct Offer {
    pub key: u64,
    /// Operations that a definition costs, with the first or the second part's coefficient 1.
    pub cost: [i16; 2],
    /// Factors of a pair's first part.
    pub first: u16,
    /// What it saves to replace it, for either choice of the coefficient that is 1.
    pub saved: [i16; 2],
    pub origin: Origin,
}

struct Listing {
    key: u64,
    /// See [`Offer`].
    cost: [i16; 2],
    first: u16,
    /// What its occurrences save in all, for either choice of the coefficient that is 1.
    saved: [i32; 2],
    /// What occurrences that overlap, so that not all can be replaced, were found to count too much.
    overcount: i32,
    /// The gain of its highest entry in the queue.
    queued: i32,
}

impl Listing {
    /// Operations saved if all occurrences are replaced, less what the divisor costs.
    fn gain(&self) -> i32 {
        let with = |unit: usize| self.saved[unit] - i32::from(self.cost[unit]);
        with(0).max(with(1)) - self.overcount
    }
}

/// The divisor to extract next.
pub struct Best {
    pub number: Number,
    pub origin: Origin,
    pub gain: i32,
}

/// Divisors of one gain, to be taken the oldest first.
#[derive(Default)]
struct Level {
    /// Those that came in order, and how many of them are taken.
    sorted: Vec<Number>,
    taken: usize,
    others: BinaryHeap<Reverse<Number>>,
}

impl Level {
    fn push(&mut self, number: Number) {
        if self.sorted.last().is_none_or(|last| *last < number) {
            self.sorted.push(number);
        } else {
            self.others.push(Reverse(number));
        }
    }

    fn pop(&mut self) -> Option<Number> {
        let next = self.sorted.get(self.taken).copied();
        match (next, self.others.peek()) {
            (Some(next), Some(Reverse(other))) if other < &next => self.others.pop().map(|Reverse(number)| number),
            (Some(next), _) => {
                self.taken += 1;
                Some(next)
            }
            (None, _) => self.others.pop().map(|Reverse(number)| number),
        }
    }
}

/// All divisors that the sums offer.
pub struct Market {
    listings: Vec<Listing>,
    origins: Vec<Origin>,
    /// Open addressing: half a key and the divisor's number; the length is a power of two.
    table: Vec<(u32, Number)>,
    /// The divisors of each gain. Gains may be out of date: too high, never too low.
    queue: Vec<Level>,
    /// Whether the queue is kept up to date.
    open: bool,
}

const VACANT: Number = Number::MAX;

impl Market {
    /// A market with room for about so many divisors, and as many again that come from rewriting.
    pub fn new(room: usize) -> Market {
        let table = vec![(0, VACANT); (room + room / 4).next_power_of_two().max(64)];
        let (listings, origins) = (Vec::with_capacity(2 * room), Vec::with_capacity(2 * room));
        Market { listings, origins, table, queue: Vec::new(), open: false }
    }

    /// The place of `key` or where it belongs.
    fn place(&self, key: u64) -> usize {
        let mask = self.table.len() - 1;
        let mut at = key as usize & mask;
        loop {
            let (half, number) = self.table[at];
            if number == VACANT || (half == (key >> 32) as u32 && self.listings[number as usize].key == key) {
                return at;
            }
            at = (at + 1) & mask;
        }
    }

    fn grow(&mut self) {
        let larger = vec![(0, VACANT); 2 * self.table.len()];
        self.table = larger;
        for number in 0..self.listings.len() {
            let key = self.listings[number].key;
            let at = self.place(key);
            self.table[at] = ((key >> 32) as u32, number as Number);
        }
    }

    /// The divisor with this key, if it has been seen.
    fn find(&self, key: u64) -> Option<Number> {
        let (_, number) = self.table[self.place(key)];
        (number != VACANT).then_some(number)
    }

    /// Adds occurrences. `numbers` become those of their divisors.
    pub fn add(&mut self, offers: &[Offer], numbers: &mut Vec<Number>) {
        let mask = self.table.len() - 1;
        let likely = |offer: &Offer| {
            let (half, number) = self.table[offer.key as usize & mask];
            if half == (offer.key >> 32) as u32 { number } else { VACANT }
        };
        numbers.clear();
        numbers.extend(offers.iter().map(likely));
        for (offer, number) in offers.iter().zip(numbers) {
            if self.listings.get(*number as usize).is_none_or(|likely| likely.key != offer.key) {
                *number = self.number(offer);
            }
            let listing = &mut self.listings[*number as usize];
            listing.saved[0] += i32::from(offer.saved[0]);
            listing.saved[1] += i32::from(offer.saved[1]);
            if self.open {
                self.queue(*number);
            }
        }
    }

    /// The number of an offered divisor, which is listed if it is new.
    fn number(&mut self, offer: &Offer) -> Number {
        let at = self.place(offer.key);
        let Offer { key, cost, first, origin, .. } = *offer;
        if self.table[at].1 == VACANT {
            self.table[at] = ((key >> 32) as u32, self.listings.len() as Number);
            self.listings.push(Listing { key, cost, first, saved: [0; 2], overcount: 0, queued: 0 });
            self.origins.push(origin);
            if 5 * self.listings.len() > 4 * self.table.len() {
                self.grow();
            }
            return self.listings.len() as Number - 1;
        }
        self.table[at].1
    }

    /// Takes an occurrence back.
    pub fn take(&mut self, number: Number, saved: [i16; 2]) {
        let listing = &mut self.listings[number as usize];
        listing.saved[0] -= i32::from(saved[0]);
        listing.saved[1] -= i32::from(saved[1]);
    }

    pub fn open(&mut self) {
        self.open = true;
        (0..self.listings.len() as Number).for_each(|number| self.queue(number));
    }

    #[inline]
    fn queue(&mut self, number: Number) {
        let listing = &mut self.listings[number as usize];
        let gain = listing.gain();
        if gain > listing.queued {
            listing.queued = gain;
            let gain = gain as usize;
            if self.queue.len() <= gain {
                self.queue.resize_with(gain + 1, Level::default);
            }
            self.queue[gain].push(number);
        }
    }

    /// The divisor that saves most, the oldest of these.
    pub fn best(&mut self) -> Option<Best> {
        while let (gain, Some(highest)) = (self.queue.len() as i32 - 1, self.queue.last_mut()) {
            let Some(number) = highest.pop() else {
                self.queue.pop();
                continue;
            };
            let listing = &mut self.listings[number as usize];
            if gain == listing.queued {
                listing.queued = 0;
                if listing.gain() == gain {
                    return Some(Best { number, origin: self.origins[number as usize], gain });
                }
                self.queue(number);
            }
        }
        None
    }

    /// Factors of the first part of a pair.
    pub fn first(&self, number: Number) -> u16 {
        self.listings[number as usize].first
    }

    /// What the occurrences of a divisor save in all.
    pub fn saved(&self, key: u64) -> i32 {
        self.find(key).map_or(0, |number| self.listings[number as usize].saved[0])
    }

    /// `best` turned out to gain less, since some occurrences overlap.
    pub fn correct(&mut self, best: &Best, gain: i32) {
        self.listings[best.number as usize].overcount += best.gain - gain;
        self.queue(best.number);
    }
}
