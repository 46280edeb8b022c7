//! The samples that a worker has still to take.

use fogbow_kernels::columns::queues::Request;

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

    /// The next one, if any is left.
    #[inline]
    pub fn next(&mut self) -> Option<Request> {
        if self.next.y >= self.region.y1 || self.samples.is_empty() {
            return None;
        }
        let request = self.next;
        self.next.sample += 1;
        if self.next.sample == self.samples.end {
            self.next = Request { x: self.next.x + 1, sample: self.samples.start, ..self.next };
        }
        if self.next.x == self.region.x1 {
            self.next = Request { x: self.region.x0, y: self.next.y + 1, ..self.next };
        }
        Some(request)
    }
}
