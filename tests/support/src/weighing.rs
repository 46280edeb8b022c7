//! Complete paths put into tables and weighed by a mis_weight kernel of choice.

use bumpalo::Bump;
use fogbow_kernels::columns::Spectrum;
use fogbow_kernels::columns::paths::{LastSurfaceColumns, Outlook, OutlookColumns, PathColumns, Vertex, VertexColumns};
use fogbow_kernels::columns::queues::{Bucket, Candidate, CandidateQueue, ChainTable, WorthTable};
use fogbow_kernels::columns::trail::{Mark, TrailTable};
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::light_sample::reference::light_sum;
use fogbow_kernels::connect::suffix::Suffix;
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::media::Medium;
use fogbow_kernels::mis_weight::{self, Competing};
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::{PathLengths, Step, WalkLimits};
use glam::DVec3;

/// What paths are weighed in.
#[derive(Clone, Copy)]
pub struct Weigher<'a> {
    /// The kernel.
    pub kernel: mis_weight::Kernel,
    /// The medium.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// The active techniques.
    pub techniques: &'a Techniques,
    /// How far walks go.
    pub walk: WalkLimits,
    /// Which starts compete.
    pub competing: Competing,
    /// Longest path, in segments.
    pub longest: u32,
}

/// A complete path, and how it is told to have been made.
#[derive(Clone, Debug)]
pub struct Made<'a> {
    /// x_0 .. x_n.
    pub vertices: &'a [DVec3],
    /// Vertices inserted by a connection: 0 to n - 2.
    pub inserted: usize,
    /// First eligible start, >= 1.
    pub first_start: usize,
    /// Index of the light on which it ends.
    pub emitter: usize,
}

impl<'a> Weigher<'a> {
    /// Weighs with `kernel`, for walks that go on and paths of any length.
    pub fn new(kernel: mis_weight::Kernel, medium: &'a Medium, lights: &'a Lights, techniques: &'a Techniques) -> Self {
        Self { kernel, medium, lights, techniques, walk: WalkLimits::ALL, competing: Competing::All, longest: 1000 }
    }

    /// The weight of a path. It stands in `lane` of two batches; all other lanes are dead and hold NaN.
    pub fn weight(&self, made: &Made<'_>, lane: usize) -> f64 {
        let n = made.vertices.len() - 1;
        let depth = n - 1 - made.inserted;
        let step = Step { seed: 0, clock: 5000 };
        let arena = Bump::new();
        let lanes = 2 * LANES;
        let mut paths = PathColumns::new_in(&arena, lanes);
        let mut last_surface = LastSurfaceColumns::new_in(&arena, lanes);
        let mut outlook = OutlookColumns::new_in(&arena, lanes);
        let mut vertex = VertexColumns::new_in(&arena, lanes);
        let mut trail = TrailTable::new_in(&arena, lanes, n + 1);
        let chains = ChainTable::new_in(&arena, lanes, made.inserted);
        let mut suffix = Suffix::new_in(&arena, n);
        let mut candidates = CandidateQueue::new_in(&arena, LANES);
        let mut worth = WorthTable::new_in(&arena, LANES, 1);

        paths.birth.rows_mut()[lane] = step.clock - depth as u32;
        last_surface.depth.rows_mut()[lane] = made.first_start as u32;
        worth.weight.rows_mut().fill(f32::NAN);
        let f32s = |v: DVec3| v.as_vec3().to_array();
        vertex.position.channels_mut().into_iter().for_each(|channel| channel.rows_mut().fill(f32::NAN));
        for (lane, slot) in (0..lanes).flat_map(|lane| (0..=n as u32).map(move |slot| (lane, slot))) {
            trail.set_numbers(lane, slot, [f32::NAN; 8]);
        }
        let mut arc = 0.0;
        for j in 0..=depth {
            if j > 1 {
                arc += made.vertices[j].distance(made.vertices[j - 1]);
            }
            let [position, leaving] = [made.vertices[j], direction(made, j)].map(f32s);
            let (arc, light_sum) = (arc as f32, light_sum(self.lights, made.vertices[j]) as f32);
            let clock = step.clock - (depth - j) as u32;
            trail.set_row(lane, clock, Mark { position, arc, leaving, light_sum });
            if j == depth {
                vertex.set_row(lane, Vertex { position, arc });
                outlook.set_row(lane, Outlook { light_sum, first_near: 1 });
            }
        }
        for (vertex, position) in chains.vertices.iter_mut().zip(&made.vertices[depth + 1..n]) {
            vertex.channels_mut().into_iter().for_each(|channel| channel.rows_mut().fill(f32::NAN));
            vertex.set_row(0, f32s(*position));
        }
        candidates.push(Candidate {
            lane: lane as u32,
            emitter: made.emitter as u32,
            start: f32s(made.vertices[depth]),
            arriving: f32s(direction(made, depth - 1)),
            point: f32s(made.vertices[n]),
        });
        let columns = mis_weight::Columns {
            medium: self.medium,
            lights: self.lights,
            techniques: self.techniques,
            walk: &self.walk,
            competing: self.competing,
            lengths: PathLengths { min: 1, max: self.longest },
            solid: false,
            bucket: Bucket { inserted: made.inserted, start: 0, len: 1 },
            candidates: &candidates,
            chains: &chains,
            paths: &paths,
            log_posterior: &Spectrum::new_in(&arena, lanes, 1),
            last_surface: &last_surface,
            outlook: &outlook,
            vertex: &vertex,
            trail: &trail,
            passages: &[],
            passage_trails: &[],
            suffix: &mut suffix,
            worth: &mut worth,
        };
        (self.kernel)(step, columns);
        f64::from(worth.weight.rows()[0])
    }

    /// The sum of all ratios: `1 / weight - 1`.
    pub fn ratios(&self, made: &Made<'_>, lane: usize) -> f64 {
        1.0 / self.weight(made, lane) - 1.0
    }
}

fn direction(made: &Made<'_>, j: usize) -> DVec3 {
    (made.vertices[j + 1] - made.vertices[j]).normalize_or_zero()
}
