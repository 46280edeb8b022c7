//! Estimated transmittances in f64.
//!
//! ```text
//! factor *= prod over segments a -> b of T'(a, b) e^{tau~(a, b)}
//! ```

use glam::DVec3;

use super::Columns;
use crate::media::grid::Grid;
use crate::media::grid::reference::GridTwin;
use crate::media::grid::tracking::reference::transmittance;
use crate::media::reference::Medium as _;
use crate::phase::HenyeyGreenstein;
use crate::random::{self, Purpose, Stream};
use crate::{Step, connect::sequence::Draws};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { grid, bucket, purpose, candidates, chains, paths, worth, .. } = columns;
    for row in bucket.rows() {
        if worth.weight.rows()[row] == 0.0 {
            continue;
        }
        let candidate = candidates.row(row);
        let inserted = chains.vertices[..bucket.inserted].iter().map(|vertex| vertex.row(row));
        let chain = [candidate.start].into_iter().chain(inserted).chain([candidate.point]);
        let chain: Vec<DVec3> = chain.map(|v| DVec3::from(v.map(f64::from))).collect();
        let draws = Draws::new(step, paths, candidate.lane as usize);
        let through = factor(grid, &chain, purpose, &draws);
        let factor = worth.factor.row(row).map(|channel| (f64::from(channel) * through) as f32);
        worth.factor.set_row(row, factor);
    }
}

/// What the segments of a chain leave of light, over what weights take that for.
pub fn factor(grid: &Grid, chain: &[DVec3], purpose: Purpose, draws: &Draws) -> f64 {
    let medium = GridTwin { grid, phase: &HenyeyGreenstein { g: 0.0 } };
    let block = random::block(draws.depth, random::TRANSMITTANCE.nth(purpose.number()));
    let estimate = |(part, ends): (usize, &[DVec3])| {
        let stream = Stream::new(draws.pixel, draws.sample, block, draws.seed, part as u32);
        let (product, known) = transmittance(grid, ends[0], ends[1], stream);
        product * (medium.optical_depth(ends[0], ends[1]) - known).exp()
    };
    chain.windows(2).enumerate().map(estimate).product()
}
