//! The full density of bridges, in f64 (Schuessler, Hanika, Dachsbacher, EGSR 2024; the aligned roll is our own).
//!
//! A chain x_i .. x_n of N edges of lengths l_j, L in all, whose ends are at distance s along the axis w, is made with
//!
//! ```text
//! p = p_A P_l P(N) * s^3 (N-1)! / L^N * prod_inner phase(c_j) * prod_j 1 / l_j^2 * 2 pi p(psi) * 2 P(first)
//! P(N) = (1 - e) P_table(N; tau(s), gamma) + e / room,      1 <= N <= room
//! ```
//!
//! in volume and area measure and, if it is a single edge, p_A P_l P(1). With d the direction of arrival at the start
//! and d_0 that of the first edge, at angles gamma and beta to the axis, the aligned roll by psi from d to d_0 has the
//! density of wrapped Cauchy distributions, one per lobe by which the phase function rolls, of its g and its share w,
//!
//! ```text
//! a = 1 + g^2 - 2 g cos beta cos gamma,   b = 2 g sin beta sin gamma
//! 2 pi p(psi) = sum over the lobes of w sqrt(a^2 - b^2) / (a - b cos psi)
//! ```
//!
//! With an aligned roll, which end of a walk comes first is chosen as well. With a and b of the lobe of the table, for
//! the first edge, and for the last in its place,
//!
//! ```text
//! P(first) = A(first) / (A(first) + A(last)),      A = 1 / ((a - b) sqrt(a + b))
//! ```
//!
//! This is the density of walks as they are drawn. That one is then chosen among several is not in it: the resampling
//! weight makes up for that.

use glam::DVec3;

use super::{Bridge, Roll, counts};
use crate::connect::density::Density;
use crate::media::reference::Medium;
use crate::phase::reference::Phase;

/// The start of a bridge.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Its depth in the path.
    pub depth: u32,
    /// Where it is `[m]`.
    pub position: DVec3,
    /// Unit direction in which the path arrives there.
    pub arriving: DVec3,
    /// Whether it is on a surface: it then has no phase function to align a roll with.
    pub on_surface: bool,
}

impl Start {
    /// How bridges from here are rolled.
    pub fn roll(&self, bridge: &Bridge) -> Roll {
        if self.on_surface { Roll::Uniform } else { bridge.roll }
    }
}

/// Largest number of edges of a bridge from a start at `depth`, where paths have at most `longest` segments.
pub fn room(bridge: &Bridge, longest: u32, depth: u32) -> u32 {
    if depth >= longest {
        return 0;
    }
    let limit = if bridge.max_inserted == u32::MAX { u32::MAX } else { bridge.max_inserted + 1 };
    limit.min(longest - depth)
}

/// The place in the table of counts of a start with a light `point` `[m]`.
pub fn cell(bridge: &Bridge, medium: &dyn Medium, start: &Start, point: DVec3) -> counts::reference::Cell {
    let axis = (point - start.position).normalize_or(start.arriving);
    let turn = (!start.on_surface).then(|| start.arriving.dot(axis));
    let depth = medium.optical_depth(start.position, point);
    counts::reference::cell(&bridge.counts, medium.phase().lobe(), depth, turn)
}

/// P(N): the probability of `edges` edges from `start` to the light `point` `[m]`, where paths have at most `longest`
/// segments.
pub fn count_probability(
    bridge: &Bridge,
    medium: &dyn Medium,
    longest: u32,
    start: &Start,
    point: DVec3,
    edges: u32,
) -> f64 {
    let room = room(bridge, longest, start.depth);
    if edges == 0 || edges > room {
        return 0.0;
    }
    let tabled = counts::reference::probability(&bridge.counts, &cell(bridge, medium, start, point), edges);
    let defensive = f64::from(bridge.defensive);
    (1.0 - defensive) * tabled + defensive / f64::from(room)
}

/// ln k!
fn log_factorial(k: u32) -> f64 {
    (2..=k).map(|factor| f64::from(factor).ln()).sum()
}

/// The coefficients a and b of `h(arriving . first) = a - b cos psi` of a lobe of mean cosine g, for unit vectors.
pub fn roll_coefficients(g: f64, arriving: DVec3, axis: DVec3, first: DVec3) -> (f64, f64) {
    let (cos_gamma, cos_beta) = (arriving.dot(axis), first.dot(axis));
    let (sin_gamma, sin_beta) = (arriving.cross(axis).length(), first.cross(axis).length());
    (1.0 + g * g - 2.0 * g * cos_beta * cos_gamma, 2.0 * g * sin_beta * sin_gamma)
}

/// 2 pi p(psi) of the aligned roll that takes the first edge to `first`; all three are unit vectors. 1 if one of the
/// two directions lies on the axis.
pub fn roll_density(phase: &dyn Phase, arriving: DVec3, axis: DVec3, first: DVec3) -> f64 {
    let across = |v: DVec3| (v - v.dot(axis) * axis).try_normalize();
    let (Some(arriving_side), Some(first_side)) = (across(arriving), across(first)) else {
        return 1.0;
    };
    let lobe_density = |g: f64| {
        let (a, b) = roll_coefficients(g, arriving, axis, first);
        (a * a - b * b).sqrt() / (a - b * arriving_side.dot(first_side))
    };
    phase.roll_lobes().into_iter().map(|(share, g)| share * lobe_density(g)).sum()
}

/// P(first): the probability that a walk whose ends have the unit directions `first` and `last` is taken with that one
/// first where the roll is aligned; `arriving` and `axis` are unit vectors, too. Ends of a walk are read in the same
/// sense: it runs along both.
pub fn first_share(phase: &dyn Phase, arriving: DVec3, axis: DVec3, first: DVec3, last: DVec3) -> f64 {
    let [first, last] = [first, last].map(|end| {
        let (a, b) = roll_coefficients(f64::from(phase.lobe().g), arriving, axis, end);
        1.0 / ((a - b) * (a + b).sqrt())
    });
    first / (first + last)
}

/// Density of making `chain`, the vertices from the start to the point on the light.
///
/// Paths have at most `longest` segments; `light_density` is p_A P_l at the start. Zero if the chain is longer than the
/// limit or has an edge without length.
pub fn density(
    bridge: &Bridge,
    medium: &dyn Medium,
    longest: u32,
    start: &Start,
    chain: &[DVec3],
    light_density: f64,
) -> Density {
    let [first, .., point] = chain else {
        return Density::ZERO;
    };
    let edges: Vec<DVec3> = chain.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let way = *point - *first;
    let distance = way.length();
    if distance == 0.0 || distance > f64::from(bridge.max_distance) || edges.iter().any(|edge| edge.length() == 0.0) {
        return Density::ZERO;
    }
    if medium.optical_depth(*first, *point) > f64::from(bridge.max_depth) * medium.over_clearest() {
        return Density::ZERO;
    }
    let count = edges.len() as u32;
    let counted = Density::new(light_density).times(count_probability(bridge, medium, longest, start, *point, count));
    if count == 1 {
        return counted;
    }
    let length: f64 = edges.iter().map(|edge| edge.length()).sum();
    let mut density =
        counted.times_exp(3.0 * distance.ln() + log_factorial(count - 1) - f64::from(count) * length.ln());
    let phase = medium.phase();
    for pair in edges.windows(2) {
        density = density.times(phase.density(pair[0].normalize().dot(pair[1].normalize())));
    }
    for edge in &edges {
        density = density.times(1.0 / edge.length_squared());
    }
    match start.roll(bridge) {
        Roll::Uniform => density,
        Roll::Aligned => {
            let (axis, [first, last]) = (way / distance, [edges[0], edges[edges.len() - 1]].map(DVec3::normalize));
            let chosen = 2.0 * first_share(phase, start.arriving, axis, first, last);
            density.times(chosen).times(roll_density(phase, start.arriving, axis, first))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Medium;
    use crate::media::reference::Homogeneous;
    use crate::phase::HenyeyGreenstein;
    use crate::phase::PhaseFunction;
    use core::f64::consts::{PI, TAU};

    const DEFENSIVE: f64 = super::super::DEFENSIVE as f64;

    fn bridge(roll: Roll, g: f32) -> Bridge {
        let phase = PhaseFunction::henyey_greenstein(g);
        Bridge::new(roll, &Medium::homogeneous(0.7, [1.0; 3], phase), 40)
    }

    fn start(depth: u32, arriving: DVec3) -> Start {
        Start { depth, position: DVec3::ZERO, arriving, on_surface: false }
    }

    #[test]
    fn count_probabilities_add_up_to_one_with_room_and_to_less_without() {
        let bridge = bridge(Roll::Aligned, 0.6);
        let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.6 });
        let sum = |longest: u32, way: f64| -> f64 {
            let p = |n| count_probability(&bridge, medium, longest, &start(1, DVec3::Y), way * DVec3::Z, n);
            (0..=longest + 2).map(p).sum()
        };
        for way in [0.0, 2e-3, 1.0, 8.0, 60.0, 1e9] {
            assert!((sum(1024, way) - 1.0).abs() < 1e-6, "{way}");
            let few = sum(4, way);
            assert!((DEFENSIVE..=1.0 + 1e-6).contains(&few), "{way}: {few}");
        }
        // Four edges are far below what 60 mean free paths take: the defensive part is left, and the counts beyond are
        // dropped.
        assert!((sum(4, 60.0) - DEFENSIVE).abs() < 1e-6);
    }

    #[test]
    fn counts_are_a_mixture_of_the_table_and_uniform_within_the_room() {
        let free = bridge(Roll::Aligned, 0.6);
        let limited = Bridge { max_inserted: 2, ..free.clone() };
        let (at, way) = (start(4, DVec3::X), 1.5 * DVec3::Z);
        let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.6 });
        let tabled = counts::reference::probability(&free.counts, &cell(&free, medium, &at, way), 3);
        let found = |bridge: &Bridge, longest: u32, n: u32| count_probability(bridge, medium, longest, &at, way, n);
        // Room min(9 - 4, 3), and 5.
        for (bridge, room) in [(&limited, 3.0), (&free, 5.0)] {
            let expected = (1.0 - DEFENSIVE) * tabled + DEFENSIVE / room;
            assert!((found(bridge, 9, 3) - expected).abs() < 1e-15);
        }
        assert_eq!([0, 4].map(|edges| found(&limited, 9, edges)), [0.0; 2]);
        assert_eq!([4, 3].map(|longest| found(&free, longest, 1)), [0.0; 2]);
        // Beyond the table counts are uniform.
        assert_eq!(found(&free, 2004, 40), DEFENSIVE / 2000.0);
    }

    /// A unit vector at `angle` to the z axis.
    fn tilted(angle: f64, azimuth: f64) -> DVec3 {
        DVec3::new(angle.sin() * azimuth.cos(), angle.sin() * azimuth.sin(), angle.cos())
    }

    #[test]
    fn the_roll_integrates_to_a_full_turn() {
        for (g, gamma, beta) in [(0.9, 1.0, 0.4), (0.5, 2.5, 1.4), (-0.8, 0.7, 2.0), (0.97, 0.3, 0.3), (0.0, 1.0, 1.0)]
        {
            let steps = 4096;
            let width = TAU / f64::from(steps);
            let phase = HenyeyGreenstein { g };
            let density =
                |k: i32| roll_density(&phase, tilted(gamma, 0.3), DVec3::Z, tilted(beta, f64::from(k) * width));
            let sum: f64 = (0..steps).map(density).sum();
            assert!((sum * width / TAU - 1.0).abs() < 1e-9, "g = {g}: {}", sum * width);
        }
        let phase = HenyeyGreenstein { g: 0.9 };
        assert_eq!(roll_density(&phase, DVec3::X, DVec3::Z, DVec3::Z), 1.0);
        assert_eq!(roll_density(&phase, DVec3::Z, DVec3::Z, DVec3::X), 1.0);
    }

    #[test]
    fn the_roll_is_proportional_to_the_phase_function_to_the_power_two_thirds() {
        let (phase, arriving) = (HenyeyGreenstein { g: 0.7 }, tilted(0.8, 2.0));
        let constant = |azimuth: f64| {
            let first = tilted(1.1, azimuth);
            roll_density(&phase, arriving, DVec3::Z, first) / phase.density(arriving.dot(first)).powf(2.0 / 3.0)
        };
        for azimuth in [0.5, 1.9, 3.0, 6.0] {
            assert!((constant(azimuth) / constant(0.0) - 1.0).abs() < 1e-12, "{azimuth}");
        }
    }

    /// Bipolar coordinates: with angles alpha and beta at the ends and turn theta = alpha + beta, the edges are
    /// s sin(beta) / sin(theta) and s sin(alpha) / sin(theta), and dV = l_1^2 l_2^2 / s dalpha dbeta dphi.
    #[test]
    fn the_density_of_one_inserted_vertex_integrates_to_its_probability() {
        let (distance, arriving) = (1.3, tilted(1.1, 0.4));
        let point = DVec3::new(0.0, 0.0, distance);
        for (roll, g) in [(Roll::Uniform, 0.0), (Roll::Uniform, 0.6), (Roll::Aligned, 0.6), (Roll::Aligned, -0.5)] {
            let (bridge, at) = (bridge(roll, g), start(2, arriving));
            let phase = HenyeyGreenstein { g };
            let medium = &Homogeneous::new(0.7, &phase);
            let (turns, shares, azimuths) = (400, 200, 24);
            let mut sum = 0.0;
            for (i, j) in (0..turns).flat_map(|i| (0..shares).map(move |j| (i, j))) {
                let theta = PI * (f64::from(i) + 0.5) / f64::from(turns);
                let alpha = theta * (f64::from(j) + 0.5) / f64::from(shares);
                let [l1, l2] = [theta - alpha, alpha].map(|angle| distance * angle.sin() / theta.sin());
                let volume = l1 * l1 * l2 * l2 / distance * theta;
                for k in 0..azimuths {
                    let vertex = l1 * tilted(alpha, TAU * f64::from(k) / f64::from(azimuths));
                    let chain = [DVec3::ZERO, vertex, point];
                    sum += density(&bridge, medium, 9, &at, &chain, 2.0).value() * volume;
                }
            }
            sum *= PI * TAU / f64::from(turns * shares * azimuths);
            let expected = 2.0 * count_probability(&bridge, medium, 9, &at, point, 2);
            assert!((sum / expected - 1.0).abs() < 1e-3, "{bridge:?}, g = {g}: {sum}, expected {expected}");
        }
    }

    #[test]
    fn a_single_edge_obeys_the_formula_of_many() {
        let (start, point) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 4.0));
        let s = (point - start).length();
        let medium = &Homogeneous::new(0.8, &HenyeyGreenstein { g: 0.9 });
        for roll in [Roll::Aligned, Roll::Uniform] {
            let bridge = bridge(roll, 0.9);
            let at = super::Start { depth: 1, position: start, arriving: DVec3::X, on_surface: false };
            let p = density(&bridge, medium, 9, &at, &[start, point], 3.0).value();
            let count = count_probability(&bridge, medium, 9, &at, point, 1);
            let many = 3.0 * count * s.powi(3) / s / (s * s);
            assert!((p / many - 1.0).abs() < 1e-14, "{p} and {many}");
        }
    }

    #[test]
    fn a_thousand_vertices_in_any_unit_of_length_have_a_density() {
        let (bridge, phase) = (bridge(Roll::Aligned, 0.9), HenyeyGreenstein { g: 0.9 });
        let zigzag = |k: i32| DVec3::new(0.3 * f64::from(k % 3), 0.2 * f64::from(k % 2), 0.5 * f64::from(k));
        let ratios = [1e-6, 1.0, 1e6].map(|unit| {
            let path: Vec<_> = (0..1025).map(|k| unit * zigzag(k)).collect();
            let medium = &Homogeneous::new(1.0 / unit, &phase);
            let from = Start { position: path[1], ..start(1, DVec3::Z) };
            let p = density(&bridge, medium, 2048, &from, &path[1..], 1.0 / (unit * unit));
            let traced =
                crate::mis_weight::reference::path_tracing_density(medium, &path, 1, None, -DVec3::Z).expect("one");
            p.over(traced)
        });
        assert!(ratios[1].is_finite() && ratios[1] > 0.0, "{ratios:?}");
        assert!(ratios.iter().all(|ratio| (ratio / ratios[1] - 1.0).abs() < 1e-8), "{ratios:?}");
    }

    #[test]
    fn chains_beyond_the_reach_or_with_an_empty_edge_are_never_made() {
        let aligned = bridge(Roll::Aligned, 0.5);
        let made = |bridge: &Bridge, chain: &[DVec3]| {
            let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.5 });
            density(bridge, medium, 4, &start(1, DVec3::X), chain, 1.0).value() > 0.0
        };
        let chain = [DVec3::ZERO, DVec3::Y, DVec3::ONE, DVec3::Z, 2.0 * DVec3::Z];
        assert!(made(&aligned, &chain[..4]) && made(&aligned, &[DVec3::ZERO, DVec3::Z]));
        assert!(!made(&aligned, &chain), "more edges than there is room");
        assert!(!made(&Bridge { max_inserted: 1, ..aligned.clone() }, &chain[..4]));
        assert!(made(&Bridge { max_distance: 1.0, ..aligned.clone() }, &chain[..4]));
        assert!(!made(&Bridge { max_distance: 0.99, ..aligned.clone() }, &chain[..4]));
        assert!(!made(&aligned, &[DVec3::ZERO, DVec3::Y, DVec3::Y, DVec3::Z]));
        assert!(!made(&aligned, &[DVec3::ZERO, DVec3::Y, DVec3::ZERO]));
        assert!(!made(&aligned, &[DVec3::ZERO]));
    }
}
