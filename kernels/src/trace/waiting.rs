//! Rays that wait until they are eight.
//!
//! ```text
//! for each batch:  those of its rays that are near anything wait
//!                  while eight or more wait: the first eight are traced together
//! at last, what still waits is traced
//! ```
//!
//! Of eight flights in fog one or so is near a wall. Traced with the others it would take as long as eight.

use wide::{f32x8, u32x8};

use super::Rays;
use crate::lanes::{self, LANES};
use crate::vec3::Vec3x8;

/// Rays in the order in which they came.
pub struct Waiting {
    count: usize,
    /// Whose they are.
    lane: [u32; Self::ROOM],
    /// The components of their origins and directions, and their bounds.
    numbers: [[f32; Self::ROOM]; 7],
}

/// Up to eight rays that have waited.
pub struct Waited {
    /// The rays.
    pub rays: Rays,
    /// Whose they are.
    pub lane: u32x8,
    /// Which lanes are taken, as bits: the first ones.
    pub live: u32,
}

impl Waiting {
    /// Seven that wait, and eight that come.
    const ROOM: usize = 2 * LANES;

    /// None yet.
    #[inline(always)]
    pub fn new() -> Self {
        Self { count: 0, lane: [0; Self::ROOM], numbers: [[0.0; Self::ROOM]; 7] }
    }

    /// The rays of the set `bits` wait, fewer than eight others before them.
    #[inline(always)]
    pub fn add(&mut self, rays: &Rays, lane: u32x8, bits: u32) {
        let (order, at) = (lanes::pack_order(bits), self.count..self.count + LANES);
        self.lane[at.clone()].copy_from_slice(&lane.shuffle(order).to_array());
        let Rays { origin, direction, max } = *rays;
        let numbers = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, max];
        for (column, numbers) in self.numbers.iter_mut().zip(numbers) {
            column[at.clone()].copy_from_slice(&lanes::reorder_f32(numbers, order).to_array());
        }
        self.count += bits.count_ones() as usize;
    }

    /// Eight of them, if so many wait.
    #[inline(always)]
    pub fn full(&mut self) -> Option<Waited> {
        (self.count >= LANES).then(|| self.take())
    }

    /// What waits, fewer than eight; none if nothing does.
    #[inline(always)]
    pub fn rest(&mut self) -> Option<Waited> {
        (self.count > 0).then(|| self.take())
    }

    #[inline(always)]
    fn take(&mut self) -> Waited {
        let first = |column: &[f32; Self::ROOM]| f32x8::new(lanes::per_lane(|i| column[i]));
        let [x, y, z, dx, dy, dz, max] = self.numbers.each_ref().map(first);
        let rays = Rays { origin: Vec3x8::new(x, y, z), direction: Vec3x8::new(dx, dy, dz), max };
        let waited =
            Waited { rays, lane: u32x8::new(lanes::per_lane(|i| self.lane[i])), live: lanes::first(self.count) };
        self.lane.copy_within(LANES.., 0);
        self.numbers.iter_mut().for_each(|column| column.copy_within(LANES.., 0));
        self.count = self.count.saturating_sub(LANES);
        waited
    }
}

impl Default for Waiting {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays of which every number tells which it is.
    fn rays(first: u32) -> (Rays, u32x8) {
        let lane = u32x8::splat(first) + lanes::indices(0);
        let numbers = |of: u32| f32x8::new(lane.to_array().map(|lane| (1000 * of + lane) as f32));
        let vector = |of: u32| Vec3x8::new(numbers(of), numbers(of + 1), numbers(of + 2));
        (Rays { origin: vector(1), direction: vector(4), max: numbers(7) }, lane)
    }

    #[test]
    fn rays_come_back_as_they_were_and_in_their_order() {
        let (mut waiting, mut expected, mut found) = (Waiting::new(), Vec::new(), Vec::new());
        let mut settle = |waited: Waited| {
            let taken = waited.live.count_ones() as usize;
            assert_eq!(waited.live, lanes::first(taken));
            for lane in 0..taken {
                let of = waited.lane.to_array()[lane];
                let number = |of_number: u32| (1000 * of_number + of) as f32;
                let ray = waited.rays.at(lane);
                assert_eq!(ray.origin, [number(1), number(2), number(3)]);
                assert_eq!((ray.direction, ray.max), ([number(4), number(5), number(6)], number(7)));
                found.push(of);
            }
            taken
        };
        for bits in 0..=lanes::ALL {
            let (rays, lane) = rays(8 * bits);
            expected.extend(lanes::each(bits).map(|i| 8 * bits + i as u32));
            waiting.add(&rays, lane, bits);
            while let Some(waited) = waiting.full() {
                assert_eq!(settle(waited), LANES);
            }
        }
        assert_eq!(waiting.rest().map(&mut settle), Some(expected.len() % LANES).filter(|rest| *rest > 0));
        assert!(waiting.rest().is_none() && waiting.full().is_none());
        assert_eq!(found, expected);
    }
}
