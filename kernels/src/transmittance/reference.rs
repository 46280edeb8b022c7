//! Estimated transmittances in f64.
//!
//! ```text
//! factor_c *= prod over segments a -> b of T'_c(a, b) e^{tau~_c(a, b)}
//! ```

use glam::DVec3;

use super::Columns;
use crate::media::field::Field;
use crate::media::field::reference::FieldTwin;
use crate::media::field::tracking::reference::transmittance;
use crate::media::reference::Medium as _;
use crate::media::spectral::CHANNELS;
use crate::phase::HenyeyGreenstein;
use crate::random::{self, Purpose, Stream};
use crate::{Step, connect::sequence::Draws};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { field, flown, bucket, purpose, candidates, chains, paths, immersion, worth, .. } = columns;
    for row in bucket.rows() {
        if worth.weight.rows()[row] == 0.0 {
            continue;
        }
        let candidate = candidates.row(row);
        let inserted = chains.vertices[..bucket.inserted].iter().map(|vertex| vertex.row(row));
        let chain = [candidate.start].into_iter().chain(inserted).chain([candidate.point]);
        let chain: Vec<DVec3> = chain.map(|v| DVec3::from(v.map(f64::from))).collect();
        let lane = candidate.lane as usize;
        let hero = flown.then(|| immersion.hero.rows()[lane] as usize);
        let through = factor(field, hero, &chain, purpose, &Draws::new(step, paths, lane));
        let before = worth.factor.row(row);
        worth.factor.set_row(row, core::array::from_fn(|c| (f64::from(before[c]) * through[c]) as f32));
    }
}

/// What the segments of a chain leave of light, over what weights take that for, per channel; relative to the `hero`'s
/// if its flights have got through.
pub fn factor(field: &Field, hero: Option<usize>, chain: &[DVec3], purpose: Purpose, draws: &Draws) -> [f64; CHANNELS] {
    let block = random::block(draws.depth, random::TRANSMITTANCE.nth(purpose.number()));
    let mut product = [1.0; CHANNELS];
    for (part, ends) in chain.windows(2).enumerate() {
        let stream = Stream::new(draws.pixel, draws.sample, block, draws.seed, part as u32);
        let through = estimate(field, hero, ends[0], ends[1], stream);
        product = core::array::from_fn(|c| product[c] * through[c]);
    }
    product
}

/// `T'_c e^{tau~_c}` of a segment; where there is a `hero`, of extinctions less that of the hero.
pub fn estimate(field: &Field, hero: Option<usize>, from: DVec3, to: DVec3, stream: Stream) -> [f64; CHANNELS] {
    if let Some(apart) = field.apart() {
        let mut found = [1.0; CHANNELS];
        for unknown in apart.transmittances().chain(apart.beyond_flights()).filter(|unknown| unknown.hero == hero) {
            let ([product], known) = transmittance(unknown.field, [1.0], from, to, stream);
            found[unknown.channel] = product * (unknown.depth_between(from, to) - known).exp();
        }
        return found;
    }
    let all = field.hues().map(f64::from);
    let hues = all.map(|hue| hue - hero.map_or(0.0, |hero| all[hero]));
    let medium = FieldTwin { field, hue: 1.0, phase: &HenyeyGreenstein { g: 0.0 } };
    let (products, known) = transmittance(field, hues, from, to, stream);
    let depth = medium.optical_depth(from, to);
    core::array::from_fn(|c| products[c] * (hues[c] * (depth - known)).exp())
}
