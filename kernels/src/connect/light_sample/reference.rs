//! The choice of a light and of a point on it, in f64.
//!
//! A light of intensity `I_l = pi R^2 Le` at distance `D_l` from the start is chosen with probability `P_l`, one of
//!
//! ```text
//! 1 / lights,      I_l / sum I,      (I_l / D_l) / sum (I / D)
//! ```
//!
//! the last being Weber et al. 2017, Eq. 8, with I and D those of a light as a whole. Of a mesh, or of a group of disks
//! and spheres, it then chooses an emitter in proportion to `A L`, area times radiance; of a group, under the uniform
//! rule, all alike, as it counts as many lights as it has. The point is uniform on the emitter (area measure):
//!
//! ```text
//! disk:      r = R sqrt(u),                              p_A = 1 / (pi R^2)
//! sphere:    height z = R (1 - 2 u), r^2 = R^2 - z^2     p_A = 1 / (4 pi R^2)
//! triangle:  weights 1 - sqrt(u), (1 - v) sqrt(u), v sqrt(u)
//!            p_A = (A L / sum over the mesh of A L) / A
//! ```

use core::f64::consts::TAU;

use glam::DVec3;

use super::{Columns, Scope};
use crate::columns::queues::Candidate;
use crate::connect::distant;
use crate::emission::reference::cosine;
use crate::random::Purpose;
use crate::tables::lights::{Emitter, LEAST_SELECTION_DISTANCE, Light, Lights, Selection, Shape};
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, scope, live, paths, last_surface, vertex, before, connections, .. } = columns;
    for lane in live.each() {
        let depth = paths.depth_of(step.clock, lane);
        if !may_start(scope, depth, last_surface.first_start(lane)) {
            continue;
        }
        let start = vertex.position.row(lane);
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let u = uniforms(pixel, sample, depth, scope.purpose, step.seed);
        if let Some((emitter, point)) = connect(lights, scope, DVec3::from(start.map(f64::from)), u) {
            connections.push(Candidate {
                lane: lane as u32,
                emitter: emitter as u32,
                start,
                arriving: before.direction.row(lane),
                point: point.as_vec3().to_array(),
            });
        }
    }
}

/// Whether the vertex at `depth` connects, of a path whose first eligible vertex is at depth `first` <= `depth`.
pub fn may_start(scope: Scope, depth: u32, first: u32) -> bool {
    depth <= scope.max_depth && depth - first < scope.starts
}

/// What decides on light, emitter and point.
#[derive(Clone, Copy, Debug)]
pub struct Uniforms {
    /// Uniform number for the light.
    pub light: f64,
    /// Random words for the emitter, or for the pixel of an image.
    pub emitter: [u32; 4],
    /// Uniform numbers for the point.
    pub point: [f64; 2],
}

/// The numbers of a vertex's light point.
pub fn uniforms(pixel: u32, sample: u32, depth: u32, purpose: Purpose, seed: u32) -> Uniforms {
    let words = |purpose: Purpose| random::words(pixel, sample, random::block(depth, purpose), seed);
    let [light, u, v, _] = words(purpose);
    let emitter = words(purpose.emitter());
    Uniforms { light: random::uniform(light), emitter, point: [u, v].map(random::uniform) }
}

/// The emitter and the point that `start` is to be connected with, if that is within the scope.
pub fn connect(lights: &Lights, scope: Scope, start: DVec3, u: Uniforms) -> Option<(usize, DVec3)> {
    if scope.distant {
        return Some(distant::reference::connect(lights, start, u));
    }
    let light = choose_light(lights, start, u.light)?;
    let index = lights.choose_emitter(light as u32, u.emitter[0]) as usize;
    let emitter = &lights.emitters()[index];
    let point = point_on(emitter, u.point);
    if scope.facing && cosine(emitter, point, point - start) <= 0.0 {
        return None;
    }
    let may_be_so_deep = scope.reach.is_none_or(|reach| reach.may_hold_one(start, point));
    if (point - start).length() > f64::from(scope.max_distance) || !may_be_so_deep {
        return None;
    }
    Some((index, point))
}

/// What the probability of choosing `light` from `start` is proportional to.
fn preference(lights: &Lights, light: usize, start: DVec3) -> f64 {
    match lights.selection() {
        Selection::Uniform => lights_within(lights, light),
        Selection::Intensity => intensity(lights, light),
        Selection::IntensityDistance => intensity(lights, light) / selection_distance(&lights.lights()[light], start),
    }
}

/// How many lights a group of disks and spheres stands for; a mesh is one.
fn lights_within(lights: &Lights, light: usize) -> f64 {
    let emitters = &lights.lights()[light].emitters;
    if emitters.end as usize <= lights.bodies().len() { f64::from(emitters.end - emitters.start) } else { 1.0 }
}

/// Intensity of a light: that of all its emitters [W/sr].
fn intensity(lights: &Lights, light: usize) -> f64 {
    let [first, end] = [lights.lights()[light].emitters.start, lights.lights()[light].emitters.end];
    lights.emitters()[first as usize..end as usize].iter().map(Emitter::intensity).sum()
}

/// Distance from `start` to the centre of the light, as far as the selection is concerned `[m]`.
fn selection_distance(light: &Light, start: DVec3) -> f64 {
    (DVec3::from(light.center.map(f64::from)) - start).length().max(f64::from(LEAST_SELECTION_DISTANCE))
}

/// Sum of the preferences of all lights.
fn total_preference(lights: &Lights, start: DVec3) -> f64 {
    (0..lights.lights().len()).map(|light| preference(lights, light, start)).sum()
}

/// The light in whose interval `u` falls, when intervals as long as the probabilities are laid end to end in the order
/// of the table. None if there are no lights.
pub fn choose_light(lights: &Lights, start: DVec3, u: f64) -> Option<usize> {
    let target = u * total_preference(lights, start);
    let mut sum = 0.0;
    for light in 0..lights.lights().len() {
        sum += preference(lights, light, start);
        if target < sum {
            return Some(light);
        }
    }
    lights.lights().len().checked_sub(1)
}

/// P_l: the probability with which `start` chooses `light`.
pub fn selection_probability(lights: &Lights, light: usize, start: DVec3) -> f64 {
    preference(lights, light, start) / total_preference(lights, start)
}

/// Sum over the lights of their share in the total intensity over their distance [1/m].
pub fn light_sum(lights: &Lights, start: DVec3) -> f64 {
    let intensities: Vec<f64> = (0..lights.lights().len()).map(|light| intensity(lights, light)).collect();
    let total: f64 = intensities.iter().sum();
    let score = |(light, intensity): (&Light, f64)| intensity / total / selection_distance(light, start);
    lights.lights().iter().zip(intensities).map(score).sum()
}

/// The point of an emitter for two numbers `[m]`.
pub fn point_on(emitter: &Emitter, [u, v]: [f64; 2]) -> DVec3 {
    let [origin, tangent, bitangent] =
        [emitter.origin, emitter.tangent, emitter.bitangent].map(|v| DVec3::from(v.map(f64::from)));
    let radius = f64::from(emitter.radius);
    let (sin_azimuth, cos_azimuth) = (TAU * v).sin_cos();
    let around = cos_azimuth * tangent + sin_azimuth * bitangent;
    match emitter.shape {
        Shape::Disk => origin + radius * u.sqrt() * around,
        Shape::Sphere => {
            let height = radius * (1.0 - 2.0 * u);
            origin + height * tangent.cross(bitangent) + (radius * radius - height * height).max(0.0).sqrt() * around
        }
        Shape::Triangle => origin + u.sqrt() * ((1.0 - v) * tangent + v * bitangent),
        Shape::Distant => unreachable!("what is at infinity has no points"),
    }
}

/// p_A P_l: the density of a connection from `start` choosing a given point on `emitter` (area measure) [1/m^2].
pub fn light_density(lights: &Lights, emitter: usize, start: DVec3) -> f64 {
    let emitter = &lights.emitters()[emitter];
    let light = &lights.lights()[emitter.light as usize];
    let mesh = &lights.emitters()[light.emitters.start as usize..light.emitters.end as usize];
    let alike = lights.selection() == Selection::Uniform && emitter.shape != Shape::Triangle;
    let weight = |emitter: &Emitter| if alike { 1.0 } else { emitter.intensity() };
    let share = if mesh.len() > 1 { weight(emitter) / mesh.iter().map(weight).sum::<f64>() } else { 1.0 };
    selection_probability(lights, emitter.light as usize, start) * share / emitter.area()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, PathColumns, RayColumns, VertexColumns};
    use crate::columns::queues::CandidateQueue;
    use crate::lanes::LaneSet;
    use bumpalo::Bump;

    fn lights(selection: Selection) -> Lights {
        let disk = |z: f64, radius: f64, radiance: f64| {
            Emitter::disk(DVec3::new(0.5, -1.0, z), DVec3::new(0.2, 0.1, -1.0), radius, [radiance; 3])
        };
        Lights::new(
            vec![disk(1.0, 0.5, 2.0), disk(2.0, 1.0, 0.0), disk(3.0, 0.25, 16.0), disk(9.0, 0.5, 4.0)],
            selection,
        )
    }

    #[test]
    fn lights_are_chosen_as_often_as_their_probability_says() {
        let start = DVec3::new(0.5, -1.0, 0.0);
        for (selection, expected) in [
            (Selection::Uniform, [1.0, 1.0, 1.0, 1.0]),
            (Selection::Intensity, [0.5, 0.0, 1.0, 1.0]),
            (Selection::IntensityDistance, [0.5, 0.0, 1.0 / 3.0, 1.0 / 9.0]),
        ] {
            let lights = lights(selection);
            let total: f64 = expected.iter().sum();
            for (light, share) in expected.iter().map(|share| share / total).enumerate() {
                assert!((selection_probability(&lights, light, start) - share).abs() < 1e-12, "{selection:?}");
                let chosen = (0..9000)
                    .filter(|i| choose_light(&lights, start, (f64::from(*i) + 0.5) / 9000.0) == Some(light))
                    .count();
                assert!((chosen as f64 - 9000.0 * share).abs() <= 1.0, "{selection:?} light {light}: {chosen}");
            }
        }
        assert_eq!(choose_light(&Lights::new(Vec::new(), Selection::Uniform), start, 0.5), None);
    }

    #[test]
    fn the_light_sum_normalises_the_selection() {
        let (lights, start) = (lights(Selection::IntensityDistance), DVec3::new(0.5, -1.0, 0.0));
        let share = f64::from(lights.lights()[2].share) / 3.0 / light_sum(&lights, start);
        assert!((share - selection_probability(&lights, 2, start)).abs() < 1e-7);
        assert!(light_sum(&lights, DVec3::new(0.5, -1.0, 1.0)).is_finite(), "a start at a centre");
    }

    #[test]
    fn points_lie_on_the_disk_uniformly_in_area() {
        let lights = lights(Selection::Uniform);
        let disk = &lights.emitters()[2];
        let center = DVec3::from(disk.origin.map(f64::from));
        for [u, v] in [[0.0, 0.0], [0.25, 0.3], [0.99, 0.9]] {
            let offset = point_on(disk, [u, v]) - center;
            assert!((offset.length_squared() - 0.0625 * u).abs() < 1e-7);
            assert!(offset.dot(DVec3::from(disk.normal.map(f64::from))).abs() < 1e-7);
        }
    }

    /// Mean of `value` over points of an emitter, at the middles of cells.
    fn mean(emitter: &Emitter, value: impl Fn(DVec3) -> f64) -> f64 {
        let cells = (0..300 * 300).map(|i| [f64::from(i % 300), f64::from(i / 300)].map(|x| (x + 0.5) / 300.0));
        cells.map(|cell| value(point_on(emitter, cell))).sum::<f64>() / 90_000.0
    }

    #[test]
    fn points_lie_on_spheres_and_triangles_uniformly_in_area() {
        let center = DVec3::new(1.0, -2.0, 0.5);
        let sphere = Emitter::sphere(center, 0.5, [1.0; 3]);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            assert!(mean(&sphere, |point| (point - center).dot(axis)).abs() < 1e-5);
            assert!((mean(&sphere, |point| (point - center).dot(axis).powi(2)) - 0.25 / 3.0).abs() < 1e-5);
        }
        let corners = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 4.0, 1.0]];
        let triangle = Emitter::triangle(corners, 0, false, [1.0; 3]);
        // Moments of barycentric weights: 1/3 and 1/6.
        assert!((mean(&triangle, |point| point.x / 2.0) - 1.0 / 3.0).abs() < 1e-4);
        assert!((mean(&triangle, |point| (point.x / 2.0).powi(2)) - 1.0 / 6.0).abs() < 1e-4);
        assert!((mean(&triangle, |point| (point.y / 4.0).powi(2)) - 1.0 / 6.0).abs() < 1e-4);
    }

    #[test]
    fn lights_shine_where_their_cosine_is_positive() {
        let sphere = Emitter::sphere(DVec3::Z, 0.5, [1.0; 3]);
        assert!((cosine(&sphere, 0.5 * DVec3::Z, 3.0 * DVec3::Z) - 1.0).abs() < 1e-6);
        assert!(cosine(&sphere, 1.5 * DVec3::Z, DVec3::Z) < 0.0);
        let corners = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 4.0, 1.0]];
        for (double_sided, back) in [(false, -1.0), (true, 1.0)] {
            let triangle = Emitter::triangle(corners, 0, double_sided, [1.0; 3]);
            assert_eq!([DVec3::NEG_Z, DVec3::Z].map(|d| cosine(&triangle, DVec3::Z, d)), [1.0, back]);
        }
    }

    #[test]
    fn starts_are_counted_from_the_first_eligible_vertex() {
        let starts =
            |scope: Scope, first: u32| (first..20).filter(|depth| may_start(scope, *depth, first)).collect::<Vec<_>>();
        let all = Scope::new(random::BRIDGE_LIGHT);
        assert_eq!(starts(all, 1).len(), 19);
        assert_eq!(starts(all.from_first(1), 1), [1]);
        assert_eq!(starts(all.from_first(3), 4), [4, 5, 6]);
        assert_eq!(starts(Scope { max_depth: 5, ..all }, 4), [4, 5]);
        assert_eq!(starts(Scope { max_depth: 5, ..all.from_first(1) }, 6), []);
    }

    #[test]
    fn only_vertices_that_may_start_connect() {
        let arena = Bump::new();
        let lights = lights(Selection::IntensityDistance);
        let mut live = LaneSet::new_in(&arena, 4);
        let mut paths = PathColumns::new_in(&arena, 4);
        let last_surface = LastSurfaceColumns::new_in(&arena, 4);
        let outlook = OutlookColumns::new_in(&arena, 4);
        let vertex = VertexColumns::new_in(&arena, 4);
        let mut before = RayColumns::new_in(&arena, 4);
        let mut connections = CandidateQueue::new_in(&arena, 4);
        // Depths 1, 2, 3 and 1, the last of them dead.
        for (lane, depth) in [1, 2, 3, 1].into_iter().enumerate() {
            paths.birth.rows_mut()[lane] = 50 - depth;
            before.direction.set_row(lane, [0.0, 0.0, 1.0]);
            if lane < 3 {
                live.insert(lane);
            }
        }
        let columns = Columns {
            lights: &lights,
            scope: Scope { max_distance: 50.0, ..Scope::new(random::BRIDGE_LIGHT) }.from_first(2),
            live: &live,
            paths: &paths,
            last_surface: &last_surface,
            outlook: &outlook,
            vertex: &vertex,
            before: &before,
            connections: &mut connections,
        };
        run(Step { seed: 5, clock: 50 }, columns);
        assert_eq!(connections.lane.rows()[..connections.len], [0, 1]);
        assert_eq!(connections.row(1).arriving, [0.0, 0.0, 1.0]);
    }
}
