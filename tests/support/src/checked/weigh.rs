//! What becomes of complete candidates, checked.

use super::*;

pub(super) fn check_sift(step: Step, columns: sift::Columns<'_, '_>) {
    let sift::Columns { medium, lights, bucket, candidates, chains, worth } = columns;
    let [both] = run_both!(
        sift(step),
        [worth],
        sift::Columns { medium, lights, bucket, candidates, chains, worth: &mut *worth }
    );
    let [kernel, twin] = [&both.0, &both.1].map(|saved| saved.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        if kernel[at] != twin[at] {
            count_decisions(1);
        }
    }
}

pub(super) fn check_mis_weight(step: Step, columns: mis_weight::Columns<'_, '_>) {
    let mis_weight::Columns { medium, lights, techniques, walk, competing, lengths, solid, bucket, .. } = columns;
    let mis_weight::Columns { candidates, chains, paths, log_posterior, last_surface, outlook, vertex, .. } = columns;
    let mis_weight::Columns { trail, passages, passage_trails, suffix, worth, .. } = columns;
    let [both] = run_both!(
        mis_weight(step),
        [worth],
        mis_weight::Columns {
            medium,
            lights,
            techniques,
            walk,
            competing,
            lengths,
            solid,
            bucket,
            candidates,
            chains,
            paths,
            log_posterior,
            last_surface,
            outlook,
            vertex,
            trail,
            passages,
            passage_trails,
            suffix: &mut *suffix,
            worth: &mut *worth,
        }
    );
    let sight = Sight { bucket, candidates, chains, paths, trail, lights, step };
    let [weights, weights_twin] = [&both.0, &both.1].map(|saved| saved.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        let (weight, weight_twin) = (f64::from(weights[at]), f64::from(weights_twin[at]));
        let conditioning = sight.conditioning(sharpest(medium), at);
        let Tolerance { absolute, relative } = tolerances::WEIGHT;
        let largest = weight.max(weight_twin);
        let [brings, brings_twin] = [&both.0, &both.1].map(|saved| brings(saved, at));
        count_worth(brings, brings_twin);
        if (weight == 0.0) != (weight_twin == 0.0) && largest > absolute {
            count_disputed(brings, brings_twin);
        } else if medium.is_coloured() && weight != 0.0 {
            // Where two channels are as likely, kernel and twin may weigh by another one: all together is the same.
            let [factor, factor_twin] = [&both.0, &both.1].map(|saved| saved.vector("factor", at));
            for (factor, factor_twin) in factor.into_iter().zip(factor_twin) {
                let (found, expected) = (weight * f64::from(factor), weight_twin * f64::from(factor_twin));
                if (found - expected).abs() > absolute + (relative + conditioning) * found.max(expected) {
                    if medium.field().is_some() {
                        count_disputed(brings, brings_twin);
                        break;
                    }
                    let text = format!(
                        "    worth: kernel {weight:e} {factor:e}  twin {weight_twin:e} {factor_twin:e}, {} inserted\n    \
                         log posterior {:?}\n    {:?}",
                        bucket.inserted,
                        log_posterior.row(candidates.lane.rows()[at] as usize),
                        sight.path(at),
                    );
                    fail("mis_weight", at, &text);
                }
            }
        } else if (weight - weight_twin).abs() > absolute + (relative + conditioning) * largest {
            if medium.field().is_some() {
                // A cell of the coarse field is a decision.
                count_disputed(brings, brings_twin);
                continue;
            }
            let text = format!(
                "    weight: kernel {weight:e}  twin {weight_twin:e}, {} inserted, conditioning {conditioning:e}\n    {:?}\n    {:?}",
                bucket.inserted,
                candidates.row(at),
                sight.path(at),
            );
            fail("mis_weight", at, &text);
        }
    }
    if medium.is_coloured() {
        return;
    }
    let mut factors = both;
    factors.0.forget("weight");
    factors.1.forget("weight");
    for at in bucket.rows() {
        check_row("mis_weight", (0, at), &factors, &[("factor", tolerances::CONTRIBUTION)]);
    }
}

/// What a candidate brings that has been weighed, in its brightest channel.
fn brings(worth: &Saved, at: usize) -> f64 {
    let brightest = worth.vector("factor", at).into_iter().fold(0.0, f32::max);
    f64::from(worth.vector("weight", at)[0]) * f64::from(brightest)
}

/// Largest |g| of the lobes of a medium.
pub(super) fn sharpest(medium: &Medium) -> f64 {
    medium.phase.twin().roll_lobes().into_iter().fold(0.0, |largest, (_, g)| g.abs().max(largest))
}

/// The complete paths of candidates.
struct Sight<'a, 'q> {
    bucket: Bucket,
    candidates: &'a CandidateQueue<'q>,
    chains: &'a ChainTable<'q>,
    paths: &'a PathColumns<'q>,
    trail: &'a TrailTable<'q>,
    lights: &'a Lights,
    step: Step,
}

impl Sight<'_, '_> {
    /// Vertices from the camera, as far as it is remembered, to the light.
    fn path(&self, at: usize) -> Vec<glam::DVec3> {
        let lane = self.candidates.lane.rows()[at] as usize;
        let depth = self.paths.depth_of(self.step.clock, lane).min(self.trail.slots() as u32);
        let history = (1..=depth).rev().map(|back| self.trail.row(lane, self.step.clock - back).position);
        let inserted = self.chains.vertices[..self.bucket.inserted].iter().map(|vertex| vertex.row(at));
        let ends = [self.candidates.start.row(at), self.candidates.point.row(at)];
        let path = history.chain([ends[0]]).chain(inserted).chain([ends[1]]);
        path.map(|position| glam::DVec3::from(position.map(f64::from))).collect()
    }

    /// Whether the light is at infinity, where rounding of the last vertex is that of a direction.
    fn is_distant(&self, at: usize) -> bool {
        self.lights.distant_of(self.candidates.emitter.rows()[at]).is_some()
    }

    fn conditioning(&self, g: f64, at: usize) -> f64 {
        let path = self.path(at);
        let near = &path[..path.len() - usize::from(self.is_distant(at))];
        let distance = near.iter().map(|position| position.length()).fold(0.0, f64::max);
        let shortest = near.windows(2).map(|ends| ends[0].distance(ends[1])).fold(f64::INFINITY, f64::min);
        let emitter = self.candidates.emitter.rows()[at] as usize;
        let ends = [path[path.len() - 2], path[path.len() - 1]];
        conditioning(self.lights, emitter, ends, g, [distance, shortest])
    }
}

/// Relative error of a weight of a path that ends with a segment between `ends`, whose vertices are up to `distance`
/// from the origin and at least `shortest` from each other.
pub(super) fn conditioning(
    lights: &Lights,
    emitter: usize,
    [before, point]: [glam::DVec3; 2],
    g: f64,
    [distance, shortest]: [f64; 2],
) -> f64 {
    let emitter = &lights.emitters()[emitter];
    let cos_light = cosine(emitter, point, point - before);
    tolerances::weight_conditioning(g, distance, shortest, cos_light / (1.0 + f64::from(emitter.exponent)))
        + tolerances::cone_conditioning(emitter.window, distance, shortest, cos_light)
}

pub(super) fn check_phase_quotient(step: Step, columns: phase_quotient::Columns<'_, '_>) {
    let phase_quotient::Columns { medium, solid, bucket, candidates, chains, paths, last_surface, worth } = columns;
    let [both] = run_both!(
        phase_quotient(step),
        [worth],
        phase_quotient::Columns { medium, solid, bucket, candidates, chains, paths, last_surface, worth: &mut *worth }
    );
    let counts = both.0.reals("weight");
    for at in bucket.rows().filter(|at| counts[*at] != 0.0) {
        check_found((0, at), &both, &[("factor", tolerances::QUOTIENT)]);
    }
}

pub(super) fn check_roulette(step: Step, columns: roulette::Columns<'_, '_>) {
    let roulette::Columns { lights, threshold, bucket, candidates, paths, throughput, worth } = columns;
    let [both] = run_both!(
        roulette(step),
        [worth],
        roulette::Columns { lights, threshold, bucket, candidates, paths, throughput, worth: &mut *worth }
    );
    let [kernel, twin] = [&both.0, &both.1].map(|saved| saved.reals("weight"));
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

pub(super) fn check_occlusion(step: Step, columns: occlusion::Columns<'_, '_>) {
    let occlusion::Columns { lights, surfaces, bucket, candidates, chains, worth } = columns;
    let before = worth.save();
    let [both] = run_both!(
        occlusion(step),
        [worth],
        occlusion::Columns { lights, surfaces, bucket, candidates, chains, worth: &mut *worth }
    );
    for at in bucket.rows() {
        count_rows(1);
        let [before, kernel, twin] = [&before, &both.0, &both.1].map(|saved| saved.row(0, at));
        if kernel != twin {
            count_decisions(1);
        }
        let free = both.0.vector("factor", at).into_iter().any(|factor| factor != 0.0);
        if free && kernel != before {
            fail("occlusion", at, &format!("    what a free connection counts became {kernel:?}"));
        }
    }
}

pub(super) fn check_transmittance(step: Step, columns: transmittance::Columns<'_, '_>) {
    let transmittance::Columns { field, flown, bucket, purpose, candidates, chains, .. } = columns;
    let transmittance::Columns { paths, immersion, estimates, worth, .. } = columns;
    let [both] = run_both!(
        transmittance(step),
        [worth],
        transmittance::Columns {
            field,
            flown,
            bucket,
            purpose,
            candidates,
            chains,
            paths,
            immersion,
            estimates: &mut *estimates,
            worth: &mut *worth,
        }
    );
    let counts = both.0.reals("weight");
    for at in bucket.rows().filter(|at| counts[*at] != 0.0) {
        check_found((0, at), &both, &[("factor", tolerances::ESTIMATE)]);
    }
}

pub(super) fn check_accumulate(step: Step, columns: accumulate::Columns<'_, '_>) {
    let accumulate::Columns { lights, lengths, bucket, candidates, worth, paths, throughput, .. } = columns;
    let accumulate::Columns { radiance, origin, parts, dropped, .. } = columns;
    let [radiance_both, parts_both, dropped_both] = run_both!(
        accumulate(step),
        [radiance, parts, dropped],
        accumulate::Columns {
            lights,
            lengths,
            bucket,
            candidates,
            worth,
            paths,
            throughput,
            radiance: &mut *radiance,
            origin,
            parts: &mut *parts,
            dropped: &mut *dropped,
        }
    );
    for lane in 0..radiance.channels()[0].rows().len() {
        check_row("accumulate", (0, lane), &radiance_both, &[("channels", tolerances::CONTRIBUTION)]);
        check_row("accumulate", (0, lane), &parts_both, &[("channels", tolerances::CONTRIBUTION)]);
    }
    if dropped_both.0 != dropped_both.1 {
        fail("accumulate", 0, &format!("    dropped {:?} and {:?}", dropped_both.0, dropped_both.1));
    }
}
