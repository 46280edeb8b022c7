//! Eight rays on their way: what is known of each, and how they come into their lanes.

use wide::{f32x8, i32x8, u32x8};

use super::RaysX8;
use super::quest::Quest;
use crate::lanes::{self, LANES};
use crate::media::field::Field;
use crate::media::field::axis::within;
use crate::media::field::blocks::EDGE;
use crate::random::{Stream, uniform_f32};
use crate::vec3::Vec3x8;

/// A ray that is through.
pub(super) struct Ended<const N: usize> {
    pub t: f32,
    pub collided: bool,
    pub results: [f32; N],
    pub known: f32,
}

/// Eight rays on their way.
#[derive(Clone, Copy)]
pub(super) struct Lanes<const N: usize> {
    /// Where the ray is at t = 0, and where it goes, in cells.
    pub origin: Vec3x8,
    pub direction: Vec3x8,
    /// How far that is from where it began: t counts from where it comes to the cells.
    pub start: f32x8,
    pub t: f32x8,
    /// Where it leaves the cells or ends, as t.
    pub exit: f32x8,
    /// Where it enters the next block along each axis.
    pub next: Vec3x8,
    /// From one block to the next along each axis.
    pub delta: Vec3x8,
    /// The block that the ray is in.
    pub block: i32x8,
    /// From there to the next one along each axis.
    pub stride: [i32x8; 3],
    /// Length of a unit of t `[m]`, times the hue of a flight.
    pub scale: f32x8,
    /// Mean free paths left until the next candidate.
    pub budget: f32x8,
    pub results: [f32x8; N],
    pub hues: [f32x8; N],
    /// Optical depth of what is known.
    pub known: f32x8,
    pub stream: [u32x8; 4],
    pub candidates: u32x8,
    pub row: u32x8,
    /// Lanes with a ray.
    pub live: u32,
    /// Those of them whose rays have left the cells, or come to their ends.
    pub through: u32,
}

impl<const N: usize> Lanes<N> {
    pub fn empty() -> Self {
        let (zero, none) = (f32x8::ZERO, u32x8::splat(0));
        Self {
            origin: Vec3x8::ZERO,
            direction: Vec3x8::ZERO,
            start: zero,
            t: zero,
            exit: zero,
            next: Vec3x8::ZERO,
            delta: Vec3x8::ZERO,
            block: i32x8::splat(0),
            stride: [i32x8::splat(0); 3],
            scale: zero,
            budget: zero,
            results: [zero; N],
            hues: [zero; N],
            known: zero,
            stream: [none; 4],
            candidates: none,
            row: none,
            live: 0,
            through: 0,
        }
    }

    /// What became of a ray, if those of `through` have not collided.
    pub fn ended(&self, lane: usize, through: u32) -> Ended<N> {
        let of = |v: f32x8| v.to_array()[lane];
        let collided = through >> lane & 1 == 0;
        Ended { t: of(self.start + self.t), collided, results: self.results.map(of), known: of(self.known) }
    }

    /// Takes the rays that wait as long as there are vacant lanes.
    #[inline(always)]
    pub fn take(&mut self, waiting: &mut Self) {
        if self.live == 0 {
            *self = *waiting;
            waiting.live = 0;
            return;
        }
        for (to, from) in lanes::each(!self.live & lanes::ALL).zip(lanes::each(waiting.live)) {
            self.put(to, waiting, from);
            self.live |= 1 << to;
            waiting.live &= !(1 << from);
        }
    }

    /// Hands rays that have ended to `end`.
    #[inline(always)]
    pub fn end(&self, ended: u32, through: u32, end: &mut impl FnMut(usize, Ended<N>)) {
        let rows = self.row.to_array();
        for lane in lanes::each(ended) {
            end(rows[lane] as usize, self.ended(lane, through));
        }
    }

    /// Takes a batch to where it enters the cells, with so many mean free paths to its first candidates.
    ///
    /// From there on t counts: seen from far away, the way from one block to the next is less than a digit of how far
    /// away they are, and steps that are lost there would lead out of the columns.
    #[inline(always)]
    pub fn enter<Q: Quest<N>>(&mut self, field: &Field, batch: &RaysX8<N>, budget: f32x8, longest: f32) {
        let RaysX8 { first, stream, hues, .. } = *batch;
        let live = lanes::mask(batch.live);
        let [origin, direction] = [batch.origin, batch.direction].map(|v| Vec3x8::select(live, v, Vec3x8::ZERO));
        let mut scale = direction.length_squared().sqrt();
        if Q::FLIES {
            scale *= hues[0];
        }
        let (origin, direction) = (field.in_cells(origin), field.to_cells.directions(direction));
        let part = |origin: Vec3x8, longest: f32x8| {
            within(origin, direction, [0.0; 3], field.cells.dims().map(|dim| dim as f32), longest)
        };
        let longest = f32x8::splat(longest);
        let [enter, exit] = part(origin, longest);
        let start = enter.simd_lt(exit).select(enter, f32x8::ZERO);
        let origin = direction.mul_add(start, origin);
        let [enter, exit] = part(origin, longest - start);
        let at = direction.mul_add(enter, origin);
        let (layout, edge) = (&field.blocks.layout, f32x8::splat(EDGE as f32));
        let mut next = [f32x8::ZERO; 3];
        let mut delta = [f32x8::ZERO; 3];
        let mut index = i32x8::splat(0);
        for axis in 0..3 {
            let pick = |v: Vec3x8| [v.x, v.y, v.z][axis];
            let (from, step) = (pick(origin), pick(direction));
            let last = f32x8::splat((layout.dims[axis] - 1) as f32);
            let block = (pick(at) / edge).fast_max(f32x8::ZERO).fast_min(last).fast_trunc_int();
            let forward = step.simd_gt(f32x8::ZERO);
            let border = (f32x8::from_i32x8(block) + forward.select(f32x8::ONE, f32x8::ZERO)) * edge;
            let inverse = f32x8::ONE / step;
            let moves = !step.simd_eq(f32x8::ZERO);
            next[axis] = moves.select((border - from) * inverse, f32x8::splat(f32::INFINITY));
            delta[axis] = moves.select(edge * inverse.abs(), f32x8::splat(f32::INFINITY));
            let stride = i32x8::splat(layout.strides()[axis]);
            index += (block + i32x8::splat(1)) * stride;
            self.stride[axis] = choose(forward, stride, -stride);
        }
        let vector = |[x, y, z]: [f32x8; 3]| Vec3x8::new(x, y, z);
        (self.origin, self.direction) = (origin, direction);
        (self.next, self.delta, self.block) = (vector(next), vector(delta), index);
        (self.start, self.t, self.exit, self.scale) = (start, enter, exit, scale);
        (self.results, self.hues, self.known) = ([f32x8::ONE; N], hues, f32x8::ZERO);
        self.stream = stream;
        self.row = u32x8::splat(first as u32) + u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
        (self.budget, self.candidates) = (budget, u32x8::splat(1));
        self.through = 0;
    }

    /// Puts the ray in lane `from` of `other` in lane `to`.
    #[inline(always)]
    fn put(&mut self, to: usize, other: &Self, from: usize) {
        let vectors = [
            (&mut self.origin, &other.origin),
            (&mut self.direction, &other.direction),
            (&mut self.next, &other.next),
            (&mut self.delta, &other.delta),
        ];
        for (vector, source) in vectors {
            put(&mut vector.x, to, &source.x, from);
            put(&mut vector.y, to, &source.y, from);
            put(&mut vector.z, to, &source.z, from);
        }
        put(&mut self.start, to, &other.start, from);
        put(&mut self.t, to, &other.t, from);
        put(&mut self.exit, to, &other.exit, from);
        put(&mut self.scale, to, &other.scale, from);
        put(&mut self.budget, to, &other.budget, from);
        put(&mut self.known, to, &other.known, from);
        put(&mut self.block, to, &other.block, from);
        put(&mut self.candidates, to, &other.candidates, from);
        put(&mut self.row, to, &other.row, from);
        for hue in 0..N {
            put(&mut self.results[hue], to, &other.results[hue], from);
            put(&mut self.hues[hue], to, &other.hues[hue], from);
        }
        for axis in 0..3 {
            put(&mut self.stride[axis], to, &other.stride[axis], from);
        }
        for word in 0..4 {
            put(&mut self.stream[word], to, &other.stream[word], from);
        }
    }

    /// The two numbers of the next candidate of every ray.
    #[inline(always)]
    pub fn draw(&self) -> [f32x8; 2] {
        let [a, b, ..] = Stream::words_x8(self.stream, self.candidates);
        [uniform_f32(a), uniform_f32(b)]
    }
}

/// Puts lane `from` of `source` in lane `to`.
#[inline(always)]
fn put<T: bytemuck::Pod>(column: &mut T, to: usize, source: &T, from: usize) {
    let (column, source): (&mut [u32; LANES], &[u32; LANES]) = (bytemuck::cast_mut(column), bytemuck::cast_ref(source));
    column[to] = source[from];
}

#[inline(always)]
fn choose(mask: f32x8, a: i32x8, b: i32x8) -> i32x8 {
    bytemuck::cast(mask.select(bytemuck::cast::<i32x8, f32x8>(a), bytemuck::cast::<i32x8, f32x8>(b)))
}
