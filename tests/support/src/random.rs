//! Random numbers that depend on a number alone.

/// A sequence of random numbers (splitmix64).
pub struct Random(u64);

impl Random {
    /// The sequence of this number.
    pub fn new(case: u64) -> Self {
        Self(case)
    }

    /// All bits of the next number.
    #[expect(clippy::should_implement_trait, reason = "no iterator: it does not end")]
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `end`, which is > 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}
