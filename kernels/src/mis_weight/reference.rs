//! The weight of a complete path x_0 .. x_n, from full densities in f64.
//!
//! From start i, path tracing makes x_{i+1} .. x_n with density (volume and area measure)
//!
//! ```text
//! p_PT(i) = prod_{j=i..n-1} phase(c_j) exp(-mu_t l_j) / l_j^2 * (mu_t, or cos_light for j = n - 1)
//! ```
//!
//! where l_j is the length of the segment from x_j to x_{j+1} and c_j the cosine of the turn at x_j. With p_k(i) for
//! the density of technique k doing the same, the balance heuristic (Veach and Guibas 1995) gives, whichever technique
//! made the path,
//!
//! ```text
//! weight = 1 / (reach(n) + sum over starts i of reach(i) * sum over techniques k of p_k(i) / p_PT(i))
//! reach(i) = survival^{i-1};      reach(n) = 0 if walks end before they have n segments
//! ```
//!
//! times the profile of the light: 1, or `(k + 1) / (2 pi) cos^k theta` of a spotlight with exponent k.
//!
//! Starts run from the first eligible vertex to x_{n-1}, but are no more than the walk's `starts`. A path that nothing
//! makes weighs nothing.

use core::f64::consts::PI;

use glam::DVec3;

use super::Columns;
use crate::columns::paths::VertexTable;
use crate::columns::trail::TrailTable;
use crate::connect::light_sample::reference::{cosine, light_density, normal};
use crate::connect::{Techniques, bridge, lis, mvnee, nee, omnee};
use crate::phase::reference as phase;
use crate::tables::lights::{Emitter, Lights};
use crate::tables::media::Medium;
use crate::{PathLengths, Step, Walk};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &Walk,
    lengths: PathLengths,
    step: Step,
    columns: Columns<'_, '_>,
) {
    let Columns { bucket, candidates, chains, paths, vertices, trail, suffix: _ } = columns;
    let mut path = Vec::new();
    for row in bucket.rows() {
        let lane = candidates.lane.rows()[row] as usize;
        path.clear();
        for back in (1..=paths.depth(step.clock, lane)).rev() {
            path.push(position_before(vertices, trail, step, lane, back).map_or(DVec3::NAN, DVec3::from));
        }
        path.push(DVec3::from(candidates.start.row(row).map(f64::from)));
        for vertex in &chains.vertices[..bucket.inserted] {
            path.push(DVec3::from(vertex.row(row).map(f64::from)));
        }
        path.push(DVec3::from(candidates.point.row(row).map(f64::from)));
        let light = candidates.light.rows()[row] as usize;
        let first_start = paths.first_start(lane) as usize;
        let normal = paths.columns.surface_normal.row(lane).map(f64::from);
        let is_surface = paths.surfaces && paths.columns.last_surface.rows()[lane] > 0;
        let surface = is_surface.then(|| DVec3::from(normal));
        let weight = weight(medium, lights, techniques, walk, lengths, &path, first_start, surface, light);
        candidates.weight.rows_mut()[row] = weight as f32;
    }
}

/// Where a path was `back` >= 1 vertices before the current one, if it remembers.
///
/// Without a trail only the vertex before is known: no active technique then starts earlier than at the current vertex,
/// and NaN in the place of the others does not reach the weight.
pub fn position_before(
    vertices: &VertexTable<'_>,
    trail: &TrailTable<'_>,
    step: Step,
    lane: usize,
    back: u32,
) -> Option<[f64; 3]> {
    let clock = step.clock - back;
    let position = match back {
        1 => vertices.at(clock).position.row(lane),
        _ if (back as usize) < trail.slots() => trail.row(lane, clock).position,
        _ => return None,
    };
    Some(position.map(f64::from))
}

/// The weight of `path`, from the camera vertex to a point on `light`, with starts from `first_start` on, which is on a
/// surface of the normal `surface`, if there is one.
#[expect(clippy::too_many_arguments, reason = "a weight depends on everything that competes for the path")]
pub fn weight(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &Walk,
    lengths: PathLengths,
    path: &[DVec3],
    first_start: usize,
    surface: Option<DVec3>,
    light: usize,
) -> f64 {
    let [.., before, point] = path else {
        return 0.0;
    };
    let profile = profile(&lights.emitters()[light], *point, *point - *before);
    if profile == 0.0 {
        return 0.0;
    }
    let segments = path.len() - 1;
    if surface.is_some_and(|normal| (path[first_start + 1] - path[first_start]).dot(normal) <= 0.0) {
        return 0.0;
    }
    let mut sum = if segments <= walk.segments as usize { reach(walk, segments) } else { 0.0 };
    for start in first_start..segments.min(first_start.saturating_add(walk.starts as usize)) {
        let surface = surface.filter(|_| start == first_start);
        sum += reach(walk, start) * ratios(medium, lights, techniques, lengths, path, start, surface, light);
    }
    if sum == 0.0 {
        return 0.0;
    }
    profile / sum
}

/// Radiance of an emitter from `point` towards where a ray in `direction` comes from, over its `radiance`; 0 from its back.
pub fn profile(emitter: &Emitter, point: DVec3, direction: DVec3) -> f64 {
    let cosine = cosine(emitter, point, direction);
    if cosine <= 0.0 {
        return 0.0;
    }
    let exponent = f64::from(emitter.exponent);
    if emitter.is_focused() { (exponent + 1.0) / (2.0 * PI) * cosine.powf(exponent) } else { 1.0 }
}

/// Probability that a walk survives all vertices between the camera and vertex `i`.
pub fn reach(walk: &Walk, i: usize) -> f64 {
    f64::from(walk.survival).powi(i as i32 - 1)
}

/// The sum of all techniques' ratios r_i for the vertex `start` of `path`, on a surface of the normal `surface` if that is
/// given; the path ends on `light`.
#[expect(clippy::too_many_arguments, reason = "a ratio depends on everything that may make the path")]
fn ratios(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    lengths: PathLengths,
    path: &[DVec3],
    start: usize,
    surface: Option<DVec3>,
    light: usize,
) -> f64 {
    let (extinction, g) = (f64::from(medium.extinction), f64::from(medium.phase.g));
    let [.., before, point] = path else {
        return 0.0;
    };
    let emitter = &lights.emitters()[light];
    let normal = normal(emitter, *point, *point - *before);
    let Some(traced) = path_tracing_density(extinction, g, path, start, surface, normal) else {
        return 0.0;
    };
    let (chain, depth) = (&path[start..], start as u32);
    let light_density = light_density(lights, light, path[start]);
    let mut sum = 0.0;
    if techniques.nee {
        sum += nee::reference::density(chain, normal, light_density).over(traced);
    }
    if let Some(mvnee) = &techniques.mvnee {
        sum += mvnee::reference::density(&mvnee.into(), extinction, chain, light_density).over(traced);
    }
    if techniques.omnee && depth <= omnee::reach(lengths).max_depth {
        sum += omnee::reference::density(g, chain, light_density).over(traced);
    }
    let longest = lengths.max;
    let arriving = (path[start] - path[start - 1]).normalize();
    if let Some(lis) = &techniques.lis {
        let from = lis::reference::Start { depth, arriving, on_surface: surface.is_some() };
        let density = lis::reference::density(lis, (extinction, g), emitter, longest, from, chain, light_density);
        sum += density.over(traced);
        if techniques.companion().is_some() {
            sum += lis::reference::companion_density(lis, chain, normal, light_density).over(traced);
        }
    }
    if let Some(bridge) = &techniques.bridge {
        let bridge = if surface.is_some() { bridge.from_surface() } else { *bridge };
        let density =
            bridge::reference::density(&bridge, extinction, g, longest, depth, arriving, chain, light_density);
        sum += density.over(traced);
    }
    sum
}

/// Density with which path tracing, at vertex `start`, makes the rest of `path`, which ends on a light that faces
/// `normal`; the start is on a surface of the normal `surface`, or in the medium. None if it cannot: in vacuum, or where a segment has no length and so no direction.
pub fn path_tracing_density(
    extinction: f64,
    g: f64,
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
                _ => phase::density(g, arriving.dot(leaving)),
            })
            .times_exp(-extinction * length)
            .times(1.0 / (length * length))
            .times(if ends_on_light { -leaving.dot(normal) } else { extinction });
        arriving = leaving;
    }
    (density.mantissa > 0.0).then_some(density)
}

/// A density, `mantissa * e^exponent`: a plain product, except that its range does not end where that of f64 does.
///
/// It would be left soon: with a mean free path of a kilometre every vertex brings a factor of about 1e-9 per cubic
/// metre, and the product of 36 of them is no longer a number. So is `exp(-mu_t s)` past 745 mean free paths, although
/// the quotient of two such densities is of the order of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    mantissa: f64,
    exponent: f64,
}

impl Density {
    /// The density of what is never made.
    pub const ZERO: Self = Self { mantissa: 0.0, exponent: 0.0 };

    /// A density of one factor.
    pub fn new(factor: f64) -> Self {
        Self { mantissa: factor, exponent: 0.0 }
    }

    /// Multiplied by `factor`, >= 0.
    pub fn times(self, factor: f64) -> Self {
        let product = Self { mantissa: self.mantissa * factor, ..self };
        if product.mantissa == 0.0 || (1e-100..1e100).contains(&product.mantissa) {
            return product;
        }
        Self { mantissa: 1.0, exponent: product.exponent + product.mantissa.ln() }
    }

    /// Multiplied by `e^exponent`.
    pub fn times_exp(self, exponent: f64) -> Self {
        Self { exponent: self.exponent + exponent, ..self }
    }

    /// The product of two densities.
    pub fn product(self, other: Self) -> Self {
        self.times(other.mantissa).times_exp(other.exponent)
    }

    /// The quotient of two densities.
    pub fn over(self, other: Self) -> f64 {
        if self.mantissa == 0.0 {
            return 0.0;
        }
        self.mantissa / other.mantissa * (self.exponent - other.exponent).exp()
    }

    /// The density as a number, as far as it is one.
    pub fn value(self) -> f64 {
        self.over(Self::new(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::bridge::{Bridge, Roll};
    use crate::connect::mvnee::{Mvnee, Offset};
    use crate::phase::HenyeyGreenstein;
    use crate::tables::lights::{Emitter, Selection};
    use core::f64::consts::PI;

    fn medium(extinction: f32, g: f32) -> Medium {
        Medium { extinction, albedo: [1.0; 3], phase: HenyeyGreenstein { g } }
    }

    fn light(center: DVec3) -> Lights {
        Lights::new(vec![Emitter::disk(center, -DVec3::Z, 0.5, [1.0; 3])], Selection::Uniform)
    }

    fn both(medium: &Medium) -> Techniques {
        let mvnee = Some(Mvnee::new(medium, f64::INFINITY, Offset::Ggx));
        Techniques { nee: true, mvnee, ..Techniques::default() }
    }

    const FREE: Walk = Walk { segments: u32::MAX, starts: u32::MAX, survival: 1.0 };
    const LENGTHS: PathLengths = PathLengths { min: 1, max: 1000 };

    #[test]
    fn a_straight_connection_has_the_ratios_of_the_closed_form() {
        let (medium, lights) = (medium(0.5, 0.0), light(DVec3::new(0.0, 1.0, 3.0)));
        let path = [DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 3.0)];
        // p_A s^2 / (p_w cos_light), with and without the probability of a flight past the light.
        let ratio = 1.0 / (0.25 * PI) * 4.0 * 4.0 * PI;
        let weight = |techniques: &Techniques| weight(&medium, &lights, techniques, &FREE, LENGTHS, &path, 1, None, 0);
        assert_eq!(weight(&Techniques::default()), 1.0);
        let nee = weight(&Techniques { nee: true, ..Techniques::default() });
        assert!((nee - 1.0 / (1.0 + ratio * 1.0_f64.exp())).abs() < 1e-12, "{nee}");
        let mvnee = weight(&Techniques { nee: false, ..both(&medium) });
        assert!((mvnee - 1.0 / (1.0 + ratio)).abs() < 1e-12, "{mvnee}");
        let all = weight(&both(&medium));
        assert!((all - 1.0 / (1.0 + ratio + ratio * 1.0_f64.exp())).abs() < 1e-12, "{all}");
    }

    #[test]
    fn backs_and_paths_without_a_last_segment_weigh_nothing() {
        let (medium, lights) = (medium(0.5, 0.3), light(DVec3::ZERO));
        let weight = |before: DVec3| {
            let path = [DVec3::X, before, DVec3::ZERO];
            weight(&medium, &lights, &both(&medium), &FREE, LENGTHS, &path, 1, None, 0)
        };
        assert!(weight(-DVec3::Z) > 0.0);
        assert_eq!([DVec3::Z, DVec3::Y, DVec3::ZERO].map(weight), [0.0; 3]);
    }

    #[test]
    fn starts_whose_suffix_has_an_empty_segment_have_no_ratio() {
        let (medium, lights) = (medium(0.5, 0.3), light(DVec3::new(0.0, 0.0, 2.0)));
        let path = [-DVec3::Z, DVec3::X, DVec3::X, DVec3::ZERO, DVec3::new(0.0, 0.1, 2.0)];
        let weight = |first: usize| weight(&medium, &lights, &both(&medium), &FREE, LENGTHS, &path, first, None, 0);
        assert_eq!(weight(1), weight(3));
        assert!(weight(3) < 1.0);
    }

    #[test]
    fn weights_do_not_depend_on_the_unit_of_length() {
        let zigzag = |k: usize| DVec3::new(0.1 * (k % 3) as f64, 0.2 * (k % 2) as f64, 0.5 * k as f64);
        let weights = [1e-5_f64, 1.0, 1e4].map(|mfp| {
            let mut path: Vec<_> = (0..200).map(|k| mfp * zigzag(k)).collect();
            path.push(mfp * DVec3::new(0.0, 0.0, 101.0));
            let disk = Emitter::disk(path[200], -DVec3::Z, 20.0 * mfp, [1.0; 3]);
            let lights = Lights::new(vec![disk], Selection::Uniform);
            let medium = medium((1.0 / mfp) as f32, 0.6);
            weight(&medium, &lights, &both(&medium), &FREE, LENGTHS, &path, 1, None, 0)
        });
        assert!(weights[1] > 0.0 && weights[1] < 1.0, "{weights:?}");
        assert!(weights.iter().all(|weight| (weight / weights[1] - 1.0).abs() < 1e-4), "{weights:?}");
    }

    /// A path of five segments through open space, and the light at its end.
    fn bent() -> (Medium, Lights, [DVec3; 6]) {
        let at = |x: f64, z: f64| DVec3::new(x, 0.1 * z * z, z);
        let path = [at(0.0, 0.0), at(0.3, 0.8), at(0.1, 1.5), at(0.6, 2.1), at(0.5, 2.9), at(0.2, 4.0)];
        (medium(1.2, 0.4), light(path[5]), path)
    }

    /// The one-line ratios of section 5 and 6 of the derivation, which know of no full density.
    #[test]
    fn bridges_and_once_more_estimation_have_the_ratios_of_their_closed_forms() {
        let (medium, lights, path) = bent();
        let (extinction, g) = (f64::from(medium.extinction), f64::from(medium.phase.g));
        let direction = |j: usize| (path[j + 1] - path[j]).normalize();
        let area = PI * 0.25;
        let lengths = PathLengths { min: 1, max: 9 };
        let sum = |techniques: &Techniques, start: usize| {
            ratios(&medium, &lights, techniques, lengths, &path, start, None, 0)
        };
        for start in 1..5 {
            let n = 5 - start as i32;
            let length: f64 = (start..5).map(|j| (path[j + 1] - path[j]).length()).sum();
            let s = (path[5] - path[start]).length();
            let cos_light = direction(4).z;
            let common = 1.0 / (area * phase::density(g, direction(start - 1).dot(direction(start))) * cos_light);
            let factorial: f64 = (1..n).map(f64::from).product();
            let axis = (path[5] - path[start]) / s;
            let mean = extinction * s * (2.95 - 2.0 * direction(start - 1).dot(axis));
            let count = 0.95 * (-mean).exp() * mean.powi(n - 1) / factorial + 0.05 / f64::from(9 - start as i32);
            let uniform = common * count * factorial * extinction * s.powi(3) * (extinction * length).exp()
                / (extinction * length).powi(n);
            let roll = bridge::reference::roll_density(g, direction(start - 1), axis, direction(start));
            for (kind, expected) in [(Roll::Uniform, uniform), (Roll::Aligned, uniform * roll)] {
                let found = sum(&Techniques { bridge: Some(Bridge::new(kind)), ..Techniques::default() }, start);
                assert!((found / expected - 1.0).abs() < 1e-6, "{kind:?} from {start}: {found}, expected {expected}");
            }
            let found = sum(&Techniques { omnee: true, ..Techniques::default() }, start);
            if start != 3 {
                assert_eq!(found, 0.0, "from {start}");
                continue;
            }
            let theta = direction(3).angle_between(direction(4));
            let share = omnee::reference::forward_share(g);
            let expected = common * s * theta.sin() / theta * (extinction * length).exp() / (share * extinction);
            assert!((found / expected - 1.0).abs() < 1e-6, "{found}, expected {expected}");
        }
    }

    #[test]
    fn walks_that_end_stop_or_rarely_start_compete_less() {
        let (medium, lights, path) = bent();
        let techniques =
            Techniques { nee: true, omnee: true, bridge: Some(Bridge::new(Roll::Aligned)), ..both(&medium) };
        let ratio = |start: usize| ratios(&medium, &lights, &techniques, LENGTHS, &path, start, None, 0);
        let weight =
            |walk: Walk, first: usize| weight(&medium, &lights, &techniques, &walk, LENGTHS, &path, first, None, 0);
        let close =
            |found: f64, sum: f64| assert!((found * sum - 1.0).abs() < 1e-12, "{found}, expected {}", 1.0 / sum);
        close(weight(FREE, 1), 1.0 + (1..5).map(ratio).sum::<f64>());
        close(weight(FREE, 3), 1.0 + ratio(3) + ratio(4));
        close(weight(Walk { starts: 2, ..FREE }, 1), 1.0 + ratio(1) + ratio(2));
        close(weight(Walk { starts: 1, ..FREE }, 4), 1.0 + ratio(4));
        close(weight(Walk { segments: 5, ..FREE }, 4), 1.0 + ratio(4));
        close(weight(Walk { segments: 4, ..FREE }, 4), ratio(4));
        let q: f64 = 0.5;
        let survived: f64 = (1..5).map(|start| q.powi(start as i32 - 1) * ratio(start)).sum();
        close(weight(Walk { survival: 0.5, ..FREE }, 1), q.powi(4) + survived);
    }

    #[test]
    fn a_path_that_nothing_makes_weighs_nothing() {
        let (medium, lights, path) = bent();
        let short = Walk { segments: 4, ..FREE };
        for techniques in [Techniques::default(), Techniques { omnee: true, ..Techniques::default() }] {
            assert_eq!(weight(&medium, &lights, &techniques, &short, LENGTHS, &path, 4, None, 0), 0.0);
        }
    }

    #[test]
    fn the_depth_of_the_start_limits_what_it_can_make() {
        let (medium, lights, path) = bent();
        let sum = |techniques: &Techniques, max: u32, start: usize| {
            ratios(&medium, &lights, techniques, PathLengths { min: 1, max }, &path, start, None, 0) > 0.0
        };
        let omnee = Techniques { omnee: true, ..Techniques::default() };
        assert!(sum(&omnee, 5, 3) && !sum(&omnee, 4, 3));
        let limited = Bridge { max_inserted: 2, ..Bridge::new(Roll::Uniform) };
        let bridge = Techniques { bridge: Some(limited), ..Techniques::default() };
        assert!(sum(&bridge, 5, 2) && !sum(&bridge, 5, 1) && !sum(&bridge, 4, 2));
    }
}
