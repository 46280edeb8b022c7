//! The end of walks, one path after the other.
//!
//! ```text
//! goes on:  depth + 1 < segments,  and the path met a surface, or its flight ends in a medium that scatters
//! ```

use super::Columns;
use crate::Step;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { segments, scatters, flights, on_surface, paths, live } = columns;
    let lanes: Vec<usize> = live.each().collect();
    for lane in lanes {
        let ends_somewhere = flights.flight.rows()[lane].is_finite();
        let turns = scatters && ends_somewhere || on_surface.contains(lane);
        if !turns || is_over(segments, paths.depth_of(step.clock, lane)) {
            live.remove(lane);
        }
    }
}

/// Whether the segment from the vertex at `depth` on is the last of a walk of so many segments.
pub fn is_over(segments: u32, depth: u32) -> bool {
    depth + 1 >= segments
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::PathColumns;
    use crate::columns::queues::FlightTable;
    use crate::lanes::LaneSet;
    use bumpalo::Bump;

    /// The paths that go on of sixteen, of depths 0, 1, 2 and so on; every third met a surface, the flights of the tenth
    /// and eleventh are endless, and the last is dead.
    fn after(segments: u32, scatters: bool) -> Vec<usize> {
        let arena = Bump::new();
        let mut paths = PathColumns::new_in(&arena, 16);
        let [mut live, mut on_surface] = [(); 2].map(|()| LaneSet::new_in(&arena, 16));
        let mut flights = FlightTable::new_in(&arena, 16);
        [9, 10].into_iter().for_each(|lane| flights.flight.rows_mut()[lane] = f32::INFINITY);
        for lane in 0..16 {
            paths.birth.rows_mut()[lane] = 40 - lane as u32;
            if lane < 15 {
                live.insert(lane);
            }
            if lane % 3 == 0 {
                on_surface.insert(lane);
            }
        }
        let columns =
            Columns { segments, scatters, flights: &flights, on_surface: &on_surface, paths: &paths, live: &mut live };
        run(Step { seed: 1, clock: 40 }, columns);
        live.each().collect()
    }

    #[test]
    fn walks_have_as_many_segments_as_are_asked_for() {
        assert_eq!(after(u32::MAX, true).len(), 14);
        assert_eq!(after(5, true), [0, 1, 2, 3]);
        assert_eq!(after(1, true), []);
    }

    #[test]
    fn endless_flights_end_paths_unless_a_surface_is_in_the_way() {
        let going = after(u32::MAX, true);
        assert!(going.contains(&9) && !going.contains(&10), "{going:?}");
    }

    #[test]
    fn where_nothing_scatters_only_paths_on_a_surface_go_on() {
        assert_eq!(after(u32::MAX, false), [0, 3, 6, 9, 12]);
        assert_eq!(after(8, false), [0, 3, 6]);
    }
}
