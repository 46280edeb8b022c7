//! What becomes of complete candidates, checked.

use super::*;

pub(super) fn check_roulette(
    medium: &Medium,
    lights: &Lights,
    threshold: Threshold,
    step: Step,
    columns: roulette::Columns<'_, '_>,
) {
    let roulette::Columns { bucket, candidates, paths } = columns;
    let (kernel, twin) = run_both!(
        roulette(medium, lights, threshold, step),
        [candidates],
        roulette::Columns { bucket, candidates: &mut *candidates, paths }
    );
    let (kernel, twin) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        let (weight, weight_twin) = (f64::from(kernel[at]), f64::from(twin[at]));
        let Tolerance { absolute, relative } = tolerances::CONTRIBUTION;
        if (weight == 0.0) != (weight_twin == 0.0) {
            count_decisions(1);
        } else if (weight - weight_twin).abs() > absolute + relative * weight {
            fail("roulette", at, &format!("    weight: kernel {weight:e}  twin {weight_twin:e}"));
        }
    }
}

pub(super) fn check_mis_weight(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &Walk,
    lengths: PathLengths,
    step: Step,
    columns: mis_weight::Columns<'_, '_>,
) {
    let mis_weight::Columns { bucket, candidates, chains, paths, vertices, trail, suffix } = columns;
    let (kernel, twin) = run_both!(
        mis_weight(medium, lights, techniques, walk, lengths, step),
        [candidates],
        mis_weight::Columns {
            bucket,
            candidates: &mut *candidates,
            chains,
            paths,
            vertices,
            trail,
            suffix: &mut *suffix
        }
    );
    let sight = Sight { bucket, candidates, chains, paths, vertices, trail, lights, step };
    let (kernel_weights, twin_weights) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        let (weight, weight_twin) = (f64::from(kernel_weights[at]), f64::from(twin_weights[at]));
        let conditioning = sight.conditioning(f64::from(medium.phase.g), at);
        let Tolerance { absolute, relative } = tolerances::WEIGHT;
        let largest = weight.max(weight_twin);
        if (weight == 0.0) != (weight_twin == 0.0) && largest > absolute {
            count_decisions(1);
        } else if (weight - weight_twin).abs() > absolute + (relative + conditioning) * largest {
            let text = format!(
                "    weight: kernel {weight:e}  twin {weight_twin:e}, {} inserted, conditioning {conditioning:e}\n    {:?}\n    {:?}",
                bucket.inserted,
                kernel.0.row(0, at),
                sight.path(at),
            );
            fail("mis_weight", at, &text);
        }
    }
}

/// The complete paths of candidates.
struct Sight<'a, 'q> {
    bucket: Bucket,
    candidates: &'a CandidateQueue<'q>,
    chains: &'a ChainTable<'q>,
    paths: &'a PathTable<'q>,
    vertices: &'a VertexTable<'q>,
    trail: &'a TrailTable<'q>,
    lights: &'a Lights,
    step: Step,
}

impl Sight<'_, '_> {
    /// Vertices from the camera, as far as it is remembered, to the light.
    fn path(&self, at: usize) -> Vec<glam::DVec3> {
        let lane = self.candidates.lane.rows()[at] as usize;
        let depth = self.paths.depth(self.step.clock, lane);
        let before = |back| position_before(self.vertices, self.trail, self.step, lane, back);
        let history = (1..=depth).rev().filter_map(before).map(|position| position.map(|x| x as f32));
        let inserted = self.chains.vertices[..self.bucket.inserted].iter().map(|vertex| vertex.row(at));
        let ends = [self.candidates.start.row(at), self.candidates.point.row(at)];
        let path = history.chain([ends[0]]).chain(inserted).chain([ends[1]]);
        path.map(|position| glam::DVec3::from(position.map(f64::from))).collect()
    }

    fn conditioning(&self, g: f64, at: usize) -> f64 {
        let path = self.path(at);
        let distance = path.iter().map(|position| position.length()).fold(0.0, f64::max);
        let shortest = path.windows(2).map(|ends| ends[0].distance(ends[1])).fold(f64::INFINITY, f64::min);
        let emitter = &self.lights.emitters()[self.candidates.emitter.rows()[at] as usize];
        let [before, point] = [path[path.len() - 2], path[path.len() - 1]];
        let cos_light = cosine(emitter, point, point - before);
        tolerances::weight_conditioning(g, distance, shortest, cos_light)
            + tolerances::cone_conditioning(emitter.window, distance, shortest, cos_light)
    }
}

pub(super) fn check_occlusion(lights: &Lights, surfaces: &Surfaces, columns: occlusion::Columns<'_, '_>) {
    let occlusion::Columns { bucket, candidates, chains } = columns;
    let before = candidates.weight.rows().to_vec();
    let (kernel, twin) = run_both!(
        occlusion(lights, surfaces),
        [candidates],
        occlusion::Columns { bucket, candidates: &mut *candidates, chains }
    );
    let (kernel, twin) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        if kernel[at].to_bits() != twin[at].to_bits() {
            count_decisions(1);
        }
        if kernel[at] != 0.0 && kernel[at].to_bits() != before[at].to_bits() {
            fail("occlusion", at, &format!("    a free connection's weight became {}", kernel[at]));
        }
    }
}

pub(super) fn check_accumulate(
    medium: &Medium,
    lights: &Lights,
    lengths: PathLengths,
    step: Step,
    columns: accumulate::Columns<'_, '_>,
) {
    let accumulate::Columns { bucket, candidates, paths, dropped } = columns;
    let (kernel, twin) = run_both!(
        accumulate(medium, lights, lengths, step),
        [paths, dropped],
        accumulate::Columns { bucket, candidates, paths: &mut *paths, dropped: &mut *dropped }
    );
    for lane in lanes(paths) {
        check_row("accumulate", (0, lane), (&kernel.0, &twin.0), &[("radiance", tolerances::CONTRIBUTION)]);
    }
    if kernel.1 != twin.1 {
        fail("accumulate", 0, &format!("    dropped {:?} and {:?}", kernel.1, twin.1));
    }
}
