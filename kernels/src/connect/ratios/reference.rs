//! The sum over techniques for one start, in f64.

use glam::DVec3;

use crate::PathLengths;
use crate::connect::density::Density;
use crate::connect::{Technique, Techniques, bridge, lis, mvnee, nee, omnee};
use crate::media::reference::Medium;
use crate::tables::lights::Emitter;

/// The rest of a path, from a start to a light with a place, as techniques see it.
pub struct Suffix<'a> {
    /// The medium.
    pub medium: &'a dyn Medium,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// The start, and how the path got there.
    pub from: bridge::reference::Start,
    /// Its vertices, from the start to the point on the light `[m]`.
    pub chain: &'a [DVec3],
    /// The emitter on which it ends.
    pub emitter: &'a Emitter,
    /// Normal of the emitter at that point.
    pub normal: DVec3,
    /// Density with which the start chooses that point [1/m^2].
    pub light_density: f64,
}

impl Suffix<'_> {
    /// The sum of the ratios of `techniques`: their densities over `traced`, that of path tracing.
    pub fn ratios(&self, techniques: &Techniques, traced: Density) -> f64 {
        Technique::ALL.into_iter().map(|technique| self.ratio(techniques, technique, traced)).sum()
    }

    /// That of one of them; 0 if it is not active.
    fn ratio(&self, techniques: &Techniques, technique: Technique, traced: Density) -> f64 {
        let Self { medium, lengths, from, chain, emitter, normal, light_density } = *self;
        let Techniques { nee, mvnee, omnee, bridge, lis } = techniques;
        match technique {
            Technique::Nee if *nee => nee::reference::density(chain, normal, light_density).over(traced),
            Technique::Omnee if *omnee && from.depth <= omnee::scope(lengths).max_depth => {
                omnee::reference::density(medium.phase(), chain, light_density).over(traced)
            }
            Technique::Nee | Technique::Omnee => 0.0,
            Technique::Mvnee => mvnee.as_ref().map_or(0.0, |mvnee| {
                mvnee::reference::density(&mvnee.into(), medium, chain, light_density).over(traced)
            }),
            Technique::Bridge => bridge.as_ref().map_or(0.0, |bridge| {
                bridge::reference::density(bridge, medium, lengths.max, &from, chain, light_density).over(traced)
            }),
            Technique::Lis => lis.as_ref().map_or(0.0, |lis| {
                let companion = || lis::reference::companion_density(lis, chain, normal, light_density).over(traced);
                let density = lis::reference::density(lis, medium, emitter, lengths.max, &from, chain, light_density);
                density.over(traced) + techniques.companion().map_or(0.0, |_| companion())
            }),
        }
    }
}
