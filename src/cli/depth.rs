//! Optical depths, for whoever wants to know them: nothing of it is rendered.

use fogbow_kernels::media::field::Field;
use fogbow_kernels::media::field::reference::part_in_box;
use fogbow_kernels::media::reference::Medium as _;
use fogbow_kernels::media::{Medium, MediumLanes, MediumX8};
use fogbow_kernels::vec3::Vec3x8;
use fogbow_kernels::with_medium;
use glam::DVec3;

/// Points between two borders at which extinction is looked up where no formula tells the depth.
const POINTS: u32 = 1024;

/// Optical depth per channel of the segment between two points of a scene. Connections have limits and count less of what
/// is thick and uneven; this is all of it.
pub fn between(medium: &Medium, from: DVec3, to: DVec3) -> [f64; 3] {
    let Some(field) = medium.field().filter(|field| !field.is_known()) else {
        return [0, 1, 2].map(|channel| medium.twin(channel).optical_depth(from, to));
    };
    let borders = borders(field, from, to);
    with_medium!(medium, |lanes| [0, 1, 2].map(|channel| {
        let mean = |piece: &[f64]| mean(lanes.channel(channel), from, to, [piece[0], piece[1]]);
        let share = |piece: &[f64]| (piece[1] - piece[0]) * mean(piece);
        borders.windows(2).map(share).sum::<f64>() * from.distance(to)
    }))
}

/// Where the segment begins and ends, and where it enters and leaves the boxes around volumes, as shares of it: a volume
/// may be small next to it.
fn borders(field: &Field, from: DVec3, to: DVec3) -> Vec<f64> {
    let parts = field.volume_bounds().filter_map(|bounds| part_in_box(bounds, from, to - from, 1.0));
    let mut borders: Vec<_> = parts.flat_map(|(enter, exit)| [enter, exit]).chain([0.0, 1.0]).collect();
    borders.sort_by(f64::total_cmp);
    borders
}

/// Mean extinction between two shares of a segment [1/m].
fn mean(medium: impl MediumX8, from: DVec3, to: DVec3, [begin, end]: [f64; 2]) -> f64 {
    let extinction = |point: u32| {
        let share = begin + (end - begin) * (f64::from(point) + 0.5) / f64::from(POINTS);
        let at = Vec3x8::splat(from.lerp(to, share).as_vec3().to_array());
        f64::from(medium.extinction(at).to_array()[0])
    };
    (0..POINTS).map(extinction).sum::<f64>() / f64::from(POINTS)
}

#[cfg(test)]
mod tests {
    use fogbow_kernels::media::field::{Shape, Volume};
    use fogbow_kernels::phase::PhaseFunction;

    use super::*;

    fn ball(z: f64, radius: f64) -> Volume {
        let shape = Shape::Sphere { center: DVec3::new(0.0, 0.0, z), radius };
        Volume { shape: Some(shape), voxels: None, extinction: 0.5 }
    }

    #[test]
    fn small_volumes_before_distant_lights_count_in_every_channel() {
        let volumes = || vec![ball(50.0, 10.0), ball(300.0, 4.0)];
        let lit = DVec3::new(0.0, 0.0, 1e6);
        let depths =
            |field: Field| between(&Medium::of_field(field, [0.5; 3], PhaseFunction::isotropic()), DVec3::ZERO, lit);
        let close = |found: [f64; 3], expected: [f64; 3]| {
            (0..3).for_each(|c| assert!((found[c] / expected[c] - 1.0).abs() < 2e-3, "{found:?}, not {expected:?}"));
        };
        close(depths(Field::new(volumes(), 0.0)), [14.0; 3]);
        close(depths(Field::new(volumes(), 0.0).coloured([1.0, 0.5, 0.25])), [14.0, 7.0, 3.5]);
        // Each of a colour of its own, in haze.
        let apart = Field::of_colours(volumes(), &[[1.0, 0.5, 0.25], [0.5, 1.0, 1.0]], [0.0, 1e-5, 2e-5]);
        close(depths(apart), [12.0, 9.0 + 10.0, 6.5 + 20.0]);
    }
}
