//! The current vertices of live paths, copied one after the other.
//!
//! ```text
//! trail(lane, clock) = (position, arc) of the vertex, direction of the ray, light sum of the outlook
//! ```

use super::Columns;
use crate::Step;
use crate::columns::trail::Mark;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { live, vertex, ray, outlook, trail } = columns;
    if trail.slots() == 0 {
        return;
    }
    for lane in live.each() {
        let mark = Mark {
            position: vertex.position.row(lane),
            arc: vertex.arc.rows()[lane],
            leaving: ray.direction.row(lane),
            light_sum: outlook.light_sum.rows()[lane],
        };
        trail.set_row(lane, step.clock, mark);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::{OutlookColumns, RayColumns, Vertex, VertexColumns};
    use crate::columns::trail::TrailTable;
    use crate::lanes::LaneSet;
    use bumpalo::Bump;

    const LANES: usize = 16;

    /// What is current at `clock` in `lane`.
    fn mark(clock: u32, lane: usize) -> Mark {
        let number = (100 * clock) as f32 + lane as f32;
        Mark { position: [number, 1.0, -number], arc: 0.5 * number, leaving: [0.0, number, 2.0], light_sum: -number }
    }

    /// A trail of so many slots, in which every other lane has remembered its vertices up to clock 49.
    fn trail(arena: &Bump, slots: usize) -> TrailTable<'_> {
        let mut trail = TrailTable::new_in(arena, LANES, slots);
        let mut live = LaneSet::new_in(arena, LANES);
        let mut vertex = VertexColumns::new_in(arena, LANES);
        let mut ray = RayColumns::new_in(arena, LANES);
        let mut outlook = OutlookColumns::new_in(arena, LANES);
        (0..LANES).step_by(2).for_each(|lane| live.insert(lane));
        for clock in 45..50 {
            for lane in 0..LANES {
                let Mark { position, arc, leaving, light_sum } = mark(clock, lane);
                vertex.set_row(lane, Vertex { position, arc });
                ray.direction.set_row(lane, leaving);
                outlook.light_sum.rows_mut()[lane] = light_sum;
            }
            let columns = Columns { live: &live, vertex: &vertex, ray: &ray, outlook: &outlook, trail: &mut trail };
            run(Step { seed: 1, clock }, columns);
        }
        trail
    }

    #[test]
    fn every_live_path_finds_its_last_vertices_again() {
        let arena = Bump::new();
        let trail = trail(&arena, 3);
        for (clock, lane) in (47..50).flat_map(|clock| (0..LANES).map(move |lane| (clock, lane))) {
            if lane % 2 == 0 {
                assert_eq!(trail.row(lane, clock), mark(clock, lane));
            } else {
                assert_eq!(trail.numbers(lane, clock), [0.0; 8], "lane {lane} is dead");
            }
        }
    }

    #[test]
    fn nothing_is_remembered_where_nothing_looks_back() {
        let arena = Bump::new();
        assert_eq!(trail(&arena, 0).lanes(), 0);
    }
}
