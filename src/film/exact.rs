//! Sums that are exact, so that they do not depend on the order of their terms.
//!
//! A sample's value is rounded once, to a multiple of a unit that belongs to the layer; from there on there is only
//! integer addition, and addition that would overflow saturates, which for non-negative terms is associative too. Any
//! number of threads, any tiling and any split of the samples therefore give the same bits.
//!
//! The unit follows from the largest value that is expected, for radiance that of the brightest light. A contribution
//! is at most its radiance where all walks go on, and rarely more than a thousand times that where few do; with `2^e`
//! the power of two above the largest value:
//!
//! | | unit | smallest | largest sample | sum |
//! |---|---|---|---|---|
//! | value | 2^(e-48) | 4e-15 of the largest | 2^48 times the largest | 96 bits |
//! | square | the value on 2^(e-40), squared | 1e-12 of it | 2^24 times | 128 bits |

/// The unit of a layer's sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The power of two above the largest value that is expected.
    exponent: i32,
    /// Units of the sum per unit of the values, a power of two.
    values: f64,
    /// Units of the root of the sum of squares per unit of the values, a power of two.
    roots: f64,
}

impl Unit {
    /// The unit for values of which `largest` is the largest that is expected, in the unit of the values themselves.
    pub fn for_largest(largest: f32) -> Self {
        // largest < 2^exponent, from the bits: the same on every machine.
        let exponent = if largest > 0.0 { (largest.to_bits() >> 23) as i32 - 126 } else { 0 };
        Self::for_exponent(exponent)
    }

    /// The unit for values below two to the power of `exponent`.
    pub const fn for_exponent(exponent: i32) -> Self {
        Self { exponent, values: power_of_two(48 - exponent), roots: power_of_two(40 - exponent) }
    }

    /// The number of units nearest to a value, finite and >= 0.
    #[inline]
    pub fn units(self, value: f32) -> u128 {
        nearest(f64::from(value) * self.values)
    }

    /// The square of the nearest number of units of roots, for a value, finite and >= 0; the largest, if it is larger.
    #[inline]
    pub fn square_units(self, value: f32) -> u128 {
        let root = nearest(f64::from(value) * self.roots).min(u128::from(u64::MAX));
        root * root
    }

    /// The power of two above the largest value that is expected.
    pub fn exponent(self) -> i32 {
        self.exponent
    }
}

/// Two to the power of `exponent`, which is that of a normal number.
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The whole number nearest to a number >= 0, of two the even one; the largest, if it is larger.
#[inline]
fn nearest(number: f64) -> u128 {
    // A sum with 2^52 has no digits behind the point, and ends with the bits of what is added. Converting is slower, even
    // to 64 bits, and hardly any sample is so large.
    const SHIFT: f64 = (1_u64 << 52) as f64;
    const DIGITS: u64 = (1 << 52) - 1;
    if number < SHIFT / 2.0 {
        u128::from((number + SHIFT).to_bits() & DIGITS)
    } else {
        number.round_ties_even() as u128
    }
}

/// Sum of one channel of one pixel, in 12 bytes: little-endian limbs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum([u32; 3]);

impl ExactSum {
    /// Number of its limbs.
    pub const LIMBS: usize = 3;

    /// The sum of these limbs, the least significant first.
    pub fn from_limbs(limbs: [u32; Self::LIMBS]) -> Self {
        Self(limbs)
    }

    /// Its limbs, the least significant first.
    pub fn limbs(self) -> [u32; Self::LIMBS] {
        self.0
    }

    /// Adds one sample, finite and >= 0.
    #[inline]
    pub fn add(&mut self, unit: Unit, value: f32) {
        self.add_raw(unit.units(value));
    }

    /// Adds so many units.
    #[inline]
    pub fn add_units(&mut self, units: u128) {
        self.add_raw(units);
    }

    /// Adds the sum of other samples.
    pub fn merge(&mut self, other: &Self) {
        self.add_raw(other.raw());
    }

    #[inline]
    fn add_raw(&mut self, sum: u128) {
        const LARGEST: u128 = (1 << 96) - 1;
        let sum = self.raw().saturating_add(sum).min(LARGEST);
        self.0 = [sum as u32, (sum >> 32) as u32, (sum >> 64) as u32];
    }

    fn raw(&self) -> u128 {
        let [a, b, c] = self.0.map(u128::from);
        a | b << 32 | c << 64
    }

    /// Mean of `samples` samples, in the unit of the values.
    pub fn mean(&self, unit: Unit, samples: u64) -> f64 {
        if samples == 0 {
            return 0.0;
        }
        self.raw() as f64 / samples as f64 / unit.values
    }
}

/// Sum of squares of one channel of one pixel, in 16 bytes: little-endian limbs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSquares([u32; 4]);

impl ExactSquares {
    /// Number of its limbs.
    pub const LIMBS: usize = 4;

    /// The sum of these limbs, the least significant first.
    pub fn from_limbs(limbs: [u32; Self::LIMBS]) -> Self {
        Self(limbs)
    }

    /// Its limbs, the least significant first.
    pub fn limbs(self) -> [u32; Self::LIMBS] {
        self.0
    }

    /// Adds the square of one sample, which is finite and >= 0.
    #[inline]
    pub fn add(&mut self, unit: Unit, value: f32) {
        self.add_raw(unit.square_units(value));
    }

    /// Adds so many units.
    #[inline]
    pub fn add_units(&mut self, units: u128) {
        self.add_raw(units);
    }

    /// Adds the squares of other samples.
    pub fn merge(&mut self, other: &Self) {
        self.add_raw(other.raw());
    }

    #[inline]
    fn add_raw(&mut self, squares: u128) {
        let squares = self.raw().saturating_add(squares);
        self.0 = [squares, squares >> 32, squares >> 64, squares >> 96].map(|limb| limb as u32);
    }

    fn raw(&self) -> u128 {
        let [a, b, c, d] = self.0.map(u128::from);
        a | b << 32 | c << 64 | d << 96
    }

    /// Standard error of the `mean` of `samples` samples, in the unit of the values: unbiased sample variance over the
    /// number of samples, rooted; 0 for one sample.
    pub fn standard_error(&self, unit: Unit, mean: f64, samples: u64) -> f64 {
        if samples < 2 {
            return 0.0;
        }
        let mean_square = self.raw() as f64 / samples as f64 / unit.roots / unit.roots;
        ((mean_square - mean * mean).max(0.0) / (samples - 1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Vec<f32> {
        (0..1000).map(|i| (i * i % 977) as f32 * 0.37e-3 + if i % 250 == 7 { 80.0 } else { 0.0 }).collect()
    }

    /// A sum and the sum of squares beside it.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Sums {
        sum: ExactSum,
        squares: ExactSquares,
    }

    impl Sums {
        fn merge(&mut self, other: &Self) {
            self.sum.merge(&other.sum);
            self.squares.merge(&other.squares);
        }

        fn mean(&self, unit: Unit, samples: u64) -> f64 {
            self.sum.mean(unit, samples)
        }

        fn standard_error(&self, unit: Unit, samples: u64) -> f64 {
            self.squares.standard_error(unit, self.mean(unit, samples), samples)
        }
    }

    fn sum_of<'a>(unit: Unit, samples: impl Iterator<Item = &'a f32>) -> Sums {
        let mut sums = Sums::default();
        samples.for_each(|sample| {
            sums.sum.add(unit, *sample);
            sums.squares.add(unit, *sample);
        });
        sums
    }

    #[test]
    fn numbers_of_units_are_the_nearest_ones() {
        let powers = (0..70).map(|k| 2.0_f64.powi(k - 3));
        let near = powers.flat_map(|x| [x, x * 1.25, x + 0.5, x + 1.5, x.next_down(), x.next_up(), 1.499 * x]);
        for number in near.chain([0.0, 0.5, 1.5, 2.5, 0.5_f64.next_down(), 0.5_f64.next_up()]) {
            assert_eq!(nearest(number), number.round_ties_even() as u128, "{number}");
        }
        assert_eq!(Unit::for_exponent(0).square_units(f32::MAX), u128::from(u64::MAX).pow(2));
    }

    #[test]
    fn order_and_grouping_do_not_change_a_bit() {
        let (unit, samples) = (Unit::for_largest(80.0), samples());
        let forward = sum_of(unit, samples.iter());
        assert_eq!(forward, sum_of(unit, samples.iter().rev()));
        let mut merged = sum_of(unit, samples[300..].iter());
        merged.merge(&sum_of(unit, samples[..300].iter()));
        assert_eq!(forward, merged);
    }

    #[test]
    fn mean_and_error_are_those_of_the_samples() {
        let (unit, samples) = (Unit::for_largest(80.0), samples());
        let (n, sum) = (samples.len() as u64, sum_of(Unit::for_largest(80.0), samples.iter()));
        let mean = samples.iter().map(|x| f64::from(*x)).sum::<f64>() / n as f64;
        let variance = samples.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
        assert!((sum.mean(unit, n) / mean - 1.0).abs() < 1e-12);
        assert!((sum.standard_error(unit, n) / (variance / n as f64).sqrt() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_unit_follows_the_scene_so_that_brightness_does_not_matter() {
        for scale in [1e-30_f32, 1e-6, 1.0, 1e6, 1e30] {
            let unit = Unit::for_largest(scale);
            let sum = sum_of(unit, [0.25 * scale, 1e-9 * scale].iter());
            let relative = sum.mean(unit, 2) / (f64::from(0.125 * scale) + f64::from(0.5e-9 * scale));
            assert!((relative - 1.0).abs() < 1e-7, "scale {scale:e}: {relative}");
        }
    }

    #[test]
    fn samples_far_brighter_than_the_light_count_in_full() {
        let unit = Unit::for_largest(1.0);
        for radiance in [3e4_f32, 1e5, 1e7] {
            let sum = sum_of(unit, [radiance, 0.5].iter());
            assert_eq!(sum.mean(unit, 2), (f64::from(radiance) + 0.5) / 2.0);
            let deviation = (f64::from(radiance) - 0.5) / 2.0;
            assert!((sum.standard_error(unit, 2) / deviation - 1.0).abs() < 1e-9, "{radiance}");
        }
    }

    #[test]
    fn errors_of_faint_pixels_are_known_beside_a_bright_light() {
        // 2^-40 of the power of two above the light, in which roots are rounded.
        let (light, root) = (100.0, 128.0 * 2.0_f64.powi(-40));
        for faintness in [1.0, 1e-3, 1e-6, 1e-8, 1e-10] {
            let samples: Vec<f32> =
                (0..1000).map(|i| (light * faintness * f64::from(i * i % 977) / 977.0) as f32).collect();
            let n = samples.len() as f64;
            let mean = samples.iter().map(|x| f64::from(*x)).sum::<f64>() / n;
            let variance = samples.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let unit = Unit::for_largest(light as f32);
            let error = sum_of(unit, samples.iter()).standard_error(unit, samples.len() as u64);
            // Half a unit off every root moves the mean square by no more than a unit times the mean, in the worst
            // case.
            let bound = 0.5 * root * mean / variance + 1e-9;
            let relative = error / (variance / n).sqrt() - 1.0;
            assert!(relative.abs() <= bound && bound < 0.05, "{faintness:e}: off by {relative:e}, may be by {bound:e}");
        }
    }

    #[test]
    fn overflow_saturates() {
        let unit = Unit::for_largest(1.0);
        let mut sum = sum_of(unit, [f32::MAX; 3].iter());
        let full = sum;
        for _ in 0..40 {
            let copy = sum;
            sum.merge(&copy);
        }
        sum.merge(&full);
        assert!(sum.mean(unit, 1) >= full.mean(unit, 1));
    }
}
