//! Quotients of phase functions in f64.
//!
//! ```text
//! factor_c *= product over turns of p(cos) / p~(cos)
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::media::Medium;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, solid, bucket, candidates, chains, paths, last_surface, worth } = columns;
    for row in bucket.rows().filter(|row| worth.weight.rows()[*row] != 0.0) {
        let candidate = candidates.row(row);
        let inserted = chains.vertices[..bucket.inserted].iter().map(|vertex| vertex.row(row));
        let chain = [candidate.start].into_iter().chain(inserted).chain([candidate.point]);
        let chain: Vec<DVec3> = chain.map(|vertex| DVec3::from(vertex.map(f64::from))).collect();
        let lane = candidate.lane as usize;
        let on_surface = solid && last_surface.depth.rows()[lane] == paths.depth_of(step.clock, lane);
        let arriving = (!on_surface).then(|| DVec3::from(candidate.arriving.map(f64::from)));
        let quotient = quotient(medium, arriving, &chain);
        worth.factor.set_row(row, worth.factor.row(row).map(|factor| (f64::from(factor) * quotient) as f32));
    }
}

/// The product over the turns of a chain from its start to the light; the first one from the direction in which the path
/// arrives at the start, if it scatters there.
pub fn quotient(medium: &Medium, arriving: Option<DVec3>, chain: &[DVec3]) -> f64 {
    let directions = chain.windows(2).map(|ends| (ends[1] - ends[0]).normalize_or_zero());
    let ways: Vec<DVec3> = arriving.into_iter().chain(directions).collect();
    let turning = &chain[usize::from(arriving.is_none())..];
    let turns = ways.windows(2).zip(turning);
    turns
        .map(|(ways, at)| {
            let cosine = ways[0].dot(ways[1]);
            medium.phase_at(*at).density(cosine) / medium.phase.twin().density(cosine)
        })
        .product()
}
