//! Segment against disk and sphere in f64.
//!
//! With the heights `h = (x - c) . n` of its ends over the disk's plane, a segment from a to b crosses the plane if
//! they have opposite signs, at
//!
//! ```text
//! a + (b - a) h_a / (h_a - h_b)
//! ```
//!
//! and the disk of radius R blocks it if that point is within R of the centre c. The test covers the segment as it is,
//! from perturbed vertex to perturbed vertex, not its seed on the axis. A sphere blocks it if its closest point to the
//! centre is within the radius.

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::tables::lights::{Emitter, Lights, Shape};
use crate::tables::surfaces::Surfaces;
use crate::trace::{self, Ray};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { lights, surfaces, bucket, candidates, chains, worth } = columns;
    let mut chain = Vec::with_capacity(bucket.inserted + 2);
    for row in bucket.rows() {
        chain.clear();
        chain.push(DVec3::from(candidates.start.row(row).map(f64::from)));
        for vertex in &chains.vertices[..bucket.inserted] {
            chain.push(DVec3::from(vertex.row(row).map(f64::from)));
        }
        chain.push(DVec3::from(candidates.point.row(row).map(f64::from)));
        let emitter = candidates.emitter.rows()[row] as usize;
        let weighs = worth.weight.rows()[row] != 0.0;
        if weighs && (is_occluded(lights, emitter, &chain) || is_hidden(lights, surfaces, emitter, &chain)) {
            worth.factor.set_row(row, [0.0; 3]);
        }
    }
}

/// Whether a disk or sphere blocks the chain from a start to a point on an `emitter`, which does not block the
/// segment that ends on it.
pub fn is_occluded(lights: &Lights, emitter: usize, chain: &[DVec3]) -> bool {
    let last = chain.len().saturating_sub(2);
    for (index, ends) in chain.windows(2).enumerate() {
        for (other, body) in lights.bodies().iter().enumerate() {
            if index == last && other == emitter {
                continue;
            }
            if blocks(body, ends[0], ends[1]) {
                return true;
            }
        }
    }
    false
}

/// Whether a triangle blocks a segment of the chain to a point on an `emitter`, which does not block the last.
pub fn is_hidden(lights: &Lights, surfaces: &Surfaces, emitter: usize, chain: &[DVec3]) -> bool {
    let (geometry, own) = (surfaces.geometry(), lights.emitters()[emitter].triangle as usize);
    let last = chain.len().saturating_sub(2);
    chain.windows(2).enumerate().any(|(index, ends)| {
        let [origin, end] = [ends[0], ends[1]].map(|v| v.as_vec3().to_array());
        let direction = core::array::from_fn(|axis| end[axis] - origin[axis]);
        let ray = Ray { origin, direction, max: 1.0 };
        let others = (0..geometry.len()).filter(|triangle| index != last || *triangle != own);
        others.into_iter().any(|triangle| trace::reference::meet(geometry.corners(triangle), &ray).is_some())
    })
}

/// Whether the segment from `a` to `b` crosses a disk, or enters a sphere; one that only touches a disk's plane does
/// not.
pub fn blocks(body: &Emitter, a: DVec3, b: DVec3) -> bool {
    let center = DVec3::from(body.origin.map(f64::from));
    let normal = DVec3::from(body.normal.map(f64::from));
    if body.shape == Shape::Sphere {
        let edge = b - a;
        let along = ((center - a).dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        return (a + along * edge - center).length() < f64::from(body.radius);
    }
    let (height_a, height_b) = ((a - center).dot(normal), (b - center).dot(normal));
    let crosses = (height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0);
    if !crosses {
        return false;
    }
    let crossing = a + (b - a) * (height_a / (height_a - height_b));
    (crossing - center).length() <= f64::from(body.radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::lights::Selection;

    #[test]
    fn segments_are_blocked_only_where_they_cross_a_disk() {
        let disk = Emitter::disk(DVec3::new(0.0, 0.0, 1.0), DVec3::Z, 1.0, [1.0; 3]);
        let blocked = |a: [f64; 3], b: [f64; 3]| blocks(&disk, DVec3::from(a), DVec3::from(b));
        assert!(blocked([0.5, 0.0, 0.0], [0.5, 0.0, 2.0]) && blocked([0.5, 0.0, 2.0], [0.5, 0.0, 0.0]));
        assert!(!blocked([1.5, 0.0, 0.0], [1.5, 0.0, 2.0]), "passes beside it");
        assert!(!blocked([0.5, 0.0, 0.0], [0.5, 0.0, 0.9]), "ends before it");
        assert!(!blocked([0.5, 0.0, 0.0], [0.5, 0.0, 1.0]), "touches it");
        assert!(!blocked([0.0, 0.0, 1.0], [0.5, 0.0, 1.0]), "lies in it");
    }

    #[test]
    fn a_light_blocks_every_segment_but_the_one_that_ends_on_it() {
        let lights = Lights::new(vec![Emitter::disk(DVec3::Z, -DVec3::Z, 1.0, [1.0; 3])], Selection::Uniform);
        let chain = [DVec3::ZERO, DVec3::new(0.0, 0.1, 1.5), DVec3::new(0.0, 0.2, 1.0)];
        assert!(is_occluded(&lights, 0, &chain));
        let beside = [DVec3::ZERO, DVec3::new(0.0, 3.5, 1.5), DVec3::new(0.0, 0.2, 1.0)];
        assert!(!is_occluded(&lights, 0, &beside));
        assert!(!is_occluded(&lights, 0, &[DVec3::ZERO, DVec3::new(0.0, 0.2, 1.000_000_1)]));
    }
}
