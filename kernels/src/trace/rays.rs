//! Eight rays made ready: what [`ray`](super::ray) is for one, lane by lane in the same arithmetic.
//!
//! **Boxes.** Which of two planes is near differs between rays, and needs no choice: the near one is where t is less,
//! after both were moved away from the inside of their box.
//!
//! **Triangles.** Which axis is the longest differs, too; the axes of the views are numbers per ray.

use wide::{f32x8, u32x8};

use super::Ray;
use super::ray::{LEAST, Line, Ready, VIEWS, WIDENING};
use crate::lanes::{self, LANES};
use crate::real::Real;
use crate::vec3::{Vec3, Vec3x8};

/// Eight rays: the points `origin + t direction` for t in `(0, max)`.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// Where they start; see [`Ray`].
    pub origin: Vec3x8,
    /// Where they go.
    pub direction: Vec3x8,
    /// Bounds of t.
    pub max: f32x8,
}

impl Rays {
    /// One of them.
    #[inline(always)]
    pub fn at(&self, lane: usize) -> Ray {
        let row = |v: Vec3x8| v.to_arrays().map(|component| component[lane]);
        Ray { origin: row(self.origin), direction: row(self.direction), max: self.max.to_array()[lane] }
    }
}

/// Eight rays made ready for boxes, by axis.
pub struct Slabs {
    /// r: one over the direction.
    pub(super) inverse: [f32x8; 3],
    /// c of lower planes.
    lower: [f32x8; 3],
    /// c of upper planes.
    upper: [f32x8; 3],
}

impl Slabs {
    /// Of rays that meet boxes whose coordinates have sizes of up to `extent`.
    #[inline(always)]
    pub fn new(rays: &Rays, extent: f32) -> Self {
        let least = f32x8::splat(LEAST) * largest(rays.direction);
        let widening = f32x8::splat(WIDENING) * (f32x8::splat(extent) + largest(rays.origin));
        let (origin, direction) = (by_axis(rays.origin), by_axis(rays.direction));
        let inverse = direction.map(|d| {
            let size = d.abs().fast_max(least);
            f32x8::ONE / d.is_sign_negative().select(-size, size)
        });
        // Every plane is moved away from the inside of its box, whichever way the ray goes.
        let lower = [0, 1, 2].map(|axis| -(origin[axis] + widening) * inverse[axis]);
        let upper = [0, 1, 2].map(|axis| -(origin[axis] - widening) * inverse[axis]);
        Self { inverse, lower, upper }
    }

    /// Where the rays' lines enter the box with these lower and upper planes, and, as a mask, the rays that are in it
    /// after their start and no later than `max`. A box's lower planes are not above the upper ones.
    #[inline(always)]
    pub fn enter(&self, planes: &[f32; 6], max: f32x8) -> (f32x8, f32x8) {
        let t = |plane: usize, c: &[f32x8; 3]| {
            let axis = plane % 3;
            f32x8::splat(planes[plane]).mul_add(self.inverse[axis], c[axis])
        };
        let [[ax, bx], [ay, by], [az, bz]] = [0, 1, 2].map(|axis| [t(axis, &self.lower), t(3 + axis, &self.upper)]);
        let entered = ax.fast_min(bx).fast_max(ay.fast_min(by)).fast_max(az.fast_min(bz));
        let left = ax.fast_max(bx).fast_min(ay.fast_max(by)).fast_min(az.fast_max(bz));
        (entered, entered.fast_max(f32x8::ZERO).simd_le(left.fast_min(max)))
    }
}

/// Eight rays as boxes see them one at a time, by axis.
pub(super) struct Lines {
    inverse: [f32x8; 3],
    near: [f32x8; 3],
    far: [f32x8; 3],
    /// Rays for which the upper planes are near, as bits.
    backwards: [u32; 3],
}

impl Lines {
    #[inline(always)]
    pub fn new(Slabs { inverse, lower, upper }: &Slabs) -> Self {
        let backwards = inverse.map(|r| r.is_sign_negative());
        Self {
            inverse: *inverse,
            near: [0, 1, 2].map(|axis: usize| backwards[axis].select(upper[axis], lower[axis])),
            far: [0, 1, 2].map(|axis: usize| backwards[axis].select(lower[axis], upper[axis])),
            backwards: backwards.map(lanes::bits),
        }
    }

    /// One of the rays.
    #[inline(always)]
    pub fn at(&self, lane: usize) -> Line {
        Line {
            inverse: splat(&self.inverse, lane),
            near: splat(&self.near, lane),
            far: splat(&self.far, lane),
            near_side: self.backwards.map(|bits| (bits >> lane & 1) as usize),
        }
    }
}

/// What one lane has, in all lanes.
#[inline(always)]
fn splat(v: &[f32x8; 3], lane: usize) -> [f32x8; 3] {
    [0, 1, 2].map(|i: usize| f32x8::splat(v[i].as_array()[lane % LANES]))
}

/// Eight rays made ready for triangles: the view along each.
pub(super) struct Views {
    /// Axes x, y and z of the views: z is the longest of the direction.
    pub axes: [u32x8; 3],
    /// The origins along those axes `[m]`.
    pub origin: [f32x8; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z`.
    pub shear: [f32x8; 3],
    /// Rays that have a direction, as a mask: the others meet nothing.
    pub directed: f32x8,
}

impl Views {
    /// Of rays, and one over their directions.
    #[inline(always)]
    pub fn new(rays: &Rays, inverse: [f32x8; 3]) -> Self {
        let longest = largest(rays.direction);
        let [_, along_y, along_z] = by_axis(rays.direction).map(|d| d.abs().simd_eq(longest));
        let turned = |v: [f32x8; 3]| {
            let [x, y, z] = [0, 1, 2].map(|view: usize| VIEWS[view].map(|axis| v[axis]));
            [0, 1, 2].map(|axis| along_z.select(z[axis], along_y.select(y[axis], x[axis])))
        };
        // As numbers of the same bits, so that they are chosen as components are.
        let names = [0, 1, 2].map(|axis| bytemuck::cast::<u32x8, f32x8>(u32x8::splat(axis)));
        let [x, y, _] = turned(by_axis(rays.direction));
        let [.., over_z] = turned(inverse);
        Self {
            axes: turned(names).map(bytemuck::cast::<f32x8, u32x8>),
            origin: turned(by_axis(rays.origin)),
            shear: [x * over_z, y * over_z, over_z],
            directed: longest.simd_gt(f32x8::ZERO) & longest.simd_lt(f32x8::splat(f32::INFINITY)),
        }
    }
}

/// Eight rays made ready.
pub(super) struct Sights<'a> {
    pub rays: &'a Rays,
    pub slabs: &'a Slabs,
    pub views: Views,
}

impl<'a> Sights<'a> {
    #[inline(always)]
    pub fn new(rays: &'a Rays, slabs: &'a Slabs) -> Self {
        let views = Views::new(rays, slabs.inverse);
        Self { rays, slabs, views }
    }

    /// One of the rays, which has a direction; boxes see it as `line`.
    #[inline(always)]
    pub fn at(&self, lane: usize, line: Line) -> Ready {
        let Views { axes, shear, .. } = &self.views;
        Ready {
            line,
            origin: splat(&by_axis(self.rays.origin), lane),
            ray: self.rays.at(lane),
            axes: [0, 1, 2].map(|i: usize| axes[i].as_array()[lane % LANES] as usize),
            shear: splat(shear, lane),
        }
    }
}

/// Size of the largest component.
#[inline(always)]
pub(super) fn largest<F: Real>(v: Vec3<F>) -> F {
    v.x.abs().fast_max(v.y.abs()).fast_max(v.z.abs())
}

#[inline(always)]
pub(super) fn by_axis<F: Real>(v: Vec3<F>) -> [F; 3] {
    [v.x, v.y, v.z]
}
