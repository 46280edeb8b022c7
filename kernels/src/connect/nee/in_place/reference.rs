//! One vertex after the other, in f64: the twins of the three stages that it stands for.

use glam::DVec3;

use super::Columns;
use crate::accumulate::reference::{add, contribution, used};
use crate::connect::Techniques;
use crate::connect::light_sample::reference as light_sample;
use crate::connect::nee::SCOPE;
use crate::media::spectral::CHANNELS;
use crate::mis_weight::reference::{Competition, CompletePath, Worth};
use crate::{LONGEST_PATH, PathLengths, Step};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, walk, live, paths, vertex, before, throughput, .. } = columns;
    let Columns { radiance, dropped, tally, .. } = columns;
    let techniques = &Techniques { nee: true, ..Techniques::default() };
    let competition =
        Competition { medium, lights, techniques, walk, lengths: PathLengths { min: 1, max: LONGEST_PATH } };
    for lane in live.each() {
        let depth = paths.depth_of(step.clock, lane) as usize;
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let [start, arriving] =
            [vertex.position.row(lane), before.direction.row(lane)].map(|v| DVec3::from(v.map(f64::from)));
        let u = light_sample::uniforms(pixel, sample, depth as u32, SCOPE.purpose, step.seed);
        let Some((emitter, point)) = light_sample::connect(lights, SCOPE, start, u) else { continue };
        let mut vertices = vec![DVec3::NAN; depth - 1];
        vertices.extend([start - arriving, start, point]);
        let path = CompletePath {
            vertices: &vertices,
            first_start: 1,
            surface: None,
            emitter,
            current: depth,
            log_posterior: [0.0; CHANNELS],
        };
        let Worth { weight, factor } = competition.worth(&path);
        tally.tried += 1;
        tally.weighted += u64::from(weight != 0.0);
        let emitted = lights.emitters()[emitter].radiance.map(f64::from);
        let found = contribution(weight, factor, emitted, throughput.row(lane).map(f64::from));
        match used(&found, radiance) {
            Some(used) => add(radiance, lane, used),
            None => dropped.note(pixel, sample),
        }
    }
}
