//! How large pictures are: as large as there is time for enough samples of every pixel, so that all that are compared
//! can be given the same time, sample by sample.

/// How large a picture is: how often the pixels of its scene are halved. There are few sizes, so that runs that differ
/// a little share references.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    halvings: u32,
}

/// Rendering time from which on pictures begin with all the pixels of their scenes `[s]`.
const FULL_SIZE_FROM: f64 = 3.0;
/// Least longer side of a picture in pixels.
const LEAST_SIDE: f64 = 32.0;
/// How often the slowest of those that are compared is to take the least that it takes at a time: its time is then off
/// by a thirtieth at most.
pub const STEPS: f64 = 16.0;
/// Share of these that is still enough.
const NEARLY: f64 = 0.8;

impl Size {
    /// The size to begin with if a picture gets `seconds`.
    pub fn for_seconds(seconds: f64) -> Self {
        let halvings = (FULL_SIZE_FROM / seconds.max(1e-9)).log2().max(0.0).round();
        Self { halvings: halvings as u32 }
    }

    /// Width and height of a picture of a scene of these.
    pub fn of(self, full: [u32; 2]) -> [u32; 2] {
        let longer = f64::from(full[0].max(full[1]));
        let scale = (-0.5 * f64::from(self.halvings)).exp2().max(LEAST_SIDE / longer).min(1.0);
        full.map(|length| (scale * f64::from(length)).round().max(1.0) as u32)
    }

    /// One of so many times fewer pixels, to the nearest.
    fn smaller(self, times: f64) -> Self {
        Self { halvings: self.halvings + times.log2().round().clamp(1.0, 64.0) as u32 }
    }
}

/// The longest step that fits often enough into `seconds` `[s]`.
pub fn longest_step(seconds: f64) -> f64 {
    seconds / (NEARLY * STEPS)
}

/// What `begin` makes of pictures of the largest size, `size` or a smaller one, at which the slowest of them takes its
/// steps often enough in `seconds`; `step` says how long one takes `[s]`, and `full` is how large the scene is. Nothing
/// is tried once `stops` says so.
///
/// # Errors
/// Those of `begin` and `step`.
pub fn fitting<T, E>(
    size: &mut Size,
    full: [u32; 2],
    seconds: f64,
    mut begin: impl FnMut(Size) -> Result<T, E>,
    mut step: impl FnMut(&mut T) -> Result<f64, E>,
    stops: impl Fn() -> bool,
) -> Result<T, E> {
    loop {
        let mut all = begin(*size)?;
        let step = step(&mut all)?;
        let smaller = size.smaller(step * STEPS / seconds);
        if step <= longest_step(seconds) || smaller.of(full) == size.of(full) || stops() {
            return Ok(all);
        }
        *size = smaller;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_shrink_with_their_time() {
        let sides = [100.0, 2.9, 1.5, 0.75, 1e-12].map(|seconds| Size::for_seconds(seconds).of([600, 270]));
        assert_eq!(sides, [[600, 270], [600, 270], [424, 191], [300, 135], [32, 14]]);
        assert_eq!(Size::for_seconds(1e-9).of([16, 8]), [16, 8], "never larger than the scene");
    }

    /// Renders that take `nanoseconds` for a sample of a pixel.
    fn fits(nanoseconds: f64, seconds: f64) -> ([u32; 2], u32) {
        let (mut size, full, mut tries) = (Size::default(), [600, 270], 0);
        let begin = |size: Size| {
            tries += 1;
            let [width, height] = size.of(full);
            Ok::<_, ()>(f64::from(width * height))
        };
        let step = |pixels: &mut f64| Ok(1e-9 * nanoseconds * *pixels);
        let pixels = fitting(&mut size, full, seconds, begin, step, || false).expect("no errors");
        let [width, height] = size.of(full);
        assert_eq!(f64::from(width * height), pixels);
        ([width, height], tries)
    }

    #[test]
    fn pictures_shrink_until_enough_samples_fit() {
        assert_eq!(fits(1000.0, 5.0), ([600, 270], 1));
        for (nanoseconds, seconds) in [(5000.0, 5.0), (5e4, 5.0), (5000.0, 0.1)] {
            let ([width, height], tries) = fits(nanoseconds, seconds);
            let steps = seconds / (1e-9 * nanoseconds * f64::from(width * height));
            assert!(
                (NEARLY * STEPS..2.6 * STEPS).contains(&steps) && tries <= 3,
                "{steps} steps of {width} x {height}"
            );
        }
        assert_eq!(fits(1e9, 1.0).0, [32, 14], "some pixels are left");
    }
}
