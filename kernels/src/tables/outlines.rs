//! Pixels through which the outlines of lamps pass.
//!
//! A lamp is mostly far brighter than what is around it, and a sample of a pixel that it half covers sees all of it or
//! nothing. What a few such pixels add to the variance of an image can be most of it. Lamps in these pixels are looked at
//! by many rays per sample: see [`outline`](crate::outline).

use rayon::prelude::*;

use super::camera::Camera;
use super::lights::Lights;
use crate::extend::reference::meet_body;
use crate::generate::reference::film_ray;

/// Most rays that are cast to find outlines: images of more corners times lamps do without.
const MOST_RAYS: u64 = 1 << 26;

/// Largest share of pixels, as a divisor: where outlines are nearly everywhere, many rays per sample cost more than they
/// are worth.
const SHARE_DIVISOR: usize = 8;

/// Rows of pixels that one thread looks at.
const BAND: u32 = 32;

/// A set of pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outlines {
    /// A bit per pixel, row by row.
    words: Vec<u64>,
}

impl Outlines {
    /// The pixels, of `size` altogether, whose corners do not all see the same of some disk or sphere of `lights`, whatever
    /// is in front of it; none where there are no such pixels, or too many. Lamps that fall between the corners of a pixel
    /// are missed, which changes no mean.
    pub fn of(camera: &Camera, [width, height]: [u32; 2], lights: &Lights) -> Option<Self> {
        let corners = (u64::from(width) + 1) * (u64::from(height) + 1);
        if corners.saturating_mul(lights.bodies().len() as u64) > MOST_RAYS || lights.bodies().is_empty() {
            return None;
        }
        // Per corner of a row, the lamps that are seen there as one number: their indices times odd constants.
        let seen = |y: u32| -> Vec<u64> {
            let corner = |x: u32| {
                let (origin, direction) = film_ray(camera, f64::from(x), f64::from(y));
                let met = (1..).zip(lights.bodies()).filter(|(_, body)| meet_body(body, origin, direction).is_some());
                met.fold(0_u64, |seen, (number, _)| seen.wrapping_add(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(number)))
            };
            (0..=width).map(corner).collect()
        };
        let in_band = |band: u32| {
            let (first, mut pixels) = (band * BAND, Vec::new());
            let mut above = seen(first);
            for y in first..height.min(first + BAND) {
                let below = seen(y + 1);
                let differ = |x: &usize| [above[x + 1], below[*x], below[x + 1]].iter().any(|seen| *seen != above[*x]);
                pixels.extend((0..width as usize).filter(differ).map(|x| y as usize * width as usize + x));
                above = below;
            }
            pixels
        };
        let pixels: Vec<usize> = (0..height.div_ceil(BAND)).into_par_iter().flat_map_iter(in_band).collect();
        let count = width as usize * height as usize;
        if pixels.is_empty() || pixels.len() > count / SHARE_DIVISOR {
            return None;
        }
        let mut words = vec![0; count.div_ceil(64)];
        pixels.into_iter().for_each(|pixel| words[pixel / 64] |= 1 << (pixel % 64));
        Some(Self { words })
    }

    /// Whether an outline passes through a pixel.
    #[inline(always)]
    pub fn contains(&self, pixel: u32) -> bool {
        self.words[pixel as usize / 64] >> (pixel % 64) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tables::lights::{Emitter, Selection};

    #[test]
    fn outlines_are_rings() {
        let size = [64, 48];
        let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.9, 0.0, size);
        let lamp = Emitter::sphere(DVec3::new(0.1, 0.0, 4.0), 0.7, [1.0; 3]);
        let outlines = Outlines::of(&camera, size, &Lights::new(vec![lamp], Selection::Uniform)).expect("a ring");
        let ring: Vec<_> = (0..64 * 48).filter(|pixel| outlines.contains(*pixel)).collect();
        // A circle of radius r pixels crosses about 8 r of them; 0.7 m at 4 m are 8.8 pixels.
        assert!((60..85).contains(&ring.len()), "{}", ring.len());
        let centre = f64::from(48 / 2) / (0.45_f64).tan() * 0.1 / 4.0;
        for pixel in ring {
            let at = [f64::from(pixel % 64) + 0.5 - 32.0 + centre, f64::from(pixel / 64) + 0.5 - 24.0];
            let radius = at[0].hypot(at[1]);
            assert!((7.5..10.5).contains(&radius), "{at:?}: {radius}");
        }
    }

    #[test]
    fn images_without_lamps_have_none() {
        let size = [16, 16];
        let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.9, 0.0, size);
        let behind = Emitter::sphere(DVec3::new(0.0, 0.0, -4.0), 0.7, [1.0; 3]);
        for lamps in [vec![], vec![behind]] {
            assert_eq!(Outlines::of(&camera, size, &Lights::new(lamps, Selection::Uniform)), None);
        }
    }
}
