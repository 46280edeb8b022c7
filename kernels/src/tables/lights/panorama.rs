//! Images of the sky: radiance by direction.
//!
//! A lat-long image of w x h pixels has a pixel for every rectangle of azimuth and polar angle: row i reaches from
//! `theta_i = pi i / h`, counted from +y, to `theta_{i+1}`. The middle of its width is towards -z, unless it is turned,
//! and its right half is towards +x: it shows the sky as it is seen from inside. All of a pixel has the same radiance.
//!
//! Directions are drawn by pixel, in proportion to radiance (mean over the channels) times solid angle, first a row,
//! then a column of it, and then uniformly in the pixel, so that their density is
//!
//! ```text
//! p_dir(w) = L(w) / integral of L over all directions      [1/sr]
//! ```

use core::f64::consts::{PI, TAU};

use super::alias::AliasTable;

/// An image of the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    width: u32,
    height: u32,
    /// Radiance per channel over the largest one, [0, 1], row by row from the top.
    texels: Vec<[f32; 3]>,
    /// The largest radiance of any pixel in any channel [W/(m^2 sr)].
    largest: f32,
    /// Turn about +y, [0, 1).
    turn: f32,
    /// Integral of the radiance over all directions, mean over the channels [W/m^2].
    flux: f64,
    /// Where rows begin and end.
    bands: Vec<Band>,
    /// The choice of a row.
    rows: AliasTable,
    /// The choice of a pixel in each row.
    columns: Vec<AliasTable>,
}

/// A row of an image, as a part of the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// 1 in the upper half of the sphere, -1 in the lower one.
    pub side: f32,
    /// Where it begins and ends: `sin^2 (theta / 2)` with theta counted from the pole of its side. Bands next to a pole
    /// keep their digits.
    pub from_pole: [f32; 2],
}

impl Band {
    /// Row `i` of `count`.
    fn new(i: u32, count: u32) -> Self {
        let upper = 2 * i < count;
        let from_pole = |row: u32| {
            let rows = if upper { row } else { count - row };
            (0.5 * PI * f64::from(rows) / f64::from(count)).sin().powi(2) as f32
        };
        Self { side: if upper { 1.0 } else { -1.0 }, from_pole: [from_pole(i), from_pole(i + 1)] }
    }
}

/// Solid angle of a pixel of row `i` of an image of `size` [sr]:
/// `2 pi / w (cos theta_i - cos theta_{i+1}) = 4 pi / w sin (pi (2 i + 1) / (2 h)) sin (pi / (2 h))`.
fn solid_angle(i: u32, [width, height]: [u32; 2]) -> f64 {
    let half = 0.5 * PI / f64::from(height);
    2.0 * TAU / f64::from(width) * (half * f64::from(2 * i + 1)).sin() * half.sin()
}

fn mean(channels: [f32; 3]) -> f64 {
    channels.iter().map(|channel| f64::from(*channel)).sum::<f64>() / 3.0
}

/// A choice in proportion to `weights`; any, where all are 0.
fn choice(weights: &[f64]) -> AliasTable {
    if weights.iter().any(|weight| *weight > 0.0) {
        AliasTable::new(weights)
    } else {
        AliasTable::new(&vec![1.0; weights.len()])
    }
}

impl Panorama {
    /// Most pixels along either side.
    pub const LARGEST_SIDE: u32 = 1 << 16;

    /// An image of `size`, width and height, whose `pixels`, row by row from the top, have finite radiances >= 0
    /// [W/(m^2 sr)], turned by `angle` `[rad]` about +y: counterclockwise, seen from above.
    ///
    /// # Panics
    /// If there are no pixels, or not as many as `size` says.
    pub fn new(size: [u32; 2], mut pixels: Vec<[f32; 3]>, angle: f64) -> Self {
        let [width, height] = size;
        assert!(width > 0 && height > 0 && pixels.len() as u64 == u64::from(width) * u64::from(height), "{size:?}");
        let largest = pixels.iter().flatten().fold(0.0, |most: f32, channel| most.max(*channel));
        if largest > 0.0 {
            pixels.iter_mut().flatten().for_each(|channel| *channel /= largest);
        }
        let texels = pixels;
        let rows = || texels.chunks_exact(width as usize);
        let weights: Vec<Vec<f64>> = rows().map(|row| row.iter().map(|texel| mean(*texel)).collect()).collect();
        let of_row = |(i, row): (u32, &Vec<f64>)| row.iter().sum::<f64>() * solid_angle(i, size);
        let totals: Vec<f64> = (0..).zip(&weights).map(of_row).collect();
        Self {
            width,
            height,
            largest,
            turn: (angle / TAU).rem_euclid(1.0) as f32 % 1.0,
            flux: totals.iter().sum::<f64>() * f64::from(largest),
            bands: (0..height).map(|i| Band::new(i, height)).collect(),
            rows: choice(&totals),
            columns: weights.iter().map(|row| choice(row)).collect(),
            texels,
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The largest radiance of any pixel in any channel [W/(m^2 sr)].
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Integral of the radiance over all directions, mean over the channels [W/m^2].
    pub fn flux(&self) -> f64 {
        self.flux
    }

    /// Turn about +y, [0, 1).
    pub fn turn(&self) -> f32 {
        self.turn
    }

    /// Radiance of a pixel over the largest one, per channel.
    #[inline(always)]
    pub fn texel(&self, column: u32, row: u32) -> [f32; 3] {
        self.texels[row as usize * self.width as usize + column as usize]
    }

    /// Row `i` as a part of the sphere.
    #[inline(always)]
    pub fn band(&self, row: u32) -> Band {
        self.bands[row as usize]
    }

    /// A pixel, column and row, for four random words.
    #[inline(always)]
    pub fn choose(&self, [row, row_share, column, column_share]: [u32; 4]) -> [u32; 2] {
        let row = self.rows.choose_with(row, row_share);
        [self.columns[row as usize].choose_with(column, column_share), row]
    }

    /// Whether all pixels are grey.
    pub fn is_grey(&self) -> bool {
        self.texels.iter().all(|texel| *texel == [texel[0]; 3])
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.texels.len() * (size_of::<[f32; 3]>() + AliasTable::BYTES)
    }

    /// Shows what directions see of it to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(&[self.width, self.height]));
        digest(bytemuck::cast_slice(&[self.largest, self.turn]));
        digest(bytemuck::cast_slice(&self.texels));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: [u32; 2]) -> Panorama {
        let pixel = |i: u32| [i % 7, i % 3, i % 11].map(|x| x as f32);
        Panorama::new(size, (0..size[0] * size[1]).map(pixel).collect(), 0.0)
    }

    #[test]
    fn solid_angles_add_up_to_the_sphere() {
        for size in [[1, 1], [8, 4], [5, 7], [64, 33]] {
            let sum: f64 = (0..size[1]).map(|i| solid_angle(i, size) * f64::from(size[0])).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-12, "{size:?}: {sum}");
            let bands = image(size).bands;
            let share = |band: &Band| f64::from((band.from_pole[1] - band.from_pole[0]).abs());
            for (i, band) in (0..).zip(&bands) {
                let expected = solid_angle(i, size) * f64::from(size[0]) / (4.0 * PI);
                assert!((share(band) - expected).abs() < 1e-6, "{size:?}, row {i}");
            }
        }
    }

    #[test]
    fn pixels_are_chosen_in_proportion_to_radiance_times_solid_angle() {
        let (size, image) = ([5, 4], image([5, 4]));
        let mut counts = vec![0.0; 20];
        let steps = 1 << 10;
        let word = |i: u32| (i << 22) + 12_345;
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            // Shares go with indices through other bits of the same low-discrepancy numbers.
            let share = |k: u32| k.wrapping_mul(2_654_435_769);
            let [column, row] = image.choose([word(i), share(i), word(j), share(j)]);
            counts[(row * 5 + column) as usize] += 1.0 / f64::from(steps * steps);
        }
        for (at, count) in (0..20).zip(counts) {
            let texel = image.texel(at % 5, at / 5);
            let expected = mean(texel) * f64::from(image.largest) * solid_angle(at / 5, size) / image.flux();
            assert!((count - expected).abs() < 5e-3, "pixel {at}: {count}, not {expected}");
            assert_eq!(count == 0.0, expected == 0.0);
        }
    }

    #[test]
    fn a_black_image_can_be_asked_for_everything() {
        let image = Panorama::new([3, 2], vec![[0.0; 3]; 6], 1.0);
        assert_eq!((image.largest(), image.flux(), image.is_grey()), (0.0, 0.0, true));
        assert!(image.choose([u32::MAX; 4])[0] < 3);
    }
}
