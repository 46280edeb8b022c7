//! What layers of the film beside radiance ask for: what the camera sees first, and the light by how it was found.

use fogbow_kernels::columns::paths::Feature;
use fogbow_kernels::random;

use super::{RaysOf, Source, Wavefront};
use crate::film::aov::{Aov, Origin};
use crate::film::{MOST_LAYERS, Tile};

impl Wavefront<'_> {
    /// What the camera sees first along the rays of new samples, whose free flights have been drawn.
    pub(super) fn look_first(&mut self) {
        if !self.frame.aovs.see() || self.requested.is_empty() {
            return;
        }
        self.extend(RaysOf::First);
        self.features();
        if !self.frame.aovs.has(Aov::Transmittance) {
            return;
        }
        let bucket = self.candidates.views.direct();
        self.transmittance(Source::Views, bucket, random::FEATURES);
        for row in bucket.rows() {
            let (lane, through) = (self.candidates.views.lane.rows()[row] as usize, self.worth.factor.row(row));
            if through.iter().any(|channel| !channel.is_finite()) {
                self.stats.dropped.note(self.paths.pixel.rows()[lane], self.paths.sample.rows()[lane]);
            }
            self.features
                .transmittance
                .set_row(lane, through.map(|channel| if channel.is_finite() { channel } else { 0.0 }));
        }
    }

    /// Which of the parts by origin the light of this origin is; of no meaning where there are none.
    pub(super) fn part_of(&self, origin: Origin) -> usize {
        self.origins.iter().position(|other| *other == origin).unwrap_or(usize::MAX)
    }

    /// Hands what the path in `lane` has found to the pixel at `place`: the values of all layers, in the order of the
    /// film.
    pub(super) fn add_layers(&self, tile: &mut Tile, place: usize, lane: usize) {
        let aovs = &self.frame.aovs;
        let (mut values, mut count) = ([[0.0; 3]; MOST_LAYERS], 0);
        let mut push = |value: [f32; 3]| {
            values[count] = value;
            count += 1;
        };
        push(self.radiance.row(lane));
        if aovs.see() {
            let Feature { depth, hit, normal, albedo, transmittance, .. } = self.features.row(lane);
            let seen = [
                (Aov::Depth, [depth, hit, 0.0]),
                (Aov::Normal, normal),
                (Aov::Albedo, albedo),
                (Aov::Transmittance, transmittance),
            ];
            seen.into_iter().filter(|(aov, _)| aovs.has(*aov)).for_each(|(_, value)| push(value));
        }
        // Those that nothing asks for are not there.
        self.parts.origins.iter().chain(self.parts.lengths.iter()).for_each(|part| push(part.row(lane)));
        tile.add(place, &values[..count]);
    }
}
