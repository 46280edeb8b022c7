//! Filling the table: what light by N edges contributes, from free walks.
//!
//! ```text
//! for each of many walks, for N = 1 .. edges, for each knot (mu_t s, gamma):
//!     x     = mu_t s L / |y_N|,      psi rolled by an even spread of numbers
//!     I(N) += albedo^(N-1) x^N e^-x / (N-1)! * 4 pi p_w / (2 pi p(psi))
//! ```
//!
//! 1. The first N edges of a long walk are a walk of N edges: one walk serves all N.
//! 2. A summand is a product of what depends on mu_t s and of what depends on gamma.
//!
//! An error of the table costs efficiency and nothing else: whatever it says is both drawn and weighed.

use core::f64::consts::PI;

use glam::DVec3;

use super::{CountTable, DISTANCES, Knot, MOST_EDGES, TURNS, knots};
use crate::media::Medium;
use crate::phase::reference::{Phase, turn};
use crate::random;

/// Walks that the means are taken over.
const WALKS: u32 = 512;
/// The seed of their numbers.
const SEED: u32 = 0x6d2b_79f5;
/// One over the golden ratio, by multiples of which numbers spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl CountTable {
    /// The table for bridges in `medium` on paths of at most `longest` segments.
    pub fn new(medium: &Medium, longest: u32) -> Self {
        let edges = longest.saturating_sub(1).clamp(1, MOST_EDGES) as usize;
        let means = means(medium, edges);
        Self::from_weights(medium.phase.twin().lobe(), edges, |knot| {
            means.iter().map(|slab| slab[knot.index]).collect()
        })
    }
}

/// I(N) at every knot, up to a common factor: `[N - 1][knot]`.
fn means(medium: &Medium, edges: usize) -> Vec<Vec<f64>> {
    let phase = medium.phase.twin();
    let (lobe, rolls) = (phase.lobe(), phase.roll_lobes());
    let albedo = f64::from(medium.albedo.into_iter().fold(0.0, f32::max));
    let knots: Vec<Knot> = knots(lobe).collect();
    let mut means = vec![vec![0.0; DISTANCES * TURNS]; edges];
    for walk in 0..WALKS {
        let roll = (f64::from(walk) * GOLDEN).fract();
        let (mut factorial, mut scattered) = (0.0, 1.0);
        for (n, (stretch, first)) in shapes(phase, edges, walk).enumerate() {
            let edges = (n + 1) as f64;
            let turns: [f64; TURNS] =
                core::array::from_fn(|j| turn_factor(phase, &rolls, knots[j].cosine, first, roll));
            for (i, row) in means[n].chunks_exact_mut(TURNS).enumerate() {
                let x = knots[i * TURNS].distance * stretch;
                let strength = scattered * (edges * x.ln() - x - factorial).exp();
                row.iter_mut().zip(turns).for_each(|(mean, turn)| *mean += strength * turn);
            }
            factorial += edges.ln();
            scattered *= albedo;
        }
    }
    means
}

/// The free walk of number `walk`, edge by edge: its length over the distance from its origin, and the cosine between
/// its first edge and its end.
fn shapes(phase: &dyn Phase, edges: usize, walk: u32) -> impl Iterator<Item = (f64, f64)> {
    let (mut position, mut direction, mut length) = (DVec3::ZERO, DVec3::Z, 0.0);
    (0..edges).map(move |edge| {
        let [flight, cosine, azimuth, _] = random::words(walk, edge as u32, 0, SEED).map(random::uniform);
        let flight = -(1.0 - flight).ln();
        length += flight;
        position += flight * direction;
        direction = turn(direction, phase.sample_cosine(cosine), azimuth);
        let distance = position.length();
        (length / distance, position.z / distance)
    })
}

/// `4 pi p_w / (2 pi p(psi))` of a roll by the lobes `rolls`, shares and mean cosines, for a path that arrives at an
/// angle of cosine `arriving` to the axis, from which the first edge has an angle of cosine `first`; 1 at a surface.
fn turn_factor(phase: &dyn Phase, rolls: &[(f64, f64)], arriving: Option<f64>, first: f64, roll: f64) -> f64 {
    let Some(arriving) = arriving else {
        return 1.0;
    };
    let sine = |cosine: f64| (1.0 - cosine * cosine).max(0.0).sqrt();
    let (along, across) = (first * arriving, sine(first) * sine(arriving));
    let cos_psi = draw_roll(rolls, (along, across), roll);
    let density: f64 = rolls.iter().map(|(share, g)| share * roll_density(*g, (along, across), cos_psi)).sum();
    4.0 * PI * phase.density(along + across * cos_psi) / density
}

/// `h_-`, `h_+` and, for the roll of cosine `cos_psi`, h of a lobe of mean cosine g.
fn h(g: f64, (along, across): (f64, f64), cos_psi: f64) -> [f64; 3] {
    [along + across, along - across, along + across * cos_psi].map(|cosine| 1.0 + g * g - 2.0 * g * cosine)
}

/// `2 pi p(psi)` of a lobe.
fn roll_density(g: f64, plane: (f64, f64), cos_psi: f64) -> f64 {
    let [near, far, h] = h(g, plane, cos_psi);
    (near * far).sqrt() / h
}

/// Cosine of the roll for the number `u`, which also selects the lobe.
fn draw_roll(rolls: &[(f64, f64)], plane: (f64, f64), mut u: f64) -> f64 {
    let mut chosen = rolls[0];
    for (index, part) in rolls.iter().enumerate() {
        chosen = *part;
        if u < part.0 || index + 1 == rolls.len() {
            break;
        }
        u -= part.0;
    }
    let (share, g) = chosen;
    let [near, far, _] = h(g, plane, 0.0);
    let (s, c) = (PI * (u / share - 0.5)).sin_cos();
    (far * c * c - near * s * s) / (far * c * c + near * s * s)
}
