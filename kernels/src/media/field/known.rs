//! Of what nothing has to be estimated: one shape of one extinction, and one box of cells that are all alike.
//!
//! **One shape.** A ball or a box of one extinction, and what is around it, is all that there is in many fields. A segment
//! then has three pieces of one extinction each: before, within and behind the shape. Its optical depth is their sum,
//! and a flight ends where that is used up.
//!
//! **An even part.** Where a field is a cloud with a solid kernel, or fog with bounds that few paths come to, most cells
//! next to each other are alike. A box of these is remembered. It is convex: a segment from one point of it to another has
//! one extinction, and so has a flight that ends before it leaves the box. This changes nothing of what is found there,
//! only how long it takes.

use glam::DVec3;
use wide::f32x8;

use super::axis::within;
use super::bricks::Extent;
use super::cells::Survey;
use super::shape::Shape;
use super::volume::Volume;
use crate::vec3::Vec3x8;

/// One shape, in a lattice of one cell that just holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneShape {
    /// Extinction in it [1/m].
    pub extinction: f32,
    /// Whether it is a ball: half a cell about the middle of the cell. Otherwise it is the cell.
    pub is_round: bool,
}

impl OneShape {
    /// The one that `volumes` are, if they are one.
    pub fn of(volumes: &[Volume]) -> Option<Self> {
        let [Volume { shape: Some(shape), voxels: None, extinction }] = volumes else { return None };
        match shape {
            Shape::Box { .. } => Some(Self { extinction: *extinction, is_round: false }),
            Shape::Sphere { .. } => Some(Self { extinction: *extinction, is_round: true }),
            Shape::Mesh(_) | Shape::Voxels(_) => None,
        }
    }

    /// The part of `start + t way`, t in [0, `end`], in cells, within the shape; empty where the second is not larger.
    #[inline(always)]
    pub fn part(&self, start: Vec3x8, way: Vec3x8, end: f32x8) -> [f32x8; 2] {
        if !self.is_round {
            return within(start, way, [0.0; 3], [1.0; 3], end);
        }
        let from_middle = start - Vec3x8::splat([0.5; 3]);
        let squared = way.length_squared().fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let closest = -from_middle.dot(way) / squared;
        // From the point that is closest to the middle, so that nothing cancels however far away the start is.
        let left = f32x8::splat(0.25) - way.mul_add(closest, from_middle).length_squared();
        let half = (left.fast_max(f32x8::ZERO) / squared).sqrt();
        [(closest - half).fast_max(f32x8::ZERO), (closest + half).fast_min(end)]
    }
}

/// A box of cells of one extinction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenPart {
    /// Its corners, in cells, moved inwards.
    low: [f32; 3],
    high: [f32; 3],
    /// Extinction in it [1/m].
    pub extinction: f32,
}

/// By how much of a cell the corners are moved inwards: what is within is in these cells, however it is rounded.
const INWARDS: f32 = 1e-2;
/// Cells from which such a box is looked for.
const SEEDS: usize = 64;
/// Least share of all cells for which the box is worth being asked for.
const LEAST_SHARE: f64 = 0.05;

impl EvenPart {
    /// The largest box that grows from some of the cells; none if it is small.
    pub fn largest(cells: &Survey) -> Option<Self> {
        let [width, height, depth] = cells.dims.map(|dim| dim as usize);
        let place = |i: usize| [i % width, i / width % height, i / (width * height)].map(|c| c as u32);
        let count = width * height * depth;
        let is_seed = |i: &usize| is_even(cells, place(*i)).is_some_and(|extinction| extinction > 0.0);
        let step = (count / SEEDS).max(1);
        // A prime number of rows apart: seeds are not all in one plane.
        let seeds = (0..count.min(SEEDS)).map(|k| (step / 2 + k * step + 7 * k * width) % count).filter(is_seed);
        let (corners, extinction) = seeds
            .map(|i| (grown(cells, place(i)), is_even(cells, place(i)).unwrap_or(0.0)))
            .max_by_key(|(corners, _)| volume(corners))?;
        let is_large = volume(&corners) as f64 >= LEAST_SHARE * count as f64;
        let [low, high] = corners.map(|corner| corner.map(|c| c as f32));
        let part = Self { low: low.map(|c| c + INWARDS), high: high.map(|c| c - INWARDS), extinction };
        is_large.then_some(part)
    }

    /// Which points, in cells, are in it.
    #[inline(always)]
    pub fn holds(&self, at: Vec3x8) -> f32x8 {
        let inside =
            |v: f32x8, axis: usize| v.simd_ge(f32x8::splat(self.low[axis])) & v.simd_le(f32x8::splat(self.high[axis]));
        inside(at.x, 0) & inside(at.y, 1) & inside(at.z, 2)
    }

    /// Whether a point, in cells, is in it, for twins.
    pub fn holds_one(&self, at: DVec3) -> bool {
        (0..3).all(|axis| (f64::from(self.low[axis])..=f64::from(self.high[axis])).contains(&at[axis]))
    }
}

/// The extinction of a cell that has but one [1/m].
fn is_even(cells: &Survey, place: [u32; 3]) -> Option<f32> {
    let Extent { least, most, .. } = cells.at(place);
    (least == most).then_some(most)
}

/// Cells in a box from one corner to the other.
fn volume([low, high]: &[[u32; 3]; 2]) -> u64 {
    (0..3).map(|axis| u64::from(high[axis] - low[axis])).product()
}

/// The box of cells like that at `seed`, from its first cell to the ones behind its last, that grows as long as a whole
/// layer on any of its sides is like it.
fn grown(cells: &Survey, seed: [u32; 3]) -> [[u32; 3]; 2] {
    let extinction = is_even(cells, seed);
    let mut corners = [seed, seed.map(|c| c + 1)];
    let mut grows = true;
    while grows {
        grows = false;
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let at_border = if side == 0 { corners[0][axis] == 0 } else { corners[1][axis] == cells.dims[axis] };
            if at_border {
                continue;
            }
            let layer = if side == 0 { corners[0][axis] - 1 } else { corners[1][axis] };
            let mut range = [0, 1, 2].map(|axis| corners[0][axis]..corners[1][axis]);
            range[axis] = layer..layer + 1;
            let [xs, ys, zs] = range;
            let is_like = |x: u32, y: u32, z: u32| is_even(cells, [x, y, z]) == extinction;
            if zs.into_iter().all(|z| ys.clone().all(|y| xs.clone().all(|x| is_like(x, y, z)))) {
                if side == 0 {
                    corners[0][axis] -= 1
                } else {
                    corners[1][axis] += 1
                }
                grows = true;
            }
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(extinction: impl Fn([u32; 3]) -> f32 + Sync + Send) -> Survey {
        let even = |extinction: f32| Extent { least: extinction, most: extinction, mean: extinction };
        Survey::new([20, 16, 12], 1.0, 0.0, |place| (even(extinction(place)), 1))
    }

    #[test]
    fn the_largest_box_of_cells_that_are_alike_is_found() {
        let inside = |place: [u32; 3]| (0..3).all(|axis| place[axis] >= 2 && place[axis] < [17, 15, 11][axis]);
        let part = EvenPart::largest(&cells(|place| if inside(place) { 3.0 } else { 0.0 })).expect("a box");
        assert_eq!(part.extinction, 3.0);
        for axis in 0..3 {
            assert_eq!(part.low[axis].floor(), 2.0);
            assert_eq!(part.high[axis].ceil(), [17.0, 15.0, 11.0][axis]);
        }
        let at = |x: f32| part.holds(Vec3x8::splat([x, 8.0, 6.0])).all();
        assert_eq!([2.5, 16.5, 1.9, 17.1].map(at), [true, true, false, false]);
    }

    #[test]
    fn neither_vacuum_nor_what_is_different_everywhere_is_one() {
        assert_eq!(EvenPart::largest(&cells(|_| 0.0)), None);
        assert_eq!(EvenPart::largest(&cells(|[x, y, z]| (x + 7 * y + 31 * z + 1) as f32)), None);
    }
}
