//! Which connections may count, in f64.
//!
//! ```text
//! C = 0  unless  n . (x_{n-1} - x_n) > 0,  x_1 != x_0  and  mu_t(x_i) > 0  for every inserted vertex x_i
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::emission::reference::cosine;
use crate::media::reference::Medium;
use crate::tables::lights::Emitter;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, bucket, candidates, chains, worth } = columns;
    let field = medium.field().map(|_| medium.own_twin());
    let field = field.as_ref().map(|twin| twin as &dyn Medium);
    for row in bucket.rows() {
        let candidate = candidates.row(row);
        let inserted = chains.vertices[..bucket.inserted].iter().map(|vertex| vertex.row(row));
        let chain = [candidate.start].into_iter().chain(inserted).chain([candidate.point]);
        let chain: Vec<DVec3> = chain.map(|vertex| DVec3::from(vertex.map(f64::from))).collect();
        let counts = may_count(field, &lights.emitters()[candidate.emitter as usize], &chain);
        worth.weight.rows_mut()[row] = if counts { 1.0 } else { 0.0 };
    }
}

/// Whether light goes along a `chain` from its start to a point on `emitter`, where extinction varies through `field`.
fn may_count(field: Option<&dyn Medium>, emitter: &Emitter, chain: &[DVec3]) -> bool {
    let [.., last, point] = chain else { return false };
    let inserted = &chain[1..chain.len() - 1];
    let scatters = |medium: &dyn Medium| inserted.iter().all(|vertex| medium.extinction(*vertex) > 0.0);
    cosine(emitter, *point, *point - *last) > 0.0 && chain[1] != chain[0] && field.is_none_or(scatters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::{Field, field::reference::FieldTwin};
    use crate::phase::PhaseFunction;

    #[test]
    fn neither_vacuum_nor_dark_sides_nor_vertices_at_the_start_count() {
        let lamp = Emitter::disk(4.0 * DVec3::Z, -DVec3::Z, 1.0, [1.0; 3]);
        let field = Field::block([[-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]], 3.0);
        let phase = PhaseFunction::isotropic();
        let twin = FieldTwin { field: &field, hue: 1.0, phase: phase.twin() };
        let counts = |inserted: &[[f64; 3]], is_bounded: bool| {
            let ends = [[DVec3::ZERO], [4.0 * DVec3::Z]];
            let inserted = inserted.iter().copied().map(DVec3::from);
            let chain: Vec<DVec3> = ends[0].into_iter().chain(inserted).chain(ends[1]).collect();
            may_count(is_bounded.then_some(&twin), &lamp, &chain)
        };
        for is_bounded in [false, true] {
            assert!(counts(&[], is_bounded) && counts(&[[0.5, 0.5, 1.0], [0.0, 0.9, 1.5]], is_bounded));
            assert!(!counts(&[[0.0, 0.0, 1.0], [0.1, 0.0, 5.0]], is_bounded), "from behind the lamp");
            assert!(!counts(&[[0.0; 3], [0.0, 0.9, 1.5]], is_bounded), "a vertex where the start is");
            assert_eq!(counts(&[[0.0, 0.0, 3.0], [0.0, 0.1, 1.0]], is_bounded), !is_bounded, "a vertex in vacuum");
        }
    }
}
