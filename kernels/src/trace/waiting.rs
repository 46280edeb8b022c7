//! Flights that wait until they are eight.
//!
//! ```text
//! those flights of a batch that are near anything wait
//! while eight or more wait: the first eight are traced together
//! at last, what still waits is traced
//! ```
//!
//! Of eight flights in fog one or so is near a wall. Traced with the others it would take as long as eight. What waits is
//! a lane: its ray stays where it is.

use wide::u32x8;

use crate::lanes::{self, LANES};

/// Lanes that wait, in the order in which they came.
#[derive(Clone, Copy, Debug, Default)]
pub struct Waiting {
    count: usize,
    /// Seven that wait, and eight that come.
    lane: [u32; 2 * LANES],
}

/// Up to eight lanes that have waited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waited {
    /// The lanes; 0 where there is none.
    pub lane: [u32; LANES],
    /// Which are taken, as bits: the first ones.
    pub live: u32,
}

impl Waiting {
    /// The lanes of batch `b` in the set `bits` wait, fewer than eight others before them. Gives the first eight, if so
    /// many wait now.
    #[inline(always)]
    pub fn add(&mut self, b: usize, bits: u32) -> Option<Waited> {
        let packed = lanes::indices(b).shuffle(lanes::pack_order(bits));
        self.lane[self.count..self.count + LANES].copy_from_slice(packed.as_array());
        self.count += bits.count_ones() as usize;
        (self.count >= LANES).then(|| self.take())
    }

    /// The same for one lane.
    #[inline(always)]
    pub fn add_one(&mut self, lane: u32) -> Option<Waited> {
        self.lane[self.count] = lane;
        self.count += 1;
        (self.count == LANES).then(|| self.take())
    }

    /// What still waits, fewer than eight; none if nothing does.
    #[inline(always)]
    pub fn rest(&mut self) -> Option<Waited> {
        (self.count > 0).then(|| self.take())
    }

    #[inline(always)]
    fn take(&mut self) -> Waited {
        let live = lanes::first(self.count);
        let first = u32x8::new(lanes::per_lane(|i| self.lane[i])) & lanes::as_integer_mask(lanes::mask(live));
        self.lane.copy_within(LANES.., 0);
        self.count = self.count.saturating_sub(LANES);
        Waited { lane: first.to_array(), live }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_come_back_once_and_in_their_order() {
        let (mut waiting, mut expected, mut found) = (Waiting::default(), Vec::new(), Vec::new());
        let mut settle = |waited: Waited| {
            let taken = waited.live.count_ones() as usize;
            assert_eq!(waited.live, lanes::first(taken));
            assert_eq!(waited.lane[taken..], [0; LANES][taken..]);
            found.extend_from_slice(&waited.lane[..taken]);
            taken
        };
        for bits in 0..=lanes::ALL {
            let b = 2 * bits as usize;
            expected.extend(lanes::each(bits).map(|i| (b * LANES + i) as u32));
            if let Some(waited) = waiting.add(b, bits) {
                assert_eq!(settle(waited), LANES);
            }
            let one = ((b + 1) * LANES) as u32;
            expected.push(one);
            if let Some(waited) = waiting.add_one(one) {
                assert_eq!(settle(waited), LANES);
            }
        }
        assert_eq!(waiting.rest().map(&mut settle), Some(expected.len() % LANES).filter(|rest| *rest > 0));
        assert_eq!(waiting.rest(), None);
        assert_eq!(found, expected);
    }
}
