//! One segment of every path.

use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::outline::LOOKS;
use fogbow_kernels::random;

use super::{RaysOf, Source, Wavefront};
use crate::film::aov::Origin;

impl Wavefront<'_> {
    /// One segment of every live path, and everything that connects from its end.
    pub fn bounce(&mut self) {
        self.stats.segments += self.live.count() as u64;
        self.look_at_outlines();
        self.remember();
        self.fly();
        self.extend(RaysOf::Paths);
        self.glow();
        self.note_glow();
        self.hit_lights();
        self.prune();
        if self.live.is_empty() {
            self.step.clock += 1;
            return;
        }
        self.turn();
        self.step.clock += 1;
        if let Some(sums) = &mut self.stats.by_depth {
            self.live.each().for_each(|lane| sums.add_vertex(self.paths.depth_of(self.step.clock, lane)));
        }
        self.connect();
    }

    /// Draws the flights.
    pub fn fly(&mut self) {
        self.medium_sample();
        self.look_first();
        if self.frame.aims() && !self.requested.is_empty() {
            self.first_flight();
        }
    }

    /// Lamps in pixels that their outlines pass through are seen by many rays of each new sample.
    fn look_at_outlines(&mut self) {
        if self.outlined.is_empty() {
            return;
        }
        for cell in 0..LOOKS {
            self.outline(cell);
            self.extend(RaysOf::Looks);
            self.light_hit(RaysOf::Looks);
            self.count_views();
        }
    }

    /// What the camera sees of lights.
    fn count_views(&mut self) {
        let views = self.candidates.views.direct();
        self.transmittance(Source::Views, views, random::CAMERA);
        self.contribute(Origin::View, Source::Views, views);
    }

    /// Lights met on the way: weighed and counted before the other paths scatter.
    fn hit_lights(&mut self) {
        if self.hits.len == 0 {
            return;
        }
        self.light_hit(RaysOf::Paths);
        self.count_views();
        let bucket = self.candidates.light_hits.direct();
        self.mis_weight(Competing::All, Source::LightHits, bucket);
        self.transmittance(Source::LightHits, bucket, random::CAMERA);
        self.contribute(Origin::Path, Source::LightHits, bucket);
    }

    /// Takes every path to its next vertex and turns it there.
    pub fn turn(&mut self) {
        let aimed = self.frame.aims() && !self.requested.is_empty();
        if aimed && self.surface_hits.len > 0 {
            self.first_surface();
        }
        if self.frame.medium.is_coloured() {
            self.spectral_weight();
            self.flight_hue();
        } else if aimed {
            self.flight_weight();
        }
        self.scatter();
        if self.surface_hits.len > 0 {
            self.surface();
        }
        if self.frame.varies() && self.frame.techniques.any() {
            self.passage();
        }
    }
}
