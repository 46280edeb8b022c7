//! Lights at infinity for eight rows.
//!
//! ```text
//! cap:    s = u S,    w = (1 - 2 s) axis + 2 sqrt(s - s^2) (cos(2 pi v) tangent + sin(2 pi v) bitangent)
//! image:  pixel (column, row) chosen;    s = s_row + u (s_{row+1} - s_row),    a = (column + v) / width - 1/2 - turn
//!         w = 2 sqrt(s - s^2) (sin(2 pi a), 0, -cos(2 pi a)) +- (1 - 2 s) y
//! ```
//!
//! 1. With `s = sin^2 (theta / 2)` neither the cosine of a small sun nor that of a row next to a pole cancels.
//! 2. Rows of eight different lights gather what they need; pixels are looked up one by one.

use core::f32::consts::PI;

use wide::{f32x8, u32x8};

use crate::columns::Spectrum;
use crate::lanes::{self, LANES};
use crate::media::spectral::CHANNELS;
use crate::tables::lights::{Band, Distant, Lights, Panorama};
use crate::transcendental::sin_cos_turn;
use crate::vec3::Vec3x8;

/// Directions of which lights at infinity are seen.
pub struct Seen {
    /// p_dir P_l: the density of connections towards them [1/sr].
    pub density: f32x8,
    /// Radiance over that of the emitter, per channel.
    pub colour: [f32x8; CHANNELS],
}

/// What is seen of `emitters` in unit directions; of those that are not at infinity, nothing that counts.
#[inline(always)]
pub fn see(lights: &Lights, emitters: &[u32; LANES], direction: Vec3x8) -> Seen {
    let light = emitters.map(|emitter| lights.distant_of(emitter));
    let gather = |value: &dyn Fn(&Distant) -> f32| f32x8::new(light.map(|light| light.map_or(0.0, value)));
    let mut density = gather(&|light| light.share * (0.25 / PI) / light.cap);
    let mut colour = [f32x8::ONE; CHANNELS];
    if lights.has_panorama() {
        let places = Places::of(direction);
        for (i, light) in light.iter().enumerate() {
            let Some((light, panorama)) = light.and_then(|light| Some((light, light.panorama.as_ref()?))) else {
                continue;
            };
            let [column, row] = places.pixel(panorama, i);
            let texel = panorama.texel(column, row);
            density.as_mut_array()[i] = light.share * panorama_density(panorama, texel);
            (0..CHANNELS).for_each(|c| colour[c].as_mut_array()[i] = texel[c]);
        }
    }
    Seen { density, colour }
}

impl Seen {
    /// Multiplies batch `b` of `factor` by the colours.
    #[inline(always)]
    pub fn tint(&self, b: usize, factor: &mut Spectrum<'_>) {
        for (factor, colour) in factor.channels_mut().iter_mut().zip(self.colour) {
            factor.set_batch(b, factor.batch(b) * colour);
        }
    }
}

/// Density of directions in a pixel of this radiance over the largest [1/sr].
fn panorama_density(panorama: &Panorama, [r, g, b]: [f32; 3]) -> f32 {
    let flux = panorama.flux() as f32;
    if flux > 0.0 { (r + g + b) * (panorama.largest() / flux / 3.0) } else { 0.0 }
}

/// Where eight directions are on an image that is not turned.
struct Places {
    /// From the left edge, [0, 1].
    across: [f32; LANES],
    /// From the upper edge, [0, 1].
    down: [f32; LANES],
}

impl Places {
    #[inline(always)]
    fn of(direction: Vec3x8) -> Self {
        let Vec3x8 { x, y, z } = direction;
        let radius = x.mul_add(x, z * z).sqrt();
        let across = x.atan2(-z) * f32x8::splat(0.5 / PI) + f32x8::splat(0.5);
        Self { across: across.to_array(), down: (radius.atan2(y) * f32x8::splat(1.0 / PI)).to_array() }
    }

    /// Column and row of the pixel that row `i` sees.
    #[inline(always)]
    fn pixel(&self, panorama: &Panorama, i: usize) -> [u32; 2] {
        let [width, height] = panorama.size();
        let across = self.across[i] + panorama.turn();
        let column = (across - across.floor()) * width as f32;
        [(column as u32).min(width - 1), ((self.down[i] * height as f32) as u32).min(height - 1)]
    }
}

/// Emitters at infinity and unit directions towards them, for uniform numbers that decide on light and direction;
/// `words` are those for the pixels of an image.
#[inline(always)]
pub fn draw(lights: &Lights, [choice, u, v]: [f32x8; 3], words: impl FnOnce() -> [u32x8; 4]) -> (u32x8, Vec3x8) {
    let chosen = choose(lights, choice);
    let light = chosen.to_array().map(|index| &lights.distant()[index as usize]);
    let gather = |value: &dyn Fn(&Distant) -> f32| f32x8::new(light.map(value));
    let gather3 = |value: &dyn Fn(&Distant) -> [f32; 3]| {
        let component = |axis: usize| gather(&|light| value(light)[axis]);
        Vec3x8::new(component(0), component(1), component(2))
    };
    let (cosine, sine) = polar(u * gather(&|light| light.cap));
    let (sin, cos) = sin_cos_turn(v);
    let across = gather3(&|light| light.tangent).mul_add(sine * cos, gather3(&|light| light.bitangent) * (sine * sin));
    let mut direction = gather3(&|light| light.axis).mul_add(cosine, across);
    if lights.has_panorama() {
        let of_image = lanes::mask(lanes_where(|i| light[i].panorama.is_some()));
        direction = Vec3x8::select(of_image, in_pixels(&light, u, v, words()), direction);
    }
    (chosen + u32x8::splat(lights.first_distant()), direction)
}

/// Bits of the lanes of which something is true.
fn lanes_where(is: impl Fn(usize) -> bool) -> u32 {
    (0..LANES).fold(0, |bits, i| bits | u32::from(is(i)) << i)
}

/// The first light l with u < P_0 + .. + P_l.
#[inline(always)]
fn choose(lights: &Lights, u: f32x8) -> u32x8 {
    let (mut below, mut chosen) = (0.0, u32x8::splat(0));
    for light in &lights.distant()[..lights.distant().len() - 1] {
        below += light.share;
        let beyond: u32x8 = bytemuck::cast(u.simd_ge(f32x8::splat(below)));
        chosen -= beyond; // a mask of all ones is -1
    }
    chosen
}

/// Cosine and sine of a polar angle theta with `sin^2 (theta / 2) = s`.
#[inline(always)]
fn polar(s: f32x8) -> (f32x8, f32x8) {
    let half_sine = (s * (f32x8::ONE - s)).sqrt();
    (f32x8::ONE - (s + s), half_sine + half_sine)
}

/// Directions in pixels that `words` choose; senseless where there is no image.
#[inline(always)]
fn in_pixels(light: &[&Distant; LANES], u: f32x8, v: f32x8, words: [u32x8; 4]) -> Vec3x8 {
    let words = words.map(|words| words.to_array());
    let [mut from, mut to, mut side, mut column, mut across, mut turn] = [[0.0; LANES]; 6];
    for i in 0..LANES {
        let Some(panorama) = &light[i].panorama else { continue };
        let [x, y] = panorama.choose(words.map(|words| words[i]));
        Band { side: side[i], from_pole: [from[i], to[i]] } = panorama.band(y);
        (column[i], across[i], turn[i]) = (x as f32, 1.0 / panorama.size()[0] as f32, panorama.turn());
    }
    let [from, to, side, column, across, turn] = [from, to, side, column, across, turn].map(f32x8::new);
    let (cosine, sine) = polar((to - from).mul_add(u, from));
    let azimuth = (column + v).mul_sub(across, turn + f32x8::splat(0.5));
    let (sin, cos) = sin_cos_turn(azimuth - azimuth.floor());
    Vec3x8::new(sine * sin, side * cosine, -(sine * cos))
}

impl Distant {
    /// Whether a ray in the unit `direction` goes there.
    #[inline(always)]
    pub fn is_met(&self, direction: [f32; 3]) -> bool {
        // The square of the chord, which does not cancel.
        let chord = |axis: usize| (direction[axis] - self.axis[axis]) * (direction[axis] - self.axis[axis]);
        self.cap >= 1.0 || chord(0) + chord(1) + chord(2) <= 4.0 * self.cap
    }
}
