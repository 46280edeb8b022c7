//! The samples that a worker has still to take.

use fogbow_kernels::columns::queues::Request;
use fogbow_kernels::lanes::LANES;

use crate::film::Region;

/// The samples of a block that no lane has taken yet: all samples of a pixel before the next pixel, so that
/// neighbouring lanes see similar things and sums stay in cache.
pub(super) struct Work {
    region: Region,
    samples: core::ops::Range<u32>,
    next: Request,
}

impl Work {
    pub fn new(region: Region, samples: core::ops::Range<u32>) -> Self {
        let next = Request { x: region.x0, y: region.y0, sample: samples.start };
        Self { region, samples, next }
    }

    /// Whether nothing is left.
    #[inline]
    pub fn is_done(&self) -> bool {
        self.next.y >= self.region.y1 || self.samples.is_empty()
    }

    /// The next one, if any is left.
    #[inline]
    pub fn next(&mut self) -> Option<Request> {
        (!self.is_done()).then(|| self.pass(1))
    }

    /// The first of the next eight, if these are left and of one pixel.
    #[inline]
    pub fn next_eight(&mut self) -> Option<Request> {
        let has_eight = !self.is_done() && self.samples.end - self.next.sample >= LANES as u32;
        has_eight.then(|| self.pass(LANES as u32))
    }

    /// Goes on by so many of one pixel, and says which was the first.
    #[inline]
    fn pass(&mut self, count: u32) -> Request {
        let first = self.next;
        self.next.sample += count;
        if self.next.sample == self.samples.end {
            self.next = Request { x: self.next.x + 1, sample: self.samples.start, ..self.next };
        }
        if self.next.x == self.region.x1 {
            self.next = Request { x: self.region.x0, y: self.next.y + 1, ..self.next };
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_the_same_by_eight_and_one_by_one() {
        let region = Region { x0: 3, y0: 1, x1: 6, y1: 3 };
        for samples in [0..0, 0..5, 0..8, 3..30, 7..71] {
            let mut one_by_one = Work::new(region, samples.clone());
            let expected: Vec<Request> = core::iter::from_fn(|| one_by_one.next()).collect();
            let (mut work, mut found, mut eights) = (Work::new(region, samples.clone()), Vec::new(), 0);
            loop {
                if let Some(first) = work.next_eight() {
                    found.extend((0..8).map(|nth| Request { sample: first.sample + nth, ..first }));
                    eights += 1;
                } else if let Some(request) = work.next() {
                    found.push(request);
                } else {
                    break;
                }
            }
            assert_eq!(found, expected, "{samples:?}");
            assert_eq!(eights, 6 * (samples.len() / LANES), "{samples:?}");
        }
    }
}
