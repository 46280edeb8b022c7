//! The weight of a complete path x_0 .. x_n, from full densities in f64.
//!
//! From start i, path tracing makes x_{i+1} .. x_n with density (volume and area measure)
//!
//! ```text
//! p_PT(i) = prod_{j=i..n-1} phase(c_j) exp(-tau_j) / l_j^2 * (mu_t(x_{j+1}), or cos_light for j = n - 1)
//! ```
//!
//! where l_j is the length and tau_j the optical depth of the segment from x_j to x_{j+1}, and c_j the cosine of the
//! turn at x_j. With p_k(i) for the density of technique k doing the same, the balance heuristic (Veach and Guibas
//! 1995) gives, whichever technique made the path,
//!
//! ```text
//! weight = 1 / (reach(n) + sum over starts i of reach(i) * sum over techniques k of p_k(i) / p_PT(i))
//! reach(i) = prod_{j=1..i-1} survival(j);      reach(n) = 0 if walks end before they have n segments
//! ```
//!
//! times the profile of the light: 1, or `(k + 1) / (2 pi) cos^k theta` of a spotlight with exponent k, or
//! `clamp(a cos theta + b, 0, 1)^2 / cos theta` of one with a cone.
//!
//! **Colour.** Where extinction differs between channels, everything above is so for one channel c, of weight 1 / D_c.
//! Of what the walk brought to its vertex x_s, the share posterior_c was drawn for that channel. With w_c for
//! posterior_c times the density of free walks along x_s .. x_n, and * for the channel of the largest,
//!
//! ```text
//! weight = w_* / (posterior_* sum_c w_c D_c),      factor_k = albedo_k^m (w_k / posterior_k) / (w_* / posterior_*)
//! ```
//!
//! Connections are drawn for that channel, too, or for the mean of channels where these are
//! [apart](crate::media::field::Apart).
//!
//! **Lights at infinity.** One technique connects with them, next event estimation of their own, from the last vertex
//! alone, whatever starts the others have: the sum is its only ratio. Factors are multiplied by the colour of an image.
//!
//! Starts run from the first eligible vertex to x_{n-1}, but are no more than the walk's `starts`; or the current vertex
//! alone competes with the walk. A path that nothing makes weighs nothing; of one that neither of these two makes, the
//! bound is infinite.

use core::f64::consts::PI;

use glam::DVec3;

use super::{Columns, Competing};
use crate::columns::trail::TrailTable;
use crate::connect::density::Density;
use crate::connect::light_sample::reference::light_density;
use crate::connect::{Techniques, bridge, distant, ratios};
use crate::emission::reference::{normal, profile};
use crate::media::Medium;
use crate::media::reference::{self, Medium as _};
use crate::media::spectral::CHANNELS;
use crate::survival::Survival;
use crate::tables::lights::Lights;
use crate::{PathLengths, Step, WalkLimits};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, techniques, walk, competing, lengths, solid, bucket, candidates, .. } = columns;
    let Columns { chains, paths, log_posterior, last_surface, trail, worth, .. } = columns;
    let competition = Competition { medium, lights, techniques, walk, competing, lengths };
    let mut path = Vec::new();
    for row in bucket.rows() {
        let candidate = candidates.row(row);
        let lane = candidate.lane as usize;
        let [start, arriving, point] =
            [candidate.start, candidate.arriving, candidate.point].map(|v| DVec3::from(v.map(f64::from)));
        path.clear();
        for back in (1..=paths.depth_of(step.clock, lane)).rev() {
            let unknown = if back == 1 { start - arriving } else { DVec3::NAN };
            path.push(position_before(trail, step, lane, back).map_or(unknown, DVec3::from));
        }
        path.push(start);
        for vertex in &chains.vertices[..bucket.inserted] {
            path.push(DVec3::from(vertex.row(row).map(f64::from)));
        }
        path.push(point);
        let is_surface = solid && last_surface.depth.rows()[lane] > 0;
        let path = CompletePath {
            vertices: &path,
            first_start: last_surface.first_start(lane) as usize,
            surface: is_surface.then(|| DVec3::from(last_surface.normal.row(lane).map(f64::from))),
            emitter: candidate.emitter as usize,
            current: path.len() - 2 - bucket.inserted,
            log_posterior: if medium.is_coloured() { log_posterior.row(lane).map(f64::from) } else { [0.0; CHANNELS] },
        };
        let Worth { weight, factor } = competition.worth(&path);
        worth.weight.rows_mut()[row] = weight as f32;
        let resampling = if bucket.inserted > 0 { f64::from(chains.resampling.rows()[row]) } else { 1.0 };
        worth.factor.set_row(row, factor.map(|channel| (channel * resampling) as f32));
    }
}

/// Where a path was `back` >= 1 vertices before the current one, if it remembers.
///
/// Without a trail no active technique starts earlier than at the current vertex. Of the vertex before it, only the
/// direction then matters in which the path left, which the candidate knows; NaN in the place of the others does not
/// reach the weight.
pub fn position_before(trail: &TrailTable<'_>, step: Step, lane: usize, back: u32) -> Option<[f64; 3]> {
    let remembered = (back as usize) < trail.slots();
    remembered.then(|| trail.row(lane, step.clock - back).position.map(f64::from))
}

/// The share of light that inserted vertices leave, per channel: one albedo each.
pub fn factor(medium: &Medium, inserted: &[DVec3]) -> [f64; 3] {
    let albedos = inserted.iter().map(|vertex| medium.albedo_at(*vertex));
    albedos.fold([1.0; 3], |product, albedo| core::array::from_fn(|c| product[c] * albedo[c]))
}

/// A complete path x_0 .. x_n.
#[derive(Clone, Copy, Debug)]
pub struct CompletePath<'a> {
    /// Vertices from the camera to the point on the emitter `[m]`.
    pub vertices: &'a [DVec3],
    /// First vertex that may start a connection, 1 <= `first_start` < n.
    pub first_start: usize,
    /// Normal of the surface that the first start is on, if it is on one.
    pub surface: Option<DVec3>,
    /// Index of the emitter on which the path ends.
    pub emitter: usize,
    /// The vertex that the walk has come to: those after it, but for the last, were inserted.
    pub current: usize,
    /// ln of the probability that the walk up to there was drawn for a channel, where extinction is coloured.
    pub log_posterior: [f64; CHANNELS],
}

/// What a path counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worth {
    /// One over the sum of all densities, relative to those of free walks in the channel in which they are largest.
    pub weight: f64,
    /// What the throughput leaves out, per channel.
    pub factor: [f64; CHANNELS],
}

/// All that competes for a path.
#[derive(Clone, Copy, Debug)]
pub struct Competition<'a> {
    /// The medium.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// The active techniques.
    pub techniques: &'a Techniques,
    /// How far walks go, and where they connect from.
    pub walk: &'a WalkLimits,
    /// Which starts compete.
    pub competing: Competing,
    /// The path lengths that count.
    pub lengths: PathLengths,
}

impl Competition<'_> {
    /// What a path counts.
    pub fn worth(&self, path: &CompletePath<'_>) -> Worth {
        let worth = self.worth_of_white(path);
        let [.., before, point] = path.vertices else {
            return worth;
        };
        let colour = distant::reference::colour(self.lights, path.emitter, *point - *before);
        Worth { factor: [0, 1, 2].map(|channel| worth.factor[channel] * colour[channel]), ..worth }
    }

    /// The same if its light were the same in all channels and directions.
    fn worth_of_white(&self, path: &CompletePath<'_>) -> Worth {
        let CompletePath { vertices, current, log_posterior, .. } = *path;
        let inserted = &vertices[current + 1..vertices.len() - 1];
        let albedos = factor(self.medium, inserted);
        if inserted.iter().any(|vertex| self.medium.own_twin().extinction(*vertex) == 0.0) {
            // Nothing scatters there.
            return Worth { weight: 0.0, factor: albedos };
        }
        if !self.medium.is_coloured() {
            return Worth { weight: self.weight(path, self.sum(path, 0)), factor: albedos };
        }
        let walked = [0, 1, 2].map(|channel| free_walk(&self.medium.twin(channel), &vertices[current..]));
        let joint = [0, 1, 2].map(|channel| walked[channel].times_exp(log_posterior[channel]));
        let own = [1, 2]
            .into_iter()
            .fold(0, |own, channel| if joint[channel].over(joint[own]) > 1.0 { channel } else { own });
        let sum: f64 = (0..CHANNELS).map(|channel| joint[channel].over(walked[own]) * self.sum(path, channel)).sum();
        Worth {
            weight: self.weight(path, sum),
            factor: [0, 1, 2].map(|channel| albedos[channel] * walked[channel].over(walked[own])),
        }
    }

    /// The weight of a path of this sum of densities.
    fn weight(&self, path: &CompletePath<'_>, sum: f64) -> f64 {
        let profile = self.profile(path);
        if profile == 0.0 || sum == 0.0 && self.competing == Competing::All { 0.0 } else { profile / sum }
    }

    /// The profile of the light at the end of a path that arrives at its front and leaves its first start outwards; or
    /// else 0.
    fn profile(&self, path: &CompletePath<'_>) -> f64 {
        let CompletePath { vertices, first_start, surface, emitter, .. } = *path;
        let [.., before, point] = vertices else {
            return 0.0;
        };
        let leaving = vertices[first_start + 1] - vertices[first_start];
        if surface.is_some_and(|normal| leaving.dot(normal) <= 0.0) {
            return 0.0;
        }
        profile(&self.lights.emitters()[emitter], *point, *point - *before)
    }

    /// reach(n) and the densities of all techniques, over that of path tracing, where all is as in one channel.
    fn sum(&self, path: &CompletePath<'_>, channel: usize) -> f64 {
        let CompletePath { vertices, first_start, .. } = *path;
        let segments = vertices.len() - 1;
        // No connection makes more vertices than that; what is farther away may be forgotten.
        let nearest = segments.saturating_sub(self.techniques.most_inserted(self.lengths.max) + 1);
        let (first, end) = (first_start.max(nearest), first_start.saturating_add(self.walk.starts as usize));
        let starts = match self.competing {
            Competing::All => first..segments.min(end),
            Competing::Own => path.current..path.current + 1,
        };
        let walked = if segments <= self.walk.segments as usize { reach(self.walk, segments) } else { 0.0 };
        if self.lights.distant_of(path.emitter as u32).is_some() {
            return walked + reach(self.walk, segments - 1) * self.distant_ratio(path, channel);
        }
        let connected: f64 = starts.map(|start| reach(self.walk, start) * self.ratios(path, start, channel)).sum();
        walked + connected
    }

    /// The ratio of connections with a light at infinity for a path that ends on one, in one channel.
    fn distant_ratio(&self, path: &CompletePath<'_>, channel: usize) -> f64 {
        let Self { medium, lights, techniques, .. } = *self;
        let [.., before, point] = path.vertices else {
            return 0.0;
        };
        let start = path.vertices.len() - 2;
        if !techniques.any() || start != path.current {
            return 0.0;
        }
        let surface = path.surface.filter(|_| start == path.first_start);
        let facing = (*before - *point).normalize();
        let Some(traced) = path_tracing_density(&medium.twin(channel), path.vertices, start, surface, facing) else {
            return 0.0;
        };
        distant::reference::density(lights, path.emitter, *before, *point).over(traced)
    }

    /// The sum of all techniques' ratios r_i for the vertex `start` of a path, in one channel.
    pub(super) fn ratios(&self, path: &CompletePath<'_>, start: usize, channel: usize) -> f64 {
        let Self { medium, lights, techniques, lengths, .. } = *self;
        let vertices = path.vertices;
        let surface = path.surface.filter(|_| start == path.first_start);
        let (walked, connected) = (medium.twin(channel), medium.twin_of_connections(channel));
        let [.., before, point] = vertices else {
            return 0.0;
        };
        let emitter = &lights.emitters()[path.emitter];
        let normal = normal(emitter, *point, *point - *before);
        let Some(traced) = path_tracing_density(&walked, vertices, start, surface, normal) else {
            return 0.0;
        };
        let (position, arriving) = (vertices[start], (vertices[start] - vertices[start - 1]).normalize());
        let suffix = ratios::reference::Suffix {
            medium: &connected,
            lengths,
            from: bridge::reference::Start { depth: start as u32, position, arriving, on_surface: surface.is_some() },
            chain: &vertices[start..],
            emitter,
            normal,
            light_density: light_density(lights, path.emitter, position),
        };
        suffix.ratios(techniques, traced)
    }
}

/// Probability that a walk survives all vertices between the camera and vertex `i`.
pub fn reach(walk: &WalkLimits, i: usize) -> f64 {
    match walk.survival {
        Survival::Constant(survival) => f64::from(survival).powi(i as i32 - 1),
        by_octave @ Survival::ByOctave(_) => (1..i as u32).map(|depth| f64::from(by_octave.at(depth))).product(),
    }
}

/// Density of free flights that end at the vertices of a walk after its first, but for the last one, which is on a
/// light.
pub fn free_walk(medium: &dyn reference::Medium, walk: &[DVec3]) -> Density {
    let mut density = Density::new(1.0);
    for j in 1..walk.len() {
        let event = if j + 1 < walk.len() { medium.event(walk[j]) } else { 1.0 };
        density = density.times(event).times_exp(-medium.optical_depth(walk[j - 1], walk[j]));
    }
    density
}

/// Density with which path tracing, at vertex `start`, makes the rest of `path`, which ends on a light that faces
/// `normal`; the start is on a surface of the normal `surface`, or in the medium. None if it cannot: in vacuum, or
/// where a segment has no length and so no direction.
pub fn path_tracing_density(
    medium: &dyn reference::Medium,
    path: &[DVec3],
    start: usize,
    surface: Option<DVec3>,
    normal: DVec3,
) -> Option<Density> {
    let mut density = Density::new(1.0);
    let mut arriving = (path[start] - path[start - 1]).try_normalize()?;
    for j in start..path.len() - 1 {
        let edge = path[j + 1] - path[j];
        let length = edge.length();
        let leaving = edge.try_normalize()?;
        let ends_on_light = j + 2 == path.len();
        density = density
            .times(match surface {
                Some(normal) if j == start => leaving.dot(normal).max(0.0) / PI,
                _ => medium.phase().density(arriving.dot(leaving)),
            })
            .times_exp(-medium.optical_depth(path[j], path[j + 1]))
            .times(1.0 / (length * length))
            .times(if ends_on_light { (-leaving.dot(normal)).max(0.0) } else { medium.event(path[j + 1]) });
        arriving = leaving;
    }
    (!density.is_zero()).then_some(density)
}
