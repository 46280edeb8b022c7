//! One vertex after the other, in f64: the twins of the stages that it stands for.

use glam::DVec3;

use super::Columns;
use crate::accumulate::reference::{add, contribution, used};
use crate::columns::queues::Candidate;
use crate::connect::Techniques;
use crate::connect::light_sample::reference as light_sample;
use crate::connect::nee::SCOPE;
use crate::media::spectral::CHANNELS;
use crate::mis_weight::Competing;
use crate::mis_weight::reference::{Competition, CompletePath, Worth};
use crate::roulette::reference as roulette;
use crate::{LONGEST_PATH, PathLengths, Step};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, walk, live, paths, last_surface, solid, vertex, before, throughput, .. } = columns;
    let Columns { blocked, threshold, radiance, candidates, worth, dropped, tally, .. } = columns;
    let techniques = &Techniques { nee: true, ..Techniques::default() };
    let competition = Competition {
        medium,
        lights,
        techniques,
        walk,
        competing: Competing::All,
        lengths: PathLengths { min: 1, max: LONGEST_PATH },
    };
    for lane in live.each() {
        let depth = paths.depth_of(step.clock, lane) as usize;
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let [start, arriving] =
            [vertex.position.row(lane), before.direction.row(lane)].map(|v| DVec3::from(v.map(f64::from)));
        let u = light_sample::uniforms(pixel, sample, depth as u32, SCOPE.purpose, step.seed);
        let Some((emitter, point)) = light_sample::connect(lights, SCOPE, start, u) else { continue };
        let mut vertices = vec![DVec3::NAN; depth - 1];
        vertices.extend([start - arriving, start, point]);
        let is_surface = solid && last_surface.depth.rows()[lane] > 0;
        let path = CompletePath {
            vertices: &vertices,
            first_start: if solid { last_surface.first_start(lane) as usize } else { 1 },
            surface: is_surface.then(|| DVec3::from(last_surface.normal.row(lane).map(f64::from))),
            emitter,
            current: depth,
            log_posterior: [0.0; CHANNELS],
        };
        let Worth { mut weight, factor } = competition.worth(&path);
        tally.tried += 1;
        tally.weighted += u64::from(weight != 0.0);
        let emitted = lights.emitters()[emitter].radiance.map(f64::from);
        let brought = |weight: f64| contribution(weight, factor, emitted, throughput.row(lane).map(f64::from));
        if let Some(threshold) = threshold {
            let brightest = roulette::largest(&brought(weight)[..throughput.channels().len()]);
            let survival = roulette::survival(f64::from(threshold.contribution), brightest);
            let u = roulette::uniform(pixel, sample, depth as u32, threshold.purpose, step.seed);
            weight = if u < survival { weight / survival } else { 0.0 };
        }
        tally.kept += u64::from(weight != 0.0);
        if !blocked {
            match used(&brought(weight), radiance) {
                Some(used) => add(radiance, lane, used),
                None => dropped.note(pixel, sample),
            }
        } else if weight != 0.0 {
            worth.weight.rows_mut()[candidates.len] = weight as f32;
            worth.factor.set_row(candidates.len, factor.map(|channel| channel as f32));
            candidates.push(Candidate {
                lane: lane as u32,
                emitter: emitter as u32,
                start: vertex.position.row(lane),
                arriving: before.direction.row(lane),
                point: point.to_array().map(|component| component as f32),
            });
        }
    }
}
