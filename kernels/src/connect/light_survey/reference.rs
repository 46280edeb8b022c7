//! What vertices know of the lights, in f64.
//!
//! With c_l, R_l and `share_l` the centre, the radius and the share of light l, a vertex x has
//!
//! ```text
//! light sum = sum over l of share_l / |x - c_l|
//! near:       |x - c_l| <= (near + R_l) (1 + 10^-4)       for any l
//! ```
//!
//! and the first near vertex of its path is the one of the least depth.

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::connect::light_sample::reference::light_sum;
use crate::tables::lights::Lights;

/// How much farther than the limit a light still counts as near, so that rounding cannot lose one.
const NEAR_MARGIN: f64 = 1.0 + 1e-4;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, near, starts, live, paths, last_surface, vertex, outlook } = columns;
    for lane in live.each() {
        let depth = paths.depth_of(step.clock, lane);
        if depth - last_surface.first_start(lane) >= starts {
            continue;
        }
        let position = DVec3::from(vertex.position.row(lane).map(f64::from));
        if lights.selection_depends_on_start() {
            outlook.light_sum.rows_mut()[lane] = light_sum(lights, position) as f32;
        }
        if near.is_finite() && is_near_a_light(lights, f64::from(near), position) {
            let first_near = &mut outlook.first_near.rows_mut()[lane];
            *first_near = depth.min(*first_near);
        }
    }
}

/// Whether some point of some light may be within `near` of `position` `[m]`; certainly true if one is.
pub fn is_near_a_light(lights: &Lights, near: f64, position: DVec3) -> bool {
    lights.lights().iter().any(|light| {
        let distance = DVec3::from(light.center.map(f64::from)).distance(position);
        distance <= (near + f64::from(light.radius)) * NEAR_MARGIN
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::{LastSurfaceColumns, Outlook, OutlookColumns, PathColumns, VertexColumns};
    use crate::lanes::LaneSet;
    use crate::tables::lights::{Emitter, Selection};
    use bumpalo::Bump;

    const CLOCK: u32 = 50;
    const BEFORE: Outlook = Outlook { light_sum: -1.0, first_near: 7 };

    /// Two lights at the heights 2 and 4, of a quarter and three quarters of the intensity.
    fn lights(selection: Selection) -> Lights {
        let disk = |z: f64, radiance: f64| Emitter::disk(z * DVec3::Z, DVec3::NEG_Z, 0.5, [radiance; 3]);
        Lights::new(vec![disk(2.0, 1.0), disk(4.0, 3.0)], selection)
    }

    /// What the stage leaves of eight paths at the origin, with these depths of vertex and last surface; the last path
    /// is dead.
    fn after(lights: &Lights, near: f32, starts: u32, depths: [[u32; 2]; 8]) -> [Outlook; 8] {
        let arena = Bump::new();
        let mut live = LaneSet::new_in(&arena, 8);
        let mut paths = PathColumns::new_in(&arena, 8);
        let mut last_surface = LastSurfaceColumns::new_in(&arena, 8);
        let vertex = VertexColumns::new_in(&arena, 8);
        let mut outlook = OutlookColumns::new_in(&arena, 8);
        for (lane, [depth, surface]) in depths.into_iter().enumerate() {
            paths.birth.rows_mut()[lane] = CLOCK - depth;
            last_surface.depth.rows_mut()[lane] = surface;
            outlook.set_row(lane, BEFORE);
            if lane < 7 {
                live.insert(lane);
            }
        }
        let columns = Columns {
            lights,
            near,
            starts,
            live: &live,
            paths: &paths,
            last_surface: &last_surface,
            vertex: &vertex,
            outlook: &mut outlook,
        };
        run(Step { seed: 1, clock: CLOCK }, columns);
        core::array::from_fn(|lane| outlook.row(lane))
    }

    #[test]
    fn vertices_that_may_not_start_are_left_alone() {
        let depths = [[1, 0], [2, 0], [3, 0], [4, 4], [5, 4], [6, 4], [9, 8], [1, 0]];
        let left = after(&lights(Selection::IntensityDistance), 3.0, 2, depths);
        let sum = 0.25 / 2.0 + 0.75 / 4.0;
        let surveyed = |depth: u32| (sum, BEFORE.first_near.min(depth));
        let untouched = (BEFORE.light_sum, BEFORE.first_near);
        let expected =
            [surveyed(1), surveyed(2), untouched, surveyed(4), surveyed(5), untouched, surveyed(9), untouched];
        for (outlook, (light_sum, first_near)) in left.into_iter().zip(expected) {
            assert!((outlook.light_sum - light_sum).abs() < 1e-6, "{outlook:?}");
            assert_eq!(outlook.first_near, first_near);
        }
    }

    #[test]
    fn only_what_is_asked_for_is_filled() {
        let survey = |selection: Selection, near: f32| after(&lights(selection), near, u32::MAX, [[3, 0]; 8])[0];
        assert_eq!(survey(Selection::Intensity, f32::INFINITY), BEFORE);
        assert_eq!(survey(Selection::Intensity, 2.0), Outlook { first_near: 3, ..BEFORE });
        let sums = [f32::INFINITY, 2.0, 1.0].map(|near| survey(Selection::IntensityDistance, near));
        assert_eq!(sums.map(|outlook| outlook.first_near), [7, 3, 7]);
        assert!(sums.iter().all(|outlook| outlook.light_sum > 0.0), "{sums:?}");
    }

    #[test]
    fn a_light_is_near_as_far_as_its_farthest_point_may_be() {
        let lights = lights(Selection::Uniform);
        let near = |z: f64| is_near_a_light(&lights, 1.0, z * DVec3::Z);
        assert_eq!([0.4999, 0.5, 3.0, 5.5001].map(near), [true; 4]);
        assert_eq!([0.4, 5.6].map(near), [false; 2]);
        assert!(!is_near_a_light(&Lights::new(Vec::new(), Selection::Uniform), 1e9, DVec3::ZERO));
    }
}
