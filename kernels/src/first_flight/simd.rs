//! ```text
//! u < share: t = sqrt(delta^2 + D^2) sin(v span) / sin((1 - v) span)          u, v: last words of the CAMERA block
//! else       t = free / c
//! weight = 1 / ((1 - share) c e^{(1 - c) mu_t t} + share sum_l share_l q_l(t) e^{mu_t t} / mu_t)
//! ```
//!
//! Where extinction is coloured, the density itself is filled, for each channel.
//!
//! 1. Requests are mostly whole batches; the others are blended in.
//! 2. The form with two sines does not cancel where the light is behind the ray or v is small.
//! 3. Lights are visited twice, to draw and to weigh: what is known of one is cheaper computed again than kept.

use wide::f32x8;

use super::{Aim, Columns};
use crate::media::{MediumLanes, MediumX8};
use crate::random::{self, uniform_f32};
use crate::tables::lights::Light;
use crate::transcendental::exp;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_homogeneous};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    with_homogeneous!(columns.medium, |medium| draw(step, columns, medium));
}

#[inline(always)]
fn draw<M: MediumLanes>(step: Step, columns: Columns<'_, '_>, medium: M) {
    let Columns { lights, aim, requested, paths, vertex, ray, flight, weight, density: densities, .. } = columns;
    let Aim { share, thinned } = aim;
    let share = f32x8::splat(share);
    for (b, requested) in requested.each_batch() {
        let block = wide::u32x8::splat(random::block(0, random::CAMERA));
        let (pixel, sample) = (paths.pixel.batch(b), paths.sample.batch(b));
        let [.., u, v] = random::words(pixel, sample, block, step.seed).map(uniform_f32);
        let (origin, direction) = (vertex.position.batch(b), ray.direction.batch(b));

        let mut t = flight.batch(b) * f32x8::splat(1.0 / thinned);
        let (mut open, mut below) = (u.simd_lt(share), f32x8::ZERO);
        for (index, light) in lights.lights().iter().enumerate() {
            below += share * f32x8::splat(light.intensity);
            let last = index + 1 == lights.lights().len();
            let drawn = if last { open } else { open & u.simd_lt(below) };
            t = drawn.select(Sight::new(light, origin, direction).draw(v), t);
            open &= !drawn;
        }
        let mut density = f32x8::ZERO;
        for light in lights.lights() {
            density += f32x8::splat(light.intensity) * Sight::new(light, origin, direction).density(t);
        }
        let requested = lanes::mask(requested);
        flight.set_batch(b, requested.select(t, flight.batch(b)));
        let end = direction.mul_add(t, origin);
        let in_channel = |c: usize| {
            let medium = medium.channel(c);
            (medium.extinction(end), medium.optical_depth(origin, end, t))
        };
        let free = (f32x8::ONE - share) * f32x8::splat(thinned);
        if !M::COLOURED {
            let (extinction, depth) = in_channel(0);
            let not_aimed = free * exp(depth * f32x8::splat(1.0 - thinned));
            let quotient = f32x8::ONE / (share * density).mul_add(exp(depth) / extinction, not_aimed);
            weight.set_batch(b, requested.select(quotient, weight.batch(b)));
            continue;
        }
        for (densities, c) in densities.channels_mut().iter_mut().zip(0..) {
            let (extinction, depth) = in_channel(c);
            let not_aimed = free * extinction * exp(-depth * f32x8::splat(thinned));
            let mixed = share.mul_add(density, not_aimed);
            densities.set_batch(b, requested.select(mixed, densities.batch(b)));
        }
    }
}

/// A light as eight rays pass it.
pub(crate) struct Sight {
    /// Distance along the ray to the point closest to the light's centre `[m]`.
    delta: f32x8,
    /// Distance of that point, not less than the light's radius `[m]`.
    closest: f32x8,
    /// Angle under which the light sees the ray.
    span: f32x8,
}

impl Sight {
    #[inline(always)]
    pub(crate) fn new(light: &Light, origin: Vec3x8, direction: Vec3x8) -> Self {
        let to_center = Vec3x8::splat(light.center) - origin;
        let delta = to_center.dot(direction);
        let across = direction.mul_neg_add(delta, to_center).length_squared();
        let closest = (across + f32x8::splat(light.radius * light.radius)).sqrt();
        Self { delta, closest, span: closest.atan2(-delta) }
    }

    /// The flight at the share `v` of all angles.
    #[inline(always)]
    fn draw(&self, v: f32x8) -> f32x8 {
        let distance = self.delta.mul_add(self.delta, self.closest * self.closest).sqrt();
        distance * (v * self.span).sin() / ((f32x8::ONE - v) * self.span).sin()
    }

    /// Density of the flight `t` [1/m].
    #[inline(always)]
    fn density(&self, t: f32x8) -> f32x8 {
        let along = t - self.delta;
        self.closest / (self.span * along.mul_add(along, self.closest * self.closest))
    }

    /// Probability of flights longer than `t`.
    #[inline(always)]
    pub(crate) fn probability(&self, t: f32x8) -> f32x8 {
        self.closest.atan2(t - self.delta) / self.span
    }
}
