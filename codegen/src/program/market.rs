//! The market of divisors: what each would save over all sums, and which saves most.
//!
//! There are hundreds of thousands of divisors and most are seen once. So they stand one after another as they are
//! seen, and what is looked up all over memory is only a table of eight bytes each. Keys are hashes already, and there
//! is no random seed: same input, same program.

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

/// An occurrence that the market has: of which divisor, and what it saves.
#[derive(Clone, Copy, Default)]
pub struct Offered {
    number: Number,
    saved: [i16; 2],
}

struct Listing {
    key: u64,
    origin: Origin,
    /// What its occurrences save in all less what it costs, for either choice of the coefficient that is 1.
    gains: [i32; 2],
    /// The gain of its highest entry in the queue.
    queued: i32,
}

impl Listing {
    /// Operations saved if all occurrences are replaced.
    fn gain(&self) -> i32 {
        self.gains[0].max(self.gains[1])
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
    fn clear(&mut self) {
        self.sorted.clear();
        self.taken = 0;
        self.others.clear();
    }

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
#[derive(Default)]
pub struct Market {
    listings: Vec<Listing>,
    /// Open addressing: half a key and the divisor's number; the length is a power of two.
    table: Vec<(u32, Number)>,
    /// The divisors of each gain, up to the highest one. Gains may be out of date: too high, never too low.
    queue: Vec<Level>,
    highest: usize,
    /// Whether the queue is kept up to date.
    open: bool,
}

const VACANT: Number = Number::MAX;

impl Market {
    /// Closes and empties it, with room for about so many divisors and as many again that come from rewriting.
    pub fn begin(&mut self, room: usize) {
        self.listings.clear();
        self.listings.reserve(2 * room);
        self.table.clear();
        self.table.resize((room + room / 4).next_power_of_two().max(64), (0, VACANT));
        self.queue.iter_mut().for_each(Level::clear);
        self.open = false;
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

    #[cold]
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

    /// Adds an occurrence. `saved` is what it saves to replace it, for
    /// either choice of the coefficient that is 1; `new` tells where it was seen and the operations that a definition
    /// costs, again for either choice, if it is a new one.
    #[inline]
    pub fn add(&mut self, key: u64, saved: [i16; 2], new: impl FnOnce() -> (Origin, [i16; 2])) -> Offered {
        let number = self.number(key, new);
        let listing = &mut self.listings[number as usize];
        listing.gains[0] += i32::from(saved[0]);
        listing.gains[1] += i32::from(saved[1]);
        if self.open && listing.gain() > listing.queued {
            self.queue(number);
        }
        Offered { number, saved }
    }

    /// The number of the divisor with this key, which is listed if it is new.
    #[inline]
    fn number(&mut self, key: u64, new: impl FnOnce() -> (Origin, [i16; 2])) -> Number {
        let at = self.place(key);
        if self.table[at].1 != VACANT {
            return self.table[at].1;
        }
        let number = self.listings.len() as Number;
        self.table[at] = ((key >> 32) as u32, number);
        let (origin, cost) = new();
        self.listings.push(Listing { key, origin, gains: cost.map(|cost| -i32::from(cost)), queued: 0 });
        if 5 * self.listings.len() > 4 * self.table.len() {
            self.grow();
        }
        number
    }

    /// Takes an occurrence back.
    #[inline]
    pub fn take(&mut self, offered: Offered) {
        let listing = &mut self.listings[offered.number as usize];
        listing.gains[0] -= i32::from(offered.saved[0]);
        listing.gains[1] -= i32::from(offered.saved[1]);
    }

    pub fn open(&mut self) {
        self.open = true;
        (0..self.listings.len() as Number).for_each(|number| self.queue(number));
    }

    /// Puts a divisor in the queue where it is not yet, or too low.
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
            self.highest = self.highest.max(gain);
        }
    }

    /// The divisor that saves most, the oldest of these.
    pub fn best(&mut self) -> Option<Best> {
        while self.highest > 0 {
            let Some(number) = self.queue[self.highest].pop() else {
                self.highest -= 1;
                continue;
            };
            let gain = self.highest as i32;
            let listing = &mut self.listings[number as usize];
            if gain == listing.queued {
                listing.queued = 0;
                if listing.gain() == gain {
                    return Some(Best { number, origin: listing.origin, gain });
                }
                self.queue(number);
            }
        }
        None
    }

    /// What a divisor with a definition of one operation saves in all.
    pub fn saved(&self, key: u64) -> i32 {
        self.find(key).map_or(0, |number| self.listings[number as usize].gains[0] + 1)
    }

    /// `best` turned out to gain less, since some occurrences overlap, so that not all can be replaced.
    pub fn correct(&mut self, best: &Best, gain: i32) {
        let overcount = best.gain - gain;
        self.listings[best.number as usize].gains.iter_mut().for_each(|gain| *gain -= overcount);
        self.queue(best.number);
    }
}
