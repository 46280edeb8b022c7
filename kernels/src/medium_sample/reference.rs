//! Free flights in f64.
//!
//! ```text
//! flight of the medium that a share u of all flights does not reach, in the channel of the hero
//! ```
//!
//! Before it, a path that has left the camera goes on if its fourth number is below the survival.

use glam::DVec3;

use super::Columns;
use crate::columns::queues::Flight;
use crate::connect::sequence::Draws;
use crate::media::Medium;
use crate::media::field::tracking;
use crate::random::Stream;
use crate::{Step, WalkLimits, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, walk, live, paths, immersion, vertex, ray, flights } = columns;
    let lanes: Vec<usize> = live.each().collect();
    for lane in lanes {
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let depth = paths.depth_of(step.clock, lane);
        let [distance, cosine, azimuth, survival] = words(pixel, sample, depth, step.seed);
        if depth > 0 && !survives(walk, depth, random::uniform(survival)) {
            live.remove(lane);
            continue;
        }
        let draws = Draws { pixel, sample, depth, seed: step.seed };
        let [origin, direction] =
            [vertex.position.row(lane), ray.direction.row(lane)].map(|v| DVec3::from(v.map(f64::from)));
        let hero = immersion.hero.rows()[lane] as usize;
        let flight = flight(medium, hero, (origin, direction), random::uniform(distance), &draws) as f32;
        flights.set_row(lane, Flight { flight, cosine, azimuth });
    }
}

/// Free flight of a path along the ray (origin, unit direction), in the channel of its hero: the one that a share `u` of
/// all flights does not reach, which in a field is tracked.
pub fn flight(medium: &Medium, hero: usize, ray: (DVec3, DVec3), u: f64, draws: &Draws) -> f64 {
    let Some(field) = medium.field() else {
        return medium.homogeneous_twin(hero).flight(u);
    };
    let Draws { pixel, sample, depth, seed } = *draws;
    let stream = Stream::new(pixel, sample, random::block(depth, random::TRACKING), seed, 0);
    let (field, hue) = field.channel(hero);
    tracking::reference::flight(field, f64::from(hue), ray.0, ray.1, -(1.0 - u).ln(), stream)
}

/// The random words of the segment that leaves the vertex at `depth`: flight, cosine, azimuth, survival.
pub fn words(pixel: u32, sample: u32, depth: u32, seed: u32) -> [u32; 4] {
    random::words(pixel, sample, random::block(depth, random::SEGMENT), seed)
}

/// Whether a walk goes on from the vertex at `depth`, >= 1, whose number is `u`.
pub fn survives(walk: &WalkLimits, depth: u32, u: f64) -> bool {
    u < f64::from(walk.survival.at(depth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::{ImmersionColumns, Path, PathColumns, RayColumns, VertexColumns};
    use crate::columns::queues::FlightTable;
    use crate::lanes::LaneSet;
    use crate::media::Medium;
    use crate::phase::PhaseFunction;
    use crate::survival::Survival;
    use bumpalo::Bump;

    #[test]
    fn all_vertices_but_the_camera_end_paths_as_often_as_they_should() {
        let arena = Bump::new();
        let lanes = 8000;
        let mut paths = PathColumns::new_in(&arena, lanes);
        let mut live = LaneSet::new_in(&arena, lanes);
        let immersion = ImmersionColumns::new_in(&arena, lanes);
        let mut flights = FlightTable::new_in(&arena, lanes);
        // A third each at the camera, after one segment and after four.
        for lane in 0..lanes {
            let depth = [0, 1, 4][lane % 3];
            paths.set_row(lane, Path { pixel: lane as u32, sample: 0, birth: 50 - depth });
            live.insert(lane);
        }
        let medium = Medium::homogeneous(2.0, [1.0; 3], PhaseFunction::henyey_greenstein(0.0));
        let walk = WalkLimits { segments: 9, starts: 1, survival: Survival::Constant(0.75) };
        let columns = Columns {
            medium: &medium,
            walk: &walk,
            live: &mut live,
            paths: &paths,
            immersion: &immersion,
            vertex: &VertexColumns::new_in(&arena, lanes),
            ray: &RayColumns::new_in(&arena, lanes),
            flights: &mut flights,
        };
        run(Step { seed: 5, clock: 50 }, columns);
        let mut alive = [0; 3];
        for lane in 0..lanes {
            let lives = live.contains(lane);
            alive[lane % 3] += u32::from(lives);
            assert_eq!(flights.flight.rows()[lane] > 0.0, lives, "lane {lane}");
        }
        // Five standard deviations of a binomial count of 2666.
        let thinned = alive[1..].iter().all(|alive: &u32| alive.abs_diff(2000) < 112);
        assert!(alive[0] == 2667 && thinned, "{alive:?}");
    }
}
