//! Numbers of edges of bridges: probabilities from a table.
//!
//! Were a start to see all the light that comes from a light point, how much of it would have come by N edges? Up to
//! factors that do not depend on N, it is the mean contribution of bridges of N edges,
//!
//! ```text
//! I(N) = albedo^(N-1) E[ x^N e^-x / (N-1)! * p_w(c) / p(psi) ],      x = mu_t s L / |y_N|
//! P(N) = I(N) / sum of all I,                                    N = 1 .. edges
//! ```
//!
//! where the mean is over free walks 0, y_1 .. y_N of length L and their rolls psi, the fraction with the factorial is
//! one over that of the [ratio](super), and c is the turn at the start. It is the same for both rolls. Besides phase
//! function and albedo it depends on two numbers of the start only: mu_t s, the optical distance, and gamma, the angle
//! between the axis and the direction in which the path arrives. The table knows P(N) at *knots*,
//!
//! ```text
//! mu_t s   = 2^k, 1.5 * 2^k        (least 2^-8, largest 1.5 * 2^7)
//! h(gamma) = (1 - |g|)^2 2^k       (15 of them),     and as the last, for starts on a surface, no turn: p_w / p(psi) = 1
//! ```
//!
//! and is bilinear in mu_t s and h in between, constant beyond. A bilinear mixture is drawn by choosing one of the four
//! knots around at random, and probabilities are the steps of the rounded distribution: what is drawn is what is
//! weighed, as far as uniform numbers of 23 bits can tell. Rarer counts than that are left to the uniform part of the
//! counts.
//!
//! The coordinate of turns is the `h` of a Henyey-Greenstein lobe: of the phase function itself, or of the one that has
//! its mean cosine. An error of the table costs efficiency, and nothing else.

pub mod moments;
pub mod reference;
pub mod simd;

use crate::phase::HenyeyGreenstein;

/// Knots of the optical distance.
pub const DISTANCES: usize = 32;
/// Knots of the turn; the last stands for starts on a surface.
pub const TURNS: usize = 16;
/// The knot of starts on a surface.
pub const SURFACE: usize = TURNS - 1;
/// Most edges that a table knows; longer bridges are left to the uniform part of the counts.
pub const MOST_EDGES: u32 = 128;

/// Least optical distance of a knot.
const NEAREST: f32 = 1.0 / 256.0;
/// Entries for one number of edges: one per knot, and room for what lies behind the last, which weighs nothing.
const SLAB: usize = DISTANCES * TURNS + TURNS + 1;
const _: () = assert!((DISTANCES * TURNS).is_power_of_two(), "kernels mask indices of knots");

/// Probabilities of the numbers of edges 1 .. [`CountTable::edges`].
#[derive(Clone, PartialEq)]
pub struct CountTable {
    edges: usize,
    /// One over the least h.
    inverse_least_h: f32,
    /// `[N - 1][distance * TURNS + turn]`: P(N).
    probabilities: Vec<[f32; SLAB]>,
    /// `[distance * TURNS + turn][N - 1]`: probability of at most N edges, in rows of `stride`; 1 from the last N on.
    cumulative: Vec<f32>,
    /// `edges`, rounded up to whole batches.
    stride: usize,
}

/// One knot of the table, as that which fills it sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Its place in the table, turns first.
    pub index: usize,
    /// mu_t s
    pub distance: f64,
    /// cos gamma; None for starts on a surface.
    pub cosine: Option<f64>,
}

impl core::fmt::Debug for CountTable {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("CountTable").field("edges", &self.edges).finish_non_exhaustive()
    }
}

impl CountTable {
    /// The table whose probabilities are, knot by knot, in proportion to `weights(knot)[N - 1]`, >= 0, N = 1 ..
    /// `edges`; `edges >= 1`. Where all are 0 all numbers are alike.
    pub fn from_weights(lobe: HenyeyGreenstein, edges: usize, mut weights: impl FnMut(Knot) -> Vec<f64>) -> Self {
        let least = 1.0 - f64::from(lobe.g).abs();
        let stride = edges.next_multiple_of(crate::lanes::LANES);
        let mut table = Self {
            edges,
            inverse_least_h: (1.0 / (least * least)) as f32,
            probabilities: vec![[0.0; SLAB]; edges],
            cumulative: vec![1.0; DISTANCES * TURNS * stride],
            stride,
        };
        knots(lobe).for_each(|knot| table.fill(knot.index, &weights(knot)));
        table
    }

    /// About the counts of the paper: one more than a Poisson number of mean mu_t s, between knots a mixture of two,
    /// and no more than [`MOST_EDGES`].
    pub fn poisson(lobe: HenyeyGreenstein) -> Self {
        let edges = MOST_EDGES as usize;
        Self::from_weights(lobe, edges, |knot| {
            let mut weight = (-knot.distance).exp();
            let next = |n: usize| {
                let this = weight;
                weight *= knot.distance / n as f64;
                this
            };
            (1..=edges).map(next).collect()
        })
    }

    /// Largest number of edges in the table.
    pub fn edges(&self) -> usize {
        self.edges
    }

    /// Sets one knot. The probabilities are the steps of the rounded distribution: what is drawn is what is weighed.
    fn fill(&mut self, index: usize, weights: &[f64]) {
        let sum: f64 = weights.iter().sum();
        let row = &mut self.cumulative[index * self.stride..][..self.edges];
        let (mut below, mut partial) = (0.0_f32, 0.0);
        for (n, cumulative) in row.iter_mut().enumerate() {
            partial += if sum > 0.0 { weights[n] / sum } else { 1.0 / self.edges as f64 };
            *cumulative = if n + 1 == self.edges { 1.0 } else { (partial as f32).min(1.0) };
            self.probabilities[n][index] = *cumulative - below;
            below = *cumulative;
        }
    }
}

/// The knots in the sequence of the table.
pub fn knots(lobe: HenyeyGreenstein) -> impl Iterator<Item = Knot> {
    let g = f64::from(lobe.g);
    let cosine = move |turn: usize| {
        let h = (1.0 - g.abs()).powi(2) * 2.0_f64.powi(turn as i32);
        // An isotropic medium has one h only, and the direction does not matter there.
        let cosine = if g == 0.0 { 1.0 } else { (1.0 + g * g - h) / (2.0 * g) };
        (turn != SURFACE).then_some(cosine.clamp(-1.0, 1.0))
    };
    let knot = move |index: usize| Knot { index, distance: distance_of(index / TURNS), cosine: cosine(index % TURNS) };
    (0..DISTANCES * TURNS).map(knot)
}

/// mu_t s of a knot.
fn distance_of(knot: usize) -> f64 {
    f64::from(NEAREST) * 2.0_f64.powi(knot as i32 / 2) * if knot % 2 == 1 { 1.5 } else { 1.0 }
}
