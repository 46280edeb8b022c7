//! The floor: a walk through fog over plain columns, with nothing that makes a renderer: no refill, no film, no queues,
//! no candidates. Rates of frames are best read as multiples of its time.

use fogbow_kernels::phase::{HenyeyGreenstein, HenyeyGreensteinX8, PhaseX8};
use fogbow_kernels::random::{uniform_f32, words};
use fogbow_kernels::transcendental::neg_ln;
use fogbow_kernels::vec3::Vec3x8;
use wide::{f32x8, u32x8};

/// Paths in lanes.
pub struct WalkLimits {
    position: Vec<Vec3x8>,
    direction: Vec<Vec3x8>,
    round: u32,
    /// Disks that were crossed: keeps the test alive.
    pub hits: u32,
}

impl WalkLimits {
    /// Room for `paths` paths.
    pub fn new(paths: usize) -> Self {
        Self {
            position: vec![Vec3x8::ZERO; paths / 8],
            direction: vec![Vec3x8::splat([0.0, 0.6, 0.8]); paths / 8],
            round: 0,
            hits: 0,
        }
    }

    /// Walks all paths through `segments` segments of fog-facing.
    pub fn run(&mut self, segments: u32) {
        self.round += 1;
        let phase = HenyeyGreensteinX8::new(HenyeyGreenstein { g: 0.9 });
        self.position.fill(Vec3x8::ZERO);
        self.direction.fill(Vec3x8::splat([0.0, 0.6, 0.8]));
        for segment in 0..segments {
            for (b, (position, direction)) in self.position.iter_mut().zip(&mut self.direction).enumerate() {
                let lane = u32x8::splat(8 * b as u32) + u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
                let words = words(lane, u32x8::splat(self.round), u32x8::splat(segment << 16), 1);
                let flight = neg_ln(f32x8::ONE - uniform_f32(words[0])) * f32x8::splat(1.0 / 1.7);
                let from_center = *position - Vec3x8::splat([0.0, 0.0, 5.0]);
                let distance = -from_center.z / direction.z;
                let across = direction.mul_add(distance, from_center).length_squared();
                let hit = distance.simd_gt(f32x8::ZERO) & distance.simd_lt(flight) & across.simd_le(f32x8::splat(0.25));
                self.hits += hit.to_bitmask().count_ones();
                *position = direction.mul_add(flight, *position);
                *direction = phase.sample(uniform_f32(words[1])).apply(*direction, uniform_f32(words[2]));
            }
        }
    }
}
